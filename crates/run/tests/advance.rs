//! Load steps on prepared rock, beside the closed form of the law.

use kluft_io::Values;
use kluft_mesh::Draft;
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_run::{
    Advance, Interruption, MeshInput, PreparedRock, Request, Saving, StepResult, with_prepared_rock,
};
use kluft_scene::Scene;

/// A cube of rock cut in two by a linear joint under 8 MPa.
const SCENE: &str = r#"
[mesh]
file = "in memory.msh"
[rock.default]
young_modulus = 50e9
poisson_ratio = 0.0
[fracture.joint]
aperture = 1e-4
normal_stiffness = 1e11
shear_stiffness = 1e10
[boundary.top]
traction = [0, 0, -8e6]
[boundary.bottom]
displacement = { x = 0.0, y = 0.0, z = 0.0 }
"#;

fn draft() -> Draft {
    let patches = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("bottom", &|x| x[2] == 0.0),
        Patch::new("top", &|x| x[2] == 1.0),
    ];
    tetrahedra([4; 3], [1.0; 3], &patches)
}

fn scene(text: &str) -> Scene {
    Scene::parse(text, "a scene in memory", ".".as_ref()).expect("a sound scene")
}

fn with_rock<T: Send>(drive: impl FnOnce(&mut PreparedRock<'_, '_, '_>) -> T + Send) -> T {
    let (scene, mesh) = (scene(SCENE), MeshInput::Draft(Box::new(draft())));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let pool = pool.expect("threads");
    let request = Request::in_memory(&scene, mesh, &pool);
    match with_prepared_rock(request, &mut (), drive) {
        Ok(driven) => driven,
        Err(Interruption::Defects(defects)) => panic!("{defects:?}"),
        Err(_) => panic!("the rock is prepared"),
    }
}

/// A step in which all acts as the scene says, and this pressure.
fn asked(rock: &PreparedRock<'_, '_, '_>, pressure: Option<f64>) -> Advance {
    let points = rock.fracture_points().points.len();
    Advance {
        time: None,
        factors: vec![1.0; rock.acting().len()],
        pressures: pressure.map(|pressure| vec![pressure; points]),
        laws: None,
        with_rock: false,
    }
}

fn solved(rock: &mut PreparedRock<'_, '_, '_>, asked: &Advance) -> StepResult {
    match rock.advance(asked) {
        Ok(result) => result,
        Err(Interruption::Defects(defects)) => panic!("{defects:?}"),
        Err(_) => panic!("a linear joint converges"),
    }
}

/// Every aperture, which a linear law without Poisson's effect gives: `b0 - (8 MPa - p) / K_n0`.
fn assert_closed(step: &StepResult, pressure: f64, stiffness: f64) {
    let expected = 1e-4 - (8e6 - pressure) / stiffness;
    let mut fields = step.fracture_grid.point_fields.iter();
    let Values::Real(apertures) = &fields
        .find(|field| field.name == "aperture")
        .expect("a field")
        .values
    else {
        panic!("apertures are numbers");
    };
    for aperture in apertures {
        assert!(
            (aperture / expected - 1.0).abs() < 1e-9,
            "{aperture} {expected}"
        );
    }
}

#[test]
fn pressures_and_loads_change_from_step_to_step() {
    with_rock(|rock| {
        for pressure in [None, Some(3e6), Some(5e6), None] {
            let asked = asked(rock, pressure);
            let step = solved(rock, &asked);
            // That of the step before stays where none is given.
            assert_closed(
                &step,
                pressure.unwrap_or(if step.summary.time > 2.0 { 5e6 } else { 0.0 }),
                1e11,
            );
        }
        let top = rock.acting().names().iter().position(|name| name == "top");
        let mut unloaded = asked(rock, Some(0.0));
        unloaded.factors[top.expect("a load")] = 0.0;
        let step = solved(rock, &unloaded);
        assert_closed(&step, 8e6, 1e11);
        assert_eq!(
            rock.history()
                .lines()
                .filter(|line| line.contains("fracture,joint"))
                .count(),
            5
        );
    });
}

#[test]
fn laws_change_from_step_to_step_and_numbers_that_do_not_fit_are_refused() {
    with_rock(|rock| {
        let mut stiffer = asked(rock, None);
        let text = SCENE.replace("normal_stiffness = 1e11", "normal_stiffness = 4e11");
        stiffer.laws = Some(scene(&text).laws(&["joint".to_owned()]));
        assert_closed(&solved(rock, &stiffer), 0.0, 4e11);
        let mut unfit = asked(rock, None);
        unfit.factors.pop();
        unfit.pressures = Some(vec![0.0]);
        let Err(Interruption::Defects(defects)) = rock.advance(&unfit) else {
            panic!("two lists are too short");
        };
        assert_eq!(defects.len(), 2, "{defects:?}");
    });
}

#[test]
fn steps_that_were_asked_for_are_saved_as_those_of_a_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    with_rock(|rock| {
        let mut asked = asked(rock, Some(1e6));
        asked.with_rock = true;
        let step = solved(rock, &asked);
        let mut saving = Saving::into(&out, rock.summary(), rock.history()).expect("a new folder");
        let saved = saving.step(step.summary.time, step.rock, step.fracture_grid);
        saved
            .and_then(|()| saving.finish())
            .expect("files are written");
    });
    for name in [
        "rock.pvd",
        "fractures.pvd",
        "rock_0001.vtu",
        "fractures_0001.vtu",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let history = std::fs::read_to_string(out.join("history.csv")).expect("a history");
    assert!(history.lines().any(|line| line.contains("fracture,joint")));
    let summary = std::fs::read_to_string(out.join("summary.json")).expect("a summary");
    assert!(summary.contains("\"completed\": 1.0"), "{summary}");
}
