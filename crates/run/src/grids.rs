//! The results of a load step as grids.

use glam::DVec3;
use kluft_io::{Field, Grid, Values};
use kluft_mesh::{Flat, Mesh};
use kluft_solver::{FacetResult, Solution, System, principal};
use rayon::prelude::*;

use crate::accuracy::Accuracy;
use crate::pieces::{CellSelection, GridCells, fields_at};

/// The rock, with one copy of a node for each of its sectors: of some of its cells, of all if none
/// are named.
pub fn rock_grid(
    system: &System<'_>,
    solution: &Solution,
    accuracy: Option<&Accuracy>,
    cells: Option<&[u32]>,
) -> Grid {
    let mesh = &system.problem().mesh;
    let points = &system.discretisation().points();
    let all = GridCells {
        shapes: &mesh.cells.shapes,
        offsets: &mesh.cells.offsets,
        nodes: &points.of_cell_node,
    };
    let chosen = CellSelection::of(all, points.node.len(), cells);
    let nodes: Vec<u32> = chosen.of_points(&points.node).collect();
    let rocks = chosen.of_cells(system.problem().material_of_cell());
    let displacements = chosen.of_points(&solution.displacements);
    let errors = accuracy.map(|accuracy| {
        let errors = chosen.of_cells(&accuracy.stress_errors);
        real_field("stress_error", errors.map(|error| [error]))
    });
    let stresses = || real_field("stress", chosen.of_cells(&solution.stresses));
    let principals = || {
        let cells = (0..chosen.cell_count()).into_par_iter();
        let principals = cells.map(|i| principal(&solution.stresses[chosen.cell(i)]));
        let principals: Vec<[f64; 3]> = principals.collect();
        real_field("principal_stress", principals.into_iter())
    };
    let (stresses, principals) = rayon::join(stresses, principals);
    let mut grid = Grid {
        points: nodes
            .iter()
            .map(|&node| mesh.nodes[node as usize].to_array())
            .collect(),
        point_fields: [real_field(
            "displacement",
            displacements.map(|u| u.to_array()),
        )]
        .into_iter()
        .chain(tags(mesh, &nodes))
        .collect(),
        cell_fields: vec![
            stresses,
            principals,
            integer_field("rock", rocks.map(|rock| rock as i32)),
        ],
        ..chosen.grid()
    };
    grid.cell_fields.extend(errors);
    grid
}

/// The numbers that nodes have in the mesh file, if it gives any that fit.
fn tags(mesh: &Mesh, nodes: &[u32]) -> Option<Field> {
    let largest = mesh.node_tags.iter().copied().max()?;
    let fits = mesh.node_tags.len() == mesh.nodes.len() && i32::try_from(largest).is_ok();
    let tags = nodes
        .iter()
        .map(|&node| mesh.node_tags[node as usize] as i32);
    fits.then(|| integer_field("node", tags))
}

/// Shear traction over compression; 0 where nothing presses the walls together.
fn tendency(result: &FacetResult) -> f64 {
    let normal = result.normal_traction;
    let shear = result.traction.length_squared() - normal * normal;
    match normal < 0.0 {
        true => shear.max(0.0).sqrt() / -normal,
        false => 0.0,
    }
}

/// The fractures; every facet has its own points, so that fields may jump between facets. `results`
/// are those of the nodes of the facets.
pub fn fracture_grid(
    system: &System<'_>,
    results: &[FacetResult],
    accuracy: Option<&Accuracy>,
) -> Grid {
    let mesh = &system.problem().mesh;
    let vectors =
        |of: fn(&FacetResult) -> DVec3| results.iter().map(move |result| of(result).to_array());
    let mut grid = facet_grid(
        mesh,
        vec![
            real_field("aperture", results.iter().map(|result| [result.aperture])),
            real_field("opening", results.iter().map(|result| [result.opening])),
            real_field("slip", vectors(|result| result.slip)),
            real_field("jump", vectors(|result| result.jump)),
            real_field("traction", vectors(|result| result.traction)),
            real_field(
                "normal_traction",
                results.iter().map(|result| [result.normal_traction]),
            ),
            real_field(
                "slip_tendency",
                results.iter().map(|result| [tendency(result)]),
            ),
            integer_field("state", results.iter().map(|result| result.state as i32)),
        ],
    );
    if let Some(jumps) = accuracy.and_then(|accuracy| accuracy.jumps.as_ref()) {
        let of_facets = mesh.facets.fracture.iter();
        let of_facets = of_facets.map(|&fracture| [jumps.aperture[fracture as usize]]);
        let field = real_field("aperture_uncertainty", of_facets);
        grid.cell_fields.push(field);
    }
    grid
}

