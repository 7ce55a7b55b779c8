//! Values of an array of a grid of VTK (.vtu), with their places.

use std::path::Path;

use kluft_mesh::Defect;
use vtkio::model::{Attribute, DataArray, UnstructuredGridPiece, VertexNumbers};

use super::piece::{read_piece, unread};

/// Reads an array with one value for each point, or for each cell: places (m) with values. Those of
/// a cell stand at the mean of its nodes.
///
/// # Errors
/// If the file cannot be read, or has no such array of single numbers, in the points or else in the
/// cells.
pub fn read_values(path: &Path, array: &str) -> Result<Vec<([f64; 3], f64)>, Vec<Defect>> {
    let piece = read_piece(path)?;
    let damaged = || unread(path, "its arrays do not fit together".to_owned());
    let points: Vec<f64> = piece.points.cast_into().ok_or_else(damaged)?;
    let (points, rest) = points.as_chunks();
    let named = |all: &[Attribute]| named(all, array);
    let (places, values) = match (named(&piece.data.point), named(&piece.data.cell)) {
        (Some(values), _) => (points.to_vec(), values),
        (None, Some(values)) => (centres(&piece, points).ok_or_else(damaged)?, values),
        (None, None) => return Err(missing(path, &piece, array)),
    };
    let is_finite = |place: &[f64; 3]| place.iter().all(|x| x.is_finite());
    if !rest.is_empty() || places.len() != values.len() || !places.iter().all(is_finite) {
        return Err(damaged());
    }
    Ok(places.into_iter().zip(values).collect())
}

/// The values of an array with one number for each point or cell.
fn named(all: &[Attribute], name: &str) -> Option<Vec<f64>> {
    let mut arrays = all.iter().filter_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => Some(array),
        _ => None,
    });
    let array = arrays.find(|array| array.num_comp() == 1)?;
    array.data.cast_into()
}

/// Mean of the nodes of each cell; none if cells have no nodes, or nodes that are not there.
fn centres(piece: &UnstructuredGridPiece, points: &[[f64; 3]]) -> Option<Vec<[f64; 3]>> {
    let VertexNumbers::XML {
        connectivity,
        offsets,
    } = &piece.cells.cell_verts
    else {
        return None;
    };
    let mut start = 0;
    let mut all = Vec::with_capacity(offsets.len());
    for &end in offsets {
        let nodes = connectivity.get(start..end as usize)?;
        start = end as usize;
        let mut centre = [0.0; 3];
        for &node in nodes {
            let point = points.get(node as usize)?;
            for (sum, x) in centre.iter_mut().zip(point) {
                *sum += x / nodes.len() as f64;
            }
        }
        all.push((!nodes.is_empty()).then_some(centre)?);
    }
    Some(all)
}

/// Says which arrays there are.
fn missing(path: &Path, piece: &UnstructuredGridPiece, name: &str) -> Vec<Defect> {
    let all = || piece.data.point.iter().chain(&piece.data.cell);
    let arrays = || {
        all().filter_map(|attribute| match attribute {
            Attribute::DataArray(array) => Some(array),
            Attribute::Field { .. } => None,
        })
    };
    let is_single = |array: &&DataArray| array.num_comp() == 1;
    let names: Vec<&str> = arrays()
        .filter(is_single)
        .map(|array| array.name.as_str())
        .collect();
    let problem = match arrays().find(|array| array.name == name) {
        Some(array) => format!("the array `{name}` has {} components", array.num_comp()),
        None => format!("no array of points or cells is called `{name}`"),
    };
    let remedy = format!("name an array of single numbers: `{}`", names.join("`, `"));
    vec![Defect::new(path.display().to_string(), problem, remedy)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: &str = r#"<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1">
<PointData><DataArray type="Float64" Name="kn" format="ascii">1 2 3 4</DataArray>
<DataArray type="Float64" Name="u" NumberOfComponents="3" format="ascii">0 0 0 0 0 0 0 0 0 0 0 0
</DataArray></PointData>
<CellData><DataArray type="Int32" Name="b" format="ascii">7</DataArray></CellData>
<Points><DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">
0 0 0 2 0 0 2 4 0 0 4 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>"#;

    #[test]
    fn values_stand_at_points_and_at_the_middle_of_cells() {
        let file = tempfile::Builder::new().suffix(".vtu").tempfile();
        let file = file.expect("a file");
        std::fs::write(file.path(), GRID).expect("written");
        let read = |name| read_values(file.path(), name);
        assert_eq!(read("kn").expect("points")[2], ([2.0, 4.0, 0.0], 3.0));
        assert_eq!(read("b").expect("cells"), [([1.0, 2.0, 0.0], 7.0)]);
        for (name, says) in [("u", "3 components"), ("w", "`kn`, `b`")] {
            let defects = read(name).expect_err(name);
            assert!(format!("{defects:?}").contains(says), "{defects:?}");
        }
    }
}
