//! Project files of OpenGeoSys (`.prj`): mechanics with fractures as interfaces (LIE).

use std::path::Path;

use kluft_io::import::{Imported, read_grid};
use kluft_mesh::Defect;

use super::extent::Extent;
use super::laws::{fractures, rocks};
use super::loads::{body, conditions};
use super::parameters::Parameters;
use super::said::Said;
use super::times::times;
use super::tree::Element;

/// Processes whose mechanics a scene can say.
const PROCESSES: [&str; 2] = ["SMALL_DEFORMATION_WITH_LIE", "SMALL_DEFORMATION"];
/// What Kluft decides by itself, or what says how results are written and compared.
const OWN: [&str; 4] = [
    "nonlinear_solvers",
    "linear_solvers",
    "test_definition",
    "chemical_system",
];
const OWN_OF_PROCESS: [&str; 5] = [
    "integration_order",
    "process_variables",
    "secondary_variables",
    "dimension",
    "name",
];

/// A mesh with the sections of a scene, and what became of the rest.
pub struct Project {
    pub imported: Imported,
    /// Sections of rocks, fractures, conditions and load steps.
    pub scene: String,
}

/// Reads a project with its mesh.
///
/// # Errors
/// If a file cannot be read, or the process is none of mechanics.
pub fn read_project(path: &Path) -> Result<Project, Vec<Defect>> {
    let root = Element::read(path)?;
    let place = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new("."));
    let refuse = |problem: String, remedy: &str| vec![Defect::new(&place, problem, remedy)];
    let process = root.get("processes").and_then(|list| list.get("process"));
    let kind = process.and_then(|process| process.word("type"));
    let (Some(process), Some(kind)) = (process, kind) else {
        return Err(refuse(
            "it has no process".into(),
            "write includes out first: `ogs --write-prj`",
        ));
    };
    if !PROCESSES.contains(&kind) {
        let problem = format!("its process is {kind}");
        let remedy = "only SMALL_DEFORMATION_WITH_LIE and SMALL_DEFORMATION have a counterpart; \
                      import the mesh by itself";
        return Err(refuse(problem, remedy));
    }
    let mesh = root.word("mesh").map(str::to_owned);
    let meshes = root.get("meshes");
    let mesh = mesh.or_else(|| meshes?.word("mesh").map(str::to_owned));
    let mesh =
        mesh.ok_or_else(|| refuse("it names no mesh".into(), "add <mesh>NAME.vtu</mesh>"))?;
    let mut imported = read_grid(&folder.join(&mesh))?;
    let extent = Extent::of(imported.draft.nodes.iter().copied());
    let extent = extent.ok_or_else(|| refuse("its mesh is empty".into(), "give another mesh"))?;
    let parameters = Parameters::of(&root);
    let mut said = Said::default();
    rocks(process, &parameters, &mut said);
    fractures(process, &parameters, &mut said);
    body(process, &mut said);
    let body = (&mut imported.draft, &extent);
    conditions((&root, folder), body, &parameters, &mut said);
    times(&root, &mut said);
    said.notes.extend(pass_over(&root, process));
    imported.notes.append(&mut said.notes);
    Ok(Project {
        imported,
        scene: said.scene,
    })
}

/// One note for what Kluft does by itself, one for each thing that has no counterpart.
fn pass_over(root: &Element, process: &Element) -> Vec<String> {
    root.pass_over(&OWN);
    process.pass_over(&OWN_OF_PROCESS);
    if let Some(time_loop) = root.get("time_loop") {
        time_loop.pass_over(&["output"]);
        let processes = time_loop.get("processes").into_iter();
        for own in processes.flat_map(|list| list.all("process")) {
            own.pass_over(&[
                "nonlinear_solver",
                "convergence_criterion",
                "time_discretization",
            ]);
        }
    }
    let mut left = Vec::new();
    root.left("", &mut left);
    let own = "solvers, tolerances, integration and output are Kluft's own";
    let others = left
        .into_iter()
        .map(|what| format!("no counterpart: {what}"));
    std::iter::once(own.to_owned()).chain(others).collect()
}
