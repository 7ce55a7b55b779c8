//! Steady flow: fractures that cross at a small angle, obtuse and flat facets, boreholes.

use glam::DVec3;
use kluft_chart::{Axis, Chart, Series};
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use kluft_solver::{Field, FlowDrive};

use crate::report::{Effort, Finding, Study, Table, largest, percent};
use crate::scenes::flow::{ARMS, VISCOSITY, apertures, block, on_side, solved, star, water, well};

/// The study.
pub const STUDY: Study = Study {
    name: "flow",
    title: "Steady flow in poor meshes",
    subject: "crossing angles from 90 to 0.1 degrees, facets 1 to 1000 times longer than wide and \
              sheared, boreholes in facets refined 16 times",
    run,
};

/// Error that a flow may show whose pressure is linear: rounding.
const EXACTLY: f64 = 1e-9;
/// Error of the pressure at the wall of a borehole, on the coarsest facets.
const WALL: f64 = 0.01;
/// `K(1/sqrt(2))`, by which `sn^2` maps a square to a half plane; Muskat has 0.6190 for its
/// logarithm.
const ELLIPTIC_INTEGRAL: f64 = 1.854_074_677_301_371_7;
/// Radius of the boreholes (m), and of those in thin facets.
const RADIUS: f64 = 1e-4;
const TINY: f64 = 1e-9;
const WIDTHS: [f64; 4] = [1e-4, 2e-4, 0.5e-4, 1.5e-4];
const ENDS: [f64; 4] = [3e5, 1e5, 0.0, 2e5];

/// Largest error of a rate through a star whose planes cross at an angle (degrees), as a share of
/// the largest, and its mass error.
fn crossing(angle: f64) -> [f64; 2] {
    let lean = 1.0 / angle.to_radians().tan();
    let mesh = star(Shape::Tet4, lean);
    let sides = ARMS.iter().zip(ENDS);
    let sides = sides.map(|(arm, end)| on_side(&mesh, &format!("side {arm}"), end));
    let flow = water(&mesh, sides.collect());
    let arm = |fracture: usize| {
        let name = &mesh.fractures[fracture];
        ARMS.iter().position(|arm| arm == name).expect("an arm")
    };
    let widths = apertures(&mesh, |_, fracture| WIDTHS[arm(fracture)]);
    let solved = solved(&mesh, &flow, &widths);
    let long = (1.0 + lean * lean).sqrt();
    let lengths = [1.0, 1.0, long, long];
    let conducts: Vec<f64> = (0..4)
        .map(|arm| WIDTHS[arm].powi(3) / (12.0 * VISCOSITY * lengths[arm]))
        .collect();
    let whole: f64 = conducts.iter().sum();
    let line = conducts
        .iter()
        .zip(ENDS)
        .map(|(c, end)| c * end)
        .sum::<f64>()
        / whole;
    let rates: Vec<f64> = (0..4)
        .map(|arm| conducts[arm] * (ENDS[arm] - line))
        .collect();
    let found = solved.state.conditions.iter().zip(&rates);
    let off = largest(found.map(|(found, expected)| (found.rate - expected).abs()));
    [
        off / largest(rates.iter().map(|rate| rate.abs())),
        solved.state.balance.mass_error,
    ]
}

/// A channel of 1 m by `1 / aspect` m across the block, sheared along itself.
fn sheared(aspect: f64, shear: f64) -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &|x| x[0] == 1.0),
    ];
    let width = 1.0 / aspect;
    block(
        Shape::Tet4,
        ([8, 8, 2], [1.0, width, 1.0]),
        &surfaces,
        |[x, y, z]| {
            // Nothing at the ends, whose pressures are given.
            let inside = 4.0 * x * (1.0 - x);
            [x + shear * inside * (y - 0.5 * width), y, z]
        },
    )
}

/// What poor facets make of a flow.
struct Facets {
    aspect: f64,
    /// Largest angle of a facet (degrees).
    angle: f64,
    /// Of the rate at a linear pressure.
    error: f64,
    backward: usize,
    /// Share of the nodes whose pressure is below those given, where a borehole in the middle feeds
    /// the channel.
    negative: f64,
}

fn facets(aspect: f64, shear: f64) -> Facets {
    let mesh = sheared(aspect, shear);
    let ends = vec![
        on_side(&mesh, "side left", 1e5),
        on_side(&mesh, "side right", 0.0),
    ];
    let flow = water(&mesh, ends);
    let even = solved(&mesh, &flow, &apertures(&mesh, |_, _| 1e-4));
    let expected = 1e-12 * 1e5 / (12.0 * VISCOSITY * aspect);
    let middle = DVec3::new(0.5, 0.5 / aspect, 0.5);
    let mut fed = vec![
        on_side(&mesh, "side left", 0.0),
        on_side(&mesh, "side right", 0.0),
    ];
    fed.push(well(&mesh, middle, TINY, FlowDrive::Rate(1e-6)));
    let fed = water(&mesh, fed);
    let fed = solved(&mesh, &fed, &apertures(&mesh, |_, _| 1e-4));
    let pressures = &fed.state.pressures;
    let rounding = 1e-12 * largest(pressures.iter().copied());
    let negative = pressures.iter().filter(|pressure| **pressure < -rounding);
    Facets {
        aspect,
        angle: largest_angle(&mesh),
        error: (even.state.conditions[0].rate / expected - 1.0).abs(),
        backward: even.system.backward_edges(),
        negative: negative.count() as f64 / pressures.len() as f64,
    }
}

