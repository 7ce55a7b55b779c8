//! A run that dies between its last load step and its end.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use kluft_run::{Ending, MeshInput, Observer, Origin, Outcome, Request, Stage, run};
use kluft_scene::Scene;
use serde_json::Value;

/// Spoils the page of a run once the grids of its last load step are written, so that the run
/// fails before its end.
struct Spoiler {
    page: PathBuf,
    grids: PathBuf,
}

impl Observer for Spoiler {
    fn stage_ends(&mut self, stage: Stage, _took: Duration) {
        if stage == Stage::Write && self.grids.exists() {
            fs::create_dir(&self.page).expect("a folder in its place");
        }
    }
}

fn solved(
    folder: &Path,
    resume: bool,
    observer: &mut dyn Observer,
) -> Result<Outcome, Vec<kluft_mesh::Defect>> {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../geometries/inclined-joint");
    let file = place.join("scene.toml");
    let text = fs::read_to_string(&file).expect("a scene");
    let text = format!("{text}\n[load]\nsteps = [0.5, 1.0]\n");
    let scene = Scene::parse(&text, "scene.toml", &place).expect("a sound scene");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let pool = pool.expect("threads");
    let request = Request {
        folder: Some(folder),
        origin: Some(Origin {
            file: &file,
            text: &text,
        }),
        resume,
        ..Request::in_memory(&scene, MeshInput::OfScene, &pool)
    };
    run(request, observer)
}

/// What a run says of itself, without times, memory and paths.
fn said(folder: &Path) -> Value {
    let text = fs::read(folder.join("summary.json")).expect("a summary");
    let mut value: Value = serde_json::from_slice(&text).expect("JSON");
    let object = value.as_object_mut().expect("an object");
    for key in [
        "seconds",
        "peak_memory_bytes",
        "predicted_memory_bytes",
        "provenance",
    ] {
        object.remove(key);
    }
    value
}

#[test]
fn a_run_that_dies_after_its_last_step_ends_when_it_is_resumed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [whole, died] = ["whole", "died"].map(|name| folder.path().join(name));
    solved(&whole, false, &mut ()).expect("no defects");
    let page = died.join("report.html");
    let grids = died.join("fractures_0002.vtu");
    let mut spoiler = Spoiler {
        page: page.clone(),
        grids,
    };
    solved(&died, false, &mut spoiler).expect_err("no place for the page");
    fs::remove_dir(&page).expect("removed");
    let outcome = solved(&died, true, &mut ()).expect("no defects");
    assert_eq!(outcome.ending, Ending::Solved);
    assert_eq!(said(&died), said(&whole));
    assert!(page.is_file());
    let again = solved(&died, true, &mut ()).expect("no defects");
    assert_eq!(again.ending, Ending::NothingLeft);
}
