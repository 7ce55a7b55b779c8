//! Where a scene meets a mesh: names become groups, groups become parts of a problem.

use glam::DVec3;
use kluft_mesh::{Defect, Draft, Faces, Mesh, nearest};
use kluft_solver::{Condition, FixedPoint, Flow, Problem, Spring, SpringStiffness, Varying};
use lie_core::FractureLaw;

use crate::bind_fields::bind_fields;
use crate::bind_flow::bind_flow;
use crate::bind_probes::{Probe, bind_probes};
use crate::bind_rocks::{bind_rocks, rocks, wrong_gravity};
use crate::cases::{Bound, schedule};
use crate::conditions::{BoundaryEntry, FixedPointEntry, FractureEntry};
use crate::doubts::warnings;
use crate::fluid_doubts;
use crate::isolated::treat;
use crate::join::{JoinedDraft, join};
use crate::oracle::Oracle;
use crate::placed::name_places;
use crate::point_contacts;
use crate::refine::refine;
use crate::remedies::in_terms_of_scene;
use crate::roles::{DEFAULT, Roles, roles};
use crate::scene::{Named, Scene};
use crate::surfaces::{SurfaceMesh, surface_mesh};
use crate::wrong_boundaries::wrong_boundaries;

/// A problem and what was decided on the way to it.
pub struct Binding {
    /// The problem.
    pub problem: Problem,
    /// The flow in its fractures, if there is one.
    pub flow: Option<Flow>,
    /// One line a decision, for the user.
    pub decisions: Vec<String>,
    /// What is possible but hardly meant, one line each.
    pub warnings: Vec<String>,
    /// Closed form of each fracture that has one.
    pub oracles: Vec<Option<Oracle>>,
    /// Probes.
    pub probes: Vec<Probe>,
}

impl Scene {
    /// The problem of this scene on a mesh as read, with what was decided on the way.
    ///
    /// # Errors
    /// Every defect of the mesh, and everything in the scene that does not fit it.
    pub fn problem(&self, draft: Draft) -> Result<Binding, Vec<Defect>> {
        let draft = self.taken(draft);
        if self.takes_surfaces(&draft) {
            return self.surface_problem(draft);
        }
        if self.has_stages() {
            let staged = self.staged(draft)?;
            let first = staged.bind(0, None)?.binding;
            return Ok(first.after(staged.decisions, staged.warnings));
        }
        let faces = Faces::of(&draft);
        let joined = name_places(self, join(self, draft, faces)?)?;
        let inner = joined.faces.inner_surfaces(&joined.draft);
        let Roles {
            of_group,
            decisions: unused,
            warnings,
            ..
        } = roles(self, &joined.draft, &inner)?;
        let JoinedDraft {
            draft,
            faces,
            mut decisions,
        } = refine(self, joined, &of_group).map_err(in_terms_of_scene)?;
        decisions.extend(unused);
        decisions.extend(draft.is_extruded.then(|| {
            "a mesh of the plane: plane strain in x and y; areas and forces are those of one metre"
                .to_owned()
        }));
        let mesh = Mesh::build_on(draft, faces, &of_group).map_err(in_terms_of_scene)?;
        Ok(bind(self, mesh)?.after(decisions, warnings))
    }

    /// The problem on a mesh without cells.
    fn surface_problem(&self, draft: Draft) -> Result<Binding, Vec<Defect>> {
        let SurfaceMesh { mesh, roles } = surface_mesh(self, draft)?;
        Ok(bind(self, mesh)?.after(roles.decisions, roles.warnings))
    }
}

impl Binding {
    /// The same after what was decided and doubted before.
    pub(crate) fn after(mut self, mut decisions: Vec<String>, mut warnings: Vec<String>) -> Self {
        decisions.append(&mut self.decisions);
        warnings.append(&mut self.warnings);
        Self {
            decisions,
            warnings,
            ..self
        }
    }
}

