//! Reads the sections of a scene.

use std::path::{Path, PathBuf};

use kluft_defect::ordinary_text;
use kluft_keys::{Document, Range};
use kluft_mesh::Defect;
use lie_core::FacetQuadrature;

use crate::bisected_curves::refuse_bisected_curves;
use crate::conditions::{BodyEntry, FixedPointEntry, read_body, read_boundary, read_fixed_point};
use crate::fluid::{FluidEntry, SourceEntry, fluid_use, read_fluid, read_source};
use crate::fracture::read_placed_fracture;
use crate::initial_stress::read_initial_stress;
use crate::load::{Clock, read_timetable, refuse_beside_stages};
use crate::oracle;
use crate::probe::read_probe;
use crate::reader::{Section, Source};
use crate::rock::read_rock;
use crate::scene::{Adapt, AdaptBy, Isolated, MeshSource, Named, Scene, SolverEntry};
use crate::setting::Setting;
use crate::strength::{StrengthReduction, read_strength_reduction};

impl Scene {
    /// Reads a scene file; paths in it are relative to its folder.
    ///
    /// # Errors
    /// Every defect of the file, each with its line and a remedy.
    pub fn read(path: &Path) -> Result<Self, Vec<Defect>> {
        Self::parse_file(path, &Self::text(path)?)
    }

    /// The text of a scene file.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn text(path: &Path) -> Result<String, Vec<Defect>> {
        ordinary_text(path).map_err(|error| {
            let remedy = match error.kind() {
                std::io::ErrorKind::InvalidData => "save the file as UTF-8 text",
                _ => "give the path of a scene file, e.g. geometries/inclined-joint/scene.toml",
            };
            vec![Defect::new(
                path.display().to_string(),
                format!("the scene cannot be read: {error}"),
                remedy,
            )]
        })
    }

    /// Reads a scene from the text of its file.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn parse_file(path: &Path, text: &str) -> Result<Self, Vec<Defect>> {
        let folder = path.parent().unwrap_or(Path::new("."));
        Self::parse(text, &path.display().to_string(), folder)
    }

    /// Reads a scene from its text; `name` is for messages, `folder` is where its paths start.
    ///
    /// # Errors
    /// Every defect of the text, each with its line and a remedy.
    pub fn parse(text: &str, name: &str, folder: &Path) -> Result<Self, Vec<Defect>> {
        let source = Source::new(name, text, Document::Scene).in_folder(folder);
        let table = source.parse();
        let scene = table.as_ref().and_then(|table| {
            let root = Section::root(&source, table.get_ref());
            let scene = read_scene(&source, &root, folder);
            root.finish();
            scene
        });
        let defects = source.into_defects();
        match scene {
            Some(scene) if defects.is_empty() => Ok(scene),
            _ => Err(defects),
        }
    }
}

/// Finds the defects of everything in a scene that speaks of neither mesh nor fractures; another
/// file may hold those sections for a scene to be made from it. Returns what they mean for its
/// fractures.
pub fn check_conditions(source: &Source<'_>, root: &Section<'_, '_>) -> Setting {
    let (_, clock) = read_timetable(root);
    let setting = Setting {
        clock,
        fluid: fluid_use(root),
    };
    if setting.is_rigid() {
        refuse_in_rigid_rock(root, &["fixed_point", "initial_stress"]);
        refuse_in_rigid_solver(root);
    }
    root.text("title");
    for (name, section) in root.named_sections("rock") {
        entry(source, name, section, |section| read_rock(section, setting));
    }
    for (name, section) in root.named_sections("boundary") {
        entry(source, name, section, |section| {
            read_boundary(section, setting)
        });
    }
    for section in root.listed_sections("fixed_point") {
        entry(source, String::new(), section, |section| {
            read_fixed_point(section, clock)
        });
    }
    let body = read_body(root, clock);
    read_flow(root, &body);
    read_sources(source, root, setting);
    root.section("initial_stress").map(read_initial_stress);
    read_solver(root);
    setting
}

