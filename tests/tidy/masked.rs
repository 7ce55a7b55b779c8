//! Rust text without what only looks like code.

/// The text with blanks for comments and the insides of strings and characters; all else, and all
/// lines, stay where they are.
pub fn mask(text: &str) -> String {
    let mut out = text.as_bytes().to_vec();
    let mut at = 0;
    while at < out.len() {
        let end = end_of_opaque(text.as_bytes(), at);
        for byte in &mut out[at..end] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
        at = end.max(at + 1);
    }
    String::from_utf8(out).expect("whole characters are blanked")
}

/// Where a comment, string or character that begins at a byte ends; that byte if none does.
fn end_of_opaque(text: &[u8], at: usize) -> usize {
    let rest = &text[at..];
    match rest {
        [b'/', b'/', ..] => at + find(rest, b"\n").unwrap_or(rest.len()),
        [b'/', b'*', ..] => at + block_comment(rest),
        [b'"', ..] => at + string(rest),
        [b'r', b'"' | b'#', ..] if !is_word(text, at) => at + raw_string(rest),
        [b'b', b'r', ..] if !is_word(text, at) => match raw_string(&rest[1..]) {
            0 => at,
            length => at + 1 + length,
        },
        [b'\'', ..] => at + character(rest),
        _ => at,
    }
}

/// Whether the byte before continues a name.
fn is_word(text: &[u8], at: usize) -> bool {
    at > 0 && (text[at - 1].is_ascii_alphanumeric() || text[at - 1] == b'_')
}

fn find(text: &[u8], what: &[u8]) -> Option<usize> {
    text.windows(what.len()).position(|window| window == what)
}

fn block_comment(text: &[u8]) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at + 1 < text.len() {
        match &text[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

fn string(text: &[u8]) -> usize {
    let mut at = 1;
    while at < text.len() && text[at] != b'"' {
        at += if text[at] == b'\\' { 2 } else { 1 };
    }
    text.len().min(at + 1)
}

/// Length of a raw string; 0 if it is none, as in `r#type`.
fn raw_string(text: &[u8]) -> usize {
    let hashes = text[1..].iter().take_while(|&&b| b == b'#').count();
    if text.get(1 + hashes) != Some(&b'"') {
        return 0;
    }
    let end = [b"\"", "#".repeat(hashes).as_bytes()].concat();
    let begin = hashes + 2;
    find(&text[begin..], &end).map_or(text.len(), |found| begin + found + end.len())
}

/// Length of a character; 0 for a lifetime.
fn character(text: &[u8]) -> usize {
    const LONGEST: usize = 12;
    if text.get(1) == Some(&b'\\') {
        let closing = find(&text[3..text.len().min(LONGEST)], b"'");
        return closing.map_or(0, |found| found + 4);
    }
    let closing = text[1..text.len().min(6)].iter().position(|&b| b == b'\'');
    let width =
        |length: usize| std::str::from_utf8(&text[1..=length]).map_or(0, |s| s.chars().count());
    match closing {
        Some(length) if length > 0 && width(length) == 1 => length + 2,
        _ => 0,
    }
}

#[test]
fn strings_comments_and_characters_are_blank() {
    let text = "let a = \"x { \\\" \"; // {\nlet b = '{'; let c: &'a str = r#\"{\"#; /* { /* */ { */ d('\\n')";
    let masked = mask(text);
    assert_eq!(masked.len(), text.len());
    assert!(!masked.contains('{') && masked.contains("&'a str") && masked.contains("d("));
    assert_eq!(masked.lines().count(), 2);
}
