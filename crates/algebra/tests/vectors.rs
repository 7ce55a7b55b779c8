//! Sums into vectors that several tasks share.

use glam::DVec3;
use kluft_algebra::add_at;

/// Rows before, at and behind the borders of tasks, wherever these are.
#[test]
fn every_row_takes_its_sum_and_no_other_does() {
    let length = 20_000;
    for step in [1, 3, 4096, 4097, 19_999] {
        let rows: Vec<u32> = (0..length).step_by(step).collect();
        let mut vector = vec![DVec3::ONE; length as usize];
        add_at(&rows, |number| DVec3::splat(number as f64), &mut vector);
        for (row, entry) in (0_u32..).zip(&vector) {
            let number = rows.binary_search(&row).ok();
            let sum = 1.0 + number.map_or(0.0, |number| number as f64);
            assert_eq!(*entry, DVec3::splat(sum), "row {row} of every {step}");
        }
    }
}

#[test]
fn without_rows_nothing_is_added() {
    let mut vector = vec![DVec3::ONE; 5000];
    add_at(&[], |_| DVec3::ONE, &mut vector);
    assert!(vector.iter().all(|entry| *entry == DVec3::ONE));
}
