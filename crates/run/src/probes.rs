//! `probes.csv`: what the rock and the fractures do at the points of probes, load step by load
//! step.

use glam::DVec3;
use kluft_io::printable::cell;
use kluft_scene::{Hit, Probe};
use kluft_solver::{FacetResult, Solution, Step, System, principal, sample};

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

/// Whether a text is a table of this kind.
pub fn is_probes(text: &str) -> bool {
    text.lines().next() == Some(head().as_str())
}

fn head() -> String {
    [&OF_STEP[..], &OF_ROCK, &OF_FRACTURE].concat().join(",")
}

/// A converged load step.
pub struct Solved<'a> {
    /// Number of the load step, from 1.
    pub number: usize,
    /// The load step.
    pub step: &'a Step,
    /// The system.
    pub system: &'a System<'a>,
    /// Its solution.
    pub solution: &'a Solution,
    /// Results at the nodes of facets.
    pub nodes: &'a [FacetResult],
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

/// What a point has, and where.
struct Row {
    position: DVec3,
    rock: Option<[f64; OF_ROCK.len()]>,
    fracture: Option<[f64; OF_FRACTURE.len()]>,
}

impl Row {
    /// Whether the point hits anything that is there.
    fn has_values(&self) -> bool {
        self.rock.is_some() || self.fracture.is_some()
    }
}

impl Solved<'_> {
    /// Adds the rows of the load step to a table.
    fn add_to(&self, text: &mut String, probes: &[Probe]) {
        if probes.is_empty() {
            return;
        }
        if text.is_empty() {
            *text = head() + "\n";
        }
        let mut table = csv::Writer::from_writer(Vec::new());
        for probe in probes {
            let rows: Vec<Row> = probe
                .points
                .iter()
                .map(|point| self.row(point.position, &point.hit))
                .collect();
            let mean = mean(&rows).filter(|_| probe.mean);
            let shown = match &mean {
                Some(mean) => std::slice::from_ref(mean),
                None => &rows[..],
            };
            for (index, row) in shown.iter().enumerate() {
                let name = match probe.mean {
                    true => "mean".to_owned(),
                    false => (index + 1).to_string(),
                };
                // Writing to memory cannot fail.
                let _ = table.write_record(self.record(&probe.name, name, row));
            }
        }
        let bytes = table.into_inner().unwrap_or_default();
        text.push_str(&String::from_utf8_lossy(&bytes));
    }

    fn row(&self, position: DVec3, hit: &Hit) -> Row {
        match hit {
            Hit::Rock(place) => {
                let found = sample(self.system, self.solution, place);
                let mut values = [0.0; OF_ROCK.len()];
                values[..3].copy_from_slice(&found.displacement.to_array());
                values[3..9].copy_from_slice(&found.stress);
                values[9..15].copy_from_slice(&found.strain);
                values[15..].copy_from_slice(&principal(&found.stress));
                Row {
                    position,
                    rock: Some(values),
                    fracture: None,
                }
            }
            Hit::Nothing => Row {
                position,
                rock: None,
                fracture: None,
            },
            Hit::Fracture(node) => {
                let found = &self.nodes[*node];
                let [jump, traction] = [found.jump, found.traction];
                let across = found.normal_traction;
                let along = (traction.length_squared() - across * across)
                    .max(0.0)
                    .sqrt();
                Row {
                    position,
                    rock: None,
                    fracture: Some([
                        found.aperture,
                        found.opening,
                        jump.x,
                        jump.y,
                        jump.z,
                        found.slip.length(),
                        across,
                        along,
                        traction.x,
                        traction.y,
                        traction.z,
                    ]),
                }
            }
        }
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
        record.extend(row.position.to_array().map(number));
        match row.rock {
            Some(values) => record.extend(values.map(number)),
            None => record.extend(OF_ROCK.map(|_| String::new())),
        }
        match row.fracture {
            Some(values) => record.extend(values.map(number)),
            None => record.extend(OF_FRACTURE.map(|_| String::new())),
        }
        record
    }
}

/// The mean of rows of one kind.
fn mean(rows: &[Row]) -> Option<Row> {
    let count = rows.len() as f64;
    let present: Vec<&Row> = rows.iter().filter(|row| row.has_values()).collect();
    let shared = present.len() as f64;
    fn of<const N: usize>(all: impl Iterator<Item = [f64; N]>, count: f64) -> [f64; N] {
        let mut sums = [0.0; N];
        for values in all {
            sums.iter_mut()
                .zip(values)
                .for_each(|(sum, value)| *sum += value);
        }
        sums.map(|sum| sum / count)
    }
    let rock = present.iter().filter_map(|row| row.rock);
    let fracture = present.iter().filter_map(|row| row.fracture);
    let first = present.first();
    (!rows.is_empty()).then(|| Row {
        position: rows.iter().map(|row| row.position).sum::<DVec3>() / count,
        rock: first.and_then(|row| row.rock).map(|_| of(rock, shared)),
        fracture: first
            .and_then(|row| row.fracture)
            .map(|_| of(fracture, shared)),
    })
}
