//! The numbers of an equivalent permeability.

use kluft_mesh::bearing;
use kluft_solver::{EquivalentPermeability, PermeabilityTensor};
use serde::Serialize;

/// A principal permeability.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PrincipalPermeability {
    /// Its value (m^2).
    pub value: f64,
    /// Unit vector along it.
    pub direction: [f64; 3],
    /// Clockwise from north (+y), where it points down (degrees).
    pub trend: f64,
    /// Below the horizontal (degrees).
    pub plunge: f64,
}

/// A permeability tensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TensorSummary {
    /// Its components (m^2), symmetric.
    pub components: [[f64; 3]; 3],
    /// Its eigenvalues with their directions, the largest first.
    pub principal: Vec<PrincipalPermeability>,
}

/// How a body of fractures conducts as a whole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PermeabilitySummary {
    /// The tensor.
    #[serde(flatten)]
    pub tensor: TensorSummary,
    /// That after the last load step, in rock that deforms, unless a fracture has closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loaded: Option<TensorSummary>,
    /// Snow's tensor: that of the same fractures if each went through the body.
    pub through_going: TensorSummary,
    /// Largest difference between components across the diagonal, as a share of the largest.
    pub asymmetry: f64,
    /// What nodes inside lose or gain, as a share of what flows.
    pub mass_error: f64,
    /// Volume of the body (m^3).
    pub volume: f64,
    /// Area of the fractures that conduct (m^2).
    pub area: f64,
    /// Area of those that hang together with the outer surface (m^2).
    pub connected_area: f64,
}

impl TensorSummary {
    /// That of a tensor.
    pub(crate) fn of(tensor: &PermeabilityTensor) -> Self {
        let pairs = tensor.principal.iter().zip(tensor.directions);
        let principal = pairs.map(|(&value, direction)| {
            let down = if direction.z > 0.0 {
                -direction
            } else {
                direction
            };
            let level = down.truncate().length();
            PrincipalPermeability {
                value,
                direction: direction.to_array(),
                trend: match level > 0.0 {
                    true => bearing(down.x, down.y),
                    false => 0.0,
                },
                plunge: (-down.z).atan2(level).to_degrees(),
            }
        });
        Self {
            components: tensor.components,
            principal: principal.collect(),
        }
    }

    /// Its eigenvalues in words.
    pub fn words(&self) -> String {
        let parts = self.principal.iter().map(|one| {
            format!(
                "{:.4e} m2 towards {:.1}/{:.1}",
                one.value, one.trend, one.plunge
            )
        });
        parts.collect::<Vec<String>>().join(", ")
    }
}

impl PermeabilitySummary {
    /// That of a body.
    pub fn of(found: &EquivalentPermeability) -> Self {
        Self {
            tensor: TensorSummary::of(&found.tensor),
            loaded: None,
            through_going: TensorSummary::of(&found.through_going),
            asymmetry: found.asymmetry,
            mass_error: found.mass_error,
            volume: found.volume,
            area: found.areas[0],
            connected_area: found.areas[1],
        }
    }
}
