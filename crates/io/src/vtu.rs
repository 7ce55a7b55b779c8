//! Unstructured grids as binary XML files of VTK, compressed with LZ4.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use lie_mesh::{Defect, Shape};
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer,
    Piece, UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::{Compressor, VTKFile};

use crate::atomic::write_atomically;

/// vtkio leaves out a count of zero, and VTK refuses a piece without its counts.
const EMPTY_GRID: &str = r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <UnstructuredGrid>
    <Piece NumberOfPoints="0" NumberOfCells="0">
      <Points>
        <DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii"/>
      </Points>
      <Cells>
        <DataArray type="Int64" Name="connectivity" format="ascii"/>
        <DataArray type="Int64" Name="offsets" format="ascii"/>
        <DataArray type="UInt8" Name="types" format="ascii"/>
      </Cells>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
"#;

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
/// # Panics
/// When the lengths of the parts of `grid` do not fit together: an error of the caller.
pub fn write_vtu(path: &Path, grid: &Grid) -> Result<(), Defect> {
    check_lengths(grid);
    if grid.shapes.is_empty() {
        return write_atomically(path, |out| out.write_all(EMPTY_GRID.as_bytes()));
    }
    let file = vtk_file(grid).map_err(|error| {
        Defect::new(
            path.display().to_string(),
            format!("cannot be encoded: {error}"),
            "report this as an error of the program, with the scene",
        )
    })?;
    write_atomically(path, |out| write_xml(out, &file))
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

fn vtk_file(grid: &Grid) -> Result<VTKFile, vtkio::xml::Error> {
    let vtk = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::UnstructuredGrid {
            meta: None,
            pieces: vec![Piece::Inline(Box::new(piece(grid)))],
        },
        file_path: None,
    };
    // LZ4 has no levels; 0 would switch compression off.
    vtk.try_into_xml_format(Compressor::LZ4, 1)
}

fn piece(grid: &Grid) -> UnstructuredGridPiece {
    let mut connectivity = Vec::with_capacity(grid.nodes.len());
    let mut offsets = Vec::with_capacity(grid.shapes.len());
    for (cell, &shape) in grid.shapes.iter().enumerate() {
        let nodes = &grid.nodes[grid.offsets[cell] as usize..grid.offsets[cell + 1] as usize];
        match cell_of(shape).1 {
            [] => connectivity.extend(nodes.iter().map(|&node| u64::from(node))),
            order => {
                connectivity.extend(order.iter().map(|&local| u64::from(nodes[local as usize])));
            }
        }
        offsets.push(connectivity.len() as u64);
    }
    UnstructuredGridPiece {
        points: IOBuffer::F64(grid.points.as_flattened().to_vec()),
        cells: Cells {
            cell_verts: VertexNumbers::XML {
                connectivity,
                offsets,
            },
            types: grid.shapes.iter().map(|&shape| cell_of(shape).0).collect(),
        },
        data: Attributes {
            point: attributes(&grid.point_fields),
            cell: attributes(&grid.cell_fields),
        },
    }
}

/// The VTK cell of a shape and which of our nodes stands at each of its places; none where the
/// order is the same. VTK has no 14-node pyramid: its 13-node pyramid leaves the middle of the base
/// out.
fn cell_of(shape: Shape) -> (CellType, &'static [u8]) {
    match shape {
        Shape::Tri3 => (CellType::Triangle, &[]),
        Shape::Tri6 => (CellType::QuadraticTriangle, &[]),
        Shape::Quad4 => (CellType::Quad, &[]),
        Shape::Quad8 => (CellType::QuadraticQuad, &[]),
        Shape::Quad9 => (CellType::BiquadraticQuad, &[]),
        Shape::Tet4 => (CellType::Tetra, &[]),
        Shape::Tet10 => (CellType::QuadraticTetra, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        Shape::Hex8 => (CellType::Hexahedron, &[]),
        Shape::Hex20 => (CellType::QuadraticHexahedron, &HEX27[..20]),
        Shape::Hex27 => (CellType::TriquadraticHexahedron, &HEX27),
        Shape::Prism6 => (CellType::Wedge, &[]),
        Shape::Prism15 => (CellType::QuadraticWedge, &PRISM18[..15]),
        Shape::Prism18 => (CellType::BiquadraticQuadraticWedge, &PRISM18),
        Shape::Pyramid5 => (CellType::Pyramid, &[]),
        Shape::Pyramid13 | Shape::Pyramid14 => (CellType::QuadraticPyramid, &PYRAMID13),
    }
}

const HEX27: [u8; 27] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25,
    26,
];
const PRISM18: [u8; 18] = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16];
const PYRAMID13: [u8; 13] = [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12];

