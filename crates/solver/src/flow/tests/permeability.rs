//! Equivalent permeabilities beside Snow's formula, and networks that nothing drives.

use glam::DMat3;

use super::*;
use crate::flow::EquivalentPermeability;

const WIDTH: f64 = 1e-4;
/// `b^3 / 12` (m^3).
const CUBIC: f64 = WIDTH * WIDTH * WIDTH / 12.0;

/// A block cut by so many planes across some axes, each between two layers of cells.
fn cut(
    shape: Shape,
    counts: [usize; 3],
    size: [f64; 3],
    sets: &[(usize, usize)],
    bend: impl Fn([f64; 3]) -> [f64; 3],
) -> Mesh {
    let planes = sets
        .iter()
        .flat_map(|&(axis, count)| (1..=count).map(move |k| (axis, k)));
    let planes = planes.map(|(axis, k)| {
        let at = k as f64 * size[axis] / counts[axis] as f64;
        move |x: [f64; 3]| (x[axis] - at).abs() < 1e-9
    });
    let planes: Vec<_> = planes.collect();
    let names: Vec<String> = (0..planes.len()).map(|k| format!("joint {k}")).collect();
    let surfaces = names.iter().zip(&planes);
    let surfaces: Vec<Patch<'_>> = surfaces.map(|(name, on)| Patch::new(name, on)).collect();
    block(shape, (counts, size), &surfaces, bend)
}

fn of(mesh: &Mesh) -> EquivalentPermeability {
    let flow = flow(mesh, Vec::new());
    let apertures = apertures(mesh, |_, _| WIDTH);
    EquivalentPermeability::of(mesh, &flow, &apertures).expect("a permeability")
}

/// Components against those expected, as shares of the largest.
fn agrees(found: [[f64; 3]; 3], expected: DMat3, tolerance: f64) {
    let expected = expected.to_cols_array_2d();
    let largest = expected
        .as_flattened()
        .iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
        let error = (found - expected).abs();
        assert!(error <= tolerance * largest, "{found} {expected}");
    }
}

/// Six joints across a block 3 m long: `k = T / spacing` along them, and none across.
#[test]
fn parallel_joints_conduct_by_their_spacing() {
    for shape in SHAPES {
        let mesh = cut(shape, [3, 2, 6], [3.0, 2.0, 1.0], &[(2, 5)], |x| x);
        let found = of(&mesh);
        // Five of them in 1 m.
        let along = 5.0 * CUBIC;
        agrees(
            found.tensor.components,
            DMat3::from_diagonal(DVec3::new(along, along, 0.0)),
            1e-11,
        );
        is_close(found.tensor.principal[0], along, 1e-11);
        assert!(found.tensor.principal[2].abs() < 1e-11 * along);
        is_close(found.tensor.directions[2].z, 1.0, 1e-11);
        is_close(found.volume, 6.0, 1e-13);
        is_close(found.areas[1], 30.0, 1e-13);
        assert!(
            found.asymmetry < 1e-11 && found.mass_error < 1e-11,
            "{found:?}"
        );
    }
}

/// Three sets at right angles conduct alike in all directions; two that lean follow Snow.
#[test]
fn crossing_sets_add_up() {
    let sets = [(0, 2), (1, 2), (2, 2)];
    let mesh = cut(Shape::Tet4, [3, 3, 3], [1.0; 3], &sets, |x| x);
    let found = of(&mesh);
    agrees(
        found.tensor.components,
        DMat3::IDENTITY * (4.0 * CUBIC),
        1e-11,
    );
    agrees(
        found.tensor.components,
        DMat3::from_cols_array_2d(&found.through_going.components),
        1e-11,
    );

    // Sheared, so that the planes `x` lean; all still go through, and the volume stays.
    let mesh = cut(Shape::Tet4, [3, 3, 3], [1.0; 3], &sets[..1], |[x, y, z]| {
        [x + 0.7 * z, y, z]
    });
    let found = of(&mesh);
    let normal = DVec3::new(1.0, 0.0, -0.7).normalize();
    let across = DMat3::from_cols(normal.x * normal, normal.y * normal, normal.z * normal);
    let area = 2.0 * 1.49_f64.sqrt();
    agrees(
        found.tensor.components,
        (DMat3::IDENTITY - across) * (area * CUBIC),
        1e-11,
    );
}

/// What does not reach the outer surface counts in Snow's tensor only.
#[test]
fn fractures_that_end_in_the_rock_conduct_less() {
    let inside = |x: [f64; 3]| x[2] == 0.5 && (x[0] - 0.5).abs() < 0.3 && (x[1] - 0.5).abs() < 0.3;
    let mesh = block(
        Shape::Tet4,
        ([8, 8, 4], [1.0; 3]),
        &[Patch::new("joint", &inside)],
        |x| x,
    );
    let found = of(&mesh);
    assert_eq!(found.tensor.components, [[0.0; 3]; 3]);
    assert_eq!(found.areas[1], 0.0);
    let area = 0.25;
    is_close(found.areas[0], area, 1e-12);
    agrees(
        found.through_going.components,
        DMat3::from_diagonal(DVec3::new(area, area, 0.0)) * CUBIC,
        1e-11,
    );

    let half = |x: [f64; 3]| x[2] == 0.5 && x[0] <= 0.5;
    let mesh = block(
        Shape::Tet4,
        ([8, 8, 4], [1.0; 3]),
        &[Patch::new("joint", &half)],
        |x| x,
    );
    let found = of(&mesh);
    let [[xx, ..], [_, yy, _], _] = found.tensor.components;
    let whole = found.through_going.components[0][0];
    // Along the tip the pressure is linear and the tip does not matter; across it does.
    is_close(yy, whole, 1e-11);
    assert!(xx > 0.1 * whole && xx < 0.9 * whole, "{xx} {whole}");
    assert!(found.asymmetry < 1e-11, "{found:?}");
}

#[test]
fn facets_that_nothing_drives_are_found_and_left_out() {
    let low = |x: [f64; 3]| x[2] == 0.25;
    let high = |x: [f64; 3]| x[2] == 0.75;
    let surfaces = [
        Patch::new("low", &low),
        Patch::new("high", &high),
        Patch::new("side left", &|x| x[0] == 0.0 && x[2] <= 0.5),
    ];
    let mesh = block(Shape::Tet4, ([2, 2, 4], [1.0; 3]), &surfaces, |x| x);
    let mut flow = flow(&mesh, vec![on_side(&mesh, "side left", pressure(1e5))]);
    let apertures = apertures(&mesh, |_, _| WIDTH);
    let system = FlowSystem::of(&mesh, &flow, &apertures).expect("sound conditions");
    assert_eq!(system.undriven().len(), 1);
    let isolated = system.isolated_facets();
    let area: f64 = isolated
        .iter()
        .map(|&facet| mesh.facet_areas()[facet as usize].length())
        .sum();
    is_close(area, 1.0, 1e-13);
    assert!(
        isolated
            .iter()
            .all(|&facet| mesh.facets.fracture[facet as usize] == 1)
    );
    flow.inactive = isolated;
    let mut system = FlowSystem::of(&mesh, &flow, &apertures).expect("sound conditions");
    assert!(system.undriven().is_empty() && system.isolated_facets().is_empty());
    system.factorise().expect("positive definite");
    let state = system.solve(&Load::proportional(1.0)).expect("finite");
    assert_eq!(state.balance.inflow, 0.0);
    assert!(
        state
            .pressures
            .iter()
            .all(|pressure| (pressure - 1e5).abs() < 1e-7)
    );
}
