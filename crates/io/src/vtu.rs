//! Unstructured grids as binary XML files of VTK, compressed with zlib.

use std::io::{self, Write};
use std::path::Path;

use kluft_mesh::{Defect, Shape};
use rayon::prelude::*;

use crate::about::About;
use crate::atomic::write_atomically;
use crate::fingerprint::{Fingerprint, SumWriter};
use crate::vtu_array::{COMPRESSOR, EncodedArray};

/// Cells or facets with values on their points and on themselves.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    /// Coordinates.
    pub points: Vec<[f64; 3]>,
    /// The shape of every cell.
    pub shapes: Vec<Shape>,
    /// Where the points of every cell start in `nodes`, and after the last cell the end.
    pub offsets: Vec<u32>,
    /// Points of all cells, one cell after the other.
    pub nodes: Vec<u32>,
    /// Values on every point.
    pub point_fields: Vec<Field>,
    /// Values on every cell.
    pub cell_fields: Vec<Field>,
}

/// One block of values for every point or every cell.
#[derive(Debug, Clone)]
pub struct Field {
    /// The name ParaView shows.
    pub name: &'static str,
    /// Values per point or cell.
    pub components: u32,
    /// All components of the first point or cell, then those of the second.
    pub values: Values,
}

/// Values of one type; they are written bit for bit.
#[derive(Debug, Clone)]
pub enum Values {
    /// Floating-point numbers.
    Real(Vec<f64>),
    /// Whole numbers.
    Integer(Vec<i32>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Values::Real(values) => values.len(),
            Values::Integer(values) => values.len(),
        }
    }
}

/// Writes `grid` as a `.vtu`, to a temporary name beside `path`, then renames.
///
/// Without cells the file holds no points and no fields either.
///
/// # Errors
/// If the file cannot be written.
///
/// # Panics
/// When the lengths of the parts of `grid` do not fit together: an error of the caller.
pub fn write_vtu(path: &Path, grid: Grid) -> Result<(), Defect> {
    let encoded = EncodedGrid::of(grid, path)?;
    encoded.write(path, &About::default()).map(drop)
}

fn check_lengths(grid: &Grid) {
    let cells = grid.shapes.len();
    assert_eq!(
        grid.offsets.len(),
        cells + 1,
        "one offset a cell and one end"
    );
    assert_eq!(grid.offsets[0], 0, "the first cell starts at 0");
    assert_eq!(
        grid.offsets[cells] as usize,
        grid.nodes.len(),
        "the last cell ends at the end"
    );
    for (cell, shape) in grid.shapes.iter().enumerate() {
        let nodes = grid.offsets[cell + 1].checked_sub(grid.offsets[cell]);
        assert_eq!(
            nodes,
            Some(shape.node_count() as u32),
            "nodes of cell {cell}"
        );
    }
    let highest = grid.nodes.iter().max();
    assert!(
        highest.is_none_or(|&node| (node as usize) < grid.points.len()),
        "a missing point"
    );
    check_fields(&grid.point_fields, grid.points.len());
    check_fields(&grid.cell_fields, cells);
}

fn check_fields(fields: &[Field], count: usize) {
    for field in fields {
        assert_ne!(field.components, 0, "components of field {}", field.name);
        let expected = field.components as usize * count;
        assert_eq!(
            field.values.len(),
            expected,
            "values of field {}",
            field.name
        );
    }
}

/// A grid with its arrays encoded, ready to be written.
pub struct EncodedGrid {
    points: usize,
    cells: usize,
    point_data: Vec<EncodedArray>,
    cell_data: Vec<EncodedArray>,
    coordinates: EncodedArray,
    topology: [EncodedArray; 3],
}

impl EncodedGrid {
    /// Encodes a grid for the file `path`, on all threads. One without cells has no points and no
    /// fields either.
    ///
    /// # Errors
    /// If the compressor refuses.
    ///
    /// # Panics
    /// As [`write_vtu`].
    pub fn of(grid: Grid, path: &Path) -> Result<Self, Defect> {
        check_lengths(&grid);
        let grid = match grid.shapes.is_empty() {
            true => Grid {
                offsets: vec![0],
                ..Grid::default()
            },
            false => grid,
        };
        Self::encode(&grid).map_err(|error| {
            Defect::new(
                path.display().to_string(),
                format!("cannot be encoded: {error}"),
                "report this as an error of the program, with the scene",
            )
        })
    }

