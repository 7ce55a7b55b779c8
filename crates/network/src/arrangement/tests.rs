//! Arrangements whose points and edges are known.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::arrange::Arrangement;
use super::collapse::collapse;
use super::faces::faces;
use super::sheet::Sheet;
use crate::clip::Domain;
use crate::fracture::{CellSizes, InputFracture, NetworkFracture};
use crate::network::{Network, coplanar_neighbours, intersections};
use crate::samples::{DOMAIN, FLOOR, SIZES, fracture, wall};
use crate::{Amount, Fisher, FractureShape, Orientation, SizeLaw, StochasticSet};

fn arranged(polygons: &[&[[f64; 3]]]) -> Arrangement {
    arranged_in(&DOMAIN, polygons)
}

fn arranged_in(domain: &Domain, polygons: &[&[[f64; 3]]]) -> Arrangement {
    let fractures: Vec<NetworkFracture> = polygons
        .iter()
        .map(|corners| fracture("f", corners))
        .collect();
    let polygons: Vec<_> = fractures.iter().map(|one| &one.polygon).collect();
    let shared = intersections(domain, &fractures);
    let coplanar = coplanar_neighbours(domain, &fractures);
    Arrangement::of(domain, &polygons, &shared, &coplanar)
}

/// A vertical rectangle through the middle of the floor, at right angles to the wall.
const CROSS_WALL: [[f64; 3]; 4] = [
    [4.0, 4.0, 3.0],
    [6.0, 4.0, 3.0],
    [6.0, 4.0, 6.0],
    [4.0, 4.0, 6.0],
];

fn trace_length(arrangement: &Arrangement, sheet: usize) -> f64 {
    let traces = arrangement.sheets[sheet].traces.iter();
    traces
        .map(|&[a, b]| arrangement.points[a].distance(arrangement.points[b]))
        .sum()
}

fn has_point(arrangement: &Arrangement, sheet: usize, at: [f64; 3]) -> bool {
    let points = arrangement.sheets[sheet].points();
    let at = DVec3::from(at);
    points
        .iter()
        .any(|&point| arrangement.points[point].distance(at) < 1e-12)
}

#[test]
fn two_that_cross_share_one_edge() {
    let made = arranged(&[&FLOOR, &wall(4.0)]);
    assert_eq!(made.sheets.len(), 8);
    assert_eq!(made.sheets[0].traces.len(), 1);
    let trace = made.sheets[0].traces.first().expect("a trace");
    assert!((trace_length(&made, 0) - 3.0).abs() < 1e-12);
    // The wall's outline has two more points, and its trace runs between them.
    assert_eq!(made.sheets[1].outline.len(), 6);
    assert_eq!(made.sheets[1].traces.first(), Some(trace));
    assert_eq!(made.points.len(), 8 + 4 + 4 + 2);
}

#[test]
fn an_abutting_end_is_an_edge_of_its_outline() {
    let made = arranged(&[&FLOOR, &wall(5.0)]);
    assert_eq!(made.sheets[1].traces.len(), 0);
    assert_eq!(made.sheets[1].outline.len(), 4);
    let trace = made.sheets[0].traces.first().expect("a trace");
    assert!(made.sheets[1].edges().contains(trace));
}

#[test]
fn three_planes_share_a_point() {
    let made = arranged(&[&FLOOR, &wall(4.0), &CROSS_WALL]);
    for sheet in 0..3 {
        assert_eq!(made.sheets[sheet].traces.len(), 4, "{sheet}");
        assert!(has_point(&made, sheet, [5.0, 4.0, 5.0]));
    }
    assert!((trace_length(&made, 0) - 5.0).abs() < 1e-12);
    assert!((trace_length(&made, 1) - 5.0).abs() < 1e-12);
    assert!((trace_length(&made, 2) - 4.0).abs() < 1e-12);
}

