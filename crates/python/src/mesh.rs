//! Meshes.

use std::path::PathBuf;

use kluft_io::{arrange_large, shape_of_gmsh_element, shape_of_vtk_cell, vtk_cell};
use kluft_mesh::{Defect, Draft, ElementBlock, Group, Shape};
use kluft_run::read_mesh;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::asked::threads;
use crate::errors::{input_error, sound};
use crate::survey::survey;

/// A mesh as read or given, before a scene meets it.
#[pyclass(frozen)]
pub struct Mesh {
    /// Its nodes, elements and groups.
    pub draft: Draft,
}

/// How elements are numbered and their nodes ordered (`vtk` or `gmsh`), their type there, nodes,
/// tags and groups.
type Block<'py> = (
    String,
    i32,
    PyReadonlyArray2<'py, i64>,
    PyReadonlyArray1<'py, u64>,
    Vec<usize>,
);

#[pymethods]
impl Mesh {
    /// Reads a file of gmsh.
    #[staticmethod]
    fn read(py: Python<'_>, file: PathBuf) -> PyResult<Self> {
        let draft = py.detach(|| {
            let pool = threads(None).map_err(|defect| vec![defect])?;
            let scratch = std::env::temp_dir();
            pool.install(|| read_mesh(&file, 0, &scratch, &Default::default()))
        });
        Ok(Self {
            draft: sound(py, draft)?,
        })
    }

    /// Takes arrays: coordinates (m) with numbers of the nodes, groups as (dimension, tag, name),
    /// and blocks of elements.
    #[staticmethod]
    fn of_blocks(
        py: Python<'_>,
        source: &str,
        nodes: (PyReadonlyArray2<'_, f64>, PyReadonlyArray1<'_, u64>),
        groups: Vec<(usize, i32, String)>,
        blocks: Vec<Block<'_>>,
    ) -> PyResult<Self> {
        let (points, tags) = (nodes.0.as_slice()?, nodes.1.as_slice()?);
        let (points, []) = points.as_chunks::<3>() else {
            return Err(PyValueError::new_err("points have three coordinates each"));
        };
        if points.len() != tags.len() {
            return Err(PyValueError::new_err("one tag for each point"));
        }
        let groups = groups.into_iter().map(|(dimension, tag, name)| Group {
            dimension,
            tag,
            name,
        });
        let blocks = blocks.iter().map(|block| element_block(py, source, block));
        let blocks = blocks.collect::<PyResult<Vec<_>>>()?;
        let nodes = (points.to_vec(), tags.to_vec());
        let mut draft = sound(
            py,
            Draft::of_blocks(source, nodes, groups.collect(), &blocks),
        )?;
        py.detach(|| arrange_large(&mut draft));
        Ok(Self { draft })
    }

    /// Where it came from.
    #[getter]
    fn source(&self) -> &str {
        &self.draft.source
    }

    /// Number of nodes.
    #[getter]
    fn node_count(&self) -> usize {
        self.draft.nodes.len()
    }

    /// Number of cells.
    #[getter]
    fn cell_count(&self) -> usize {
        self.draft.cells.elements.len()
    }

    /// Name, dimension, tag and number of elements of each physical surface and volume.
    fn groups(&self) -> Vec<(String, usize, i32, usize)> {
        let draft = &self.draft;
        let sizes = [
            draft.group_sizes(&draft.facets),
            draft.group_sizes(&draft.cells),
        ];
        let groups = draft.groups.iter().enumerate();
        let solid = groups.filter(|(_, group)| group.dimension >= 2);
        solid
            .map(|(index, group)| {
                let size = sizes[group.dimension.min(3) - 2][index];
                (group.name.clone(), group.dimension, group.tag, size)
            })
            .collect()
    }

    /// What it is like; surfaces of these names are fractures, or all inner ones.
    fn survey<'py>(
        &self,
        py: Python<'py>,
        fractures: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        survey(py, self.draft.clone(), fractures.as_deref())
    }
}

fn element_block(
    py: Python<'_>,
    source: &str,
    (numbering, kind, nodes, tags, groups): &Block<'_>,
) -> PyResult<ElementBlock> {
    let (shape, order): (Option<Shape>, &[u8]) = match numbering.as_str() {
        "gmsh" => (shape_of_gmsh_element(*kind), &[]),
        _ => {
            let shape = u8::try_from(*kind).ok().and_then(shape_of_vtk_cell);
            (shape, shape.map_or(&[], |shape| vtk_cell(shape).1))
        }
    };
    let Some(shape) = shape else {
        let problem = format!("elements of {numbering} type {kind} cannot be used here");
        let remedy = "mesh with tetrahedra, hexahedra, prisms or pyramids of first or second order";
        let defect = Defect::new(source, problem, remedy);
        return Err(input_error(py, vec![defect]));
    };
    let width = shape.node_count();
    if nodes.shape()[1] != width {
        let problem = format!("an element of shape {shape:?} has {width} nodes");
        return Err(PyValueError::new_err(problem));
    }
    // What is no index is one beyond all nodes, which is refused with its element.
    let index = |node: i64| u32::try_from(node).unwrap_or(u32::MAX);
    let mut own: Vec<u32> = nodes.as_slice()?.iter().map(|&node| index(node)).collect();
    if !order.is_empty() {
        for row in own.chunks_mut(width) {
            let given = row.to_vec();
            for (place, &local) in order.iter().enumerate() {
                row[local as usize] = given[place];
            }
        }
    }
    Ok(ElementBlock {
        shape,
        nodes: own,
        tags: tags.as_slice()?.to_vec(),
        groups: groups.clone(),
    })
}
