//! How wrong the flux in the fractures is, estimated from itself as the stress is (O. C.
//! Zienkiewicz and J. Z. Zhu, Int. J. Numer. Meth. Engng 24, 1987 and 33, 1992): the difference
//! between the flux `q` of the facets and a smoother one `q*` is taken for the error, with the
//! energy norm
//!
//! ```text
//! |q|^2 = sum_f int |q|^2 / T_f dA
//! ```
//!
//! Where pressures are given, a rate between them is off by about the square of the error's share.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use kluft_algebra::{Lists, trace};
use kluft_mesh::{DisjointSets, Mesh};

use crate::flow::FlowFields;

/// Facets from which on a patch has a polynomial of its own.
const FEWEST: usize = 4;
/// Rounding of a pressure, as a share of the largest.
const ROUNDING: f64 = 1e-13;
/// Determinant below which places do not tell a slope, of a unit trace.
const SINGULAR: f64 = 1e-6;

/// Error of a flux.
#[derive(Debug, Clone)]
pub struct FluxError {
    /// Root mean square over each facet (m^2/s); zero where nothing flows.
    pub of_facet: Vec<f64>,
    /// The error as a share of the flux, in the energy norm; zero where rounding alone drives it.
    pub relative: f64,
}

impl FluxError {
    /// Estimates the error of the flux of a fluid of this viscosity (Pa s) in fields of a mesh.
    pub fn of(mesh: &Mesh, fields: &FlowFields, viscosity: f64) -> Self {
        let facets = Facets::of(mesh, fields);
        let smooth = facets.smooth(mesh);
        let mut of_facet = vec![0.0; mesh.facets.elements.len()];
        let largest = fields
            .pressures
            .iter()
            .fold(0.0_f64, |most, p| most.max(p.abs()));
        let (mut error, mut energy, mut rounding) = (0.0, 0.0, 0.0);
        for (own, smooth) in facets.all.iter().zip(smooth) {
            let found = own.at_corners(mesh, fields, viscosity);
            let along = |v: DVec3| v - v.dot(own.normal) * own.normal;
            let pairs = smooth.iter().zip(&found);
            let apart: Vec<DVec3> = pairs.map(|(smooth, q)| along(*smooth) - *q).collect();
            let square = mean_square(&apart);
            let weight = own.area / fields.transmissivities[own.facet];
            error += weight * square;
            energy += weight * mean_square(&found);
            rounding += weight * own.rounding(fields, viscosity, largest).powi(2);
            of_facet[own.facet] = square.sqrt();
        }
        let relative = if energy > rounding {
            (error / energy).sqrt()
        } else {
            0.0
        };
        Self { of_facet, relative }
    }
}

/// Mean over a triangle, or a parallelogram, of the square of what has these values at the corners.
fn mean_square(corners: &[DVec3]) -> f64 {
    let count = corners.len();
    let own: f64 = corners.iter().map(|v| v.length_squared()).sum();
    let beside = (0..count).map(|at| corners[at].dot(corners[(at + 1) % count]));
    let beside: f64 = beside.sum();
    match count {
        3 => (own + beside) / 6.0,
        _ => {
            let across = corners[0].dot(corners[2]) + corners[1].dot(corners[3]);
            (2.0 * own + 2.0 * beside + across) / 18.0
        }
    }
}

/// A facet that conducts.
struct Conducting {
    facet: usize,
    corners: Vec<u32>,
    centre: DVec3,
    normal: DVec3,
    /// In m^2.
    area: f64,
    /// Mean flux (m^2/s).
    flux: DVec3,
}

impl Conducting {
    /// The flux at the corners (m^2/s): that of a quadrangle varies as the gradient of its pressure
    /// does, of which gravity is an even part.
    fn at_corners(&self, mesh: &Mesh, fields: &FlowFields, viscosity: f64) -> Vec<DVec3> {
        let first = mesh.facets.elements.range(self.facet).start;
        let count = self.corners.len();
        let slope = |at: usize| {
            let to = |other: usize| {
                let [from, to] = [at, other].map(|at| mesh.nodes[self.corners[at] as usize]);
                let rise = fields.pressures[first + other] - fields.pressures[first + at];
                (to - from, rise)
            };
            let ((a, of_a), (b, of_b)) = (to((at + 1) % count), to((at + count - 1) % count));
            let normal = a.cross(b);
            (of_a * b.cross(normal) + of_b * normal.cross(a)) / normal.length_squared()
        };
        let slopes: Vec<DVec3> = (0..count).map(slope).collect();
        let mean = slopes.iter().sum::<DVec3>() / count as f64;
        let conducts = fields.transmissivities[self.facet] / viscosity;
        let slopes = slopes.into_iter();
        slopes
            .map(|slope| self.flux - conducts * (slope - mean))
            .collect()
    }

