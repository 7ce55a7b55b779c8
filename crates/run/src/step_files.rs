//! Names of the files with the grids of a load step.

/// Names of the grids of a load step, each in one file or in several pieces.
pub fn names(number: usize, pieces: usize) -> [String; 2] {
    let end = if pieces > 1 { "pvtu" } else { "vtu" };
    ["rock", "fractures"].map(|kind| format!("{kind}_{number:04}.{end}"))
}

/// Names of the pieces of a grid; none if it stands in one file.
pub fn parts(name: &str, pieces: usize) -> Vec<String> {
    match name.strip_suffix(".pvtu") {
        Some(name) => (0..pieces)
            .map(|piece| format!("{name}_{piece:04}.vtu"))
            .collect(),
        None => Vec::new(),
    }
}
