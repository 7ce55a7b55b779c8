//! The text of a scene that a mesh suggests.

use std::fmt::Write;
use std::path::PathBuf;

use glam::DVec3;
use kluft_keys::{quoted, section_head};
use kluft_mesh::{Mesh, Survey};

use super::supports::{Assumed, assumed};

/// Column in which comments begin.
const COMMENT: usize = 34;

/// Where a mesh comes from.
pub struct Source {
    /// Its path, as the scene names it.
    pub path: PathBuf,
    /// Whether gmsh makes the mesh from it.
    pub is_geometry: bool,
}

/// The scene.
pub fn scene(source: &Source, mesh: &Mesh, survey: &Survey) -> String {
    let mut out = Lines::default();
    let name = source.path.file_stem().unwrap_or_default();
    out.add(
        "# Made by `kluft init`. Values marked `assumed` are those of some granite with stiff",
        "",
    );
    out.add(
        "# joints: put in your own. `kluft explain KEY` says what a key means.",
        "",
    );
    out.add(&format!("title = {}", quoted(&name.to_string_lossy())), "");
    mesh_section(&mut out, source, mesh);
    rocks(&mut out, mesh);
    fractures(&mut out, mesh, survey);
    boundaries(&mut out, mesh);
    out.text
}

#[derive(Default)]
struct Lines {
    text: String,
}

impl Lines {
    /// Adds a line with a comment, which may be empty.
    fn add(&mut self, line: &str, comment: &str) {
        let _ = match comment {
            "" => writeln!(self.text, "{line}"),
            comment => writeln!(
                self.text,
                "{line:<COMMENT$}# {}",
                crate::printing::one_line(comment)
            ),
        };
    }

    fn section(&mut self, head: &str, comment: &str) {
        self.text.push('\n');
        self.add(head, comment);
    }
}

fn mesh_section(out: &mut Lines, source: &Source, mesh: &Mesh) {
    let cells = format!(
        "{} cells, {} fracture facets",
        mesh.cells.len(),
        mesh.facets.elements.len()
    );
    out.section("[mesh]", &cells);
    let key = if source.is_geometry {
        "geometry"
    } else {
        "file"
    };
    let path = quoted(&source.path.to_string_lossy());
    out.add(&format!("{key} = {path}"), "");
    if source.is_geometry {
        out.add(
            "# parameters = { h = 0.1 }",
            "values of its DefineConstant names",
        );
    }
}

/// One section for each volume that has a name, or one for all.
fn rocks(out: &mut Lines, mesh: &Mesh) {
    let mut cells = vec![0; mesh.groups.len()];
    let mut nameless = 0;
    for &set in &mesh.cell_group_set {
        let groups = &mesh.group_sets[set as usize];
        groups.iter().for_each(|&group| cells[group] += 1);
        nameless += usize::from(groups.is_empty());
    }
    let groups = mesh.groups.iter().zip(cells);
    let volumes: Vec<_> = groups
        .filter(|(group, cells)| group.dimension == 3 && *cells > 0)
        .collect();
    if volumes.is_empty() || nameless > 0 {
        out.section(
            "[rock.default]",
            &format!("{nameless} cells of no physical volume"),
        );
        elasticity(out);
    }
    for (group, cells) in volumes {
        let head = section_head("rock", &group.name);
        out.section(&head, &format!("a physical volume of {cells} cells"));
        elasticity(out);
    }
}

fn elasticity(out: &mut Lines) {
    out.add("young_modulus = \"50 GPa\"", "assumed");
    out.add("poisson_ratio = 0.25", "assumed");
}

fn fractures(out: &mut Lines, mesh: &Mesh, survey: &Survey) {
    for (name, found) in mesh.fractures.iter().zip(&survey.fractures) {
        let lies = match found.closed {
            true => "closed".to_owned(),
            false => {
                let mean = &found.orientation;
                format!(
                    "dip {:.0}°, dip direction {:.0}°",
                    mean.dip, mean.dip_direction
                )
            }
        };
        let what = format!("rock on both sides; {:.4} m2, {lies}", found.area);
        out.section(&section_head("fracture", name), &what);
        out.add("aperture = \"0.1 mm\"", "assumed");
        out.add("normal_stiffness = \"100 GPa/m\"", "assumed");
        out.add("shear_stiffness = \"50 GPa/m\"", "assumed");
        out.add(
            "closure = \"logarithmic\"",
            "assumed: stiffer as it closes, never overlaps",
        );
    }
    if mesh.fractures.is_empty() {
        out.section(
            "# No physical surface has rock on both sides: there is no fracture.",
            "",
        );
    }
}

fn boundaries(out: &mut Lines, mesh: &Mesh) {
    let assumed = assumed(mesh);
    for (part, assumed) in mesh.boundaries.iter().zip(&assumed) {
        let head = section_head("boundary", &part.name);
        match assumed {
            Assumed::Roller(axis) => {
                out.section(
                    &head,
                    &format!("assumed: a roller at the lower end of {axis}"),
                );
                out.add("symmetry = true", "");
            }
            Assumed::Pressed => {
                out.section(&head, "the top");
                out.add("pressure = \"10 MPa\"", "assumed");
            }
            Assumed::Free(why) => {
                out.section(&format!("# {head}"), &format!("free: {why}"));
                out.add(
                    "# pressure = \"1 MPa\"",
                    "or symmetry = true, displacement = { x = 0 }",
                );
            }
        }
    }
    let misses = |wanted: &dyn Fn(&Assumed) -> bool| !assumed.iter().any(wanted);
    let axes = ["x", "y", "z"].into_iter();
    let loose: Vec<&str> = axes
        .filter(|&axis| misses(&|one| *one == Assumed::Roller(axis)))
        .collect();
    match loose[..] {
        [] => {}
        [axis] => fixed_point(out, mesh, axis),
        _ => {
            let text = "# Too little was found that holds the body: give surfaces above";
            out.section(text, "");
            out.add("# `symmetry = true`, or add [[fixed_point]] sections.", "");
        }
    }
    if misses(&|one| *one == Assumed::Pressed) {
        out.section("# No flat top was found: give a surface above a pressure, or let gravity act (`kluft explain gravity`).", "");
    }
}

/// Holds a node at the lowest corner of the body along an axis; rollers along the others keep it
/// from turning.
fn fixed_point(out: &mut Lines, mesh: &Mesh, axis: &str) {
    let (low, _) = mesh.bounds();
    let distance = |node: &DVec3| node.distance_squared(low);
    let nodes = mesh.nodes.iter();
    let nearest = nodes.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let Some(DVec3 { x, y, z }) = nearest else {
        return;
    };
    let why = format!("assumed: no roller holds the body along {axis}");
    out.section("[[fixed_point]]", &why);
    out.add(&format!("at = [{x:?}, {y:?}, {z:?}]"), "");
    out.add(&format!("displacement = {{ {axis} = 0.0 }}"), "");
}
