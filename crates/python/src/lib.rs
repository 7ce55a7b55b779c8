//! The extension module `kluft._kluft`: scenes, meshes and runs for Python, and the program.
//!
//! The package around it (`python/kluft`) makes of this what users see; nothing here is meant for
//! them. Defects become `kluft.InputError`, with every defect. Arrays are moved into numpy, never
//! copied. While a run works, the interpreter's lock is released; the thread that called looks for
//! signals and calls the follower (see [`follow`]).

mod arrays;
mod asked;
mod errors;
mod follow;
mod mesh;
mod prepared;
mod program;
mod results;
mod scene;
mod solve;
mod survey;

/// The module.
#[pyo3::pymodule(name = "_kluft", gil_used = false)]
mod module {
    #[pymodule_export]
    use super::mesh::Mesh;
    #[pymodule_export]
    use super::prepared::Prepared;
    #[pymodule_export]
    use super::program::main;
    #[pymodule_export]
    use super::results::Results;
    #[pymodule_export]
    use super::scene::{Scene, tables_of, toml_of};
    #[pymodule_export]
    use super::solve::solve;
}
