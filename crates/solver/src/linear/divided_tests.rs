//! What ranks divide of a system is what one of them would have.

use glam::{DMat3, DVec3};
use kluft_algebra::InterfaceBlocks;
use kluft_algebra::multigrid::LowerLevels;
use kluft_algebra::thread_ranks::on_threads;

use crate::linear::fractured_tests::{problem, system};
use crate::linear::iterative::{first_coarsening, serves};
use crate::system::{Discretisation, System};

fn displacements(count: usize) -> Vec<DVec3> {
    let number = |at: usize| ((at * at * 7919 + at * 13) % 1009) as f64 / 1009.0 - 0.5;
    (0..count)
        .map(|at| DVec3::new(number(3 * at), number(3 * at + 1), number(3 * at + 2)))
        .collect()
}

#[test]
fn forces_of_the_rock_are_the_same_to_the_last_bit() {
    let problem = problem(|z| z);
    let whole = system(&problem);
    let moved = displacements(whole.discretisation.points.len());
    for ranks in [2, 3, 5] {
        let found = on_threads(ranks, |communicator| {
            let discretisation = Discretisation::of(&problem).expect("held");
            let mut divided = System::divided(&problem, discretisation, communicator);
            let before = divided.rock_forces(&moved);
            first_coarsening(&mut divided).expect("definite");
            assert!(divided.rock_rows().blocks.len() < whole.rock_rows().blocks.len());
            assert_eq!(before, divided.rock_forces(&moved));
            (before, divided.absolute_rock_forces(&moved))
        });
        for (forces, absolute) in found {
            assert!(forces == whole.rock_forces(&moved), "{ranks} ranks");
            assert!(
                absolute == whole.absolute_rock_forces(&moved),
                "{ranks} ranks"
            );
        }
    }
}

#[test]
fn all_ranks_judge_a_stiffness_as_one_does() {
    let problem = problem(|z| z);
    let whole = system(&problem);
    let points = whole.discretisation.interface.points.len();
    let stiffness = |size: f64| {
        let tangents = vec![size * DMat3::IDENTITY; points];
        whole.discretisation.interface.stiffness(&tangents)
    };
    let (old, pairs) = (stiffness(1.0), [1.0, 1.9, 4.0].map(stiffness));
    let judged = |system: &System<'_>| {
        let fixed = system.fixed_part();
        pairs.each_ref().map(|new| serves(fixed, &old, new))
    };
    let expected = judged(&whole);
    assert_eq!(expected, [true, true, false]);
    let found = on_threads(3, |communicator| {
        let discretisation = Discretisation::of(&problem).expect("held");
        judged(&System::divided(&problem, discretisation, communicator))
    });
    assert!(found.iter().all(|found| *found == expected), "{found:?}");
}

#[test]
fn ranks_make_the_second_level_of_one_rank() {
    let problem = problem(|z| z);
    let stiffness = |system: &System<'_>| {
        let interface = &system.discretisation.interface;
        interface.stiffness(&vec![DMat3::IDENTITY; interface.points.len()])
    };
    let levels = |ranks: usize| -> LowerLevels {
        let all = on_threads(ranks, |communicator| {
            let discretisation = Discretisation::of(&problem).expect("held");
            let mut system = System::divided(&problem, discretisation, communicator);
            let (mut coarsening, owner) = first_coarsening(&mut system).expect("definite");
            let (fixed, blocks) = (system.fixed_part(), stiffness(&system));
            let added = InterfaceBlocks {
                pattern: fixed.interface,
                blocks: &blocks,
            };
            let rows = 0..owner.len() as u32;
            let is_own = |row: &u32| owner[*row as usize] as usize == communicator.rank();
            let own: Vec<u32> = rows.filter(is_own).collect();
            let rows = coarsening.factorised(fixed.matrix, added, &own);
            let part = coarsening.part(&rows.expect("definite"), |_| {});
            let levels = coarsening.levels_below(part.next, communicator);
            levels.expect("finite")
        });
        all.into_iter().next_back().expect("a rank")
    };
    let (mut one, mut three) = (levels(1), levels(3));
    assert_eq!(one.nodes(0), three.nodes(0));
    let all: Vec<u32> = (0..one.nodes(0) as u32).collect();
    let (one, three) = (one.take_rows(0, &all), three.take_rows(0, &all));
    for node in 0..all.len() {
        for ((column, one), (at, other)) in one.row(node).zip(three.row(node)) {
            assert_eq!(column, at);
            for (one, other) in std::iter::zip(one.as_flattened(), other.as_flattened()) {
                // Single precision.
                assert!((one - other).abs() < 1e-4, "{one} and {other}");
            }
        }
    }
}
