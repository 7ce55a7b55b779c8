//! Flow in time between walls that do not move: nodes store what pressure compresses.
//!
//! With the volume `V_i = sum_f A s b` that belongs to a node and the compressibility `c`, its
//! balance over a time `dt` (implicit Euler) is
//!
//! ```text
//! c V_i (p_i - p_i,before) / dt + sum_f T_f sum_j k_ij (phi_j - phi_i) = q_i
//! ```
//!
//! It is linear, with one factor for all increments of one length. A time step is solved in one
//! increment and in two, and divided where these differ.

use kluft_algebra::{LinearFailure, ScalarCholesky};
use kluft_mesh::facet_area_vector;
use serde::{Deserialize, Serialize};

use super::loaded::{FlowState, Loaded, Stored};
use super::solve::{corrected, free_of};
use super::steady::FlowSystem;
use crate::problem::{Load, Schedule};

/// Shortest part of a time step that is tried; what it differs from two halves is let be.
const SMALLEST_SUBSTEP: f64 = 1.0 / 64.0;
/// Below this share of the error allowed the next part is twice as long.
const GROWTH_SHARE: f64 = 0.25;
/// Factors that are kept: those of a part, its halves, and of parts before and after a division.
const KEPT_FACTORS: usize = 4;

/// A flow in time.
pub struct TransientFlow<'s, 'a> {
    system: &'s FlowSystem<'a>,
    /// `c V_i` (m^3/Pa).
    storage: Vec<f64>,
    /// Pressures before any load (Pa).
    initial: Vec<f64>,
    /// Largest difference of a time step in one increment and in two; 1 takes steps as given.
    accuracy: f64,
    /// Factors of the matrix, each with the length of its increments (s).
    factors: Vec<(f64, Option<ScalarCholesky>)>,
    load: Load,
    reached: TransientState,
}

/// What an increment starts from.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TransientState {
    /// Pressures (Pa).
    pressures: Vec<f64>,
    /// What has entered through each condition (m^3).
    entered: Vec<f64>,
}

/// A time step that was solved.
pub struct TimeStep {
    /// The flow at its end.
    pub state: FlowState,
    /// Parts that it was divided into.
    pub parts: usize,
    /// Largest difference of one increment and two that exceeds the accuracy, however short.
    pub error: Option<f64>,
}

impl<'s, 'a> TransientFlow<'s, 'a> {
    /// The flow of a system with these apertures (m), as in the flat node list of the facets, from
    /// the initial pressure on.
    pub fn of(
        system: &'s FlowSystem<'a>,
        apertures: &[f64],
        schedule: &Schedule,
        accuracy: f64,
    ) -> Self {
        let flow = system.topology.flow;
        let initial = system.topology.initial_pressures();
        Self {
            storage: storage(system, apertures),
            accuracy,
            factors: Vec::new(),
            load: schedule.start(),
            reached: TransientState {
                pressures: initial.clone(),
                entered: vec![0.0; flow.conditions.len()],
            },
            initial,
            system,
        }
    }

    /// Where it stands.
    pub fn state(&self) -> &TransientState {
        &self.reached
    }

    /// Goes on from where another one stood under a load; whether that was one of the same system.
    pub fn go_on(&mut self, load: &Load, reached: TransientState) -> bool {
        let lengths = |state: &TransientState| [state.pressures.len(), state.entered.len()];
        let fits = lengths(&reached) == lengths(&self.reached);
        if fits {
            self.load.clone_from(load);
            self.reached = reached;
        }
        fits
    }

    /// The flow at the end of a time step that leads to `load`.
    ///
    /// # Errors
    /// A matrix that does not fit in memory, numbers that are not finite.
    pub fn step(&mut self, schedule: &Schedule, load: &Load) -> Result<TimeStep, LinearFailure> {
        let start = schedule.walked_from(&self.load);
        let at = |share: f64| match share {
            1.0 => load.clone(),
            share => Load::between(&start, load, share),
        };
        let (mut here, mut part) = (0.0, 1.0_f64);
        let (mut parts, mut error) = (0, None::<f64>);
        loop {
            let end = f64::min(here + part, 1.0);
            let loads = [at(here), at(0.5 * (here + end)), at(end)];
            let (state, reached, apart) = self.solve_part(&loads)?;
            if apart > self.accuracy && part > SMALLEST_SUBSTEP {
                part *= 0.5;
                continue;
            }
            if apart > self.accuracy {
                error = Some(error.map_or(apart, |worst| worst.max(apart)));
            }
            self.reached = reached;
            parts += 1;
            here = end;
            if here >= 1.0 {
                self.load.clone_from(load);
                let state = FlowState {
                    entered: self.reached.entered.clone(),
                    ..state
                };
                return Ok(TimeStep {
                    state,
                    parts,
                    error,
                });
            }
            part *= if apart < GROWTH_SHARE * self.accuracy {
                2.0
            } else {
                1.0
            };
        }
    }

