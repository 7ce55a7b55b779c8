//! Quarter-point elements: second-order cells at crack fronts, whose displacements follow the
//! square root of the distance.
//!
//! Where the middle of an edge lies at a quarter of its length from the front, the distance along
//! it is `r = s^2 l` for the reference coordinate `s`, so that quadratic displacements are
//! `c_0 + c_1 sqrt(r) + c_2 r` (R. D. Henshell and K. G. Shaw, Int. J. Numer. Meth. Engng 9, 1975;
//! R. S. Barsoum, ibid. 10, 1976).

use glam::DVec3;

use crate::mesh::Mesh;
use crate::shape::Shape;

impl Mesh {
    /// Moves the middles of all edges that leave a crack front to a quarter of their length, and
    /// the middles of faces and cells along; returns how many edges there are. Linear cells have
    /// none.
    pub fn move_to_quarter_points(&mut self) -> usize {
        let is_front = self.front_nodes();
        let place = |node: u32| self.nodes[node as usize];
        let mut moves = vec![None; self.nodes.len()];
        let mut count = 0;
        for cell in (0..self.cells.len()).filter(|&cell| self.cells.shapes[cell].is_quadratic()) {
            let shape = self.cells.shapes[cell];
            let nodes = self.cells.nodes_of(cell);
            let middles = &nodes[shape.corner_count()..];
            for (&[a, b], &middle) in shape.edges().iter().zip(middles) {
                let (a, b) = (nodes[a as usize], nodes[b as usize]);
                let (front, other) = match (is_front[a as usize], is_front[b as usize]) {
                    (true, false) => (a, b),
                    (false, true) => (b, a),
                    _ => continue,
                };
                // The edge at a quarter of its reference length, which follows a curve.
                let quarter = 0.375 * place(front) - 0.125 * place(other) + 0.75 * place(middle);
                let by = quarter - place(middle);
                let moved = moves[middle as usize].replace(by);
                if moved.is_none() && self.is_own(middle) {
                    count += 1;
                }
            }
        }
        self.drag_middles(&mut moves);
        self.move_middles(&moves);
        count
    }

    /// Nodes of fractures where both walls are one: tips.
    pub fn front_nodes(&self) -> Vec<bool> {
        let mut is_front = vec![false; self.nodes.len()];
        for &node in &self.facets.elements.nodes {
            is_front[node as usize] = self.sectors.count[node as usize] == 1;
        }
        is_front
    }

    /// Cells with a node among [`Self::front_nodes`].
    pub fn front_cells(&self) -> Vec<bool> {
        let is_front = self.front_nodes();
        let touches = |cell: usize| {
            let mut nodes = self.cells.nodes_of(cell).iter();
            nodes.any(|&node| is_front[node as usize])
        };
        (0..self.cells.len()).map(touches).collect()
    }

    /// Moves the middles of faces and cells as their edges say: by half the sum over the edges of a
    /// quadrangle, by a quarter of it in a hexahedron, because corners stay.
    fn drag_middles(&self, moves: &mut [Option<DVec3>]) {
        let mut drag = |middle: u32, edges: &[u32], share: f64| {
            let sum: DVec3 = edges.iter().filter_map(|&edge| moves[edge as usize]).sum();
            if sum != DVec3::ZERO {
                moves[middle as usize] = Some(share * sum);
            }
        };
        for cell in 0..self.cells.len() {
            let nodes = self.cells.nodes_of(cell);
            for face in self.cells.shapes[cell].faces() {
                if face.shape == Shape::Quad9 {
                    let local: Vec<u32> = face.nodes.iter().map(|&n| nodes[n as usize]).collect();
                    drag(local[8], &local[4..8], 0.5);
                }
            }
            if self.cells.shapes[cell] == Shape::Hex27 {
                drag(nodes[26], &nodes[8..20], 0.25);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structured::{Patch, cells_of};
    use crate::{Mesh, SurfaceRole};

    /// A cube with a crack in the left half of its middle plane.
    fn cracked(shape: Shape) -> Mesh {
        let contains = |x: [f64; 3]| x[2] == 0.5 && x[0] <= 0.5;
        let crack = Patch {
            name: "crack",
            contains: &contains,
        };
        let draft = cells_of(shape, [2, 1, 2], [1.0; 3], &[crack]);
        let role = |dimension| match dimension {
            2 => SurfaceRole::Fracture,
            _ => SurfaceRole::Unused,
        };
        let roles: Vec<_> = draft.groups.iter().map(|g| role(g.dimension)).collect();
        Mesh::build(draft, &roles).expect("a sound mesh")
    }

    #[test]
    fn middles_beside_the_front_lie_at_a_quarter() {
        for shape in Shape::CELLS {
            let mut mesh = cracked(shape);
            let before = mesh.nodes.clone();
            let count = mesh.move_to_quarter_points();
            assert_eq!(count > 0, shape.is_quadratic(), "{shape:?}");
            assert_eq!(mesh.has_quarter_points, count > 0);
            let from_front = |x: DVec3| DVec3::new(x.x - 0.5, 0.0, x.z - 0.5);
            for (before, after) in before.iter().zip(&mesh.nodes) {
                // Edges along the axes leave the front in cells of all shapes.
                let (old, new) = (from_front(*before), from_front(*after));
                if (old.length() - 0.25).abs() < 1e-12 && old.x * old.z == 0.0 {
                    assert!(
                        (new - 0.5 * old).length() < 1e-12,
                        "{shape:?} {before} {after}"
                    );
                } else if old.abs().max_element() > 0.4 {
                    assert_eq!(before, after, "{shape:?}");
                }
            }
        }
    }
}
