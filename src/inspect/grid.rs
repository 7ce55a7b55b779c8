//! `inspect.vtu`: the fractures and the worst cells, with what was found on them.

use kluft_io::{Field, Grid};
use kluft_mesh::{Mesh, Survey};

use kluft_run::{integer_field, real_field};

/// Facets of all fractures, each with points of its own, then the worst cells.
pub fn of(mesh: &Mesh, survey: &Survey) -> Grid {
    let mut cells = survey.quality.worst.clone();
    cells.extend(&survey.quality.worst_at_fractures);
    cells.sort_unstable();
    cells.dedup();
    let facets = &mesh.facets.elements;
    let mut grid = Grid {
        shapes: facets.shapes.clone(),
        offsets: facets.offsets.clone(),
        ..Grid::default()
    };
    let mut nodes = facets.nodes.clone();
    for &cell in &cells {
        nodes.extend(mesh.cells.nodes_of(cell as usize));
        grid.shapes.push(mesh.cells.shapes[cell as usize]);
        grid.offsets.push(nodes.len() as u32);
    }
    let positions = nodes.iter().map(|&node| mesh.nodes[node as usize]);
    grid.points = positions.map(|x| x.to_array()).collect();
    grid.nodes = (0..nodes.len() as u32).collect();
    let sectors = nodes
        .iter()
        .map(|&node| mesh.sectors.count[node as usize] as i32);
    grid.point_fields = vec![integer_field("sectors", sectors)];
    grid.cell_fields = fields(mesh, survey, &cells);
    grid
}

/// Values on facets, then on cells; what has no meaning on one of them is -1 or 0 there.
fn fields(mesh: &Mesh, survey: &Survey, cells: &[u32]) -> Vec<Field> {
    let facets = &mesh.facets;
    let none = || cells.iter().map(|_| -1);
    let numbers =
        |values: &[u32]| -> Vec<i32> { values.iter().map(|&value| value as i32).collect() };
    let block = |cell: u32| mesh.block[cell as usize] as i32;
    let blocks = |sides: &[u32]| {
        let own: Vec<i32> = sides.iter().map(|&cell| block(cell)).collect();
        own.into_iter().chain(cells.iter().map(|&cell| block(cell)))
    };
    let quality = |cell: u32| survey.quality.of_cell[cell as usize];
    let sides = facets.minus.iter().zip(&facets.plus);
    let beside = sides.map(|(&minus, &plus)| quality(minus).min(quality(plus)));
    let normals = mesh.facet_areas().into_iter().map(|area| area.normalize());
    let flat = cells.iter().map(|_| glam::DVec3::ZERO);
    let patches = survey.patch_of_facet.iter();
    let tips = survey.tip_edges_of_facet.iter();
    vec![
        integer_field(
            "fracture",
            numbers(&facets.fracture).into_iter().chain(none()),
        ),
        real_field("normal", normals.chain(flat).map(|n| n.to_array())),
        integer_field(
            "unresolved_patch",
            patches
                .map(|patch| patch.map_or(-1, |patch| patch as i32))
                .chain(none()),
        ),
        integer_field("tip_edges", tips.map(|&tips| i32::from(tips)).chain(none())),
        integer_field("block_minus", blocks(&facets.minus)),
        integer_field("block_plus", blocks(&facets.plus)),
        real_field(
            "quality",
            beside
                .chain(cells.iter().map(|&cell| quality(cell)))
                .map(|quality| [quality]),
        ),
    ]
}
