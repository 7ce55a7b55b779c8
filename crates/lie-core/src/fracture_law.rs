//! Closure, shear and friction of a fracture together.

use crate::closure::{Closure, ClosureKind, Tension};

/// Coulomb friction: the shear traction is at most `c - tan(phi) sigma_n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// `tan(phi)` of the friction angle.
    pub coefficient: f64,
    /// Cohesion `c` (Pa); lost once the walls are an aperture apart or a bond is broken.
    pub cohesion: f64,
    /// `tan(psi)` of the dilation angle: opening per slip beyond the elastic slip,
    /// `<= coefficient`.
    pub dilation: f64,
}

/// Law of a fracture: [`Closure`] across, elastic in shear, sliding by [`Friction`] if it has any.
///
/// `t = sigma_n(b) n + K_s w_s`, with the potential `Psi(b) + K_s |w_s|^2 / 2`, as long as it does
/// not slide. A fracture without friction whose tension is cut off lets go of its shear as it
/// opens, see `FractureLaw::shear_retention`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractureLaw {
    /// Normal part.
    pub closure: Closure,
    /// Shear stiffness `K_s` (Pa/m); infinite if only friction lets the walls slide.
    pub shear_stiffness: f64,
    /// Friction, if the shear traction is limited.
    pub friction: Option<Friction>,
}

impl FractureLaw {
    /// A fracture without friction.
    pub fn elastic(closure: Closure, shear_stiffness: f64) -> Self {
        Self {
            closure,
            shear_stiffness,
            friction: None,
        }
    }

    /// A fracture whose walls never move from their aperture (m): their stiffness is infinite.
    pub fn rigid(aperture: f64) -> Self {
        Self::elastic(
            Closure::new(aperture, f64::INFINITY, ClosureKind::Linear),
            f64::INFINITY,
        )
    }

    /// The same with friction and cohesion divided by a factor, as strength reduction has it; no
    /// fracture dilates more than it rubs.
    #[must_use]
    pub fn weakened(self, factor: f64) -> Self {
        let friction = self.friction.map(|friction| {
            let coefficient = friction.coefficient / factor;
            Friction {
                coefficient,
                cohesion: friction.cohesion / factor,
                dilation: friction.dilation.min(coefficient),
            }
        });
        Self { friction, ..self }
    }

    /// Whether traction is proportional to the jump.
    pub fn is_linear(&self) -> bool {
        self.friction.is_none() && self.closure.is_linear()
    }

    /// Whether walls may pass through each other where the law balances the rock: it resists no
    /// more, the closer they are. A logarithmic law that goes on linearly below its cutoff stiffens
    /// up to there, which keeps iterations from doing so on the way.
    pub fn lets_walls_pass(&self) -> bool {
        self.is_linear()
    }

    /// Whether the tangent changes gradually: no sliding, no end of contact.
    pub fn is_smooth(&self) -> bool {
        self.friction.is_none() && self.closure.is_smooth()
    }

    /// Whether the traction depends on how a jump was reached.
    pub fn is_path_dependent(&self) -> bool {
        self.friction.is_some() || matches!(self.closure.tension, Tension::Cohesive { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_pass_where_no_law_stiffens() {
        let cut = |cutoff| ClosureKind::Logarithmic { cutoff };
        let law = |stiffness, kind| FractureLaw::elastic(Closure::new(1e-3, stiffness, kind), 1e9);
        for (law, passes) in [
            (law(1e10, ClosureKind::Linear), true),
            (law(1e10, cut(Some(1e-3))), true),
            (law(1e10, cut(Some(1e-5))), false),
            (law(1e10, cut(None)), false),
            (law(0.0, cut(None)), true),
        ] {
            assert_eq!(law.lets_walls_pass(), passes, "{law:?}");
        }
    }
}