    /// What the rounding of pressures of this size (Pa) alone may drive (m^2/s).
    fn rounding(&self, fields: &FlowFields, viscosity: f64, largest: f64) -> f64 {
        let conducts = fields.transmissivities[self.facet] / viscosity;
        ROUNDING * conducts * largest / self.area.sqrt()
    }
}

/// The facets that conduct, and the patches that they form around their corners: those of one
/// fracture that hang together there across edges which no other facet shares, because flux jumps
/// where fractures meet.
struct Facets {
    all: Vec<Conducting>,
    /// Patch of each corner of each facet, facet by facet.
    patch: Vec<u32>,
    /// First of these of each facet.
    first: Vec<usize>,
    /// Node of each patch.
    node: Vec<u32>,
    /// Facets of each patch.
    members: Lists,
}

impl Facets {
    fn of(mesh: &Mesh, fields: &FlowFields) -> Self {
        let elements = &mesh.facets.elements;
        let areas = mesh.facet_areas();
        let conducting = (0..elements.len()).filter(|&facet| fields.transmissivities[facet] > 0.0);
        let own = |facet: usize| {
            let corners = elements.shapes[facet].corner_count();
            let corners = elements.nodes_of(facet)[..corners].to_vec();
            let places = corners.iter().map(|&node| mesh.nodes[node as usize]);
            Conducting {
                facet,
                centre: places.sum::<DVec3>() / corners.len() as f64,
                corners,
                normal: areas[facet].normalize_or_zero(),
                area: areas[facet].length(),
                flux: fields.fluxes[facet],
            }
        };
        let all: Vec<Conducting> = conducting.map(own).collect();
        let mut first = vec![0];
        for facet in &all {
            first.push(first[first.len() - 1] + facet.corners.len());
        }
        let mut facets = Self {
            patch: (0..first[all.len()] as u32).collect(),
            all,
            first,
            node: Vec::new(),
            members: Lists::default(),
        };
        facets.join(mesh);
        facets.number();
        facets
    }

    /// Gives corners of facets that hang together the lowest number among them.
    fn join(&mut self, mesh: &Mesh) {
        let mut around: HashMap<[u32; 2], Vec<(u32, [u32; 2])>> = HashMap::new();
        for (index, facet) in (0..).zip(&self.all) {
            let count = facet.corners.len();
            let first = self.first[index as usize];
            for at in 0..count {
                let mut ends =
                    [at, (at + 1) % count].map(|at| (facet.corners[at], (first + at) as u32));
                ends.sort_unstable();
                let [a, b] = ends;
                let own = around.entry([a.0, b.0]).or_default();
                own.push((index, [a.1, b.1]));
            }
        }
        let of = |index: u32| mesh.facets.fracture[self.all[index as usize].facet];
        let mut sets = DisjointSets::new(self.patch.len());
        for own in around.values() {
            if let [(one, [a, b]), (other, [c, d])] = own[..]
                && of(one) == of(other)
            {
                sets.join(a, c);
                sets.join(b, d);
            }
        }
        for corner in &mut self.patch {
            *corner = sets.root(*corner);
        }
    }

    /// Numbers the patches.
    fn number(&mut self) {
        let mut number = vec![u32::MAX; self.patch.len()];
        let mut members: Vec<Vec<u32>> = Vec::new();
        for (index, facet) in self.all.iter().enumerate() {
            for (at, &node) in facet.corners.iter().enumerate() {
                let lowest = &mut self.patch[self.first[index] + at];
                let own = &mut number[*lowest as usize];
                if *own == u32::MAX {
                    *own = members.len() as u32;
                    members.push(Vec::new());
                    self.node.push(node);
                }
                *lowest = *own;
                members[*own as usize].push(index as u32);
            }
        }
        self.members = Lists::collect(&members);
    }

