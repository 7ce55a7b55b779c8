//! The discrete problem: unknowns, stiffness, loads, and what they make of a state.

use glam::{DMat3, DVec3};
use kluft_mesh::Defect;
use lie_core::{FractureLaw, JointHistory, JointState, Response, TrialState};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::assembly::{self, Frame};
use crate::folded;
use crate::interface::{FacetPoint, Interface};
use crate::loads::Loads;
use crate::matrix::BlockMatrix;
use crate::multigrid::BlockRows;
use crate::pattern::Pattern;
use crate::points::Points;
use crate::problem::Problem;
use crate::rigid_modes;
use crate::schedule::Load;
use crate::supports::Supports;

/// Numbering and topology of a problem, before any value is computed.
#[derive(Debug, Clone)]
pub struct Discretisation {
    /// Copies of nodes, and unknowns.
    pub points: Points,
    /// What is held.
    pub supports: Supports,
    /// Pattern of the matrix.
    pub pattern: Pattern,
    /// The fractures.
    pub interface: Interface,
}

impl Discretisation {
    /// What assembly works from.
    pub(crate) fn frame<'a>(&'a self, problem: &'a Problem) -> Frame<'a> {
        Frame {
            problem,
            points: &self.points,
            supports: &self.supports,
            pattern: &self.pattern,
        }
    }

    /// Enriches and numbers a problem.
    ///
    /// # Errors
    /// Cells that fold over themselves, conditions that contradict each other, and blocks of rock
    /// that nothing holds, each named with the motions left free.
    pub fn of(problem: &Problem) -> Result<Self, Vec<Defect>> {
        if let Some(defect) = folded::find(problem) {
            return Err(vec![defect]);
        }
        let points = Points::of(&problem.mesh);
        let supports = Supports::of(problem, &points)?;
        let interface = Interface::of(problem, &points, &supports);
        let defects = rigid_modes::find(problem, &points, &supports);
        if !defects.is_empty() {
            return Err(defects);
        }
        let pattern = Pattern::of(&problem.mesh, &points);
        Ok(Self {
            points,
            supports,
            pattern,
            interface,
        })
    }

    /// Number of scalar unknowns, held directions left out.
    pub fn unknown_count(&self) -> usize {
        3 * self.points.len() - self.supports.held_directions
    }
}

/// The state of a run: what a load step starts from and leaves behind.
///
/// Apertures and tractions are kept beside the unknowns and follow them by increments. Computed
/// anew from displacements, a stiff fracture would multiply the rounding of the displacements by
/// its stiffness.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State {
    /// Load under which the state stands.
    pub load: Load,
    /// Unknown 3-vectors (m).
    pub unknowns: Vec<DVec3>,
    /// State of each facet point.
    pub facet_points: Vec<FacetPointState>,
    /// Largest sizes of the states on the way to it.
    pub(crate) reached: Sizes,
    /// Which laws of the system it was reached with.
    generation: u32,
}

/// How large the quantities of a state are: what "small" is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Sizes {
    /// Largest of the forces that must balance (N).
    pub(crate) force: f64,
    /// Largest displacement or opening (m).
    pub(crate) displacement: f64,
    /// Largest normal traction of a fracture (Pa).
    pub(crate) traction: f64,
}

impl Sizes {
    /// The larger of each, where the other counts with a `share`.
    pub(crate) fn or_share(self, share: f64, other: Self) -> Self {
        Self {
            force: self.force.max(share * other.force),
            displacement: self.displacement.max(share * other.displacement),
            traction: self.traction.max(share * other.traction),
        }
    }
}

/// State of one facet point.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct FacetPointState {
    /// Where the law is linearised, which is where the walls are once converged.
    pub joint: JointState,
    /// Jump of the walls beyond that (m); rounding once converged.
    pub jump_residual: DVec3,
    /// What former steps left behind.
    pub history: JointHistory,
}

/// The discrete problem, assembled.
#[derive(Debug, Clone)]
pub struct System<'a> {
    /// What is solved.
    pub problem: &'a Problem,
    /// Numbering and topology.
    pub discretisation: Discretisation,
    /// Stiffness of the rock over all unknowns; it never changes.
    pub rock: BlockMatrix,
    /// Forces.
    pub loads: Loads,
    /// Law of each fracture; see [`System::set_laws`].
    laws: Vec<FractureLaw>,
    /// How often the laws were changed.
    generation: u32,
}

/// Share of the forces of prescribed displacements that counts even if they cancel: rounding.
const CANCELLING: f64 = 1e-3;

impl<'a> System<'a> {
    /// Assembles rock and loads.
    pub fn assemble(problem: &'a Problem, discretisation: Discretisation) -> Self {
        let frame = discretisation.frame(problem);
        let rock = assembly::rock_stiffness(frame);
        let loads = Loads::of(frame, &discretisation.interface);
        Self {
            problem,
            rock,
            loads,
            laws: problem
                .fractures
                .iter()
                .map(|fracture| fracture.law)
                .collect(),
            generation: 0,
            discretisation,
        }
    }

    /// Gives the fractures other laws, one each. Rock and loads stay, and with them whatever a solver
    /// prepared. A state reached with the former laws serves as a first guess for a step with the new
    /// ones.
    pub fn set_laws(&mut self, laws: Vec<FractureLaw>) {
        self.generation += 1;
        self.discretisation
            .interface
            .carry_initial_stress(self.problem, &laws);
        self.laws = laws;
    }

    /// Whether a step may need more than one linear solve.
    pub fn is_nonlinear(&self) -> bool {
        self.laws.iter().any(|law| !law.is_linear())
    }

