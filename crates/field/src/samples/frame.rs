//! In how many directions positions are spread, and which.

use glam::DVec3;

/// Share of the extent below which positions are not spread in a direction.
const FLAT: f64 = 1e-6;

/// Axes along which positions are spread, the longest first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    origin: DVec3,
    axes: [DVec3; 3],
    /// Number of directions: 0 at one place, 1 on a line, 2 in a plane.
    pub(crate) dimension: usize,
}

impl Frame {
    /// The axes from the first position to the farthest one, and to the one farthest from that
    /// line.
    pub(crate) fn of(positions: &[DVec3]) -> Self {
        let origin = positions.first().copied().unwrap_or_default();
        let farthest = |rest: &dyn Fn(DVec3) -> DVec3| {
            let all = positions.iter().map(|position| rest(*position - origin));
            all.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                .unwrap_or_default()
        };
        let across = |x: DVec3, axis: DVec3| x - x.dot(axis) * axis;
        let first = farthest(&|x| x);
        let extent = first.length();
        let first = first.normalize_or_zero();
        let second = farthest(&|x| across(x, first));
        let is_line = second.length() <= FLAT * extent;
        let second = across(second, first).normalize_or_zero();
        let third = first.cross(second);
        let height = farthest(&|x| across(across(x, first), second)).length();
        let is_plane = height <= FLAT * extent;
        let dimension = if extent == 0.0 {
            0
        } else if is_line {
            1
        } else if is_plane {
            2
        } else {
            3
        };
        Self {
            origin,
            axes: [first, second, third],
            dimension,
        }
    }

    /// A position in the axes of the frame (m).
    pub(crate) fn in_frame(&self, position: DVec3) -> DVec3 {
        let from = position - self.origin;
        DVec3::from(self.axes.map(|axis| from.dot(axis)))
    }
}
