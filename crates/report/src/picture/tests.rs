//! Pictures of a wall in a cube.

use kluft_io::{Field, Grid, Values};
use kluft_mesh::Shape;

use super::*;

/// A square in the middle of a unit cube, across x, whose field grows with z, as so many
/// quadrangles along each side.
fn wall(count: usize) -> Surface {
    let step = 1.0 / count as f64;
    let mut points = Vec::new();
    for i in 0..count * count {
        let (y, z) = ((i % count) as f64 * step, (i / count) as f64 * step);
        let corners = [(0.0, 0.0), (step, 0.0), (step, step), (0.0, step)];
        points.extend(corners.map(|(dy, dz)| [0.5, y + dy, z + dz]));
    }
    let cells = count * count;
    Surface::of(
        &Grid {
            shapes: vec![Shape::Quad4; cells],
            offsets: (0..=cells as u32).map(|cell| 4 * cell).collect(),
            nodes: (0..4 * cells as u32).collect(),
            point_fields: vec![Field {
                name: "aperture",
                components: 1,
                values: Values::Real(points.iter().map(|point| 1e-3 * point[2]).collect()),
            }],
            cell_fields: Vec::new(),
            points,
        },
        &["aperture"],
    )
}

/// Colour and opacity of a pixel of the picture of the aperture.
fn pixel(frame: &Frame<'_>, [x, y]: [usize; 2]) -> [u8; 4] {
    let values = frame.surface.field("aperture").expect("a field");
    let scale = Scale::of(values).expect("numbers");
    let pixels = frame.pixels(|point| scale.share(values[point]));
    let at = 4 * (y * SIZE[0] + x);
    std::array::from_fn(|i| pixels[at + i])
}

#[test]
fn a_wall_is_seen_where_it_is_in_the_colours_of_its_field() {
    let surface = wall(3);
    let frame = Frame::of(&surface, [[0.0; 3], [1.0; 3]]);
    let middle = [SIZE[0] / 2, SIZE[1] / 2];
    let [r, g, b, opacity] = pixel(&frame, middle).map(f32::from);
    assert_eq!(opacity, 255.0);
    // The middle of the scale, shaded: the parts keep their ratios.
    let [r0, g0, b0] = colours::colour(0.5);
    assert!((r / g - r0 / g0).abs() < 0.05 && (b / g - b0 / g0).abs() < 0.05);
    assert_eq!(pixel(&frame, [2, 2])[3], 0, "nothing in the corner");
    assert_eq!(frame.caption(), "Box of the body: 1 × 1 × 1 m; z is up");
}

#[test]
fn a_picture_does_not_depend_on_the_number_of_facets() {
    let (coarse, fine) = (wall(1), wall(200));
    let length = |surface: &Surface| {
        let frame = Frame::of(surface, [[0.0; 3], [1.0; 3]]);
        frame
            .picture("aperture", "Aperture", "m")
            .expect("a field")
            .html()
            .len()
    };
    let (one, many) = (length(&coarse), length(&fine));
    assert!(one < 200_000 && many < one + one / 2, "{one} {many} bytes");
}

#[test]
fn a_small_fracture_fills_its_picture() {
    let surface = wall(2);
    let frame = Frame::of(&surface, [[-50.0; 3], [50.0; 3]]);
    assert_eq!(
        frame.caption(),
        "Box of the fractures: 0 × 1 × 1 m; z is up"
    );
    assert_eq!(pixel(&frame, [SIZE[0] / 2, SIZE[1] / 2])[3], 255);
}

#[test]
fn titles_are_text_and_fields_that_are_not_there_have_no_picture() {
    let surface = wall(1);
    let frame = Frame::of(&surface, [[0.0; 3], [1.0; 3]]);
    let html = frame
        .picture("aperture", "<b>", "m")
        .expect("a field")
        .html();
    assert!(!html.contains("<b>") && html.contains("&lt;b&gt;"));
    assert!(html.contains("<span>0 mm</span>") && html.contains("<span>1.00 mm</span>"));
    assert!(frame.picture("slip", "Slip", "m").is_none());
}

#[test]
fn nothing_has_a_picture_too() {
    let nothing = Surface::of(
        &Grid {
            offsets: vec![0],
            ..Grid::default()
        },
        &["aperture"],
    );
    assert!(nothing.is_empty());
    let frame = Frame::of(&nothing, [[0.0; 3], [1.0; 3]]);
    assert!(frame.picture("aperture", "Aperture", "m").is_none());
}

#[test]
fn a_line_of_the_plane_is_seen_from_above_in_the_colours_of_its_field() {
    let grid = Grid {
        points: vec![[0.0, 0.25, 0.0], [1.0, 0.25, 0.0], [0.5, 0.25, 0.0]],
        shapes: vec![Shape::Line3],
        offsets: vec![0, 3],
        nodes: vec![0, 1, 2],
        point_fields: vec![Field {
            name: "aperture",
            components: 1,
            values: Values::Real(vec![0.0, 1e-3, 0.5e-3]),
        }],
        cell_fields: Vec::new(),
    };
    let surface = Surface::of(&grid, &["aperture"]);
    assert!(!surface.is_empty());
    let frame = Frame::of(&surface, [[0.0; 3], [1.0, 0.5, 0.0]]);
    assert_eq!(frame.caption(), "Box of the body: 1 × 0.5 m; y is up");
    let [column, row] = SIZE.map(|size| size / 2);
    let seen = pixel(&frame, [column, row]);
    let middle = colours::colour(0.5).map(|part| part.round() as u8);
    assert!((0..3).all(|i| seen[i].abs_diff(middle[i]) <= 3), "{seen:?}");
    assert_eq!(seen[3], 255);
    // To the right the field is larger, which is lighter; beside the line there is nothing.
    let right = pixel(&frame, [column + 200, row]);
    assert!(right[1] > seen[1]);
    assert_eq!(pixel(&frame, [column, row + 6])[3], 0);
}
