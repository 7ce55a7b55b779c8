//! The factor of safety against limit equilibrium.

use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_run::{Ending, MeshInput, Request, StrengthSummary, run};
use kluft_scene::Scene;

/// A block of half a unit cube on a plane that dips 25 degrees (gravity is turned instead), held by
/// friction, cohesion (Pa) and under water of some pressure (Pa) in the plane.
struct Slide {
    friction: f64,
    cohesion: f64,
    water: f64,
}

const DIP: f64 = 25.0;
/// Weight of the upper half (N).
const WEIGHT: f64 = 0.5 * 2700.0 * 9.81;

impl Slide {
    /// `((W cos - U) tan phi + c A) / (W sin)`.
    fn limit_equilibrium(&self) -> f64 {
        let (sin, cos) = DIP.to_radians().sin_cos();
        let across = WEIGHT * cos - self.water;
        (across * self.friction.to_radians().tan() + self.cohesion) / (WEIGHT * sin)
    }

    fn found(&self) -> StrengthSummary {
        let (sin, cos) = DIP.to_radians().sin_cos();
        let text = format!(
            "title = \"slide\"\n[mesh]\nfile = \"in memory.msh\"\n\
             [rock.default]\nyoung_modulus = 1e9\npoisson_ratio = 0.2\ndensity = 2700\n\
             [body]\ngravity = [{}, 0, {}]\n\
             [fracture.plane]\naperture = 1e-3\nnormal_stiffness = 1e9\nshear_stiffness = 1e9\n\
             closure = \"logarithmic\"\nfriction_angle = {}\ncohesion = {}\nfluid_pressure = {}\n\
             [boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
             [strength_reduction]\nfractures = [\"plane\"]\naccuracy = 1e-3\n",
            9.81 * sin,
            -9.81 * cos,
            self.friction,
            self.cohesion,
            self.water
        );
        let scene = Scene::parse(&text, "a scene in memory", std::path::Path::new("."));
        let scene = scene.unwrap_or_else(|defects| panic!("{defects:?}"));
        let patches = [
            Patch::new("plane", &|x| x[2] == 0.5),
            Patch::new("bottom", &|x| x[2] == 0.0),
        ];
        let draft = tetrahedra([3, 3, 4], [1.0; 3], &patches);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
        let pool = pool.expect("threads");
        let mesh = MeshInput::Draft(Box::new(draft));
        let done = run(Request::in_memory(&scene, mesh, &pool), &mut ());
        let done = done.unwrap_or_else(|defects| panic!("{defects:?}"));
        assert_eq!(done.ending, Ending::Solved);
        done.summary.strength_reduction.expect("a factor of safety")
    }
}

/// The block slides as a whole, whatever the distribution of tractions: the factor is that of limit
/// equilibrium, within the accuracy asked for.
#[test]
fn a_block_on_a_plane_slides_at_the_factor_of_limit_equilibrium() {
    let cases = [
        Slide {
            friction: 40.0,
            cohesion: 0.0,
            water: 0.0,
        },
        Slide {
            friction: 35.0,
            cohesion: 3e3,
            water: 0.0,
        },
        Slide {
            friction: 45.0,
            cohesion: 0.0,
            water: 2e3,
        },
    ];
    for case in cases {
        let (found, wanted) = (case.found(), case.limit_equilibrium());
        let failing = found.failing.expect("it slides in the end");
        println!(
            "{wanted}: {} to {failing}, {:?}",
            found.stable, found.trials
        );
        assert!(
            found.stable <= wanted * (1.0 + 1e-6) && wanted <= failing * (1.0 + 1e-6),
            "{} to {failing} does not hold {wanted}",
            found.stable
        );
        assert!(failing - found.stable <= 1.001e-3 * found.stable);
        let said = found.free_blocks.join("; ");
        assert!(said.contains("plane"), "{said}: names what let go");
    }
}
