//! The discrete problem: unknowns, stiffness, loads, and what they make of a state.

mod carried;
mod discretisation;
mod rock_stiffness;
mod spread_displacements;
mod stage;
mod state;

use std::borrow::Cow;

use glam::{DMat3, DVec3};
use kluft_algebra::{
    BlockMatrix, BlockRows, Communicator, Division, FixedPart, LinearFailure, norm,
};
use kluft_mesh::{Defect, Mesh};
use lie_core::{FractureLaw, JointHistory, JointState, TrialState};
use rayon::prelude::*;

use crate::assembly::facet_point::FacetPoint;
use crate::assembly::interface::Interface;
use crate::assembly::loads::Loads;
use crate::flow::{Coupling, FlowSystem, between_corners};
use crate::problem::{Conduit, Field, Flow, Load, Problem};
use crate::space::cell::StrainOffsets;

use carried::Carried;
use rock_stiffness::RockStiffness;

pub use discretisation::Discretisation;

pub use carried::StageEnd;
pub(crate) use state::StateScales;
pub use state::{FacetPointState, State};

/// The discrete problem, assembled.
#[derive(Debug, Clone)]
pub struct System<'a> {
    /// What is solved.
    pub(crate) problem: &'a Problem,
    /// Numbering and topology, and the laws.
    pub(crate) discretisation: Discretisation,
    rock: RockStiffness,
    /// Forces.
    loads: Loads,
    /// How often the laws were changed.
    generation: u32,
    /// Flow that follows the walls, if there is any.
    coupling: Option<Coupling<'a>>,
    /// What it has from the stage before, if there was one.
    carried: Option<Carried>,
    /// What strains cells where nothing is carried: nothing.
    unstrained: StrainOffsets,
}

/// Share of the forces of prescribed displacements that counts even if they cancel: rounding.
const CANCELLING: f64 = 1e-3;

impl<'a> System<'a> {
    /// Assembles rock and loads.
    pub fn assemble(problem: &'a Problem, discretisation: Discretisation) -> Self {
        Self::divided(problem, discretisation, &Communicator::alone())
    }

    /// Assembles loads, and of the stiffness of the rock the rows of this rank.
    pub fn divided(
        problem: &'a Problem,
        discretisation: Discretisation,
        communicator: &Communicator,
    ) -> Self {
        let space = discretisation.space(problem);
        let beside = discretisation.interface.pattern().rows;
        let rock = RockStiffness::of(space, beside, communicator);
        let loads = Loads::of(space, &discretisation.interface);
        Self {
            problem,
            rock,
            loads,
            generation: 0,
            coupling: None,
            carried: None,
            unstrained: StrainOffsets::default(),
            discretisation,
        }
    }

    /// Gives the fractures other laws, one each, the same all over a fracture. Rock and loads
    /// stay, and with them whatever a solver prepared. A state reached with the former laws
    /// serves as a first guess for a step with the new ones.
    pub fn set_laws(&mut self, laws: Vec<FractureLaw>) {
        self.generation += 1;
        let interface = &mut self.discretisation.interface;
        interface.set_laws(self.problem, laws);
        if let Some(coupling) = &self.coupling {
            let pressures = initial_pressures(&self.problem.mesh, coupling.flow(), interface);
            interface.set_initial_pressures(self.problem, &pressures);
        }
    }

    /// Takes `laws`, as [`Self::laws`] has them, with the strength of some fractures divided by a
    /// factor. Stiffnesses, rock and loads stay; a state reached before serves as a first guess.
    ///
    /// # Panics
    /// If there are not as many laws as before.
    pub fn weaken(
        &mut self,
        laws: &[FractureLaw],
        factor: f64,
        is_weakened: impl Fn(usize) -> bool,
    ) {
        self.generation += 1;
        self.discretisation
            .interface
            .weaken(laws, factor, is_weakened);
    }

    /// Takes other forces instead of those of the problem.
    pub fn set_loads(&mut self, loads: Loads) {
        self.loads = loads;
    }

