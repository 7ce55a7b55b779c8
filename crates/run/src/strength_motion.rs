//! How blocks move at the first factor at which strength does not hold them.

use glam::DVec3;
use kluft_io::Grid;
use kluft_solver::{FreeBody, System};

use crate::grids::{facet_grid, in_plane, integer_field, real_field};

/// A factor that did not hold.
pub struct FailedTrial {
    /// Bodies that nothing held.
    pub bodies: Vec<FreeBody>,
    /// How far all points were, where the iterations ended, from the state that they began with
    /// (m).
    pub moved: Vec<DVec3>,
}

impl FailedTrial {
    /// How all points move, the largest motion being 1: free bodies as they are pushed; where none
    /// are known, as the iterations moved them.
    pub fn motion(&self, system: &System<'_>) -> Vec<DVec3> {
        let mut motion = match self.bodies.is_empty() {
            true if self.moved.iter().all(|u| u.is_finite()) => self.moved.clone(),
            true => vec![DVec3::ZERO; self.moved.len()],
            false => self.rigid_motion(system),
        };
        let largest = motion.iter().map(|u| u.length()).fold(0.0, f64::max);
        if largest > 0.0 && largest.is_finite() {
            motion.iter_mut().for_each(|u| *u /= largest);
        }
        motion
    }

    fn rigid_motion(&self, system: &System<'_>) -> Vec<DVec3> {
        let mesh = &system.problem().mesh;
        let points = system.discretisation().points();
        let mut body_of_block = vec![None; mesh.block_count];
        for body in &self.bodies {
            let blocks = body.blocks.iter();
            blocks.for_each(|&block| body_of_block[block as usize] = Some(body));
        }
        let mut motion = vec![DVec3::ZERO; points.len()];
        for cell in 0..mesh.cells.len() {
            let Some(body) = body_of_block[mesh.block[cell] as usize] else {
                continue;
            };
            for &point in &points.of_cell_node[mesh.cells.range(cell)] {
                let node = points.node[point as usize] as usize;
                motion[point as usize] = body.motion_at(mesh.nodes[node]);
            }
        }
        motion
    }

    /// The rock with a motion of all points, coloured by blocks.
    pub fn rock_grid(&self, system: &System<'_>, motion: &[DVec3]) -> Grid {
        let mesh = &system.problem().mesh;
        let points = system.discretisation().points();
        let is_free = |block: u32| self.bodies.iter().any(|body| body.blocks.contains(&block));
        let nodes = points.node.iter();
        let grid = Grid {
            points: nodes
                .map(|&node| mesh.nodes[node as usize].to_array())
                .collect(),
            shapes: mesh.cells.shapes.clone(),
            offsets: mesh.cells.offsets.clone(),
            nodes: points.of_cell_node.clone(),
            point_fields: vec![real_field("motion", motion.iter().map(|u| u.to_array()))],
            cell_fields: vec![
                integer_field("block", mesh.block.iter().map(|&block| block as i32 + 1)),
                integer_field(
                    "free",
                    mesh.block.iter().map(|&block| is_free(block).into()),
                ),
            ],
        };
        in_plane(mesh, grid)
    }
}

/// The fractures with the jump of a motion of all points, `u(plus) - u(minus)`.
pub fn fracture_grid(system: &System<'_>, motion: &[DVec3]) -> Grid {
    let mesh = &system.problem().mesh;
    let points = system.discretisation().points();
    let facets = &mesh.facets;
    let at = |slot: u32| motion[points.of_cell_node[slot as usize] as usize];
    let walls = facets.plus_slots.iter().zip(&facets.minus_slots);
    let jumps = walls.map(|(&plus, &minus)| (at(plus) - at(minus)).to_array());
    in_plane(mesh, facet_grid(mesh, vec![real_field("motion", jumps)]))
}