impl Scene {
    /// The laws of these fractures of a mesh, of those that the scene names or has a default for.
    pub fn laws(&self, fractures: &[String]) -> Vec<FractureLaw> {
        let entries = bind_fractures(self, fractures, &mut Vec::new());
        let laws = entries.iter().map(|entry| entry.value.fracture.law);
        laws.collect()
    }
}

/// Binds a scene to its mesh.
///
/// # Errors
/// Volumes without or with several rocks, gravity without density, fixed points that are not in
/// the body, and boreholes that hit no fracture.
pub fn bind(scene: &Scene, mesh: Mesh) -> Result<Binding, Vec<Defect>> {
    bind_with(scene, mesh, |_| None)
}

/// Like [`bind`], with other rocks where `rock_of` has one for a cell.
pub(crate) fn bind_with(
    scene: &Scene,
    mut mesh: Mesh,
    rock_of: impl Fn(usize) -> Option<u32>,
) -> Result<Binding, Vec<Defect>> {
    let (mut defects, mut decisions, mut idle) = (Vec::new(), Vec::new(), Vec::new());
    let moved = (scene.quarter_points).then(|| quarter_points(mesh.move_to_quarter_points()));
    decisions.extend(moved.into_iter().flatten());
    let mut rock_of_cell = bind_rocks(scene, &mesh, &mut defects);
    let cells = rock_of_cell.iter_mut().enumerate();
    cells.for_each(|(cell, rock)| *rock = rock_of(cell).unwrap_or(*rock));
    defects.extend(wrong_gravity(scene, &mesh));
    defects.extend(out_of_plane(scene, &mesh).iter().cloned());
    let fractures = bind_fractures(scene, &mesh.fractures, &mut decisions);
    let fixed_points = bind_fixed_points(scene, &mesh, &mut decisions, &mut defects);
    let oracles = bind_oracles(scene, &mesh, &fractures, &mut defects);
    defects.extend(wrong_strength(scene, &mesh, &fractures));
    let (boundaries, conditions) = bind_boundaries(scene, &mesh);
    defects.extend(wrong_boundaries(&mesh, &boundaries, &conditions));
    if !defects.is_empty() {
        return Err(defects);
    }
    let (fixed_entries, fixed_points) = fixed_points.into_iter().unzip();
    let bound = Bound {
        boundaries,
        fixed_points: fixed_entries,
        fractures,
        sources: scene.sources.iter().collect(),
    };
    let schedule = schedule(scene, &bound, &mut decisions, &mut idle);
    let mut flow = bind_flow(scene, &mesh, &bound, &schedule.cases, &mut decisions)?;
    let mut problem = Problem {
        springs: springs(&bound.boundaries, &conditions, mesh.is_plane()),
        conditions,
        rocks: rocks(scene),
        rock_of_cell,
        schedule,
        fractures: (bound.fractures.iter().map(|entry| entry.value.fracture)).collect(),
        fixed_points,
        gravity: scene.body.gravity,
        initial_stress: (scene.initial_stress.as_ref()).map(|entry| entry.stress.clone()),
        added: Vec::new(),
        varying: Varying::default(),
        facet_quadrature: scene.solver.facets,
        mesh,
    };
    let probes = bind_probes(scene, &problem.mesh, &mut decisions)?;
    let odd = bind_fields(scene, &bound, &mut problem, &mut decisions)?;
    if let Some(flow) = &mut flow {
        settle_flow(scene, &problem, flow, &mut decisions)?;
    }
    Ok(Binding {
        warnings: doubts(scene, &problem, flow.as_ref(), [odd, idle]),
        problem,
        flow,
        decisions,
        oracles,
        probes,
    })
}

/// What a scene is wrong about because its mesh is one of the plane.
fn out_of_plane<'s>(scene: &'s Scene, mesh: &Mesh) -> &'s [Defect] {
    match mesh.is_plane() {
        true => &scene.in_plane,
        false => &[],
    }
}

