//! How a plane lies in space, as geologists say it.

use glam::DVec3;

/// Dip and dip direction of a plane; north is +y, east is +x, up is +z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// Angle below the horizontal, 0 to 90 (degrees).
    pub dip: f64,
    /// Where the plane dips to, clockwise from north (degrees).
    pub dip_direction: f64,
}

impl Orientation {
    /// The plane whose normal runs down along a line: its trend clockwise from north, its plunge
    /// below the horizontal (degrees).
    pub fn of_trend_and_plunge(trend: f64, plunge: f64) -> Self {
        Self {
            dip: 90.0 - plunge,
            dip_direction: trend + 180.0,
        }
    }

    /// The normal that points up.
    pub fn pole(self) -> DVec3 {
        let (sin, cos) = libm::sincos(self.dip.to_radians());
        let (east, north) = libm::sincos(self.dip_direction.to_radians());
        DVec3::new(sin * east, sin * north, cos)
    }

    /// Horizontal direction with the dip on its right hand, and the direction of steepest descent.
    pub fn strike_and_fall(self) -> (DVec3, DVec3) {
        let (sin, cos) = libm::sincos(self.dip.to_radians());
        let (east, north) = libm::sincos(self.dip_direction.to_radians());
        let strike = DVec3::new(-north, east, 0.0);
        (strike, DVec3::new(cos * east, cos * north, -sin))
    }

    /// The orientation of the plane with this normal; either of the two normals serves.
    pub fn of_normal(normal: DVec3) -> Self {
        let up = if normal.z < 0.0 { -normal } else { normal };
        let dip = libm::atan2(up.truncate().length(), up.z).to_degrees();
        let direction = libm::atan2(up.x, up.y).to_degrees();
        Self {
            dip,
            dip_direction: below_360(direction),
        }
    }
}

/// The same direction (degrees) from 0 to below 360.
pub(crate) fn below_360(direction: f64) -> f64 {
    let positive = direction.rem_euclid(360.0);
    // Of an angle just below 0 the remainder is 360 by rounding.
    if positive < 360.0 { positive } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, b: DVec3) {
        assert!(a.distance(b) < 1e-14, "{a} against {b}");
    }

    #[test]
    fn trend_and_plunge_are_those_of_the_normal_downwards() {
        let found = Orientation::of_trend_and_plunge(45.0, 35.0).pole();
        let (level, down) = (35_f64.to_radians().cos(), 35_f64.to_radians().sin());
        let line = DVec3::new(level * 0.5_f64.sqrt(), level * 0.5_f64.sqrt(), -down);
        close(found, -line);
    }

    #[test]
    fn a_plane_dipping_30_to_the_east_descends_eastwards() {
        let east = Orientation {
            dip: 30.0,
            dip_direction: 90.0,
        };
        let (strike, fall) = east.strike_and_fall();
        let root = 3.0_f64.sqrt() / 2.0;
        close(fall, DVec3::new(root, 0.0, -0.5));
        close(strike, DVec3::Y);
        close(east.pole(), DVec3::new(0.5, 0.0, root));
        close(fall.cross(strike), east.pole());
    }

    #[test]
    fn a_plane_dipping_60_to_the_south_west() {
        let plane = Orientation {
            dip: 60.0,
            dip_direction: 225.0,
        };
        let (strike, fall) = plane.strike_and_fall();
        let half = 0.5_f64.sqrt();
        close(
            fall,
            DVec3::new(-half / 2.0, -half / 2.0, -(0.75_f64.sqrt())),
        );
        close(strike, DVec3::new(half, -half, 0.0));
    }

    #[test]
    fn both_normals_tell_the_orientation() {
        for (dip, dip_direction) in [(30.0, 90.0), (90.0, 10.0), (1.0, 359.0), (72.5, 181.0)] {
            let given = Orientation { dip, dip_direction };
            for normal in [given.pole(), -given.pole()] {
                let found = Orientation::of_normal(normal);
                assert!((found.dip - dip).abs() < 1e-10);
                // Of a vertical plane both directions are as good.
                let apart = (found.dip_direction - dip_direction).rem_euclid(360.0);
                let same = apart.min(360.0 - apart) < 1e-8;
                assert!(
                    same || (dip == 90.0 && (apart - 180.0).abs() < 1e-8),
                    "{found:?}"
                );
            }
        }
    }
}
