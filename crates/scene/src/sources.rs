//! Where sources inside the body meet its fractures.

use std::collections::BTreeSet;

use glam::DVec3;
use kluft_mesh::{Defect, Mesh, nearest};
use kluft_solver::{Conduit, Field, FlowCondition, FlowDrive, FlowPlace, LineShare, Profile};
use lie_core::{Conduction, HydraulicAperture};

use crate::cases::Bound;
use crate::fluid::{SourceEntry, SourcePlace};
use crate::lines::LineShares;
use crate::scene::Named;

/// A borehole further from its node than this share of the edges there is told.
const BESIDE: f64 = 1e-6;
/// Crossings of one fracture nearer to each other than this share of a borehole are one.
const SAME_PLACE: f64 = 1e-9;
/// Crossings that are told one by one.
const TOLD: usize = 8;

/// A source on its way to nodes.
pub(crate) struct Drilling<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) conduits: &'a [Conduit],
    pub(crate) bound: &'a Bound<'a>,
    /// Density times the upward acceleration of gravity (Pa/m).
    pub(crate) weight: f64,
    /// Load case of the source.
    pub(crate) case: usize,
}

/// Where a borehole goes through a fracture.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// Share of the borehole.
    along: f64,
    fracture: u32,
    /// The corner of the facet there that is nearest, and its distance (m).
    node: u32,
    distance: f64,
}

