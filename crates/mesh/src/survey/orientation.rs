//! How a fracture lies in space.

use glam::{DMat3, DVec3};

use crate::orientation::below_360;

/// Mean orientation of a fracture, by area.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeanOrientation {
    /// Unit normal of the mean plane, upwards.
    pub normal: DVec3,
    /// Angle between the mean plane and the horizontal, 0 to 90 (degrees).
    pub dip: f64,
    /// Direction in which the mean plane falls, clockwise from north [degrees, 0 to 360]; north is
    /// +y, east is +x, up is +z. 0 for a horizontal plane.
    pub dip_direction: f64,
    /// Largest angle between the normal of a facet and the mean normal (degrees); 0 is plane.
    pub deviation: f64,
}

/// Orientations of all fractures from the area vectors of the facets, whatever their signs.
///
/// The mean normal is the axis of `sum_f A_f n_f n_f^T` with the largest eigenvalue.
pub(super) fn of_fractures(
    areas: &[DVec3],
    fracture: &[u32],
    count: usize,
) -> Vec<MeanOrientation> {
    let mut tensors = vec![DMat3::ZERO; count];
    for (&area, &fracture) in areas.iter().zip(fracture) {
        let normal = area.normalize_or_zero();
        tensors[fracture as usize] +=
            DMat3::from_cols(area * normal.x, area * normal.y, area * normal.z);
    }
    let mut orientations: Vec<MeanOrientation> = tensors.into_iter().map(of_tensor).collect();
    for (&area, &fracture) in areas.iter().zip(fracture) {
        let entry = &mut orientations[fracture as usize];
        let normal = area.normalize_or_zero();
        // The sine is exact for small angles, where the cosine is rounding.
        let sine = normal.cross(entry.normal).length();
        let angle = sine.atan2(normal.dot(entry.normal).abs()).to_degrees();
        entry.deviation = entry.deviation.max(angle);
    }
    orientations
}

/// Direction of a vector clockwise from north (degrees, from 0 on and below 360).
pub fn bearing(east: f64, north: f64) -> f64 {
    below_360(east.atan2(north).to_degrees())
}

fn of_tensor(tensor: DMat3) -> MeanOrientation {
    let axis = leading_axis(tensor);
    let up = match [axis.z, axis.y, axis.x]
        .into_iter()
        .find(|c| c.abs() > 1e-9)
    {
        Some(leading) if leading < 0.0 => -axis,
        _ => axis,
    };
    let level = up.truncate();
    let dip_direction = if level.length() > 1e-9 {
        bearing(level.x, level.y)
    } else {
        0.0
    };
    MeanOrientation {
        normal: up,
        dip: level.length().atan2(up.z.abs()).to_degrees(),
        dip_direction,
        deviation: 0.0,
    }
}

/// Eigenvector of the largest eigenvalue: squared again and again, the matrix becomes `v v^T`.
fn leading_axis(mut matrix: DMat3) -> DVec3 {
    for _ in 0..40 {
        let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        if trace <= 0.0 {
            return DVec3::Z;
        }
        matrix *= 1.0 / trace;
        matrix = matrix * matrix;
    }
    let columns = [matrix.z_axis, matrix.y_axis, matrix.x_axis];
    let longest = columns
        .into_iter()
        .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    longest.unwrap_or(DVec3::Z).normalize_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bearings_lie_below_360_degrees() {
        assert_eq!(bearing(1.0, 0.0), 90.0);
        assert_eq!(bearing(-1.0, 0.0), 270.0);
        assert_eq!(bearing(-1e-18, 1.0), 0.0);
    }
}
