//! Inputs that are wrong: every defect comes with its place and its remedy, and nothing is lost.
//!
//! The cases start from a sound scene, `base.toml` on `base.msh`: two cells with a joint between.

mod fields;
mod fluid;
mod geometry;
mod load;
mod mesh;
mod probes;
mod problem;
mod scene;
mod values;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::harness::{Run, edited, files, kluft_with, scratch};

const SCENE: &str = include_str!("base.toml");
const MESH: &str = include_str!("base.msh");

type Edits = &'static [(&'static str, &'static str)];

/// One wrong input and what the program must say of it.
#[derive(Clone, Copy)]
struct Case {
    /// What is wrong.
    name: &'static str,
    /// What to replace in `base.toml`.
    scene: Edits,
    /// What to replace in `base.msh`.
    mesh: Edits,
    /// More files.
    files: Edits,
    /// More environment.
    environment: Edits,
    /// Number of defects.
    defects: usize,
    /// Texts that the messages hold: place, problem, remedy.
    says: &'static [&'static str],
}

/// A case that changes nothing.
const SOUND: Case = Case {
    name: "",
    scene: &[],
    mesh: &[],
    files: &[],
    environment: &[],
    defects: 1,
    says: &[],
};

/// A file of this content is not written at all.
const MISSING: &str = "(missing)";
/// A file of this content becomes a folder.
const FOLDER: &str = "(folder)";

impl Case {
    fn lay_out(&self, folder: &Path) {
        let scene = edited(SCENE, self.scene);
        let mesh = edited(MESH, self.mesh);
        let mut laid: BTreeMap<&str, &str> = self.files.iter().copied().collect();
        laid.entry("scene.toml").or_insert(&scene);
        laid.entry("base.msh").or_insert(&mesh);
        for (name, content) in laid {
            match content {
                MISSING => {}
                FOLDER => fs::create_dir(folder.join(name)).expect("a folder"),
                text => fs::write(folder.join(name), text).expect("a file"),
            }
        }
    }

    fn run(&self, folder: &Path) -> Run {
        let (scene, out) = (folder.join("scene.toml"), folder.join("out"));
        let arguments = [
            "run".as_ref(),
            scene.as_os_str(),
            "--out".as_ref(),
            out.as_os_str(),
        ];
        kluft_with(&arguments, self.environment)
    }

    /// What the run did wrong.
    fn complaints(&self, run: &Run) -> Vec<String> {
        let mut complaints = Vec::new();
        let mut check = |holds: bool, complaint: String| {
            if !holds {
                complaints.push(complaint);
            }
        };
        check(run.code == Some(2), format!("exit code {:?}", run.code));
        check(run.out.is_empty(), format!("standard output: {}", run.out));
        check(!run.err.contains("panicked"), "it panicked".into());
        let head = match self.defects {
            1 => "1 defect in the input\n".to_owned(),
            count => format!("{count} defects in the input\n"),
        };
        check(
            run.err.starts_with(&head),
            format!("it does not begin with {head:?}"),
        );
        let remedies = run.err.matches("\n    remedy: ").count();
        check(remedies == self.defects, format!("{remedies} remedies"));
        for text in self.says {
            check(run.err.contains(text), format!("it does not say {text:?}"));
        }
        complaints
    }

    /// Runs the case where a sound scene has left `former` results.
    fn judge(&self, former: &BTreeMap<String, Vec<u8>>) -> Option<String> {
        let folder = scratch();
        let out = folder.path().join("out");
        fs::create_dir(&out).expect("a folder");
        for (name, content) in former {
            fs::write(out.join(name), content).expect("a former result");
        }
        self.lay_out(folder.path());
        let run = self.run(folder.path());
        let mut complaints = self.complaints(&run);
        let mut left = files(&out);
        // The mesh that gmsh made is there to be looked at.
        left.remove("mesh.msh");
        if left != *former {
            let names: Vec<&String> = left.keys().collect();
            complaints.push(format!(
                "the former results changed; now there is {names:?}"
            ));
        }
        let all = complaints.join("\n  ");
        (!complaints.is_empty())
            .then(|| format!("{}:\n  {all}\n--- it said\n{}", self.name, run.err))
    }
}

/// Results of the sound scene.
fn former_results() -> BTreeMap<String, Vec<u8>> {
    let folder = scratch();
    SOUND.lay_out(folder.path());
    let run = SOUND.run(folder.path());
    assert_eq!(
        (run.code, run.err.as_str(), run.out.as_str()),
        (Some(0), "", "")
    );
    files(&folder.path().join("out"))
}

fn judge_all(cases: &[Case]) {
    let former = former_results();
    assert_eq!(
        former.len(),
        9,
        "two collections, two grids, both together, a summary, a history, a page, a checkpoint"
    );
    let verdicts: Vec<String> = cases
        .iter()
        .filter_map(|case| case.judge(&former))
        .collect();
    let count = verdicts.len();
    assert!(
        count == 0,
        "{count} of {} cases\n\n{}",
        cases.len(),
        verdicts.join("\n")
    );
}

#[test]
fn there_are_many_cases() {
    let groups = [
        fluid::CASES,
        scene::CASES,
        values::CASES,
        load::CASES,
        mesh::CASES,
        geometry::CASES,
        problem::CASES,
    ];
    let count = groups.concat().len();
    assert!(count >= 40, "{count} cases");
}

#[test]
fn a_scene_that_is_not_there_is_named() {
    let run = crate::harness::kluft(&["run", "no/such/scene.toml"]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    assert!(
        run.err
            .contains("no/such/scene.toml: the scene cannot be read"),
        "{}",
        run.err
    );
    assert!(
        run.err.contains("remedy: give the path of a scene file"),
        "{}",
        run.err
    );
    assert!(!Path::new("no").exists());
}

#[test]
fn a_scene_that_is_not_text_is_named() {
    let folder = scratch();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, b"title = \"\xff\"\n").expect("a scene");
    let run = crate::harness::kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    assert!(
        run.err.contains("remedy: save the file as UTF-8 text"),
        "{}",
        run.err
    );
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = scratch();
    SOUND.lay_out(folder.path());
    let (scene, out) = (
        folder.path().join("scene.toml"),
        folder.path().join("base.msh/out"),
    );
    let arguments = [
        "run".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ];
    let run = kluft_with(&arguments, &[]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    assert!(run.err.contains(&out.display().to_string()), "{}", run.err);
    assert!(
        run.err
            .contains("remedy: name a folder you may write to with --out"),
        "{}",
        run.err
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("base.msh")).expect("the mesh"),
        MESH
    );
}
