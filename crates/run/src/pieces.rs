//! The part of a grid that one rank writes.

use kluft_io::{Field, Grid, Values};
use kluft_solver::System;

/// Number of a point that no cell of the piece has.
const LEFT_OUT: u32 = u32::MAX;

/// Which cells and facets are those of one rank: the ones whose first point it owns.
pub struct Piece {
    cells: Vec<bool>,
    facets: Vec<bool>,
}

impl Piece {
    /// The piece of a rank, with the `owner` of each point of a system.
    pub fn of(system: &System<'_>, owner: &[u32], rank: usize) -> Self {
        let mesh = &system.problem().mesh;
        let points = system.discretisation().points();
        let is_own = |point: u32| owner[point as usize] as usize == rank;
        let starts = mesh.cells.offsets.windows(2).map(|pair| pair[0] as usize);
        let cells = starts.map(|start| is_own(points.of_cell_node[start]));
        let facets = mesh.facets.elements.offsets.windows(2);
        let facets = facets.map(|pair| {
            let node = mesh.facets.elements.nodes[pair[0] as usize];
            is_own(points.of_node(node as usize).start as u32)
        });
        Self {
            cells: cells.collect(),
            facets: facets.collect(),
        }
    }

    /// Takes its cells out of a grid of the rock, whose fields are empty then.
    pub fn take_rock(&self, grid: &mut Grid) -> Grid {
        taken(grid, &self.cells)
    }

    /// Takes its facets out of a grid of the fractures, whose fields are empty then.
    pub fn take_fractures(&self, grid: &mut Grid) -> Grid {
        taken(grid, &self.facets)
    }
}

/// The cells that are wanted, with the points that they have; the fields of the grid are empty
/// then.
fn taken(grid: &mut Grid, is_wanted: &[bool]) -> Grid {
    let mut number = vec![LEFT_OUT; grid.points.len()];
    let mut points = Vec::new();
    let mut piece = Grid {
        offsets: vec![0],
        ..Grid::default()
    };
    let wanted = |list: &[bool]| -> Vec<usize> {
        let numbered = list.iter().enumerate();
        numbered
            .filter(|(_, wanted)| **wanted)
            .map(|(cell, _)| cell)
            .collect()
    };
    let cells = wanted(is_wanted);
    for &cell in &cells {
        let own = grid.offsets[cell] as usize..grid.offsets[cell + 1] as usize;
        for &point in &grid.nodes[own] {
            let number = &mut number[point as usize];
            if *number == LEFT_OUT {
                *number = points.len() as u32;
                points.push(point as usize);
            }
            piece.nodes.push(*number);
        }
        piece.shapes.push(grid.shapes[cell]);
        piece.offsets.push(piece.nodes.len() as u32);
    }
    piece.points = points.iter().map(|&point| grid.points[point]).collect();
    piece.point_fields = fields(&mut grid.point_fields, &points);
    piece.cell_fields = fields(&mut grid.cell_fields, &cells);
    piece
}

fn fields(all: &mut [Field], items: &[usize]) -> Vec<Field> {
    let of = |field: &mut Field| {
        let width = field.components as usize;
        let values = match &mut field.values {
            Values::Real(values) => Values::Real(picked(std::mem::take(values), width, items)),
            Values::Integer(values) => {
                Values::Integer(picked(std::mem::take(values), width, items))
            }
        };
        Field { values, ..*field }
    };
    all.iter_mut().map(of).collect()
}

/// Records of so many numbers, those of some items.
fn picked<T: Copy>(all: Vec<T>, width: usize, items: &[usize]) -> Vec<T> {
    let mut own = Vec::with_capacity(width * items.len());
    for &item in items {
        own.extend_from_slice(&all[width * item..width * (item + 1)]);
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;
    use kluft_mesh::Shape;

    #[test]
    fn pieces_hold_every_cell_once_with_its_values() {
        let mut grid = Grid {
            points: (0..6).map(|i| [f64::from(i), 0.0, 1.0]).collect(),
            shapes: vec![Shape::Tri3; 3],
            offsets: vec![0, 3, 6, 9],
            nodes: vec![0, 1, 2, 2, 1, 4, 3, 4, 5],
            point_fields: vec![crate::grids::real_field(
                "u",
                (0..6).map(|i| [f64::from(i), -f64::from(i)]),
            )],
            cell_fields: vec![crate::grids::integer_field("c", 0..3)],
        };
        let piece = taken(&mut grid, &[false, true, true]);
        assert_eq!(piece.offsets, [0, 3, 6]);
        let at = |node: usize| piece.points[piece.nodes[node] as usize][0];
        let places: Vec<f64> = (0..6).map(at).collect();
        assert_eq!(places, [2.0, 1.0, 4.0, 3.0, 4.0, 5.0]);
        let Values::Real(values) = &piece.point_fields[0].values else {
            panic!("real numbers");
        };
        for (point, values) in piece.points.iter().zip(values.chunks(2)) {
            assert_eq!(values, [point[0], -point[0]]);
        }
        let Values::Integer(cells) = &piece.cell_fields[0].values else {
            panic!("whole numbers");
        };
        assert_eq!(cells, &[1, 2]);
        assert!(taken(&mut grid, &[false; 3]).shapes.is_empty());
    }
}