    /// Writes it as a `.vtu` with what it says of itself, to a temporary name beside `path`, then
    /// renames. The sum of the file's bytes.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path, about: &About) -> Result<Fingerprint, Defect> {
        let mut sum = 0;
        write_atomically(path, |out| {
            let mut summed = SumWriter::new(out);
            self.write_into(&mut summed, about)?;
            sum = summed.finish();
            Ok(())
        })?;
        Ok(sum)
    }

    fn encode(grid: &Grid) -> io::Result<Self> {
        Ok(Self {
            points: grid.points.len(),
            cells: grid.shapes.len(),
            point_data: fields(&grid.point_fields)?,
            cell_data: fields(&grid.cell_fields)?,
            coordinates: EncodedArray::of("Points", 3, grid.points.as_flattened())?,
            topology: topology(&grid.shapes, &grid.offsets, &grid.nodes)?,
        })
    }

    fn write_into(&self, out: &mut impl Write, about: &About) -> io::Result<()> {
        write!(
            out,
            r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="{COMPRESSOR}"><UnstructuredGrid>"#
        )?;
        about.write(out)?;
        write!(
            out,
            r#"<Piece NumberOfPoints="{}" NumberOfCells="{}">"#,
            self.points, self.cells
        )?;
        write_arrays(out, "PointData", &self.point_data)?;
        write_arrays(out, "CellData", &self.cell_data)?;
        write_arrays(out, "Points", [&self.coordinates])?;
        write_arrays(out, "Cells", &self.topology)?;
        write!(out, "</Piece></UnstructuredGrid></VTKFile>")
    }
}

fn fields(fields: &[Field]) -> io::Result<Vec<EncodedArray>> {
    let encoded = |field: &Field| match &field.values {
        Values::Real(values) => EncodedArray::of(field.name, field.components, values),
        Values::Integer(values) => EncodedArray::of(field.name, field.components, values),
    };
    fields.par_iter().map(encoded).collect()
}

/// Points of all cells, ends of the cells and their types.
fn topology(shapes: &[Shape], offsets: &[u32], nodes: &[u32]) -> io::Result<[EncodedArray; 3]> {
    let (connectivity, ends) = vtk_connectivity(shapes, offsets, nodes);
    let types: Vec<u8> = shapes.iter().map(|&shape| vtk_cell(shape).0).collect();
    Ok([
        EncodedArray::of("connectivity", 1, &connectivity)?,
        EncodedArray::of("offsets", 1, &ends)?,
        EncodedArray::of("types", 1, &types)?,
    ])
}

/// Points of all cells in the order of VTK, and where each cell ends.
pub fn vtk_connectivity(shapes: &[Shape], offsets: &[u32], nodes: &[u32]) -> (Vec<u64>, Vec<u64>) {
    let mut connectivity = Vec::with_capacity(nodes.len());
    let mut ends = Vec::with_capacity(shapes.len());
    for (cell, &shape) in shapes.iter().enumerate() {
        let nodes = &nodes[offsets[cell] as usize..offsets[cell + 1] as usize];
        match vtk_cell(shape).1 {
            [] => connectivity.extend(nodes.iter().map(|&node| u64::from(node))),
            order => {
                connectivity.extend(order.iter().map(|&local| u64::from(nodes[local as usize])));
            }
        }
        ends.push(connectivity.len() as u64);
    }
    (connectivity, ends)
}

fn write_arrays<'a>(
    out: &mut impl Write,
    element: &str,
    arrays: impl IntoIterator<Item = &'a EncodedArray>,
) -> io::Result<()> {
    let mut arrays = arrays.into_iter().peekable();
    if arrays.peek().is_none() {
        return Ok(());
    }
    write!(out, "<{element}>")?;
    arrays.try_for_each(|array| array.write(out))?;
    write!(out, "</{element}>")
}

/// The shape of a VTK cell (`vtkCellType.h`) that can be solved on.
pub fn shape_of_vtk_cell(number: u8) -> Option<Shape> {
    let lines = [Shape::Line2, Shape::Line3];
    let mut shapes = Shape::CELLS.into_iter().chain(Shape::FACETS).chain(lines);
    shapes.find(|&shape| vtk_cell(shape).0 == number)
}

