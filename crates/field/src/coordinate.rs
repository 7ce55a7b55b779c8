//! What a value may depend on.

use glam::DVec3;

/// What a value may depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// The first coordinate (m).
    X,
    /// The second coordinate (m).
    Y,
    /// The elevation (m).
    Z,
    /// How far below the ground (m).
    Depth,
    /// The time of the load steps.
    Time,
}

/// Where and when a value is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The position (m).
    pub position: DVec3,
    /// The time.
    pub time: f64,
    /// Elevation of the ground (m), where the depth is 0.
    pub ground: f64,
}

/// What holds where a field has no value of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Beyond {
    /// Nothing: the value is not a number.
    #[default]
    Refuse,
    /// The nearest value.
    Nearest,
}

impl Coordinate {
    /// All of them, each under its name.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("x", Self::X),
        ("y", Self::Y),
        ("z", Self::Z),
        ("depth", Self::Depth),
        ("time", Self::Time),
    ];

    /// The one with a name.
    pub fn named(name: &str) -> Option<Self> {
        let mut all = Self::NAMES.into_iter();
        all.find(|(own, _)| *own == name).map(|(_, found)| found)
    }

    /// Its value.
    pub fn of(self, place: &Place) -> f64 {
        match self {
            Self::X => place.position.x,
            Self::Y => place.position.y,
            Self::Z => place.position.z,
            Self::Depth => place.ground - place.position.z,
            Self::Time => place.time,
        }
    }
}