impl Drilling<'_> {
    /// What a source does to the flow.
    ///
    /// # Errors
    /// If it meets no fracture that conducts.
    pub(crate) fn conditions(
        &self,
        entry: &Named<SourceEntry>,
        (lines, decisions): (&mut Vec<Vec<LineShare>>, &mut Vec<String>),
    ) -> Result<Vec<FlowCondition>, Defect> {
        let condition = |place: FlowPlace| FlowCondition {
            name: entry.name.clone(),
            place,
            drive: entry.value.drive.resolved(self.weight),
            case: self.case,
        };
        match &entry.value.place {
            SourcePlace::At { at, radius } => {
                let node = self.well(entry, *at, decisions)?;
                Ok(vec![condition(self.open_at(node, *radius, lines))])
            }
            SourcePlace::Fracture(name) => {
                let fracture = self.fracture(entry, name)?;
                Ok(vec![condition(FlowPlace::Fracture(fracture))])
            }
            SourcePlace::Curve(name) => {
                let pieces = self.curve(entry, name)?;
                lines.push(self.line(entry, &pieces, decisions)?);
                Ok(vec![condition(FlowPlace::Line(lines.len() - 1))])
            }
            SourcePlace::Points(points) => {
                let pieces: Vec<_> = points.windows(2).map(|pair| [pair[0], pair[1]]).collect();
                lines.push(self.line(entry, &pieces, decisions)?);
                Ok(vec![condition(FlowPlace::Line(lines.len() - 1))])
            }
            SourcePlace::Along { from, to, radius } => {
                self.borehole(entry, ([*from, *to], *radius), (lines, decisions))
            }
        }
    }

    fn conducts(&self, fracture: u32) -> bool {
        self.conduits[fracture as usize] != Conduit::Sealed
    }

    /// The fracture of a name, if it conducts.
    fn fracture(&self, entry: &Named<SourceEntry>, name: &str) -> Result<usize, Defect> {
        let names = &self.mesh.fractures;
        let Some(found) = names.iter().position(|known| known == name) else {
            let remedy = match nearest(name, names.iter().map(String::as_str)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("fractures of the mesh: {}", names.join(", ")),
            };
            let problem = format!("`{name}` is no fracture of the mesh");
            return Err(Defect::new(&entry.place, problem, remedy));
        };
        if self.conducts(found as u32) {
            return Ok(found);
        }
        let problem = format!("`{name}` is sealed: nothing can flow into it");
        let remedy = "remove sealed = true there, or the source";
        Err(Defect::new(&entry.place, problem, remedy))
    }

    /// The pieces of a curve of the mesh (m).
    fn curve(&self, entry: &Named<SourceEntry>, name: &str) -> Result<Vec<[DVec3; 2]>, Defect> {
        let curves = &self.mesh.curves;
        let found = curves.iter().find(|curve| curve.name == name);
        let found = found.filter(|curve| !curve.pieces.is_empty());
        let Some(curve) = found else {
            let names = || curves.iter().map(|curve| curve.name.as_str());
            let remedy = match nearest(name, names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None if curves.is_empty() => format!(
                    "name it in the geometry: Physical Curve(\"{name}\") = {{...}}; or give its points"
                ),
                None => format!(
                    "curves of the mesh: {}",
                    names().collect::<Vec<_>>().join(", ")
                ),
            };
            let problem = format!("`{name}` is no curve of the mesh");
            return Err(Defect::new(&entry.place, problem, remedy));
        };
        let pieces = curve.pieces.iter();
        Ok(pieces.map(|ends| ends.map(DVec3::from)).collect())
    }

    /// What corners of fractures share of a line.
    fn line(
        &self,
        entry: &Named<SourceEntry>,
        pieces: &[[DVec3; 2]],
        decisions: &mut Vec<String>,
    ) -> Result<Vec<LineShare>, Defect> {
        let facets = &self.mesh.facets;
        let all = 0..facets.elements.len();
        let conducting: Vec<usize> = all.filter(|&f| self.conducts(facets.fracture[f])).collect();
        let found = LineShares::of(self.mesh, &conducting, pieces);
        if found.shares.is_empty() {
            return Err(Defect::new(
                &entry.place,
                "the line runs in no fracture that conducts",
                "let it lie within one; a borehole that crosses fractures has from, to and radius",
            ));
        }
        if entry.value.drive.drive.is_pressure() && !found.is_on_edges {
            return Err(Defect::new(
                &entry.place,
                "a pressure is given along a line that runs across facets, where no node has it",
                "let edges run along it: embed it in the surface of the geometry \
                 (Curve{...} In Surface{...}) and name it as a curve; or give a rate",
            ));
        }
        let [whole, within] = found.lengths;
        if within < (1.0 - BESIDE) * whole {
            let name = &entry.name;
            decisions.push(format!(
                "{name}: {within:.4e} m of its {whole:.4e} m lie in fractures that conduct; the \
                 rest does nothing"
            ));
        }
        Ok(self.through_layers(found.shares))
    }

    /// The shares of a line in both layers of nodes of a mesh of the plane.
    fn through_layers(&self, shares: Vec<LineShare>) -> Vec<LineShare> {
        if !self.mesh.is_plane() {
            return shares;
        }
        let elements = &self.mesh.facets.elements;
        let of_share = |share: LineShare| {
            let below = self.mesh.layer_below(share.node);
            let facet = share.facet as usize;
            let corners = &elements.nodes_of(facet)[..elements.shapes[facet].corner_count()];
            let both = corners.iter().copied();
            let both = both.filter(move |&node| self.mesh.layer_below(node) == below);
            both.map(move |node| LineShare {
                node,
                length: 0.5 * share.length,
                ..share
            })
        };
        shares.into_iter().flat_map(of_share).collect()
    }

    /// A borehole through all fractures that it crosses: one pressure is hydrostatic along it,
    /// pressures that change from place to place are what they are, a rate is shared by the
    /// transmissivities of the fractures without load.
    fn borehole(
        &self,
        entry: &Named<SourceEntry>,
        (ends, radius): ([DVec3; 2], f64),
        (lines, decisions): (&mut Vec<Vec<LineShare>>, &mut Vec<String>),
    ) -> Result<Vec<FlowCondition>, Defect> {
        let crossings = self.crossings(ends);
        let drive = entry.value.drive.resolved(self.weight);
        let is_pressure = drive.is_pressure();
        if crossings.is_empty() {
            let [a, b] = ends;
            return Err(Defect::new(
                &entry.place,
                format!(
                    "the borehole from ({}, {}, {}) to ({}, {}, {}) crosses no fracture that conducts",
                    a.x, a.y, a.z, b.x, b.y, b.z
                ),
                "let it cross one; a borehole within the plane of a fracture does not, nor does one \
                 that ends before it",
            ));
        }
        if entry.value.drive.in_time().is_some() && is_pressure && self.weight != 0.0 {
            return Err(Defect::new(
                &entry.place,
                "the pressure of a borehole changes with time, but the weight of the fluid in it does not",
                "let it change from place to place and scale it by a history, or give a source `at` \
                 each fracture its own",
            ));
        }
        decisions.push(self.told(entry, &crossings));
        let weights: Vec<f64> = crossings
            .iter()
            .map(|one| self.cubed(one.fracture))
            .collect();
        let whole: f64 = weights.iter().sum();
        let mut condition = |(crossing, weight): (&Crossing, f64)| FlowCondition {
            name: format!(
                "{} through {}",
                entry.name, self.mesh.fractures[crossing.fracture as usize]
            ),
            place: self.open_at(crossing.node, radius, lines),
            drive: match &drive {
                FlowDrive::Rate(rate) => FlowDrive::Rate(rate * weight / whole),
                leakoff @ FlowDrive::Leakoff(_) => leakoff.clone(),
                FlowDrive::Pressure(given) if given.depends_on_place() => drive.clone(),
                FlowDrive::Pressure(given) => FlowDrive::Pressure(Field::from(Profile {
                    per_metre: self.weight,
                    at: ends[0].z,
                    value: given.at(ends[0], 0.0),
                })),
            },
            case: self.case,
        };
        Ok(crossings.iter().zip(weights).map(&mut condition).collect())
    }

    /// Cube of the hydraulic aperture of a fracture without load (m^3).
    fn cubed(&self, fracture: u32) -> f64 {
        let Conduit::Open(hydraulic) = self.conduits[fracture as usize] else {
            return 0.0;
        };
        let law = self.bound.fractures[fracture as usize].value.fracture.law;
        let Conduction {
            hydraulic_aperture, ..
        } = HydraulicAperture::at(hydraulic, law.closure.aperture);
        hydraulic_aperture.powi(3)
    }

    fn told(&self, entry: &Named<SourceEntry>, crossings: &[Crossing]) -> String {
        let name = |one: &Crossing| self.mesh.fractures[one.fracture as usize].as_str();
        let names: Vec<&str> = crossings.iter().take(TOLD).map(name).collect();
        let more = match crossings.len() {
            count if count > TOLD => format!(" and {} more", count - TOLD),
            _ => String::new(),
        };
        let farthest = crossings.iter().map(|one| one.distance).fold(0.0, f64::max);
        format!(
            "{} crosses {}{more}; it is open at their nearest nodes, at most {farthest:.3e} m away",
            entry.name,
            names.join(", ")
        )
    }

    /// The crossings of a borehole in its order, each node once.
    fn crossings(&self, ends: [DVec3; 2]) -> Vec<Crossing> {
        let facets = &self.mesh.facets;
        let all = (0..facets.elements.len()).filter(|&f| self.conducts(facets.fracture[f]));
        let mut found: Vec<Crossing> = all.filter_map(|facet| self.crossing(facet, ends)).collect();
        found.sort_by(|a, b| {
            (a.fracture, a.along)
                .partial_cmp(&(b.fracture, b.along))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        // Where it hits an edge all facets there are hit.
        let same = |a: &Crossing, b: &Crossing| {
            a.fracture == b.fracture && (a.along - b.along).abs() <= SAME_PLACE
        };
        let nearest = |run: &[Crossing]| {
            let by_distance = |a: &&Crossing, b: &&Crossing| a.distance.total_cmp(&b.distance);
            run.iter().min_by(by_distance).copied()
        };
        let mut found: Vec<Crossing> = found.chunk_by(same).filter_map(nearest).collect();
        found.sort_by(|a, b| a.along.total_cmp(&b.along));
        let mut seen = BTreeSet::new();
        found.retain(|crossing| seen.insert(crossing.node));
        found
    }

    /// Where a borehole goes through a facet.
    fn crossing(&self, facet: usize, [from, to]: [DVec3; 2]) -> Option<Crossing> {
        let elements = &self.mesh.facets.elements;
        let corners = self.mesh.corners(elements, facet);
        let fan = (1..corners.len() - 1).map(|k| [corners[0], corners[k], corners[k + 1]]);
        let along = fan
            .filter_map(|triangle| through(triangle, from, to))
            .next()?;
        let at = from + along * (to - from);
        let nodes = &elements.nodes_of(facet)[..corners.len()];
        let distances = nodes.iter().zip(&corners);
        let distances = distances.map(|(&node, x)| (node, x.distance(at)));
        let (node, distance) = distances.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Crossing {
            along,
            fracture: self.mesh.facets.fracture[facet],
            node,
            distance,
        })
    }

    /// Where a borehole is open that meets fractures at a node. In the plane it is one along the
    /// edge of the facets there: nothing flows around it, so that its radius does not matter.
    fn open_at(&self, node: u32, radius: f64, lines: &mut Vec<Vec<LineShare>>) -> FlowPlace {
        if !self.mesh.is_plane() {
            return FlowPlace::Well { node, radius };
        }
        let facets = &self.mesh.facets;
        let all = (0..facets.elements.len()).filter(|&f| self.conducts(facets.fracture[f]));
        let around = all.filter(|&facet| facets.elements.nodes_of(facet).contains(&node));
        let share = |facet: usize| LineShare {
            node,
            facet: facet as u32,
            length: 1.0,
        };
        lines.push(self.through_layers(around.map(share).collect()));
        FlowPlace::Line(lines.len() - 1)
    }

    /// The node of a borehole at a place.
    fn well(
        &self,
        entry: &Named<SourceEntry>,
        at: DVec3,
        decisions: &mut Vec<String>,
    ) -> Result<u32, Defect> {
        let mesh = self.mesh;
        let facets = &mesh.facets;
        let conducts = |facet: &usize| self.conducts(facets.fracture[*facet]);
        let all = (0..facets.elements.len()).filter(conducts);
        let corners = |facet: usize| {
            let count = facets.elements.shapes[facet].corner_count();
            &facets.elements.nodes_of(facet)[..count]
        };
        let nodes: BTreeSet<u32> = all.clone().flat_map(corners).copied().collect();
        let distance = |node: u32| mesh.nodes[node as usize].distance(at);
        let nearest = nodes.into_iter();
        let nearest = nearest.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        let Some(node) = nearest else {
            return Err(Defect::new(&entry.place, "it hits no fracture", "add one"));
        };
        let around = all.filter(|facet| corners(*facet).contains(&node));
        let edges = around
            .flat_map(corners)
            .map(|&other| mesh.edge_length([node, other]));
        let longest = edges.fold(0.0, f64::max);
        let (x, tag) = (mesh.nodes[node as usize], mesh.node_tags[node as usize]);
        let found = format!("node {tag} at ({:.6}, {:.6}, {:.6})", x.x, x.y, x.z);
        let wanted = format!("({}, {}, {})", at.x, at.y, at.z);
        if distance(node) > longest {
            return Err(Defect::new(
                &entry.place,
                format!("the borehole at {wanted} hits no fracture that conducts"),
                format!("the nearest such is {found}"),
            ));
        }
        if distance(node) > BESIDE * longest {
            let name = &entry.name;
            decisions.push(format!(
                "{name}: no node of a fracture at {wanted}; {found} is taken instead"
            ));
        }
        Ok(node)
    }
}

