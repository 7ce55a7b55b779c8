//! The method at one point and on one element: laws, elements, the two kernels, the enrichment.
//! No files, no threads, no global matrix.
//!
//! # Conventions
//!
//! | quantity | sign and unit |
//! |---|---|
//! | stress, traction | tension positive (Pa) |
//! | normal of a fracture `n` | from its minus to its plus side |
//! | traction of a fracture `t` | `stress . n` (Pa) |
//! | jump `w` | `u(plus) - u(minus)` (m) |
//! | opening `w_n` | `w . n` (m), positive when the walls part |
//! | slip `w_s` | `w - w_n n` (m) |
//! | aperture `b` | `b0 + w_n` (m) |
//! | fluid pressure `p` | compression positive (Pa) |
//!
//! # The closure law
//!
//! ```
//! use lie_core::{Closure, ClosureKind};
//!
//! let closure = Closure::new(1e-4, 1e11, ClosureKind::Logarithmic { cutoff: None });
//! let half_closed = closure.at_aperture(0.5e-4);
//! assert!((half_closed.traction / -1e7 - 0.740227).abs() < 1e-6);
//! ```

mod anisotropy;
mod basis;
mod bezier;
mod closure;
mod element;
pub mod enrichment;
mod facet;
mod facet_flow;
mod flow;
mod fracture_law;
mod joint_state;
pub mod kernel;
mod outer;
mod quadrature;
mod recovery;
mod return_map;
mod rock;
mod root;
mod shear_retention;
mod tangent;

pub use anisotropy::{Anisotropy, Orthotropy};
pub use basis::Basis;
pub use bezier::{bezier_function, control_value};
pub use closure::{
    Closure, ClosureKind, NormalBalance, NormalResponse, NormalSpring, OwnLaw, OwnResponse,
    Separation, Tension,
};
pub use element::{ElementRule, RulePoint, rule};
pub use facet::{FacetQuadrature, FacetRulePoint, facet_points, load_areas};
pub use facet_flow::FacetFlow;
pub use flow::{Conduction, HydraulicAperture, Roughness};
pub use fracture_law::{FractureLaw, Friction};
pub use joint_state::{JointHistory, JointState, TrialState};
pub use recovery::{FinePoint, RecoveryRule, recovery_rule};
pub use return_map::RockStiffness;
pub use rock::{Elasticity, Rock, SymmetricStress};
pub use tangent::Tangent;
