//! Flow that follows the walls of fractures as they move, and pushes them.
//!
//! With the aperture `b`, the pressure `p` and the potential `phi = p - rho g . x`, what belongs to
//! a node `i` is `V_i = (1 + c (p_i - p_0)) sum_f A s b`, over facet points of area `A` in whose
//! pressure the node has a share `s`. Its balance over a time `dt` (implicit Euler) is
//!
//! ```text
//! (V_i - V_i,before) / dt + sum_f T_f(b) sum_j k_ij (phi_j - phi_i) = q_i
//! ```
//!
//! without the first term in a steady state. The volumes are those at the density that the fluid
//! has under the initial pressure `p_0`, so that the sum over all nodes is the mass balance. The
//! transmissivity of a facet is the mean of those of its points, at the jump of the walls and not
//! where their law balances the rock: linearised there it may become negative.

use std::sync::Arc;

use kluft_mesh::Defect;
use lie_core::{ClosureKind, FacetQuadrature, HydraulicAperture};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::balance::{ConditionFlow, FlowBalance};
use super::conductance::{self, Conductance};
use super::fields::FlowFields;
use super::loaded::{FlowState, Loaded, Stored};
use super::numbering::FlowNodes;
use super::operator::FlowOperator;
use super::push::Push;
use super::steady::FlowSystem;
use super::topology::Topology;
use super::undrained::{self, Undrained};
use super::wall_points::WallPoints;
use crate::assembly::interface::Interface;
use crate::problem::{Conduit, Flow, Load, Problem};

/// Share of the aperture that a fracture conducted with before, below which one iteration does not
/// take it.
const LEAST_SHARE: f64 = 0.1;

/// Share of the largest displacement, and of the largest change of a pressure, below which nothing
/// has moved.
const LEAST_MOVED: f64 = 1e-6;

/// Flow coupled with the motion of walls.
#[derive(Debug, Clone)]
pub struct Coupling<'a> {
    pub(super) topology: Arc<Topology<'a>>,
    pub(super) points: WallPoints,
    /// How pressures push on the walls.
    pub(super) push: Push,
    /// How each facet point conducts; none where nothing flows.
    hydraulic: Vec<Option<HydraulicAperture>>,
    /// Whether the walls of each facet point may overlap.
    may_overlap: Vec<bool>,
    /// Whether the flow takes time.
    pub(super) is_transient: bool,
    /// Networks that keep what they hold; none where the flow takes time.
    pub(super) undrained: Vec<Undrained>,
    /// Area of the facets that belongs to each node (m^2).
    areas: Vec<f64>,
    /// What belongs to each node before any load (m^3).
    initial_volumes: Vec<f64>,
    /// Pressure before any load at each row (Pa).
    initial_pressures: Vec<f64>,
}

/// The fluid in a state.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FluidState {
    /// `p - rho g . x` at each node that has a pressure (Pa), less the reference of its network;
    /// nodes ascending.
    pub(crate) potentials: Vec<f64>,
    /// What potentials are counted from in each network (Pa).
    pub(crate) references: Vec<f64>,
    /// What belongs to each of them (m^3) at the end of the last increment.
    pub(crate) volumes: Vec<f64>,
    /// Aperture that each facet point conducts with (m).
    pub(crate) apertures: Vec<f64>,
    /// Flow through each condition at the end of the last increment.
    pub(crate) conditions: Vec<ConditionFlow>,
    /// What has entered through each condition since the run began (m^3); zero in steady states.
    pub(crate) entered: Vec<f64>,
    /// Balance of the last increment.
    pub(crate) balance: FlowBalance,
}

/// An increment of a flow.
#[derive(Debug, Clone)]
pub(crate) struct FlowIncrement {
    /// What belonged to each node when it began (m^3).
    pub(crate) volumes: Vec<f64>,
    /// The load that it begins under; none for a steady state.
    from: Option<Load>,
}

impl FlowIncrement {
    /// How long it takes to a load (s); none for a steady state.
    pub(super) fn duration(&self, to: &Load) -> Option<f64> {
        self.from.as_ref().map(|from| to.time - from.time)
    }
}

