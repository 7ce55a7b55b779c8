//! Flow in rigid rock that is stopped between two load steps.

use std::fs;
use std::ops::ControlFlow;

use kluft_run::{Ending, MeshInput, Observer, Origin, Request};
use kluft_scene::Scene;

use crate::harness::{root, scratch, summary};

/// Stops a run when it is first asked whether to go on.
struct Impatient {
    asked: usize,
}

impl Observer for Impatient {
    fn goes_on(&mut self) -> ControlFlow<()> {
        self.asked += 1;
        ControlFlow::Break(())
    }
}

#[test]
fn a_flow_that_is_stopped_keeps_its_steps_and_goes_on() {
    let place = root().join("geometries/network-flow");
    let file = place.join("scene.toml");
    let text = fs::read_to_string(&file).expect("a scene");
    let text = format!("{text}\n[load]\nsteps = [0.25, 0.5, 1.0]\n");
    let scene = Scene::parse(&text, "scene.toml", &place).expect("a sound scene");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let pool = pool.expect("threads");
    let folder = scratch();
    let solve = |resume: bool, observer: &mut dyn Observer| {
        let request = Request {
            folder: Some(folder.path()),
            origin: Some(Origin {
                file: &file,
                text: &text,
            }),
            resume,
            ..Request::in_memory(&scene, MeshInput::OfScene, &pool)
        };
        kluft_run::run(request, observer)
            .expect("no defects")
            .ending
    };
    let steps = || summary(folder.path())["steps"].as_array().map(Vec::len);
    let mut impatient = Impatient { asked: 0 };
    assert_eq!(solve(false, &mut impatient), Ending::Stopped);
    assert_eq!((impatient.asked, steps()), (1, Some(1)));
    assert_eq!(solve(true, &mut ()), Ending::Solved);
    assert_eq!(steps(), Some(3));
}
