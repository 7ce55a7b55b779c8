//! How a condition changes with time, and when load steps end.

/// A factor as a function of time: linear between points, constant before the first and after the
/// last.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadHistory {
    /// Times, ascending, each with its factor; at least one.
    pub points: Vec<[f64; 2]>,
}

impl LoadHistory {
    /// Grows from 0 at time 0 to 1 at `end`, and stays.
    pub fn ramp(end: f64) -> Self {
        Self {
            points: vec![[0.0, 0.0], [end, 1.0]],
        }
    }

    /// The factor at a time.
    pub fn at(&self, time: f64) -> f64 {
        let next = self.points.partition_point(|[start, _]| *start < time);
        match (
            next.checked_sub(1).map(|i| self.points[i]),
            self.points.get(next),
        ) {
            (_, Some([end, factor])) if *end == time => *factor,
            (Some([start, before]), Some([end, after])) => {
                let share = (time - start) / (end - start);
                (1.0 - share) * before + share * after
            }
            (Some([_, factor]), None) | (None, Some(&[_, factor])) => factor,
            (None, None) => 0.0,
        }
    }
}

/// Where a load step ends.
#[derive(Debug, Clone, PartialEq)]
pub struct StepEnd {
    /// Its time.
    pub time: f64,
    /// The phase that the step belongs to.
    pub phase: Option<String>,
}

/// Time 0 and the ends of the load steps.
pub(crate) fn moments(ends: &[StepEnd]) -> impl Iterator<Item = f64> {
    [0.0].into_iter().chain(ends.iter().map(|end| end.time))
}

/// The load steps of a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Timetable {
    /// A factor on all loads and prescribed displacements for each step.
    Factors(Vec<f64>),
    /// Steps in time.
    Times {
        /// Ends of the steps, ascending.
        ends: Vec<StepEnd>,
        /// When a condition without a history has grown to its full size.
        grown: f64,
        /// The phases, if there are any.
        phases: Vec<PhaseEntry>,
    },
}

/// A phase, and what it changes of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseEntry {
    /// Its name.
    pub name: String,
    /// File and line.
    pub place: String,
    /// Its end.
    pub until: f64,
    /// The number of its steps.
    pub steps: usize,
    /// Volumes that it removes.
    pub remove: Vec<String>,
    /// Volumes that it adds.
    pub add: Vec<String>,
    /// Rock of what it adds, if not that of the volume.
    pub added_as: Option<String>,
    /// Share of what holds cut walls that it lets go.
    pub release: f64,
}

impl PhaseEntry {
    /// Whether other volumes are there in it than before.
    pub fn changes(&self) -> bool {
        !self.remove.is_empty() || !self.add.is_empty()
    }
}

impl Timetable {
    /// The phases, if there are any.
    pub fn phases(&self) -> &[PhaseEntry] {
        match self {
            Self::Times { phases, .. } => phases,
            Self::Factors(_) => &[],
        }
    }

    /// Whether phases remove or add volumes.
    pub fn has_stages(&self) -> bool {
        self.phases().iter().any(PhaseEntry::changes)
    }
}

impl Default for Timetable {
    fn default() -> Self {
        Self::Factors(vec![1.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_linear_between_points_and_constant_outside() {
        let history = LoadHistory {
            points: vec![[1.0, 2.0], [3.0, -0.5], [4.0, 0.0]],
        };
        let times = [-1.0, 1.0, 2.0, 3.0, 3.5, 4.0, 9.0];
        let factors = [2.0, 2.0, 0.75, -0.5, -0.25, 0.0, 0.0];
        assert_eq!(times.map(|time| history.at(time)), factors);
    }

    #[test]
    fn a_point_has_exactly_its_factor() {
        let (time, factor) = (0.1 + 0.2, 1.0 / 3.0);
        let history = LoadHistory {
            points: vec![[0.0, 0.7], [time, factor], [1.0, 0.9]],
        };
        assert_eq!(history.at(time), factor);
    }

    #[test]
    fn without_a_history_a_condition_grows_once() {
        let ramp = LoadHistory::ramp(2.0);
        assert_eq!(
            [0.0, 0.5, 2.0, 5.0].map(|time| ramp.at(time)),
            [0.0, 0.25, 1.0, 1.0]
        );
    }
}
