//! A study under way.

use kluft_io::ClaimedFolder;
use kluft_run::Machine;

use super::point::{PointRecord, Runner};
use super::settings::StudyPlan;

/// A study under way.
pub(super) struct Study {
    /// The scene as it is written.
    pub(super) text: String,
    pub(super) title: String,
    pub(super) plan: StudyPlan,
    pub(super) runner: Runner,
    /// Folder of each setting.
    pub(super) folders: Vec<String>,
    /// What came out of each setting; none before it is run.
    pub(super) records: Vec<Option<PointRecord>>,
    pub(super) machine: Machine,
    /// Why it runs on fewer threads than were asked for, if so.
    pub(super) thread_word: Option<String>,
    /// The folder of its results.
    pub(super) claimed: ClaimedFolder,
}
