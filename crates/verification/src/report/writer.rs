//! Writes what studies found: numbers, charts, pages, and the overview.
//!
//! What the overview says of a study is kept in a file, so that one study can be run again without
//! the others.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::{Map, Value, json};

use super::markdown::{anchor, item, parts, wrapped};
use super::{Effort, Finding, Part, Study};
use crate::machine;

/// Studies that are written about together.
pub struct Report {
    /// Its name on the command line, and that of the folder with its numbers and charts.
    pub name: &'static str,
    /// What the overview begins with: a title, and what it is.
    pub head: &'static str,
    /// Heads of the overview: the study, its subject, and its entries.
    pub columns: &'static [&'static str],
    /// Its studies, in their order.
    pub studies: Vec<Study>,
    /// How they are laid out.
    pub layout: Layout,
}

/// How studies are laid out.
pub enum Layout {
    /// All on one page beside the folder.
    OnePage {
        /// What all cases must hold; those that do not are listed below.
        promise: String,
    },
    /// A page each in the folder, and an overview with the time that each took.
    PageEach,
}

impl Report {
    /// The studies of these names, all of them if there are none.
    ///
    /// # Errors
    /// A name that no study has.
    pub fn chosen(&self, names: &[String]) -> Result<Vec<&Study>, String> {
        let known: Vec<&str> = self.studies.iter().map(|study| study.name).collect();
        if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
            let known = known.join(", ");
            return Err(format!(
                "{} has no study {name}; there are {known}",
                self.name
            ));
        }
        let is_chosen = |study: &&Study| names.is_empty() || names.iter().any(|n| n == study.name);
        Ok(self.studies.iter().filter(is_chosen).collect())
    }

    /// Runs a study and writes its files below `folder`; what it found, and the seconds it took.
    ///
    /// # Errors
    /// What the system says of files that cannot be written.
    pub fn run(&self, study: &Study, effort: Effort, folder: &Path) -> io::Result<(Finding, f64)> {
        self.run_as(study, || (study.run)(effort), folder)
    }

    /// The same with another way to run the study.
    ///
    /// # Errors
    /// As [`Report::run`].
    pub fn run_as(
        &self,
        study: &Study,
        run: impl FnOnce() -> Finding,
        folder: &Path,
    ) -> io::Result<(Finding, f64)> {
        let is_busy = machine::is_busy();
        let start = Instant::now();
        let finding = run();
        let seconds = start.elapsed().as_secs_f64();
        let own = folder.join(self.name);
        fs::create_dir_all(&own)?;
        write_files(&own, study, &finding)?;
        let entry = match self.layout {
            Layout::OnePage { .. } => json!({
                "summary": finding.summary,
                "body": parts(study, &finding.parts, &format!("{}/", self.name)),
                "misses": finding.misses,
            }),
            Layout::PageEach => {
                fs::write(
                    own.join(format!("{}.md", study.name)),
                    self.page(study, &finding),
                )?;
                json!({"summary": finding.summary, "seconds": seconds.round(), "busy": is_busy})
            }
        };
        let mut kept = self.kept(folder)?;
        kept.insert(study.name.to_owned(), entry);
        let text = serde_json::to_string_pretty(&kept)? + "\n";
        fs::write(self.kept_in(folder), text)?;
        Ok((finding, seconds))
    }

    /// A page of one study.
    fn page(&self, study: &Study, finding: &Finding) -> String {
        let command = format!(
            "cargo run --release -p kluft-verification --bin verify -- {} {}",
            self.name, study.name
        );
        let body = parts(study, &finding.parts, "");
        let title = study.title;
        format!("# {title}\n\n{body}\n## Make it again\n\n    {command}\n")
    }

    fn kept_in(&self, folder: &Path) -> PathBuf {
        let name = match self.layout {
            Layout::OnePage { .. } => "findings.json",
            Layout::PageEach => "index.json",
        };
        folder.join(self.name).join(name)
    }

    /// What was found before, by study.
    fn kept(&self, folder: &Path) -> io::Result<Map<String, Value>> {
        match fs::read_to_string(self.kept_in(folder)) {
            Ok(text) => Ok(serde_json::from_str(&text)?),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Map::new()),
            Err(error) => Err(error),
        }
    }

    /// Writes the overview below `folder` from all that is kept there.
    ///
    /// # Errors
    /// What the system says of files that cannot be read or written.
    pub fn write_overview(&self, folder: &Path) -> io::Result<()> {
        let kept = self.kept(folder)?;
        let known = self.studies.iter();
        let known: Vec<(&Study, &Value)> = known
            .filter_map(|study| Some((study, kept.get(study.name)?)))
            .collect();
        let head = format!("{}\n\n{}", wrapped(self.head), self.overview(&known));
        match &self.layout {
            Layout::OnePage { promise } => {
                let file = folder.join(format!("{}.md", self.name));
                fs::write(file, head + &sections(&known) + &failures(promise, &known))
            }
            Layout::PageEach => {
                let file = folder.join(self.name).join("README.md");
                fs::write(file, head + &about_times(&known))
            }
        }
    }

    /// The table of all studies.
    fn overview(&self, known: &[(&Study, &Value)]) -> String {
        let rule = "---|".repeat(self.columns.len());
        let mut text = format!("| {} |\n|{rule}\n", self.columns.join(" | "));
        for (study, entry) in known {
            let target = match self.layout {
                Layout::OnePage { .. } => format!("#{}", anchor(study.title)),
                Layout::PageEach => format!("{}.md", study.name),
            };
            let entries = strings(&entry["summary"]).map(str::to_owned);
            let entries = entries.chain(entry["seconds"].as_f64().map(|s| format!("{s} s")));
            let entries = entries.collect::<Vec<String>>().join(" | ");
            let _ = writeln!(
                text,
                "| [{}]({target}) | {} | {entries} |",
                study.title, study.subject
            );
        }
        text
    }
}

