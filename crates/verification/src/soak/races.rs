//! Two runs for one folder: one wins, or one follows the other; nothing is mixed.

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use super::asked::Asked;
use super::folder::{Files, LIMIT, Workshop, broken, difference, results};
use super::program::{End, left_behind};
use super::random_stream::RandomStream;
use super::tally::{Miss, Verdict, finding};
use crate::report::{Finding, Study};

/// The suite.
pub const STUDY: Study = Study {
    name: "races",
    title: "Two runs for one folder",
    subject: "two scenes with different meshes, the second started while the first runs",
    run: |effort| run(&Asked::of(effort)),
};

const TEXT: &str = "Two scenes, or one scene twice, are run into one folder, the second started at \
    a random instant of the first 40 % of the first. Either one is refused (exit code 1 or 2) and the other ends with \
    0, or both end with 0, the second after the first. The folder must hold exactly what one of \
    them leaves when it is alone.";

/// Share of a run's own time by which a second run must end later, if it has followed the first.
const FOLLOWS: f64 = 0.6;

const SCENES: [(&str, f64); 2] = [("first.toml", 0.3), ("second.toml", 0.25)];

/// Runs the suite.
pub fn run(asked: &Asked) -> Finding {
    let workshop = Workshop::new(&asked.program);
    let alone = SCENES.map(|(scene, size)| {
        workshop.write_scene(scene, size, "direct");
        workshop.undisturbed(scene)
    });
    let verdicts = asked.each(6, 100, |number| {
        let mut random = RandomStream::new(asked.seed, number);
        let scenes = random.pick(&[[0, 1], [1, 0], [0, 0]]);
        let race = Race {
            workshop: &workshop,
            number,
            scenes,
            alone: scenes.map(|scene| &alone[scene].0),
            took: scenes.map(|scene| alone[scene].1),
        };
        let after = race.took[0].mul_f64(random.between(0.0, 0.4));
        race.run(after)
            .unwrap_or_else(|miss| miss.in_case(&format!("{number} (seed {})", asked.seed)))
    });
    finding(TEXT, &verdicts)
}

struct Race<'a> {
    workshop: &'a Workshop,
    number: usize,
    scenes: [usize; 2],
    alone: [&'a Files; 2],
    took: [Duration; 2],
}

impl Race<'_> {
    fn run(&self, after: Duration) -> Result<Verdict, Miss> {
        let out = self.workshop.path(&format!("case-{}-raced", self.number));
        let start = |which: usize| {
            let scene = SCENES[self.scenes[which]].0;
            let end = self.workshop.start(scene, &out, false).end(LIMIT);
            (end, Instant::now())
        };
        let [first, second] = thread::scope(|scope| {
            let first = scope.spawn(|| start(0));
            thread::sleep(after);
            let second = start(1);
            [first.join().expect("an end"), second]
        });
        let verdict = self.judged(
            [&first.0, &second.0],
            second.1.saturating_duration_since(first.1),
        )?;
        if let Some(left) = left_behind(&out).first() {
            return Err(Miss::of("a process left behind", left.clone()));
        }
        if let Some(what) = broken(&out) {
            return Err(Miss::of("a file that is not whole", what));
        }
        let found = results(&out);
        let mut differences = self.alone.iter().map(|alone| difference(&found, alone));
        let [a, b] = [differences.next().flatten(), differences.next().flatten()];
        if let (Some(a), Some(b)) = (a, b) {
            let what = format!("beside the first run {a}, beside the second {b}");
            return Err(Miss::of("mixed", what));
        }
        let _ = fs::remove_dir_all(&out);
        Ok(verdict)
    }

    fn judged(&self, ends: [&End; 2], later: Duration) -> Result<Verdict, Miss> {
        if let Some(fault) = ends.iter().find_map(|end| end.fault()) {
            return Err(Miss::of("fault", fault));
        }
        let words = |end: &End| format!("{:?}: {}", end.code, end.first_line());
        match ends.map(|end| end.code == Some(0)) {
            [true, true] if later >= self.took[1].mul_f64(FOLLOWS) => {
                Ok(Verdict::held("one followed the other"))
            }
            [true, true] => Err(Miss::of(
                "both at the same time",
                format!("{later:?} apart"),
            )),
            [true, false] => Ok(Verdict::held("the second was refused")),
            [false, true] => Ok(Verdict::held("the first was refused")),
            [false, false] => Err(Miss::of("none won", ends.map(words).join("; "))),
        }
    }
}
