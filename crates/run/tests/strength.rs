//! The factor of safety against limit equilibrium.

use kluft_mesh::Defect;
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_run::{Ending, MeshInput, Outcome, Request, StrengthSummary, run};
use kluft_scene::Scene;

/// A block of half a unit cube on a plane that dips 25 degrees (gravity is turned instead), held by
/// friction, cohesion (Pa) and under water of some pressure (Pa) in the plane.
struct Slide {
    friction: f64,
    cohesion: f64,
    water: f64,
    /// Whether the water flows there, along the plane, from one edge to the other at that pressure.
    flows: bool,
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

    /// What the scene says of the water: of the fracture, and in sections behind it.
    fn fluid(&self) -> String {
        let pressure = format!("fluid_pressure = {}\n", self.water);
        match self.flows {
            true => format!(
                "hydraulic_aperture = 1e-4\n[fluid]\nviscosity = 1e-3\ndensity = 1000\n\
                 [boundary.left]\n{pressure}[boundary.right]\n{pressure}"
            ),
            false => pressure,
        }
    }

    fn text(&self) -> String {
        let (sin, cos) = DIP.to_radians().sin_cos();
        format!(
            "title = \"slide\"\n[mesh]\nfile = \"in memory.msh\"\n\
             [rock.default]\nyoung_modulus = 1e9\npoisson_ratio = 0.2\ndensity = 2700\n\
             [body]\ngravity = [{}, 0, {}]\n\
             [fracture.plane]\naperture = 1e-3\nnormal_stiffness = 1e9\nshear_stiffness = 1e9\n\
             closure = \"logarithmic\"\nfriction_angle = {}\ncohesion = {}\n{}\
             [boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
             [strength_reduction]\nfractures = [\"plane\"]\naccuracy = 1e-3\n",
            9.81 * sin,
            -9.81 * cos,
            self.friction,
            self.cohesion,
            self.fluid()
        )
    }

    fn found(&self) -> StrengthSummary {
        let done = solve(&self.text()).unwrap_or_else(|defects| panic!("{defects:?}"));
        assert_eq!(done.ending, Ending::Solved);
        done.summary.strength_reduction.expect("a factor of safety")
    }
}

fn solve(text: &str) -> Result<Outcome, Vec<Defect>> {
    let scene = Scene::parse(text, "a scene in memory", std::path::Path::new("."))?;
    let patches = [
        Patch::new("plane", &|x| x[2] == 0.5),
        Patch::new("bottom", &|x| x[2] == 0.0),
        Patch::new("left", &|x| x[0] == 0.0),
        Patch::new("right", &|x| x[0] == 1.0),
    ];
    let draft = tetrahedra([3, 3, 4], [1.0; 3], &patches);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let pool = pool.expect("threads");
    let mesh = MeshInput::Draft(Box::new(draft));
    run(Request::in_memory(&scene, mesh, &pool), &mut ())
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
            flows: false,
        },
        Slide {
            friction: 35.0,
            cohesion: 3e3,
            water: 0.0,
            flows: false,
        },
        Slide {
            friction: 45.0,
            cohesion: 0.0,
            water: 2e3,
            flows: false,
        },
        // Between equal pressures at both edges its own weight drives it, and the pressure is the
        // same all along.
        Slide {
            friction: 45.0,
            cohesion: 0.0,
            water: 2e3,
            flows: true,
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

/// Pressures that change with the motion of the walls are not those at which strength is reduced.
#[test]
fn pressures_that_follow_the_walls_are_refused() {
    let flowing = Slide {
        friction: 45.0,
        cohesion: 0.0,
        water: 2e3,
        flows: true,
    };
    let text = flowing.text().replace("hydraulic_aperture = 1e-4\n", "");
    let defects = solve(&text).expect_err("pressures that follow the walls");
    assert_eq!(defects.len(), 1, "{defects:?}");
    let said = defects[0].to_string();
    for text in [
        "strength is reduced",
        "follow the walls",
        "hydraulic_aperture",
    ] {
        assert!(said.contains(text), "{text}: {said}");
    }
}
