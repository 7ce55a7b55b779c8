//! Random networks of polygons in a box, meshed by gmsh, and random problems on them.

use std::fmt::Write as _;
use std::fs;

use glam::DVec3;
use kluft_io::{Dimension, GmshOptions, Meshing, load_msh, mesh_geometry};
use kluft_mesh::{Defect, Draft, Group, Mesh, SurfaceRole};
use kluft_solver::{Condition, Fracture, Problem, Support, SurfaceLoad};
use lie_core::{Closure, ClosureKind, FractureLaw};

use crate::random::Random;
use crate::scenes;

/// Facets this close to the plane of a polygon (m) lie in it; gmsh keeps planes to about 1e-12.
const IN_PLANE: f64 = 1e-8;

/// A plane convex polygon.
pub struct Polygon {
    /// In order around it (m).
    pub corners: Vec<DVec3>,
    /// Of its plane, of length 1.
    pub normal: DVec3,
}

/// A regular polygon of 3 to 8 corners, large enough to cross others and to leave the box at times.
fn polygon(random: &mut Random) -> Polygon {
    let centre = DVec3::splat(0.5) + 0.35 * random.vector();
    let normal = random.direction();
    let (a, b) = normal.any_orthonormal_pair();
    let radius = random.between(0.25, 0.8);
    let count = 3 + (6.0 * random.unit()) as usize;
    let turn = random.unit();
    let corner = |i: usize| {
        let angle = std::f64::consts::TAU * (i as f64 + turn) / count as f64;
        centre + radius * (angle.cos() * a + angle.sin() * b)
    };
    Polygon {
        corners: (0..count).map(corner).collect(),
        normal,
    }
}

/// 3 to 12 polygons.
pub fn polygons(seed: u64) -> Vec<Polygon> {
    let mut random = Random::new(seed);
    let count = 3 + (10.0 * random.unit()) as usize;
    (0..count).map(|_| polygon(&mut random)).collect()
}

/// Vertical planes through the middle line of the box, at equal angles.
pub fn fan(count: usize) -> Vec<Polygon> {
    let plane = |i: usize| {
        let (sin, cos) = (std::f64::consts::PI * (i as f64 + 0.3) / count as f64).sin_cos();
        let (along, up) = (DVec3::new(cos, sin, 0.0), DVec3::Z);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corner = |(a, b): (f64, f64)| DVec3::splat(0.5) + a * along + b * up;
        Polygon {
            corners: corners.map(corner).to_vec(),
            normal: DVec3::new(-sin, cos, 0.0),
        }
    };
    (0..count).map(plane).collect()
}

/// A unit cube cut by the polygons: outer faces by name, all fractures as "joints".
fn geometry(polygons: &[Polygon], size: f64) -> String {
    let mut text = String::from("SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\n");
    text += "cut() = {};\n";
    for (number, polygon) in polygons.iter().enumerate() {
        let mut lines = Vec::new();
        for corner in &polygon.corners {
            let _ = writeln!(
                text,
                "p = newp; Point(p) = {{{:.15}, {:.15}, {:.15}}}; c_{number}() += {{p}};",
                corner.x, corner.y, corner.z
            );
        }
        for i in 0..polygon.corners.len() {
            let next = (i + 1) % polygon.corners.len();
            lines.push(format!(
                "l = newl; Line(l) = {{c_{number}({i}), c_{number}({next})}}; e_{number}() += {{l}};"
            ));
        }
        text += &lines.join("\n");
        let _ = writeln!(
            text,
            "\nk = newll; Curve Loop(k) = e_{number}(); s = news; Plane Surface(s) = {{k}};\ncut() \
             += BooleanIntersection{{ Surface{{s}}; Delete; }}{{ Volume{{1}}; }};"
        );
    }
    text += "BooleanFragments{ Volume{1}; Delete; }{ Surface{cut()}; Delete; }\n";
    text += "e = 1e-4;\njoints() = Surface{:};\n";
    let spans = [["-e", "e"], ["1 - e", "1 + e"]];
    for (face, name) in scenes::FACES.iter().enumerate() {
        let mut range = [["-e", "1 + e"]; 3];
        range[face / 2] = spans[face % 2];
        let bounds = [0, 1]
            .map(|end| range.map(|span| span[end]).join(", "))
            .join(", ");
        let _ = writeln!(
            text,
            "f_{face}() = Surface In BoundingBox {{{bounds}}}; joints() -= f_{face}();\nPhysical \
             Surface(\"{name}\") = f_{face}();"
        );
    }
    text += "Physical Volume(\"rock\") = Volume{:};\nPhysical Surface(\"joints\") = joints();\n";
    let _ = writeln!(
        text,
        "Mesh.MeshSizeMin = {size};\nMesh.MeshSizeMax = {size};"
    );
    text
}