#[test]
fn a_fracture_cuts_the_faces_that_it_reaches() {
    let through = [
        [0.0, 0.0, 5.0],
        [10.0, 0.0, 5.0],
        [10.0, 10.0, 5.0],
        [0.0, 10.0, 5.0],
    ];
    let made = arranged(&[&through, &wall(4.0)]);
    for face in 2..6 {
        assert_eq!(made.sheets[face].traces.len(), 1, "{face}");
        assert_eq!(made.sheets[face].outline.len(), 6, "{face}");
        assert!((made.sheets[face].area(&made.points) - 100.0).abs() < 1e-9);
    }
    for face in 6..8 {
        assert!(made.sheets[face].traces.is_empty(), "{face}");
        assert_eq!(made.sheets[face].outline.len(), 4, "{face}");
    }
}

#[test]
fn a_corner_that_touches_is_a_contact() {
    let tent = [[5.0, 5.0, 5.0], [6.0, 5.0, 7.0], [4.0, 5.0, 7.0]];
    let made = arranged(&[&FLOOR, &tent]);
    assert_eq!(made.sheets[0].contacts.len(), 1);
    assert!(made.sheets[0].traces.is_empty() && made.sheets[1].contacts.is_empty());
    assert!(has_point(&made, 1, [5.0, 5.0, 5.0]));
}

#[test]
fn traces_in_one_line_share_their_pieces() {
    // Both walls stand on the floor in the line x = 5 and overlap there from y = 4 to 6.
    let slope = [
        [5.0, 4.0, 5.0],
        [5.0, 8.0, 5.0],
        [7.0, 8.0, 7.0],
        [7.0, 4.0, 7.0],
    ];
    let made = arranged(&[&FLOOR, &wall(5.0), &slope]);
    assert_eq!(made.sheets[0].traces.len(), 3);
    assert!((trace_length(&made, 0) - 5.0).abs() < 1e-12);
    let (wall, slope) = (made.sheets[1].edges(), made.sheets[2].edges());
    assert_eq!(wall.intersection(&slope).count(), 1);
}

#[test]
fn neighbours_in_one_plane_share_an_edge() {
    let beside = [
        [8.0, 3.0, 5.0],
        [9.0, 3.0, 5.0],
        [9.0, 6.0, 5.0],
        [8.0, 6.0, 5.0],
    ];
    let made = arranged(&[&FLOOR, &beside]);
    let (floor, beside) = (made.sheets[0].edges(), made.sheets[1].edges());
    assert_eq!(floor.intersection(&beside).count(), 1);
    assert_eq!(made.sheets[0].outline.len(), 6);
}

/// The faces of each surface make up its area, and hold each of its traces once.
fn check_faces(made: &Arrangement) {
    for (number, sheet) in made.sheets.iter().enumerate() {
        let faces = faces(sheet, &made.points);
        let area: f64 = faces
            .iter()
            .map(|face| face.area(&sheet.plane, &made.points))
            .sum();
        let whole = sheet.area(&made.points);
        assert!(
            (area - whole).abs() < 1e-12 * whole,
            "{number}: {area} of {whole}"
        );
        let loose: usize = faces.iter().map(|face| face.traces.len()).sum();
        let mut sides = BTreeMap::new();
        for ring in faces.iter().flat_map(|face| &face.rings) {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                *sides.entry([*a.min(b), *a.max(b)]).or_insert(0) += 1;
            }
        }
        let inner = sides.values().filter(|sides| **sides == 2).count();
        assert_eq!(loose + inner, sheet.traces.len(), "{number}");
    }
}

