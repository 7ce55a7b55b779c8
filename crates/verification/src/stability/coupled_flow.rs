//! Flow that follows the walls: time steps, openings, closing with trapped fluid, reversal, small
//! angles, closed networks, threads.

use kluft_mesh::Shape;
use kluft_solver::{Condition, Discretisation, Field, Fracture, Problem, Support, System};
use lie_core::{Closure, FractureLaw};

use crate::report::{Effort, Finding, Study, largest};
use crate::scenes::flow::{ARMS, on_side, star, water};
use crate::scenes::flowing_cube::{PRESSURE, Trial, cube};
use crate::scenes::soft_slabs::{
    DRIVEN, as_given, equal_steps, path, problem, steady, strip, times,
};
use crate::scenes::{EXACT, ROCK};

use super::coupled_linear;
use super::coupled_steps::{Case, chart, table, text};
use super::coupled_sweeps::sweeps;
use super::coupled_walks;

/// The study.
pub const STUDY: Study = Study {
    name: "coupled-flow",
    title: "Flow that opens and closes its joints",
    subject: "time steps over 18 decades, joints closed to a millionth that open, drawdown, loads \
              of 0.1 to 100 K_n b0 on trapped fluid, rock of 10 MPa to 10 TPa, meshes of 8 to 64 \
              cells across, paths of small steps, crossing angles from 90 to 2 degrees, closed \
              networks, threads",
    run,
};

/// A strip that is pumped up and let off again and again; how far the last state of full pressure
/// is from the first.
fn reversed() -> (Case, f64) {
    let mesh = strip(Shape::Hex8, 20, [2.0, 0.1], 1.0);
    let closure = Closure::new(1e-4, 1e11, EXACT);
    let factors = [1.0, 0.1, 1.0, 0.1, 1.0];
    let schedule = times((1..).map(|turn| 1e6 * f64::from(turn)).zip(factors));
    let problem = problem(&mesh, closure, 30e6, schedule);
    let mut driven = on_side(&mesh, "side left", 25e6);
    driven.case = DRIVEN;
    let mut flow = water(&mesh, vec![driven]);
    flow.initial_pressure = Field::constant(10e6);
    let path = path(&problem, &flow, as_given());
    let apart = match &path.frames[..] {
        [first, .., last] => {
            let pairs = first.apertures.iter().zip(&last.apertures);
            largest(pairs.map(|(first, last)| (last / first - 1.0).abs()))
        }
        _ => f64::NAN,
    };
    let what = "25 and 2.5 MPa in turn".to_owned();
    (Case::of("reversal", what, 1.0, (&path, 2.68e-5)), apart)
}

/// Four half planes in rock that is held around them, fed from one side.
fn crossing(angle: f64) -> Case {
    let mesh = star(Shape::Tet4, 1.0 / angle.to_radians().tan());
    let law = FractureLaw::elastic(Closure::new(1e-4, 1e10, EXACT), 1e10);
    let held = |boundary: usize| Condition {
        boundary,
        load: None,
        support: Some(Support::Displacement([Some(0.0); 3])),
    };
    let fracture = Fracture {
        law,
        fluid_pressure: 0.0,
    };
    let problem = Problem {
        fractures: vec![fracture; mesh.fractures.len()],
        conditions: (0..mesh.boundaries.len()).map(held).collect(),
        schedule: equal_steps(4, 1.0),
        ..Problem::of_rock(mesh.clone(), ROCK)
    };
    let side = format!("side {}", ARMS[0]);
    let flow = water(&mesh, vec![on_side(&mesh, &side, 1e6)]);
    let path = path(&problem, &flow, as_given());
    Case::of("crossing", format!("{angle} degrees"), angle, (&path, 1e-4))
}

/// Pressure of a fluid that cannot leave under a load (as a share of what it should be off), and
/// how rough it is from node to node.
fn undrained(shape: Shape) -> [f64; 2] {
    let trial = Trial {
        load: Some(1e6),
        ..Trial::of(1e10, Some(1e-9))
    };
    let path = trial.taken(&cube(shape, 4));
    let pressures = &path.end().flow.pressures;
    let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
    let rough = largest(pressures.iter().map(|p| (p - mean).abs()));
    [
        ((mean - PRESSURE) / 1e6 - 1.0).abs(),
        rough / (mean - PRESSURE).abs(),
    ]
}

