//! What the sections of a scene mean for one another.

use crate::load::Clock;

/// Whether a fluid flows, and in what rock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FluidUse {
    /// Nothing flows.
    None,
    /// It flows in rock that deforms.
    InElasticRock,
    /// It flows in rigid rock, and nothing else happens.
    InRigidRock,
}

/// What other sections mean for one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setting {
    /// Whether the load steps have times.
    pub clock: Clock,
    /// Whether a fluid flows.
    pub fluid: FluidUse,
}

impl Setting {
    /// Whether the rock is rigid.
    pub(crate) fn is_rigid(self) -> bool {
        self.fluid == FluidUse::InRigidRock
    }
}
