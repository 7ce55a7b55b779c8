//! Boxes around places.

/// Share of the size of the body within which a coordinate is the same.
pub const NEAR: f64 = 1e-9;

/// The smallest box around places (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Extent {
    /// Around some places.
    pub fn of(places: impl Iterator<Item = [f64; 3]>) -> Option<Self> {
        let mut all: Option<Self> = None;
        for place in places {
            let own = all.get_or_insert(Self {
                low: place,
                high: place,
            });
            for (axis, x) in place.into_iter().enumerate() {
                own.low[axis] = own.low[axis].min(x);
                own.high[axis] = own.high[axis].max(x);
            }
        }
        all
    }
}
