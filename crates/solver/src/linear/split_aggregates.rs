//! Split aggregates: the motions of aggregates that fractures cut, one for each part.
//!
//! An aggregate of the intact rock moves nodes on both sides of a fracture. Cut along the facets,
//! its motion falls into parts; each becomes a motion of its own, as a node falls into points. So
//! the next level knows smooth jumps as the finest one knows jumps, which nothing else can take
//! care of at a moderate cost: a jump of nodes alone, one layer thick, is stiffer by `L/h` than one
//! whose sides follow it to the distance `L`. Where a fracture ends inside an aggregate, each of
//! its walls has a part that reaches beyond the edge. Small parts have no motions of their own but
//! follow those beside them, so that whatever moves rigidly on the finest level still does so
//! exactly on the next one. What stiff walls make of these motions is left to the multigrid, see
//! [`kluft_algebra::multigrid`].

use kluft_algebra::Communicator;
use kluft_algebra::multigrid::{CoarseBasis, Continuity, MeanField};
use kluft_algebra::small::{Modes, add, product, rows_of, widen};
use rayon::prelude::*;

use crate::linear::moved_points::{MovedPoints, NOWHERE};
use crate::space::Space;

/// A part with less than this share of the motion of its aggregate follows that of another one.
const SMALL: f64 = 0.02;
/// Marks a part that does so.
const FOLLOWS: u32 = u32::MAX;
/// Aggregates that one task cuts.
const PER_TASK: usize = 64;

/// The parts of all aggregates.
pub(super) struct SplitAggregates<'a> {
    space: Space<'a>,
    means: &'a MeanField,
    /// First split aggregate of each aggregate; one entry more than there are aggregates.
    offset: Vec<u32>,
    /// Part of each point that an aggregate moves, or [`FOLLOWS`], points ascending; empty if it is
    /// whole.
    parts: Vec<Vec<(u32, u32)>>,
    /// `R^-1` of the modes of each aggregate, if they do not depend on each other.
    inverse: Vec<Option<Modes<6>>>,
}

impl<'a> SplitAggregates<'a> {
    /// Cuts the aggregates of `means`. The ranks divide the work.
    pub(super) fn of(space: Space<'a>, means: &'a MeanField, ranks: &Communicator) -> Self {
        let aggregates = means.aggregates();
        let own = ranks.divide_evenly(aggregates).own();
        let cuts: Vec<SplitAggregate> = own
            .into_par_iter()
            .with_min_len(PER_TASK)
            .map_init(
                || vec![NOWHERE; space.points.len()],
                |number, aggregate| {
                    let moved = moved(space, means, aggregate);
                    cut(space, &moved, number)
                },
            )
            .collect();
        let cuts = SplitAggregate::of_all_ranks(cuts, ranks);
        let mut split = Self {
            space,
            means,
            offset: vec![0],
            inverse: means.modes().iter().map(inverse).collect(),
            parts: Vec::new(),
        };
        let numbered = (0..aggregates).into_par_iter();
        let numbered = numbered.map(|aggregate| split.numbered(&cuts, aggregate));
        let numbered: Vec<(u32, Vec<(u32, u32)>)> = numbered.collect();
        for (count, parts) in numbered {
            let last = split.offset[split.parts.len()];
            split.offset.push(last + count);
            split.parts.push(parts);
        }
        split
    }

    /// Numbers the parts of an aggregate that become motions of their own, and tells how many they
    /// are: those that are not small, or have a point that no other aggregate could move in their
    /// stead.
    fn numbered(&self, cuts: &[SplitAggregate], aggregate: usize) -> (u32, Vec<(u32, u32)>) {
        let SplitAggregate { parts, is_small } = &cuts[aggregate];
        let mut has_own_motion: Vec<bool> = is_small.iter().map(|small| !small).collect();
        for &(point, part) in parts {
            let has_host = self.entries(point as usize).any(|(other, _)| {
                other != aggregate && self.inverse[other].is_some() && cuts[other].is_host(point)
            });
            has_own_motion[part as usize] |= !has_host;
        }
        let mut number = vec![FOLLOWS; has_own_motion.len()];
        let mut count = 0;
        for (number, _) in number
            .iter_mut()
            .zip(has_own_motion)
            .filter(|(_, has_own_motion)| *has_own_motion)
        {
            *number = count;
            count += 1;
        }
        let parts = parts.iter();
        let parts = parts.map(|&(point, part)| (point, number[part as usize]));
        (count.max(1), parts.collect())
    }

    /// Aggregates that move the node of a point, and how.
    fn entries(&self, point: usize) -> impl Iterator<Item = (usize, &[[f32; 6]; 3])> {
        let node = self.space.points.node[point] as usize;
        self.means.motions_of(node)
    }