/// Share of the way from one place to another at which it goes through a triangle, edges included
/// (Moeller & Trumbore 1997).
fn through([a, b, c]: [DVec3; 3], from: DVec3, to: DVec3) -> Option<f64> {
    /// Triangles are this much larger, as a share of themselves, so that none is missed between
    /// two.
    const RIM: f64 = 1e-9;
    let way = to - from;
    let (first, second) = (b - a, c - a);
    let across = way.cross(second);
    let volume = first.dot(across);
    if volume.abs() <= 1e-12 * way.length() * first.cross(second).length() {
        return None;
    }
    let offset = from - a;
    let u = offset.dot(across) / volume;
    let turned = offset.cross(first);
    let v = way.dot(turned) / volume;
    let along = second.dot(turned) / volume;
    let is_inside = u >= -RIM && v >= -RIM && u + v <= 1.0 + RIM;
    (is_inside && (0.0..=1.0).contains(&along)).then_some(along)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn a_way_goes_through_a_triangle_or_beside_it() {
        let down = |x: f64, y: f64, to: f64| {
            through(TRIANGLE, DVec3::new(x, y, 3.0), DVec3::new(x, y, to))
        };
        assert_eq!(down(0.2, 0.3, -1.0), Some(0.75));
        assert_eq!(down(0.5, 0.5, -1.0), Some(0.75));
        assert_eq!(down(0.6, 0.5, -1.0), None);
        assert_eq!(down(0.2, 0.3, 1.0), None);
        assert_eq!(
            through(
                TRIANGLE,
                DVec3::new(-1.0, 0.2, 0.0),
                DVec3::new(2.0, 0.2, 0.0)
            ),
            None
        );
    }
}
