//! What a geometry and the files that it opens would do to the machine.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use kluft_mesh::Defect;

use super::commands::{Command, Effect, commands};
use super::files::{Kind, kind};
use super::options::GmshOptions;

/// Most commands that are named.
const SHOWN: usize = 10;
/// Folders that hold nothing of a geometry.
const OF_THE_SYSTEM: [&str; 6] = ["/boot", "/dev", "/etc", "/proc", "/run", "/sys"];
const TRUST: &str = "if you know what it does, start with --trust";

/// What came out.
#[derive(Debug, Default)]
pub(super) struct Review {
    /// What nobody may do behind the user's back.
    pub(super) defects: Vec<Defect>,
    /// The file itself, and those that it opens by names that it writes out.
    pub(super) opened: Vec<PathBuf>,
    /// Whether the outcome depends on more than these files.
    pub(super) depends_on_more: bool,
}

impl Review {
    /// What gmsh must be able to read: the folder of the file, and what lies elsewhere.
    pub(super) fn reads(&self, file: &Path) -> Vec<PathBuf> {
        let folder = folder_of(file);
        let whole = folder.canonicalize().unwrap_or_else(|_| folder.clone());
        let outside = self.opened.iter().filter(|file| !file.starts_with(&whole));
        std::iter::once(folder).chain(outside.cloned()).collect()
    }

    /// The opened files that are scripts.
    pub(super) fn scripts(&self) -> impl Iterator<Item = &PathBuf> {
        self.opened.iter().filter(|file| kind(file) == Kind::Script)
    }
}

/// The review of a file that gmsh is to open; what nobody may do behind the user's back is refused,
/// unless the user trusts the file.
pub(super) fn reviewed(file: &Path, options: &GmshOptions) -> Result<Review, Vec<Defect>> {
    let review = review(file, options.confines());
    if options.trust || review.defects.is_empty() {
        Ok(review)
    } else {
        Err(review.defects)
    }
}

/// The folder that a file is in.
pub(super) fn folder_of(file: &Path) -> PathBuf {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    folder.unwrap_or(Path::new(".")).to_owned()
}

/// Reviews a file that gmsh is to open, with all files that it names. If gmsh is confined, names
/// that are computed are no defects: it finds out itself that it may not open them.
pub(super) fn review(file: &Path, is_confined: bool) -> Review {
    let mut walk = Walk {
        is_confined,
        ..Walk::default()
    };
    walk.enter(file.to_owned());
    while let Some(file) = walk.left.pop() {
        walk.look_into(&file);
    }
    let more = walk.review.defects.len().saturating_sub(SHOWN);
    if more > 0 {
        walk.review.defects.truncate(SHOWN);
        let problem = format!("{more} more commands of this kind");
        let defect = Defect::new(file.display().to_string(), problem, remedy("remove them"));
        walk.review.defects.push(defect);
    }
    walk.review
}

#[derive(Default)]
struct Walk {
    is_confined: bool,
    review: Review,
    known: HashSet<PathBuf>,
    left: Vec<PathBuf>,
}

impl Walk {
    /// Takes a file into account if it is there and new; gmsh also obeys `FILE.opt`.
    fn enter(&mut self, file: PathBuf) {
        let mut options = file.clone().into_os_string();
        options.push(".opt");
        for file in [file, options.into()] {
            let Ok(whole) = file.canonicalize() else {
                continue;
            };
            if self.known.insert(whole.clone()) {
                self.review.opened.push(whole);
                self.left.push(file);
            }
        }
    }

    fn look_into(&mut self, file: &Path) {
        let place = file.display().to_string();
        let is_ordinary = fs::metadata(file).is_ok_and(|about| about.is_file());
        if !is_ordinary {
            let problem = "a geometry opens it, and it is no ordinary file";
            self.refuse(place, problem, "name a file");
            return;
        }
        match kind(file) {
            Kind::Data => {}
            Kind::Program => {
                self.review.depends_on_more = true;
                let problem = "gmsh would run a program to open a file of this name";
                self.refuse(place, problem, "rename or unpack it");
            }
            Kind::Script => {
                // What cannot be read gmsh cannot read either, and says so.
                let script = fs::read(file).unwrap_or_default();
                for command in commands(&script) {
                    self.judge(file, &command);
                }
            }
        }
    }

    fn judge(&mut self, file: &Path, command: &Command) {
        let place = format!("{}, line {}", file.display(), command.line);
        let word = command.word;
        self.review.depends_on_more |= !matches!(command.effect, Effect::Opens(_));
        match &command.effect {
            Effect::Asks => {}
            Effect::Runs => {
                let problem = format!("`{word}` would run a program on this machine");
                self.refuse(place, problem, "remove it");
            }
            Effect::Writes => {
                let problem =
                    format!("`{word}` would write a file or send it, and only the mesh is wanted");
                self.refuse(place, problem, "remove it");
            }
            Effect::Opens(name) => {
                let folder = file.parent().unwrap_or(Path::new(""));
                let opened = folder.join(name);
                if of_the_system(&opened) {
                    let problem = format!("`{word}` would read {name}, a file of the system");
                    self.refuse(place, problem, "remove it");
                } else {
                    self.enter(opened);
                }
            }
            Effect::Computed if self.is_confined => {}
            Effect::Computed => {
                let problem = format!(
                    "what `{word}` would open or do is only known when gmsh does it, and on this \
                     machine nothing keeps gmsh from it"
                );
                self.refuse(place, problem, "write the name out");
            }
        }
    }

    fn refuse(&mut self, place: String, problem: impl Into<String>, cure: &str) {
        self.review
            .defects
            .push(Defect::new(place, problem, remedy(cure)));
    }
}

fn remedy(cure: &str) -> String {
    format!("{cure}; or, {TRUST}")
}

fn of_the_system(file: &Path) -> bool {
    let whole = file.canonicalize();
    let whole = whole.as_deref().unwrap_or(file);
    OF_THE_SYSTEM.iter().any(|folder| whole.starts_with(folder))
}
