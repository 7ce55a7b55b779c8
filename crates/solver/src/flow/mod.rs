//! Flow in the fractures: one pressure a node, linear along facets.
//!
//! A node of conducting fractures has one pressure, whatever fractures meet there: the fluid passes
//! from one to another without loss. With the potential `phi = p - rho g . x`, the transmissivities
//! `T_f` of the facets and their stencils `k_ij` (see `lie_core::FacetFlow`),
//!
//! ```text
//! sum_f T_f sum_j k_ij (phi_j - phi_i) = q_i
//! ```
//!
//! is the rate that enters at node `i`: what a condition drives, and zero at all others. The sum of
//! these equations is the mass balance.
//!
//! | file | what it holds |
//! |---|---|
//! | `numbering` | the nodes that have a pressure |
//! | `conductance` | transmissivities of facets, the matrix, rates of potentials |
//! | `places`, `edges`, `wells` | where conditions act |
//! | `node_radius` | the radius that the pressure of a node stands for |
//! | `nodal` | conditions as they act on nodes |
//! | `topology` | all of a flow that stays whatever the apertures |
//! | `networks` | what hangs together hydraulically |
//! | `steady_state` | networks that have none, or more than one |
//! | `isolated` | networks that nothing drives |
//! | `undrained`, `keeping` | networks that keep what they hold |
//! | `permeability` | how the body conducts as a whole |
//! | `steady`, `solve` | the discrete flow, factorised once; the flow at a load |
//! | `balance` | what enters, what leaves |
//! | `push` | how pressures push on the walls that follow them, as a matrix |
//! | `walls` | the push of the fluid on the walls of fractures |
//! | `fields` | pressure, hydraulic aperture and flux for results |

mod balance;
mod conductance;
mod coupling;
mod edges;
mod fields;
mod isolated;
mod keeping;
mod linearised;
mod loaded;
mod networks;
mod nodal;
mod node_radius;
mod numbering;
mod operator;
mod permeability;
mod places;
mod push;
mod solve;
mod steady;
mod steady_state;
mod topology;
mod transient;
mod undrained;
mod wall_points;
mod walls;
mod wells;

pub use balance::{ConditionFlow, FlowBalance};
pub use coupling::{Coupling, FluidState, unfit_walls};
pub(crate) use coupling::{FlowAtWalls, FlowIncrement};
pub use fields::FlowFields;
pub(crate) use linearised::LinearisedFlow;
pub use loaded::FlowState;
pub use networks::FlowNetwork;
pub use permeability::{EquivalentPermeability, NoPermeability, PermeabilityTensor};
pub use steady::FlowSystem;
pub use steady_state::NO_PRESSURE;
pub use transient::{TimeStep, TransientFlow, TransientState};
pub(crate) use wall_points::between_corners;

#[cfg(test)]
mod tests;