/// All warnings of a scene on its mesh, with those that are known.
fn doubts(
    scene: &Scene,
    problem: &Problem,
    flow: Option<&Flow>,
    known: [Vec<String>; 2],
) -> Vec<String> {
    let of_flow = flow.and_then(|flow| fluid_doubts::warning(scene, problem, flow));
    let contacts = flow.and_then(|flow| point_contacts::warning(scene, &problem.mesh, flow));
    let known = known.into_iter().flatten();
    warnings(scene, problem)
        .into_iter()
        .chain(known)
        .chain(of_flow)
        .chain(contacts)
        .collect()
}

/// Treats networks that are isolated, and checks what goes with the flow.
fn settle_flow(
    scene: &Scene,
    problem: &Problem,
    flow: &mut Flow,
    decisions: &mut Vec<String>,
) -> Result<(), Vec<Defect>> {
    treat(scene, problem, flow, decisions)?;
    let reduction = scene.strength_reduction.as_ref();
    let is_timed = problem.schedule.is_timed;
    let defect = reduction.and_then(|own| own.defect_beside(flow, is_timed));
    defect.map_or(Ok(()), |defect| Err(vec![defect]))
}

/// What is wrong with the reduction of strength, where no volumes come and go.
fn wrong_strength(scene: &Scene, mesh: &Mesh, fractures: &[&Named<FractureEntry>]) -> Vec<Defect> {
    let reduction = scene.strength_reduction.as_ref();
    let Some(reduction) = reduction.filter(|_| !scene.has_stages()) else {
        return Vec::new();
    };
    let laws = fractures.iter().map(|entry| entry.value.fracture.law);
    reduction.defects(&mesh.fractures, &laws.collect::<Vec<_>>())
}

/// What acts on and holds the outer surface.
fn bind_boundaries<'a>(
    scene: &'a Scene,
    mesh: &Mesh,
) -> (Vec<&'a Named<BoundaryEntry>>, Vec<Condition>) {
    let conditions = scene.boundaries.iter().filter_map(|entry| {
        let boundary = mesh.boundaries.iter().position(|b| b.name == entry.name)?;
        let condition = Condition {
            boundary,
            load: entry.value.uniform_load(),
            support: entry.value.support,
        };
        Some((entry, condition))
    });
    conditions.unzip()
}

/// The springs of boundaries, which stand beside their conditions.
fn springs(
    boundaries: &[&Named<BoundaryEntry>],
    conditions: &[Condition],
    is_plane: bool,
) -> Vec<Spring> {
    let pairs = boundaries.iter().zip(conditions);
    let springs = pairs.filter_map(|(entry, condition)| {
        let mut stiffness = entry.value.springs.as_ref()?.stiffness.clone();
        if let SpringStiffness::Outside { is_line, .. } = &mut stiffness {
            *is_line = is_plane;
        }
        Some(Spring {
            boundary: condition.boundary,
            stiffness,
        })
    });
    springs.collect()
}

fn quarter_points(moved: usize) -> Option<String> {
    (moved > 0).then(|| {
        format!(
            "quarter points: the middles of {moved} edges at crack fronts moved towards the front, so that \
             displacements follow the square root of the distance ([mesh] quarter_points = false leaves them)"
        )
    })
}

