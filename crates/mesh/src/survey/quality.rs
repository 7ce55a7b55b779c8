//! Quality of cells from the angles between their faces.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::fracture_edges::FracturesAtNodes;
use crate::mesh::Mesh;
use crate::shape::Shape;

/// Number of worst cells that are kept.
const KEPT: usize = 10;

/// Angles between the faces of a cell, and its volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellAngles {
    /// Smallest dihedral angle (degrees).
    pub smallest: f64,
    /// Largest dihedral angle (degrees).
    pub largest: f64,
    /// Volume between its corners (m^3).
    pub volume: f64,
    /// 1 for the regular cell of its shape, 0 for a flat one: the smaller of `smallest / regular`
    /// and `(180 - largest) / (180 - regular)`, `regular` being the dihedral angle of the regular
    /// cell that is nearest to 0 and to 180 degrees.
    pub quality: f64,
}

/// Quality of all cells; see [`CellAngles::quality`].
#[derive(Debug, Clone)]
pub struct CellQuality {
    /// One entry for each cell.
    pub of_cell: Vec<f64>,
    /// Volumes of the cells (m^3).
    pub volumes: Vec<f64>,
    /// Number of cells by quality, in ten equal classes from 0 to 1.
    pub histogram: [usize; 10],
    /// The ten worst cells, the worst first.
    pub worst: Vec<u32>,
    /// The ten worst cells with a node on a fracture, the worst first.
    pub worst_at_fractures: Vec<u32>,
    /// The worst cell with a node on each fracture.
    pub worst_of_fracture: Vec<Option<u32>>,
}

impl CellQuality {
    pub(super) fn of(mesh: &Mesh, at_nodes: &FracturesAtNodes) -> Self {
        let pairs = Shape::CELLS.map(|shape| (shape, adjacent_faces(shape)));
        let of_shape = |shape: Shape| {
            let found = pairs.iter().find(|(other, _)| *other == shape);
            found.map_or(&[][..], |(_, pairs)| pairs)
        };
        let angles =
            (0..mesh.cells.len()).map(|cell| angles(mesh, cell, of_shape(mesh.cells.shapes[cell])));
        let (of_cell, volumes): (Vec<f64>, Vec<f64>) =
            angles.map(|angles| (angles.quality, angles.volume)).unzip();
        let mut histogram = [0; 10];
        for quality in &of_cell {
            histogram[((10.0 * quality) as usize).min(9)] += 1;
        }
        let mut worst = Worst::new(&of_cell);
        let mut worst_at_fractures = Worst::new(&of_cell);
        let mut worst_of_fracture: Vec<Option<u32>> = vec![None; mesh.fractures.len()];
        for cell in 0..mesh.cells.len() as u32 {
            worst.offer(cell);
            let nodes = mesh.cells.nodes_of(cell as usize).iter();
            let mut touches = false;
            for &fracture in nodes.flat_map(|&node| at_nodes.of(node as usize)) {
                touches = true;
                let entry = &mut worst_of_fracture[fracture as usize];
                if entry.is_none_or(|other| of_cell[cell as usize] < of_cell[other as usize]) {
                    *entry = Some(cell);
                }
            }
            if touches {
                worst_at_fractures.offer(cell);
            }
        }
        Self {
            worst: worst.cells,
            worst_at_fractures: worst_at_fractures.cells,
            worst_of_fracture,
            histogram,
            of_cell,
            volumes,
        }
    }
}

/// The worst cells of those offered.
struct Worst<'a> {
    quality: &'a [f64],
    cells: Vec<u32>,
}

impl<'a> Worst<'a> {
    fn new(quality: &'a [f64]) -> Self {
        Self {
            quality,
            cells: Vec::with_capacity(KEPT + 1),
        }
    }

    fn offer(&mut self, cell: u32) {
        let quality = |cell: u32| self.quality[cell as usize];
        let is_full = self.cells.len() == KEPT;
        if is_full
            && self
                .cells
                .last()
                .is_some_and(|&last| quality(last) <= quality(cell))
        {
            return;
        }
        let place = self
            .cells
            .partition_point(|&other| quality(other) <= quality(cell));
        self.cells.insert(place, cell);
        self.cells.truncate(KEPT);
    }
}

/// Angles of one cell.
pub fn cell_angles(mesh: &Mesh, cell: usize) -> CellAngles {
    angles(mesh, cell, &adjacent_faces(mesh.cells.shapes[cell]))
}

/// Pairs of faces of a cell that share an edge.
fn adjacent_faces(shape: Shape) -> Vec<(u8, u8)> {
    let corners =
        |face: usize| -> BTreeSet<u8> { shape.faces()[face].corners().iter().copied().collect() };
    let count = shape.faces().len();
    let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    all.filter(|&(a, b)| corners(a).intersection(&corners(b)).count() == 2)
        .map(|(a, b)| (a as u8, b as u8))
        .collect()
}

/// Smallest and largest dihedral angle (degrees) of the cell with equal edges.
fn regular(shape: Shape) -> (f64, f64) {
    match shape.corner_count() {
        // arccos(1/3)
        4 => (70.528_779_365_509_3, 70.528_779_365_509_3),
        // arccos(1/sqrt 3) at the base, arccos(-1/3) between the sides.
        5 => (54.735_610_317_245_35, 109.471_220_634_490_7),
        6 => (60.0, 90.0),
        _ => (90.0, 90.0),
    }
}

/// Outward normals `n` of the faces give the dihedral angles by `cos = -n_a . n_b`; warped faces
/// count with their mean normal.
fn angles(mesh: &Mesh, cell: usize, pairs: &[(u8, u8)]) -> CellAngles {
    let shape = mesh.cells.shapes[cell];
    let nodes = mesh.cells.nodes_of(cell);
    let at = |local: u8| mesh.nodes[nodes[local as usize] as usize];
    let origin = at(0);
    let mut normals = [DVec3::ZERO; 6];
    let mut volume = 0.0;
    for (normal, face) in normals.iter_mut().zip(shape.faces()) {
        let corners = face.corners();
        let (a, b, c) = (at(corners[0]), at(corners[1]), at(corners[2]));
        let mut area = 0.5 * (b - a).cross(c - a);
        let mut centre = a + b + c;
        if let Some(&d) = corners.get(3) {
            area += 0.5 * (c - a).cross(at(d) - a);
            centre += at(d);
        }
        volume += (centre / corners.len() as f64 - origin).dot(area) / 3.0;
        *normal = area.normalize_or_zero();
    }
    let (mut low, mut high) = (1.0_f64, -1.0_f64);
    for &(a, b) in pairs {
        let cosine = -normals[a as usize].dot(normals[b as usize]);
        low = low.min(cosine);
        high = high.max(cosine);
    }
    let degrees = |cosine: f64| cosine.clamp(-1.0, 1.0).acos().to_degrees();
    let (smallest, largest) = (degrees(high), degrees(low));
    let (sharp, blunt) = regular(shape);
    let quality = (smallest / sharp).min((180.0 - largest) / (180.0 - blunt));
    CellAngles {
        smallest,
        largest,
        volume,
        quality: quality.min(1.0),
    }
}
