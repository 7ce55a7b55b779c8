//! Reads unstructured grids of VTK (.vtu) with numbers of materials on their cells, as OpenGeoSys
//! and GEOS write them.

use std::path::Path;

use kluft_mesh::{Defect, Draft, Group, Shape, TaggedElements, sample};
use vtkio::model::{Attribute, UnstructuredGridPiece, VertexNumbers};

use super::imported::Imported;
use super::piece::{read_piece, unread};
use super::vtk_order::from_vtk;
use crate::vtu::shape_of_vtk_cell;

/// Names under which programs keep the material of a cell, the first that is there counts.
const MATERIALS: [&str; 6] = [
    "MaterialIDs",
    "attribute",
    "Attribute",
    "gmsh:physical",
    "region",
    "CellEntityIds",
];

/// Reads a grid. Cells of one material are a group; those of a lower dimension than the highest are
/// surfaces, or lines in the plane.
///
/// # Errors
/// If the file cannot be read, holds no unstructured grid, or cells that cannot be used.
pub fn read_grid(path: &Path) -> Result<Imported, Vec<Defect>> {
    let piece = read_piece(path)?;
    let cells = Cells::of(&piece)
        .ok_or_else(|| unread(path, "its arrays do not fit together".to_owned()))?;
    cells.imported(path.display().to_string())
}

/// The arrays of a grid.
struct Cells {
    points: Vec<[f64; 3]>,
    types: Vec<u8>,
    nodes: Vec<u64>,
    ends: Vec<u64>,
    /// The array of materials and its values.
    materials: Option<(String, Vec<i64>)>,
    /// Names of the other arrays.
    others: Vec<String>,
}

impl Cells {
    fn of(piece: &UnstructuredGridPiece) -> Option<Self> {
        let points: Vec<f64> = piece.points.cast_into()?;
        let VertexNumbers::XML {
            connectivity,
            offsets,
        } = &piece.cells.cell_verts
        else {
            return None;
        };
        let (mut materials, mut others) = (None, Vec::new());
        let mut best = MATERIALS.len();
        for attribute in &piece.data.cell {
            let Attribute::DataArray(array) = attribute else {
                continue;
            };
            let rank = MATERIALS.iter().position(|name| *name == array.name);
            match (rank, array.data.cast_into::<i64>()) {
                (Some(rank), Some(values)) if rank < best => {
                    best = rank;
                    materials = Some((array.name.clone(), values));
                }
                _ => others.push(array.name.clone()),
            }
        }
        let (places, rest) = points.as_chunks();
        let cells = Self {
            points: places.to_vec(),
            types: piece.cells.types.iter().map(|kind| *kind as u8).collect(),
            nodes: connectivity.clone(),
            ends: offsets.clone(),
            materials,
            others,
        };
        let count = cells.types.len();
        let is_whole = rest.is_empty()
            && cells.ends.len() == count
            && cells.ends.is_sorted()
            && cells
                .ends
                .last()
                .is_none_or(|end| *end == cells.nodes.len() as u64)
            && cells
                .nodes
                .iter()
                .all(|node| (*node as usize) < cells.points.len())
            && cells
                .materials
                .as_ref()
                .is_none_or(|(_, values)| values.len() == count);
        is_whole.then_some(cells)
    }

    fn imported(self, source: String) -> Result<Imported, Vec<Defect>> {
        let shapes: Vec<Option<Shape>> = self
            .types
            .iter()
            .map(|kind| shape_of_vtk_cell(*kind))
            .collect();
        if let Some(defect) = self.unusable(&source, &shapes) {
            return Err(vec![defect]);
        }
        let dimensions = shapes.iter().flatten().map(|shape| shape.dimension());
        let highest = dimensions.max().unwrap_or(0);
        let mut draft = Draft {
            source,
            node_tags: (1..=self.points.len() as u64).collect(),
            cells: TaggedElements::new(),
            facets: TaggedElements::new(),
            lines: TaggedElements::new(),
            ..Draft::default()
        };
        for (cell, shape) in shapes.into_iter().enumerate() {
            if let Some(shape) = shape {
                self.add(&mut draft, (cell, shape), highest);
            }
        }
        draft.nodes = self.points;
        let mut notes = vec![match &self.materials {
            Some((name, _)) => format!("groups by the values of `{name}`"),
            None => "no array of materials: one group for each dimension".to_owned(),
        }];
        if !self.others.is_empty() {
            notes.push(format!(
                "not taken over: the arrays {}",
                self.others.join(", ")
            ));
        }
        Ok(Imported { draft, notes }.without_copies())
    }

