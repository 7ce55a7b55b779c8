//! The walls of a fracture at one point: where they are, what they carry, and what they remember.
//!
//! Newton's method asks the law three things. Where it balances the rock beside the point
//! ([`FractureLaw::return_map`]): after a linear solve has put the walls at a jump `w` with a traction
//! `t`, the state `w~, t~` of the law with `t~ + k w~ = t + k w`, `k` the stiffness of the rock. How
//! the traction changes from there ([`FractureLaw::tangent`]). And, once a step has converged, what
//! lasts ([`FractureLaw::commit`]).
//!
//! Friction is integrated by return mapping on the total normal law. With the slip `s` since the walls
//! last stuck without shear, the plastic slip `lambda` of the step and the limit
//! `L = c - tan(phi) sigma_n`:
//!
//! ```text
//! stuck     t_s = K_s s,         |t_s| < L
//! sliding   t_s = L s / |s|,     |s| = L / K_s + lambda,    w_n = w_n(sigma_n) + tan(psi) lambda
//! ```

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::closure::{NormalBalance, Separation, Tension};
use crate::fracture_law::{FractureLaw, Friction, ShearRetention, outer};

/// Where the walls are and what they carry.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JointState {
    /// How far they are apart.
    pub separation: Separation,
    /// Tangential jump (m), since they last stuck without shear.
    pub slip: DVec3,
    /// Normal traction (Pa), tension positive.
    pub normal_traction: f64,
    /// Tangential traction (Pa).
    pub shear: DVec3,
    /// Slip that is not elastic, since the last commit (m).
    pub plastic_slip: f64,
    /// Whether they slide.
    pub sliding: bool,
}

/// What lasts of former steps.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JointHistory {
    /// Opening by dilation (m).
    pub dilation: f64,
    /// Largest opening (m), of a bond that may break.
    pub largest_opening: f64,
}

/// Where a linear solve has put the walls, and the traction that it gave them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialState {
    /// How far they are apart.
    pub separation: Separation,
    /// Tangential jump (m), since they last stuck without shear.
    pub slip: DVec3,
    /// Normal traction (Pa).
    pub normal_traction: f64,
    /// Tangential traction (Pa).
    pub shear: DVec3,
}

/// Stiffness of the rock beside a facet point (Pa/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RockStiffness {
    /// Across.
    pub normal: f64,
    /// Along; positive if the law has friction.
    pub shear: f64,
}

/// How the traction changes with the jump (Pa/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent {
    /// `dt/dw`; neither symmetric nor definite where friction or a softening bond is at work.
    pub exact: DMat3,
    /// A symmetric positive semidefinite tangent that is close to it: the same wherever that is one.
    pub positive: DMat3,
}

impl JointState {
    /// Traction (Pa) across a facet with unit `normal`.
    pub fn traction(&self, normal: DVec3) -> DVec3 {
        self.normal_traction * normal + self.shear
    }
}

impl FractureLaw {
    /// The walls carrying `traction` (Pa) as far as they can before anything has moved them: what
    /// initial stress leaves behind. Shear beyond the limit of friction starts to slide in the first
    /// step.
    pub fn under_initial_stress(&self, traction: DVec3, normal: DVec3) -> JointState {
        let across = traction.dot(normal);
        let balance = self.closure.balanced_after(0.0, across, 0.0);
        let shear = if self.shear_stiffness > 0.0 {
            traction - across * normal
        } else {
            DVec3::ZERO
        };
        JointState {
            separation: balance.separation,
            slip: shear / self.shear_stiffness.max(f64::MIN_POSITIVE),
            normal_traction: balance.traction,
            shear,
            ..JointState::default()
        }
    }

    /// The state of the law that balances the rock, see the module.
    pub fn return_map(
        &self,
        landing: &TrialState,
        springs: RockStiffness,
        memory: &JointHistory,
    ) -> JointState {
        match &self.friction {
            Some(friction) => self.balance_friction(friction, landing, springs, memory),
            None => self.balance_elastic(landing, springs, memory),
        }
    }

    /// The state of the law where a linear solve has put the walls, of a law that is smooth.
    pub fn state_at(&self, landing: &TrialState) -> JointState {
        let across = NormalBalance {
            separation: landing.separation,
            traction: self.closure.at(landing.separation).traction,
        };
        self.elastic_state(across, landing.slip, self.shear_stiffness)
    }

    fn balance_elastic(
        &self,
        landing: &TrialState,
        springs: RockStiffness,
        memory: &JointHistory,
    ) -> JointState {
        let load = landing.normal_traction + springs.normal * landing.separation.opening;
        let slip = landing.slip;
        let stiffness = self.shear_stiffness * (1.0 - self.damage(memory));
        let thrust = |separation: Separation| self.thrust(separation, slip, stiffness);
        let mut balance = self
            .closure
            .balanced_after(springs.normal, load, memory.largest_opening);
        // Where the fracture lets go of its shear, what pushes its walls apart is part of the balance.
        if thrust(balance.separation) < 0.0 {
            let from = balance.separation;
            let reach = self.closure.aperture - from.opening;
            let excess = |way: f64| springs.normal * way + thrust(from.moved(way));
            balance.separation = from.moved(root(excess, reach));
        }
        self.elastic_state(balance, slip, stiffness)
    }