fn read_scene(source: &Source<'_>, root: &Section<'_, '_>, folder: &Path) -> Option<Scene> {
    let named = |key: &'static str| root.named_sections(key).into_iter();
    let (timetable, clock) = read_timetable(root);
    let setting = Setting {
        clock,
        fluid: fluid_use(root),
    };
    let title = root.text("title").unwrap_or("untitled").to_owned();
    let mut mesh = read_mesh_section(root, folder);
    if timetable.has_stages() {
        settle_stages(root, &mut mesh);
    }
    match setting.is_rigid() {
        true => refuse_in_rigid_scene(root),
        false => root.require("rock"),
    }
    let rock = |(name, s)| entry(source, name, s, |s| read_rock(s, setting));
    let fracture = |(name, s): (String, _)| {
        let called = name.clone();
        entry(source, name, s, |s| {
            read_placed_fracture(s, &called, setting)
        })
    };
    let fractures = named("fracture").filter_map(fracture).collect();
    let boundary = |(name, s)| entry(source, name, s, |s| read_boundary(s, setting));
    let boundaries = named("boundary").filter_map(boundary).collect();
    let body = read_body(root, clock);
    // Of `kluft study`, which reads it.
    root.section("study");
    let probe = |(name, s)| entry(source, name, s, |s| read_probe(s, setting));
    let oracle = |(name, s)| entry(source, name, s, oracle::read);
    let flowing = read_flow(root, &body);
    refuse_bisected_curves(root, mesh.source.as_ref());
    Some(Scene {
        oracles: named("oracle").filter_map(oracle).collect(),
        probes: named("probe").filter_map(probe).collect(),
        fluid: flowing.fluid,
        isolated: flowing.isolated,
        equivalent_permeability: flowing.equivalent_permeability,
        body,
        sources: read_sources(source, root, setting),
        fixed_points: read_fixed_points(source, root, clock),
        initial_stress: root.section("initial_stress").map(read_initial_stress),
        timetable,
        solver: read_solver(root),
        strength_reduction: read_strength(root),
        silenced: silenced(root),
        title,
        rocks: named("rock").filter_map(rock).collect(),
        fractures,
        boundaries,
        scale: mesh.scale,
        quarter_points: mesh.quarter_points,
        weld: mesh.weld,
        refine: mesh.refine,
        mesh: mesh.source?,
        in_plane: source.take_defects_in_plane(),
        warnings: source.take_warnings(),
    })
}

/// Crack fronts come and go with volumes, and nodes stay where they are.
fn settle_stages(root: &Section<'_, '_>, mesh: &mut MeshSection) {
    refuse_beside_stages(root);
    mesh.quarter_points = false;
}

fn read_strength(root: &Section<'_, '_>) -> Option<StrengthReduction> {
    let section = root.section("strength_reduction");
    section.map(read_strength_reduction)
}

fn silenced(root: &Section<'_, '_>) -> Vec<&'static str> {
    let section = root.section("warnings");
    section.map_or_else(Vec::new, read_silenced)
}

/// What a scene says of its mesh.
struct MeshSection {
    source: Option<MeshSource>,
    scale: f64,
    quarter_points: bool,
    weld: bool,
    refine: u32,
}

fn read_mesh_section(root: &Section<'_, '_>, folder: &Path) -> MeshSection {
    root.require("mesh");
    let section = root.section("mesh");
    let flag = |key| section.as_ref().and_then(|section| section.flag(key));
    let refine = section
        .as_ref()
        .and_then(|section| section.number("refine"));
    let refine = refine.map_or(0, |times| times as u32);
    let scale = section.as_ref().and_then(|section| section.number("scale"));
    MeshSection {
        scale: scale.unwrap_or(1.0),
        quarter_points: flag("quarter_points").unwrap_or(true),
        weld: flag("weld").unwrap_or(false),
        refine,
        source: section.and_then(|section| read_mesh(section, folder, refine)),
    }
}

fn entry<'a, 'i, T>(
    source: &Source<'i>,
    name: String,
    section: Section<'a, 'i>,
    read: impl Fn(&Section<'a, 'i>) -> Option<T>,
) -> Option<Named<T>> {
    let place = format!("{} {}", source.place(&section.at), section.title);
    let value = read(&section);
    section.finish();
    value.map(|value| Named { name, place, value })
}