    /// The smooth flux at the corners of each facet (m^2/s).
    fn smooth(&self, mesh: &Mesh) -> Vec<Vec<DVec3>> {
        let places: Vec<DVec3> = self
            .node
            .iter()
            .map(|&node| mesh.nodes[node as usize])
            .collect();
        let patches = 0..self.node.len();
        let fits: Vec<Option<Fit>> = patches
            .clone()
            .map(|patch| self.fit(patch, places[patch]))
            .collect();
        let at = |patch: usize| {
            if let Some(fit) = &fits[patch] {
                return fit.value;
            }
            // What the patches beside it say, else the mean.
            let (mut sum, mut count) = (DVec3::ZERO, 0.0);
            let (mut flux, mut area) = (DVec3::ZERO, 0.0);
            for &facet in self.members.of(patch) {
                let own = &self.all[facet as usize];
                (flux, area) = (flux + own.area * own.flux, area + own.area);
                let corners = self.first[facet as usize]..self.first[facet as usize + 1];
                for &other in &self.patch[corners] {
                    if let Some(fit) = &fits[other as usize] {
                        sum += fit.at(places[patch] - places[other as usize]);
                        count += 1.0;
                    }
                }
            }
            if count > 0.0 {
                sum / count
            } else {
                flux / area
            }
        };
        let values: Vec<DVec3> = patches.map(at).collect();
        let facets = self.first.windows(2);
        facets
            .map(|ends| {
                let own = self.patch[ends[0]..ends[1]].iter();
                own.map(|&patch| values[patch as usize]).collect()
            })
            .collect()
    }

    /// The linear polynomial that comes nearest to the fluxes at the centres of a patch, about its
    /// node; none if there are too few.
    fn fit(&self, patch: usize, place: DVec3) -> Option<Fit> {
        let members = self.members.of(patch);
        let own = || members.iter().map(|&facet| &self.all[facet as usize]);
        if members.len() < FEWEST {
            return None;
        }
        let normal = own().map(|facet| facet.area * facet.normal).sum::<DVec3>();
        let axis = normal.try_normalize()?.any_orthonormal_vector();
        let axes = [axis, normal.normalize().cross(axis)];
        let width = own().map(|facet| facet.area).sum::<f64>().sqrt();
        let mut matrix = DMat3::ZERO;
        let mut sums = [DVec3::ZERO; 3];
        for facet in own() {
            let arm = (facet.centre - place) / width;
            let terms = DVec3::new(1.0, arm.dot(axes[0]), arm.dot(axes[1]));
            matrix += DMat3::from_cols(terms.x * terms, terms.y * terms, terms.z * terms);
            (0..3).for_each(|term| sums[term] += terms[term] * facet.flux);
        }
        if matrix.determinant() < SINGULAR * (trace(matrix) / 3.0).powi(3) {
            return None;
        }
        let inverse = matrix.inverse();
        let term = |row: usize| (0..3).map(|term| inverse.col(term)[row] * sums[term]).sum();
        let [value, a, b]: [DVec3; 3] = std::array::from_fn(term);
        Some(Fit {
            value,
            slopes: [(axes[0] / width, a), (axes[1] / width, b)],
        })
    }
}

/// A linear polynomial about a node.
struct Fit {
    value: DVec3,
    /// Directions (1/m), and what it gains along them.
    slopes: [(DVec3, DVec3); 2],
}

