//! The surfaces of a draft as the faces of cells that they are.

use std::collections::BTreeMap;

/// A fracture facet of the draft and the two cell faces it lies between.
pub(crate) struct DraftFacet {
    /// Index into [`Surfaces::fractures`].
    pub(crate) fracture: u32,
    /// The two cell faces, in no particular order.
    pub(crate) faces: [u32; 2],
    /// The number the facet has in the file.
    pub(crate) tag: u64,
}

/// The surfaces of a draft, matched to faces of cells.
#[derive(Default)]
pub(crate) struct Surfaces {
    /// Groups that are fractures.
    pub(crate) fractures: Vec<usize>,
    /// Their facets.
    pub(crate) facets: Vec<DraftFacet>,
    /// Groups that are boundaries, with their cell faces.
    pub(crate) boundaries: Vec<(usize, Vec<u32>)>,
    /// How many facets a fracture (first) left to another (second) that holds them too.
    pub(crate) shared: BTreeMap<(u32, u32), usize>,
}