/// A flow at some apertures and potentials.
#[derive(Debug, Clone)]
pub(crate) struct FlowAtWalls {
    pub(super) operator: FlowOperator,
    /// What conditions drive into each node, less what flows on and what is stored (m^3/s).
    pub(super) missing: Vec<f64>,
    /// What belongs to each node (m^3).
    pub(crate) volumes: Vec<f64>,
    /// `dV/dV_0` of each node, the factor of the density.
    pub(super) density: Vec<f64>,
    /// `sum A s b` of each node (m^3).
    pub(super) spaces: Vec<f64>,
    /// `dT/db` at each facet point (m^2/(Pa s)).
    pub(super) slopes: Vec<f64>,
    /// `1 / tau` of each network that keeps what it holds (1/s).
    pub(super) keeping: Vec<f64>,
    /// The balance.
    pub(crate) balance: FlowBalance,
    /// Flow through each condition.
    pub(crate) conditions: Vec<ConditionFlow>,
}

impl<'a> Coupling<'a> {
    /// The flow of a problem that follows the walls of an interface, whose facet points have these
    /// apertures (m) to begin with.
    ///
    /// # Errors
    /// As [`FlowSystem::of`]; fractures integrated at Gauss points, where jumps and pressures do
    /// not belong to one node; walls in contact that leave nothing open; in steady flow, networks
    /// without a pressure that do not keep what they hold.
    pub fn of(
        problem: &'a Problem,
        flow: &'a Flow,
        interface: &Interface,
        apertures: &[f64],
    ) -> Result<Self, Vec<Defect>> {
        let mesh = &problem.mesh;
        let unfit = unfit_walls(problem, flow, interface);
        if !unfit.is_empty() {
            return Err(unfit);
        }
        let nodes = FlowNodes::of(mesh, flow);
        let at_nodes = &apertures[..mesh.facets.elements.nodes.len()];
        let transmissivity = conductance::transmissivities(mesh, flow, &nodes, at_nodes);
        let (topology, conductance) = Topology::of((mesh, flow), nodes, transmissivity)?;
        let topology = Arc::new(topology);
        let is_transient = problem.schedule.is_timed;
        if !is_transient {
            let system = FlowSystem::with(topology.clone(), conductance);
            let refused = match flow.is_undrained {
                true => system.unbalanced(),
                false => system.undriven(),
            };
            if !refused.is_empty() {
                return Err(refused);
            }
        }
        let points = WallPoints::of(&topology, interface);
        let conduit = |(index, facet): (usize, u32)| match flow.conduit(mesh, facet as usize) {
            Conduit::Open(hydraulic) if points.conducts(index) => Some(hydraulic),
            _ => None,
        };
        let facets = interface.points().iter().map(|point| point.facet);
        let laws = interface.points().iter();
        let laws = laws.map(|point| &interface.laws()[point.law as usize]);
        let areas = points.at_rows(&vec![1.0; apertures.len()]);
        let undrained = match is_transient {
            true => Vec::new(),
            false => undrained::find(&topology, &areas),
        };
        Ok(Self {
            hydraulic: facets.enumerate().map(conduit).collect(),
            may_overlap: laws.map(|law| law.closure.kind.may_overlap()).collect(),
            areas,
            undrained,
            initial_volumes: points.at_rows(apertures),
            push: Push::of(interface, &points),
            initial_pressures: topology.initial_pressures(),
            points,
            topology,
            is_transient,
        })
    }

