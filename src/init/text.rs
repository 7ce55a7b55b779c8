//! The text of a scene that a mesh suggests.

use std::path::PathBuf;

use kluft_keys::{key_text, quoted, section_head};
use kluft_mesh::{FractureSurvey, Mesh, Survey};

use super::conditions::conditions;
use super::lines::Lines;

/// Most constants of a geometry that are shown.
const CONSTANTS: usize = 3;

/// Where a mesh comes from.
pub struct Source {
    /// Its path, as the scene names it.
    pub path: PathBuf,
    /// Whether gmsh makes the mesh from it.
    pub is_geometry: bool,
    /// What a scene may set of a geometry, with the defaults.
    pub constants: Vec<(String, f64)>,
}

/// A scene that is suggested.
pub struct Suggested {
    /// The scene.
    pub text: String,
    /// Whether enough was found that holds the body for a run to begin.
    pub is_held: bool,
}

/// The scene.
pub fn scene(source: &Source, mesh: &Mesh, survey: &Survey) -> Suggested {
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
    let is_held = conditions(&mut out, mesh);
    Suggested {
        text: out.text,
        is_held,
    }
}

fn mesh_section(out: &mut Lines, source: &Source, mesh: &Mesh) {
    let strain = match mesh.is_plane() {
        true => "a plane, in plane strain: ",
        false => "",
    };
    let cells = format!(
        "{strain}{} cells, {} fracture facets",
        mesh.cells.len(),
        mesh.facets.elements.len()
    );
    out.section("[mesh]", &cells);
    let path = quoted(&source.path.to_string_lossy());
    if !source.is_geometry {
        return out.add(&format!("file = {path}"), "");
    }
    out.add(&format!("geometry = {path}"), "");
    if mesh.is_plane() {
        out.add("dimension = 2", "the geometry has no volumes");
    }
    parameters(out, &source.constants);
}

/// What a scene may set of a geometry, with the defaults.
fn parameters(out: &mut Lines, constants: &[(String, f64)]) {
    if constants.is_empty() {
        return;
    }
    let shown = constants.iter().take(CONSTANTS);
    let shown: Vec<String> = shown
        .map(|(name, value)| format!("{} = {value:?}", key_text(name)))
        .collect();
    let line = format!("# parameters = {{ {} }}", shown.join(", "));
    let comment = match constants.len() > CONSTANTS {
        true => "the first of its DefineConstant names, with their defaults",
        false => "its DefineConstant names, with their defaults",
    };
    out.add(&line, comment);
}

/// What gmsh calls the groups of rock and of fractures.
fn kinds(mesh: &Mesh) -> [&'static str; 2] {
    match mesh.is_plane() {
        true => ["surface", "curve"],
        false => ["volume", "surface"],
    }
}

/// One section for each volume that has a name, or one for all.
fn rocks(out: &mut Lines, mesh: &Mesh) {
    let [kind, _] = kinds(mesh);
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
            &format!("{nameless} cells of no physical {kind}"),
        );
        elasticity(out);
    }
    for (group, cells) in volumes {
        let head = section_head("rock", &group.name);
        out.section(&head, &format!("a physical {kind} of {cells} cells"));
        elasticity(out);
    }
}

fn elasticity(out: &mut Lines) {
    out.add("young_modulus = \"50 GPa\"", "assumed");
    out.add("poisson_ratio = 0.25", "assumed");
}

fn fractures(out: &mut Lines, mesh: &Mesh, survey: &Survey) {
    for (name, found) in mesh.fractures.iter().zip(&survey.fractures) {
        let what = format!("rock on both sides; {}", extent(mesh, found));
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
        let [_, kind] = kinds(mesh);
        let text = format!("# No physical {kind} has rock on both sides: there is no fracture.");
        out.section(&text, "");
    }
}

/// How large a fracture is, and how it lies; in the plane the area of one metre is a length.
fn extent(mesh: &Mesh, found: &FractureSurvey) -> String {
    let mean = &found.orientation;
    match (mesh.is_plane(), found.closed) {
        (true, _) => format!("{:.4} m long", found.area),
        (false, true) => format!("{:.4} m2, closed", found.area),
        (false, false) => format!(
            "{:.4} m2, dip {:.0}°, dip direction {:.0}°",
            found.area, mean.dip, mean.dip_direction
        ),
    }
}