    fn nodes_of(&self, cell: usize) -> &[u64] {
        let start = cell.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.nodes[start as usize..self.ends[cell] as usize]
    }

    /// Points that are nowhere, counted from 0.
    fn lost_points(&self) -> Vec<u64> {
        let points = self.points.iter().zip(0..);
        let lost = points.filter(|(point, _)| point.iter().any(|x| !x.is_finite()));
        lost.map(|(_, number)| number).collect()
    }

    /// Points that are nowhere, cells of no shape that serves, or with another number of nodes.
    /// Vertices lie on nodes that others have.
    fn unusable(&self, source: &str, shapes: &[Option<Shape>]) -> Option<Defect> {
        let lost = self.lost_points();
        if !lost.is_empty() {
            return Some(Defect::new(
                source,
                format!(
                    "coordinates of points are no finite numbers: {}",
                    sample(&lost)
                ),
                "write the grid again with numbers in their place",
            ));
        }
        let odd = self.types.iter().zip(shapes);
        let odd = odd.filter(|(kind, shape)| shape.is_none() && **kind > 2);
        let mut odd: Vec<u64> = odd.map(|(kind, _)| u64::from(*kind)).collect();
        odd.sort_unstable();
        odd.dedup();
        if !odd.is_empty() {
            return Some(Defect::new(
                source,
                format!("cells of VTK's types {} cannot be used", sample(&odd)),
                "mesh with tetrahedra, hexahedra, wedges or pyramids of first or second order, or \
                 triangles and quadrangles in the plane",
            ));
        }
        let broken = |cell: &usize| {
            shapes[*cell].is_some_and(|shape| self.nodes_of(*cell).len() != shape.node_count())
        };
        let cell = (0..shapes.len()).find(broken)?;
        let problem = format!("cell {cell} has {} nodes", self.nodes_of(cell).len());
        Some(Defect::new(source, problem, "write the grid again"))
    }

    /// Adds a cell; `highest` is the dimension of the rock.
    fn add(&self, draft: &mut Draft, (cell, shape): (usize, Shape), highest: usize) {
        let nodes = self.nodes_of(cell).iter();
        let nodes: Vec<u32> = nodes.map(|&node| node as u32).collect();
        let materials = self.materials.as_ref();
        let material = materials.map_or(0, |(_, values)| values[cell]);
        let set = group(draft, shape.dimension(), (material, highest));
        let target = match shape.dimension() {
            3 => &mut draft.cells,
            2 => &mut draft.facets,
            _ => &mut draft.lines,
        };
        target.elements.push(shape, &from_vtk(shape, &nodes));
        target.tags.push(cell as u64 + 1);
        target.group_set.push(set);
    }
}

/// The set of the group of a material; `highest` is the dimension of the rock.
fn group(draft: &mut Draft, dimension: usize, (material, highest): (i64, usize)) -> u32 {
    let kind = match dimension == highest {
        true => "material",
        false => "surface",
    };
    let name = format!("{kind}-{material}");
    let known = draft
        .groups
        .iter()
        .position(|g| g.dimension == dimension && g.name == name);
    known.unwrap_or_else(|| {
        draft.groups.push(Group {
            dimension,
            tag: draft.groups.len() as i32 + 1,
            name,
        });
        draft.group_sets.push(vec![draft.groups.len() - 1]);
        draft.groups.len() - 1
    }) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUAD: &str = r#"<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1">
<Points><DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">
0 0 0 2 0 0 2 4 0 0 4 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>"#;

    #[test]
    fn points_that_are_nowhere_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.vtu");
        for (number, is_lost) in [("2.5", false), ("nan", true), ("-inf", true)] {
            let text = QUAD.replace("2 4 0 0 4 0", &format!("2 4 0 0 {number} 0"));
            std::fs::write(&file, text).expect("written");
            let told = match read_grid(&file) {
                Ok(_) => String::new(),
                Err(defects) => defects[0].to_string(),
            };
            assert_eq!(
                told.contains("finite numbers: 3\n"),
                is_lost,
                "{number}: {told}"
            );
            assert_eq!(told.is_empty(), !is_lost, "{number}: {told}");
        }
    }
}
