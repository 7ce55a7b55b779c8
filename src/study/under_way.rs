//! A study under way.

use std::path::PathBuf;

use super::machine::Machine;
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
    pub(super) out: PathBuf,
}
