//! Laws along paths of prescribed jumps, against closed forms.

use glam::DVec3;
use lie_core::{
    Closure, ClosureKind, FractureLaw, Friction, JointHistory, JointState, RockStiffness, Tension,
    TrialState,
};

const NORMAL: DVec3 = DVec3::Z;

/// A fracture whose walls are moved.
struct Driven {
    law: FractureLaw,
    state: JointState,
    history: JointHistory,
    /// Jump at the last commit.
    jump: DVec3,
}

impl Driven {
    fn new(law: FractureLaw) -> Self {
        Self {
            law,
            state: law.under_initial_stress(DVec3::ZERO, NORMAL),
            history: JointHistory::default(),
            jump: DVec3::ZERO,
        }
    }

    /// The state at a jump, without commit: rock many times stiffer than the fracture.
    fn at(&self, jump: DVec3) -> JointState {
        let stiffness = 1e4 * self.law.closure.normal_stiffness;
        let rock = RockStiffness {
            normal: stiffness,
            shear: stiffness,
        };
        let mut state = self.state;
        for _ in 0..20 {
            let trial = TrialState {
                separation: self.law.closure.opened(jump.dot(NORMAL)),
                slip: self.state.slip + (jump - self.jump).reject_from(NORMAL),
                normal_traction: state.normal_traction,
                shear: state.shear,
            };
            state = self.law.return_map(&trial, rock, &self.history);
        }
        state
    }

    fn go(&mut self, jump: DVec3) -> DVec3 {
        self.state = self.at(jump);
        let traction = self.state.traction(NORMAL);
        self.law.commit(&mut self.state, &mut self.history);
        self.jump = jump;
        traction
    }
}

fn close(found: f64, wanted: f64, tolerance: f64) {
    assert!(
        (found - wanted).abs() <= tolerance * wanted.abs(),
        "{found} against {wanted}"
    );
}

/// OpenGeoSys' test `coulomb_load_path`: 20 kPa normal load, friction 22 degrees, cohesion 1 kPa,
/// dilation 10 degrees, K = 20 GPa/m. First slip at 9.081 kPa.
#[test]
fn shear_under_normal_load_slips_first_at_9081_pascal() {
    let tangent = |degrees: f64| degrees.to_radians().tan();
    let friction = Friction {
        coefficient: tangent(22.0),
        cohesion: 1e3,
        dilation: tangent(10.0),
    };
    let law = FractureLaw {
        closure: Closure::new(1e-5, 20e9, ClosureKind::Linear),
        shear_stiffness: 20e9,
        friction: Some(friction),
    };
    let mut path = Driven::new(law);
    close(path.go(DVec3::new(0.0, 0.0, -1e-6)).z, -20e3, 1e-9);
    let limit = 1e3 + 20e3 * friction.coefficient;
    close(limit, 9081.0, 1e-4);
    let at = |traction: f64| DVec3::new(traction / 20e9, 0.0, -1e-6);
    assert!(!path.at(at(0.9999 * limit)).sliding);
    assert!(path.at(at(1.0001 * limit)).sliding);
    let slip = 1e-5;
    let sliding = path.at(DVec3::new(slip, 0.0, -1e-6));
    // Consistency: lambda = F / (K_s + K_n tan(psi) tan(phi)).
    let lambda = (20e9 * slip - limit) / (20e9 + 20e9 * friction.dilation * friction.coefficient);
    close(sliding.plastic_slip, lambda, 1e-8);
    close(sliding.shear.x, 20e9 * (slip - lambda), 1e-8);
    let across = 20e9 * (-1e-6 - friction.dilation * lambda);
    close(sliding.normal_traction, across, 1e-8);
    // The way back is elastic until the limit on the other side.
    path.go(DVec3::new(slip, 0.0, -1e-6));
    let back = path.at(DVec3::new(slip - 1e-7, 0.0, -1e-6));
    assert!(!back.sliding);
    close(back.shear.x, sliding.shear.x - 20e9 * 1e-7, 1e-8);
}