    /// What flows, and what drives it.
    pub(crate) fn flow(&self) -> &'a Flow {
        self.topology.flow
    }

    /// Whether the flow takes time.
    pub fn is_transient(&self) -> bool {
        self.is_transient
    }

    /// Whether fluid is trapped between walls: it takes time to leave, or never does.
    pub fn traps(&self) -> bool {
        self.is_transient || !self.undrained.is_empty()
    }

    /// Number of pressures.
    pub fn nodes(&self) -> usize {
        self.topology.nodes.len()
    }

    /// How far two fluids are apart under a load: the larger of the volume that they fill at
    /// different places, as a share of what has moved since the run began,
    /// `sum |V_a - V_b| / sum |V_b - V_0|`, and of the same for pressures by the area of their
    /// nodes, as root mean squares. What has moved counts from a share of what it would be if all
    /// walls had opened and all pressures changed by the `largest` so far (m, Pa).
    pub(crate) fn difference(
        &self,
        [a, b]: [&FluidState; 2],
        load: &Load,
        largest: [f64; 2],
    ) -> f64 {
        let mut volumes = [0.0; 2];
        let mut squares = [0.0; 2];
        let [first, second] = [a, b].map(|fluid| self.pressures(fluid, load));
        for (row, (first, second)) in first.iter().zip(second).enumerate() {
            volumes[0] += (a.volumes[row] - b.volumes[row]).abs();
            volumes[1] += (b.volumes[row] - self.initial_volumes[row]).abs();
            squares[0] += self.areas[row] * (first - second).powi(2);
            squares[1] += self.areas[row] * (second - self.initial(row)).powi(2);
        }
        let area: f64 = self.areas.iter().sum();
        let least = largest.map(|largest| LEAST_MOVED * largest);
        volumes[1] = volumes[1].max(area * least[0]);
        squares[1] = squares[1].max(area * least[1].powi(2));
        let share = |[apart, moved]: [f64; 2]| if apart == 0.0 { 0.0 } else { apart / moved };
        share(volumes).max(share(squares).sqrt())
    }

    /// Whether a fluid has the numbers of this flow.
    pub(crate) fn fits(&self, fluid: &FluidState) -> bool {
        let conditions = self.topology.flow.conditions.len();
        [fluid.potentials.len(), fluid.volumes.len()] == [self.nodes(); 2]
            && fluid.references.len() == self.topology.networks.len()
            && fluid.apertures.len() == self.hydraulic.len()
            && [fluid.conditions.len(), fluid.entered.len()] == [conditions; 2]
    }

    /// The fluid before any load, between walls of these apertures (m).
    pub(crate) fn start(&self, load: &Load, apertures: &[f64]) -> FluidState {
        let loaded = Loaded::of(&self.topology, load).counted_from_means();
        let rows = 0..self.nodes();
        let potentials = rows.map(|row| self.initial(row) - loaded.weight(row));
        let none = ConditionFlow::steady(0.0, 0.0);
        let conditions = self.topology.flow.conditions.len();
        FluidState {
            potentials: potentials.collect(),
            references: loaded.references.clone(),
            volumes: self.initial_volumes.clone(),
            apertures: apertures.to_vec(),
            conditions: vec![none; conditions],
            entered: vec![0.0; conditions],
            balance: FlowBalance::default(),
        }
    }

    /// Pressure before any load at a row (Pa).
    pub(super) fn initial(&self, row: usize) -> f64 {
        self.initial_pressures[row]
    }

    /// Moves a fluid to another load: pressures stay, but those that are given.
    pub(crate) fn move_load(&self, fluid: &mut FluidState, from: &Load, to: &Load) {
        let pressures = self.pressures(fluid, from);
        let to = Loaded::of(&self.topology, to).counted_from_means_of(pressures.iter().copied());
        let from = self.loaded(fluid, from);
        for (row, potential) in fluid.potentials.iter_mut().enumerate() {
            *potential += from.weight(row) - to.weight(row);
        }
        to.set_given(&mut fluid.potentials);
        fluid.references = to.references;
    }

    /// The load of a fluid, with potentials counted as it has them.
    pub(super) fn loaded<'s>(&'s self, fluid: &FluidState, load: &'s Load) -> Loaded<'s, 'a> {
        Loaded::of(&self.topology, load).counted_from(&fluid.references)
    }

    /// Pressures of a fluid under a load (Pa), nodes ascending.
    pub(crate) fn pressures(&self, fluid: &FluidState, load: &Load) -> Vec<f64> {
        let loaded = self.loaded(fluid, load);
        let rows = fluid.potentials.iter().enumerate();
        rows.map(|(row, phi)| phi + loaded.weight(row)).collect()
    }

    /// The increment of a fluid that begins under a load.
    pub(crate) fn increment(&self, fluid: &FluidState, from: Load) -> FlowIncrement {
        FlowIncrement {
            volumes: fluid.volumes.clone(),
            from: self.is_transient.then_some(from),
        }
    }

    /// Adds changes of the pressures that are not given (Pa).
    pub(crate) fn add(&self, potentials: &mut [f64], changes: &[f64]) {
        for (&row, change) in self.topology.free.iter().zip(changes) {
            potentials[row as usize] += change;
        }
    }

    /// Apertures to conduct with after an iteration that has led to `reached` from where fractures
    /// conducted with `before` (m). Walls that may overlap are where they are.
    pub(crate) fn conducting(&self, before: &[f64], reached: &[f64]) -> Vec<f64> {
        let pairs = before.par_iter().zip(reached).zip(&self.may_overlap);
        pairs
            .map(|((before, reached), may_overlap)| match may_overlap {
                true => *reached,
                false => reached.max(LEAST_SHARE * before),
            })
            .collect()
    }

    /// Pressure at each facet point (Pa); 0 where nothing flows.
    pub(crate) fn point_pressures(&self, fluid: &FluidState, load: &Load) -> Vec<f64> {
        let pressures = self.pressures(fluid, load);
        self.points.at_points(|row| pressures[row])
    }

    /// The flow of a fluid in an increment to a load, between walls that store at these apertures
    /// (m).
    pub(crate) fn at(
        &self,
        fluid: &FluidState,
        storing: &[f64],
        (increment, load): (&FlowIncrement, &Load),
    ) -> FlowAtWalls {
        let viscosity = self.topology.flow.fluid.viscosity;
        let conduction = |point: usize| {
            let hydraulic = self.hydraulic[point];
            hydraulic.map(|hydraulic| hydraulic.at(fluid.apertures[point]))
        };
        let transmissivity = self.points.at_facets(|point| {
            conduction(point).map_or(0.0, |conduction| conduction.transmissivity(viscosity))
        });
        let slope =
            |point: usize| conduction(point).map_or(0.0, |own| own.transmissivity_slope(viscosity));
        let Topology {
            nodes, stencils, ..
        } = &*self.topology;
        let conductance = Conductance::of(nodes, stencils, transmissivity);
        let operator = FlowOperator::of(&self.topology, conductance);
        let mut loaded = self.loaded(fluid, load);
        loaded.from = increment.from.as_ref();
        let potentials = &fluid.potentials;
        let compressibility = self.topology.flow.fluid.compressibility;
        let density = potentials.iter().enumerate().map(|(row, potential)| {
            1.0 + compressibility * (potential + loaded.weight(row) - self.initial(row))
        });
        let density: Vec<f64> = density.collect();
        let spaces = self.points.at_rows(storing);
        let volumes = density.iter().zip(&spaces).map(|(rho, space)| rho * space);
        let volumes: Vec<f64> = volumes.collect();
        if let Some(duration) = increment.duration(load) {
            let pairs = volumes.iter().zip(&increment.volumes);
            loaded.stored = Some(Stored {
                rates: pairs.map(|(now, then)| (now - then) / duration).collect(),
                terms: volumes.iter().map(|volume| volume.abs()).sum::<f64>() / duration,
            });
        }
        let keeping = self.keeping(&operator, (fluid, load), &increment.volumes);
        loaded.kept = self.kept(&keeping, [&volumes, &increment.volumes]);
        let missing = loaded.missing(&operator, potentials);
        let state = loaded.state(&operator, potentials.clone());
        FlowAtWalls {
            slopes: (0..self.hydraulic.len())
                .into_par_iter()
                .map(slope)
                .collect(),
            keeping,
            balance: state.balance,
            conditions: state.conditions,
            operator,
            missing,
            volumes,
            density,
            spaces,
        }
    }

    /// A flow that has converged under a load, as the state that the next increment starts from.
    pub(crate) fn commit(
        &self,
        fluid: &mut FluidState,
        flow: &FlowAtWalls,
        (increment, load): (&FlowIncrement, &Load),
    ) {
        fluid.volumes.clone_from(&flow.volumes);
        fluid.conditions.clone_from(&flow.conditions);
        fluid.balance = flow.balance;
        let duration = increment.duration(load).unwrap_or(0.0);
        for (entered, condition) in fluid.entered.iter_mut().zip(&flow.conditions) {
            *entered += condition.mean_rate * duration;
        }
    }

    /// The flow in a state under a load, for results.
    pub fn state(&self, fluid: &FluidState, load: &Load) -> FlowState {
        FlowState {
            pressures: self.pressures(fluid, load),
            potentials: fluid.potentials.clone(),
            conditions: fluid.conditions.clone(),
            entered: fluid.entered.clone(),
            balance: fluid.balance,
        }
    }

    /// The fields of a state under a load; `apertures` (m) are those at the nodes of the facets.
    pub fn fields(&self, fluid: &FluidState, load: &Load, apertures: &[f64]) -> FlowFields {
        let system = self.system(fluid);
        system.fields(&self.state(fluid, load), apertures)
    }

    /// The flow through walls as far apart as they are.
    pub(super) fn system(&self, fluid: &FluidState) -> FlowSystem<'a> {
        let (nodes, stencils) = (&self.topology.nodes, &self.topology.stencils);
        let viscosity = self.topology.flow.fluid.viscosity;
        let transmissivity = self.points.at_facets(|point| {
            let hydraulic = self.hydraulic[point];
            hydraulic.map_or(0.0, |own| {
                own.at(fluid.apertures[point]).transmissivity(viscosity)
            })
        });
        let conductance = Conductance::of(nodes, stencils, transmissivity);
        FlowSystem::with(self.topology.clone(), conductance)
    }
}