fn attributes(fields: &[Field]) -> Vec<Attribute> {
    fields.iter().map(attribute).collect()
}

fn attribute(field: &Field) -> Attribute {
    Attribute::DataArray(DataArray {
        name: field.name.to_owned(),
        elem: ElementType::Generic(field.components),
        data: match &field.values {
            Values::Real(values) => IOBuffer::F64(values.clone()),
            Values::Integer(values) => IOBuffer::I32(values.clone()),
        },
    })
}

fn write_xml(out: &mut BufWriter<File>, file: &VTKFile) -> io::Result<()> {
    let mut checked = CheckedWriter { out, failure: None };
    let written = file.write(&mut checked);
    match checked.failure {
        Some(failure) => Err(failure),
        None => written.map_err(io::Error::other),
    }
}

/// Writes every buffer whole and remembers the first failure.
///
/// vtkio takes a partial write for a whole one (one call moves at most 2 GiB on Linux), and drops
/// the buffer it writes through without looking at the outcome of the last flush.
struct CheckedWriter<'a> {
    out: &'a mut BufWriter<File>,
    failure: Option<io::Error>,
}

impl Write for CheckedWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Err(failure) = self.out.write_all(bytes) {
            let kind = failure.kind();
            self.failure.get_or_insert(failure);
            return Err(kind.into());
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic::scratch_folder;
    use std::fs;

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
        write_vtu(&path, grid).expect("written");
        let read = Vtk::import(&path).expect("readable");
        fs::remove_dir_all(folder).expect("removed");
        let DataSet::UnstructuredGrid { pieces, .. } = read.data else {
            panic!("not an unstructured grid");
        };
        let piece = pieces.into_iter().next().expect("a piece");
        piece.into_loaded_piece_data(None).expect("loaded")
    }

    fn bits(buffer: &IOBuffer) -> Vec<u64> {
        let values: Vec<f64> = buffer.clone().into_vec().expect("real numbers");
        values.into_iter().map(f64::to_bits).collect()
    }

    #[test]
    fn every_bit_comes_back() {
        // More than one block of compression, and not a whole number of them.
        let grid = triangles(2001);
        let read = written_and_read(&grid, "bits");
        let points = IOBuffer::F64(grid.points.as_flattened().to_vec());
        assert_eq!(bits(&read.points), bits(&points));
        assert_eq!(read.cells, piece(&grid).cells);
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
            assert_eq!(bits(&array.data), bits(&attribute_buffer(field)));
        }
        assert_eq!(fracture.data, attribute_buffer(&grid.cell_fields[1]));
    }

    fn attribute_buffer(field: &Field) -> IOBuffer {
        match attribute(field) {
            Attribute::DataArray(array) => array.data,
            Attribute::Field { .. } => panic!("not an array"),
        }
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
        assert_eq!(read.cells, piece(&grid).cells);
    }

    #[test]
    fn a_grid_without_cells_names_its_counts() {
        let folder = scratch_folder("empty");
        let path = folder.join("grid.vtu");
        write_vtu(&path, &triangles(0)).expect("written");
        let text = fs::read_to_string(&path).expect("a text");
        assert!(text.contains(r#"NumberOfPoints="0" NumberOfCells="0""#));
        fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    #[should_panic(expected = "values of field aperture")]
    fn a_field_of_another_length_is_an_error_of_the_caller() {
        let mut grid = triangles(2);
        grid.point_fields[0].components = 2;
        let _ = write_vtu(Path::new("never-written.vtu"), &grid);
    }
}