/// The number of the VTK cell of a shape (`vtkCellType.h`) and which of our nodes stands at each of
/// its places; none where the order is the same. VTK has no 14-node pyramid: its 13-node pyramid
/// leaves the middle of the base out.
pub fn vtk_cell(shape: Shape) -> (u8, &'static [u8]) {
    match shape {
        Shape::Line2 => (3, &[]),
        Shape::Line3 => (21, &[]),
        Shape::Tri3 => (5, &[]),
        Shape::Tri6 => (22, &[]),
        Shape::Quad4 => (9, &[]),
        Shape::Quad8 => (23, &[]),
        Shape::Quad9 => (28, &[]),
        Shape::Tet4 => (10, &[]),
        Shape::Tet10 => (24, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        Shape::Hex8 => (12, &[]),
        Shape::Hex20 => (25, &HEX27[..20]),
        Shape::Hex27 => (29, &HEX27),
        Shape::Prism6 => (13, &[]),
        Shape::Prism15 => (26, &PRISM18[..15]),
        Shape::Prism18 => (32, &PRISM18),
        Shape::Pyramid5 => (14, &[]),
        Shape::Pyramid13 | Shape::Pyramid14 => (27, &PYRAMID13),
    }
}

const HEX27: [u8; 27] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25,
    26,
];
const PRISM18: [u8; 18] = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16];
const PYRAMID13: [u8; 13] = [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic::scratch_folder;
    use std::fs;
    use vtkio::model::{
        Attribute, CellType, DataSet, IOBuffer, UnstructuredGridPiece, VertexNumbers, Vtk,
    };

    /// Bit patterns that a detour through text or `f32` would lose.
    const AWKWARD: [f64; 4] = [0.1, f64::MIN_POSITIVE / 8.0, -0.0, 1.0 + f64::EPSILON];

    fn triangles(count: usize) -> Grid {
        let points = 3 * count;
        Grid {
            points: (0..points)
                .map(|i| [i as f64, 0.1 * i as f64, -0.0])
                .collect(),
            shapes: vec![Shape::Tri3; count],
            offsets: (0..=count as u32).map(|cell| 3 * cell).collect(),
            nodes: (0..points as u32).rev().collect(),
            point_fields: vec![real_field("aperture", 1, points)],
            cell_fields: vec![
                real_field("normal", 3, count),
                Field {
                    name: "fracture",
                    components: 1,
                    values: Values::Integer((0..count as i32).map(|i| i - 7).collect()),
                },
            ],
        }
    }

    fn real_field(name: &'static str, components: u32, count: usize) -> Field {
        let values = (0..count * components as usize)
            .map(|i| AWKWARD[i % 4])
            .collect();
        Field {
            name,
            components,
            values: Values::Real(values),
        }
    }

    fn written_and_read(grid: &Grid, test: &str) -> UnstructuredGridPiece {
        let folder = scratch_folder(test);
        let path = folder.join("grid.vtu");
        write_vtu(&path, grid.clone()).expect("written");
        let read = Vtk::import(&path).expect("readable");
        fs::remove_dir_all(folder).expect("removed");
        let DataSet::UnstructuredGrid { pieces, .. } = read.data else {
            panic!("not an unstructured grid");
        };
        let piece = pieces.into_iter().next().expect("a piece");
        piece.into_loaded_piece_data(None).expect("loaded")
    }

    fn assert_cells(read: &UnstructuredGridPiece, grid: &Grid) {
        let VertexNumbers::XML {
            connectivity,
            offsets,
        } = &read.cells.cell_verts
        else {
            panic!("not as XML files have them");
        };
        let nodes = connectivity.iter().map(|&node| node as u32);
        assert!(nodes.eq(grid.nodes.iter().copied()));
        let ends = offsets.iter().map(|&end| end as u32);
        assert!(ends.eq(grid.offsets[1..].iter().copied()));
    }

    fn buffer(values: &Values) -> IOBuffer {
        match values {
            Values::Real(values) => IOBuffer::F64(values.clone()),
            Values::Integer(values) => IOBuffer::I32(values.clone()),
        }
    }

    fn bits(buffer: &IOBuffer) -> Vec<u64> {
        let values: Vec<f64> = buffer.clone().into_vec().expect("real numbers");
        values.into_iter().map(f64::to_bits).collect()
    }

    #[test]
    fn every_bit_comes_back() {
        // More than one block of compression, and not a whole number of them.
        let grid = triangles(12_001);
        let read = written_and_read(&grid, "bits");
        let points = IOBuffer::F64(grid.points.as_flattened().to_vec());
        assert_eq!(bits(&read.points), bits(&points));
        assert_cells(&read, &grid);
        let [Attribute::DataArray(aperture)] = &read.data.point[..] else {
            panic!("one array on the points");
        };
        let [Attribute::DataArray(normal), Attribute::DataArray(fracture)] = &read.data.cell[..]
        else {
            panic!("two arrays on the cells");
        };
        assert_eq!((&*aperture.name, aperture.num_comp()), ("aperture", 1));
        assert_eq!((&*normal.name, normal.num_comp()), ("normal", 3));
        for (array, field) in [
            (aperture, &grid.point_fields[0]),
            (normal, &grid.cell_fields[0]),
        ] {
            assert_eq!(bits(&array.data), bits(&buffer(&field.values)));
        }
        assert_eq!(fracture.data, buffer(&grid.cell_fields[1].values));
    }

    #[test]
    fn tetrahedra_keep_their_type_and_nodes() {
        let grid = Grid {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            shapes: vec![Shape::Tet4],
            offsets: vec![0, 4],
            nodes: vec![1, 2, 0, 3],
            ..Grid::default()
        };
        let read = written_and_read(&grid, "tetrahedra");
        assert_eq!(read.cells.types, [CellType::Tetra]);
        assert_cells(&read, &grid);
    }

    #[test]
    fn a_grid_without_cells_names_its_counts() {
        let folder = scratch_folder("empty");
        let path = folder.join("grid.vtu");
        write_vtu(&path, triangles(0)).expect("written");
        let text = fs::read_to_string(&path).expect("a text");
        assert!(text.contains(r#"NumberOfPoints="0" NumberOfCells="0""#));
        // The compressor that all readers of the format know.
        assert!(text.contains(r#"compressor="vtkZLibDataCompressor""#));
        fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    #[should_panic(expected = "values of field aperture")]
    fn a_field_of_another_length_is_an_error_of_the_caller() {
        let mut grid = triangles(2);
        grid.point_fields[0].components = 2;
        let _ = write_vtu(Path::new("never-written.vtu"), grid);
    }
}
