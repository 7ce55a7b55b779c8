//! Grids as arrays of numpy, which own what the grids held.

use std::sync::Arc;

use kluft_io::{Field, Grid, Values, vtk_cell, vtk_connectivity};
use kluft_mesh::Shape;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Who shares points with whom.
pub struct Topology {
    shapes: Vec<Shape>,
    offsets: Vec<u32>,
    nodes: Vec<u32>,
}

/// A grid whose numbers belong to numpy.
pub struct GridArrays {
    topology: Arc<Topology>,
    points: Py<PyArray1<f64>>,
    point_fields: Vec<FieldArray>,
    cell_fields: Vec<FieldArray>,
}

struct FieldArray {
    name: &'static str,
    components: u32,
    values: ValueArray,
}

enum ValueArray {
    Real(Py<PyArray1<f64>>),
    Integer(Py<PyArray1<i32>>),
}

impl GridArrays {
    /// Moves a grid; coordinates and topology are those of a `former` one on the same mesh.
    pub fn of(py: Python<'_>, grid: Grid, former: Option<&Self>) -> Self {
        let fields = |fields: Vec<Field>| {
            let fields = fields.into_iter();
            fields.map(|field| FieldArray::of(py, field)).collect()
        };
        let (topology, points) = match former {
            Some(former) => (Arc::clone(&former.topology), former.points.clone_ref(py)),
            None => {
                let points = grid.points.into_flattened();
                let topology = Topology {
                    shapes: grid.shapes,
                    offsets: grid.offsets,
                    nodes: grid.nodes,
                };
                let points = PyArray1::from_vec(py, points).unbind();
                (Arc::new(topology), points)
            }
        };
        Self {
            topology,
            points,
            point_fields: fields(grid.point_fields),
            cell_fields: fields(grid.cell_fields),
        }
    }

    /// Whether it has cells.
    pub fn has_cells(&self) -> bool {
        !self.topology.shapes.is_empty()
    }

    /// Flat arrays with their numbers of components: `points`, `point_fields`, `cell_fields`; and
    /// `cells`, the topology as VTK has it: connectivity, ends of the cells, types.
    pub fn dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("points", self.points.bind(py))?;
        dict.set_item("point_fields", named(py, &self.point_fields)?)?;
        dict.set_item("cell_fields", named(py, &self.cell_fields)?)?;
        Ok(dict)
    }

    /// Points of all cells in the order of VTK, where each cell ends, and types of VTK.
    pub fn cells<'py>(&self, py: Python<'py>) -> CellArrays<'py> {
        let Topology {
            shapes,
            offsets,
            nodes,
        } = &*self.topology;
        let (connectivity, ends) = vtk_connectivity(shapes, offsets, nodes);
        let types = shapes.iter().map(|&shape| vtk_cell(shape).0).collect();
        (
            PyArray1::from_vec(py, connectivity),
            PyArray1::from_vec(py, ends),
            PyArray1::from_vec(py, types),
        )
    }

    /// A copy as a grid.
    pub fn grid(&self, py: Python<'_>) -> PyResult<Grid> {
        let fields = |fields: &[FieldArray]| {
            let fields = fields.iter();
            fields.map(|field| field.field(py)).collect::<PyResult<_>>()
        };
        let points = self.points.bind(py).readonly();
        Ok(Grid {
            points: points.as_slice()?.as_chunks().0.to_vec(),
            shapes: self.topology.shapes.clone(),
            offsets: self.topology.offsets.clone(),
            nodes: self.topology.nodes.clone(),
            point_fields: fields(&self.point_fields)?,
            cell_fields: fields(&self.cell_fields)?,
        })
    }
}

/// Connectivity, ends, types.
pub type CellArrays<'py> = (
    Bound<'py, PyArray1<u64>>,
    Bound<'py, PyArray1<u64>>,
    Bound<'py, PyArray1<u8>>,
);

impl FieldArray {
    fn of(py: Python<'_>, field: Field) -> Self {
        let values = match field.values {
            Values::Real(values) => ValueArray::Real(PyArray1::from_vec(py, values).unbind()),
            Values::Integer(values) => ValueArray::Integer(PyArray1::from_vec(py, values).unbind()),
        };
        Self {
            name: field.name,
            components: field.components,
            values,
        }
    }

    fn field(&self, py: Python<'_>) -> PyResult<Field> {
        let values = match &self.values {
            ValueArray::Real(values) => {
                Values::Real(values.bind(py).readonly().as_slice()?.to_vec())
            }
            ValueArray::Integer(values) => {
                Values::Integer(values.bind(py).readonly().as_slice()?.to_vec())
            }
        };
        Ok(Field {
            name: self.name,
            components: self.components,
            values,
        })
    }
}

fn named<'py>(py: Python<'py>, fields: &[FieldArray]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for field in fields {
        let components = field.components as usize;
        match &field.values {
            ValueArray::Real(values) => {
                dict.set_item(field.name, rows(values.bind(py), components)?)?;
            }
            ValueArray::Integer(values) => {
                dict.set_item(field.name, rows(values.bind(py), components)?)?;
            }
        }
    }
    Ok(dict)
}

/// The same numbers, a row for each point or cell if there are several of each.
fn rows<'py, T: numpy::Element>(
    values: &Bound<'py, PyArray1<T>>,
    components: usize,
) -> PyResult<Bound<'py, PyAny>> {
    match components {
        1 => Ok(values.clone().into_any()),
        _ => Ok(values
            .reshape([values.len() / components, components])?
            .into_any()),
    }
}
