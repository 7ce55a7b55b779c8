//! Accuracy against cost: what a scene's settings yield, and what each takes.
//!
//! Each setting is a process of its own, so that its time, memory and failure are those of a run,
//! and whatever happens to it does not end the study.

mod answer;
mod assess;
mod charts;
mod dimension;
mod edits;
mod files;
mod page;
mod point;
mod reference;
mod settings;
mod sweep;
mod table;
mod under_way;
mod values;
mod words;

use std::io::Write;
use std::path::{Path, PathBuf};

use kluft_io::{sync_folder, write_atomically};
use kluft_mesh::Defect;
use kluft_run::{Machine, ThreadCount, thread_count};

use crate::failure::Failure;
use crate::gmsh::GmshArgs;
use crate::input::{expect_scene, scene_at};
use crate::printing::{lines, one_line};
use crate::report::{Report, Verbosity};
use crate::stdout::print;
use assess::{Assessment, assess};
use files::{PAGE, TABLE};
use kluft_io::fingerprint_of;
use kluft_io::gmsh::version;
use kluft_program::invocation::OwnProgram;
use kluft_scene::Scene;
use point::{PointOutcome, PointRecord, Runner};
use settings::StudyPlan;
use under_way::Study;
use words::{duration, or_the_scene, percent};

/// How to study a scene.
#[derive(Debug, Clone)]
pub struct StudyOptions {
    /// Folder for the results; `study` beside the scene if not given.
    pub out: Option<PathBuf>,
    /// Largest error that is wanted, as a share; all settings are run if not given.
    pub tolerance: Option<f64>,
    /// Number of threads of each run; all cores if not given.
    pub threads: Option<usize>,
    /// How much to tell.
    pub verbosity: Verbosity,
    /// How each run starts gmsh.
    pub gmsh: GmshArgs,
    /// What runs the settings; none if the system does not tell.
    pub own: Option<OwnProgram>,
}

/// Runs the settings of a scene, cheapest first, and writes what each yields and takes. Settings
/// that a former study of the folder has run are not run again. With a tolerance the study ends
/// when a setting reaches it, and prints that setting as a fragment of a scene.
///
/// # Errors
/// [`Failure::BadInput`] with every defect of the scene, or if no run has the measure that is asked
/// for, after all have been run; [`Failure::NotReached`] if no setting was solved, or none is as
/// accurate as wanted. Settings that fail are results.
pub fn study(scene_file: &Path, options: &StudyOptions) -> Result<(), Failure> {
    let mut report = Report::new(options.verbosity);
    let mut study = Study::begin(scene_file, options)?;
    report.entry("study", &study.title);
    if let Some(word) = &study.thread_word {
        report.entry("warning", word);
    }
    let found = study.run(&mut report, options.tolerance)?;
    study.write(&found)?;
    for line in summary(&study, &found) {
        report.entry("result", &line);
    }
    let page = study.claimed.path().join(PAGE);
    report.entry("open", &page.display().to_string());
    if answer::has_no_result(&study.records) {
        let why = study
            .records
            .iter()
            .flatten()
            .find_map(PointRecord::failure);
        let why = why.unwrap_or_default();
        return Err(Failure::NotReached(format!(
            "no setting was solved; the first: {why}"
        )));
    }
    if let Some(defect) = &found.missing {
        return Err(defect.clone().into());
    }
    let Some(tolerance) = options.tolerance else {
        return Ok(());
    };
    let Some(best) = answer::cheapest(&study, &found, tolerance) else {
        return Err(Failure::NotReached(answer::closest_setting(
            &study, &found, tolerance,
        )));
    };
    let text = answer::fragment(&study, &found, best, tolerance);
    print(&lines(&text))
}

