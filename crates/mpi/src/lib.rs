//! Kluft on many ranks: the same run, its linear systems solved by PETSc over MPI.
//!
//! Every rank goes through the run with the same numbers; what is divided among them are the rows
//! of the linear solver, and the pieces of the grids that are written.
//!
//! | file | what it holds |
//! |---|---|
//! | `petsc`, `shim.c` | PETSc and MPI behind safe types |
//! | `partition` | which rank owns which unknowns |
//! | `next_level` | the second level, put together from what the rows of all ranks give to it |
//! | `distributed` | the linear solver |
//! | `run`, `args`, `memory`, `traffic` | the program |

mod answers;
pub mod args;
pub mod distributed;
mod memory;
pub mod next_level;
pub mod partition;
pub mod petsc;
pub mod run;
mod traffic;
