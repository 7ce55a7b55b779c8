//! Some of the cells of a grid, such as the piece that one rank writes.

use kluft_io::{Field, Grid, Values};
use kluft_mesh::Shape;
use kluft_solver::System;

/// Number of a point that no chosen cell has.
const LEFT_OUT: u32 = u32::MAX;

/// Which cells and facets are those of one rank: the ones whose first point it owns.
pub struct Piece {
    /// Cells of the rock, ascending.
    pub cells: Vec<u32>,
    /// Facets of the fractures, ascending.
    pub facets: Vec<u32>,
}

impl Piece {
    /// The piece of a rank, with the `owner` of each point of a system.
    pub fn of(system: &System<'_>, owner: &[u32], rank: usize) -> Self {
        let mesh = &system.problem().mesh;
        let points = system.discretisation().points();
        let is_own = |point: u32| owner[point as usize] as usize == rank;
        let cells = mesh.cells.offsets.windows(2);
        let cells = cells.map(|pair| is_own(points.of_cell_node[pair[0] as usize]));
        let facets = mesh.facets.elements.offsets.windows(2);
        let facets = facets.map(|pair| {
            let node = mesh.facets.elements.nodes[pair[0] as usize];
            is_own(points.of_node(node as usize).start as u32)
        });
        Self {
            cells: numbers(cells),
            facets: numbers(facets),
        }
    }
}

/// Some cells of a grid, with their points and values.
pub fn some_of(grid: &Grid, cells: &[u32]) -> Grid {
    let all = GridCells {
        shapes: &grid.shapes,
        offsets: &grid.offsets,
        nodes: &grid.nodes,
    };
    let chosen = CellSelection::of(all, grid.points.len(), Some(cells));
    Grid {
        points: chosen.of_points(&grid.points).collect(),
        point_fields: fields_at(&grid.point_fields, chosen.points.as_deref()),
        cell_fields: fields_at(&grid.cell_fields, chosen.cells),
        ..chosen.grid()
    }
}

/// The numbers of what is wanted.
fn numbers(wanted: impl Iterator<Item = bool>) -> Vec<u32> {
    let numbered = wanted.zip(0..).filter(|(wanted, _)| *wanted);
    numbered.map(|(_, number)| number).collect()
}

/// Cells and their points, as a grid has them.
#[derive(Clone, Copy)]
pub struct GridCells<'a> {
    /// The shape of every cell.
    pub shapes: &'a [Shape],
    /// Where the points of every cell start in `nodes`, and after the last cell the end.
    pub offsets: &'a [u32],
    /// Points of all cells, one cell after the other.
    pub nodes: &'a [u32],
}

/// Some cells, or all, with the points that they have.
pub struct CellSelection<'a> {
    of: GridCells<'a>,
    cells: Option<&'a [u32]>,
    /// Points of the cells, in the order in which these name them first; all if none are named.
    points: Option<Vec<u32>>,
    nodes: Vec<u32>,
}

impl<'a> CellSelection<'a> {
    /// Some of the cells on so many points, all of them if none are named.
    pub fn of(of: GridCells<'a>, point_count: usize, cells: Option<&'a [u32]>) -> Self {
        let Some(chosen) = cells else {
            return Self {
                nodes: of.nodes.to_vec(),
                points: None,
                of,
                cells,
            };
        };
        let mut number = vec![LEFT_OUT; point_count];
        let (mut points, mut nodes) = (Vec::new(), Vec::new());
        for &cell in chosen {
            for &point in of.nodes_of(cell) {
                let number = &mut number[point as usize];
                if *number == LEFT_OUT {
                    *number = points.len() as u32;
                    points.push(point);
                }
                nodes.push(*number);
            }
        }
        Self {
            of,
            cells,
            points: Some(points),
            nodes,
        }
    }

    /// Its records among those of all points.
    pub fn of_points<T: Copy>(&self, all: &[T]) -> impl Iterator<Item = T> {
        picked(all, self.points.as_deref())
    }

    /// Its records among those of all cells.
    pub fn of_cells<T: Copy>(&self, all: &[T]) -> impl Iterator<Item = T> {
        picked(all, self.cells)
    }

    /// How many cells it has.
    pub fn cell_count(&self) -> usize {
        self.cells.map_or(self.of.shapes.len(), <[u32]>::len)
    }

    /// The number of one of its cells among all.
    pub fn cell(&self, i: usize) -> usize {
        self.cells.map_or(i, |cells| cells[i] as usize)
    }

    /// Its cells as a grid without coordinates and fields.
    pub fn grid(self) -> Grid {
        let shapes: Vec<Shape> = self.of_cells(self.of.shapes).collect();
        let ends = shapes.iter().scan(0, |end, shape| {
            *end += shape.node_count() as u32;
            Some(*end)
        });
        let offsets = std::iter::once(0).chain(ends).collect();
        Grid {
            shapes,
            offsets,
            nodes: self.nodes,
            ..Grid::default()
        }
    }
}

impl GridCells<'_> {
    fn nodes_of(&self, cell: u32) -> &[u32] {
        let cell = cell as usize;
        &self.nodes[self.offsets[cell] as usize..self.offsets[cell + 1] as usize]
    }
}

/// Fields at some of their points or cells, at all if none are named.
pub fn fields_at(all: &[Field], items: Option<&[u32]>) -> Vec<Field> {
    all.iter().map(|field| field_at(field, items)).collect()
}

fn field_at(field: &Field, items: Option<&[u32]>) -> Field {
    fn rows<T: Copy>(all: &[T], width: usize, items: Option<&[u32]>) -> Vec<T> {
        let places = places(all.len() / width, items);
        let rows = places.flat_map(|place| &all[width * place..width * (place + 1)]);
        rows.copied().collect()
    }
    let width = field.components as usize;
    Field {
        values: match &field.values {
            Values::Real(values) => Values::Real(rows(values, width, items)),
            Values::Integer(values) => Values::Integer(rows(values, width, items)),
        },
        ..*field
    }
}

/// Some records, all if none are named.
fn picked<T: Copy>(all: &[T], items: Option<&[u32]>) -> impl Iterator<Item = T> {
    places(all.len(), items).map(|place| all[place])
}

/// Where some of so many records stand, all if none are named.
fn places(count: usize, items: Option<&[u32]>) -> impl Iterator<Item = usize> {
    let count = items.map_or(count, <[u32]>::len);
    (0..count).map(move |i| items.map_or(i, |items| items[i] as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kluft_mesh::Shape;

    #[test]
    fn pieces_hold_every_cell_once_with_its_values() {
        let grid = Grid {
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
        let piece = some_of(&grid, &[1, 2]);
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
        assert!(some_of(&grid, &[]).shapes.is_empty());
    }
}
