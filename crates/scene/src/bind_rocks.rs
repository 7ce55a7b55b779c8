//! Gives cells their rocks, by the names of volumes and by values that vary.

use glam::DVec3;
use kluft_mesh::{Defect, Mesh};
use kluft_solver::Problem;
use lie_core::Rock;

use crate::look::Look;
use crate::rock::RockEntry;
use crate::roles::DEFAULT;
use crate::scene::{Named, Scene};

/// What is wrong with a rock that leaves the plane of its mesh, and what helps.
const LEAVES_PLANE: [&str; 2] = [
    "strains in the plane of the mesh shear this rock across the plane",
    "give a dip of 90, with which bedding stands on the plane x, y (its normal points to \
     dip_direction, clockwise from y), or a dip of 0, or a mesh of volumes",
];

/// Rocks that leave the plane of a mesh of the plane.
fn wrong_axes(scene: &Scene, mesh: &Mesh) -> Vec<Defect> {
    let leaves = |entry: &&Named<RockEntry>| {
        !entry.value.has_varying_axes() && leaves_plane(&entry.value.rock)
    };
    let rocks = scene.rocks.iter().filter(|_| mesh.is_plane());
    let defects = rocks
        .filter(leaves)
        .map(|entry| Defect::new(&entry.place, LEAVES_PLANE[0], LEAVES_PLANE[1]));
    defects.collect()
}

/// The rocks; rigid rock needs no section.
pub(crate) fn rocks(scene: &Scene) -> Vec<Rock> {
    let rocks = scene.rocks.iter().map(|entry| entry.value.rock.clone());
    match scene.rocks.is_empty() {
        true => vec![Rock::rigid(0.0)],
        false => rocks.collect(),
    }
}

/// Rock of each cell, decided once for each set of groups that cells belong to.
pub(crate) fn bind_rocks(scene: &Scene, mesh: &Mesh, defects: &mut Vec<Defect>) -> Vec<u32> {
    defects.extend(wrong_axes(scene, mesh));
    let default = scene.rocks.iter().position(|entry| entry.name == DEFAULT);
    let mut used = vec![false; mesh.group_sets.len()];
    for &set in &mesh.cell_group_set {
        used[set as usize] = true;
    }
    let rock_of_set: Vec<u32> = mesh
        .group_sets
        .iter()
        .zip(used)
        .map(|(set, used)| {
            let names: Vec<&str> = set.iter().map(|&g| mesh.groups[g].name.as_str()).collect();
            let matches = |entry: &Named<RockEntry>| names.contains(&entry.name.as_str());
            let found: Vec<usize> = (0..scene.rocks.len())
                .filter(|&rock| matches(&scene.rocks[rock]))
                .collect();
            if let (true, Some(defect)) = (used, rock_defect(scene, &names, &found, default)) {
                defects.push(defect);
            }
            found.first().copied().or(default).unwrap_or(0) as u32
        })
        .collect();
    let sets = mesh.cell_group_set.iter();
    sets.map(|&set| rock_of_set[set as usize]).collect()
}

fn rock_defect(
    scene: &Scene,
    names: &[&str],
    found: &[usize],
    default: Option<usize>,
) -> Option<Defect> {
    let volume = match names {
        [] => "the cells in no physical volume".to_owned(),
        names => format!("physical volume `{}`", names.join("`, `")),
    };
    match (found, default) {
        // Rigid rock needs no section.
        ([], None) if scene.rocks.is_empty() => None,
        ([], None) => Some(Defect::new(
            volume,
            "no rock is given for it",
            "add a [rock.NAME] section for it, or [rock.default] for all volumes not named",
        )),
        ([first, second, ..], _) => Some(Defect::new(
            volume,
            format!(
                "two rocks are given for the same cells: `{}` and `{}`",
                scene.rocks[*first].name, scene.rocks[*second].name
            ),
            "name only one of the volumes that overlap in the scene",
        )),
        _ => None,
    }
}