/// Files with the numbers and charts of a study.
fn write_files(folder: &Path, study: &Study, finding: &Finding) -> io::Result<()> {
    for part in &finding.parts {
        match part {
            Part::Numbers(numbers) => {
                let name = numbers.name.unwrap_or(study.name);
                fs::write(folder.join(format!("{name}.csv")), numbers.table.csv())?;
            }
            Part::Chart(name, chart) => {
                fs::write(folder.join(format!("{name}.svg")), chart.svg())?;
            }
            Part::Heading(_) | Part::Text(_) => {}
        }
    }
    Ok(())
}

fn strings(list: &Value) -> impl Iterator<Item = &str> {
    list.as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
}

/// The studies one below the other.
fn sections(known: &[(&Study, &Value)]) -> String {
    let section = |(study, entry): &(&Study, &Value)| {
        let body = entry["body"].as_str().unwrap_or_default();
        format!("\n## {}\n\n{body}", study.title)
    };
    known.iter().map(section).collect()
}

/// What was promised, and what did not hold.
fn failures(promise: &str, known: &[(&Study, &Value)]) -> String {
    let miss = |title: &str, miss: &str| item(&format!("*{title}*: {miss}"));
    let misses = known
        .iter()
        .flat_map(|(study, entry)| strings(&entry["misses"]).map(|text| miss(study.title, text)));
    let misses: String = misses.collect();
    let held = if misses.is_empty() {
        "Every case held.\n"
    } else {
        &misses
    };
    format!("\n## What did not\n\n{}\n\n{held}", wrapped(promise))
}

fn about_times(known: &[(&Study, &Value)]) -> String {
    let is_busy = known.iter().any(|(_, entry)| entry["busy"] == true);
    let busy = if is_busy {
        "Times are from a machine that was busy with other work; they say what to expect at most. "
    } else {
        ""
    };
    let all = "A time covers all meshes of a page, made by gmsh. Everything but times is the same \
               in every run.";
    format!("\n{}\n", wrapped(&format!("{busy}{all}")))
}
