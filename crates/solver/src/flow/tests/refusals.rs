//! What has no flow, by name.

use kluft_mesh::structured::Patch;
use kluft_mesh::{Defect, Mesh, Shape};

use super::{apertures, block, flow, on_side, pressure, smooth, square, well};
use crate::flow::{FlowSystem, NO_PRESSURE};
use crate::problem::{Conduit, Flow, FlowDrive, FlowPlace};

fn refused(mesh: &Mesh, flow: &Flow, apertures: &[f64]) -> Vec<Defect> {
    FlowSystem::of(mesh, flow, apertures).map_or_else(|defects| defects, |made| made.undriven())
}

#[test]
fn a_borehole_wider_than_the_cells_is_refused() {
    let mesh = square(8);
    let mut wide = well(&mesh, [0.5, 0.5, 0.5], pressure(1e6));
    wide.place = match wide.place {
        FlowPlace::Well { node, .. } => FlowPlace::Well { node, radius: 0.1 },
        other => other,
    };
    let flow = flow(&mesh, vec![wide]);
    let defects = refused(&mesh, &flow, &apertures(&mesh, |_, _| 1e-4));
    assert!(
        defects[0].problem.contains("radius of 0.1 m"),
        "{defects:?}"
    );
}

/// Two joints that do not meet.
fn apart() -> Mesh {
    let surfaces = [
        Patch::new("low", &|x| x[2] == 0.5),
        Patch::new("high", &|x| x[2] == 1.5),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &|x| x[0] == 1.0),
        Patch::new("side top", &|x| x[2] == 2.0),
    ];
    block(Shape::Tet4, ([2, 2, 4], [1.0, 1.0, 2.0]), &surfaces, |x| x)
}

#[test]
fn networks_without_a_pressure_are_refused_by_the_names_of_their_fractures() {
    let mesh = apart();
    let apertures = apertures(&mesh, |_, _| 1e-4);
    let rate = |value: f64, z: f64| well(&mesh, [0.5, 0.5, z], FlowDrive::Rate(value));
    let high = well(&mesh, [0.5, 0.5, 1.5], pressure(0.0));
    let cases = [
        (vec![high.clone()], "nothing drives"),
        (vec![high.clone(), rate(1e-6, 0.5)], "add up to 1.000000e-6"),
        (
            vec![
                high,
                rate(1e-6, 0.5),
                on_side(&mesh, "side left", FlowDrive::Rate(0.0)),
                well(&mesh, [0.5, 0.0, 0.5], FlowDrive::Rate(-1e-6)),
            ],
            "up to a constant",
        ),
    ];
    for (conditions, said) in cases {
        let defects = refused(&mesh, &flow(&mesh, conditions), &apertures);
        assert_eq!(defects.len(), 1, "{defects:?}");
        assert_eq!(defects[0].code, Some(NO_PRESSURE));
        assert_eq!(defects[0].place, "fracture `low`");
        assert!(defects[0].problem.contains(said), "{}", defects[0]);
    }
    let sealed = Flow {
        conduits: vec![Conduit::Sealed, smooth()],
        ..flow(&mesh, vec![well(&mesh, [0.5, 0.5, 1.5], pressure(0.0))])
    };
    assert!(refused(&mesh, &sealed, &apertures).is_empty());
}

#[test]
fn what_cannot_act_is_refused_by_name() {
    let mesh = apart();
    let sides = |names: [(&str, f64); 2]| {
        let all = names.map(|(name, value)| on_side(&mesh, name, pressure(value)));
        flow(&mesh, all.to_vec())
    };
    let open = apertures(&mesh, |_, _| 1e-4);
    let dry = refused(
        &mesh,
        &sides([("side left", 1.0), ("side top", 0.0)]),
        &open,
    );
    assert!(dry.len() == 1 && dry[0].place == "side top", "{dry:?}");
    let shut = apertures(&mesh, |_, fracture| 1e-4 * fracture as f64);
    let shut = refused(
        &mesh,
        &sides([("side left", 1.0), ("side right", 0.0)]),
        &shut,
    );
    assert!(
        shut.len() == 1 && shut[0].place == "fracture `low`",
        "{shut:?}"
    );
    let mut twice = sides([("side left", 1e5), ("side left", 2e5)]);
    let defects = refused(&mesh, &twice, &open);
    assert!(
        defects.len() == 1 && defects[0].problem.contains("200000 Pa"),
        "{defects:?}"
    );
    twice.conditions[1].drive = pressure(1e5);
    assert!(refused(&mesh, &twice, &open).is_empty());
}
