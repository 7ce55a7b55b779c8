//! A Galerkin solve in a recycled space: Newton's method in the space of the corrections of former
//! steps, for the first guess of an increment.
//!
//! States along a path lie close to a space of few dimensions, which the corrections that led to
//! them span. With `y = y_0 + V c` the balance of forces becomes
//! `V^T (loads - K y - fractures) = 0`. The rock enters by the small matrix `V^T K V`, which never
//! changes, and the fractures by the jumps of `V`, so an iteration costs what the facet points
//! cost, whatever the size of the rock. Smooth laws are convex, so this is the state of least
//! energy in the space. What the guess leaves out of balance is orthogonal to the space, and so, in
//! energy, is the correction that removes it: the next direction (Erhel and Guyomarc'h 2000 start
//! conjugate gradients alike). Directions beyond a number are condensed to the principal ones
//! (proper orthogonal decomposition).
//!
//! Laws with kinks may have several equilibria, and the one that the loads lead to is not
//! recognised by its energy. There only the linear solves begin in the space: whatever they begin
//! with, they have one solution.

mod condensation;
mod galerkin;
mod linear_guess;
mod projection;
mod space;

pub(super) use galerkin::GalerkinGuess;
pub(super) use linear_guess::KEPT_AT_KINKS;
pub(super) use space::RecycledSpace;
pub(crate) use space::bytes;