fn largest_angle(mesh: &Mesh) -> f64 {
    let facets = 0..mesh.facets.elements.len();
    let angles = facets.flat_map(|facet| {
        let x = mesh.corners(&mesh.facets.elements, facet);
        [0, 1, 2].map(|k| {
            (x[(k + 1) % 3] - x[k])
                .angle_between(x[(k + 2) % 3] - x[k])
                .to_degrees()
        })
    });
    largest(angles)
}

/// Pressure between the wells of a five-spot pattern in a quarter of it: at the wall of a borehole
/// and at its node, relative to Muskat's.
fn five_spot(n: usize) -> [f64; 2] {
    let surfaces = [Patch::new("joint", &|x| x[2] == 0.5)];
    let mesh = block(Shape::Hex8, ([n, n, 2], [1.0; 3]), &surfaces, |x| x);
    let producer = FlowDrive::Pressure(Field::constant(0.0));
    let corner = |at: [f64; 2], drive| well(&mesh, DVec3::new(at[0], at[1], 0.5), RADIUS, drive);
    let conditions = vec![
        corner([0.0, 0.0], FlowDrive::Rate(1e-6)),
        corner([1.0, 1.0], producer),
    ];
    let flow = water(&mesh, conditions);
    let solved = solved(&mesh, &flow, &apertures(&mesh, |_, _| 1e-4));
    let conducts = 1e-12 / (12.0 * VISCOSITY);
    let logarithm = (2.0_f64.sqrt() / RADIUS).ln() - ELLIPTIC_INTEGRAL.ln();
    let drop = 4.0 * 1e-6 * logarithm / (std::f64::consts::PI * conducts);
    let at_wall = solved.state.conditions[0].pressure;
    let pressures = &solved.state.pressures;
    let (low, high) = pressures
        .iter()
        .fold((f64::INFINITY, 0.0), |(low, high), &p| {
            (f64::min(low, p), f64::max(high, p))
        });
    [at_wall, high - low].map(|found| (found / drop - 1.0).abs())
}

/// All cases of the study.
struct Cases {
    /// Angles (degrees) with errors of rates and mass.
    crossings: Vec<(f64, [f64; 2])>,
    poor: Vec<Facets>,
    /// Facets along the side with errors at the wall and at the node.
    wells: Vec<(usize, [f64; 2])>,
}

fn cases(effort: Effort) -> Cases {
    let (angles, shapes, sizes): (&[f64], &[(f64, f64)], &[usize]) = match effort {
        Effort::Quick => (&[90.0, 1.0], &[(1.0, 0.0), (100.0, 20.0)], &[8, 16]),
        Effort::Full => (
            &[90.0, 45.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1],
            &[
                (1.0, 0.0),
                (1.0, 0.4),
                (10.0, 0.0),
                (10.0, 4.0),
                (100.0, 0.0),
                (100.0, 4.0),
                (100.0, 20.0),
                (1000.0, 20.0),
            ],
            &[8, 16, 32, 64, 128],
        ),
    };
    let poor = shapes.iter();
    Cases {
        crossings: angles
            .iter()
            .map(|&angle| (angle, crossing(angle)))
            .collect(),
        poor: poor.map(|&(aspect, shear)| facets(aspect, shear)).collect(),
        wells: sizes.iter().map(|&n| (n, five_spot(n))).collect(),
    }
}

impl Cases {
    /// What it says of angles and facets, then of boreholes.
    fn story(&self) -> [String; 2] {
        let crossed = largest(self.crossings.iter().map(|(_, errors)| errors[0]));
        let stretched = largest(self.poor.iter().map(|case| case.error));
        let negative = largest(self.poor.iter().map(|case| case.negative));
        let widest = largest(self.poor.iter().map(|case| case.angle));
        let (first, last) = (&self.wells[0], &self.wells[self.wells.len() - 1]);
        [
            format!(
                "Four half planes that meet in a line exchange fluid through it; where they cross \
                 at a small angle the facets between become long and thin. Rates stay exact, to \
                 {crossed:.0e}, down to {}°. A channel of facets up to {} times longer than wide, \
                 with angles up to {widest:.1}°, has its rate to {stretched:.0e}. Obtuse angles let \
                 some edges drive fluid backwards; `kluft inspect` counts them. They do not spoil \
                 rates, but pressures may lie below all that are given: where a borehole feeds the \
                 middle of the channel, at {} of the nodes at most.",
                self.crossings[self.crossings.len() - 1].0,
                largest(self.poor.iter().map(|case| case.aspect)),
                percent(negative)
            ),
            format!(
                "The pressure at the node of a borehole belongs to a radius that shrinks with the \
                 facets, so that it never converges: in a quarter of the five-spot pattern it is {} \
                 off with {} facets along the side, and {} with {}. The pressure at the wall, which \
                 results tell, is {} off at most (boreholes of 0.1 mm, Muskat's formula).",
                percent(first.1[1]),
                first.0,
                percent(last.1[1]),
                last.0,
                percent(self.at_walls())
            ),
        ]
    }

