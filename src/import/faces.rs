//! Boundaries of a project that are meshes of their own, as faces of the mesh of the body.

use kluft_mesh::{Draft, Group};

use super::extent::{Extent, NEAR};

/// Adds the faces of a boundary's mesh, whose nodes are nodes of the body, to the body as a group
/// of this name; none of them if a node is not there.
pub fn add_faces(body: &mut Draft, boundary: &Draft, name: &str) -> Option<()> {
    let nodes = Places::of(body)?.find_all(&boundary.nodes)?;
    let is_plane = body.is_plane();
    let (faces, target) = match is_plane {
        true => (&boundary.lines, &mut body.lines),
        false => (&boundary.facets, &mut body.facets),
    };
    if faces.elements.is_empty() {
        return None;
    }
    let group = Group {
        dimension: if is_plane { 1 } else { 2 },
        tag: body.groups.len() as i32 + 1,
        name: name.to_owned(),
    };
    body.groups.push(group);
    body.group_sets.push(vec![body.groups.len() - 1]);
    let set = (body.group_sets.len() - 1) as u32;
    let last = target.tags.iter().max().copied().unwrap_or(0);
    let shapes = faces.elements.shapes.iter().enumerate();
    for ((face, &shape), tag) in shapes.zip(last + 1..) {
        let own = faces.elements.nodes_of(face).iter();
        let own: Vec<u32> = own.map(|&node| nodes[node as usize]).collect();
        target.elements.push(shape, &own);
        target.tags.push(tag);
        target.group_set.push(set);
    }
    Some(())
}

/// The nodes of a mesh, ascending in x.
struct Places {
    sorted: Vec<([f64; 3], u32)>,
    /// Places nearer than this are one (m).
    near: f64,
}

impl Places {
    fn of(mesh: &Draft) -> Option<Self> {
        let Extent { low, high } = Extent::of(mesh.nodes.iter().copied())?;
        let size = (0..3).map(|axis| high[axis] - low[axis]);
        let numbered = mesh.nodes.iter().zip(0..);
        let mut sorted: Vec<_> = numbered.map(|(&place, node)| (place, node)).collect();
        sorted.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        Some(Self {
            sorted,
            near: NEAR * size.fold(0.0, f64::max),
        })
    }

    /// The node at each place.
    fn find_all(&self, places: &[[f64; 3]]) -> Option<Vec<u32>> {
        places.iter().map(|place| self.find(place)).collect()
    }

    fn find(&self, place: &[f64; 3]) -> Option<u32> {
        let begin = self
            .sorted
            .partition_point(|(own, _)| own[0] < place[0] - self.near);
        let candidates = self.sorted[begin..].iter();
        let mut candidates = candidates.take_while(|(own, _)| own[0] <= place[0] + self.near);
        let is_same = |own: &[f64; 3]| (0..3).all(|k| (own[k] - place[k]).abs() <= self.near);
        let found = candidates.find(|(own, _)| is_same(own));
        found.map(|(_, node)| *node)
    }
}
