//! `$PhysicalNames`, which mshio drops. It is text in binary files too.

use kluft_mesh::{Defect, Group};

use super::source::{Encoding, MshSource};

/// The named groups in file order. `offset` is where `body` begins in the file.
pub(super) fn read(source: MshSource, body: &[u8], offset: usize) -> Result<Vec<Group>, Defect> {
    let defect = |problem: String| source.defect_at(offset, Encoding::Text, problem);
    let mut lines = body
        .split(|&byte| byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .filter(|line| !line.is_empty());
    let count = lines.next().and_then(number::<usize>);
    let count = count.ok_or_else(|| defect("$PhysicalNames has no count".to_owned()))?;
    let groups: Result<Vec<Group>, String> = lines.map(group_of).collect();
    let groups = groups.map_err(defect)?;
    if groups.len() != count {
        let found = groups.len();
        return Err(defect(format!(
            "$PhysicalNames promises {count} names, there are {found}"
        )));
    }
    check_repeated(source, &groups)?;
    Ok(groups)
}

/// `dimension tag "name"`: the name goes from the first quote of the line to the last.
fn group_of(line: &[u8]) -> Result<Group, String> {
    let wrong = || format!("`{}` is no physical name", decode(line).escape_debug());
    let open = memchr::memchr(b'"', line).ok_or_else(wrong)?;
    let close = memchr::memrchr(b'"', line).filter(|&close| close > open);
    let name = &line[open + 1..close.ok_or_else(wrong)?];
    let mut words = line[..open]
        .split(|&b| b == b' ' || b == b'\t')
        .filter(|w| !w.is_empty());
    let dimension = words.next().and_then(number::<usize>).filter(|&d| d <= 3);
    let tag = words
        .next()
        .and_then(number::<i32>)
        .map(i32::saturating_abs);
    let (Some(dimension), Some(tag), None) = (dimension, tag, words.next()) else {
        return Err(wrong());
    };
    let name = if name.is_empty() {
        tag.to_string()
    } else {
        decode(name)
    };
    Ok(Group {
        dimension,
        tag,
        name,
    })
}

fn check_repeated(source: MshSource, groups: &[Group]) -> Result<(), Defect> {
    let mut seen = std::collections::HashSet::new();
    match groups
        .iter()
        .find(|group| !seen.insert((group.dimension, group.tag)))
    {
        None => Ok(()),
        Some(group) => Err(Defect::new(
            format!("{}, physical group \"{}\"", source.name, group.name),
            format!("its tag {} has another name already", group.tag),
            "give every physical group one name",
        )),
    }
}

fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// UTF-8, or else Latin-1: the two encodings that names are found in.
fn decode(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(
        |_| bytes.iter().map(|&byte| char::from(byte)).collect(),
        str::to_owned,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(body: &[u8]) -> Result<Vec<Group>, Defect> {
        let source = MshSource {
            name: "t",
            bytes: body,
        };
        read(source, body, 0)
    }

    #[test]
    fn odd_names_survive() {
        let body = b"5\n2 1 \"a b\"\r\n3 2 \"say \"x\" $EndA \\\"\n2 -7 \"Kl\xc3\xbcft\"\n\
            2 8 \"Kl\xfcft\"\n2 9 \"\"\n";
        let names: Vec<String> = names(body)
            .expect("names")
            .into_iter()
            .map(|g| g.name)
            .collect();
        assert_eq!(names, ["a b", "say \"x\" $EndA \\", "Klüft", "Klüft", "9"]);
    }

    #[test]
    fn broken_names_are_defects() {
        for body in [
            &b""[..],
            b"x",
            b"2\n2 1 \"a\"",
            b"1\n2 1 a",
            b"1\n2 1 \"a",
            b"1\n4 1 \"a\"",
            b"1\n2 1 1 \"a\"",
            b"1\n2 \"a\"",
            b"2\n2 1 \"a\"\n2 1 \"b\"",
        ] {
            assert!(names(body).is_err(), "{body:?}");
        }
    }
}