impl Fit {
    fn at(&self, arm: DVec3) -> DVec3 {
        let gains = self
            .slopes
            .iter()
            .map(|(along, gain)| arm.dot(*along) * *gain);
        self.value + gains.sum::<DVec3>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kluft_mesh::structured::{Patch, cells_of};
    use kluft_mesh::{Shape, SurfaceRole};
    use lie_core::FacetFlow;

    const VISCOSITY: f64 = 1e-3;
    const CUBED: f64 = 1e-12;

    /// A box of 2 by 2 by 2 m with fractures on planes.
    fn mesh(shape: Shape, count: usize, planes: &[Patch<'_>]) -> Mesh {
        let draft = cells_of(shape, [count, count, 2], [2.0; 3], planes);
        let role = |name: &str| match name {
            "rock" => SurfaceRole::Unused,
            _ => SurfaceRole::Fracture,
        };
        let roles: Vec<SurfaceRole> = draft.groups.iter().map(|own| role(&own.name)).collect();
        Mesh::build(draft, &roles).expect("a sound mesh")
    }

    /// Fields of the pressure that is `of` a place at the nodes.
    fn fields(mesh: &Mesh, of: impl Fn(DVec3) -> f64) -> FlowFields {
        let elements = &mesh.facets.elements;
        let place = |&node: &u32| mesh.nodes[node as usize];
        let flux = |facet: usize| {
            let corners: Vec<DVec3> = elements.nodes_of(facet).iter().map(place).collect();
            let own: Vec<f64> = corners.iter().map(|&corner| of(corner)).collect();
            let stencil = FacetFlow::of(elements.shapes[facet], &corners);
            -CUBED / VISCOSITY * stencil.mean_gradient(&own)
        };
        FlowFields {
            pressures: elements.nodes.iter().map(|node| of(place(node))).collect(),
            hydraulic_apertures: Vec::new(),
            transmissivities: vec![CUBED; elements.len()],
            fluxes: (0..elements.len()).map(flux).collect(),
        }
    }

    /// A harmonic pressure and its gradient in the plane.
    fn cubic(at: DVec3) -> (f64, DVec3) {
        let value = at.x.powi(3) - 3.0 * at.x * at.y.powi(2);
        let slopes = [at.x.powi(2) - at.y.powi(2), -2.0 * at.x * at.y];
        (value, 3.0 * DVec3::new(slopes[0], slopes[1], 0.0))
    }

    /// Error of the gradient of nodal values on triangles and rectangles, as a share.
    fn true_error(mesh: &Mesh) -> f64 {
        const PARTS: usize = 6;
        let (mut error, mut energy) = (0.0, 0.0);
        for facet in 0..mesh.facets.elements.len() {
            let corners = mesh.corners(&mesh.facets.elements, facet);
            let last = corners.len() - 1;
            let (a, b) = (corners[1] - corners[0], corners[last] - corners[0]);
            let values: Vec<f64> = corners.iter().map(|&corner| cubic(corner).0).collect();
            for part in 0..PARTS * PARTS {
                let middle = |index: usize| (index as f64 + 0.5) / PARTS as f64;
                let (mut u, mut v) = (middle(part / PARTS), middle(part % PARTS));
                if last == 2 && u + v > 1.0 {
                    (u, v) = (1.0 - v, 1.0 - u);
                }
                let across = if last == 3 {
                    values[2] - values[1] - values[3] + values[0]
                } else {
                    0.0
                };
                let rises = [
                    values[1] - values[0] + v * across,
                    values[last] - values[0] + u * across,
                ];
                let normal = a.cross(b);
                let slope = rises[0] * b.cross(normal) + rises[1] * normal.cross(a);
                let exact = cubic(corners[0] + u * a + v * b).1;
                error += (slope / normal.length_squared() - exact).length_squared();
                energy += exact.length_squared();
            }
        }
        (error / energy).sqrt()
    }

    #[test]
    fn the_estimate_is_the_error_of_a_smooth_flow() {
        for shape in [Shape::Tet4, Shape::Hex8] {
            let plane = [Patch::new("joint", &|x| x[2] == 1.0)];
            let mesh = mesh(shape, 12, &plane);
            let found = FluxError::of(&mesh, &fields(&mesh, |at| cubic(at).0), VISCOSITY);
            let ratio = found.relative / true_error(&mesh);
            assert!((0.95..1.1).contains(&ratio), "{shape:?}: {ratio}");
        }
    }

    #[test]
    fn flux_that_jumps_where_fractures_cross_is_no_error() {
        let planes = [
            Patch::new("one", &|x| x[1] == 1.0),
            Patch::new("other", &|x| x[0] == 1.0),
        ];
        let mesh = mesh(Shape::Tet4, 6, &planes);
        let pressure = |at: DVec3| {
            let along = at.x - 1.0;
            along.max(3.0 * along) + 5.0 * (at.y - 1.0).abs()
        };
        let found = FluxError::of(&mesh, &fields(&mesh, pressure), VISCOSITY);
        assert!(found.relative < 1e-12, "{}", found.relative);
        let joined = fields(&mesh, |at| at.x.powi(2));
        assert!(FluxError::of(&mesh, &joined, VISCOSITY).relative > 1e-3);
    }

    #[test]
    fn fluid_at_rest_has_no_error() {
        let mesh = mesh(Shape::Hex8, 2, &[Patch::new("joint", &|x| x[2] == 1.0)]);
        let found = FluxError::of(&mesh, &fields(&mesh, |_| 1e6), VISCOSITY);
        assert_eq!(found.relative, 0.0);
    }
}
