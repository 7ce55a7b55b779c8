//! From where something is looked at, without perspective.

use glam::{DMat3, DVec3, Vec3};

/// Directions that are tried (degrees above the horizontal, counter-clockwise from east); the
/// first is taken unless another shows much more.
const ELEVATIONS: [f64; 2] = [25.0, 45.0];
const AZIMUTHS: [f64; 8] = [-55.0, -80.0, -100.0, -125.0, -35.0, -10.0, 10.0, 35.0];
/// How much more of the surfaces another direction must show, as a share of them.
const MUCH: f64 = 0.1;

/// A direction of view, with what is to the right and above on the picture: unit vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// To the viewer.
    pub towards: DVec3,
    /// To the right.
    pub right: DVec3,
    /// Up.
    pub up: DVec3,
}

impl View {
    fn from(elevation: f64, azimuth: f64) -> Self {
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        Self {
            towards: DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e),
            right: DVec3::new(-sin_a, cos_a, 0.0),
            up: DVec3::new(-sin_e * cos_a, -sin_e * sin_a, cos_e),
        }
    }

    /// From above, as a map is looked at.
    const ABOVE: Self = Self {
        towards: DVec3::Z,
        right: DVec3::X,
        up: DVec3::Y,
    };

    /// A view that shows as much as it can of triangles; without any, the plane from above.
    pub fn of(points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        if triangles.is_empty() {
            return Self::ABOVE;
        }
        let mut tensor = DMat3::ZERO;
        for triangle in triangles {
            let [a, b, c] = triangle.map(|corner| points[corner as usize].as_dvec3());
            let area = (b - a).cross(c - a);
            let normal = area.normalize_or_zero();
            tensor += DMat3::from_cols(area * normal.x, area * normal.y, area * normal.z);
        }
        let trace = tensor.x_axis.x + tensor.y_axis.y + tensor.z_axis.z;
        let shown = |view: &Self| match trace > 0.0 {
            true => (view.towards.dot(tensor * view.towards) / trace).sqrt(),
            false => 0.0,
        };
        let views = ELEVATIONS.into_iter();
        let views = views.flat_map(|e| AZIMUTHS.map(|azimuth| Self::from(e, azimuth)));
        let views: Vec<Self> = views.collect();
        let mut best = views[0];
        for view in &views[1..] {
            if shown(view) > shown(&best) + MUCH {
                best = *view;
            }
        }
        best
    }

    /// Right, up and towards the viewer of a place.
    pub fn place(&self, at: DVec3) -> DVec3 {
        DVec3::new(at.dot(self.right), at.dot(self.up), at.dot(self.towards))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How much of a square with some normal is seen.
    fn seen(normal: DVec3) -> f64 {
        let (a, b) = normal.any_orthonormal_pair();
        let points = [Vec3::ZERO, a.as_vec3(), b.as_vec3()];
        View::of(&points, &[[0, 1, 2]]).towards.dot(normal).abs()
    }

    #[test]
    fn no_plane_is_looked_at_along_its_surface() {
        for azimuth in 0..36 {
            for dip in 0..10 {
                let view = View::from(10.0 * f64::from(dip), 10.0 * f64::from(azimuth));
                assert!(seen(view.towards) > 0.35, "{:?}", view.towards);
            }
        }
    }

    #[test]
    fn the_directions_are_at_right_angles() {
        for view in ELEVATIONS.map(|elevation| View::from(elevation, -55.0)) {
            assert!((view.right.cross(view.up) - view.towards).length() < 1e-15);
            assert!(view.up.z > 0.0);
        }
    }
}
