//! Where notes on lines stand: beside a piece of their line, on nothing else.

/// A place on the sheet (units).
type Place = (i32, i32);

/// A rectangle: left, top, right, bottom (units).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds(pub(super) [i32; 4]);

impl Bounds {
    /// Of a width and a height around a place.
    pub(super) fn around((x, y): Place, (width, height): Place) -> Self {
        Self([x - width / 2, y - height / 2, x + width / 2, y + height / 2])
    }

    fn overlaps(self, other: Self) -> bool {
        let (Self(a), Self(b)) = (self, other);
        a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
    }

    fn within(self, other: Self) -> bool {
        let (Self(a), Self(b)) = (self, other);
        a[0] >= b[0] && a[1] >= b[1] && a[2] <= b[2] && a[3] <= b[3]
    }
}

/// Boxes that cover a line, each as long as `step`.
pub(super) fn along(line: &[Place], step: i32) -> Vec<Bounds> {
    let piece = |pair: &[Place]| {
        let ((x, y), (u, v)) = (pair[0], pair[1]);
        let count = ((u - x).abs().max((v - y).abs()) / step).max(1);
        let at = move |i: i32| (x + (u - x) * i / count, y + (v - y) * i / count);
        (0..=count).map(move |i| Bounds::around(at(i), (step, step)))
    };
    line.windows(2).flat_map(piece).collect()
}

/// The middle of a note of some size beside a line, inside `area` and on none of `taken`; the last
/// pieces of the line come first.
pub(super) fn beside(line: &[Place], size: Place, area: Bounds, taken: &[Bounds]) -> Option<Place> {
    let middle = |pair: &[Place]| ((pair[0].0 + pair[1].0) / 2, (pair[0].1 + pair[1].1) / 2);
    let pieces = line.windows(2).rev().map(middle);
    let candidates = pieces.flat_map(|(x, y)| {
        let (right, down) = (size.0 / 2, size.1);
        let sides = [
            (1, -1),
            (-1, 1),
            (0, -1),
            (0, 1),
            (1, 0),
            (-1, 0),
            (1, 1),
            (-1, -1),
        ];
        [1, 2].into_iter().flat_map(move |far| {
            sides.map(|(a, b)| (x + a * (right + far * size.1 / 3), y + b * far * down))
        })
    });
    let fits = |&place: &Place| {
        let own = Bounds::around(place, size);
        own.within(area) && !taken.iter().any(|&other| own.overlaps(other))
    };
    candidates.into_iter().find(fits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_keep_clear_of_lines_and_of_each_other() {
        let area = Bounds([0, 0, 1000, 1000]);
        let lines = [
            [(100, 100), (500, 500)],
            [(100, 140), (500, 540)],
            [(100, 500), (500, 100)],
        ];
        let mut taken: Vec<Bounds> = lines.iter().flat_map(|line| along(line, 10)).collect();
        for line in &lines {
            let size = (80, 30);
            let place = beside(line, size, area, &taken).expect("a place");
            let own = Bounds::around(place, size);
            assert!(taken.iter().all(|&other| !own.overlaps(other)));
            taken.push(own);
        }
    }

    #[test]
    fn a_full_sheet_has_no_place() {
        let area = Bounds([0, 0, 100, 100]);
        assert_eq!(beside(&[(0, 0), (100, 100)], (20, 20), area, &[area]), None);
    }
}
