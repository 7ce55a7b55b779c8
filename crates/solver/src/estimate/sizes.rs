//! Cell sizes that would meet a tolerance with the fewest cells.
//!
//! Where the solution is smooth, the errors `e_K` of cells fall with the factor `s_K` on their size
//! as `s_K^(2 p)`, and the number of cells grows as `s_K^-3`. Cells that touch a crack front are
//! different: per length of the front their error is a share of `K^2 s / E` that their form gives
//! and not their size, because quarter points follow the square root of the distance but no
//! polynomial follows how stresses turn around the front. So their errors fall as `s` only,
//! whatever `p`, and their number grows as `s^-1`. The fewest cells for `E_f s + sum e_K s_K^(2 p)
//! = T`, with `N_f` cells and the errors `E_f` at fronts, have `s = sqrt(N_f / (m E_f))` and
//! `s_K^(2 p + 3) = 3 / (2 p m e_K)`, with one multiplier `m`: sizes go as the density of the error
//! to the power of `-1 / (2 p + d)` (R. Becker and R. Rannacher, Acta Numerica 10, 2001, who have
//! `-1/4` for `p = 1` in the plane).
//!
//! In the plane `d` is 2 in the place of 3. A front is a point there, with as many cells around it
//! whatever their size, but each ring between them and larger cells takes as many: `-N_f ln s` of
//! them, so that `s = N_f / (m E_f)`.
//!
//! Cells one layer away from a front count as smooth: with the stress `r^(-1/2)` their errors fall
//! as `s^4 r^-5`, of which the optimal sizes, as `r^(5/7)`, leave little near the front.

use glam::DVec3;
use kluft_mesh::Mesh;

/// How much a cell may shrink and grow at once.
const SHRINK: f64 = 0.125;
const GROW: f64 = 2.0;
/// Part of the present error, below which one new mesh does not go: its sizes would be guessed from
/// cells that say too little.
const AT_ONCE: f64 = 0.1;
/// Part of the tolerance that is aimed at, so that the next mesh meets it.
const AIM: f64 = 0.8;

/// Sizes (m) at all nodes, from errors of cells that should add up to `tolerance` for each group of
/// cells (`groups` numbers them; cells in none may grow).
pub fn target_sizes(mesh: &Mesh, errors: &[f64], groups: &[u32], tolerance: f64) -> Vec<f64> {
    let rates = Rates {
        error: if mesh.cells.has_quadratic() { 4.0 } else { 2.0 },
        count: if mesh.is_plane() { 2.0 } else { 3.0 },
    };
    let at_front = mesh.front_cells();
    let last = groups.iter().filter(|&&group| group != u32::MAX).max();
    let mut sums = vec![Sums::default(); last.map_or(0, |&last| last as usize + 1)];
    for (cell, &group) in groups.iter().enumerate() {
        let Some(sums) = sums.get_mut(group as usize) else {
            continue;
        };
        if at_front[cell] {
            sums.at_fronts += errors[cell];
            sums.front_cells += 1.0;
        } else {
            sums.powers += errors[cell].powf(rates.count / (rates.error + rates.count));
            sums.elsewhere += errors[cell];
        }
    }
    let multipliers = sums.iter().map(|sums| sums.multiplier(rates, tolerance));
    let multipliers: Vec<f64> = multipliers.collect();
    let size = |cell: usize| {
        let group = groups[cell] as usize;
        let factor = multipliers.get(group).map_or(GROW, |&multiplier| {
            if at_front[cell] {
                sums[group].front_factor(multiplier, rates)
            } else {
                smooth_factor(errors[cell], multiplier, rates)
            }
        });
        (cell_size(mesh, cell) * factor.clamp(SHRINK, GROW)).ln()
    };
    let logarithms: Vec<f64> = (0..mesh.cells.len()).map(size).collect();
    at_nodes(mesh, &logarithms)
}

/// Powers of the factor on sizes.
#[derive(Clone, Copy)]
struct Rates {
    /// With which errors fall away from fronts, `2 p`.
    error: f64,
    /// With which cells become fewer there, `d`.
    count: f64,
}

/// Errors of the cells of a group.
#[derive(Clone, Default)]
struct Sums {
    at_fronts: f64,
    /// Number of cells at fronts.
    front_cells: f64,
    elsewhere: f64,
    /// `sum e_K^(d / (2 p + d))` away from fronts.
    powers: f64,
}

impl Sums {
    /// `s` of the cells at fronts.
    fn front_factor(&self, multiplier: f64, rates: Rates) -> f64 {
        let ratio = self.front_cells / (multiplier * self.at_fronts);
        ratio.powf(1.0 / (rates.count - 1.0))
    }

    /// Error that a multiplier leaves.
    fn error(&self, multiplier: f64, rates: Rates) -> f64 {
        let at_fronts = match self.at_fronts > 0.0 {
            true => self.at_fronts * self.front_factor(multiplier, rates),
            false => 0.0,
        };
        let Rates { error, count } = rates;
        // e_K s_K^(2 p) = e_K^(d / (2 p + d)) (d / (2 p m))^(2 p / (2 p + d))
        at_fronts + self.powers * (count / (error * multiplier)).powf(error / (error + count))
    }

    /// `m`, by bisection: the error falls as it grows.
    fn multiplier(&self, rates: Rates, tolerance: f64) -> f64 {
        let aim = (AIM * tolerance).max(AT_ONCE * (self.at_fronts + self.elsewhere));
        let (mut low, mut high) = (-100.0_f64, 100.0_f64);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.error(10.0_f64.powf(middle), rates) > aim {
                low = middle;
            } else {
                high = middle;
            }
        }
        10.0_f64.powf(high)
    }
}

/// `s_K` of a cell away from fronts.
fn smooth_factor(error: f64, multiplier: f64, rates: Rates) -> f64 {
    let sum = rates.error + rates.count;
    (rates.count / (rates.error * multiplier * error)).powf(1.0 / sum)
}

/// Median distance of the corners of a cell (m): in a layer of flat or slender cells the size in
/// its plane. Of a mesh of the plane those of one layer count.
fn cell_size(mesh: &Mesh, cell: usize) -> f64 {
    let corners = mesh.cells.shapes[cell].corner_count();
    let nodes = mesh.cells.nodes_of(cell)[..corners].iter();
    let nodes: Vec<u32> = nodes.copied().filter(|&node| mesh.is_own(node)).collect();
    let place = |node: &u32| -> DVec3 { mesh.nodes[*node as usize] };
    let pairs = nodes.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| nodes[..i].iter().map(move |b| (a, b)));
    let mut lengths: Vec<f64> = pairs.map(|(a, b)| place(a).distance(place(b))).collect();
    lengths.sort_by(f64::total_cmp);
    lengths[lengths.len() / 2]
}

/// Geometric mean of the sizes, given by logarithms, of the cells around each node.
fn at_nodes(mesh: &Mesh, logarithms: &[f64]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); mesh.nodes.len()];
    for (cell, logarithm) in logarithms.iter().enumerate() {
        for &node in mesh.cells.nodes_of(cell) {
            let (sum, count) = &mut sums[node as usize];
            *sum += logarithm;
            *count += 1.0;
        }
    }
    let means = sums.into_iter();
    means
        .map(|(sum, count)| f64::exp(sum / f64::max(count, 1.0)))
        .collect()
}
