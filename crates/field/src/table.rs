//! Values that are linear between the rows of a table.

use glam::DVec3;

use crate::coordinate::{Beyond, Coordinate, Place};

/// Rows of a coordinate and a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    rows: Vec<[f64; 2]>,
    over: Coordinate,
    ground: f64,
    beyond: Beyond,
}

impl Table {
    /// A table over a coordinate; `ground` is the elevation (m) where the depth is 0. The rows come
    /// in any order; none if there are none, or if a coordinate has two values.
    pub fn new(
        mut rows: Vec<[f64; 2]>,
        over: Coordinate,
        ground: f64,
        beyond: Beyond,
    ) -> Option<Self> {
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let is_sound = !rows.is_empty() && rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        is_sound.then_some(Self {
            rows,
            over,
            ground,
            beyond,
        })
    }

    /// What the rows are over.
    pub fn over(&self) -> Coordinate {
        self.over
    }

    /// The first and the last coordinate.
    pub fn ends(&self) -> [f64; 2] {
        let end = |row: Option<&[f64; 2]>| row.map_or(f64::NAN, |row| row[0]);
        [end(self.rows.first()), end(self.rows.last())]
    }

    /// The value; beyond the ends the last one, or not a number.
    pub fn at(&self, position: DVec3, time: f64) -> f64 {
        let ground = self.ground;
        let place = Place {
            position,
            time,
            ground,
        };
        self.at_coordinate(self.over.of(&place))
    }

    fn at_coordinate(&self, at: f64) -> f64 {
        let next = self.rows.partition_point(|row| row[0] < at);
        let before = next.checked_sub(1).and_then(|last| self.rows.get(last));
        match (before, self.rows.get(next)) {
            (_, Some([end, value])) if *end == at => *value,
            (Some([start, before]), Some([end, after])) => {
                let share = (at - start) / (end - start);
                (1.0 - share) * before + share * after
            }
            (Some([_, value]), None) | (None, Some([_, value])) => {
                match self.beyond == Beyond::Nearest || self.is_rounding(at) {
                    true => *value,
                    false => f64::NAN,
                }
            }
            (None, None) => f64::NAN,
        }
    }

    /// Whether a coordinate misses an end by the rounding of coordinates only.
    fn is_rounding(&self, at: f64) -> bool {
        let [first, last] = self.ends();
        let size = first.abs().max(last.abs()).max(self.ground.abs());
        let miss = (first - at).max(at - last);
        miss <= 1e-9 * size.max(last - first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(over: Coordinate, beyond: Beyond) -> Table {
        let rows = vec![[10.0, 5.0], [0.0, 1.0], [30.0, -5.0]];
        Table::new(rows, over, 100.0, beyond).expect("sound rows")
    }

    #[test]
    fn values_are_linear_between_rows_in_any_order() {
        let z = table(Coordinate::Z, Beyond::Refuse);
        let at = |z_at: f64| z.at(DVec3::new(7.0, 8.0, z_at), 3.0);
        assert_eq!([at(0.0), at(5.0), at(10.0), at(20.0)], [1.0, 3.0, 5.0, 0.0]);
        assert!(at(-0.1).is_nan() && at(30.1).is_nan());
        assert_eq!(at(30.0 + 1e-12), -5.0);
    }

    #[test]
    fn depth_is_below_the_ground_and_time_is_time() {
        let depth = table(Coordinate::Depth, Beyond::Nearest);
        assert_eq!(depth.at(DVec3::Z * 95.0, 0.0), 3.0);
        assert_eq!(depth.at(DVec3::Z * 105.0, 0.0), 1.0);
        let time = table(Coordinate::Time, Beyond::Nearest);
        assert_eq!(
            [time.at(DVec3::ZERO, 5.0), time.at(DVec3::ZERO, 99.0)],
            [3.0, -5.0]
        );
    }

    #[test]
    fn two_values_at_one_place_are_no_table() {
        let rows = vec![[0.0, 1.0], [0.0, 2.0]];
        assert_eq!(Table::new(rows, Coordinate::X, 0.0, Beyond::Refuse), None);
        assert_eq!(
            Table::new(Vec::new(), Coordinate::X, 0.0, Beyond::Refuse),
            None
        );
    }
}
