//! Runs that find the disk full: exit code 1, with what is kept.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::asked::Asked;
use super::folder::{Files, LIMIT, Workshop, broken, difference, results, visible};
use super::program::{End, left_behind, run as run_program};
use super::random_stream::RandomStream;
use super::tally::{Miss, Verdict, finding};
use crate::report::{Finding, Study};

/// The suite.
pub const STUDY: Study = Study {
    name: "disks",
    title: "Full disks",
    subject: "a disk of random size below what a run writes, empty or with former results",
    run: |effort| run(&Asked::of(effort)),
};

const TEXT: &str = "The folder of the results lies on a disk of its own (tmpfs) of random size, \
    every second time with the results of a former run in it; without the right to mount one, the \
    size of each file is limited instead. A run that the disk cannot hold must end with exit code 1 \
    and name the disk or the file; what it leaves is whole; former results are kept to the last bit \
    or spoken of; no process and no unfinished mesh is left.";

const SCENES: [(&str, f64); 2] = [("former.toml", 0.5), ("next.toml", 0.25)];

/// A disk that goes away with its owner.
struct Disk(PathBuf);

impl Disk {
    /// None where it cannot be mounted.
    fn of(folder: PathBuf, bytes: usize) -> Option<Self> {
        fs::create_dir_all(&folder).ok()?;
        let size = format!("size={}k", bytes.div_ceil(1024).max(4));
        let mut mount = Command::new("mount");
        let mount = mount
            .args(["-t", "tmpfs", "-o", &size, "tmpfs"])
            .arg(&folder);
        let is_mounted = mount.output().is_ok_and(|output| output.status.success());
        is_mounted.then_some(Self(folder))
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).output();
    }
}

/// Runs the suite.
pub fn run(asked: &Asked) -> Finding {
    let workshop = Workshop::new(&asked.program);
    let [former, next] = SCENES.map(|(scene, size)| {
        workshop.write_scene(scene, size, "direct");
        workshop.undisturbed(scene);
        workshop.path(&format!("{scene}-undisturbed"))
    });
    let verdicts = asked.each(6, 50, |number| {
        let case = Case {
            workshop: &workshop,
            program: &asked.program,
            out: workshop.path(&format!("case-{number}-full")),
            former: if number % 2 == 1 {
                visible(&former)
            } else {
                Files::new()
            },
            next: visible(&next),
            expected: results(&next),
        };
        let verdict = case.run(&mut RandomStream::new(asked.seed, number));
        verdict.unwrap_or_else(|miss| miss.in_case(&format!("{number} (seed {})", asked.seed)))
    });
    finding(TEXT, &verdicts)
}

struct Case<'a> {
    workshop: &'a Workshop,
    program: &'a Path,
    out: PathBuf,
    former: Files,
    next: Files,
    expected: Files,
}

fn size(files: &Files) -> usize {
    // A page each for what does not fill one.
    files
        .values()
        .map(|bytes| bytes.len().next_multiple_of(4096))
        .sum()
}

impl Case<'_> {
    fn run(&self, random: &mut RandomStream) -> Result<Verdict, Miss> {
        let share = random.between(0.0, 1.2);
        let beyond = (size(&self.next) as f64 * share) as usize;
        let disk = Disk::of(self.out.clone(), size(&self.former) + 8192 + beyond);
        let out = self.out.join("out");
        fs::create_dir_all(&out).expect("a folder");
        for (name, bytes) in &self.former {
            fs::write(out.join(name), bytes).expect("room for former results");
        }
        let end = if disk.is_some() {
            self.workshop.start(SCENES[1].0, &out, false).end(LIMIT)
        } else {
            self.limited(&out, share)
        };
        let left = left_behind(&out);
        let verdict = self.judged(&out, &end)?;
        match left.first() {
            Some(left) => Err(Miss::of("a process left behind", left.clone())),
            None => Ok(verdict),
        }
    }

    /// Files may become no larger than a share of the largest; the signal for it is ignored, so
    /// that writing fails.
    fn limited(&self, out: &Path, share: f64) -> End {
        let largest = self.next.values().map(Vec::len).max().unwrap_or(0);
        let blocks = (largest as f64 * share / 512.0) as usize;
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        let own = self.workshop.arguments(SCENES[1].0, out, false);
        let mut arguments = vec![
            OsStr::new("-c"),
            OsStr::new(&script),
            self.program.as_os_str(),
        ];
        arguments.extend(own.iter().map(|text| &**text));
        run_program(Path::new("sh"), &arguments, LIMIT)
    }

    fn judged(&self, out: &Path, end: &End) -> Result<Verdict, Miss> {
        let first = end.first_line().to_owned();
        if let Some(fault) = end.fault() {
            return Err(Miss::of("fault", format!("{fault}: {first}")));
        }
        if end.code == Some(0) {
            let differs = difference(&results(out), &self.expected);
            return match differs {
                Some(what) => Err(Miss::of("other results", what)),
                None => Ok(Verdict::held("there was room")),
            };
        }
        if end.code != Some(1) {
            return Err(Miss::of("taken for bad input", end.said.replace('\n', " ")));
        }
        if !["space", "full", "too large"]
            .iter()
            .any(|word| end.said.contains(word))
        {
            return Err(Miss::of("not named", end.said.replace('\n', " ")));
        }
        if let Some(what) = broken(out) {
            return Err(Miss::of("a file that is not whole", what));
        }
        let found = visible(out);
        let is_kept = |(name, bytes): (&String, &Vec<u8>)| found.get(name) == Some(bytes);
        if self.former.iter().all(is_kept) {
            return Ok(Verdict::held(if self.former.is_empty() {
                "full: named"
            } else {
                "full: named, former results kept"
            }));
        }
        if ["former", "kept", "removed"]
            .iter()
            .any(|word| end.said.contains(word))
        {
            return Ok(Verdict::held(
                "full: named, what became of former results told",
            ));
        }
        Err(Miss::of(
            "former results lost without a word",
            end.said.replace('\n', " "),
        ))
    }
}