    /// Adds the push of a flow at constant apertures, factorised, to the forces of all load cases.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn push_walls(&mut self, flow: &FlowSystem<'_>) -> Result<(), LinearFailure> {
        let mut cases = self.loads.cases().to_vec();
        flow.add_push(&self.discretisation.interface, &mut cases)?;
        self.loads = Loads::new(cases, self.loads.initial().to_vec());
        Ok(())
    }

    /// Lets a flow follow the walls and push them.
    ///
    /// # Errors
    /// As [`Coupling::of`].
    pub fn couple(&mut self, flow: &'a Flow) -> Result<(), Vec<Defect>> {
        let interface = &mut self.discretisation.interface;
        let pressures = initial_pressures(&self.problem.mesh, flow, interface);
        interface.set_initial_pressures(self.problem, &pressures);
        let apertures = apertures(interface.all_initial_walls());
        self.coupling = Some(Coupling::of(self.problem, flow, interface, &apertures)?);
        Ok(())
    }

    /// The flow that follows the walls, if there is any.
    pub fn coupling(&self) -> Option<&Coupling<'a>> {
        self.coupling.as_ref()
    }

    /// What is solved. Its laws are those that the run began with; see [`Self::laws`].
    pub fn problem(&self) -> &'a Problem {
        self.problem
    }

    /// Numbering and topology.
    pub fn discretisation(&self) -> &Discretisation {
        &self.discretisation
    }

    /// Forces.
    pub fn loads(&self) -> &Loads {
        &self.loads
    }

    /// Law of each fracture, then those of facet points that have their own.
    pub fn laws(&self) -> &[FractureLaw] {
        self.discretisation.interface.laws()
    }

    /// Whether a step may need more than one linear solve.
    pub fn is_nonlinear(&self) -> bool {
        self.coupling.is_some() || self.laws().iter().any(|law| !law.is_linear())
    }

    /// Whether the tangent changes gradually: no fracture slides, breaks or ends a contact.
    pub fn is_smooth(&self) -> bool {
        self.laws().iter().all(FractureLaw::is_smooth)
    }

    /// Whether a state depends on how its load was reached.
    pub fn is_path_dependent(&self) -> bool {
        self.laws().iter().any(FractureLaw::is_path_dependent)
    }

    /// The state before any load: no displacement, apertures and shear as the initial stress
    /// leaves them, or as the stage before does.
    pub fn initial_state(&self) -> State {
        let interface = &self.discretisation.interface;
        let facet_points = interface.all_initial_walls().map(|joint| FacetPointState {
            joint,
            jump_residual: DVec3::ZERO,
            history: JointHistory::default(),
        });
        let facet_points: Vec<FacetPointState> = match &self.carried {
            Some(carried) => carried.facet_points.clone(),
            None => facet_points.collect(),
        };
        let load = self.problem.schedule.start();
        let fluid = self
            .coupling
            .as_ref()
            .map(|coupling| coupling.start(&load, &apertures(interface.all_initial_walls())));
        State {
            fluid,
            load,
            unknowns: vec![DVec3::ZERO; self.discretisation.points.len()],
            facet_points,
            reached: self
                .carried
                .as_ref()
                .map_or_else(StateScales::default, |c| c.reached),
            generation: self.generation,
        }
    }

    /// A state that was reached with other laws, restated: apertures stay, the rest follows from
    /// the jumps and the present laws.
    pub(crate) fn restated<'s>(&self, state: &'s State) -> Cow<'s, State> {
        if state.generation == self.generation {
            return Cow::Borrowed(state);
        }
        let mut restated = state.clone();
        self.restate(&mut restated);
        Cow::Owned(restated)
    }

    fn restate(&self, state: &mut State) {
        state.generation = self.generation;
        let interface = &self.discretisation.interface;
        let jumps = self.seen_jumps(state);
        let points = interface.points.iter().zip(jumps);
        for ((point, seen), state) in points.zip(&mut state.facet_points) {
            let law = self.law(point);
            let opening = seen.dot(point.normal);
            let aperture = state.joint.separation.aperture;
            let trial = TrialState {
                separation: law.closure.opened(aperture - law.closure.aperture),
                slip: seen - opening * point.normal,
                normal_traction: state.joint.normal_traction,
                shear: state.joint.shear,
            };
            state.joint = if law.is_smooth() {
                law.state_at(&trial)
            } else {
                law.return_map(&trial, point.rock_stiffness(), &state.history)
            };
            let beyond = opening - state.joint.separation.opening;
            state.jump_residual = beyond * point.normal + trial.slip - state.joint.slip;
        }
    }

    /// Law of a facet point.
    pub fn law(&self, point: &FacetPoint) -> &FractureLaw {
        &self.laws()[point.law as usize]
    }

    /// Tractions of the laws of all facet points in a state (Pa).
    pub fn law_tractions(&self, state: &State) -> Vec<DVec3> {
        let points = self.discretisation.interface.points.par_iter();
        points
            .zip(&state.facet_points)
            .map(|(point, state)| state.joint.traction(point.normal))
            .collect()
    }

    /// Displacement of all points (m) under a load.
    pub fn displacements(&self, unknowns: &[DVec3], load: &Load) -> Vec<DVec3> {
        let Discretisation {
            points, supports, ..
        } = &self.discretisation;
        (0..points.len())
            .into_par_iter()
            .map(|point| supports.apply(point, points.displacement(unknowns, point), load))
            .collect()
    }

    /// How far all points have moved in a state (m), former stages included.
    pub fn total_displacements(&self, state: &State) -> Vec<DVec3> {
        let mut moved = self.displacements(&state.unknowns, &state.load);
        if let Some(carried) = &self.carried {
            let pairs = moved.iter_mut().zip(&carried.displacements);
            pairs.for_each(|(moved, before)| *moved += *before);
        }
        moved
    }

    /// Jumps of the walls in a state (m) since that of initial stress, former stages included.
    pub fn total_jumps(&self, state: &State) -> Vec<DVec3> {
        let interface = &self.discretisation.interface;
        let mut jumps = interface.jumps(&state.unknowns, &state.load);
        if let Some(carried) = &self.carried {
            let pairs = jumps.iter_mut().zip(&carried.jumps);
            pairs.for_each(|(jump, before)| *jump += *before);
        }
        jumps
    }

    /// Jumps in a state as the laws see them (m): beyond walls without stress.
    fn seen_jumps(&self, state: &State) -> Vec<DVec3> {
        let interface = &self.discretisation.interface;
        let jumps = interface.jumps(&state.unknowns, &state.load).into_iter();
        let carried = self.carried.as_ref();
        let seen = jumps.zip(&interface.points).enumerate();
        seen.map(|(index, (jump, point))| {
            let before = carried.map(|carried| carried.seen[index]);
            before.unwrap_or_else(|| interface.initial_jump(point)) + jump
        })
        .collect()
    }

    /// What strains cells beside the displacements of their points.
    pub(crate) fn strain_offsets(&self) -> &StrainOffsets {
        let carried = self.carried.as_ref();
        carried.map_or(&self.unstrained, |carried| &carried.offsets)
    }

    /// Forces of the loads on all unknowns (N).
    pub fn load_forces(&self, load: &Load) -> Vec<DVec3> {
        let cases = || self.loads.cases().iter().zip(&load.factors);
        let initial = self.loads.initial().par_iter().enumerate();
        initial
            .map(|(i, initial)| {
                let forces = cases().map(|(case, f)| *f * (case.applied[i] + case.prescribed[i]));
                forces.reduce(|a, b| a + b).unwrap_or_default() + *initial
            })
            .collect()
    }

    /// The stiffness of the rock, row by row; rows that this rank does not hold are empty.
    pub fn rock_rows(&self) -> BlockRows<'_> {
        self.rock.rows(&self.discretisation.pattern.blocks)
    }

    /// Rows of the stiffness of the rock that each rank holds.
    pub fn division(&self) -> &Division {
        self.rock.division()
    }

    /// Holds of these rows, ascending, those of whole nodes, too what `is_needed` of rows and
    /// columns. What tells of the pattern of other rows is given up: once these are there, none can
    /// be added.
    pub(crate) fn add_rows(&mut self, rows: &[u32], is_needed: impl Fn(u32, u32) -> bool) {
        let space = self.discretisation.space(self.problem);
        if let Some(blocks) = self.rock.add_rows(space, rows, is_needed) {
            self.discretisation.pattern.keep(blocks);
        }
    }

    /// Forces by which the rock resists the unknowns (N), `K y`. All ranks must ask for them.
    pub fn rock_forces(&self, unknowns: &[DVec3]) -> Vec<DVec3> {
        self.rock
            .times(&self.discretisation.pattern.blocks, unknowns)
    }

    /// `|K| |y|`, both entry by entry (N). All ranks must ask for them.
    pub(crate) fn absolute_rock_forces(&self, unknowns: &[DVec3]) -> Vec<DVec3> {
        let pattern = &self.discretisation.pattern.blocks;
        self.rock.absolute_times(pattern, unknowns)
    }

    /// Out-of-balance forces `loads - rock - fractures` (N) for given forces of the rock and
    /// tractions of the fractures.
    pub fn residual(&self, rock_forces: &[DVec3], tractions: &[DVec3], load: &Load) -> Vec<DVec3> {
        let mut residual = self.load_forces(load);
        residual
            .par_iter_mut()
            .zip(rock_forces)
            .for_each(|(force, rock)| *force -= *rock);
        self.discretisation
            .interface
            .add_forces(tractions, -1.0, &mut residual);
        residual
    }

    /// Largest of the forces that must balance (N), as Euclidean norms over all unknowns: the
    /// measure for "small" in a residual.
    pub fn force_scale(&self, rock_forces: &[DVec3], tractions: &[DVec3], load: &Load) -> f64 {
        let mut fractures = vec![DVec3::ZERO; rock_forces.len()];
        self.discretisation
            .interface
            .add_forces(tractions, 1.0, &mut fractures);
        let sizes = || self.loads.case_sizes().iter().zip(&load.factors);
        let of_cases = sizes().map(|(size, f)| f.abs() * size.applied);
        let prescribed = sizes().map(|(size, f)| f.abs() * size.prescribed);
        let prescribed = prescribed.fold(0.0, f64::max);
        // Moving a body as a whole asks for large forces that cancel: what counts is what is left.
        let mut internal = rock_forces.to_vec();
        for (case, f) in self.loads.cases().iter().zip(&load.factors) {
            let pairs = internal.par_iter_mut().zip(&case.prescribed);
            pairs.for_each(|(force, prescribed)| *force -= *f * *prescribed);
        }
        let others = [
            self.loads.initial_size(),
            norm(&internal),
            norm(&fractures),
            CANCELLING * prescribed,
        ];
        of_cases.chain(others).fold(0.0, f64::max)
    }

    /// What of the tangent stays: the stiffness of the rock, and where the fractures add to it.
    pub fn fixed_part(&self) -> FixedPart<'_> {
        FixedPart {
            matrix: self.rock_rows(),
            interface: self.discretisation.interface.pattern(),
            diagonal: self.rock.diagonal(),
        }
    }

    /// `K + fractures`: the whole tangent for given tangents of the fractures, where one rank holds
    /// all rows.
    pub fn tangent(&self, tangents: &[DMat3]) -> BlockMatrix {
        let mut whole = BlockMatrix {
            blocks: self.rock_rows().blocks.to_vec(),
        };
        let stiffness = self.discretisation.interface.stiffness(tangents);
        let pattern = &self.discretisation.pattern.blocks;
        let fixed = self.fixed_part();
        for (row, place, block) in fixed.blocks(&fixed.places(), &stiffness) {
            if let Some(address) = pattern.address(row, place) {
                whole.blocks[address] = block;
            }
        }
        whole
    }
}

/// Pressure of the fluid at each facet point before any load (Pa). One that is not linear is taken
/// as the flow has it, so that nothing moves at the start.
fn initial_pressures(mesh: &Mesh, flow: &Flow, interface: &Interface) -> Vec<f64> {
    let points = interface.points.iter();
    let mut pressures: Vec<f64> = match &flow.initial_pressure {
        Field::Profile(profile) => points
            .map(|point| profile.at_elevation(point.position.z))
            .collect(),
        varying => between_corners(mesh, interface, |node| varying.at(mesh.nodes[node], 0.0)),
    };
    for (pressure, point) in pressures.iter_mut().zip(&interface.points) {
        if flow.conduits[point.fracture as usize] == Conduit::Sealed {
            *pressure = 0.0;
        }
    }
    pressures
}

fn apertures(walls: impl Iterator<Item = JointState>) -> Vec<f64> {
    walls.map(|joint| joint.separation.aperture).collect()
}