    /// Modes of each part: those of its aggregate.
    fn modes(&self) -> Vec<Modes<6>> {
        let counts = self.offset.windows(2).map(|pair| pair[1] - pair[0]);
        let repeated = self.means.modes().iter().zip(counts);
        repeated
            .flat_map(|(modes, count)| std::iter::repeat_n(*modes, count as usize))
            .collect()
    }

    /// The part as which an aggregate moves a point; none if it follows another one.
    fn at(&self, aggregate: usize, point: usize) -> Option<u32> {
        let list = &self.parts[aggregate];
        let found = list.binary_search_by_key(&(point as u32), |(point, _)| *point);
        let part = found.map_or(0, |at| list[at].1);
        (part != FOLLOWS).then(|| self.offset[aggregate] + part)
    }

    /// The aggregate that moves a point most, of those that others can follow.
    fn host(&self, point: usize) -> Option<usize> {
        let weight =
            |block: &[[f32; 6]; 3]| block.as_flattened().iter().map(|x| x * x).sum::<f32>();
        let hosts = self.entries(point);
        let hosts = hosts.filter(|(aggregate, _)| {
            self.inverse[*aggregate].is_some() && self.at(*aggregate, point).is_some()
        });
        // `max_by` keeps the last of equals: the order of the columns decides.
        let most = hosts.max_by(|a, b| weight(a.1).total_cmp(&weight(b.1)));
        most.map(|(aggregate, _)| aggregate)
    }

    /// SplitAggregates that move a point, and how, as far as it is not held. A motion that follows
    /// that of a host is the same rigid one: `R_i R_j^-1`.
    fn motions(&self, point: usize) -> Vec<(u32, [[f64; 6]; 3])> {
        let constraint = self.space.supports.constraint(point);
        let free = constraint.map(|constraint| rows_of(&constraint.free));
        let motion = |(aggregate, block): (usize, &[[f32; 6]; 3])| {
            let block = match &free {
                Some(free) => product(free, &widen(block)),
                None => widen(block),
            };
            if let Some(part) = self.at(aggregate, point) {
                return Some((part, block));
            }
            let host = self.host(point)?;
            let rigid = product(&self.means.modes()[aggregate], self.inverse[host].as_ref()?);
            Some((self.at(host, point)?, product(&block, &rigid)))
        };
        self.entries(point).filter_map(motion).collect()
    }

    /// The motions of all unknowns: the mean displacement is the mean of the motions of the points
    /// of its node, jump `k` the motion of sector `k` less that of sector 0. Those that are not
    /// `is_wanted` have none.
    pub(super) fn basis(&self, is_wanted: impl Fn(usize) -> bool + Sync + Send) -> CoarseBasis {
        let rows = self.space.points.len();
        let basis = CoarseBasis::new(rows, self.modes(), |unknown| match is_wanted(unknown) {
            true => self.motion(unknown),
            false => Vec::new(),
        });
        basis.divided(self.continuity())
    }

    /// The parts that continuous rock joins: those that move a point in common.
    fn continuity(&self) -> Continuity {
        let aggregates = 0..self.parts.len();
        let joined = aggregates.into_par_iter().with_min_len(PER_TASK);
        let joined = joined.flat_map_iter(|aggregate| {
            let own = self.offset[aggregate]..self.offset[aggregate + 1];
            let mut joined = vec![Vec::new(); own.len()];
            for &(point, part) in &self.parts[aggregate] {
                if part != FOLLOWS {
                    joined[part as usize].extend(self.movers(point as usize));
                }
            }
            for joined in &mut joined {
                joined.sort_unstable();
                joined.dedup();
            }
            joined
        });
        Continuity::new(&joined.collect::<Vec<_>>())
    }

    /// The parts that move a point.
    fn movers(&self, point: usize) -> impl Iterator<Item = u32> {
        let aggregates = self.entries(point).map(|(aggregate, _)| aggregate);
        aggregates.filter_map(move |aggregate| {
            let own = self.at(aggregate, point);
            own.or_else(|| self.at(self.host(point)?, point))
        })
    }

    fn motion(&self, unknown: usize) -> Vec<(u32, [[f64; 6]; 3])> {
        let points = self.space.points;
        let own = points.of_node(points.node[unknown] as usize);
        let weight = match unknown - own.start {
            0 => 1.0 / own.len() as f64,
            _ => 1.0,
        };
        let plus = if unknown == own.start {
            own.clone()
        } else {
            unknown..unknown + 1
        };
        let minus = own.start..own.start + usize::from(unknown > own.start);
        let signed = plus.map(move |point| (weight, point));
        let signed = signed.chain(minus.map(|point| (-1.0, point)));
        let motions = signed.flat_map(|(weight, point)| {
            let motions = self.motions(point).into_iter();
            motions.map(move |(part, block)| (part, weight, block))
        });
        cancelled(motions.collect())
    }
}