    fn at_walls(&self) -> f64 {
        largest(self.wells.iter().map(|(_, errors)| errors[0]))
    }
}

fn run(effort: Effort) -> Finding {
    let cases = cases(effort);
    let rates = cases.crossings.iter().map(|(_, errors)| errors[0]);
    let rates = largest(rates.chain(cases.poor.iter().map(|case| case.error)));
    let nodes = cases.wells.iter().map(|(_, errors)| percent(errors[1]));
    let nodes: Vec<String> = nodes.collect();
    let [of_facets, of_wells] = cases.story();
    let Cases {
        crossings,
        poor,
        wells,
    } = &cases;
    Finding::new([
        format!(
            "the pressure of a node in the place of that of a borehole: {} to {} off, by the mesh",
            nodes[0],
            nodes[nodes.len() - 1]
        ),
        format!(
            "rates to {rates:.0e}, whatever angles and facets; boreholes to {}",
            percent(cases.at_walls())
        ),
    ])
    .text(of_facets)
    .charts(charts(crossings, wells))
    .text(of_wells)
    .table(crossing_table(crossings))
    .table_in("flow-facets", facet_table(poor))
    .table_in("flow-wells", well_table(wells))
    .missing(misses(crossings, poor, wells))
}

fn misses(
    crossings: &[(f64, [f64; 2])],
    poor: &[Facets],
    wells: &[(usize, [f64; 2])],
) -> Vec<String> {
    let mut misses = Vec::new();
    let mut hold = |case: String, error: f64, bound: f64| {
        if error.is_nan() || error > bound {
            misses.push(format!("{case}: {error:.1e}"));
        }
    };
    for (angle, [rate, mass]) in crossings {
        hold(
            format!("planes that cross at {angle} degrees"),
            rate.max(*mass),
            EXACTLY,
        );
    }
    for case in poor {
        let name = format!(
            "facets {} times longer than wide, {:.1} degrees",
            case.aspect, case.angle
        );
        hold(format!("{name}, rate"), case.error, EXACTLY);
        hold(format!("{name}, negative pressures"), case.negative, 0.01);
    }
    for (n, [wall, _]) in wells {
        hold(format!("borehole, {n} facets along the side"), *wall, WALL);
    }
    misses
}

fn crossing_table(cases: &[(f64, [f64; 2])]) -> Table {
    let mut table = Table::new(&["angle (degrees)", "rates", "mass"]);
    for (angle, [rate, mass]) in cases {
        table.push([
            angle.to_string(),
            format!("{rate:.2e}"),
            format!("{mass:.2e}"),
        ]);
    }
    table
}

fn facet_table(cases: &[Facets]) -> Table {
    let mut table = Table::new(&[
        "length over width",
        "largest angle (degrees)",
        "rate",
        "backward edges",
        "negative pressures (share)",
    ]);
    for case in cases {
        table.push([
            case.aspect.to_string(),
            format!("{:.2}", case.angle),
            format!("{:.2e}", case.error),
            case.backward.to_string(),
            format!("{:.4}", case.negative),
        ]);
    }
    table
}

fn well_table(cases: &[(usize, [f64; 2])]) -> Table {
    let mut table = Table::new(&[
        "facets along the side",
        "pressure at the wall",
        "at the node",
    ]);
    for (n, [wall, node]) in cases {
        table.push([n.to_string(), format!("{wall:.2e}"), format!("{node:.2e}")]);
    }
    table
}

fn charts(
    crossings: &[(f64, [f64; 2])],
    wells: &[(usize, [f64; 2])],
) -> Vec<(&'static str, Chart)> {
    let rates = crossings.iter().map(|(angle, errors)| (*angle, errors[0]));
    let of = |which: usize| -> Vec<(f64, f64)> {
        wells
            .iter()
            .map(|(n, errors)| (1.0 / *n as f64, errors[which]))
            .collect()
    };
    vec![
        (
            "flow",
            Chart {
                series: vec![Series::line("rates", rates.collect())],
                ..Chart::new(
                    "Half planes that cross: errors of rates",
                    Axis::logarithmic("angle between the planes (degrees)"),
                    Axis::logarithmic("error (relative)").from(1e-17),
                )
            },
        ),
        (
            "flow-wells",
            Chart {
                series: vec![
                    Series::line("at the wall of the borehole", of(0)),
                    Series::line("at its node", of(1)),
                ],
                ..Chart::new(
                    "Two boreholes in a square: error of the pressure between them",
                    Axis::logarithmic("size of facets (m)"),
                    Axis::logarithmic("error (relative)"),
                )
            },
        ),
    ]
}
