//! Points in space, those closer than a tolerance taken for one.

use std::collections::HashMap;

use glam::DVec3;

/// Cells of the grid are this many tolerances wide, so that most points look into one cell only.
const WIDTH: f64 = 4.0;

/// Points that are farther than a tolerance from each other.
pub(super) struct Points {
    tolerance: f64,
    /// Numbers of the points in each cell of a grid. It is only looked into, never walked through.
    grid: HashMap<[i64; 3], Vec<usize>>,
    all: Vec<DVec3>,
}

impl Points {
    /// No points; those closer than `tolerance` (m) will be one.
    pub(super) fn within(tolerance: f64) -> Self {
        Self {
            tolerance,
            grid: HashMap::new(),
            all: Vec::new(),
        }
    }

    /// The number of a point: that of the nearest known one within the tolerance, else a new one.
    pub(super) fn number(&mut self, point: DVec3) -> usize {
        if let Some(known) = self.nearest(point) {
            return known;
        }
        let number = self.all.len();
        self.all.push(point);
        let cell = self.cell(point);
        self.grid.entry(cell).or_default().push(number);
        number
    }

    /// The points by their numbers (m).
    pub(super) fn into_all(self) -> Vec<DVec3> {
        self.all
    }

    /// The points by their numbers (m).
    pub(super) fn all(&self) -> &[DVec3] {
        &self.all
    }

    fn cell(&self, point: DVec3) -> [i64; 3] {
        let cell = (point / (WIDTH * self.tolerance)).floor();
        cell.to_array().map(|part| part as i64)
    }

    fn nearest(&self, point: DVec3) -> Option<usize> {
        let reach = DVec3::splat(self.tolerance);
        let (low, high) = (self.cell(point - reach), self.cell(point + reach));
        let mut nearest: Option<(f64, usize)> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    for &number in self.grid.get(&[x, y, z]).into_iter().flatten() {
                        let away = self.all[number].distance(point);
                        let is_nearer = nearest.is_none_or(|other| (away, number) < other);
                        if away <= self.tolerance && is_nearer {
                            nearest = Some((away, number));
                        }
                    }
                }
            }
        }
        nearest.map(|(_, number)| number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_the_tolerance_are_one_also_across_cells() {
        let mut points = Points::within(0.1);
        let first = points.number(DVec3::splat(0.39));
        assert_eq!(points.number(DVec3::new(0.41, 0.39, 0.42)), first);
        assert_ne!(points.number(DVec3::new(0.52, 0.39, 0.39)), first);
        assert_eq!(points.into_all().len(), 2);
    }

    #[test]
    fn the_nearest_of_several_counts() {
        let mut points = Points::within(1.0);
        points.number(DVec3::ZERO);
        let second = points.number(DVec3::new(1.5, 0.0, 0.0));
        assert_eq!(points.number(DVec3::new(0.8, 0.0, 0.0)), second);
    }
}
