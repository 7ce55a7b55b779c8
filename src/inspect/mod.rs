//! An inspection: what a scene or a mesh is like, told before anything is solved.

mod cost;
mod doubled;
mod findings;
mod fractures;
mod gather;
mod grid;
mod groups;
mod hydraulics;
mod lines;
mod text;
mod walls;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use kluft_io::{GmshOptions, NOT_WRITTEN, write_atomically, write_vtu};
use kluft_mesh::{Defect, Draft, Faces, Mesh, SurfaceRole, Survey, outer_surfaces};
use kluft_solver::{Discretisation, EquivalentPermeability, FlowWorkload, Workload, unfit_walls};

use crate::failure::Failure;
use crate::input::{expect_scene, is_mesh, scene_at};
use crate::printing;
use crate::stdout::print;
use kluft_run::{
    MESH, Output, RunFlow, folder_for, inputs, mesh_file, pool, read_mesh, thread_count,
    unfinished_mesh_file,
};
use kluft_scene::{
    Binding, JoinedDraft, MeshSource, Scene, SolverEntry, SurfaceMesh, bind, in_terms_of_scene,
    join, name_places, refine, roles, surface_mesh,
};

use findings::{Inspection, MeshCounts};
use groups::GroupRoles;

/// The files that an inspection writes beside a mesh.
const GRID: &str = "inspect.vtu";
const REPORT: &str = "inspect.json";

/// How to inspect.
#[derive(Debug, Clone)]
pub struct InspectOptions {
    /// Folder for `inspect.vtu`; `out` beside the input if not given.
    pub out: Option<PathBuf>,
    /// What is printed.
    pub form: Form,
    /// How gmsh is started, and what a geometry may do.
    pub gmsh: GmshOptions,
}

/// What is printed of an inspection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Text, of many fractures a line each.
    Short,
    /// Text that describes each fracture.
    Long,
    /// All of it, as JSON.
    Json,
}

/// Inspects a scene (`.toml`) or a mesh alone (`.msh`) without solving: prints the report to the
/// standard output stream and writes `inspect.vtu`.
///
/// # Errors
/// [`Failure::BadInput`] with every defect found, or [`Failure::Machine`]; what could be inspected
/// in spite of them is printed before.
pub fn inspect(input: &Path, options: &InspectOptions) -> Result<(), Failure> {
    let pool = pool(thread_count(None).count).map_err(|defect| Failure::Machine(vec![defect]))?;
    let input = scene_at(input)?;
    pool.install(|| inspect_here(&input, options))
}

/// Inspects on the present thread pool.
fn inspect_here(input: &Path, options: &InspectOptions) -> Result<(), Failure> {
    let start = Instant::now();
    let scene = if is_mesh(input) {
        None
    } else {
        expect_scene(input)?;
        Some(Scene::read(input)?)
    };
    let folder = folder_for(input, options.out.as_deref());
    let output = output(&folder, input, scene.as_ref())?;
    let draft = read(input, scene.as_ref(), &output, &options.gmsh)?;
    let mut inspection = Inspection::of(input, scene.as_ref(), &draft);
    let mut defects = look(draft, scene.as_ref(), &output, &mut inspection);
    inspection.seconds = start.elapsed().as_secs_f64();
    let of_input = defects
        .iter()
        .filter(|defect| defect.code != Some(NOT_WRITTEN));
    inspection.defects = of_input.map(Into::into).collect();
    let printed = keep_and_print(&inspection, options.form, &output, &mut defects);
    if defects.is_empty() {
        printed
    } else {
        Err(defects.into())
    }
}

/// The folder of an inspection, for the files that it will write.
fn output(folder: &Path, input: &Path, scene: Option<&Scene>) -> Result<Output, Vec<Defect>> {
    let mut names = vec![GRID, REPORT];
    if scene.is_some_and(|scene| matches!(scene.mesh, MeshSource::Geometry { .. })) {
        names.push(MESH);
    }
    Output::prepare(folder, &names, &inputs(input, scene))
}

fn read(
    input: &Path,
    scene: Option<&Scene>,
    output: &Output,
    gmsh: &GmshOptions,
) -> Result<Draft, Vec<Defect>> {
    let scratch = output.unfinished("");
    let Some(scene) = scene else {
        return read_mesh(input, 0, &scratch, gmsh);
    };
    // The mesh beside results is theirs: an adapted one is not the one that the geometry asks for.
    if !output.has_results() {
        let file = mesh_file(scene, output, None, gmsh, &mut ())?;
        return read_mesh(&file.path, scene.refine, &scratch, gmsh);
    }
    let file = unfinished_mesh_file(scene, output, None, gmsh, &mut ())?;
    let draft = read_mesh(&file.path, scene.refine, &scratch, gmsh);
    if file.meshed.is_some() {
        // Were it to stay, the next command in this folder would remove it.
        let _ = std::fs::remove_file(&file.path);
    }
    draft
}

