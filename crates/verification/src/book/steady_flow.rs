//! Steady flow in rigid rock: a channel, a star of half planes, a wedge, a fluid at rest.

use glam::DVec3;
use kluft_chart::{Axis, Chart, Rate, Series};
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use kluft_solver::Conduit;

use crate::report::{Effort, Finding, Study, Table, largest, percent};
use crate::scenes::flow::{
    ARMS, VISCOSITY, apertures, block, channel, on_side, solved, star, water,
};

pub const PAGE: Study = Study {
    name: "steady-flow",
    title: "Steady flow in rigid rock",
    subject: "the cubic law integrated by hand",
    run,
};

const CLOSED_FORM: &str = "
With T = b^3/(12 mu), mu = 1e-3 Pa s, and per metre of height:

    channel    b 1e-4 m, 2 m long, 1e5 Pa           Q = T dp/L                      4.166667e-6 m3/s
    star       b (1, 2, 0.5, 1.5)e-4 m, arms 1 m,   p = sum T p/sum T
               ends at (3, 1, 0, 2)e5 Pa            of the first 2, 3, 4 arms       1.222222e5, 1.205479e5, 1.420000e5 Pa
    at rest    10 m deep, closed, 1000 kg/m3        p = rho g depth                 9.810000e4 Pa, nothing flows
    wedge      b from b1 = 1e-4 to b2 = 2e-4 m      b_h^3 = 2 b1^2 b2^2/(b1 + b2)   Q = 1.111111e-5 m3/s
               over 2 m, 1e5 Pa                     p = dp (b^-2 - b2^-2)/(b1^-2 - b2^-2)";

/// Shapes of cells whose faces the fractures are.
const SHAPES: [Shape; 6] = [
    Shape::Tet4,
    Shape::Tet10,
    Shape::Hex8,
    Shape::Hex20,
    Shape::Hex27,
    Shape::Prism6,
];

/// Errors of one case that any mesh must reproduce.
struct Exact {
    what: String,
    shape: Shape,
    unknowns: usize,
    /// Of rates (as shares of the largest) and pressures (as shares of the largest difference).
    errors: [f64; 2],
    mass_error: f64,
}

fn of_channel(shape: Shape) -> Exact {
    let mesh = channel(shape, 6);
    let ends = vec![
        on_side(&mesh, "side left", 1e5),
        on_side(&mesh, "side right", 0.0),
    ];
    let flow = water(&mesh, ends);
    let solved = solved(&mesh, &flow, &apertures(&mesh, |_, _| 1e-4));
    let expected = 1e-12 * 1e5 / (12.0 * VISCOSITY * 2.0);
    Exact {
        what: "channel".into(),
        shape,
        unknowns: solved.system.unknown_count(),
        errors: [
            (solved.state.conditions[0].rate / expected - 1.0).abs(),
            solved.pressure_error(&mesh, |x| 1e5 * (1.0 - 0.5 * x.x)) / 1e5,
        ],
        mass_error: solved.state.balance.mass_error,
    }
}

/// The star with so many arms; the others are sealed.
fn of_star(shape: Shape, count: usize) -> Exact {
    let (widths, ends) = ([1e-4, 2e-4, 0.5e-4, 1.5e-4], [3e5, 1e5, 0.0, 2e5]);
    let mesh = star(shape, 0.0);
    let arms = ARMS.iter().zip(ends).take(count);
    let conditions = arms.map(|(arm, end)| on_side(&mesh, &format!("side {arm}"), end));
    let mut flow = water(&mesh, conditions.collect());
    let arm = |fracture: usize| {
        let name = &mesh.fractures[fracture];
        ARMS.iter().position(|arm| arm == name).expect("an arm")
    };
    for (fracture, conduit) in flow.conduits.iter_mut().enumerate() {
        if arm(fracture) >= count {
            *conduit = Conduit::Sealed;
        }
    }
    let solved = solved(
        &mesh,
        &flow,
        &apertures(&mesh, |_, fracture| widths[arm(fracture)]),
    );
    let conducts = widths.map(|width: f64| width.powi(3) / (12.0 * VISCOSITY));
    let whole: f64 = conducts[..count].iter().sum();
    let terms = conducts.iter().zip(ends).take(count);
    let line = terms.map(|(conducts, end)| conducts * end).sum::<f64>() / whole;
    let rates: Vec<f64> = (0..count)
        .map(|arm| conducts[arm] * (ends[arm] - line))
        .collect();
    let found = solved.state.conditions.iter().zip(&rates);
    let off = largest(found.map(|(found, expected)| (found.rate - expected).abs()));
    let pressure = |x: DVec3| {
        let along = x - DVec3::new(1.0, 1.0, x.z);
        let lengths = [-along.x, along.x, -along.y, along.y];
        let own = lengths.into_iter().zip(ends);
        own.fold(line, |sum, (length, end)| {
            sum + length.max(0.0) * (end - line)
        })
    };
    Exact {
        what: format!("star of {count} half planes"),
        shape,
        unknowns: solved.system.unknown_count(),
        errors: [
            off / largest(rates.iter().map(|rate| rate.abs())),
            solved.pressure_error(&mesh, pressure) / 3e5,
        ],
        mass_error: solved.state.balance.mass_error,
    }
}

