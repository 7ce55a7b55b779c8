//! Arrangements whose points and edges are known.

use glam::DVec3;

use super::arrange::Arrangement;
use crate::clip::Domain;
use crate::fracture::NetworkFracture;
use crate::network::{coplanar_neighbours, intersections};
use crate::samples::{DOMAIN, FLOOR, fracture, wall};

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