/// Rocks without a density where gravity acts, and gravity out of a plane.
pub(crate) fn wrong_gravity(scene: &Scene, mesh: &Mesh) -> Vec<Defect> {
    let gravity = scene.body.gravity;
    let acts = gravity != DVec3::ZERO && !scene.is_rigid();
    let rocks = scene.rocks.iter();
    let without = rocks.filter(|entry| acts && entry.value.rock.density == 0.0);
    let without = without.map(|entry| {
        Defect::new(
            &entry.place,
            "gravity acts, but this rock has no density",
            "add `density = 2700` (kg/m^3)",
        )
    });
    let leaves = mesh.is_plane() && gravity.z != 0.0;
    let out_of_plane = leaves.then(|| {
        Defect::new(
            "[body]",
            "gravity has a part along z, out of the plane of the mesh",
            "write it along y: gravity = [0, -9.81, 0]",
        )
    });
    without.chain(out_of_plane).collect()
}

/// Whether strains in the plane z = 0 shear a rock across it.
fn leaves_plane(rock: &Rock) -> bool {
    let anisotropy = rock.anisotropy.as_ref();
    anisotropy.is_some_and(|own| !own.is_symmetric_about_xy())
}

/// Gives each cell of a rock that varies a rock of its own, by the values in the middle of the
/// cell.
pub(crate) fn vary_rocks(problem: &mut Problem, look: &mut Look<'_>) {
    let scene = look.scene;
    let mut rocks = scene.rocks.iter();
    if rocks.all(|entry| entry.value.varying().next().is_none()) {
        return;
    }
    let materials = problem.rock_of_cell.clone();
    for (number, entry) in scene.rocks.iter().enumerate() {
        let own = materials.iter().enumerate();
        let own = own.filter(|(_, material)| **material as usize == number);
        vary_rock(problem, (number, entry), own.map(|(cell, _)| cell), look);
    }
    problem.varying.material_of_cell = Some(materials);
}

fn vary_rock(
    problem: &mut Problem,
    (number, entry): (usize, &Named<RockEntry>),
    cells: impl Iterator<Item = usize>,
    look: &mut Look<'_>,
) {
    let middle = |mesh: &Mesh, cell: usize| {
        let corners = mesh.corners(&mesh.cells, cell);
        corners.iter().sum::<DVec3>() / corners.len() as f64
    };
    let cells = cells.map(|cell| (cell, middle(&problem.mesh, cell)));
    let cells: Vec<(usize, DVec3)> = cells.collect();
    let places: Vec<DVec3> = cells.iter().map(|(_, place)| *place).collect();
    let fields: Vec<_> = entry.value.varying().collect();
    let seen = fields.iter();
    let seen: Vec<_> = seen.map(|field| look.at(field, &places, &[0.0])).collect();
    let means: Option<Vec<f64>> = (seen.iter())
        .map(|seen| seen.as_ref().map(|seen| seen.mean))
        .collect();
    let Some(means) = means.filter(|means| !means.is_empty() && !places.is_empty()) else {
        return;
    };
    problem.rocks[number] = entry.value.with(&means);
    let mut refused = Vec::new();
    for (cell, place) in cells {
        let values: Vec<f64> = fields.iter().map(|own| own.field.at(place, 0.0)).collect();
        let rock = entry.value.with(&values);
        let refusal = entry.value.refusal(&values);
        let refusal = refusal.map(|own| [own.problem, own.remedy]);
        let is_out = problem.mesh.is_plane() && leaves_plane(&rock);
        refused.extend(
            refusal
                .or(is_out.then(|| LEAVES_PLANE.map(str::to_owned)))
                .map(|own| (place, own)),
        );
        problem.rock_of_cell[cell] = problem.rocks.len() as u32;
        problem.rocks.push(rock);
    }
    look.defects.extend(first_refusal(entry, &refused));
}

/// The first place where there is no rock, and how many more there are.
fn first_refusal(entry: &Named<RockEntry>, refused: &[(DVec3, [String; 2])]) -> Option<Defect> {
    let (place, [problem, remedy]) = refused.first()?;
    let others = match refused.len() {
        1 => String::new(),
        count => format!(", and in {} more cells", count - 1),
    };
    let [x, y, z] = place.to_array();
    let problem = format!("at ({x:.6}, {y:.6}, {z:.6}){others}: {problem}");
    Some(Defect::new(&entry.place, problem, remedy.clone()))
}