/// Fractures whose walls a flow cannot follow: those integrated at Gauss points, and those whose
/// walls come into contact and leave nothing open.
pub fn unfit_walls(problem: &Problem, flow: &Flow, interface: &Interface) -> Vec<Defect> {
    let mut defects = gauss_points(problem, interface);
    defects.extend(shut_contacts(problem, flow, interface));
    defects
}

/// Walls in contact between which nothing could flow.
fn shut_contacts(problem: &Problem, flow: &Flow, interface: &Interface) -> Vec<Defect> {
    let leaves_nothing = |conduit: &Conduit| {
        matches!(
            conduit,
            Conduit::Open(HydraulicAperture::OfWalls { residual, .. }) if *residual == 0.0
        )
    };
    let touches = |fracture: usize| {
        let mut points = interface.points().iter();
        points.any(|point| {
            let law = &interface.laws()[point.law as usize];
            point.fracture as usize == fracture && law.closure.kind == ClosureKind::Contact
        })
    };
    let fractures = problem.mesh.fractures.iter().zip(&flow.conduits);
    let fractures = fractures.enumerate();
    let shut = fractures.filter(|(index, (_, conduit))| leaves_nothing(conduit) && touches(*index));
    let defects = shut.map(|(_, (name, _))| {
        Defect::new(
            format!("fracture `{name}`"),
            "its walls come into contact, and nothing could flow between them then",
            "give it a residual hydraulic aperture (residual_hydraulic_aperture = 1e-6)",
        )
    });
    defects.collect()
}

/// Fractures integrated at Gauss points.
fn gauss_points(problem: &Problem, interface: &Interface) -> Vec<Defect> {
    let fractures = problem.mesh.fractures.iter().zip(0_u32..);
    let gauss = fractures.filter(|(_, index)| interface.rule_of(*index) == FacetQuadrature::Gauss);
    let defects = gauss.map(|(name, _)| {
        Defect::new(
            format!("fracture `{name}`"),
            "it is integrated at Gauss points, where flow cannot follow its walls",
            "integrate it at its nodes (facets = \"nodal\")",
        )
    });
    defects.collect()
}
