//! Short forms of the studies of the stability map: what docs/verification/stability.md says must
//! hold.

use kluft_verification::report::{Effort, Finding, Study};
use kluft_verification::stability::{
    contact, contrast, coupled_flow, cutoff, cycles, flow, front, hopeless, increments,
};
use kluft_verification::stability::{locking, opening, sliding, slivers, steps, units};

/// Runs a study; what it promises must hold, and its charts must be drawn.
fn hold(study: &Study) -> Finding {
    let finding = (study.run)(Effort::Quick);
    println!("{}: {}", study.name, finding.summary.join("; "));
    assert!(
        finding.misses.is_empty(),
        "{}: {:#?}",
        study.name,
        finding.misses
    );
    for (name, chart) in finding.all_charts() {
        let svg = chart.svg();
        assert!(
            svg.contains(&chart.x.title) && !svg.contains("NaN"),
            "{name}"
        );
    }
    finding
}

/// Numbers of a column.
fn column(finding: &Finding, head: &str) -> Vec<f64> {
    let table = finding.first_table();
    let place = table.column(head);
    let entries = table.rows.iter().map(|row| &row[place]);
    entries
        .map(|entry| entry.parse().unwrap_or(f64::NAN))
        .collect()
}

#[test]
fn newton_does_not_see_the_cutoff_and_plain_newton_does() {
    let finding = hold(&cutoff::STUDY);
    assert!(column(&finding, "Kluft").iter().all(|count| *count <= 8.0));
    let plain = column(&finding, "plain Newton");
    assert!(plain.iter().any(|count| count.is_nan()), "{plain:?}");
}

#[test]
fn flow_does_not_see_small_angles_and_flat_facets() {
    let finding = hold(&flow::STUDY);
    assert!(column(&finding, "rates").iter().all(|error| *error < 1e-9));
}

#[test]
fn flow_opens_and_closes_joints_in_few_iterations() {
    let finding = hold(&coupled_flow::STUDY);
    let most = column(&finding, "most of a part");
    let cases = finding.first_table().rows.iter().zip(&most);
    for (case, count) in cases {
        assert!(*count <= 10.0, "{case:?}");
    }
    assert!(column(&finding, "mass").iter().all(|error| *error < 1e-10));
}

#[test]
fn stiff_joints_spoil_split_nodes_and_not_jumps() {
    let finding = hold(&contrast::STUDY);
    let [split, jumps] = ["condition, split nodes", "condition, jumps"]
        .map(|head| *column(&finding, head).last().expect("a row"));
    assert!(split > 1e8 && jumps < 1e3, "{split:e}, {jumps:e}");
    let ours = column(&finding, "iterations, Kluft");
    assert!(*ours.last().expect("a row") < 40.0, "{ours:?}");
}

#[test]
fn gauss_points_change_signs_behind_a_front_and_nodes_do_not() {
    let finding = hold(&front::STUDY);
    let ratios = column(&finding, "smallest / largest");
    let rules = finding.first_table().rows.iter().map(|row| &row[1]);
    let wrong = |rule: &str| {
        let pairs = ratios.iter().zip(rules.clone());
        pairs
            .filter(|(ratio, own)| *own == rule && **ratio < 0.0)
            .count()
    };
    assert!(wrong("Gauss") > 0);
    assert_eq!(wrong("nodal"), 0);
}

/// Ratios to two digits from a computation by hand: `sum f'(x_i) dx / f(0.1)`.
#[test]
fn the_incremental_law_depends_on_the_number_of_steps() {
    hold(&increments::STUDY);
    let closure = kluft_verification::scenes::joint(kluft_verification::scenes::EXACT)
        .law
        .closure;
    let table = [
        (1, 7.577),
        (2, 3.974),
        (5, 2.005),
        (10, 1.446),
        (100, 1.038),
    ];
    for (steps, ratio) in table {
        let found = increments::incremental_ratio(&closure, steps);
        assert!((found / ratio - 1.0).abs() < 1e-3, "{steps}: {found}");
    }
}

#[test]
fn cycles_leave_nothing() {
    hold(&cycles::STUDY);
}

/// Where linear cells lock (an error of nearly everything), quadratic ones on a mesh of twice the
/// size keep most of the answer.
#[test]
fn quadratic_cells_hardly_lock() {
    let finding = hold(&locking::STUDY);
    let traction = column(&finding, "error of the traction");
    assert!(
        traction[1] > 0.5 && traction[3] < 0.2 * traction[1],
        "{traction:?}"
    );
}

#[test]
fn small_angles_cost_iterations_and_not_digits() {
    hold(&slivers::STUDY);
}

#[test]
fn units_do_not_matter() {
    hold(&units::STUDY);
}

#[test]
fn steps_do_not_matter() {
    hold(&steps::STUDY);
}

#[test]
fn contact_needs_no_penalty() {
    let finding = hold(&contact::STUDY);
    let penetration = column(&finding, "penetration / displacement");
    assert!(
        penetration[0] > 0.1 && penetration[3] < 1e-12,
        "{penetration:?}"
    );
}

/// Every law keeps the promise on the iterations; what it leaves over a cycle is Newton's error.
#[test]
fn joints_without_tension_open_and_close() {
    hold(&opening::STUDY);
}

/// A step of shear is divided into many parts, each of which keeps the promise.
#[test]
fn friction_converges_and_keeps_its_limit() {
    let finding = hold(&sliding::STUDY);
    let beyond = column(&finding, "shear beyond the limit");
    assert!(beyond.iter().all(|excess| *excess < 1e-9), "{beyond:?}");
}

#[test]
fn a_block_that_its_joint_lets_go_is_named() {
    let finding = hold(&hopeless::STUDY);
    for scene in &finding.first_table().rows {
        assert_eq!(scene[1], "1", "{scene:?}");
        assert!(scene[2].contains("`joint`"), "{scene:?}");
    }
}