/// Closed form of each fracture.
fn bind_oracles(
    scene: &Scene,
    mesh: &Mesh,
    fractures: &[&Named<FractureEntry>],
    defects: &mut Vec<Defect>,
) -> Vec<Option<Oracle>> {
    let strangers = scene
        .oracles
        .iter()
        .filter(|entry| !mesh.fractures.contains(&entry.name));
    defects.extend(strangers.map(|entry| {
        let known = mesh.fractures.iter().map(String::as_str);
        let remedy = match nearest(&entry.name, known) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("fractures of the mesh: {}", mesh.fractures.join(", ")),
        };
        let problem = format!("`{}` is no fracture of the mesh", entry.name);
        Defect::new(&entry.place, problem, remedy)
    }));
    let mut rocks = scene.rocks.iter();
    let is_isotropic = rocks.all(|entry| entry.value.rock.anisotropy.is_none());
    let of = |name: &String| scene.oracles.iter().find(|entry| entry.name == *name);
    for (name, fracture) in mesh.fractures.iter().zip(fractures) {
        let refused = of(name).and_then(|entry| {
            let varies = fracture.value.varying().next().is_some();
            let refusal = match varies {
                true => Some([
                    "a closed form has one law and one pressure all over its fracture",
                    "give the fracture plain numbers, or remove the closed form",
                ]),
                false => entry.value.refusal(&fracture.value.fracture, is_isotropic),
            };
            let [problem, remedy] = refusal?;
            Some(Defect::new(&entry.place, problem, remedy))
        });
        defects.extend(refused);
    }
    let names = mesh.fractures.iter();
    names
        .map(|name| of(name).map(|entry| entry.value))
        .collect()
}

/// The entry of each fracture.
fn bind_fractures<'a>(
    scene: &'a Scene,
    names: &[String],
    decisions: &mut Vec<String>,
) -> Vec<&'a Named<FractureEntry>> {
    let by_name = |name: &str| scene.fractures.iter().find(|entry| entry.name == name);
    let mut by_default = Vec::new();
    let entries = names.iter().filter_map(|name| {
        by_name(name).or_else(|| {
            by_default.push(name.as_str());
            by_name(DEFAULT)
        })
    });
    let entries = entries.collect();
    if !by_default.is_empty() {
        decisions.push(format!(
            "[fracture.default] serves {}",
            by_default.join(", ")
        ));
    }
    entries
}

fn bind_fixed_points<'a>(
    scene: &'a Scene,
    mesh: &Mesh,
    decisions: &mut Vec<String>,
    defects: &mut Vec<Defect>,
) -> Vec<(&'a Named<FixedPointEntry>, FixedPoint)> {
    let mut bound = Vec::new();
    for entry in &scene.fixed_points {
        let at = entry.value.at;
        let Some((node, distance, longest_edge)) = nearest_node(mesh, at) else {
            continue;
        };
        let node = mesh.layer_below(node as u32) as usize;
        let x = mesh.nodes[node];
        let tag = mesh.node_tags[node];
        if distance > longest_edge {
            defects.push(Defect::new(
                &entry.place,
                format!("({}, {}, {}) is outside the rock", at.x, at.y, at.z),
                format!(
                    "the nearest node is {tag} at ({:.6}, {:.6}, {:.6})",
                    x.x, x.y, x.z
                ),
            ));
        } else if distance > 1e-6 * longest_edge {
            decisions.push(format!(
                "{}: no node at ({}, {}, {}); node {tag} at ({:.6}, {:.6}, {:.6}) is held instead",
                entry.name, at.x, at.y, at.z, x.x, x.y, x.z
            ));
        }
        let point = FixedPoint {
            node: node as u32,
            displacement: entry.value.displacement,
            name: entry.name.clone(),
        };
        bound.push((entry, point));
    }
    bound
}

/// The nearest node that is in a cell, its distance, and the longest edge of a cell there.
fn nearest_node(mesh: &Mesh, at: DVec3) -> Option<(usize, f64, f64)> {
    let used = (0..mesh.nodes.len()).filter(|&node| mesh.sectors.count[node] > 0);
    let distance = |&node: &usize| mesh.nodes[node].distance(at);
    let node = used.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let cells = (0..mesh.cells.len()).map(|cell| mesh.cells.nodes_of(cell));
    let around = cells
        .filter(|nodes| nodes.contains(&(node as u32)))
        .flatten();
    let longest_edge = around.map(|&other| mesh.nodes[other as usize].distance(mesh.nodes[node]));
    Some((node, distance(&node), longest_edge.fold(0.0, f64::max)))
}
