//! The terms of the jumps: which unknowns move which facet points, and by what factor.
//!
//! A network has many terms and few different factors, each of which is kept once.

use std::collections::HashMap;

use glam::DMat3;

use crate::assembly::drawing::DrawnTerm;

/// Factors that are looked through before others are looked up.
const COMMON: usize = 8;

/// One term of the jump of a facet point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    pub(super) unknown: u32,
    /// Place of `J_i` among the different factors.
    factor: u32,
}

/// The terms of all facet points, point by point.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    /// Start of the terms of each facet point; one entry more than there are points.
    offset: Vec<u32>,
    terms: Vec<Term>,
    /// Facet point of each term.
    point: Vec<u32>,
    /// The different factors.
    factors: Vec<DMat3>,
}

impl Terms {
    /// Those of facet points.
    pub(super) fn of<'a>(points: impl Iterator<Item = &'a [DrawnTerm]>) -> Self {
        let mut all = Self {
            offset: vec![0],
            terms: Vec::new(),
            point: Vec::new(),
            factors: Vec::new(),
        };
        let mut rare = HashMap::new();
        for (number, drawn) in points.enumerate() {
            for term in drawn {
                let factor = all.place(&term.factor, &mut rare);
                let unknown = term.unknown;
                all.terms.push(Term { unknown, factor });
                all.point.push(number as u32);
            }
            all.offset.push(all.terms.len() as u32);
        }
        all.terms.shrink_to_fit();
        all.point.shrink_to_fit();
        all
    }

    /// Place of a factor; `rare` has those of the ones that are not common.
    fn place(&mut self, factor: &DMat3, rare: &mut HashMap<[u64; 9], u32>) -> u32 {
        let mut common = self.factors.iter().take(COMMON);
        if let Some(place) = common.position(|known| known == factor) {
            return place as u32;
        }
        let next = self.factors.len() as u32;
        let bits = factor.to_cols_array().map(f64::to_bits);
        let place = *rare.entry(bits).or_insert(next);
        if place == next {
            self.factors.push(*factor);
        }
        place
    }

    /// All terms, those of a point side by side.
    pub(super) fn all(&self) -> &[Term] {
        &self.terms
    }

    /// Terms of a facet point.
    pub(super) fn of_point(&self, point: usize) -> &[Term] {
        &self.terms[self.offset[point] as usize..self.offset[point + 1] as usize]
    }

    /// Facet point that a term belongs to.
    pub(super) fn point(&self, term: u32) -> usize {
        self.point[term as usize] as usize
    }

    /// `J_i` of a term.
    pub(super) fn factor(&self, term: &Term) -> &DMat3 {
        &self.factors[term.factor as usize]
    }

    /// `J_i^T` of the term with this number.
    pub(super) fn transposed(&self, term: u32) -> DMat3 {
        self.factor(&self.terms[term as usize]).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More different factors than are common; each term keeps its own.
    #[test]
    fn factors_are_kept_once_and_found_again() {
        let factor = |term: u32| f64::from(1 + term % 20) * DMat3::IDENTITY;
        let drawn: Vec<Vec<DrawnTerm>> = (0..30)
            .map(|point| {
                let own = 3 * point..3 * point + point % 3;
                own.map(|unknown| DrawnTerm {
                    unknown,
                    factor: factor(unknown),
                })
                .collect()
            })
            .collect();
        let terms = Terms::of(drawn.iter().map(Vec::as_slice));
        assert!(terms.factors.len() <= 20);
        for point in 0..30 {
            let own = terms.of_point(point);
            assert_eq!(own.len(), point % 3);
            for (index, term) in own.iter().enumerate() {
                assert_eq!(term.unknown as usize, 3 * point + index);
                assert_eq!(*terms.factor(term), factor(term.unknown));
            }
        }
        let points = (0..terms.all().len() as u32).map(|term| terms.point(term));
        assert!(points.eq((0..30).flat_map(|point| vec![point; point % 3])));
    }
}
