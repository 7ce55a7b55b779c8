//! Samples on a grid whose planes are those of the axes.

use glam::DVec3;

use super::sample::Sample;

/// Coordinates of the planes, and a value where three of them meet.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    planes: [Vec<f64>; 3],
    /// Of the nodes, x fastest.
    values: Vec<f64>,
}

impl Grid {
    /// The grid of samples, if they are one.
    pub(crate) fn of(all: &[Sample]) -> Option<Self> {
        let planes = [0, 1, 2].map(|axis| {
            let mut own: Vec<f64> = all.iter().map(|sample| sample.position[axis]).collect();
            own.sort_by(f64::total_cmp);
            own.dedup();
            own
        });
        let count = planes.iter().map(Vec::len).product::<usize>();
        if count != all.len() {
            return None;
        }
        let mut grid = Self {
            values: vec![f64::NAN; count],
            planes,
        };
        for sample in all {
            let place = |axis: usize| {
                let own = &grid.planes[axis];
                own.partition_point(|plane| *plane < sample.position[axis])
            };
            let index = grid.index([place(0), place(1), place(2)]);
            *grid.values.get_mut(index)? = sample.value;
        }
        grid.values
            .iter()
            .all(|value| !value.is_nan())
            .then_some(grid)
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.planes[0].len() * (j + self.planes[1].len() * k)
    }

    /// The trilinear value; not a number outside.
    pub(crate) fn at(&self, position: DVec3) -> f64 {
        let Some(cell) = self.cell(position) else {
            return f64::NAN;
        };
        let mut sum = 0.0;
        for corner in 0..8_usize {
            let mut node = [0; 3];
            let mut weight = 1.0;
            for axis in 0..3 {
                let (low, share) = cell[axis];
                let upper = corner >> axis & 1;
                node[axis] = low + upper;
                weight *= if upper == 1 { share } else { 1.0 - share };
            }
            if weight != 0.0 {
                sum += weight * self.values[self.index(node)];
            }
        }
        sum
    }

    /// Along each axis the plane below a position, and how far it is to the next one.
    fn cell(&self, position: DVec3) -> Option<[(usize, f64); 3]> {
        let along = |axis: usize| {
            let (planes, at) = (&self.planes[axis], position[axis]);
            let (first, last) = (*planes.first()?, *planes.last()?);
            let slack = 1e-9 * (last - first).max(first.abs()).max(last.abs());
            if at < first - slack || at > last + slack {
                return None;
            }
            let at = at.clamp(first, last);
            let above = planes.partition_point(|plane| *plane <= at);
            let low = above.saturating_sub(1);
            let share = match planes.get(low + 1) {
                Some(next) => (at - planes[low]) / (next - planes[low]),
                None => 0.0,
            };
            Some((low, share))
        };
        Some([along(0)?, along(1)?, along(2)?])
    }
}