/// OpenGeoSys' test `cohesive_zone_load_path`: strength 10 MPa, 200 J/m^2, K = 1e12 Pa/m, so
/// w_p = 1e-5 m and w_f = 4e-5 m; open, unload, close, open again.
#[test]
fn a_bond_softens_unloads_to_the_origin_and_breaks() {
    let mut closure = Closure::new(1e-5, 1e12, ClosureKind::Logarithmic { cutoff: Some(4e-6) });
    closure.tension = Tension::Cohesive {
        strength: 10e6,
        energy: 200.0,
    };
    let mut path = Driven::new(FractureLaw::elastic(closure, 1e12));
    let opened = |w: f64| w * NORMAL;
    close(path.go(opened(1e-5)).z, 10e6, 1e-6);
    let softened = 10e6 * (4e-5 - 2e-5) / 3e-5;
    close(path.go(opened(2e-5)).z, softened, 1e-6);
    close(path.go(opened(1e-5)).z, 0.5 * softened, 1e-6);
    assert!(path.go(opened(0.0)).z.abs() < 1.0);
    // In compression the closure law is whole: x = 0.2 is below the cutoff 0.4.
    let l = 0.4_f64.ln();
    let stiffness = 1.0 + l * l + 2.0 * l / 0.4 * (0.2 - 0.4);
    close(path.go(opened(-8e-6)).z, 1e12 * stiffness * -8e-6, 1e-6);
    close(path.go(opened(2e-5)).z, softened, 1e-6);
    close(path.go(opened(3e-5)).z, 10e6 / 3.0, 1e-6);
    assert_eq!(path.go(opened(4.01e-5)).z, 0.0);
    assert_eq!(path.go(opened(1e-6)).z, 0.0);
}

/// Brady and Brown: K_ni = 10 GPa/m, v_m = 0.2 mm: 0.1 mm at 2 MPa, where K_n = 40 GPa/m.
#[test]
fn barton_bandis_is_half_closed_at_stiffness_times_largest_closure() {
    let law = Closure::new(5e-4, 10e9, ClosureKind::Hyperbolic { max_closure: 2e-4 });
    let half = law.balanced(0.0, -2e6);
    close(half.opening, -1e-4, 1e-12);
    close(law.at(half).tangent, 40e9, 1e-9);
    for load in [-1e3, -1e6, -1e9, -1e13] {
        for spring in [0.0, 1e8, 1e10, 1e14] {
            for max_closure in [2e-4, 5e-4] {
                let law = Closure::new(5e-4, 10e9, ClosureKind::Hyperbolic { max_closure });
                let found = law.balanced(spring, load);
                assert!(found.aperture > 0.0, "{load} {spring} {max_closure}");
                let left = law.at(found).traction + spring * found.opening - load;
                let rounding = 1e-15 * (law.at(found).tangent * found.aperture + spring * 5e-4);
                assert!(left.abs() < 1e-12 * load.abs() + 4.0 * rounding);
            }
        }
    }
}

/// The consistent tangent is the derivative of the traction along a path.
#[test]
fn tangents_are_derivatives() {
    let friction = |dilation: f64, cohesion: f64| {
        Some(Friction {
            coefficient: 0.6,
            cohesion,
            dilation,
        })
    };
    let logarithmic = Closure::new(1e-4, 1e10, ClosureKind::Logarithmic { cutoff: None });
    let law = |tension: Tension, friction: Option<Friction>| FractureLaw {
        closure: Closure {
            tension,
            ..logarithmic
        },
        shear_stiffness: 3e9,
        friction,
    };
    let bond = Tension::Cohesive {
        strength: 1e6,
        energy: 200.0,
    };
    let laws = [
        law(Tension::Elastic, None),
        law(Tension::CutOff, None),
        law(Tension::Elastic, friction(0.0, 0.0)),
        law(Tension::Elastic, friction(0.3, 0.0)),
        law(Tension::CutOff, friction(0.2, 1e5)),
        law(bond, friction(0.0, 1e5)),
    ];
    for law in laws {
        let mut path = Driven::new(law);
        path.go(DVec3::new(3e-5, 0.0, -2e-5));
        for jump in [
            DVec3::new(4e-5, 1e-5, -3e-5),
            DVec3::new(9e-4, 4e-4, -5e-5),
            DVec3::new(2e-5, -1e-5, 2e-5),
            DVec3::new(2e-5, -1e-5, 1.5e-4),
        ] {
            let state = path.at(jump);
            let tangent = law.tangent(&state, &path.history, NORMAL, 1e20);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let h = 1e-10 * axis;
                let moved = path.at(jump + h).traction(NORMAL) - path.at(jump - h).traction(NORMAL);
                let difference = moved / 2e-10 - tangent.exact * axis;
                assert!(
                    difference.length() < 1e-4 * 3e10,
                    "{law:?} at {jump}: {difference}"
                );
            }
        }
    }
}

/// Contact without a stiffness: the walls touch and carry, or part and do not.
#[test]
fn contact_touches_or_parts() {
    let contact = Closure::contact(1e-3);
    for (load, opening, traction) in [(-2e6, -1e-3, -1e6), (-5e5, -5e-4, 0.0), (2e6, 2e-3, 0.0)] {
        let found = contact.balanced_after(&contact.spring(1e9, load), 0.0);
        close(found.separation.opening, opening, 1e-15);
        assert_eq!(found.traction, traction);
    }
    assert_eq!(contact.balanced(1e9, -2e6).aperture, 0.0);
}