impl Study {
    fn begin(scene_file: &Path, options: &StudyOptions) -> Result<Self, Failure> {
        let scene_file = &scene_at(scene_file)?;
        expect_scene(scene_file)?;
        let text = Scene::text(scene_file)?;
        let plan = StudyPlan::read(scene_file, &text)?;
        let beside = || scene_file.parent().unwrap_or(Path::new(".")).join("study");
        let out = options.out.clone().unwrap_or_else(beside);
        let out = std::path::absolute(&out).unwrap_or(out);
        let program = options.own.clone().ok_or_else(not_found)?;
        let scene = Scene::parse_file(scene_file, &text)?;
        let inputs = kluft_run::inputs(scene_file, Some(&scene));
        let claimed = files::claim(&out, &charts::file_names(&plan), &inputs)?;
        let ThreadCount { count, word } = thread_count(options.threads);
        let runner = Runner {
            folder: out.join("points"),
            study: out,
            build: fingerprint_of(&program.code)?,
            program,
            threads: count,
            gmsh: options.gmsh,
            gmsh_version: version(&options.gmsh.options(options.own.as_ref())),
        };
        std::fs::create_dir_all(&runner.folder).map_err(|error| {
            let place = runner.folder.display().to_string();
            let problem = format!("the folder cannot be made: {error}");
            Defect::new(place, problem, "name another folder with --out")
        })?;
        let (folders, records) = claim(&plan, &runner);
        let title = plan.scene.get("title").and_then(toml::Value::as_str);
        Ok(Self {
            text,
            title: title.unwrap_or("untitled").to_owned(),
            plan,
            runner,
            folders,
            records,
            machine: Machine::this(),
            thread_word: word,
            claimed,
        })
    }

    /// Runs what has not been run, until a setting reaches the tolerance.
    fn run(&mut self, report: &mut Report, tolerance: Option<f64>) -> Result<Assessment, Failure> {
        let mut found = assess(&self.plan, &self.records);
        let count = self.plan.settings.len();
        let kept = self.records.iter().flatten().count();
        report.entry("settings", &format!("{count}, {kept} of them run before"));
        for index in 0..count {
            // What is charted instead of what is asked for reaches nothing.
            let wanted = tolerance.filter(|_| found.missing.is_none());
            let reached = wanted.and_then(|most| answer::cheapest(self, &found, most));
            if reached.is_some() {
                break;
            }
            if self.records[index].is_some() {
                continue;
            }
            let name = self.name(index);
            let scene = self.plan.scene_of(&self.plan.settings[index]);
            let left = self
                .records
                .iter()
                .filter(|record| record.is_none())
                .count();
            let time = self.time_left();
            let time = time.map_or_else(String::new, |time| format!(", about {}", duration(time)));
            report.entry("point", &format!("{name} ({left} left{time})"));
            report.work_begins("running");
            let record = self.runner.run(&self.folders[index], &scene);
            report.work_ends();
            self.records[index] = Some(record?);
            found = assess(&self.plan, &self.records);
            self.tell(report, &found, index);
            // Whoever interrupts a study finds what is known so far.
            self.write(&found)?;
        }
        Ok(found)
    }

    fn tell(&self, report: &Report, found: &Assessment, index: usize) {
        let Some(record) = &self.records[index] else {
            return;
        };
        let text = match &record.outcome {
            PointOutcome::Failed(why) => format!("failed: {}", why.replace('\n', "; ")),
            PointOutcome::Solved(numbers) => {
                let error = found.verdicts[index].error;
                // A reference that is extrapolated moves with each mesh.
                let so_far = if found.references.is_empty() {
                    ""
                } else {
                    " so far"
                };
                let error = match &found.missing {
                    Some(missing) => format!(", {}", missing.problem),
                    None => error
                        .map_or_else(String::new, |e| format!(", error {}{so_far}", percent(e))),
                };
                let took = duration(numbers.seconds);
                format!("{took}, {} unknowns{error}", numbers.unknowns)
            }
        };
        report.entry("", &text);
    }

    /// Time that the settings not yet run will take, going by those that were (s).
    fn time_left(&self) -> Option<f64> {
        let cost = |index: usize| self.plan.settings[index].cost;
        let taken = (0..self.records.len()).map(|i| (cost(i), self.seconds(i)));
        let taken: Vec<(f64, f64)> = taken.filter(|(_, s)| s.is_finite()).collect();
        let left = (0..self.records.len()).filter(|&i| self.records[i].is_none());
        reference::proportion(&taken)
            .map(|(fixed, each)| left.map(|i| fixed + each * cost(i)).sum())
    }

    /// What a setting is called.
    fn name(&self, index: usize) -> String {
        let name = self.plan.name(&self.plan.settings[index], |_| true);
        or_the_scene(one_line(&name).into_owned())
    }