/// A closed channel that stands upright, as wide as by chance; a rate is a share of what its weight
/// would drive.
fn at_rest(shape: Shape) -> Exact {
    let surfaces = [
        Patch::new("joint", &|x| x[0] == 0.5),
        Patch::new("side top", &|x| x[2] == 10.0),
    ];
    let bend = |[x, y, z]: [f64; 3]| [x, y, z + 0.3 * (5.0 * y).sin() * (0.1 * z * (10.0 - z))];
    let mesh = block(shape, ([2, 3, 8], [1.0, 1.0, 10.0]), &surfaces, bend);
    let mut flow = water(&mesh, vec![on_side(&mesh, "side top", 0.0)]);
    flow.fluid.density = 1000.0;
    flow.gravity = DVec3::new(0.0, 0.0, -9.81);
    let widths = apertures(&mesh, |x, _| 1e-4 * (1.1 + (7.0 * x.z + 3.0 * x.y).sin()));
    let solved = solved(&mesh, &flow, &widths);
    let fluxes = solved.system.fields(&solved.state, &widths).fluxes;
    let by_weight = 1e-12 / (12.0 * VISCOSITY) * 9810.0;
    Exact {
        what: "fluid at rest".into(),
        shape,
        unknowns: solved.system.unknown_count(),
        errors: [
            largest(fluxes.iter().map(|flux| flux.length())) / by_weight,
            solved.pressure_error(&mesh, |x| 9810.0 * (10.0 - x.z)) / 9.81e4,
        ],
        mass_error: solved.state.balance.mass_error,
    }
}

fn exact_cases(shapes: &[Shape]) -> Vec<Exact> {
    let of = |&shape: &Shape| {
        let stars = [2, 3, 4].map(|count| of_star(shape, count));
        [of_channel(shape), at_rest(shape)].into_iter().chain(stars)
    };
    shapes.iter().flat_map(of).collect()
}

/// Errors of the wedge on one mesh.
struct Wedge {
    shape: Shape,
    size: f64,
    unknowns: usize,
    /// Of the rate and of the pressure, as shares.
    errors: [f64; 2],
}

fn wedge(shape: Shape, n: usize) -> Wedge {
    let mesh: Mesh = channel(shape, n);
    let ends = vec![
        on_side(&mesh, "side left", 1e5),
        on_side(&mesh, "side right", 0.0),
    ];
    let flow = water(&mesh, ends);
    let width = |x: f64| 1e-4 * (1.0 + 0.5 * x);
    let solved = solved(&mesh, &flow, &apertures(&mesh, |x, _| width(x.x)));
    let square: f64 = 2.0 * 1e-8 * 4e-8 / 3e-4;
    let expected = square * 1e5 / (12.0 * VISCOSITY * 2.0);
    let term = |b: f64| b.powi(-2);
    let pressure = |x: DVec3| 1e5 * (term(width(x.x)) - term(2e-4)) / (term(1e-4) - term(2e-4));
    Wedge {
        shape,
        size: 1.0 / n as f64,
        unknowns: solved.system.unknown_count(),
        errors: [
            (solved.state.conditions[0].rate / expected - 1.0).abs(),
            solved.pressure_error(&mesh, pressure) / 1e5,
        ],
    }
}

fn exact_table(cases: &[Exact]) -> Table {
    let mut table = Table::new(&["flow", "cells", "unknowns", "rates", "pressures", "mass"]);
    for case in cases {
        table.push([
            case.what.clone(),
            format!("{:?}", case.shape),
            case.unknowns.to_string(),
            format!("{:.0e}", case.errors[0]),
            format!("{:.0e}", case.errors[1]),
            format!("{:.0e}", case.mass_error),
        ]);
    }
    table
}

