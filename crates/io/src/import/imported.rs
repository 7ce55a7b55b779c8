//! What an import makes.

use kluft_mesh::Draft;

/// A mesh, and what became of what the file holds.
#[derive(Debug)]
pub struct Imported {
    /// The mesh.
    pub draft: Draft,
    /// What was decided, and what has no counterpart, one line each.
    pub notes: Vec<String>,
}