/// Fills the inspection as far as the input allows; returns what is wrong with it.
fn look(
    draft: Draft,
    scene: Option<&Scene>,
    output: &Output,
    inspection: &mut Inspection,
) -> Vec<Defect> {
    let draft = match scene {
        Some(scene) => scene.taken(draft),
        None if draft.is_plane() => draft.extruded(),
        None => draft,
    };
    inspection.warnings.extend(groups::missing(&draft));
    inspection.warnings.extend(groups::repeated(&draft));
    let faces = Faces::of(&draft);
    inspection.groups = groups::list(&draft, &faces.inner_surfaces(&draft), None, scene);
    let mesh = match mesh(draft, faces, scene, inspection) {
        Ok(mesh) => mesh,
        Err(defects) => return defects,
    };
    let survey = Survey::of(&mesh);
    gather::topology(&mesh, &survey, inspection);
    let mut defects = Vec::new();
    if !mesh.cells.is_empty() {
        let grid = grid::of(&mesh, &survey);
        defects.extend(output.write(GRID, |path| write_vtu(path, grid)).err());
    }
    let Some(scene) = scene else {
        let asked = (Workload::one_step(&mesh, &[]), &SolverEntry::default());
        defects.extend(cost::predict(&mesh, None, asked, inspection));
        return defects;
    };
    match bind(scene, mesh) {
        Ok(binding) => {
            defects.extend(look_at_problem(scene, &binding, &survey, inspection));
            inspection.decisions.extend(binding.decisions);
            inspection.warnings.extend(binding.warnings);
        }
        Err(found) => defects.extend(found),
    }
    defects
}

/// Looks at a problem and its flow; returns why they could not be solved.
fn look_at_problem(
    scene: &Scene,
    binding: &Binding,
    survey: &Survey,
    inspection: &mut Inspection,
) -> Vec<Defect> {
    let flow = binding.flow.as_ref();
    let is_idle = scene.equivalent_permeability && flow.is_some_and(|f| f.conditions.is_empty());
    let is_timed = binding.problem.schedule.is_timed;
    let takes_time = match (scene.is_rigid(), flow) {
        (true, Some(flow)) => flow.is_stored(is_timed),
        _ => is_timed,
    };
    let mut defects = Vec::new();
    if scene.equivalent_permeability {
        let volume = EquivalentPermeability::volume_of(&binding.problem.mesh);
        defects.extend(volume.err());
    }
    let pressures = connect(binding, takes_time || is_idle, inspection);
    if scene.is_rigid() && pressures.is_ok() {
        let found = cost::predict_flow(scene, binding, inspection);
        defects.extend(found.err().unwrap_or_default());
    }
    if !scene.is_rigid() {
        let pressures = pressures.as_ref().ok().copied().flatten();
        let flow = workload(scene, binding, pressures);
        defects.extend(weigh((scene, binding, flow), survey, inspection));
    }
    defects.extend(pressures.err().unwrap_or_default());
    defects
}

/// The mesh as the scene wants it: joined, refined and checked.
fn mesh(
    draft: Draft,
    faces: Faces,
    scene: Option<&Scene>,
    inspection: &mut Inspection,
) -> Result<Mesh, Vec<Defect>> {
    if let Some(scene) = scene.filter(|scene| scene.takes_surfaces(&draft)) {
        return surfaces(draft, scene, inspection);
    }
    let mut joined = joined(draft, faces, scene, inspection)?;
    let inner = joined.faces.inner_surfaces(&joined.draft);
    let Some(scene) = scene else {
        let roles = joined.faces.guessed_roles(&joined.draft);
        inspection.groups = groups::list(
            &joined.draft,
            &inner,
            Some(GroupRoles::guessed(&roles)),
            None,
        );
        return Mesh::build_on(joined.draft, joined.faces, &roles);
    };
    let found = roles(scene, &joined.draft, &inner)?;
    inspection.warnings.extend(found.warnings.iter().cloned());
    let of_scene = GroupRoles::of(&found);
    let list = |draft: &Draft| groups::list(draft, &inner, Some(of_scene), Some(scene));
    inspection.groups = list(&joined.draft);
    if scene.has_stages() {
        return stages(scene, joined, found.of_group, inspection);
    }
    joined = refine(scene, joined, &found.of_group).map_err(in_terms_of_scene)?;
    inspection.groups = list(&joined.draft);
    inspection.mesh = MeshCounts::of(&joined.draft);
    let built = Mesh::build_on(joined.draft, joined.faces, &found.of_group);
    built.map_err(in_terms_of_scene)
}

/// The mesh that the phases of a scene begin with; what they change is told, and all bodies are
/// checked.
fn stages(
    scene: &Scene,
    joined: JoinedDraft,
    of_group: Vec<SurfaceRole>,
    inspection: &mut Inspection,
) -> Result<Mesh, Vec<Defect>> {
    let staged = scene.staged_on(joined, of_group)?;
    inspection.mesh = MeshCounts::of(staged.draft());
    inspection.decisions.extend(staged.check()?);
    Ok(staged.bind(0, None)?.binding.problem.mesh)
}

