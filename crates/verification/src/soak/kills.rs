//! Runs that are killed at random instants and resumed: to the last bit the results of one that is
//! not.

use std::fs;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use kluft_solver::LinearMethod;

use super::asked::Asked;
use super::folder::{Files, LIMIT, Workshop, broken, difference, results};
use super::program::left_behind;
use super::random_stream::RandomStream;
use super::tally::{Miss, Verdict, finding};
use crate::report::{Finding, Study};

/// The suite.
pub const STUDY: Study = Study {
    name: "kills",
    title: "Killed runs",
    subject: "up to four kills at random instants of a run of seven load steps, then `--resume`",
    run: |effort| run(&Asked::of(effort)),
};

const TEXT: &str = "A run is killed (signal 9) at a random instant of the time that it takes \
    undisturbed, every second time after its first load step, up to three times more while it resumes, then resumed to its end, with the direct, \
    condensed and iterative solver in turn. After each kill every file must be whole, collections \
    must list only what is there, and no gmsh may be left; at the end all files must have the bits \
    of the undisturbed run, but for times and memory.";

/// The scene of each linear solver, what it leaves undisturbed, and how long that takes.
struct Whole {
    scene: String,
    files: Files,
    took: Duration,
}

impl Whole {
    fn of(workshop: &Workshop, linear: LinearMethod) -> Self {
        let scene = format!("{linear}.toml");
        workshop.write_scene(&scene, 0.2, &linear.to_string());
        let (files, took) = workshop.undisturbed(&scene);
        Self { scene, files, took }
    }
}

/// Runs the suite.
pub fn run(asked: &Asked) -> Finding {
    let workshop = Workshop::new(&asked.program);
    let wholes = LinearMethod::ALL.map(|linear| Whole::of(&workshop, linear));
    let verdicts = asked.each(6, 100, |number| {
        let whole = &wholes[number % wholes.len()];
        let mut random = RandomStream::new(asked.seed, number);
        let verdict = killed(&workshop, whole, number, &mut random);
        verdict.unwrap_or_else(|miss| {
            miss.in_case(&format!("{number} (seed {}, {})", asked.seed, whole.scene))
        })
    });
    finding(TEXT, &verdicts)
}

/// Waits to a random instant of a run, every second time after its first load step: meshing takes
/// most of the time of a small scene.
fn wait(out: &Path, took: Duration, random: &mut RandomStream) {
    let begin = Instant::now();
    let is_late = random.chance(0.5);
    while is_late && !out.join("resume.bin").exists() && begin.elapsed() < took {
        thread::sleep(Duration::from_millis(1));
    }
    let longest = if is_late { 0.2 } else { 1.0 };
    thread::sleep(took.mul_f64(random.between(0.0, longest)));
}

fn killed(
    workshop: &Workshop,
    whole: &Whole,
    number: usize,
    random: &mut RandomStream,
) -> Result<Verdict, Miss> {
    // A folder with a name that no other begins with.
    let out = workshop.path(&format!("case-{number}-killed"));
    let (mut hit, mut late) = (0, 0);
    for attempt in 0..=random.below(4) {
        let started = workshop.start(&whole.scene, &out, attempt > 0);
        wait(&out, whole.took, random);
        hit += usize::from(started.kill());
        late += usize::from(out.join("resume.bin").exists());
        if let Some(left) = left_behind(&out).first() {
            return Err(Miss::of("a process left behind", left.clone()));
        }
        if let Some(what) = broken(&out) {
            return Err(Miss::of("a file that is not whole", what));
        }
    }
    let end = workshop.start(&whole.scene, &out, true).end(LIMIT);
    if end.code != Some(0) {
        return Err(Miss::of(
            "not resumed",
            format!("{:?}: {}", end.code, end.first_line()),
        ));
    }
    if let Some(what) = difference(&results(&out), &whole.files) {
        return Err(Miss::of("other results", what));
    }
    let _ = fs::remove_dir_all(&out);
    let what = match (hit, late) {
        (0, _) => "ended before it was killed",
        (_, 0) => "same bits, killed before the first step ended",
        _ => "same bits, killed between load steps",
    };
    Ok(Verdict::held(what))
}