fn read_mesh(section: Section<'_, '_>, folder: &Path, refine: u32) -> Option<MeshSource> {
    let geometry = read_path(&section, "geometry", folder);
    let file = read_path(&section, "file", folder);
    let parameters = section.free_numbers("parameters");
    let mut order = section.number_in("order", Range::Positive);
    if let Some(wrong) = order.take_if(|order| *order != 1.0 && *order != 2.0) {
        section.refuse(
            "order",
            format!("elements of order {wrong} are not supported"),
            "write order = 1 (linear) or order = 2 (quadratic)",
        );
    }
    let surfaces_alone = section.number("dimension") == Some(2.0);
    let adapt = section.section("adapt").and_then(read_adapt);
    if adapt.is_some() && refine > 0 {
        refuse_both(&section);
    }
    if adapt.is_some() && section.has("scale") {
        let problem = "`scale` and `adapt` are both given: `adapt` asks gmsh for sizes in metres";
        let remedy = "write the geometry in metres, or remove adapt";
        section.refuse("scale", problem.into(), remedy);
    }
    let mesh = match (geometry, file) {
        (Some(geometry), None) => Some(MeshSource::Geometry {
            geometry,
            parameters,
            order: if order == Some(2.0) { 2 } else { 1 },
            surfaces_alone,
            adapt,
        }),
        (None, Some(file)) => {
            let Some(key) = idle_beside_file(&section, &parameters, order) else {
                section.finish();
                return Some(MeshSource::File(file));
            };
            section.refuse(
                key,
                format!("`{key}` has no effect on a mesh file"),
                "remove it, or give the geometry instead of the file",
            );
            None
        }
        (Some(_), Some(_)) => {
            section.refuse(
                "file",
                "both `geometry` and `file` are given".into(),
                "keep one of them",
            );
            None
        }
        (None, None) => {
            section.require("geometry");
            None
        }
    };
    section.finish();
    mesh
}

/// The first key that only a geometry has a use for.
fn idle_beside_file(
    section: &Section<'_, '_>,
    parameters: &[(String, f64)],
    order: Option<f64>,
) -> Option<&'static str> {
    let is_said = |key: &&'static str| match *key {
        "parameters" => !parameters.is_empty(),
        // An order that does not exist is refused by itself.
        "order" => order.is_some(),
        key => section.has(key),
    };
    let all = ["order", "dimension", "adapt", "parameters"];
    all.into_iter().find(is_said)
}

/// Refuses to refine what follows the error.
fn refuse_both(section: &Section<'_, '_>) {
    let problem = "`refine` and `adapt` are both given: the sizes that `adapt` asks gmsh for are \
                   those of the cells that the error was estimated on, and `refine` would divide \
                   them again";
    let remedy = "keep one of them: `adapt` chooses sizes by the error, `refine` divides all cells";
    section.refuse("refine", problem.into(), remedy);
}

fn read_adapt(section: Section<'_, '_>) -> Option<Adapt> {
    section.require("tolerance");
    let tolerance = section.number("tolerance");
    let max_unknowns = section.number("max_unknowns");
    let max_rounds = section.number("max_rounds");
    let by = match section.choice("by") {
        Some("bisection") => AdaptBy::Bisection,
        _ => AdaptBy::Meshing,
    };
    section.finish();
    Some(Adapt {
        tolerance: tolerance?,
        max_unknowns: max_unknowns.unwrap_or(1e6),
        max_rounds: max_rounds.map_or(8, |rounds| rounds.ceil() as usize),
        by,
    })
}

fn read_path(section: &Section<'_, '_>, key: &'static str, folder: &Path) -> Option<PathBuf> {
    let path = section.text(key)?;
    if path.is_empty() {
        let remedy = "name the file, relative to the folder of the scene";
        section.refuse(key, format!("`{key}` is empty"), remedy);
    }
    Some(folder.join(path))
}

fn read_fixed_points(
    source: &Source<'_>,
    root: &Section<'_, '_>,
    clock: Clock,
) -> Vec<Named<FixedPointEntry>> {
    let sections = root.listed_sections("fixed_point").into_iter();
    let entries = sections.filter_map(|section| {
        let name = section.title.clone();
        entry(source, name, section, |s| read_fixed_point(s, clock))
    });
    entries.collect()
}

/// What the section of the fluid says.
#[derive(Default)]
struct FlowSection {
    fluid: Option<Named<FluidEntry>>,
    isolated: Isolated,
    equivalent_permeability: bool,
}