    /// Wall-clock time of a setting (s); infinite if it was not solved.
    fn seconds(&self, index: usize) -> f64 {
        let record = self.records[index].as_ref();
        let numbers = record.and_then(PointRecord::numbers);
        numbers.map_or(f64::INFINITY, |numbers| numbers.seconds)
    }

    /// The scene that a setting ran.
    fn scene_file(&self, index: usize) -> PathBuf {
        self.runner
            .folder
            .join(&self.folders[index])
            .join("scene.toml")
    }

    /// Settings that no other one beats in time and error.
    fn front(&self, found: &Assessment) -> Vec<usize> {
        let error = |i: usize| found.drawn_error(i).unwrap_or(f64::NAN);
        let point = |i: usize| (self.seconds(i), error(i));
        let points: Vec<(f64, f64)> = (0..self.records.len()).map(point).collect();
        kluft_chart::front(&points)
    }

    /// Writes table, charts and page.
    fn write(&self, found: &Assessment) -> Result<(), Failure> {
        let charts = charts::charts(self, found);
        let drawn: Vec<(&charts::NamedChart, String)> = charts
            .iter()
            .map(|named| (named, named.chart.svg()))
            .collect();
        let write_text = |name: &str, text: &str| {
            self.claimed.write(name, |path| {
                write_atomically(path, |out| out.write_all(text.as_bytes()))
            })
        };
        for (named, svg) in &drawn {
            write_text(&named.file, svg)?;
        }
        let table = |path: &Path| table::write(path, self, found);
        self.claimed.write(TABLE, table)?;
        write_text(PAGE, &page::page(self, found, &drawn))?;
        Ok(sync_folder(self.claimed.path())?)
    }
}

/// The folder of each setting, and its record if a former study has run it.
fn claim(plan: &StudyPlan, runner: &Runner) -> (Vec<String>, Vec<Option<PointRecord>>) {
    let mut former = runner.former();
    let find = |setting: &settings::Setting| {
        let scene = plan.scene_of(setting);
        let (wanted, gmsh) = (runner.fingerprint(&scene)?, runner.gmsh_of(&scene));
        let is_own = |(_, record): &(String, PointRecord)| record.is_of(&wanted, gmsh);
        let at = former.iter().position(is_own)?;
        Some(former.remove(at))
    };
    let found: Vec<Option<(String, PointRecord)>> = plan.settings.iter().map(find).collect();
    let taken: Vec<String> = found
        .iter()
        .flatten()
        .map(|(name, _)| name.clone())
        .collect();
    let pairs = plan.settings.iter().zip(found);
    let pairs = pairs.map(|(setting, found)| match found {
        Some((name, record)) => (name, Some(record)),
        None => (untaken(&setting.folder, &taken), None),
    });
    pairs.unzip()
}

/// A name that no setting of another study has, which changed the numbers.
fn untaken(wanted: &str, taken: &[String]) -> String {
    let mut name = wanted.to_owned();
    while taken.contains(&name) {
        name.push('+');
    }
    name
}

fn not_found() -> Defect {
    let problem = "the program does not find itself";
    Defect::new("kluft", problem, "start it by its whole path")
}

/// What a study found, in a few lines.
fn summary(study: &Study, found: &Assessment) -> Vec<String> {
    let mut lines = Vec::new();
    let failed = study
        .records
        .iter()
        .flatten()
        .filter_map(PointRecord::failure)
        .count();
    if failed > 0 {
        lines.push(format!(
            "{failed} settings failed, see study.html for the reasons"
        ));
    }
    lines.extend(answer::instead(found));
    if found.verdicts.iter().all(|verdict| verdict.error.is_none()) {
        lines.push(format!("no errors: {}", answer::no_errors(study, found)));
    }
    lines.extend(
        found
            .identical_meshes
            .as_deref()
            .map(answer::identical_meshes),
    );
    for reference in &found.references {
        lines.push(reference.in_words());
    }
    for index in study.front(found) {
        let error = found.verdicts[index]
            .error
            .map_or_else(String::new, percent);
        let seconds = duration(study.seconds(index));
        lines.push(format!("{error} in {seconds}: {}", study.name(index)));
    }
    lines
}
