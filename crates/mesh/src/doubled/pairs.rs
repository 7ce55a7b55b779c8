//! Pairs of outer faces that lie on one another, node on node.

use glam::DVec3;

use super::outer::OuterFaces;
use super::places::Places;

/// Two outer faces that lie on one another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FacePair {
    /// Places in [`OuterFaces`], ascending.
    pub(crate) faces: [usize; 2],
    /// How large the part is that lies on the other (m^2).
    pub(crate) area: f64,
    /// Whether they face each other; if not, the rock behind both is on the same side.
    pub(crate) back_to_back: bool,
}

/// Faces all of whose nodes are at those of another, in ascending order; of three or more with the
/// lowest.
pub(crate) fn matching(outer: &OuterFaces, nodes: &[DVec3], places: &Places) -> Vec<FacePair> {
    if places.is_empty() {
        return Vec::new();
    }
    let candidates = (0..outer.faces.len()).filter_map(|face| {
        let own = outer.elements.nodes_of(face);
        own.iter().any(|&node| places.has(node)).then(|| {
            let mut key: Vec<u32> = own.iter().map(|&node| places.lowest(node)).collect();
            key.sort_unstable();
            (key, face)
        })
    });
    let mut candidates: Vec<(Vec<u32>, usize)> = candidates.collect();
    candidates.sort_unstable();
    let alike = candidates.chunk_by(|a, b| a.0 == b.0);
    let pairs = alike.flat_map(|alike| {
        let lowest = alike[0].1;
        alike[1..].iter().map(move |&(_, face)| [lowest, face])
    });
    let mut pairs: Vec<FacePair> = pairs
        .filter_map(|faces| {
            let [a, b] = faces.map(|face| outer.area_vector(face, nodes));
            (a.length() > 0.0).then(|| FacePair {
                faces,
                area: a.length(),
                back_to_back: a.dot(b) < 0.0,
            })
        })
        .collect();
    pairs.sort_unstable_by_key(|pair| pair.faces);
    pairs
}