#[test]
fn faces_make_up_their_surfaces() {
    // Four walls around a shaft through the floor, and one that ends in it.
    let mut walls: Vec<[[f64; 3]; 4]> = Vec::new();
    for (from, to) in [
        ([3.0, 3.0], [6.0, 3.0]),
        ([6.0, 3.0], [6.0, 6.0]),
        ([6.0, 6.0], [3.0, 6.0]),
        ([3.0, 6.0], [3.0, 3.0]),
        ([4.0, 4.0], [7.0, 5.0]),
    ] {
        let [a, b] = [from, to];
        walls.push([
            [a[0], a[1], 4.0],
            [b[0], b[1], 4.0],
            [b[0], b[1], 7.0],
            [a[0], a[1], 7.0],
        ]);
    }
    let mut all: Vec<&[[f64; 3]]> = vec![&FLOOR];
    all.extend(walls.iter().map(|wall| wall as &[[f64; 3]]));
    let made = arranged(&all);
    check_faces(&made);
    let floor = faces(&made.sheets[0], &made.points);
    assert_eq!(floor.len(), 2);
    let holed = floor
        .iter()
        .find(|face| face.rings.len() == 2)
        .expect("a hole");
    assert!((holed.area(&made.sheets[0].plane, &made.points) - 27.0).abs() < 1e-12);
    assert_eq!(floor.iter().map(|face| face.traces.len()).sum::<usize>(), 2);
}

/// Random fractures whose arrangement has many triple points.
fn random_network(seed: u64, count: usize, snap: bool) -> Network {
    let sizes = CellSizes { snap, ..SIZES };
    let set = |name: &str, dip: f64, dip_direction: f64| StochasticSet {
        name: name.into(),
        orientation: Fisher {
            mean: Orientation { dip, dip_direction },
            kappa: 20.0,
        },
        size: SizeLaw::PowerLaw {
            exponent: 2.5,
            min: 1.0,
            max: 4.0,
        },
        shape: FractureShape::Disc { sides: 12 },
        amount: Amount::Count(count),
        seed,
    };
    let sets = [
        set("a", 80.0, 90.0),
        set("b", 80.0, 180.0),
        set("c", 8.0, 45.0),
    ];
    let drawn = sets
        .iter()
        .flat_map(|set| set.draw(&DOMAIN).expect("drawn"));
    let given = drawn.enumerate().map(|(number, one)| InputFracture {
        name: format!("f{number}"),
        set: "set".into(),
        place: "here".into(),
        polygon: one.polygon,
    });
    Network::build(DOMAIN, sizes, given.collect()).expect("a network")
}

#[test]
fn random_networks_keep_areas_and_lengths() {
    for seed in 0..5 {
        let network = random_network(seed, 20, false);
        let made = &network.arrangement;
        check_faces(made);
        for (fracture, sheet) in network.fractures.iter().zip(&made.sheets) {
            let (area, whole) = (sheet.area(&made.points), fracture.polygon.area());
            assert!((area - whole).abs() < 1e-9 * whole, "{area} {whole}");
        }
        // Traces and edges of outlines that lie on another fracture.
        let fractures = &made.sheets[..network.fractures.len()];
        let mut uses = BTreeMap::new();
        for ends in fractures.iter().flat_map(|sheet| sheet.edges()) {
            *uses.entry(ends).or_insert(0) += 1;
        }
        let shared = uses.iter().filter(|(_, uses)| **uses > 1);
        let found: f64 = shared
            .map(|([a, b], _)| made.points[*a].distance(made.points[*b]))
            .sum();
        let expected: f64 = network
            .intersections
            .iter()
            .map(|(_, one)| one.length())
            .sum();
        assert!(
            (found - expected).abs() < 1e-7 * expected,
            "{found} {expected}"
        );
    }
}

/// Whether an edge of one outline goes through another surface beside all their common points.
fn goes_through(made: &Arrangement, ends: [usize; 2], sheet: &Sheet) -> bool {
    let points = sheet.points();
    let [a, b] = ends.map(|end| made.points[end]);
    let (from, to) = (sheet.plane.height(a), sheet.plane.height(b));
    if ends.iter().any(|end| points.contains(end)) || from * to > 0.0 {
        return false;
    }
    let at = sheet.plane.flat(a.lerp(b, from / (from - to)));
    // The winding of the outline around the point: once, if it is inside.
    let corners: Vec<DVec2> = sheet
        .outline
        .iter()
        .map(|&point| sheet.plane.flat(made.points[point]) - at)
        .collect();
    let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
    let turns: f64 = pairs.map(|(p, q)| p.angle_to(*q)).sum();
    turns.abs() > 1.0
}