/// The mesh of fractures and outer faces alone.
fn surfaces(draft: Draft, scene: &Scene, inspection: &mut Inspection) -> Result<Mesh, Vec<Defect>> {
    let groups = draft.groups.iter().zip(outer_surfaces(&draft));
    let inner: Vec<bool> = groups
        .map(|(group, outer)| group.dimension == 2 && !outer)
        .collect();
    let SurfaceMesh { mesh, roles } = surface_mesh(scene, draft.clone())?;
    inspection.warnings.extend(roles.warnings.iter().cloned());
    let of_scene = GroupRoles::of(&roles);
    inspection.groups = groups::list(&draft, &inner, Some(of_scene), Some(scene));
    Ok(mesh)
}

/// Tells where outer faces lie on one another, and joins what the scene wants joined. A mesh alone
/// is looked at as it is.
fn joined(
    draft: Draft,
    faces: Faces,
    scene: Option<&Scene>,
    inspection: &mut Inspection,
) -> Result<JoinedDraft, Vec<Defect>> {
    doubled::tell(&faces.doubled_surfaces(&draft), scene.is_none(), inspection);
    match scene {
        None => Ok(JoinedDraft {
            draft,
            faces: faces.let_touch(),
            decisions: Vec::new(),
        }),
        Some(scene) => name_places(scene, join(scene, draft, faces)?),
    }
}

/// What a flow that follows the walls, of a number of pressures, asks of the linear solver.
fn workload(scene: &Scene, binding: &Binding, pressures: Option<usize>) -> Option<FlowWorkload> {
    let is_timed = binding.problem.schedule.is_timed;
    let flow = binding.flow.as_ref()?;
    let time = scene.solver.time_accuracy;
    let is_divided = is_timed && time.is_none_or(|time| time < 1.0);
    flow.follows_walls(is_timed).then_some(FlowWorkload {
        pressures: pressures?,
        increments: if is_divided { 3 } else { 1 },
    })
}

/// Adds what supports, loads, laws and a flow with them make of the mesh.
fn weigh(
    (scene, binding, flow): (&Scene, &Binding, Option<FlowWorkload>),
    survey: &Survey,
    inspection: &mut Inspection,
) -> Vec<Defect> {
    let problem = &binding.problem;
    gather::held_and_loaded(problem, inspection);
    walls::judge(problem, survey, inspection);
    let (discretisation, mut defects) = match Discretisation::of(problem) {
        Ok(discretisation) => (Some(discretisation), Vec::new()),
        Err(defects) => (None, in_terms_of_scene(defects)),
    };
    let following = binding.flow.as_ref();
    let following = following.filter(|flow| flow.follows_walls(problem.schedule.is_timed));
    if let (Some(flow), Some(discretisation)) = (following, &discretisation) {
        let unfit = unfit_walls(problem, flow, discretisation.interface());
        defects.extend(in_terms_of_scene(unfit));
    }
    let workload = Workload::of(problem).with_flow(flow);
    let asked = (workload, &scene.solver);
    let too_large = cost::predict(&problem.mesh, discretisation.as_ref(), asked, inspection);
    defects.extend(too_large);
    defects
}

/// Tells which fractures fluid can pass between, and what drives it there; returns the number of
/// pressures, if anything flows.
fn connect(
    binding: &Binding,
    needs_no_drive: bool,
    inspection: &mut Inspection,
) -> Result<Option<usize>, Vec<Defect>> {
    let Some(flow) = &binding.flow else {
        return Ok(None);
    };
    let made = RunFlow::of(&binding.problem, flow).map_err(in_terms_of_scene)?;
    inspection.hydraulics = Some(made.hydraulics());
    // A flow that takes time begins with the pressures that fractures have.
    let undriven = match needs_no_drive {
        true => Vec::new(),
        false if flow.is_undrained => made.system().unbalanced(),
        false => made.system().undriven(),
    };
    if undriven.is_empty() {
        Ok(Some(made.system().nodes().len()))
    } else {
        Err(in_terms_of_scene(undriven))
    }
}

/// Prints the report and keeps it as `inspect.json`.
fn keep_and_print(
    inspection: &Inspection,
    form: Form,
    output: &Output,
    defects: &mut Vec<Defect>,
) -> Result<(), Failure> {
    let encoded = serde_json::to_string_pretty(inspection).unwrap_or_default() + "\n";
    let encoded = printing::json(&encoded);
    let text = match form {
        Form::Json => encoded.clone(),
        Form::Short => text::of(inspection, false),
        Form::Long => text::of(inspection, true),
    };
    let kept = output.write(REPORT, |path| {
        write_atomically(path, |out| out.write_all(encoded.as_bytes()))
    });
    defects.extend(kept.and_then(|()| output.sync()).err());
    print(&text)
}