/// What is said of a joint without any pressure in steady flow.
fn isolated() -> Option<String> {
    let trial = Trial::of(1e10, None);
    let mesh = cube(Shape::Hex8, 2);
    let problem = trial.problem(&mesh, steady());
    let flow = trial.flow(&mesh);
    let discretisation = Discretisation::of(&problem).ok()?;
    let mut system = System::assemble(&problem, discretisation);
    let defects = system.couple(&flow).err()?;
    let said = defects.iter().map(ToString::to_string);
    Some(said.collect::<Vec<String>>().join(" "))
}

/// Whether numbers of threads give the same bits.
fn threads_agree() -> bool {
    let trial = Trial {
        inlet: Some(15e6),
        ..Trial::of(1e10, Some(1.0))
    };
    let bits = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let path = pool
            .build()
            .expect("threads")
            .install(|| trial.taken(&cube(Shape::Tet4, 6)));
        let end = path.end();
        let numbers = end.flow.pressures.iter().chain(&end.apertures);
        numbers.map(|number| number.to_bits()).collect::<Vec<u64>>()
    });
    bits[0] == bits[1] && bits[0] == bits[2]
}

/// What does not hold beside the steps: how far reversal leads `apart`, how far `off` and `rough` a
/// trapped pressure is, a closed network, threads.
fn unheld([apart, off, rough]: [f64; 3]) -> Vec<String> {
    let said = isolated();
    let mut misses = Vec::new();
    let mut hold = |holds: bool, what: String| {
        if !holds {
            misses.push(what);
        }
    };
    hold(
        apart < 1e-6,
        format!("reversal: states differ by {apart:.1e}"),
    );
    hold(
        rough < 1e-6,
        format!("undrained: pressures are rough by {rough:.1e}"),
    );
    hold(
        off < 1e-6,
        format!("undrained: the pressure is {off:.1e} off"),
    );
    hold(
        said.as_ref().is_some_and(|said| said.contains("`joint`")),
        format!("a closed network in steady flow: {said:?}"),
    );
    hold(threads_agree(), "threads: other bits".to_owned());
    misses
}

fn run(effort: Effort) -> Finding {
    let (reversed, apart) = reversed();
    let angles: &[f64] = match effort {
        Effort::Quick => &[90.0, 2.0],
        Effort::Full => &[90.0, 45.0, 20.0, 10.0, 5.0, 2.0],
    };
    let mut cases = sweeps(effort);
    cases.extend(coupled_walks::paths(effort));
    cases.push(reversed);
    cases.extend(angles.iter().map(|&angle| crossing(angle)));
    let rough = [Shape::Tet4, Shape::Hex8, Shape::Prism6].map(undrained);
    let [off, rough] = [0, 1].map(|which| largest(rough.map(|found| found[which])));
    let linear = coupled_linear::sweep(effort);
    let walks = coupled_walks::walks(effort);
    let mut misses: Vec<String> = cases.iter().filter_map(Case::miss).collect();
    misses.extend(linear.misses());
    misses.extend(walks.misses());
    misses.extend(unheld([apart, off, rough]));
    let most = cases.iter().filter(|case| case.converged).map(Case::most);
    let most = most.max().unwrap_or(0);
    let refused = cases.iter().filter(|case| !case.converged).count();
    Finding::new([
        "Newton at the aperture that balances the rock: negative transmissivities; fluid and rock \
         in turn: no convergence where the fluid hardly compresses"
            .to_owned(),
        format!(
            "at most {most} iterations a part, {refused} of {} refused",
            cases.len()
        ),
    ])
    .text(text(&cases, [apart, off, rough]))
    .chart("coupled-flow", chart(&cases))
    .table(table(&cases))
    .text(linear.text())
    .table_in("coupled-flow-linear", linear.table())
    .text(format!(
        "{} {}",
        coupled_walks::text_of_paths(&cases),
        walks.text()
    ))
    .table_in("coupled-flow-walks", walks.table())
    .missing(misses)
}
