//! Grids that several files hold together, read back.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use kluft_io::{Grid, Values};
use vtkio::model::{Attribute, DataSet, UnstructuredGridPiece, VertexNumbers, Vtk};

/// Values of a field on the points of each cell, or on the cell; cells are known by the places of
/// their points.
pub type Cells = BTreeMap<Vec<[u64; 3]>, Vec<f64>>;

/// The files that a `.pvtu` names.
pub fn listed(pvtu: &Path) -> Vec<String> {
    let text = fs::read_to_string(pvtu).expect("a .pvtu");
    let names = text.split("Source=\"").skip(1);
    let names = names.map(|rest| rest.split('"').next().unwrap_or_default().to_owned());
    names.collect()
}

/// A field of a step's grid, all pieces together.
pub fn field(pvtu: &Path, name: &str) -> Cells {
    let folder = pvtu.parent().expect("a folder");
    let mut cells = Cells::new();
    for file in listed(pvtu) {
        let read = Vtk::import(folder.join(&file)).expect("readable");
        let DataSet::UnstructuredGrid { pieces, .. } = read.data else {
            panic!("{file}: not an unstructured grid");
        };
        for piece in pieces {
            let piece = piece.into_loaded_piece_data(None).expect("loaded");
            let before = cells.len();
            let own = of_piece(&piece, name);
            let count = own.len();
            cells.extend(own);
            assert_eq!(
                cells.len(),
                before + count,
                "{file}: a cell of another piece"
            );
        }
    }
    cells
}

fn of_piece(piece: &UnstructuredGridPiece, name: &str) -> Cells {
    let places: Vec<f64> = piece.points.clone().into_vec().expect("numbers");
    let VertexNumbers::XML {
        connectivity,
        offsets,
    } = &piece.cells.cell_verts
    else {
        panic!("not as XML files have them");
    };
    let array = |list: &[Attribute]| -> Option<(usize, Vec<f64>)> {
        list.iter().find_map(|attribute| match attribute {
            Attribute::DataArray(array) if array.name == name => {
                let values = array.data.clone().into_vec().expect("real numbers");
                Some((array.num_comp(), values))
            }
            _ => None,
        })
    };
    let (of_points, of_cells) = (array(&piece.data.point), array(&piece.data.cell));
    assert!(
        offsets.is_empty() || of_points.is_some() || of_cells.is_some(),
        "no {name}"
    );
    let mut start = 0;
    let cells = offsets.iter().enumerate().map(|(cell, &end)| {
        let points = &connectivity[start..end as usize];
        start = end as usize;
        let key = points
            .iter()
            .map(|&point| place(&places[3 * point as usize..]));
        let values = match (&of_points, &of_cells) {
            (Some((width, values)), _) => taken(values, *width, points.iter().map(|&p| p as usize)),
            (_, Some((width, values))) => taken(values, *width, [cell].into_iter()),
            _ => Vec::new(),
        };
        (key.collect(), values)
    });
    cells.collect()
}

/// The same of a grid in memory. Linear cells only: VTK has other orders of nodes for others.
pub fn field_of(grid: &Grid, name: &str) -> Cells {
    let find = |fields: &[kluft_io::Field]| {
        let field = fields.iter().find(|field| field.name == name)?;
        match &field.values {
            Values::Real(values) => Some((field.components as usize, values.clone())),
            Values::Integer(_) => None,
        }
    };
    let (of_points, of_cells) = (find(&grid.point_fields), find(&grid.cell_fields));
    let (connectivity, ends) = kluft_io::vtk_connectivity(&grid.shapes, &grid.offsets, &grid.nodes);
    let mut start = 0;
    let cells = ends.iter().enumerate().map(|(cell, &end)| {
        let points = &connectivity[start..end as usize];
        start = end as usize;
        let key = points
            .iter()
            .map(|&point| place(&grid.points[point as usize]));
        let values = match (&of_points, &of_cells) {
            (Some((width, values)), _) => taken(values, *width, points.iter().map(|&p| p as usize)),
            (_, Some((width, values))) => taken(values, *width, [cell].into_iter()),
            _ => panic!("no {name}"),
        };
        (key.collect(), values)
    });
    cells.collect()
}

fn place(coordinates: &[f64]) -> [u64; 3] {
    std::array::from_fn(|axis| coordinates[axis].to_bits())
}

fn taken(values: &[f64], width: usize, items: impl Iterator<Item = usize>) -> Vec<f64> {
    let at = items.flat_map(|item| width * item..width * (item + 1));
    at.map(|at| values[at]).collect()
}

/// A field of a grid that stands in one file.
pub fn field_of_one(vtu: &Path, name: &str) -> Cells {
    let read = Vtk::import(vtu).expect("readable");
    let DataSet::UnstructuredGrid { pieces, .. } = read.data else {
        panic!("{}: not an unstructured grid", vtu.display());
    };
    let pieces = pieces.into_iter();
    let loaded = pieces.map(|piece| piece.into_loaded_piece_data(None).expect("loaded"));
    loaded.flat_map(|piece| of_piece(&piece, name)).collect()
}
