//! What a chart shows.

use crate::axis::Axis;

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What it shows, one line.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Its data; more than a dozen series are hard to tell apart.
    pub series: Vec<Series>,
    /// What a cross at the upper edge means, `no convergence` say; named only if there are crosses.
    pub failure: String,
    /// Triangles that show rates; for two logarithmic axes.
    pub rates: Vec<Rate>,
    /// Whether to draw the front: what no other point of any series beats in both directions, less
    /// being better.
    pub front: bool,
    /// Values that mean nothing.
    pub band: Option<Band>,
}

/// Small values of `y` that mean nothing, as they are below what is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Upper edge.
    pub below: f64,
    /// Why they mean nothing, beside the chart.
    pub name: String,
}

/// Data that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name, beside the chart.
    pub name: String,
    /// `(x, y)` in the order in which they are joined. A `y` that is not finite is a failure: a
    /// cross at the upper edge.
    pub points: Vec<(f64, f64)>,
    /// Whether a line joins the points.
    pub line: bool,
    /// Written beside the line, if there is room.
    pub note: Option<String>,
}

/// A triangle beside a series whose slope is a rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Index of the series it stands under, at the middle of its points.
    pub series: usize,
    /// Slope: `y ~ x^rate`.
    pub rate: f64,
}

impl Series {
    /// Points joined by a line.
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            line: true,
            note: None,
        }
    }

    /// Points without a line.
    pub fn scatter(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            line: false,
            note: None,
        }
    }
}

impl Chart {
    /// A chart without data.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            series: Vec::new(),
            failure: "failed".into(),
            rates: Vec::new(),
            front: false,
            band: None,
        }
    }

    /// The points that no other point of the chart beats in both directions, from left to right.
    pub fn front_points(&self) -> Vec<(f64, f64)> {
        let all = self.series.iter().flat_map(|series| &series.points);
        let points: Vec<(f64, f64)> = all.copied().filter(|&point| self.shows(point)).collect();
        front(&points).into_iter().map(|i| points[i]).collect()
    }

    /// Whether a point has a place on the chart.
    pub(crate) fn shows(&self, (x, y): (f64, f64)) -> bool {
        self.x.takes(x) && self.y.takes(y)
    }
}

/// Indices of the points that no other one beats in both directions, less being better, from left
/// to right. Points with a coordinate that is not finite are left out.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let finite = |&i: &usize| points[i].0.is_finite() && points[i].1.is_finite();
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let beats = points[i].1 < best;
        best = best.min(points[i].1);
        beats
    });
    order
}
