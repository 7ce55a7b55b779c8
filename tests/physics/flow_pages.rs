//! Short forms of the pages of the verification book on flow: what they say must hold on a few
//! meshes and steps.

use kluft_verification::book;
use kluft_verification::report::{Effort, Finding, Part, Table};

fn page(name: &str) -> Finding {
    let pages = book::report().studies;
    let page = pages.iter().find(|page| page.name == name);
    (page.expect("a page").run)(Effort::Quick)
}

/// The table in a file.
fn table<'a>(finding: &'a Finding, file: &str) -> &'a Table {
    let tables = finding.parts.iter().filter_map(|part| match part {
        Part::Numbers(numbers) if numbers.name == Some(file) => Some(&numbers.table),
        _ => None,
    });
    let mut tables = tables;
    tables.next().unwrap_or_else(|| panic!("no {file}"))
}

/// Whether errors at the last size are at most `error`, and orders there at least `order`.
fn hold(table: &Table, of: &str, [error, order]: [f64; 2]) {
    let [errors, orders] = ["error", "order"].map(|head| table.column(head));
    let last = table
        .rows
        .iter()
        .filter(|row| row[0].contains(of) && !row[orders].is_empty());
    let mut count = 0;
    for row in last {
        let number = |place: usize| row[place].parse::<f64>().expect("a number");
        assert!(number(errors) <= error, "{row:?}");
        assert!(number(orders) >= order, "{row:?}");
        count += 1;
    }
    assert!(count > 0, "no {of}");
}

#[test]
fn flow_to_a_hole_is_of_second_order_and_a_borehole_has_its_pressure() {
    let finding = page("radial-flow");
    hold(table(&finding, "radial-flow"), "", [4e-3, 1.8]);
    let wells = table(&finding, "radial-flow-borehole");
    hold(wells, "wall", [5e-3, f64::NEG_INFINITY]);
    hold(wells, "from 1 m on", [1e-3, 1.4]);
}

#[test]
fn flow_that_opens_its_joint_is_of_second_order() {
    let finding = page("opened-channel");
    hold(table(&finding, "opened-channel"), "", [1e-3, 1.8]);
    let quadratic = table(&finding, "opened-channel-quadratic");
    hold(quadratic, "rate, Hex20", [1e-5, f64::NEG_INFINITY]);
}

#[test]
fn pressure_diffuses_with_its_orders() {
    for name in ["pressure-step", "line-source", "periodic-source"] {
        let finding = page(name);
        let steps = format!("{name}-time");
        hold(table(&finding, &steps), "", [2e-2, 0.7]);
        hold(table(&finding, name), "", [3e-2, 1.6]);
    }
}

#[test]
fn joints_fill_with_their_orders() {
    let finding = page("filling-joint");
    hold(table(&finding, "filling-joint-time"), "", [1e-2, 0.9]);
    hold(table(&finding, "filling-joint"), "", [5e-3, 1.6]);
    let walked = table(&finding, "filling-joint-accuracy");
    let mass = walked.column("mass");
    for row in &walked.rows {
        let mass: f64 = row[mass].parse().expect("a number");
        assert!(mass <= 1e-10, "{row:?}");
    }
}

#[test]
fn a_filled_crack_has_the_pressure_of_its_volume() {
    let finding = page("filled-penny");
    let own = table(&finding, "filled-penny");
    hold(own, "pressure, quarter points", [0.05, 0.5]);
}

#[test]
fn joints_lose_fluid_and_breathe_with_their_orders() {
    for name in ["leak-off", "periodic-pressure"] {
        let finding = page(name);
        let steps = format!("{name}-time");
        hold(table(&finding, &steps), "", [0.1, 0.8]);
        hold(table(&finding, name), "", [2e-2, 1.7]);
    }
}
