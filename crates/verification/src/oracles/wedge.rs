//! Limit equilibrium of rigid blocks.

use glam::{DMat3, DVec3};

/// One of the two joints that a wedge stands on.
#[derive(Debug, Clone, Copy)]
pub struct Wall {
    /// Unit normal into the wedge.
    pub normal: DVec3,
    /// Area (m^2).
    pub area: f64,
    /// Mean pressure of the water in it (Pa).
    pub pressure: f64,
    /// Friction (degrees).
    pub friction_angle: f64,
    /// Cohesion (Pa).
    pub cohesion: f64,
}

/// Upward unit normal of a plane with a dip and a dip direction (degrees); x east, y north.
pub fn normal(dip: f64, direction: f64) -> DVec3 {
    let ((sin, cos), (east, north)) =
        (dip.to_radians().sin_cos(), direction.to_radians().sin_cos());
    DVec3::new(sin * east, sin * north, cos)
}

/// Factor of safety of a wedge of this weight (N) that slides on two walls along the line where
/// they meet: their reactions balance the weight and the water across the line (E. Hoek and J. W.
/// Bray, Rock Slope Engineering, 1981).
pub fn wedge(weight: f64, walls: [Wall; 2]) -> f64 {
    let [first, second] = walls.map(|wall| wall.normal);
    let line = first.cross(second).normalize();
    let forces = DMat3::from_cols(first, second, line).inverse() * (weight * DVec3::Z);
    let carried = |(wall, force): (&Wall, f64)| {
        let normal = force - wall.area * wall.pressure;
        wall.cohesion * wall.area + normal * wall.friction_angle.to_radians().tan()
    };
    let strength: f64 = walls.iter().zip([forces.x, forces.y]).map(carried).sum();
    strength / forces.z.abs()
}

/// The point of the line through the origin along which two planes through it meet that lies on a
/// third plane, given by its normal and one of its points.
pub fn on_plane(line: [DVec3; 2], normal: DVec3, point: DVec3) -> DVec3 {
    let along = line[0].cross(line[1]);
    along * (normal.dot(point) / normal.dot(along))
}

/// Factor of safety of a low block of width 1 on a slope (degrees) that a slender one, `height`
/// times as high, leans on and would topple over (R. E. Goodman and J. W. Bray, 1976): the slender
/// one turns about its lower corner and pushes with friction `t = tan(phi)/F` at the top of the
/// low one.
pub fn toppling(slope: f64, height: f64, friction_angle: f64) -> f64 {
    let (sin, cos) = slope.to_radians().sin_cos();
    let push = height * (height * sin - cos) / 2.0;
    let moves = |t: f64| sin + push - (cos + push * t) * t;
    let (mut low, mut high) = (0.0_f64, friction_angle.to_radians().tan());
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if moves(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    friction_angle.to_radians().tan() / low
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two walls alike at 45 degrees to the vertical plane through a line that plunges by 40,
    /// `tan 40 / (tan 40 sin 45)` remains.
    #[test]
    fn a_symmetric_wedge_needs_friction_by_its_line_and_angle() {
        let (sin, cos) = 40_f64.to_radians().sin_cos();
        let (line, up) = (DVec3::new(cos, 0.0, -sin), DVec3::new(sin, 0.0, cos));
        let wall = |side: f64| Wall {
            normal: (up + side * line.cross(up)).normalize(),
            area: 1.0,
            pressure: 0.0,
            friction_angle: 40.0,
            cohesion: 0.0,
        };
        let found = wedge(1e6, [wall(1.0), wall(-1.0)]);
        assert!((found - std::f64::consts::SQRT_2).abs() < 1e-12, "{found}");
        assert!((toppling(20.0, 3.0, 40.0) - 1.780_685).abs() < 1e-6);
    }
}
