//! Contact by an augmented Lagrangian, to compare with: Uzawa's iteration on multipliers at the
//! facet points (Alart & Curnier 1991; Simo & Laursen 1992), around a semi-smooth Newton method.

use glam::{DMat3, DVec3};
use kluft_solver::{Load, NewtonSettings, Plan, System, TangentSolver, Unknowns, Workload, norm};

/// Changes of the multipliers, against the largest, that end the outer iteration.
const SETTLED: f64 = 1e-9;
/// Outer iterations after which it has failed.
const OUTER: usize = 200;

/// What the iteration ends with.
#[derive(Debug, Clone)]
pub struct Augmented {
    /// Openings of the facet points (m).
    pub openings: Vec<f64>,
    /// Normal tractions of the facet points, their multipliers (Pa).
    pub tractions: Vec<f64>,
    /// Updates of the multipliers.
    pub outer: usize,
    /// Linear solves of all inner iterations.
    pub newton: usize,
    /// How often the active set, and with it the matrix, changed.
    pub factorisations: usize,
    /// Memory that the linear solver was predicted to take (bytes).
    pub memory: usize,
}

/// What the iteration works on.
struct Uzawa<'a> {
    system: &'a System<'a>,
    load: Load,
    settings: NewtonSettings,
    /// `r` (Pa/m).
    stiffness: f64,
    unknowns: Vec<DVec3>,
    /// `lambda` (Pa), one a facet point.
    multipliers: Vec<f64>,
    /// Which facet points the matrix was made with.
    active: Option<Vec<bool>>,
    newton: usize,
    factorisations: usize,
}

impl Uzawa<'_> {
    /// Openings (m), and `sigma = min(0, lambda + r w_n)` (Pa).
    fn walls(&self) -> (Vec<f64>, Vec<f64>) {
        let interface = self.system.discretisation().interface();
        let jumps = interface.jumps(&self.unknowns, &self.load);
        let openings = jumps.iter().zip(interface.points());
        let openings: Vec<f64> = openings.map(|(w, point)| w.dot(point.normal)).collect();
        let pairs = openings.iter().zip(&self.multipliers);
        let tractions = pairs.map(|(w, lambda)| (lambda + self.stiffness * w).min(0.0));
        (openings.clone(), tractions.collect())
    }

    /// Tractions (Pa) and tangents (Pa/m) of the facet points, and which of them touch.
    fn responses(&self) -> (Vec<DVec3>, Vec<DMat3>, Vec<bool>) {
        let interface = self.system.discretisation().interface();
        let jumps = interface.jumps(&self.unknowns, &self.load);
        let each = interface.points().iter().enumerate().map(|(index, point)| {
            let (n, w) = (point.normal, jumps[index]);
            let across = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
            let shear = self.system.law(point).shear_stiffness;
            let sigma = self.multipliers[index] + self.stiffness * w.dot(n);
            let touches = sigma <= 0.0;
            let traction = sigma.min(0.0) * n + shear * (w - w.dot(n) * n);
            let normal = if touches { self.stiffness } else { 0.0 };
            let tangent = normal * across + shear * (DMat3::IDENTITY - across);
            (traction, tangent, touches)
        });
        let (mut tractions, mut tangents, mut active) = (Vec::new(), Vec::new(), Vec::new());
        for (traction, tangent, touches) in each {
            tractions.push(traction);
            tangents.push(tangent);
            active.push(touches);
        }
        (tractions, tangents, active)
    }

    /// Balances rock and fractures for fixed multipliers; nothing if that fails.
    fn balance(&mut self, linear: &mut dyn TangentSolver) -> Option<()> {
        for count in 0..=self.settings.max_iterations {
            let (tractions, tangents, active) = self.responses();
            let rock = self.system.rock_forces(&self.unknowns);
            let residual = self.system.residual(&rock, &tractions, &self.load);
            let scale = self.system.force_scale(&rock, &tractions, &self.load);
            // Without a solve, multipliers would drift within the tolerance and never settle.
            if count > 0 && norm(&residual) <= self.settings.force * scale {
                return Some(());
            }
            if self.active.as_ref() != Some(&active) {
                let stiffness = self
                    .system
                    .discretisation()
                    .interface()
                    .stiffness(&tangents);
                linear.update(self.system.fixed_part(), stiffness).ok()?;
                self.factorisations += 1;
                self.active = Some(active);
            }
            let tolerance = 0.1 * self.settings.force;
            let fixed = self.system.fixed_part();
            let solution = linear.solve(fixed, &residual, tolerance).ok()?;
            let moves = self.unknowns.iter_mut().zip(&solution.unknowns);
            moves.for_each(|(unknown, step)| *unknown += *step);
            self.newton += 1;
        }
        None
    }
}

/// Solves a load step at factor 1 from the state without load, with the augmentation stiffness `r`
/// (Pa/m). Walls touch where they are drawn, `w_n >= 0`; shear is as the laws of the system have
/// it, elastic. Nothing if an inner or the outer iteration does not converge.
pub fn augmented(
    system: &System<'_>,
    stiffness: f64,
    settings: NewtonSettings,
) -> Option<Augmented> {
    let unknowns = Unknowns::from(system.discretisation());
    let workload = Workload::of_system(system, 1.0);
    let points = system.discretisation().points().len();
    let workload = workload.with_extra_memory(&system.problem().mesh, points);
    let plan = Plan::of(unknowns, workload, settings.linear, usize::MAX).ok()?;
    let memory = plan.prediction().memory_bytes;
    let mut linear = plan.prepare(system).ok()?;
    let mut uzawa = Uzawa {
        system,
        load: Load::proportional(1.0),
        settings,
        stiffness,
        unknowns: vec![DVec3::ZERO; system.discretisation().points().len()],
        multipliers: vec![0.0; system.discretisation().interface().points().len()],
        active: None,
        newton: 0,
        factorisations: 0,
    };
    for outer in 1..=OUTER {
        uzawa.balance(linear.as_mut())?;
        let (openings, tractions) = uzawa.walls();
        let largest = tractions.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
        let changes = tractions.iter().zip(&uzawa.multipliers);
        let change = changes.fold(0.0, |most: f64, (new, old)| most.max((new - old).abs()));
        uzawa.multipliers.clone_from(&tractions);
        if change <= SETTLED * largest {
            return Some(Augmented {
                openings,
                tractions,
                outer,
                newton: uzawa.newton,
                factorisations: uzawa.factorisations,
                memory,
            });
        }
    }
    None
}
