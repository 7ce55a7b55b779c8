//! The nearest of known names.

/// Names further from every known one than this (normalised similarity) get no suggestion.
const ALIKE: f64 = 0.5;

/// The known name most like `name`, if any is like it at all; case counts less than letters.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let alike = |known: &'a str| {
        let as_written = strsim::normalized_damerau_levenshtein(name, known);
        let (name, known_small) = (name.to_lowercase(), known.to_lowercase());
        let in_small = strsim::normalized_damerau_levenshtein(&name, &known_small);
        (as_written.max(0.99 * in_small), known)
    };
    known
        .map(alike)
        .filter(|(alike, _)| *alike >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known)
}

/// The known names most like `name`, at most this many, the nearest first.
pub(crate) fn some_near<'a>(
    name: &str,
    known: impl Iterator<Item = &'a str>,
    count: usize,
) -> Vec<&'a str> {
    let mut found: Vec<(f64, &str)> = known
        .map(|known| (strsim::normalized_damerau_levenshtein(name, known), known))
        .filter(|(alike, _)| *alike >= ALIKE)
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    found.dedup_by_key(|(_, name)| *name);
    found
        .into_iter()
        .map(|(_, name)| name)
        .take(count)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_found_whatever_its_case() {
        let units = ["Pa", "kPa", "MPa", "GPa"];
        assert_eq!(nearest("GPA", units.into_iter()), Some("GPa"));
        assert_eq!(nearest("Mpa", units.into_iter()), Some("MPa"));
        assert_eq!(nearest("furlong", units.into_iter()), None);
    }
}