fn read_flow(root: &Section<'_, '_>, body: &BodyEntry) -> FlowSection {
    let section = root.section("fluid");
    let flowing = section.map(|section| read_flow_section(section, body));
    flowing.unwrap_or_default()
}

fn read_flow_section(section: Section<'_, '_>, body: &BodyEntry) -> FlowSection {
    let isolated = match section.choice("isolated") {
        Some("inactive") => Isolated::Inactive,
        Some("undrained") => Isolated::Undrained,
        _ => Isolated::Refused,
    };
    let equivalent_permeability = section.flag("equivalent_permeability").unwrap_or(false);
    let (place, title) = (section.place(), section.title.clone());
    let fluid = read_fluid(section, body.gravity);
    FlowSection {
        fluid: fluid.map(|value| Named {
            place: format!("{place} {title}"),
            name: title,
            value,
        }),
        isolated,
        equivalent_permeability,
    }
}

/// Boreholes, each under the name it has or else that of its section.
fn read_sources(
    source: &Source<'_>,
    root: &Section<'_, '_>,
    setting: Setting,
) -> Vec<Named<SourceEntry>> {
    let mut sources: Vec<Named<SourceEntry>> = Vec::new();
    for section in root.listed_sections("source") {
        let name = section.text("name").map(str::to_owned);
        let name = name.unwrap_or_else(|| section.title.clone());
        if sources.iter().any(|other| other.name == name) {
            let problem = format!("two sources are called \"{name}\"");
            section.refuse("name", problem, "give each a name of its own");
        }
        sources.extend(entry(source, name, section, |s| read_source(s, setting)));
    }
    sources
}

/// Sections that speak of what cannot happen in rigid rock.
fn refuse_in_rigid_rock(root: &Section<'_, '_>, keys: &[&'static str]) {
    for &key in keys {
        if root.has(key) {
            root.refuse(
                key,
                format!("`{key}` has no effect in rigid rock: no rock has a young_modulus"),
                "remove it, or add young_modulus to [rock]",
            );
        }
    }
}

/// Of the solver only the accuracy of time steps counts there.
fn refuse_in_rigid_solver(root: &Section<'_, '_>) {
    let Some(solver) = root.section("solver") else {
        return;
    };
    for key in ["linear", "memory_limit", "path_accuracy", "facets"] {
        if solver.has(key) {
            let problem =
                format!("`{key}` has no effect in rigid rock: no rock has a young_modulus");
            solver.refuse(key, problem, "remove it, or add young_modulus to [rock]");
        }
    }
}

/// The same in a scene, and a mesh that is to follow an error which nobody estimates.
fn refuse_in_rigid_scene(root: &Section<'_, '_>) {
    let idle = [
        "fixed_point",
        "initial_stress",
        "oracle",
        "strength_reduction",
    ];
    refuse_in_rigid_rock(root, &idle);
    refuse_in_rigid_solver(root);
    if let Some(mesh) = root.section("mesh").filter(|mesh| mesh.has("adapt")) {
        let problem = "no error of a mesh in rigid rock is estimated: no rock has a young_modulus";
        let remedy = "remove adapt, or add young_modulus to [rock]";
        mesh.refuse("adapt", problem.into(), remedy);
    }
}

fn read_solver(root: &Section<'_, '_>) -> SolverEntry {
    let Some(section) = root.section("solver") else {
        return SolverEntry::default();
    };
    let linear = section.choice("linear");
    let entry = SolverEntry {
        linear: linear.and_then(|name| name.parse().ok()),
        memory_limit: section.number("memory_limit"),
        path_accuracy: section.number("path_accuracy"),
        time_accuracy: section.number("time_accuracy"),
        facets: read_facets(&section),
    };
    section.finish();
    entry
}

fn read_silenced(section: Section<'_, '_>) -> Vec<&'static str> {
    let silenced = section.choices("silence");
    section.finish();
    silenced.unwrap_or_default()
}

fn read_facets(section: &Section<'_, '_>) -> FacetQuadrature {
    match section.choice("facets") {
        Some("gauss") => FacetQuadrature::Gauss,
        _ => FacetQuadrature::Nodal,
    }
}

#[cfg(test)]
mod tests;
