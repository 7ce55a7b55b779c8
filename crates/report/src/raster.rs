//! Which triangle is seen at each point of a picture.

use glam::DVec3;

/// No triangle.
const NOTHING: u32 = u32::MAX;

/// What is seen at a point: a triangle, and the shares of its second and third corner there.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    depth: f32,
    triangle: u32,
    shares: [f32; 2],
}

/// Points of a picture, row by row from the top.
pub struct Raster {
    /// Points across.
    pub width: usize,
    /// Points down.
    pub height: usize,
    seen: Vec<Seen>,
}

impl Raster {
    /// A picture of nothing.
    pub fn new(width: usize, height: usize) -> Self {
        let nothing = Seen {
            depth: f32::NEG_INFINITY,
            triangle: NOTHING,
            shares: [0.0; 2],
        };
        Self {
            width,
            height,
            seen: vec![nothing; width * height],
        }
    }

    /// Adds a triangle: across, down and towards the viewer of its corners, in points.
    pub fn add(&mut self, triangle: u32, [a, b, c]: [DVec3; 3]) {
        let (ab, ac) = (b - a, c - a);
        let twice = ab.x * ac.y - ab.y * ac.x;
        if twice == 0.0 || !twice.is_finite() {
            return;
        }
        let span = |low: f64, high: f64, count: usize| {
            let first = (low - 0.5).ceil().max(0.0) as usize;
            let end = ((high - 0.5).floor() + 1.0).clamp(0.0, count as f64) as usize;
            first..end
        };
        let columns = span(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), self.width);
        let rows = span(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), self.height);
        for row in rows {
            let y = row as f64 + 0.5 - a.y;
            for column in columns.clone() {
                let x = column as f64 + 0.5 - a.x;
                let second = (x * ac.y - y * ac.x) / twice;
                let third = (ab.x * y - ab.y * x) / twice;
                if second < 0.0 || third < 0.0 || second + third > 1.0 {
                    continue;
                }
                let depth = (a.z + second * ab.z + third * ac.z) as f32;
                let seen = &mut self.seen[row * self.width + column];
                if depth > seen.depth {
                    *seen = Seen {
                        depth,
                        triangle,
                        shares: [second as f32, third as f32],
                    };
                }
            }
        }
    }

    /// The triangle at a point with the shares of its corners; none where nothing is.
    pub fn at(&self, column: usize, row: usize) -> Option<(usize, [f32; 3])> {
        let seen = &self.seen[row * self.width + column];
        let [second, third] = seen.shares;
        let shares = [1.0 - second - third, second, third];
        (seen.triangle != NOTHING).then_some((seen.triangle as usize, shares))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of points at which each of two triangles is seen.
    fn counts(triangles: [[[f64; 3]; 3]; 2]) -> [usize; 2] {
        let mut raster = Raster::new(100, 100);
        for (number, corners) in (0..).zip(triangles) {
            raster.add(number, corners.map(DVec3::from));
        }
        let mut counts = [0; 2];
        for (row, column) in (0..100).flat_map(|row| (0..100).map(move |column| (row, column))) {
            if let Some((triangle, shares)) = raster.at(column, row) {
                counts[triangle] += 1;
                assert!(
                    shares
                        .iter()
                        .all(|share| (-1e-6..=1.000_001).contains(share))
                );
            }
        }
        counts
    }

    #[test]
    fn two_halves_cover_a_square_without_a_gap() {
        let lower = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0]];
        let upper = [[100.0, 0.0, 0.0], [100.0, 100.0, 0.0], [0.0, 100.0, 0.0]];
        let [a, b] = counts([lower, upper]);
        assert_eq!(a + b, 100 * 100);
        assert!(a.abs_diff(b) <= 100, "{a} {b}");
    }

    #[test]
    fn triangles_that_cross_hide_each_other_in_halves() {
        // Depth falls with x on one and rises on the other: they cross at x = 50.
        let tilted = |left: f64, right: f64| {
            [
                [0.0, 0.0, left],
                [100.0, 0.0, right],
                [50.0, 100.0, 0.5 * (left + right)],
            ]
        };
        let [a, b] = counts([tilted(1.0, -1.0), tilted(-1.0, 1.0)]);
        assert!(a + b > 4900 && a.abs_diff(b) < 110, "{a} {b}");
    }

    #[test]
    fn what_is_flat_or_outside_is_not_seen() {
        let flat = [[0.0, 0.0, 0.0], [50.0, 50.0, 0.0], [100.0, 100.0, 0.0]];
        let outside = [[-50.0, 0.0, 0.0], [-10.0, 0.0, 0.0], [-10.0, 50.0, 0.0]];
        assert_eq!(counts([flat, outside]), [0, 0]);
        let no_number = [[f64::NAN, 0.0, 0.0], [50.0, 0.0, 0.0], [0.0, 50.0, 0.0]];
        assert_eq!(counts([no_number, outside]), [0, 0]);
    }
}
