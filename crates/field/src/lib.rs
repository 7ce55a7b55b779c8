//! Values that vary in space and time: linear in the elevation, tables, expressions, and samples.
//!
//! A field is checked when it is made; afterwards it has a value everywhere, which is not a number
//! where it knows none: [`Field::at`] never fails, and whoever uses one looks at its values first.

mod calls;
mod coordinate;
mod expression;
mod precedence;
mod profile;
mod samples;
mod table;

use std::sync::Arc;

use glam::DVec3;

pub use coordinate::{Beyond, Coordinate, Place};
pub use expression::Expression;
pub use profile::Profile;
pub use samples::{Method, SampleFile, Samples};
pub use table::Table;

/// A value that varies in space, and in time if it says so.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// Constant, or linear in the elevation.
    Profile(Profile),
    /// Linear between the rows of a table.
    Table(Table),
    /// An expression of position and time.
    Expression(Arc<Expression>),
    /// Between values at positions.
    Samples(Arc<Samples>),
}

impl Field {
    /// The same everywhere.
    pub fn constant(value: f64) -> Self {
        Self::Profile(Profile {
            value,
            ..Profile::default()
        })
    }

    /// The value at a position (m) and a time; not a number where the field knows none.
    pub fn at(&self, position: DVec3, time: f64) -> f64 {
        match self {
            Self::Profile(profile) => profile.at_elevation(position.z),
            Self::Table(table) => table.at(position, time),
            Self::Expression(expression) => expression.at(position, time),
            Self::Samples(samples) => samples.at(position),
        }
    }

    /// Whether the value changes with time.
    pub fn depends_on_time(&self) -> bool {
        match self {
            Self::Profile(_) | Self::Samples(_) => false,
            Self::Table(table) => table.over() == Coordinate::Time,
            Self::Expression(expression) => expression.depends_on_time(),
        }
    }

    /// Whether the value differs from place to place, as far as its form says.
    pub fn depends_on_place(&self) -> bool {
        match self {
            Self::Profile(profile) => profile.per_metre != 0.0,
            Self::Table(table) => table.over() != Coordinate::Time,
            Self::Expression(expression) => expression.depends_on_place(),
            Self::Samples(_) => true,
        }
    }

    /// Where the values of samples come from, and how far a position is from the nearest (m).
    pub fn reach(&self, position: DVec3) -> Option<f64> {
        match self {
            Self::Samples(samples) => Some(samples.reach(position)),
            Self::Profile(_) | Self::Table(_) | Self::Expression(_) => None,
        }
    }
}

impl Default for Field {
    fn default() -> Self {
        Self::constant(0.0)
    }
}

impl From<Profile> for Field {
    fn from(profile: Profile) -> Self {
        Self::Profile(profile)
    }
}
