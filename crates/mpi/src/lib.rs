//! Kluft on many ranks: the same run, its linear systems solved by PETSc over MPI.
//!
//! Every rank goes through the run with the same numbers; what is divided among them are the rows
//! of the linear solver, and the pieces of the grids that are written.
//!
//! | file | what it holds |
//! |---|---|
//! | `petsc`, `shim.c` | PETSc and MPI behind safe types |
//! | `communicator` | what the ranks tell each other |
//! | `rows`, `lines`, `parts` | rows of blocks on their way to PETSc, and what a solver is made of |
//! | `partition` | which rank owns which unknowns |
//! | `levels` | the levels below the finest one, the rows of this rank |
//! | `distributed` | the linear solver |
//! | `run`, `args`, `memory`, `traffic` | the program |

pub mod answers;
pub mod args;
pub mod communicator;
pub mod distributed;
pub mod levels;
mod lines;
mod memory;
pub mod partition;
pub mod parts;
pub mod petsc;
mod rows;
pub mod run;
mod traffic;