    /// The end of a part between the first and the last of three loads, and how far one increment
    /// and two are apart there.
    fn solve_part(
        &mut self,
        [start, middle, end]: &[Load; 3],
    ) -> Result<(FlowState, TransientState, f64), LinearFailure> {
        let from = self.reached.clone();
        let (whole, reached) = self.increment(&from, [start, end])?;
        if self.accuracy >= 1.0 {
            return Ok((whole, reached, 0.0));
        }
        let (_, half) = self.increment(&from, [start, middle])?;
        let (state, reached) = self.increment(&half, [middle, end])?;
        let apart = self.difference(&whole.pressures, &state.pressures);
        Ok((state, reached, apart))
    }

    /// Root mean square, by what nodes store, of the difference of pressures against what the
    /// second of them have changed since the run began.
    fn difference(&self, a: &[f64], b: &[f64]) -> f64 {
        let mut squares = [0.0; 2];
        for (row, storage) in self.storage.iter().enumerate() {
            squares[0] += storage * (a[row] - b[row]).powi(2);
            squares[1] += storage * (b[row] - self.initial[row]).powi(2);
        }
        match squares {
            [0.0, _] => 0.0,
            [apart, moved] => (apart / moved).sqrt(),
        }
    }

    fn increment(
        &mut self,
        from: &TransientState,
        [start, end]: [&Load; 2],
    ) -> Result<(FlowState, TransientState), LinearFailure> {
        let duration = end.time - start.time;
        let factor = self.factor(duration)?;
        let (topology, operator) = (&self.system.topology, &self.system.operator);
        let before = from.pressures.iter().copied();
        let mut loaded = Loaded::of(topology, end).counted_from_means_of(before);
        loaded.from = Some(start);
        let rows = from.pressures.iter().enumerate();
        let mut potentials: Vec<f64> = rows.map(|(row, p)| p - loaded.weight(row)).collect();
        loaded.set_given(&mut potentials);
        let stored = |loaded: &Loaded<'_, '_>, potentials: &[f64]| {
            let rates = potentials.iter().enumerate().map(|(row, potential)| {
                let rise = potential + loaded.weight(row) - from.pressures[row];
                self.storage[row] * rise / duration
            });
            let sizes = self.storage.iter().zip(&from.pressures);
            Stored {
                rates: rates.collect(),
                terms: sizes.map(|(c, p)| (c * p).abs()).sum::<f64>() / duration,
            }
        };
        let factor = self.factors[factor].1.as_ref();
        corrected(&mut potentials, (topology, factor), |potentials| {
            loaded.stored = Some(stored(&loaded, potentials));
            free_of(topology, &loaded.missing(operator, potentials))
        });
        if !potentials.iter().all(|value| value.is_finite()) {
            return Err(LinearFailure::NotFinite);
        }
        loaded.stored = Some(stored(&loaded, &potentials));
        let state = loaded.state(operator, potentials);
        let entering = from.entered.iter().zip(&state.conditions);
        let entered = entering.map(|(so_far, flow)| so_far + flow.mean_rate * duration);
        let reached = TransientState {
            pressures: state.pressures.clone(),
            entered: entered.collect(),
        };
        Ok((state, reached))
    }

    /// Where the factor of increments of a length stands.
    fn factor(&mut self, duration: f64) -> Result<usize, LinearFailure> {
        if let Some(known) = self.factors.iter().position(|(of, _)| *of == duration) {
            return Ok(known);
        }
        let topology = &self.system.topology;
        let extra = |row: usize| self.storage[row] / duration;
        let matrix = self.system.operator.free_matrix(topology, extra);
        if matrix.values.iter().any(|value| !value.is_finite()) {
            return Err(LinearFailure::NotFinite);
        }
        let factor = match topology.free.is_empty() {
            true => None,
            false => {
                let mut factor = ScalarCholesky::of(&matrix.pattern)?;
                factor.factorise(&matrix)?;
                Some(factor)
            }
        };
        self.factors.truncate(KEPT_FACTORS - 1);
        self.factors.insert(0, (duration, factor));
        Ok(0)
    }
}

/// `c V_i` of each row (m^3/Pa); corners of a facet have equal parts of its area.
fn storage(system: &FlowSystem<'_>, apertures: &[f64]) -> Vec<f64> {
    let topology = &system.topology;
    let elements = &topology.mesh.facets.elements;
    let mut storage = vec![0.0; topology.nodes.len()];
    for (index, &facet) in topology.nodes.facets.iter().enumerate() {
        let facet = facet as usize;
        let corners = topology.nodes.corners.of(index);
        let points = topology.mesh.corners(elements, facet);
        let area = facet_area_vector(&points).length() / corners.len() as f64;
        let own = &apertures[elements.range(facet)];
        for (&row, aperture) in corners.iter().zip(own) {
            storage[row as usize] += topology.flow.fluid.compressibility * area * aperture;
        }
    }
    storage
}
