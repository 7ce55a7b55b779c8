//! What a file is that somebody gives as a scene.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use kluft_defect::ordinary_text;
use kluft_mesh::Defect;

use crate::printing::shell_path;

/// Bytes that tell what a file is.
const HEAD: u64 = 4096;

/// Files by the ends of their names, small letters: what they are.
const KINDS: [(&[&str], FileKind); 7] = [
    (&EXODUS, FileKind::OtherMesh),
    (&["msh"], FileKind::Mesh),
    (
        &[
            "geo",
            "geo_unrolled",
            "geo_opt",
            "step",
            "stp",
            "brep",
            "iges",
            "igs",
        ],
        FileKind::Geometry,
    ),
    (
        &["vtu", "vtk", "vtp", "vts", "vtr", "pvtu", "pvd"],
        FileKind::Vtk,
    ),
    (
        &["inp", "med", "unv", "stl", "bdf", "obj", "ply", "mesh"],
        FileKind::OtherMesh,
    ),
    (&["csv", "dat"], FileKind::List),
    (&["json"], FileKind::Json),
];

/// Ends of the names of other meshes that `kluft import` reads, beside [`EXODUS`].
const IMPORTED: [&str; 2] = ["inp", "vtu"];
/// Ends of the names of Exodus files.
pub const EXODUS: [&str; 5] = ["e", "exo", "ex2", "exii", "g"];

/// What a file is, where it is no scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FileKind {
    Folder,
    Mesh,
    Geometry,
    Vtk,
    OtherMesh,
    List,
    Json,
    Binary,
}

/// Refuses in one sentence a file that is no scene, before it is read as one. What cannot be looked
/// at twice, such as a pipe, passes.
///
/// # Errors
/// What the file is, and what can be done with it.
pub fn expect_scene(path: &Path) -> Result<(), Defect> {
    match kind_of(path) {
        None => Ok(()),
        Some(kind) => Err(refusal(kind, path)),
    }
}

/// The scene that a path means: the file itself, or the scene in a folder.
///
/// # Errors
/// A folder with no scene, or with several of which none is called `scene.toml`.
pub fn scene_at(path: &Path) -> Result<PathBuf, Defect> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let usual = path.join("scene.toml");
    if usual.is_file() {
        return Ok(usual);
    }
    let mut found = scenes_in(path);
    match (found.pop(), found.is_empty()) {
        (Some(only), true) => Ok(only),
        (None, _) => Err(refusal(FileKind::Folder, path)),
        (Some(last), false) => {
            found.push(last);
            let names: Vec<String> = found
                .iter()
                .map(|file| file.display().to_string())
                .collect();
            let remedy = format!("give one of {}", names.join(", "));
            let problem = "this folder holds several scenes";
            Err(Defect::new(path.display().to_string(), problem, remedy))
        }
    }
}

/// The scenes in a folder, in the order of their names.
fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path());
    let mut found: Vec<PathBuf> = files
        .filter(|file| has_ending(file, &["toml"]))
        .filter(|file| is_scene(&ordinary_text(file).unwrap_or_default()))
        .collect();
    found.sort();
    found
}

/// Whether a text has the section `mesh` of a scene; one that is no TOML, whether it seems so: who
/// reads it then says what is wrong.
fn is_scene(text: &str) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Ok(table) = text.parse::<toml::Table>() else {
        let mut lines = text.lines().map(str::trim_start);
        return lines.any(|line| line.starts_with("[mesh") || line.starts_with("mesh"));
    };
    let mesh = table.get("mesh").and_then(toml::Value::as_table);
    mesh.is_some_and(|mesh| !is_description(&table, mesh))
}

/// Whether it is a description for `kluft network`: its section `mesh` has sizes, and no mesh.
fn is_description(table: &toml::Table, mesh: &toml::Table) -> bool {
    let has_mesh = mesh.contains_key("file") || mesh.contains_key("geometry");
    !has_mesh && (mesh.contains_key("h") || table.contains_key("fracture_set"))
}

/// Whether a file of this name would be taken for something else than a scene.
pub fn is_named_otherwise(path: &Path) -> bool {
    of_name(path).is_some()
}

/// Whether a file is a geometry of gmsh, by its name.
pub fn is_geometry(path: &Path) -> bool {
    of_name(path) == Some(FileKind::Geometry)
}

/// Whether a file is a mesh of gmsh, by its name or by its first line.
pub fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "msh") || kind_of(path) == Some(FileKind::Mesh)
}

fn kind_of(path: &Path) -> Option<FileKind> {
    let metadata = std::fs::metadata(path).ok()?;
    if metadata.is_dir() {
        return Some(FileKind::Folder);
    }
    if !metadata.is_file() {
        return None;
    }
    let mut head = Vec::new();
    File::open(path)
        .ok()?
        .take(HEAD)
        .read_to_end(&mut head)
        .ok()?;
    of_content(&head).or_else(|| of_name(path))
}

fn of_content(head: &[u8]) -> Option<FileKind> {
    let text = head.trim_ascii_start();
    let begins = |words: &[&str]| words.iter().any(|word| text.starts_with(word.as_bytes()));
    if begins(&["$MeshFormat", "$NOD", "$Comments"]) {
        Some(FileKind::Mesh)
    } else if begins(&["<?xml", "<VTKFile", "# vtk DataFile"]) {
        Some(FileKind::Vtk)
    } else if head.contains(&0) {
        Some(FileKind::Binary)
    } else {
        None
    }
}

