//! Writes a network as a gmsh geometry.
//!
//! The arrangement is written out for gmsh's own kernel. On demand OpenCASCADE cuts the polygons
//! instead. Its fragments have other numbers than what they were cut from, and gmsh's script
//! language does not say which came from where. So the script finds the pieces of each fracture
//! again by geometry, and refuses to mesh unless they make up the fracture's area. `network.geo` is
//! the script; here stands what is different from network to network.

use std::fmt::{self, Write};

use glam::DVec3;

use crate::clip::FACES;
use crate::geo_samples::{Row, along, over};
use crate::geo_surfaces::{Lines, points, surfaces};
use crate::geo_template::{List, fill};
use crate::intersections::Intersection;
use crate::network::Network;

/// What gets a physical surface of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// Each fracture.
    Fracture,
    /// Each set.
    Set,
}

/// OpenCASCADE adds 1e-7 m to the boxes around shapes, whatever the size of the domain: a search
/// within less finds nothing (m).
const SMALLEST_BOX: f64 = 1e-6;

/// The geometry of a network, with `title` in its first line. The rock is the box of the domain, or
/// the volumes of another geometry, a path as gmsh reads it; there OpenCASCADE cuts the polygons.
pub fn write_geo(network: &Network, grouping: Grouping, title: &str, body: Option<&str>) -> String {
    let shared = long_intersections(network);
    let has_fractures = !network.fractures.is_empty();
    let holds = |condition: &str| match condition {
        "fractures" => has_fractures,
        "box" => body.is_none(),
        "body" => body.is_some(),
        "fractures in box" => has_fractures && body.is_none(),
        "fractures in body" => has_fractures && body.is_some(),
        "intersections" => !shared.is_empty(),
        _ => true,
    };
    let (sizes, domain) = (&network.sizes, &network.domain);
    let lines = Lines::of(&network.arrangement);
    let arranged =
        |out: &mut String, is_split: bool| surfaces(out, &network.arrangement, &lines, is_split);
    let value = |name: &str| match name {
        "body" => body.unwrap_or_default().to_owned(),
        "title" => title.replace(char::is_control, " "),
        "h" => format!("{:?}", sizes.h),
        "h_fracture" => format!("{:?}", sizes.h_fracture),
        "h_intersection" => format!("{:?}", sizes.h_intersection),
        "growth" => format!("{:?}", sizes.growth),
        "low" => List(&domain.low.to_array()).to_string(),
        "high" => List(&domain.high.to_array()).to_string(),
        "eps" => format!("{:?}", (1e3 * domain.tolerance()).max(SMALLEST_BOX)),
        "count" => network.fractures.len().to_string(),
        "areas" => areas(network),
        "names" => names(network),
        "corners" => text_of(|out| corners(out, network)),
        "points" => text_of(|out| points(out, &network.arrangement, &lines)),
        "whole" => text_of(|out| arranged(out, false)),
        "split" => text_of(|out| arranged(out, true)),
        "spacing" => format!("{:?}", sizes.h_fracture),
        "samples" => {
            let all = network.fractures.iter();
            text_of(|out| {
                rows(
                    out,
                    all.flat_map(|one| over(&one.polygon, sizes.h_fracture)),
                )
            })
        }
        "line_spacing" => format!("{:?}", sizes.h_intersection),
        "line_samples" => {
            let all = shared.iter();
            text_of(|out| rows(out, all.map(|shared| along(shared, sizes.h_intersection))))
        }
        "groups" => text_of(|out| groups(out, network, grouping, body.is_none())),
        _ => String::new(),
    };
    fill(include_str!("network.geo"), holds, value)
}

fn areas(network: &Network) -> String {
    let areas = network.fractures.iter().map(|one| one.polygon.area());
    List(&areas.collect::<Vec<f64>>()).to_string()
}

fn names(network: &Network) -> String {
    let fractures = network.fractures.iter();
    let names = fractures.map(|one| format!("\"{}\"", one.name));
    names.collect::<Vec<String>>().join(", ")
}

/// What is written, without the end of its last line.
fn text_of(write: impl FnOnce(&mut String) -> fmt::Result) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut out);
    out.truncate(out.trim_end_matches('\n').len());
    out
}

