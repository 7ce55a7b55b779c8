//! Load steps on rock that stays prepared, one at a time, as a caller asks for them.
//!
//! The stiffness of the rock is assembled and prepared once. A step brings factors on what acts,
//! fluid pressures that somebody else has computed, or other laws, and costs a solve for the jumps.

use glam::DVec3;
use kluft_io::Grid;
use kluft_mesh::Defect;
use kluft_scene::{Binding, Scene};
use kluft_solver::{
    CaseLoads, Load, Loads, Newton, Problem, State, Step, StepOutcome, StepRecord, System,
    determinacy, solution,
};
use lie_core::FractureLaw;

use crate::cases::{ActingCases, separate};
use crate::failures;
use crate::fractures::fractures;
use crate::grids::{facet_grid, fracture_grid, in_plane, rock_grid};
use crate::history::{Entry, Parts};
use crate::observer::{Observer, Stage, StepStart};
use crate::outcome::StepResult;
use crate::output::Output;
use crate::request::Request;
use crate::resume;
use crate::stages::{Interruption, Run};
use crate::summary::{StepFracture, StepMeasures, StepSummary, Summary};
use crate::undetermined;
use crate::unresolved;

/// What a further load step brings.
#[derive(Debug, Clone)]
pub struct Advance {
    /// Time at its end; the number of the step if none is given.
    pub time: Option<f64>,
    /// Factor on each thing that acts, see [`PreparedRock::acting`].
    pub factors: Vec<f64>,
    /// Fluid pressure on the walls (Pa) at the nodes of the facets, in the order of the points of
    /// [`PreparedRock::fracture_points`]; those of the step before if none are given. It acts
    /// beside what the scene gives.
    pub pressures: Option<Vec<f64>>,
    /// Law of each fracture from now on; those of the step before if none are given.
    pub laws: Option<Vec<FractureLaw>>,
    /// Whether the result holds the rock too.
    pub with_rock: bool,
}

/// Rock that is prepared, and the state that it is in.
pub struct PreparedRock<'r, 'a, 'p> {
    run: &'r mut Run<'a>,
    system: System<'p>,
    newton: Newton,
    state: State,
    acting: ActingCases,
    steps: usize,
    /// Share of the last step that was solved.
    completed: f64,
}

/// Prepares the rock of a scene for load steps that `drive` asks for; those of the scene are not
/// solved. Nothing is written.
///
/// # Errors
/// Defects of geometry, mesh and scene, a scene whose fluid flows, and rock that cannot be
/// prepared.
pub fn with_prepared_rock<T: Send>(
    request: Request<'_>,
    observer: &mut dyn Observer,
    drive: impl FnOnce(&mut PreparedRock<'_, '_, '_>) -> T + Send,
) -> Result<T, Interruption> {
    let pool = request.pool;
    pool.install(|| {
        let output = Output::nowhere()?;
        let identity = resume::identity(request.scene, None);
        let mut run = Run::new(request, output, observer, identity, None);
        let mut binding = run.prepare(None)?;
        refuse_flow(&binding)?;
        refuse_stages(run.request.scene)?;
        let acting = separate(&mut binding.problem);
        let mut rock = prepare(&mut run, &binding, acting)?;
        Ok(drive(&mut rock))
    })
}

fn refuse_stages(scene: &Scene) -> Result<(), Defect> {
    if !scene.has_stages() {
        return Ok(());
    }
    let remedy = "run the scene as it is, or remove `remove` and `add` from its phases";
    let problem = "phases remove or add volumes, and prepared rock is one body";
    Err(Defect::new("[load]", problem, remedy))
}

fn refuse_flow(binding: &Binding) -> Result<(), Defect> {
    if binding.flow.is_none() {
        return Ok(());
    }
    let remedy = "remove [fluid], and give pressures with each step; or run the scene as it is";
    let problem = "the pressures are computed, and cannot be given as well";
    Err(Defect::new("[fluid]", problem, remedy))
}

fn prepare<'r, 'a, 'p>(
    run: &'r mut Run<'a>,
    binding: &'p Binding,
    acting: ActingCases,
) -> Result<PreparedRock<'r, 'a, 'p>, Interruption> {
    let mut system = run.assemble(&binding.problem)?;
    let steps = binding.problem.schedule.steps.len();
    let plan = run.plan(&system, steps, None)?;
    run.decide(binding);
    let newton = run.set_up(&mut system, plan)?;
    // The pressures of a step and those of the step before are cases of their own, so that all
    // between the two is defined.
    let unknowns = system.discretisation().points().len();
    let idle = CaseLoads {
        applied: vec![DVec3::ZERO; unknowns],
        prescribed: vec![DVec3::ZERO; unknowns],
    };
    let mut cases = system.loads().cases().to_vec();
    cases.extend([idle.clone(), idle]);
    let loads = Loads::new(cases, system.loads().initial().to_vec());
    system.set_loads(loads);
    Ok(PreparedRock {
        state: system.initial_state(),
        run,
        system,
        newton,
        acting,
        steps: 0,
        completed: 1.0,
    })
}

