//! The points that an aggregate moves, as a graph, and how fractures divide them.

use kluft_mesh::DisjointSets;

use crate::space::Space;

/// Marks a point that the aggregate does not move.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Walls that have less than this share of the motion of their aggregate do not divide it.
const BESIDE: f64 = 0.1;

/// The points that an aggregate moves; those of one cell are neighbours.
pub(super) struct MovedPoints<'a> {
    space: Space<'a>,
    /// Points, ascending, and how much of the motion they have.
    points: &'a [(u32, f64)],
    /// Place of each point of the space in `points`, or [`NOWHERE`].
    place: &'a [u32],
}

impl<'a> MovedPoints<'a> {
    /// Those of a list, ascending, whose places are known.
    pub(super) fn new(space: Space<'a>, points: &'a [(u32, f64)], place: &'a [u32]) -> Self {
        Self {
            space,
            points,
            place,
        }
    }

    /// The part of each point, a number below that of the points: what cells connect, divided
    /// further where a fracture ends inside.
    pub(super) fn parts(&self) -> Vec<u32> {
        let connected = self.connected(|_| true);
        let is_wall = self.walls(&connected);
        if is_wall.contains(&true) {
            self.nearest_walls(&is_wall, &connected)
        } else {
            connected
        }
    }

    /// Sets of points that cells connect through such points as are `taken`.
    fn connected(&self, taken: impl Fn(usize) -> bool) -> Vec<u32> {
        let mut sets = DisjointSets::new(self.points.len());
        for place in (0..self.points.len()).filter(|&place| taken(place)) {
            let neighbours = self.neighbours(place);
            for other in neighbours.filter(|&other| taken(other as usize)) {
                sets.join(place as u32, other);
            }
        }
        let all = 0..self.points.len() as u32;
        all.map(|place| sets.root(place)).collect()
    }

    /// Whether each point lies on a wall whose other side is in the same set, at a node with
    /// several points in one set, if such walls have a part in the motion.
    fn walls(&self, set: &[u32]) -> Vec<bool> {
        let node = |place: usize| self.space.points.node[self.points[place].0 as usize];
        let places: Vec<usize> = (0..self.points.len()).collect();
        // The points of a node stand side by side.
        let of_nodes = places.chunk_by(|&a, &b| node(a) == node(b));
        let is_wall = of_nodes.flat_map(|own| {
            own.iter().map(|&place| {
                let mut others = own.iter().filter(|&&other| other != place);
                others.any(|&other| set[other] == set[place])
            })
        });
        let mut is_wall: Vec<bool> = is_wall.collect();
        let weight: f64 = self.points.iter().map(|(_, weight)| weight).sum();
        let mut of_walls = vec![0.0; self.points.len()];
        for place in (0..set.len()).filter(|&place| is_wall[place]) {
            of_walls[set[place] as usize] += self.points[place].1;
        }
        for (is_wall, &set) in is_wall.iter_mut().zip(set) {
            *is_wall &= of_walls[set as usize] >= BESIDE * weight;
        }
        is_wall
    }

    /// Divides sets that hold both walls of a fracture: each point goes with the wall from which
    /// the fewest cells lead to it. So walls move apart as far as the edge of the fracture, and
    /// what lies ahead of the edge tears along with them instead of holding them together.
    fn nearest_walls(&self, is_wall: &[bool], set: &[u32]) -> Vec<u32> {
        let wall = self.connected(|place| is_wall[place]);
        let mut nearest: Vec<u32> = wall
            .iter()
            .zip(is_wall)
            .map(|(&wall, &is_wall)| if is_wall { wall } else { NOWHERE })
            .collect();
        let mut front: Vec<usize> = (0..nearest.len()).filter(|&at| is_wall[at]).collect();
        while !front.is_empty() {
            let mut next = Vec::new();
            for place in front {
                for other in self.neighbours(place) {
                    if nearest[other as usize] == NOWHERE {
                        nearest[other as usize] = nearest[place];
                        next.push(other as usize);
                    }
                }
            }
            front = next;
        }
        let parts = nearest.iter().zip(set);
        parts
            .map(|(&wall, &set)| if wall == NOWHERE { set } else { wall })
            .collect()
    }

    /// Places of the points that share a cell with the one at a place, itself among them.
    fn neighbours(&self, place: usize) -> impl Iterator<Item = u32> {
        let Space {
            points, pattern, ..
        } = self.space;
        let cells = &self.space.problem.mesh.cells;
        let (point, _) = self.points[place];
        let slots = pattern.slots_of(points.node[point as usize] as usize);
        let own = slots
            .iter()
            .filter(move |&&slot| points.of_cell_node[slot as usize] == point);
        let others = own.flat_map(move |&slot| {
            let (_, slots) = pattern.cell_of_slot.locate(slot, cells);
            points.of_cell_node[slots].iter()
        });
        let places = others.map(|&other| self.place[other as usize]);
        places.filter(|&place| place != NOWHERE)
    }
}
