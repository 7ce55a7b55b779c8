//! Where the names of the series stand: beside the chart, near the ends of their lines.

/// Places at least `gap` apart and not beyond `low` and `high`, as near to the wanted ones as a
/// single pass down and one up get, in their order.
pub(super) fn apart(wanted: &[i32], gap: i32, low: i32, high: i32) -> Vec<i32> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by_key(|&i| wanted[i]);
    let mut places = wanted.to_vec();
    let mut least = low;
    for &i in &order {
        places[i] = places[i].max(least);
        least = places[i] + gap;
    }
    let mut most = high;
    for &i in order.iter().rev() {
        places[i] = places[i].min(most);
        most = places[i] - gap;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_their_distance_and_order() {
        let places = apart(&[100, 102, 500, 98, 499], 20, 0, 510);
        assert_eq!(places, [118, 138, 510, 98, 490]);
        for (i, a) in places.iter().enumerate() {
            let rest = &places[i + 1..];
            assert!(rest.iter().all(|b| (a - b).abs() >= 20), "{places:?}");
        }
    }
}
