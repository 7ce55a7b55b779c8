//! A tunnel that is excavated at once, in stages, and lined.

use crate::oracles::tunnel::{Isotropic, Tunnel};
use crate::report::{Effort, Finding, Study, Table, largest, percent};

use super::refinement::{Refinement, Shown, largest_left};
use super::scene::{self, Outcome};

pub const PAGE: Study = Study {
    name: "excavation",
    title: "A tunnel excavated in stages and lined",
    subject: "G. Kirsch, Zeitschrift des VDI 42, 1898; J. H. Michell, Proceedings of the London \
              Mathematical Society 31, 1899",
    run,
};

const PROBLEM: &str = "The scene `geometries/lined-tunnel`: a slice through a tunnel of 3 m radius \
    under 7.5 MPa from the sides and 5 MPa from above, held at 90 m; cells of second order, `h` at \
    the wall. Core and a ring of 0.3 m around it are removed; with lining the ring is added in the \
    same phase as concrete. Errors are those of the displacement of the wall at side and crown, the \
    larger one.";

const CLOSED_FORM: &str = "
Airy's function without and with cos 2 theta has two coefficients of each layer for the mean of the stresses and four for
their difference. They follow from

    at 90 m                    u_r = u_t = 0
    where ring and rock meet   u_r, u_t the same, tractions with that of the initial stress in balance
    at the inner wall          no traction

Elastic rock forgets in how many phases its walls let go, and in which order.";

const ROCK: Isotropic = Isotropic {
    young_modulus: 5e9,
    poisson_ratio: 0.25,
};
const CONCRETE: Isotropic = Isotropic {
    young_modulus: 25e9,
    poisson_ratio: 0.2,
};

/// What the scene says of its only phase.
const AT_ONCE: &str = "remove = [\"core\", \"ring\"]\nadd = [\"ring\"]\nadded_as = \"concrete\"\n";
/// A phase that makes the tunnel and nothing more.
const REMOVE: &str = "remove = [\"core\", \"ring\"]\n";
/// What a scene without lining does not need.
const SECTION: &str = "[rock.concrete]\nyoung_modulus = 25e9\npoisson_ratio = 0.2\n\n";

/// Share that the wall lets go before a lining that comes late.
const BEFORE: f64 = 0.4;

fn closed_form(lining: Option<(f64, Isotropic)>) -> [f64; 2] {
    let tunnel = Tunnel {
        radius: 3.0,
        held: 90.0,
        rock: ROCK,
        lining,
        stress: [-7.5e6, -5e6],
    };
    tunnel.wall()
}

fn tunnel(size: f64, phases: &str, is_lined: bool) -> Outcome {
    let mesh = format!("parameters = {{ h = {size} }}\norder = 2");
    let phases = (AT_ONCE, phases);
    match is_lined {
        true => scene::run_edited("lined-tunnel", &mesh, &[phases]),
        false => scene::run_edited("lined-tunnel", &mesh, &[phases, (SECTION, "")]),
    }
}

fn wall(outcome: &Outcome) -> [f64; 2] {
    let places = [("side", "displacement_x"), ("crown", "displacement_z")];
    places.map(|(probe, column)| outcome.probed(probe, column))
}

fn apart(found: [f64; 2], wanted: [f64; 2]) -> f64 {
    largest(std::iter::zip(found, wanted).map(|(found, wanted)| (found / wanted - 1.0).abs()))
}

/// Runs whose phases differ from those at once, each with what the wall should do.
fn staged(size: f64, [bare, lined]: [[f64; 2]; 2]) -> Vec<(&'static str, [f64; 2], [f64; 2])> {
    let phase = |name: &str, until: usize, rest: &str| {
        format!("\n[[load.phase]]\nname = \"{name}\"\nuntil = {until}\n{rest}")
    };
    let released = format!(
        "{REMOVE}release = 0.3\nsteps = 3\n{}",
        phase("rest", 2, "steps = 2\n")
    );
    let core_first = format!(
        "remove = [\"core\"]\nrelease = 0.5\n{}",
        phase("ring", 2, "remove = [\"ring\"]\n")
    );
    let ring_first = format!(
        "remove = [\"ring\"]\n{}",
        phase("core", 2, "remove = [\"core\"]\nsteps = 2\n")
    );
    let late = format!(
        "{REMOVE}release = {BEFORE}\n{}",
        phase("lining", 2, "add = [\"ring\"]\nadded_as = \"concrete\"\n")
    );
    let at_once = wall(&tunnel(size, REMOVE, false));
    let mixed = [0, 1].map(|place| BEFORE * bare[place] + (1.0 - BEFORE) * lined[place]);
    let run = |phases: &str, is_lined| wall(&tunnel(size, phases, is_lined));
    vec![
        (
            "30 % in three steps, then the rest",
            run(&released, false),
            at_once,
        ),
        (
            "core first, half of it, then the ring",
            run(&core_first, false),
            at_once,
        ),
        (
            "ring first, then the core",
            run(&ring_first, false),
            at_once,
        ),
        ("lined after 40 %", run(&late, true), mixed),
    ]
}

const SHOWN: Shown = Shown {
    file: "excavation",
    title: "Displacement of the wall: error over the size of cells",
    size: "size of cells at the wall (m)",
    rate: Some(3.0),
};

fn run(effort: Effort) -> Finding {
    let sizes: &[f64] = match effort {
        Effort::Quick => &[1.2, 0.6],
        Effort::Full => &[1.2, 0.6, 0.3, 0.15],
    };
    let bare = closed_form(None);
    let lined = closed_form(Some((2.7, CONCRETE)));
    let cases = [("without lining", REMOVE, bare), ("lined", AT_ONCE, lined)];
    let mut unknowns = 0;
    let refinements = cases.map(|(name, phases, wanted)| {
        let errors = sizes.iter().map(|&size| {
            let outcome = tunnel(size, phases, phases == AT_ONCE);
            unknowns = unknowns.max(outcome.unknowns());
            (size, apart(wall(&outcome), wanted))
        });
        Refinement::of(name, errors.collect::<Vec<_>>())
    });
    let mut table = Table::new(&[
        "phases",
        "u_x at the side, m",
        "u_z at the crown, m",
        "apart",
    ]);
    let staged = staged(0.3, [bare, lined]);
    for (name, found, wanted) in &staged {
        let [side, crown] = found.map(|value| format!("{value:.9e}"));
        let apart = format!("{:.1e}", apart(*found, *wanted));
        table.push([(*name).to_owned(), side, crown, apart]);
    }
    let forgot = largest(
        staged[..3]
            .iter()
            .map(|(_, found, wanted)| apart(*found, *wanted)),
    );
    let reached = format!(
        "wall {}, order of cuts {forgot:.0e}",
        percent(largest_left(&refinements))
    );
    let page = Finding::new([reached, unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject);
    SHOWN
        .on(page, &refinements)
        .text(
            "With h = 0.3 m, phases that end at the same body. The first three are compared with the \
             removal of all at once on the same mesh, the last with 40 % of the closed form without \
             lining and 60 % of that with it:",
        )
        .table_in("excavation-stages", table)
        .shows(format!(
            "The wall of the tunnel is within {} of the closed forms on the finest mesh, with and \
             without lining. The same body after other phases has moved the same to {forgot:.0e}.",
            percent(largest_left(&refinements))
        ))
}