#[test]
fn collapsing_leads_no_fracture_through_another() {
    for seed in 0..20 {
        let network = random_network(seed, 60, true);
        let made = &network.arrangement;
        let fractures = &made.sheets[..network.fractures.len()];
        for (own, sheet) in fractures.iter().enumerate() {
            for (number, other) in fractures.iter().enumerate() {
                let mut rim = sheet.rim().filter(|_| number != own);
                assert!(
                    !rim.any(|ends| goes_through(made, ends, other)),
                    "seed {seed}: {own} {number}"
                );
            }
        }
    }
}

#[test]
fn collapsing_keeps_planes_and_leaves_sound_surfaces() {
    let mut gone = 0;
    for seed in 0..5 {
        let network = random_network(seed, 30, true);
        let made = &network.arrangement;
        check_faces(made);
        for (number, sheet) in made.sheets.iter().enumerate() {
            for point in sheet.points() {
                let off = sheet.plane.height(made.points[point]).abs();
                assert!(off < 1e-7, "{off}");
            }
            if let Some(fracture) = network.fractures.get(number) {
                let (area, whole) = (sheet.area(&made.points), fracture.polygon.area());
                let reach = 4.0 * SIZES.short() * whole.sqrt();
                assert!((area - whole).abs() < reach, "{area} {whole}");
            } else {
                assert!((sheet.area(&made.points) - 100.0).abs() < 1e-9);
            }
        }
        gone += network
            .fractures
            .iter()
            .filter(|one| one.farthest_move > 0.0)
            .count();
        // Points that few planes fix have no short edge left but where a change is refused.
        assert_eq!(
            random_network(seed, 30, true).arrangement,
            network.arrangement
        );
    }
    assert!(gone > 0);
}

#[test]
fn a_trace_that_becomes_a_point_leaves_a_contact() {
    let tent = [[5.0, 5.0, 4.97], [6.0, 5.0, 7.0], [4.0, 5.0, 7.0]];
    let mut made = arranged(&[&FLOOR, &tent]);
    assert_eq!(made.sheets[0].traces.len(), 1);
    collapse(&mut made, SIZES.short(), 1e-9);
    assert!(made.sheets[0].traces.is_empty());
    let contacts: Vec<&usize> = made.sheets[0].contacts.iter().collect();
    assert!(matches!(contacts[..], [only] if made.sheets[1].outline.contains(only)));
    assert_eq!(made.sheets[1].outline.len(), 3);
}

#[test]
fn an_end_just_beyond_a_trace_moves_onto_it() {
    // The small wall crosses the floor from x = 2.5 to just beyond the great one at x = 5.
    let end = 5.0 + 0.5 * SIZES.short();
    let small = [
        [2.5, 4.0, 4.0],
        [end, 4.0, 4.0],
        [end, 4.0, 6.0],
        [2.5, 4.0, 6.0],
    ];
    let mut made = arranged(&[&FLOOR, &wall(3.0), &small]);
    assert_eq!(made.sheets[0].traces.len(), 4);
    let moved = collapse(&mut made, SIZES.short(), 1e-9);
    assert_eq!(made.sheets[0].traces.len(), 3);
    assert!(has_point(&made, 2, [5.0, 4.0, 5.0]));
    // With the end of the trace go the corners above and below it.
    assert_eq!(moved.len(), 3);
    for one in &moved {
        assert!((one.by - 0.5 * SIZES.short()).abs() < 1e-12);
        assert!(one.sheet == 2 && one.onto.contains(&1));
    }
    assert!((made.sheets[2].area(&made.points) - 5.0).abs() < 1e-12);
    check_faces(&made);
}
