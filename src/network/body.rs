//! The geometry of the rock, as the geometry of the network includes it.

use std::fs;
use std::path::{Component, Path, PathBuf};

use kluft_mesh::Defect;

/// The path of a geometry from a folder, as a text of gmsh.
///
/// # Errors
/// A path that is not there, or that gmsh cannot write in quotes.
pub(super) fn included(body: &Path, folder: &Path) -> Result<String, Defect> {
    let place = body.display().to_string();
    let whole = |path: &Path| {
        let found = fs::canonicalize(path);
        found.map_err(|error| Defect::new(&place, error.to_string(), "give a path that is there"))
    };
    let relative = from_folder(&whole(body)?, &whole(folder)?);
    let text = relative.to_str().filter(|text| !text.contains(['"', '\\']));
    let is_plain = |text: &&str| !text.chars().any(char::is_control);
    text.filter(is_plain).map(str::to_owned).ok_or_else(|| {
        let problem = "gmsh cannot read a path like this";
        Defect::new(&place, problem, "rename the file or its folder")
    })
}

/// How a path is reached from a folder; both begin at the root.
fn from_folder(path: &Path, folder: &Path) -> PathBuf {
    let pairs = path.components().zip(folder.components());
    let common = pairs.take_while(|(one, other)| one == other).count();
    let up = folder.components().skip(common);
    up.map(|_| Component::ParentDir)
        .chain(path.components().skip(common))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_goes_up_to_what_is_common_and_down_from_there() {
        let from = |path: &str, folder: &str| from_folder(Path::new(path), Path::new(folder));
        assert_eq!(from("/a/b.geo", "/a/c/d"), Path::new("../../b.geo"));
        assert_eq!(from("/a/b/c.geo", "/a"), Path::new("b/c.geo"));
    }
}
