//! What must be readable and executable for a program to start.

use std::ffi::OsString;
use std::fs::File;
use std::io::Read;
use std::os::unix::ffi::OsStringExt;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

/// Files and folders that a program needs.
#[derive(Debug, Default)]
pub(super) struct Needed {
    /// The program, and what starts it.
    pub(super) execute: Vec<PathBuf>,
    /// Where it may have its libraries: beside it, or in `lib` beside its folder.
    pub(super) read: Vec<PathBuf>,
}

/// What a program needs: its loader, or the interpreter of a script and in turn what that needs.
pub(super) fn needed_by(program: &Path) -> Needed {
    let mut needed = Needed::default();
    let mut left = vec![program.to_owned()];
    while let Some(file) = left.pop() {
        if needed.execute.contains(&file) {
            continue;
        }
        let whole = file.canonicalize().unwrap_or_else(|_| file.clone());
        for place in [&file, &whole] {
            needed.read.extend(libraries(place));
        }
        left.extend(starters(&file));
        needed.execute.push(file);
    }
    needed
}

fn libraries(program: &Path) -> impl Iterator<Item = PathBuf> + '_ {
    let folder = program.parent();
    let prefix = folder.and_then(Path::parent);
    let names = ["lib", "lib64", "share", "pyvenv.cfg"];
    let beside = prefix.map(|prefix| names.map(|name| prefix.join(name)));
    folder
        .map(Path::to_owned)
        .into_iter()
        .chain(beside.into_iter().flatten())
}

/// What the system starts in the place of a file.
fn starters(file: &Path) -> Vec<PathBuf> {
    let mut head = Vec::new();
    let Ok(file) = File::open(file) else {
        return Vec::new();
    };
    // A head that cannot be read names nothing.
    let _ = (&file).take(256).read_to_end(&mut head);
    match head.strip_prefix(b"#!") {
        Some(line) => of_script(line),
        None => loader(&file, &head).into_iter().collect(),
    }
}

/// `#!/usr/bin/env python3` needs both.
fn of_script(head: &[u8]) -> Vec<PathBuf> {
    let line = head.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let mut words = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .map(|word| PathBuf::from(OsString::from_vec(word.to_vec())));
    let mut found: Vec<PathBuf> = words.next().into_iter().collect();
    if found.first().is_some_and(|first| first.ends_with("env")) {
        let named = words.find(|word| !word.as_os_str().as_encoded_bytes().starts_with(b"-"));
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let mut places = std::env::split_paths(&folders)
            .collect::<Vec<_>>()
            .into_iter();
        found.extend(named.and_then(|name| {
            places.find_map(|folder| Some(folder.join(&name)).filter(|file| file.is_file()))
        }));
    }
    found
}

/// The loader that an ELF file of 64 bits names (program header of the type 3, `PT_INTERP`).
///
/// Source: System V ABI, generic part, chapters 4 and 5.
fn loader(file: &File, head: &[u8]) -> Option<PathBuf> {
    const HEADER: usize = 56;
    let number = |bytes: &[u8], at: usize, size: usize| -> Option<u64> {
        let mut word = [0; 8];
        word[..size].copy_from_slice(bytes.get(at..at + size)?);
        Some(u64::from_le_bytes(word))
    };
    if !head.starts_with(b"\x7fELF\x02\x01") {
        return None;
    }
    let (table, count) = (number(head, 32, 8)?, number(head, 56, 2)?);
    let mut headers = vec![0; HEADER * count as usize];
    file.read_exact_at(&mut headers, table).ok()?;
    let header = headers
        .chunks_exact(HEADER)
        .find(|header| number(header, 0, 4) == Some(3))?;
    let (at, length) = (number(header, 8, 8)?, number(header, 32, 8)?);
    let mut path = vec![
        0;
        usize::try_from(length)
            .ok()
            .filter(|&length| length <= 4096)?
    ];
    file.read_exact_at(&mut path, at).ok()?;
    path.retain(|&byte| byte != 0);
    Some(OsString::from_vec(path).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_needs_its_loader() {
        let own = std::env::current_exe().expect("this program");
        let needed = needed_by(&own);
        assert_eq!(needed.execute[0], own);
        // What the system has mapped into this process is the oracle.
        let maps = std::fs::read_to_string("/proc/self/maps").expect("the maps");
        let loader = needed.execute[1].canonicalize().expect("the loader");
        assert!(maps.contains(&loader.display().to_string()), "{needed:?}");
    }

    #[test]
    fn a_script_needs_its_interpreter() {
        assert_eq!(of_script(b""), Vec::<PathBuf>::new());
        assert_eq!(of_script(b" /bin/sh -e\necho"), [PathBuf::from("/bin/sh")]);
        let found = of_script(b"/usr/bin/env -S sh\n");
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[1].ends_with("sh") && found[1].is_file());
    }
}