/// Corners of all fractures in one list for each axis. Names do not stand here: where gmsh skips a
/// block, it takes the words of a text for commands.
fn corners(out: &mut String, network: &Network) -> fmt::Result {
    let mut first = vec![0];
    for fracture in &network.fractures {
        let corners = fracture.polygon.corners();
        first.push(first[first.len() - 1] + corners.len());
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let values: Vec<f64> = corners.iter().map(|corner| corner[axis]).collect();
            writeln!(out, "{name}() += {};", List(&values))?;
        }
    }
    let first: Vec<String> = first.iter().map(usize::to_string).collect();
    writeln!(out, "first() = {{{}}};", first.join(", "))?;
    let normals: Vec<DVec3> = network
        .fractures
        .iter()
        .map(|f| f.polygon.normal())
        .collect();
    for (axis, name) in ["nx", "ny", "nz"].into_iter().enumerate() {
        let values: Vec<f64> = normals.iter().map(|normal| normal[axis]).collect();
        writeln!(out, "{name}() = {};", List(&values))?;
    }
    Ok(())
}

/// The segments where fractures meet, without points of contact.
fn long_intersections(network: &Network) -> Vec<&Intersection> {
    let least = network.domain.tolerance();
    let all = network.intersections.iter().map(|(_, shared)| shared);
    all.filter(|shared| shared.length() > least).collect()
}

/// Rows of points in one list, seven numbers each.
fn rows(out: &mut String, rows: impl Iterator<Item = Row>) -> fmt::Result {
    writeln!(out, "rows() = {{}};")?;
    let numbers = |row: Row| {
        let ends = row.from.to_array().into_iter().chain(row.step.to_array());
        ends.chain([row.steps as f64])
    };
    let all: Vec<f64> = rows.flat_map(numbers).collect();
    for part in all.chunks(700) {
        writeln!(out, "rows() += {};", List(part))?;
    }
    Ok(())
}

/// The physical surfaces.
fn groups(out: &mut String, network: &Network, grouping: Grouping, is_box: bool) -> fmt::Result {
    for (face, ..) in FACES {
        let group = format!("Physical Surface(\"{face}\") = {face}();");
        match is_box {
            true => writeln!(out, "{group}")?,
            // The faces of a body need not lie on those of the box around it.
            false => writeln!(out, "If (#{face}() > 0)\n  {group}\nEndIf")?,
        }
    }
    if grouping == Grouping::Fracture {
        for (index, fracture) in network.fractures.iter().enumerate() {
            writeln!(
                out,
                "Physical Surface(\"{}\") = piece_{index}();",
                fracture.name
            )?;
        }
    }
    if grouping == Grouping::Set {
        for set in set_names(network) {
            let members = network
                .fractures
                .iter()
                .enumerate()
                .filter(|(_, f)| f.set == set);
            let pieces: Vec<String> = members
                .map(|(index, _)| format!("piece_{index}()"))
                .collect();
            writeln!(
                out,
                "Physical Surface(\"{set}\") = {{{}}};",
                pieces.join(", ")
            )?;
        }
    }
    Ok(())
}

/// Names of the sets with fractures, in order of appearance.
pub(crate) fn set_names(network: &Network) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for fracture in &network.fractures {
        if !names.contains(&fracture.set.as_str()) {
            names.push(&fracture.set);
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::Domain;
    use crate::fracture::{CellSizes, InputFracture};
    use crate::{Orientation, Outline, Polygon};

    fn network() -> Network {
        let domain = Domain {
            low: DVec3::ZERO,
            high: DVec3::ONE,
        };
        let sizes = CellSizes {
            h: 0.25,
            h_fracture: 0.125,
            h_intersection: 0.1,
            growth: 0.5,
            small: 0.2,
            small_angle: 10.0,
            snap: true,
        };
        let given = |name: &str, set: &str, dip: f64| {
            let outline = Outline::Rectangle {
                length: 0.5,
                width: 0.5,
                rotation: 0.0,
            };
            let orientation = Orientation {
                dip,
                dip_direction: 90.0,
            };
            InputFracture {
                name: name.into(),
                set: set.into(),
                place: String::new(),
                polygon: Polygon::placed(outline, DVec3::splat(0.5), orientation),
            }
        };
        let list = vec![
            given("a", "east", 20.0),
            given("b", "east", 80.0),
            given("c", "steep", 140.0),
        ];
        Network::build(domain, sizes, list).expect("a network")
    }

    #[test]
    fn every_fracture_has_its_group_and_its_check() {
        let geo = write_geo(&network(), Grouping::Fracture, "three", None);
        for name in ["a", "b", "c", "top", "left"] {
            assert_eq!(
                geo.matches(&format!("Physical Surface(\"{name}\")"))
                    .count(),
                1
            );
        }
        assert!(
            geo.contains("names() = Str(\"a\", \"b\", \"c\");")
                && geo.contains("h = {0.25, Name \"h\"},")
        );
    }

    #[test]
    fn sets_gather_their_fractures() {
        let geo = write_geo(&network(), Grouping::Set, "three", None);
        assert!(geo.contains("Physical Surface(\"east\") = {piece_0(), piece_1()};"));
        assert!(geo.contains("Physical Surface(\"steep\") = {piece_2()};"));
    }
}
