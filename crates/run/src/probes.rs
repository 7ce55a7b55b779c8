//! `probes.csv`: what the rock and the fractures do where probes are, load step by load step.

use glam::DVec3;
use kluft_io::printable::cell;
use kluft_mesh::Mesh;
use kluft_scene::{Hit, Probe, ProbePoint};
use kluft_solver::{
    FacetResult, FlowFields, RockSample, Solution, Step, System, principal, sample, surface_samples,
};

use crate::flow_summary::{ConduitSummary, conduits};

/// Its name in the folder of the results.
pub const NAME: &str = "probes.csv";

/// Columns before those of values.
const OF_STEP: [&str; 8] = ["step", "time", "phase", "probe", "point", "x", "y", "z"];
/// Values in the rock.
const OF_ROCK: [&str; 18] = [
    "displacement_x",
    "displacement_y",
    "displacement_z",
    "stress_xx",
    "stress_yy",
    "stress_zz",
    "stress_xy",
    "stress_yz",
    "stress_xz",
    "strain_xx",
    "strain_yy",
    "strain_zz",
    "strain_xy",
    "strain_yz",
    "strain_xz",
    "principal_min",
    "principal_mid",
    "principal_max",
];
/// Values on a fracture.
const OF_FRACTURE: [&str; 11] = [
    "aperture",
    "opening",
    "jump_x",
    "jump_y",
    "jump_z",
    "slip",
    "normal_traction",
    "shear_traction",
    "traction_x",
    "traction_y",
    "traction_z",
];
/// Values of a fluid on a fracture.
const OF_FLUID: [&str; 2] = ["pressure", "hydraulic_aperture"];
/// Where the values on a fracture begin.
const FRACTURE: usize = OF_ROCK.len();
/// Where those of a fluid begin.
const FLUID: usize = FRACTURE + OF_FRACTURE.len();
/// All values.
const WIDTH: usize = FLUID + OF_FLUID.len();

/// Whether a text is a table of this kind.
pub fn is_probes(text: &str) -> bool {
    let first = text.lines().next();
    [false, true]
        .map(head)
        .iter()
        .any(|head| first == Some(head))
}

/// The columns, without and with those of a fluid.
fn head(has_fluid: bool) -> String {
    let fluid = if has_fluid { &OF_FLUID[..] } else { &[] };
    let all = [&OF_STEP[..], &OF_ROCK, &OF_FRACTURE, fluid];
    all.concat().join(",")
}

/// A converged load step.
pub struct Solved<'a> {
    /// Number of the load step, from 1.
    pub number: usize,
    /// The load step.
    pub step: &'a Step,
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The rock, if it deforms.
    pub rock: Option<SolvedRock<'a>>,
    /// The fluid, if there is one.
    pub fluid: Option<SolvedFluid<'a>>,
}

/// Rock that deforms.
pub struct SolvedRock<'a> {
    /// The system.
    pub system: &'a System<'a>,
    /// Its solution.
    pub solution: &'a Solution,
    /// Results at the nodes of facets.
    pub nodes: &'a [FacetResult],
}

/// A fluid in fractures.
pub struct SolvedFluid<'a> {
    /// Its fields.
    pub fields: &'a FlowFields,
    /// Apertures (m) at the nodes of the facets where the rock is rigid.
    pub apertures: &'a [f64],
}

/// Probes, and what they had after the load steps so far.
#[derive(Default)]
pub struct ProbeTable {
    /// The probes on the mesh of the run.
    pub all: Vec<Probe>,
    /// The table, for the file and for checkpoints.
    pub text: String,
}

impl ProbeTable {
    /// Adds the rows of a load step.
    pub fn add(&mut self, solved: &Solved<'_>) {
        solved.add_to(&mut self.text, &self.all);
    }
}

/// What a place has; what does not apply is not there.
struct Row {
    position: DVec3,
    /// Its share of a mean (m^2 where it stands for an area).
    weight: f64,
    values: [Option<f64>; WIDTH],
}

impl Row {
    /// A row without values.
    fn at(position: DVec3) -> Self {
        Self {
            position,
            weight: 1.0,
            values: [None; WIDTH],
        }
    }

    /// Puts values side by side, from a column on.
    fn put(&mut self, first: usize, values: impl IntoIterator<Item = f64>) {
        let places = self.values[first..].iter_mut();
        places
            .zip(values)
            .for_each(|(place, value)| *place = Some(value));
    }

    fn of_rock(position: DVec3, (weight, found): (f64, &RockSample)) -> Self {
        let mut row = Self::at(position);
        row.weight = weight;
        let values = found.displacement.to_array().into_iter();
        let values = values.chain(found.stress).chain(found.strain);
        row.put(0, values.chain(principal(&found.stress)));
        row
    }

    fn of_fracture(position: DVec3, (weight, found): (f64, &FacetResult)) -> Self {
        let [jump, traction] = [found.jump, found.traction];
        let across = found.normal_traction;
        let along = traction.length_squared() - across * across;
        let mut row = Self::at(position);
        row.weight = weight;
        let values = [found.aperture, found.opening].into_iter();
        let values = values.chain(jump.to_array());
        let values = values.chain([found.slip.length(), across, along.max(0.0).sqrt()]);
        row.put(FRACTURE, values.chain(traction.to_array()));
        row
    }
}

