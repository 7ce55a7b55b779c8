//! Boreholes: pressure at their wall beside pressure at their node.
//!
//! Around a hole of radius `r_w` the pressure falls with the logarithm of the distance, which a
//! linear pressure on facets does not follow at the node itself: what it has there belongs to a
//! radius `r_e` that depends on the mesh (Peaceman 1978), see `node_radius`. With
//! `Theta = sum_f T_f theta_f`, `theta_f` the angles of the facets at the node,
//!
//! ```text
//! Q = W (phi_w - phi_i),    W = Theta / ln(r_e / r_w)
//! ```

use kluft_mesh::{Defect, Mesh};

use super::conductance::Conductance;
use super::node_radius::Surroundings;
use super::numbering::FlowNodes;

/// A borehole in facets whose transmissivities change little against each other: `r_e` stays.
#[derive(Debug, Clone)]
pub(super) struct Borehole {
    /// The pressure of its node.
    pub(super) row: usize,
    /// The facets around it, indices into those of the numbering, and their angles there.
    pub(super) angles: Vec<(usize, f64)>,
    /// `ln(r_e / r_w)`.
    pub(super) logarithm: f64,
}

/// A borehole at some transmissivities.
#[derive(Debug, Clone, Copy)]
pub(super) struct Well {
    /// The pressure of its node.
    pub(super) row: usize,
    /// `W` (m^3/(Pa s)).
    pub(super) conductance: f64,
}

impl Borehole {
    /// With facets of these transmissivities (m^3/(Pa s)).
    pub(super) fn at(&self, transmissivity: &[f64]) -> Well {
        Well {
            row: self.row,
            conductance: theta(&self.angles, transmissivity) / self.logarithm,
        }
    }
}

/// The borehole of a radius (m) at a pressure; `name` is for messages.
///
/// # Errors
/// If the mesh is so fine that the hole reaches beyond its node.
pub(super) fn at(
    mesh: &Mesh,
    nodes: &FlowNodes,
    conductance: &Conductance,
    row: usize,
    (radius, name): (f64, &str),
) -> Result<Borehole, Defect> {
    let angles = angles(mesh, nodes, row);
    let around = Surroundings::of(mesh, nodes, conductance, row);
    let equivalent = around.logarithm(theta(&angles, &conductance.transmissivity));
    let equivalent = equivalent.exp();
    if equivalent > radius {
        return Ok(Borehole {
            row,
            angles,
            logarithm: (equivalent / radius).ln(),
        });
    }
    Err(Defect::new(
        name,
        format!(
            "its radius of {radius} m is not small beside the facets around it: a borehole there is less than {equivalent:.4e} m in radius"
        ),
        "mesh coarser there, or cut the hole out of the geometry and give the pressure on its wall",
    ))
}

/// `Theta` (m^3/(Pa s)).
fn theta(angles: &[(usize, f64)], transmissivity: &[f64]) -> f64 {
    let terms = angles.iter();
    terms
        .map(|&(facet, angle)| transmissivity[facet] * angle)
        .sum()
}

/// The facets around a row, and their angles there.
fn angles(mesh: &Mesh, nodes: &FlowNodes, row: usize) -> Vec<(usize, f64)> {
    let facets = nodes.around.of(row).iter();
    let of = |&facet: &u32| {
        let corners = nodes.corners.of(facet as usize);
        let count = corners.len();
        let local = corners.iter().position(|&corner| corner as usize == row);
        let local = local.unwrap_or(0);
        let place =
            |corner: usize| mesh.nodes[nodes.node[corners[corner % count] as usize] as usize];
        let (own, before, after) = (place(local), place(local + count - 1), place(local + 1));
        let angle = (before - own).angle_between(after - own);
        (facet as usize, angle)
    };
    facets.map(of).collect()
}