/// The facets with their normals and fractures, each with points of its own, and fields there.
pub fn facet_grid(mesh: &Mesh, point_fields: Vec<Field>) -> Grid {
    let elements = &mesh.facets.elements;
    let normals = mesh
        .facet_areas()
        .into_iter()
        .map(|area| area.normalize().to_array());
    Grid {
        points: elements
            .nodes
            .iter()
            .map(|&node| mesh.nodes[node as usize].to_array())
            .collect(),
        shapes: elements.shapes.clone(),
        offsets: elements.offsets.clone(),
        nodes: (0..elements.nodes.len() as u32).collect(),
        point_fields,
        cell_fields: vec![
            real_field("normal", normals),
            integer_field(
                "fracture",
                mesh.facets.fracture.iter().map(|&fracture| fracture as i32),
            ),
        ],
    }
}

/// What of a grid on the cells or facets of a mesh lies in its plane, if it is one of the plane.
pub fn in_plane(mesh: &Mesh, grid: Grid) -> Grid {
    if !mesh.is_plane() {
        return grid;
    }
    let bottom = mesh.bounds().0.z;
    let is_kept = |point: u32| grid.points[point as usize][2] == bottom;
    let mut flat = Grid {
        offsets: vec![0],
        ..Grid::default()
    };
    for (cell, shape) in grid.shapes.iter().enumerate() {
        let own = &grid.nodes[grid.offsets[cell] as usize..grid.offsets[cell + 1] as usize];
        let Some(Flat { shape, node, .. }) = shape.flat() else {
            continue;
        };
        let at = |wanted: u8| {
            let mut pairs = own.iter().zip(&node);
            let found = pairs.find(|(point, flat)| **flat == wanted && is_kept(**point));
            found.map(|(point, _)| *point)
        };
        // Facets turn to their plus side, which leaves corners before middles, but not the axes.
        let is_facet = shape.dimension() == 1;
        let here = own
            .iter()
            .copied()
            .filter(|&point| is_facet && is_kept(point));
        let cells = (0..shape.node_count() as u8).filter(|_| !is_facet);
        flat.nodes.extend(here.chain(cells.filter_map(at)));
        flat.shapes.push(shape);
        flat.offsets.push(flat.nodes.len() as u32);
    }
    let mut kept = flat.nodes.clone();
    kept.sort_unstable();
    kept.dedup();
    let number = |point: &u32| kept.partition_point(|other| other < point) as u32;
    flat.nodes = flat.nodes.iter().map(number).collect();
    flat.points = kept.iter().map(|&p| grid.points[p as usize]).collect();
    flat.point_fields = fields_at(&grid.point_fields, Some(&kept));
    flat.cell_fields = grid.cell_fields;
    flat
}

/// A field of `N` numbers a point or cell.
pub fn real_field<const N: usize>(
    name: &'static str,
    values: impl Iterator<Item = [f64; N]>,
) -> Field {
    let values: Vec<[f64; N]> = values.collect();
    Field {
        name,
        components: N as u32,
        values: Values::Real(values.into_flattened()),
    }
}

/// A field of one whole number a point or cell.
pub fn integer_field(name: &'static str, values: impl Iterator<Item = i32>) -> Field {
    Field {
        name,
        components: 1,
        values: Values::Integer(values.collect()),
    }
}