    /// Walls without friction: `across` is where they are and what the closure law carries there.
    pub(crate) fn elastic_state(
        &self,
        across: NormalBalance,
        slip: DVec3,
        stiffness: f64,
    ) -> JointState {
        JointState {
            separation: across.separation,
            slip,
            normal_traction: across.traction + self.thrust(across.separation, slip, stiffness),
            shear: self.hold(across.separation).share * stiffness * slip,
            ..JointState::default()
        }
    }

    /// Normal traction (Pa) by which a fracture that lets go of its shear pushes its walls apart.
    fn thrust(&self, separation: Separation, slip: DVec3, stiffness: f64) -> f64 {
        self.hold(separation).slope * (0.5 * stiffness * slip.length_squared())
    }

    /// Share of a cohesive bond that former steps broke.
    fn damage(&self, memory: &JointHistory) -> f64 {
        let stiffness = self.closure.normal_stiffness;
        self.closure
            .tension
            .damage(stiffness, memory.largest_opening)
    }

    fn balance_friction(
        &self,
        friction: &Friction,
        landing: &TrialState,
        springs: RockStiffness,
        memory: &JointHistory,
    ) -> JointState {
        let (k, compliance) = (springs.shear, self.shear_stiffness.recip());
        let pull = landing.shear + k * landing.slip;
        let size = pull.length();
        // What sliding by `lambda` asks for, beyond the pull that there is.
        let excess = |lambda: f64| {
            let walls = self.across(friction, landing, springs, memory, lambda);
            let limit = self.limit(friction, &walls, memory);
            (limit * (1.0 + k * compliance) + k * lambda - size, walls)
        };
        let (missing, stuck) = excess(0.0);
        if missing >= 0.0 {
            let slip = pull / (self.shear_stiffness + k);
            return JointState {
                // The stiffness may be infinite.
                slip: if compliance > 0.0 { slip } else { DVec3::ZERO },
                shear: pull / (1.0 + k * compliance),
                ..stuck
            };
        }
        let lambda = if friction.dilation > 0.0 {
            root(|lambda| excess(lambda).0, -missing / k)
        } else {
            -missing / k
        };
        let walls = excess(lambda).1;
        let limit = self.limit(friction, &walls, memory);
        let direction = pull / size;
        JointState {
            slip: (limit * compliance + lambda) * direction,
            shear: limit * direction,
            sliding: true,
            ..walls
        }
    }

    /// The walls balanced across, after a plastic slip (m).
    fn across(
        &self,
        friction: &Friction,
        landing: &TrialState,
        springs: RockStiffness,
        memory: &JointHistory,
        plastic_slip: f64,
    ) -> JointState {
        let dilation = memory.dilation + friction.dilation * plastic_slip;
        let load =
            landing.normal_traction + springs.normal * (landing.separation.opening - dilation);
        let balance = self
            .closure
            .balanced_after(springs.normal, load, memory.largest_opening);
        JointState {
            separation: balance.separation.moved(dilation),
            normal_traction: balance.traction,
            plastic_slip,
            ..JointState::default()
        }
    }

    /// Separation as the closure law sees it: without what dilation opened.
    fn undilated(&self, walls: &JointState, memory: &JointHistory) -> Separation {
        let dilation = self.friction.map_or(0.0, |friction| friction.dilation);
        let opened = memory.dilation + dilation * walls.plastic_slip;
        walls.separation.moved(-opened)
    }

    /// Largest shear traction (Pa).
    fn limit(&self, friction: &Friction, walls: &JointState, memory: &JointHistory) -> f64 {
        let (bond, _) = self.bond(walls, memory);
        (friction.cohesion * bond - friction.coefficient * walls.normal_traction).max(0.0)
    }

    /// Share of the cohesion that is left, and how it changes with the opening (1/m).
    fn bond(&self, walls: &JointState, memory: &JointHistory) -> (f64, f64) {
        match self.closure.tension {
            Tension::Elastic => (1.0, 0.0),
            Tension::Cohesive { .. } => (1.0 - self.damage(memory), 0.0),
            Tension::CutOff => {
                let gap = self.closure.gap(self.undilated(walls, memory));
                let hold = ShearRetention::fading(gap, self.closure.aperture);
                (hold.share, hold.slope)
            }
        }
    }

    /// How the traction changes around a state of the law. `rigid` (Pa/m) takes the place of infinite
    /// stiffness: it changes how fast an iteration converges, not to what.
    pub fn tangent(
        &self,
        walls: &JointState,
        memory: &JointHistory,
        normal: DVec3,
        rigid: f64,
    ) -> Tangent {
        match &self.friction {
            Some(friction) if walls.sliding => {
                self.sliding_tangent(friction, walls, memory, normal, rigid)
            }
            _ => self.stuck_tangent(walls, memory, normal, rigid),
        }
    }

