//! Springs between the outer surface and what does not move.

use glam::{DMat3, DVec3};
use kluft_field::Field;

/// Springs on a part of the outer surface: the traction `-K u` on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Index into [`kluft_mesh::MeshData::boundaries`].
    pub boundary: usize,
    /// How stiff they are.
    pub stiffness: SpringStiffness,
}

/// How stiff springs are.
#[derive(Debug, Clone, PartialEq)]
pub enum SpringStiffness {
    /// An elastic bed.
    Bed {
        /// Against displacement along the normal (Pa/m).
        normal: Field,
        /// Against displacement along the surface (Pa/m).
        shear: Field,
    },
    /// Unbounded rock outside.
    ///
    /// Cut into cones around the centre of what happens inside, it resists as that around a sphere
    /// does: radial displacements by `4 G / r`, as around a cavity that widens, others by
    /// `3 G / r`, as around a sphere that turns. The force of a cone is that on its sphere.
    Outside {
        /// The centre (m).
        centre: DVec3,
        /// Whether it is a line along z, in plane strain: as around a cylinder, all displacements
        /// meet `2 G / r`.
        is_line: bool,
    },
}

impl SpringStiffness {
    /// `K` (Pa/m) at a position (m) on the surface with this outward unit normal, where the rock
    /// has the shear modulus `shear_modulus` (Pa).
    pub fn at(&self, position: DVec3, normal: DVec3, shear_modulus: f64) -> DMat3 {
        match self {
            Self::Bed {
                normal: across,
                shear,
            } => axial(normal, across.at(position, 0.0), shear.at(position, 0.0)),
            Self::Outside { centre, is_line } => {
                let mut arm = position - *centre;
                if *is_line {
                    arm.z = 0.0;
                }
                let radius = arm.length();
                let direction = arm / radius;
                // Area of the sphere for that of the surface in one cone.
                let share = direction.dot(normal).max(0.0);
                let unit = share * shear_modulus / radius;
                match is_line {
                    true => axial(direction, 2.0 * unit, 2.0 * unit),
                    false => axial(direction, 4.0 * unit, 3.0 * unit),
                }
            }
        }
    }
}

/// `along a a^T + across (I - a a^T)` for a unit vector `a`.
fn axial(axis: DVec3, along: f64, across: f64) -> DMat3 {
    let outer = DMat3::from_cols(axis.x * axis, axis.y * axis, axis.z * axis);
    across * DMat3::IDENTITY + (along - across) * outer
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `u = A x / r^3` has the stress `2 G grad u`, whose traction on the sphere is `-4 G u / r`;
    /// `u = w x x / r^3` has the traction `-3 G u / r`.
    #[test]
    fn rock_outside_a_sphere_resists_as_it_does() {
        let centre = DVec3::new(1.0, -2.0, 0.5);
        let is_line = false;
        let outside = SpringStiffness::Outside { centre, is_line };
        let normal = DVec3::new(2.0, 1.0, -2.0) / 3.0;
        let modulus = 7.0;
        let stiffness = outside.at(centre + 2.5 * normal, normal, modulus);
        let turned = DVec3::new(1.0, 0.0, 1.0).cross(normal);
        for (moved, factor) in [(normal, 4.0), (turned, 3.0)] {
            let apart = stiffness * moved - factor * modulus / 2.5 * moved;
            assert!(apart.length() < 1e-13, "{moved}: {apart}");
        }
        // A plane at the same place is larger in each cone by the angle.
        let tilted = outside.at(centre + 2.5 * normal, -DVec3::Z, modulus);
        let apart = tilted - stiffness * (2.0 / 3.0);
        assert!(apart.to_cols_array().iter().all(|x| x.abs() < 1e-13));
    }
}
