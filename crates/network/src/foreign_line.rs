//! Lines of lists that other programs write, and what is read from them.

use glam::DVec3;
use kluft_defect::Defect;

use crate::clip::Domain;

/// A line that says something.
pub(crate) struct Line<'a> {
    pub(crate) place: String,
    pub(crate) text: &'a str,
}

/// The corners of a polygon, and where they stand.
pub(crate) struct Corners {
    pub(crate) place: String,
    pub(crate) corners: Vec<DVec3>,
}

pub(crate) type Read = Result<(Option<Domain>, Vec<Corners>), Vec<Defect>>;

impl Line<'_> {
    /// All its values, if they are finite numbers.
    pub(crate) fn numbers(&self) -> Option<Vec<f64>> {
        let values = self.text.trim_end_matches(',').split(',');
        let number = |value: &str| value.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        values.map(number).collect()
    }

    pub(crate) fn defect(&self, problem: String, remedy: &str) -> Defect {
        Defect::new(&self.place, problem, remedy)
    }
}