/// Sums by part, ascending, without those that are zero, as where both sides move alike.
fn cancelled(mut terms: Vec<(u32, f64, [[f64; 6]; 3])>) -> Vec<(u32, [[f64; 6]; 3])> {
    terms.sort_by_key(|(part, ..)| *part);
    let mut sums: Vec<(u32, [[f64; 6]; 3])> = Vec::with_capacity(terms.len());
    for (part, weight, block) in terms {
        if sums.last().is_none_or(|(last, _)| *last != part) {
            sums.push((part, [[0.0; 6]; 3]));
        }
        if let Some((_, sum)) = sums.last_mut() {
            add(sum, weight, &block);
        }
    }
    sums.retain(|(_, sum)| sum.as_flattened().iter().any(|entry| *entry != 0.0));
    sums
}

/// The parts of an aggregate.
struct SplitAggregate {
    /// Part of each point, points ascending; empty if it is whole.
    parts: Vec<(u32, u32)>,
    /// Whether a part has but a small share of the motion.
    is_small: Vec<bool>,
}

impl SplitAggregate {
    /// Those of all ranks, rank by rank.
    fn of_all_ranks(own: Vec<Self>, ranks: &Communicator) -> Vec<Self> {
        if ranks.size() == 1 {
            return own;
        }
        let lengths = own.iter();
        let lengths = lengths.map(|cut| [cut.parts.len() as u32, cut.is_small.len() as u32]);
        let parts = own.iter().flat_map(|cut| &cut.parts);
        let parts: Vec<[u32; 2]> = parts.map(|&(point, part)| [point, part]).collect();
        let is_small = own.iter().flat_map(|cut| &cut.is_small);
        let is_small: Vec<u8> = is_small.map(|&small| u8::from(small)).collect();
        let lengths = ranks.gathered(&lengths.collect::<Vec<_>>());
        let mut parts = ranks.gathered(&parts).into_iter();
        let mut is_small = ranks.gathered(&is_small).into_iter();
        let cuts = lengths.into_iter().map(|[points, count]| {
            let parts = parts.by_ref().take(points as usize);
            let is_small = is_small.by_ref().take(count as usize);
            Self {
                parts: parts.map(|[point, part]| (point, part)).collect(),
                is_small: is_small.map(|small| small == 1).collect(),
            }
        });
        cuts.collect()
    }

    /// Whether others can follow its motion of a point.
    fn is_host(&self, point: u32) -> bool {
        let found = self.parts.binary_search_by_key(&point, |(point, _)| *point);
        found.is_ok_and(|at| !self.is_small[self.parts[at].1 as usize]) || self.parts.is_empty()
    }
}

/// Inverse of an upper triangle, if it has one.
fn inverse(triangle: &Modes<6>) -> Option<Modes<6>> {
    let mut inverse = [[0.0; 6]; 6];
    for j in 0..6 {
        if triangle[j][j] <= 0.0 {
            return None;
        }
        inverse[j][j] = 1.0 / triangle[j][j];
        for i in (0..j).rev() {
            let known: f64 = (i + 1..=j).map(|k| triangle[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -known / triangle[i][i];
        }
    }
    Some(inverse)
}

/// The points of the nodes that an aggregate moves, ascending, and how much; none if it has no node
/// with several points.
fn moved(space: Space<'_>, means: &MeanField, aggregate: usize) -> Vec<(u32, f64)> {
    let own = |node: usize| space.points.of_node(node);
    if means
        .moved_by(aggregate)
        .all(|(node, _)| own(node).len() == 1)
    {
        return Vec::new();
    }
    let points = means.moved_by(aggregate).flat_map(|(node, block)| {
        let squares = block.as_flattened().iter().map(|x| f64::from(x * x));
        let weight: f64 = squares.sum();
        own(node).map(move |point| (point as u32, weight))
    });
    points.collect()
}

/// Numbers the parts into which fractures divide the points of an aggregate. `number` is room,
/// [`NOWHERE`] for all points before and after.
fn cut(space: Space<'_>, moved: &[(u32, f64)], number: &mut [u32]) -> SplitAggregate {
    for (place, (point, _)) in moved.iter().enumerate() {
        number[*point as usize] = place as u32;
    }
    let roots = MovedPoints::new(space, moved, number).parts();
    for (point, _) in moved {
        number[*point as usize] = NOWHERE;
    }
    let mut parts = roots.clone();
    parts.sort_unstable();
    parts.dedup();
    if parts.len() < 2 {
        return SplitAggregate {
            parts: Vec::new(),
            is_small: Vec::new(),
        };
    }
    let part = |root: &u32| parts.partition_point(|other| other < root);
    let mut weights = vec![0.0; parts.len()];
    for (root, (_, weight)) in roots.iter().zip(moved) {
        weights[part(root)] += weight;
    }
    let total: f64 = weights.iter().sum();
    let numbered = moved.iter().zip(&roots);
    SplitAggregate {
        parts: numbered
            .map(|((point, _), root)| (*point, part(root) as u32))
            .collect(),
        is_small: weights
            .iter()
            .map(|weight| *weight < SMALL * total)
            .collect(),
    }
}