    /// Whether the tangent changes gradually: no fracture slides, breaks or ends a contact.
    pub fn is_smooth(&self) -> bool {
        self.laws.iter().all(FractureLaw::is_smooth)
    }

    /// Whether a state depends on how its load was reached.
    pub fn is_path_dependent(&self) -> bool {
        self.laws.iter().any(FractureLaw::is_path_dependent)
    }

    /// The state before any load: no displacement, apertures and shear as the initial stress
    /// leaves them.
    pub fn initial_state(&self) -> State {
        let points = self.discretisation.interface.points.iter();
        let facet_points = points.map(|point| FacetPointState {
            joint: point.initial,
            jump_residual: DVec3::ZERO,
            history: JointHistory::default(),
        });
        State {
            load: self.problem.schedule.start(),
            unknowns: vec![DVec3::ZERO; self.discretisation.points.len()],
            facet_points: facet_points.collect(),
            reached: Sizes::default(),
            generation: self.generation,
        }
    }

    /// Restates a state that was reached with other laws: apertures stay, the rest follows from the
    /// jumps and the present laws.
    pub(crate) fn adapt(&self, state: &mut State) {
        if state.generation == self.generation {
            return;
        }
        state.generation = self.generation;
        let interface = &self.discretisation.interface;
        let jumps = interface.jumps(&state.unknowns, &state.load);
        let points = interface.points.iter().zip(jumps);
        for ((point, jump), state) in points.zip(&mut state.facet_points) {
            let law = self.law(point);
            let seen = point.initial_jump() + jump;
            let opening = seen.dot(point.normal);
            let aperture = state.joint.separation.aperture;
            let landing = TrialState {
                separation: law.closure.opened(aperture - law.closure.aperture),
                slip: seen - opening * point.normal,
                normal_traction: state.joint.normal_traction,
                shear: state.joint.shear,
            };
            state.joint = if law.is_smooth() {
                law.state_at(&landing)
            } else {
                law.return_map(&landing, point.rock_stiffness(), &state.history)
            };
            let beyond = opening - state.joint.separation.opening;
            state.jump_residual = beyond * point.normal + landing.slip - state.joint.slip;
        }
    }

    /// Law of a facet point.
    pub fn law(&self, point: &FacetPoint) -> &FractureLaw {
        &self.laws[point.fracture as usize]
    }

    /// Tractions of the laws of all facet points in a state (Pa).
    pub fn law_tractions(&self, state: &State) -> Vec<DVec3> {
        let points = self.discretisation.interface.points.par_iter();
        points
            .zip(&state.facet_points)
            .map(|(point, state)| state.joint.traction(point.normal))
            .collect()
    }

    /// Responses of the laws to the jumps of `unknowns`.
    pub fn responses(&self, unknowns: &[DVec3], load: &Load) -> Vec<Response> {
        let interface = &self.discretisation.interface;
        let jumps = interface.jumps(unknowns, load);
        let points = interface.points.par_iter().zip(jumps);
        points
            .map(|(point, jump)| {
                let seen = point.initial_jump() + jump;
                self.law(point).response(seen, point.normal)
            })
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

    /// The stiffness of the rock, row by row.
    pub fn rock_rows(&self) -> BlockRows<'_> {
        self.rock.rows(&self.discretisation.pattern)
    }

    /// Forces by which the rock resists the unknowns (N), `K y`.
    pub fn rock_forces(&self, unknowns: &[DVec3]) -> Vec<DVec3> {
        self.rock.times(&self.discretisation.pattern, unknowns)
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

    /// `K + fractures`: the whole tangent for given tangents of the fractures.
    pub fn tangent(&self, tangents: &[DMat3]) -> BlockMatrix {
        let mut whole = self.rock.clone();
        let stiffness = self.discretisation.interface.stiffness(tangents);
        let row_offset = &self.discretisation.pattern.row_offset;
        for (row, place, block) in self.tangent_blocks(&self.interface_places(), &stiffness) {
            whole.blocks[row_offset[row] + place] = block;
        }
        whole
    }

    /// The blocks of the tangent that the fractures have a part in: block row, number of the block in
    /// it, and the block. `places` are [`Self::interface_places`].
    pub(crate) fn tangent_blocks(
        &self,
        places: &[(usize, usize)],
        stiffness: &[DMat3],
    ) -> impl Iterator<Item = (usize, usize, DMat3)> {
        let row_offset = &self.discretisation.pattern.row_offset;
        places.iter().zip(stiffness).map(|(&(row, place), block)| {
            let rock = self.rock.blocks[row_offset[row] + place];
            (row, place, rock + *block)
        })
    }

    /// Where the blocks that [`Interface::stiffness`] returns belong in the matrix: block row and
    /// number of the block in it.
    pub fn interface_places(&self) -> Vec<(usize, usize)> {
        let Discretisation {
            pattern, interface, ..
        } = &self.discretisation;
        let place = |row: usize, column: u32| {
            let address = pattern.address(row, column as usize);
            (row, address - pattern.row_offset[row])
        };
        (0..interface.unknowns.len())
            .flat_map(|index| {
                let row = interface.unknowns[index] as usize;
                interface
                    .columns
                    .of(index)
                    .iter()
                    .map(move |&column| place(row, column))
            })
            .collect()
    }
}

/// Euclidean norm, summed in a fixed order.
pub fn norm(vector: &[DVec3]) -> f64 {
    vector
        .iter()
        .map(|v| v.length_squared())
        .sum::<f64>()
        .sqrt()
}