    fn stuck_tangent(
        &self,
        walls: &JointState,
        memory: &JointHistory,
        normal: DVec3,
        rigid: f64,
    ) -> Tangent {
        let across = self.slope(walls, memory, rigid);
        let hold = self.hold(walls.separation);
        let whole = if self.friction.is_some() {
            self.shear_stiffness.min(rigid)
        } else {
            self.shear_stiffness * (1.0 - self.damage(memory))
        };
        let along = hold.share * whole;
        let coupling = hold.slope * whole * walls.slip;
        let curved = across + 0.5 * hold.curvature * whole * walls.slip.length_squared();
        let part = |across: f64| isotropic(across, along, normal);
        let exact = part(curved) + outer(normal, coupling) + outer(coupling, normal);
        let convex = curved * along >= coupling.length_squared() && curved >= 0.0;
        Tangent {
            exact,
            positive: if convex { exact } else { part(across.max(0.0)) },
        }
    }

    /// Slope of the closure law (Pa/m).
    fn slope(&self, walls: &JointState, memory: &JointHistory, rigid: f64) -> f64 {
        let separation = self.undilated(walls, memory);
        let touching = self.closure.normal_stiffness.is_infinite();
        if touching {
            let open = walls.normal_traction >= 0.0 && separation.aperture > 0.0;
            return if open { 0.0 } else { rigid };
        }
        self.closure
            .at_after(separation, memory.largest_opening)
            .tangent
    }

    /// From `d lambda = a (m . dw + tan(phi) / K_s d sigma)`, `d sigma = sigma' (dw_n - tan(psi) d
    /// lambda)` and `d|t_s| = -tan(phi) d sigma`, with the direction `m` of the slip.
    fn sliding_tangent(
        &self,
        friction: &Friction,
        walls: &JointState,
        memory: &JointHistory,
        normal: DVec3,
        rigid: f64,
    ) -> Tangent {
        // Right after a commit walls without elastic slip have none, but still know where they slid.
        let direction = if walls.slip == DVec3::ZERO {
            walls.shear.normalize_or_zero()
        } else {
            walls.slip.normalize_or_zero()
        };
        let slope = self.slope(walls, memory, rigid);
        let compliance = self.shear_stiffness.recip();
        let (_, bond) = self.bond(walls, memory);
        // Growth of the limit with the opening, at fixed plastic slip; none once there is no limit left.
        let limit = if self.limit(friction, walls, memory) > 0.0 {
            friction.cohesion * bond - friction.coefficient * slope
        } else {
            0.0
        };
        let share = 1.0 / (1.0 - compliance * friction.dilation * limit);
        let lambda = share * (direction - compliance * limit * normal);
        let apart = normal - friction.dilation * lambda;
        let turning = (walls.shear.length() / walls.slip.length().max(f64::MIN_POSITIVE))
            .min(self.shear_stiffness.min(rigid));
        let transverse = DMat3::IDENTITY - outer(normal, normal) - outer(direction, direction);
        let exact =
            outer(normal, slope * apart) + outer(direction, limit * apart) + turning * transverse;
        let across = (slope * apart.dot(normal)).max(0.0);
        let along = (limit * apart.dot(direction)).max(0.0);
        Tangent {
            exact,
            positive: outer(normal, across * normal)
                + outer(direction, along * direction)
                + turning * transverse,
        }
    }

    /// Makes a converged state the one that the next step starts from.
    pub fn commit(&self, walls: &mut JointState, memory: &mut JointHistory) {
        if matches!(self.closure.tension, Tension::Cohesive { .. }) {
            let opening = walls.separation.opening - memory.dilation;
            memory.largest_opening = memory.largest_opening.max(opening);
        }
        let Some(friction) = &self.friction else {
            return;
        };
        memory.dilation += friction.dilation * walls.plastic_slip;
        walls.plastic_slip = 0.0;
        walls.slip = walls.shear / self.shear_stiffness;
    }
}

/// `across n n^T + along (I - n n^T)`.
fn isotropic(across: f64, along: f64, normal: DVec3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(along)) + outer(normal, (across - along) * normal)
}

/// Root of a growing function that is negative at 0 and positive from `high` on.
fn root(excess: impl Fn(f64) -> f64, high: f64) -> f64 {
    let (mut low, mut high) = (0.0, high);
    let (mut at_low, mut at_high) = (excess(low), excess(high));
    for _ in 0..200 {
        if at_high <= 0.0 || high - low <= 4.0 * f64::EPSILON * high {
            break;
        }
        // Illinois: the secant, with the value of an end that stays halved.
        let x = low - at_low * (high - low) / (at_high - at_low);
        let x = if x > low && x < high {
            x
        } else {
            0.5 * (low + high)
        };
        let here = excess(x);
        if here == 0.0 {
            return x;
        }
        if here > 0.0 {
            (high, at_high) = (x, here);
            at_low *= 0.5;
        } else {
            (low, at_low) = (x, here);
            at_high *= 0.5;
        }
    }
    high
}
