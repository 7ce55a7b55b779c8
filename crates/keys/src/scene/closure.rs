//! Closure laws: what each is, and which keys of a fracture it takes.

/// A law of the normal traction of a fracture.
#[derive(Debug, Clone, Copy)]
pub struct ClosureLaw {
    /// Its name, a value of `closure`.
    pub name: &'static str,
    /// What it does, in one sentence without a full stop.
    pub says: &'static str,
    /// Keys that it needs; with friction `shear_stiffness` may be left out.
    pub needs: &'static [&'static str],
    /// Keys of the law that may stand beside them.
    pub may: &'static [&'static str],
}

const STIFF: &[&str] = &["aperture", "normal_stiffness", "shear_stiffness"];

/// All closure laws.
pub static LAWS: [ClosureLaw; 4] = [
    ClosureLaw {
        name: "linear",
        says: "Constant stiffness; the walls overlap beyond a compression of K_n0 b0",
        needs: STIFF,
        may: &["tension_cutoff"],
    },
    ClosureLaw {
        name: "logarithmic",
        says: "Stiffens as it closes; without a cutoff the walls never overlap",
        needs: STIFF,
        may: &["cutoff_aperture", "tension_cutoff"],
    },
    ClosureLaw {
        name: "hyperbolic",
        says: "Stiffens as it closes, by max_closure at most (Barton and Bandis)",
        needs: STIFF,
        may: &["max_closure", "tension_cutoff"],
    },
    ClosureLaw {
        name: "contact",
        says: "The walls touch or part, without a stiffness and without tension",
        needs: &["aperture"],
        may: &[],
    },
];
