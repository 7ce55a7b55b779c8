//! From a mesh of another program to a gmsh mesh and a scene.

mod exodus;
mod extent;
mod faces;
mod laws;
mod loads;
mod parameters;
mod project;
mod said;
mod surfaces;
mod times;
mod tree;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use kluft_defect::ordinary_text;
use kluft_io::import::{Imported, parse_abaqus, read_grid};
use kluft_io::{ClaimedFolder, sync_folder, write_atomically, write_msh};
use kluft_keys::{quoted, section_head};
use kluft_mesh::{Defect, Draft, Faces, Group};

use crate::failure::Failure;
use crate::input::EXODUS;
use crate::printing::shell_path;
use crate::report::{Report, Verbosity};

use project::{Project, read_project};

const SCENE: &str = "scene.toml";
/// First line of a scene that may be written again.
const MADE: &str = "# Made by `kluft import`; remove this line to protect the file.";

const ROCK: &str = "
[rock.default]                    # assumed: granite
young_modulus = 50e9
poisson_ratio = 0.25
";

const LAW: &str = "                                  # assumed
aperture = 1e-3
normal_stiffness = 2e10
shear_stiffness = 1e10
closure = \"logarithmic\"
";

/// How to import a mesh.
#[derive(Debug, Clone)]
pub struct ImportOptions {
    /// Folder for mesh and scene.
    pub out: PathBuf,
    /// How much to tell.
    pub verbosity: Verbosity,
}

/// Makes `NAME.msh` and `scene.toml` of a mesh that another program has written.
///
/// # Errors
/// Every defect of the file, and files that cannot be written.
pub fn import(file: &Path, options: &ImportOptions) -> Result<(), Failure> {
    let report = Report::new(options.verbosity);
    let Read { imported, sections } = read(file)?;
    let Imported { draft, notes } = imported;
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let mesh = format!("{stem}.msh");
    report.entry("import", &file.display().to_string());
    for note in &notes {
        report.entry("decided", note);
    }
    let head = format!(
        "{MADE}\ntitle = {}\n\n[mesh]\nfile = {}\n",
        quoted(&stem),
        quoted(&mesh)
    );
    let text = head + &sections.unwrap_or_else(|| assumed(&draft));
    let mut folder = ClaimedFolder::claim(&options.out)?;
    protect(&folder.path().join(SCENE))?;
    let names = [mesh.as_str(), SCENE];
    folder.protect(names.into_iter(), &[file])?;
    folder.list(names.into_iter())?;
    folder.write(&mesh, |path| write_msh(path, &draft))?;
    folder.write(SCENE, |path| {
        write_atomically(path, |out| out.write_all(text.as_bytes()))
    })?;
    sync_folder(folder.path())?;
    let scene = options.out.join(SCENE);
    report.entry("next", &format!("kluft inspect {}", shell_path(&scene)));
    Ok(())
}

/// A mesh, and the sections of its scene, if its file says them.
struct Read {
    imported: Imported,
    sections: Option<String>,
}

fn read(file: &Path) -> Result<Read, Vec<Defect>> {
    let ending = file.extension().and_then(|ending| ending.to_str());
    if ending.is_some_and(|ending| ending.eq_ignore_ascii_case("prj")) {
        let Project { imported, scene } = read_project(file)?;
        return Ok(Read {
            imported,
            sections: Some(scene),
        });
    }
    let imported = read_mesh(file)?;
    let Draft { cells, facets, .. } = &imported.draft;
    if cells.elements.is_empty() && facets.elements.is_empty() {
        let problem = "it has no cells and no surfaces";
        let remedy = "give a mesh of tetrahedra, hexahedra, wedges or pyramids, or of the plane";
        return Err(vec![Defect::new(
            file.display().to_string(),
            problem,
            remedy,
        )]);
    }
    Ok(Read {
        imported,
        sections: None,
    })
}

fn read_mesh(file: &Path) -> Result<Imported, Vec<Defect>> {
    let place = file.display().to_string();
    let ending = file.extension().and_then(|ending| ending.to_str());
    match ending.map(str::to_lowercase).as_deref() {
        Some("inp") => {
            let text = ordinary_text(file).map_err(|error| {
                let problem = format!("cannot be read: {error}");
                vec![Defect::new(
                    &place,
                    problem,
                    "give the path of an Abaqus input file",
                )]
            })?;
            parse_abaqus(&text, &place)
        }
        Some("vtu") => read_grid(file),
        Some(ending) if EXODUS.contains(&ending) => exodus::read_exodus(file),
        _ => Err(vec![Defect::new(
            place,
            "the name ends neither in .inp (Abaqus), nor in .vtu (VTK), nor in .e (Exodus), nor in \
             .prj (OpenGeoSys)",
            "let meshio convert other formats to .vtu or .inp: meshio convert FILE FILE.vtu; gmsh \
             meshes (.msh) need no import",
        )]),
    }
}

/// The sections of a scene of which only the mesh is known.
fn assumed(draft: &Draft) -> String {
    let is_plane = draft.is_plane();
    let solid = match is_plane {
        true => draft.clone().extruded(),
        false => draft.clone(),
    };
    let inner = Faces::of(&solid).inner_surfaces(&solid);
    let mut out = ROCK.to_owned();
    let surfaces = || {
        solid
            .groups
            .iter()
            .zip(&inner)
            .filter(|(group, _)| group.dimension == 2)
    };
    for (group, _) in surfaces().filter(|(_, inner)| **inner) {
        let _ = write!(out, "\n{}{LAW}", section_head("fracture", &group.name));
    }
    let outer: Vec<&Group> = surfaces()
        .filter(|(_, inner)| !**inner)
        .map(|(g, _)| g)
        .collect();
    if !outer.is_empty() {
        let names: Vec<String> = outer
            .iter()
            .map(|group| format!("`{}`", group.name))
            .collect();
        let _ = write!(
            out,
            "\n# Surfaces on the outside, free: {}\n",
            names.join(", ")
        );
    }
    let [up, sides] = match is_plane {
        true => ["y", "x"],
        false => ["z", "xy"],
    };
    let _ = write!(
        out,
        "\n[boundary.assumed-top]            # assumed: 10 MPa from above, rollers below and at sides\n\
         where = \"{up} = max\"\npressure = 10e6\n\n[boundary.assumed-bottom]\n\
         where = \"{up} = min\"\nsymmetry = true\n"
    );
    for axis in sides.chars() {
        let _ = write!(
            out,
            "\n[boundary.assumed-side-{axis}]\nwhere = \"{axis} = min\"\nsymmetry = true\n"
        );
    }
    out
}

/// A scene that somebody wrote is not ours to replace.
fn protect(scene: &Path) -> Result<(), Defect> {
    match ordinary_text(scene) {
        Ok(text) if !text.starts_with(MADE) => Err(Defect::new(
            scene.display().to_string(),
            "there is a scene that this command has not made, or that was protected",
            "name another folder with -o DIR, or remove the scene",
        )),
        _ => Ok(()),
    }
}