/// Order in which an error falls from one mesh to the next.
fn order(before: Option<&Wedge>, case: &Wedge, which: usize) -> f64 {
    before.map_or(f64::NAN, |before| {
        (before.errors[which] / case.errors[which]).ln() / (before.size / case.size).ln()
    })
}

fn wedge_table(cases: &[Wedge]) -> Table {
    let mut table = Table::new(&[
        "cells",
        "size (m)",
        "unknowns",
        "rate",
        "its order",
        "pressures",
        "their order",
    ]);
    for (index, case) in cases.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| &cases[before]);
        let before = before.filter(|before| before.shape == case.shape);
        let orders = [0, 1].map(|which| match order(before, case, which) {
            order if order.is_finite() => format!("{order:.2}"),
            _ => String::new(),
        });
        let [of_rate, of_pressure] = orders;
        table.push([
            format!("{:?}", case.shape),
            case.size.to_string(),
            case.unknowns.to_string(),
            format!("{:.2e}", case.errors[0]),
            of_rate,
            format!("{:.2e}", case.errors[1]),
            of_pressure,
        ]);
    }
    table
}

fn chart(cases: &[Wedge]) -> Chart {
    let names = ["rate", "pressures"];
    let series = [Shape::Tet4, Shape::Hex8].into_iter().flat_map(|shape| {
        names.iter().enumerate().map(move |(which, name)| {
            let own = cases.iter().filter(|case| case.shape == shape);
            let facets = if shape == Shape::Tet4 {
                "triangles"
            } else {
                "quadrangles"
            };
            let points = own.map(|case| (case.size, case.errors[which])).collect();
            Series::line(format!("{name}, {facets}"), points)
        })
    });
    Chart {
        series: series.collect(),
        rates: vec![Rate {
            series: 0,
            rate: 2.0,
        }],
        ..Chart::new(
            "Flow through a wedge: errors over the size of facets",
            Axis::logarithmic("size of facets (m)"),
            Axis::logarithmic("error (relative)"),
        )
    }
}

const PROBLEM: &str = "Blocks of tetrahedra, hexahedra and prisms of both orders, their nodes pushed \
    about in the planes of the fractures, which are triangles and quadrangles. The rock is rigid and \
    conducts nothing.";

fn run(effort: Effort) -> Finding {
    let (shapes, sizes): (&[Shape], &[usize]) = match effort {
        Effort::Quick => (&SHAPES[..1], &[4, 8]),
        Effort::Full => (&SHAPES, &[4, 8, 16, 32, 64]),
    };
    let cases = exact_cases(shapes);
    let wedges: Vec<Wedge> = [Shape::Tet4, Shape::Hex8]
        .into_iter()
        .flat_map(|shape| sizes.iter().map(move |&n| wedge(shape, n)))
        .collect();
    let worst = largest(cases.iter().flat_map(|case| case.errors));
    let mass = largest(cases.iter().map(|case| case.mass_error));
    let finest = wedges
        .iter()
        .filter(|case| case.size == 1.0 / sizes[sizes.len() - 1] as f64);
    let finest: Vec<&Wedge> = finest.collect();
    let wedge_error = largest(finest.iter().flat_map(|case| case.errors));
    let pairs = wedges
        .windows(2)
        .filter(|pair| pair[0].shape == pair[1].shape);
    let orders = pairs.flat_map(|pair| [0, 1].map(|which| order(Some(&pair[0]), &pair[1], which)));
    let lowest = orders.fold(f64::INFINITY, f64::min);
    let unknowns = wedges.iter().map(|case| case.unknowns).max().unwrap_or(0);
    Finding::new([
        format!("linear pressures {worst:.0e}; the wedge {}", percent(wedge_error)),
        unknowns.to_string(),
    ])
    .text(PROBLEM)
    .closed_form(CLOSED_FORM, PAGE.subject)
    .text("Pressures that are linear in each fracture:")
    .table_in("steady-flow-exact", exact_table(&cases))
    .text("The wedge:")
    .chart("steady-flow", chart(&wedges))
    .table(wedge_table(&wedges))
    .shows(format!(
        "Where pressures are linear, or the fluid is at rest, rates and pressures are exact on every \
         mesh: the largest error is {worst:.0e}, and at most {mass:.0e} of what flows is missing at \
         nodes. Intersections, which have no unknowns of their own, are as exact. In the wedge rate \
         and pressures converge with at least the order {lowest:.2}; at the finest mesh they are \
         {} off at most.",
        percent(wedge_error)
    ))
}