impl Solved<'_> {
    /// Adds the rows of the load step to a table.
    fn add_to(&self, text: &mut String, probes: &[Probe]) {
        if probes.is_empty() {
            return;
        }
        if text.is_empty() {
            *text = head(self.fluid.is_some()) + "\n";
        }
        let conduits = match &self.fluid {
            Some(fluid) => conduits(self.mesh, fluid.fields),
            None => Vec::new(),
        };
        let mut table = csv::Writer::from_writer(Vec::new());
        for probe in probes {
            let points = probe.points.iter();
            let rows: Vec<Row> = points.map(|point| self.row(point, &conduits)).collect();
            let shown = match probe.mean {
                true => mean(&rows).into_iter().collect(),
                false => rows,
            };
            for (number, row) in (1..).zip(&shown) {
                let point = match probe.mean {
                    true => "mean".to_owned(),
                    false => u32::to_string(&number),
                };
                // Writing to memory cannot fail.
                let _ = table.write_record(self.record(&probe.name, point, row));
            }
        }
        let bytes = table.into_inner().unwrap_or_default();
        text.push_str(&String::from_utf8_lossy(&bytes));
    }

    fn row(&self, point: &ProbePoint, conduits: &[ConduitSummary]) -> Row {
        let position = point.position;
        match (&point.hit, &self.rock) {
            (Hit::Rock(place), Some(rock)) => {
                let found = sample(rock.system, rock.solution, place);
                Row::of_rock(position, (1.0, &found))
            }
            (Hit::WholeBoundary(boundary), Some(rock)) => {
                let found = surface_samples(rock.system, rock.solution, *boundary);
                let facets = found.iter();
                let facets = facets.map(|(area, own)| Row::of_rock(position, (*area, own)));
                mean(&facets.collect::<Vec<_>>()).unwrap_or_else(|| Row::at(position))
            }
            (Hit::Fracture(node), rock) => {
                let mut row = match rock {
                    Some(rock) => Row::of_fracture(position, (1.0, &rock.nodes[*node])),
                    None => Row::at(position),
                };
                self.add_fluid_at(&mut row, *node);
                row
            }
            (Hit::WholeFracture(fracture), rock) => {
                let mut row = match rock {
                    Some(rock) => rock.over_fracture(position, *fracture),
                    None => self.rigid_over(position, *fracture),
                };
                let name = &self.mesh.fractures[*fracture];
                let own = conduits.iter().find(|conduit| conduit.name == *name);
                if let Some(own) = own {
                    row.put(FLUID, [own.pressure.mean, own.hydraulic_aperture.mean]);
                }
                row
            }
            (Hit::Rock(_) | Hit::WholeBoundary(_), None) | (Hit::Nothing, _) => Row::at(position),
        }
    }

    /// Adds what a fluid does at a node of a facet; nothing where it cannot go.
    fn add_fluid_at(&self, row: &mut Row, node: usize) {
        let Some(fluid) = &self.fluid else {
            return;
        };
        if self.rock.is_none() {
            row.put(FRACTURE, [fluid.apertures[node]]);
        }
        let offsets = &self.mesh.facets.elements.offsets;
        let facet = offsets.partition_point(|&start| start as usize <= node) - 1;
        if fluid.fields.transmissivities[facet] > 0.0 {
            let values = [&fluid.fields.pressures, &fluid.fields.hydraulic_apertures];
            row.put(FLUID, values.map(|field| field[node]));
        }
    }

    /// The mean aperture over a fracture in rigid rock, of each facet that of its corners.
    fn rigid_over(&self, position: DVec3, fracture: usize) -> Row {
        let Some(fluid) = &self.fluid else {
            return Row::at(position);
        };
        let (facets, areas) = (&self.mesh.facets, self.mesh.facet_areas());
        let rows = facets.of_fracture(fracture).map(|facet| {
            let count = facets.elements.shapes[facet].corner_count();
            let corners = &fluid.apertures[facets.elements.range(facet)][..count];
            let mut row = Row::at(position);
            row.weight = areas[facet].length();
            row.put(FRACTURE, [corners.iter().sum::<f64>() / count as f64]);
            row
        });
        mean(&rows.collect::<Vec<_>>()).unwrap_or_else(|| Row::at(position))
    }

    fn record(&self, probe: &str, point: String, row: &Row) -> Vec<String> {
        let number = |value: f64| format!("{value:e}");
        let phase = self.step.phase.as_deref().unwrap_or_default();
        let mut record = vec![
            self.number.to_string(),
            number(self.step.load.time),
            cell(phase),
            cell(probe),
            point,
        ];
        let place = row
            .position
            .to_array()
            .map(|x| Some(x).filter(|x| !x.is_nan()));
        let width = if self.fluid.is_some() { WIDTH } else { FLUID };
        let values = place.iter().chain(&row.values[..width]);
        record.extend(values.map(|value| value.map_or_else(String::new, number)));
        record
    }
}

impl SolvedRock<'_> {
    /// The mean over a fracture at the points where its law is integrated.
    fn over_fracture(&self, position: DVec3, fracture: usize) -> Row {
        let points = self.system.discretisation().interface().points().iter();
        let pairs = points.zip(&self.solution.facet_points);
        let own = pairs.filter(|(point, _)| point.fracture as usize == fracture);
        let rows = own.map(|(point, found)| Row::of_fracture(position, (point.area, found)));
        mean(&rows.collect::<Vec<_>>()).unwrap_or_else(|| Row::at(position))
    }
}

/// The mean of rows by their weights, of each value over the rows that have it.
fn mean(rows: &[Row]) -> Option<Row> {
    let count = rows.len() as f64;
    let position = rows.iter().map(|row| row.position).sum::<DVec3>() / count;
    let of_column = |column: usize| {
        let present = rows.iter();
        let present = present.filter_map(|row| Some((row.weight, row.values[column]?)));
        let [mut weights, mut sum] = [0.0; 2];
        for (weight, value) in present {
            weights += weight;
            sum += weight * value;
        }
        (weights != 0.0).then(|| sum / weights)
    };
    (!rows.is_empty()).then(|| Row {
        values: std::array::from_fn(of_column),
        ..Row::at(position)
    })
}
