//! Networks that have no steady state, or more than one.

use kluft_mesh::{Defect, Mesh};

use super::networks::FlowNetwork;
use super::nodal::{Nodal, NodalCondition};
use super::topology::Topology;
use crate::problem::FlowDrive;

/// Code of the defect that no pressure is given to a network, see [`kluft_mesh::Defect::code`].
pub const NO_PRESSURE: &str = "no-pressure";

/// What to do about it. Whoever knows how conditions are written may put it more plainly.
const GIVE_PRESSURE: &str = "give a pressure somewhere on these fractures, or seal them";

/// Rates that add up to less than this share of their sizes cancel.
const CANCELLING: f64 = 1e-12;

/// Networks without a given pressure: those that rates drive, each by itself, and all that nothing
/// drives in one.
pub(super) fn without_pressure(
    topology: &Topology<'_>,
    conditions: &[NodalCondition],
) -> Vec<Defect> {
    let mut defects = Vec::new();
    let mut idle: Vec<&str> = Vec::new();
    let mut idle_count = 0;
    for (index, network) in topology.networks.iter().enumerate() {
        if network.has_pressure {
            continue;
        }
        let names = names(topology.mesh, network);
        if network.conditions.is_empty() {
            idle_count += 1;
            idle.extend(names);
            continue;
        }
        let into = rates_into(topology, conditions, index);
        let problem = match cancel(&into) {
            true => "no pressure is given: it is known up to a constant only".to_owned(),
            false => no_steady_state(&into),
        };
        defects.push(defect(&names, problem));
    }
    if idle_count > 0 {
        idle.sort_unstable();
        idle.dedup();
        let problem = match idle_count {
            1 => "nothing drives a flow, and no pressure is given".to_owned(),
            count => format!(
                "in {count} networks that do not hang together nothing drives a flow, and no pressure is given"
            ),
        };
        defects.push(defect(&idle, problem));
    }
    defects
}

/// Networks without a given pressure into which rates drive what does not leave again.
pub(super) fn unbalanced(topology: &Topology<'_>, conditions: &[NodalCondition]) -> Vec<Defect> {
    let networks = topology.networks.iter().enumerate();
    let undriven = networks.filter(|(_, network)| !network.has_pressure);
    let defects = undriven.filter_map(|(index, network)| {
        let into = rates_into(topology, conditions, index);
        let problem = (!cancel(&into)).then(|| no_steady_state(&into))?;
        Some(defect(&names(topology.mesh, network), problem))
    });
    defects.collect()
}

fn names<'a>(mesh: &'a Mesh, network: &FlowNetwork) -> Vec<&'a str> {
    let fractures = network.fractures.iter();
    let names = fractures.map(|&fracture| mesh.fractures[fracture as usize].as_str());
    names.collect()
}

fn no_steady_state(into: &[(f64, f64)]) -> String {
    let sum: f64 = into.iter().map(|(sum, _)| sum).sum();
    format!(
        "no pressure is given, and the rates add up to {sum:.6e} m3/s: there is no steady state"
    )
}

/// Whether rates cancel whatever the factors of the load cases.
fn cancel(into: &[(f64, f64)]) -> bool {
    into.iter()
        .all(|(sum, size)| sum.abs() <= CANCELLING * size)
}

/// Sum of the rates into a network at load factor 1, and sum of their sizes (m^3/s), of each load
/// case.
fn rates_into(
    topology: &Topology<'_>,
    conditions: &[NodalCondition],
    network: usize,
) -> Vec<(f64, f64)> {
    let all = &topology.flow.conditions;
    let cases = all.iter().map(|condition| condition.case + 1).max();
    let mut sums = vec![(0.0, 0.0); cases.unwrap_or(0)];
    for NodalCondition { condition, nodal } in conditions {
        let FlowDrive::Rate(rate) = all[*condition].drive else {
            continue;
        };
        let inside = |row: usize| topology.network_of_row[row] as usize == network;
        let share: f64 = match nodal {
            Nodal::Shared(shares) => {
                let own = shares.iter().filter(|(row, _)| inside(*row));
                own.map(|(_, share)| share).sum()
            }
            Nodal::WellRate(well) => f64::from(u8::from(inside(well.row))),
            Nodal::Given(_) | Nodal::PerArea(_) | Nodal::WellPressure(_) => 0.0,
        };
        let (sum, size) = &mut sums[all[*condition].case];
        *sum += share * rate;
        *size += (share * rate).abs();
    }
    sums
}

fn defect(names: &[&str], problem: String) -> Defect {
    let word = if names.len() == 1 {
        "fracture"
    } else {
        "fractures"
    };
    let place = format!("{word} `{}`", names.join("`, `"));
    Defect::new(place, problem, GIVE_PRESSURE).with_code(NO_PRESSURE)
}