/// What gmsh makes of polygons; every polygon becomes a physical surface of its own, by its plane.
///
/// # Errors
/// What gmsh says of intersections it cannot mesh.
pub fn meshed(polygons: &[Polygon], size: f64) -> Result<Draft, Vec<Defect>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let script = folder.path().join("network.geo");
    fs::write(&script, geometry(polygons, size)).expect("a writable folder");
    let file = folder.path().join("network.msh");
    mesh_geometry(&Meshing {
        geometry: &script,
        parameters: &[],
        order: 1,
        dimension: Dimension::Volumes,
        sizes: None,
        output: &file,
        gmsh: &GmshOptions::default(),
    })?;
    let mut draft = load_msh(&file, folder.path(), &GmshOptions::default())?;
    name_by_plane(&mut draft, polygons);
    Ok(draft)
}

fn name_by_plane(draft: &mut Draft, polygons: &[Polygon]) {
    let joints = draft.groups.iter().position(|group| group.name == "joints");
    let joints = joints.expect("the geometry names its joints");
    let first_set = draft.group_sets.len();
    for number in 0..polygons.len() {
        draft.group_sets.push(vec![draft.groups.len()]);
        draft.groups.push(Group {
            dimension: 2,
            tag: 1000 + number as i32,
            name: format!("fracture {number}"),
        });
    }
    for facet in 0..draft.facets.tags.len() {
        let set = draft.facets.group_set[facet] as usize;
        if draft.group_sets[set].contains(&joints) {
            let nodes = draft.facets.elements.nodes_of(facet);
            let corners: Vec<DVec3> = nodes
                .iter()
                .map(|&n| draft.nodes[n as usize].into())
                .collect();
            let plane = polygons.iter().position(|polygon| holds(polygon, &corners));
            let plane = plane.expect("every facet lies in a polygon");
            draft.facets.group_set[facet] = (first_set + plane) as u32;
        }
    }
}

fn holds(polygon: &Polygon, corners: &[DVec3]) -> bool {
    let away = |x: &DVec3| (*x - polygon.corners[0]).dot(polygon.normal).abs();
    corners.iter().all(|x| away(x) < IN_PLANE)
}

/// The mesh of a network.
pub fn built(draft: Draft) -> Mesh {
    let mut roles = scenes::roles(&draft);
    for (group, role) in draft.groups.iter().zip(&mut roles) {
        // Its facets are those of the fractures now.
        if group.name == "joints" {
            *role = SurfaceRole::Unused;
        }
    }
    Mesh::build(draft, &roles).unwrap_or_else(|defects| panic!("{defects:?}"))
}

/// A random problem on a network.
pub fn random_problem(draft: Draft, seed: u64) -> Problem {
    let mut problem = scenes::problem(built(draft), scenes::joint(ClosureKind::Linear));
    randomise(&mut problem, seed);
    problem
}

/// Random rock, joints with stiffnesses over three decades, tractions and rollers, displacements
/// that are prescribed and not zero.
pub fn randomise(problem: &mut Problem, seed: u64) {
    let mut random = Random::new(seed + 1_000_000);
    problem.rocks[0].poisson_ratio = random.between(0.05, 0.4);
    for fracture in &mut problem.fractures {
        *fracture = random_fracture(&mut random);
    }
    for face in 0..6 {
        let condition = random_condition(problem, face, &mut random);
        problem.conditions.push(condition);
    }
}

fn random_fracture(random: &mut Random) -> Fracture {
    Fracture {
        law: FractureLaw::elastic(
            Closure::new(1e-4, 1e9 * 1e3_f64.powf(random.unit()), ClosureKind::Linear),
            1e9 * 1e3_f64.powf(random.unit()),
        ),
        fluid_pressure: random.between(0.0, 2e6),
    }
}

/// Low faces are held along their normals by rollers or by values, the bottom always by a value,
/// the right face at times; every face is loaded.
fn random_condition(problem: &Problem, face: usize, random: &mut Random) -> Condition {
    let mut held = [None; 3];
    held[face / 2] = Some(1e-4 * random.between(-1.0, 1.0));
    let rolls = random.unit() < 0.5;
    let support = match scenes::FACES[face] {
        "left" | "front" if rolls => Some(Support::Symmetry),
        "left" | "front" | "bottom" => Some(Support::Displacement(held)),
        "right" if rolls => Some(Support::Displacement(held)),
        _ => None,
    };
    Condition {
        boundary: scenes::boundary(problem, scenes::FACES[face]),
        load: Some(SurfaceLoad::Traction(5e6 * random.vector())),
        support,
    }
}