fn of_name(path: &Path) -> Option<FileKind> {
    let kinds = KINDS.iter();
    let mut kinds = kinds.filter(|(ends, _)| has_ending(path, ends));
    kinds.next().map(|(_, kind)| *kind)
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let own = path.extension().and_then(|ending| ending.to_str());
    own.is_some_and(|own| {
        endings
            .iter()
            .any(|ending| own.eq_ignore_ascii_case(ending))
    })
}

fn refusal(kind: FileKind, path: &Path) -> Defect {
    let (shown, word) = (path.display(), shell_path(path));
    let name = path.file_name().unwrap_or_default().display();
    let convert = match has_ending(path, &IMPORTED) || has_ending(path, &EXODUS) {
        true => format!("`kluft import {word} -o DIR` makes a mesh and a scene of it"),
        false => {
            "convert a mesh for gmsh first (`meshio convert FILE mesh.msh`), and name it in a \
                  scene: `[mesh] file = \"mesh.msh\"`"
                .to_owned()
        }
    };
    let (what, remedy) = match kind {
        FileKind::Folder => (
            "a folder without a scene",
            "give a scene file, or make one: `kluft init` writes it for a mesh or a geometry"
                .into(),
        ),
        FileKind::Mesh => (
            "a mesh of gmsh",
            format!(
                "`kluft inspect {word}` looks at it; `kluft init {word}` writes a scene with `[mesh] file = \"{name}\"`"
            ),
        ),
        FileKind::Geometry => (
            "a geometry",
            format!("`kluft init {word}` writes a scene with `[mesh] geometry = \"{name}\"`"),
        ),
        FileKind::Vtk => (
            "a file of VTK",
            format!("ParaView opens results; {convert}"),
        ),
        FileKind::OtherMesh => ("a mesh of another program", convert),
        FileKind::List => (
            "a list or a table",
            format!(
                "`kluft network {word} -o DIR` makes a geometry and a scene from a list of fractures"
            ),
        ),
        FileKind::Json => ("JSON", "give the scene (TOML) that it came from".to_owned()),
        FileKind::Binary => (
            "binary data",
            "give a scene: TOML, saved as UTF-8 text".to_owned(),
        ),
    };
    Defect::new(
        shown.to_string(),
        format!("this is {what}, not a scene"),
        remedy,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_tells_more_than_names() {
        assert_eq!(of_content(b"\n$MeshFormat\n4.1"), Some(FileKind::Mesh));
        assert_eq!(of_content(b"<VTKFile type="), Some(FileKind::Vtk));
        assert_eq!(of_content(b"\x7fELF\0\0"), Some(FileKind::Binary));
        assert_eq!(of_content(b"[mesh]\nfile = 'a.msh'\n"), None);
        assert_eq!(of_name(Path::new("a.GEO")), Some(FileKind::Geometry));
        assert_eq!(of_name(Path::new("scene.toml")), None);
        assert_eq!(of_name(Path::new("scene")), None);
    }

    #[test]
    fn every_text_with_a_mesh_is_a_scene() {
        for text in [
            "[mesh]\nfile = 'a.msh'\n",
            "mesh = { file = 'a.msh' }\n[fracture]\n",
            "\u{feff}mesh.geometry = 'a.geo'\n",
            "[mesh]\ngeometry = 'a.geo'\nh = 1\n",
            "[mesh]\n",
            "title = \n [mesh]\n",
            "title = \nmesh = {\n",
        ] {
            assert!(is_scene(text), "{text:?}");
        }
        for text in [
            "",
            "meshes = 'many'\n",
            "mesh = 'a.msh'\n",
            "[package]\nname = 'a'\n",
            "[mesh]\nh = 1\n",
            "[mesh]\nsmall = 0.1\n[fracture_set.a]\n",
            "title = \n[rock]\n",
        ] {
            assert!(!is_scene(text), "{text:?}");
        }
    }

    #[test]
    fn the_only_scene_of_a_folder_is_found_whatever_its_ending() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("Joint.TOML");
        std::fs::write(&file, "\u{feff}mesh = { file = 'a.msh' }\n").expect("written");
        std::fs::write(folder.path().join("network.toml"), "[mesh]\nh = 1\n").expect("written");
        assert_eq!(scene_at(folder.path()), Ok(file));
    }

    #[test]
    fn commands_that_refusals_name_are_for_a_shell() {
        for (file, command) in [
            ("my mesh.msh", "`kluft inspect 'my mesh.msh'`"),
            ("my mesh.msh", "`kluft init 'my mesh.msh'`"),
            ("my rock.geo", "`kluft init 'my rock.geo'`"),
            ("my list.csv", "`kluft network 'my list.csv' -o DIR`"),
            ("my grid.inp", "`kluft import 'my grid.inp' -o DIR`"),
        ] {
            let path = Path::new(file);
            let defect = refusal(of_name(path).expect("a kind"), path);
            assert!(defect.remedy.contains(command), "{}", defect.remedy);
            assert_eq!(defect.place, file);
        }
    }
}