impl PreparedRock<'_, '_, '_> {
    /// What acts, each with a factor of its own.
    pub fn acting(&self) -> &ActingCases {
        &self.acting
    }

    /// What is solved.
    pub fn problem(&self) -> &Problem {
        self.system.problem()
    }

    /// The facets, each with points of its own, without results.
    pub fn fracture_points(&self) -> Grid {
        facet_grid(&self.system.problem().mesh, Vec::new())
    }

    /// The numbers so far.
    pub fn summary(&self) -> &Summary {
        &self.run.summary
    }

    /// The history so far, as `history.csv` would hold it.
    pub fn history(&self) -> &str {
        self.run.history.text()
    }

    /// Share of the last step that was solved: 1, unless it did not converge.
    pub fn completed(&self) -> f64 {
        self.completed
    }

    /// Solves a further load step from where the last one ended. A step that does not converge or
    /// is stopped leaves everything where it was, but for the laws.
    ///
    /// # Errors
    /// Numbers of factors, pressures or laws that do not fit, a step that does not converge, and an
    /// observer who stops it.
    pub fn advance(&mut self, asked: &Advance) -> Result<StepResult, Interruption> {
        self.check(asked)?;
        if let Some(laws) = &asked.laws {
            self.system.set_laws(laws.clone());
        }
        let step = Step {
            load: self.load(asked),
            phase: None,
        };
        let record = self.solve(&step);
        self.completed = record.completed;
        if record.outcome == StepOutcome::Stopped {
            return Err(Interruption::Stopped);
        }
        if !record.converged() {
            let numbered = (self.steps + 1, &step);
            let why = failures::not_converged(&self.system, numbered, &record);
            return Err(Interruption::NotConverged(why));
        }
        self.steps += 1;
        Ok(self.result(&step, &record, asked.with_rock))
    }

    fn check(&self, asked: &Advance) -> Result<(), Vec<Defect>> {
        let problem = self.system.problem();
        let facets = &problem.mesh.facets.elements;
        let pressures = asked.pressures.as_ref();
        let laws = asked.laws.as_ref();
        let counts = [
            ("factors", Some(asked.factors.len()), self.acting.len()),
            ("pressures", pressures.map(Vec::len), facets.nodes.len()),
            ("laws", laws.map(Vec::len), problem.fractures.len()),
        ];
        let wrong = counts.into_iter().filter_map(|(what, found, wanted)| {
            let found = found.filter(|found| *found != wanted)?;
            let problem = format!("there are {found}, and {wanted} are wanted");
            Some(Defect::new(what, problem, "give one for each"))
        });
        let names = problem.mesh.fractures.iter().zip(&problem.fractures);
        let kinked = names.zip(laws.into_iter().flatten());
        let kinked = kinked.filter(|((_, begun), law)| begun.law.is_smooth() && !law.is_smooth());
        let kinked = kinked.map(|((name, _), _)| {
            let problem = "it slides, breaks or ends a contact by its new law, and could not by the \
                           one that the rock was prepared with";
            Defect::new(format!("fracture `{name}`"), problem, "prepare the rock with such a law")
        });
        let defects: Vec<Defect> = wrong.chain(kinked).collect();
        if defects.is_empty() {
            Ok(())
        } else {
            Err(defects)
        }
    }

    /// The load of a step; pressures become forces.
    fn load(&mut self, asked: &Advance) -> Load {
        let count = self.acting.len();
        let former = [count, count + 1].map(|case| self.state.load.factor(case));
        let mut factors = asked.factors.clone();
        match &asked.pressures {
            None => factors.extend(former),
            Some(pressures) => {
                // Where the state is not, so that a step that fails may be asked for again.
                let slot = usize::from(former[0] != 0.0);
                self.push_walls(count + slot, pressures);
                let mut own = [0.0; 2];
                own[slot] = 1.0;
                factors.extend(own);
            }
        }
        Load {
            time: asked.time.unwrap_or((self.steps + 1) as f64),
            factors,
        }
    }

    /// Makes pressures the forces of a case.
    fn push_walls(&mut self, case: usize, pressures: &[f64]) {
        let interface = self.system.discretisation().interface();
        let pressures = interface.point_values(&self.system.problem().mesh, pressures);
        let mut cases = self.system.loads().cases().to_vec();
        cases[case].applied.fill(DVec3::ZERO);
        interface.add_pressures(&pressures, &mut cases[case].applied);
        let loads = Loads::new(cases, self.system.loads().initial().to_vec());
        self.system.set_loads(loads);
    }

    fn solve(&mut self, step: &Step) -> StepRecord {
        let number = self.steps + 1;
        let Self {
            run,
            system,
            newton,
            state,
            ..
        } = self;
        run.observer.step_begins(StepStart {
            number,
            count: number,
            what: &format!("time {}", step.load.time),
        });
        let record = run.stage(Stage::Solve, |run| {
            newton.solve_step(system, state, &step.load, |number, iteration| {
                run.observer.iteration(number, iteration)
            })
        });
        run.summary.seconds.factorise += record.factorise_seconds;
        run.summary.seconds.solve += record.solve_seconds;
        record
    }

    /// Sums up the state.
    fn result(&mut self, step: &Step, record: &StepRecord, with_rock: bool) -> StepResult {
        let (system, run) = (&self.system, &mut *self.run);
        let solution = solution(system, &self.state);
        let interface = system.discretisation().interface();
        let nodes = solution.facet_nodes(system.problem(), interface);
        let mut fractures = fractures(system.problem(), interface, &solution, &nodes);
        let mesh = &system.problem().mesh;
        let mut grid = fracture_grid(system, &nodes, None);
        if let Some(facets) = determinacy(system, &self.state) {
            undetermined::note_in(&mut fractures, system, &facets);
            grid.cell_fields.push(undetermined::field(&facets));
        }
        let unresolved = unresolved::of_step(system, record);
        let summary = StepSummary {
            fractures: StepFracture::all(&fractures),
            ..StepSummary::of(step, StepMeasures::of(record, unresolved))
        };
        run.summary.steps.push(summary.clone());
        run.summary.fractures.clone_from(&fractures);
        run.history.add(&Entry {
            number: self.steps,
            step,
            newton_iterations: record.iterations.len(),
            fractures: &fractures,
            parts: Parts::of(system, &self.state, &solution),
            flow: None,
        });
        StepResult {
            summary,
            fractures,
            rock: match with_rock {
                true => in_plane(mesh, rock_grid(system, &solution, None, None)),
                false => Grid {
                    offsets: vec![0],
                    ..Grid::default()
                },
            },
            fracture_grid: in_plane(mesh, grid),
        }
    }
}
