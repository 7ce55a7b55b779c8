//! Quadrature rules on the reference shapes: points and weights, exact to a stated degree.
//!
//! Simplex rules: D. A. Dunavant, Int. J. Numer. Meth. Engng 21 (1985), and P. Keast, Comput.
//! Methods Appl. Mech. Engng 55 (1986). Everything else is a product of these and of Gauss's rules;
//! pyramids are cones over the square, `x = xi (1 - z)`, `y = eta (1 - z)`.

use glam::DVec3;
use kluft_mesh::Shape;

/// A point in reference coordinates and its weight.
pub(crate) type Weighted = (DVec3, f64);

/// Rule for the stiffness of a cell, or for integrals over a facet.
pub(crate) fn points(shape: Shape) -> Vec<Weighted> {
    match shape {
        Shape::Line2 | Shape::Line3 => {
            let points = gauss(3).into_iter();
            points.map(|(x, weight)| (x * DVec3::X, weight)).collect()
        }
        Shape::Tri3 | Shape::Tri6 => triangle_degree_4(),
        Shape::Quad4 | Shape::Quad8 | Shape::Quad9 => layers(&square(3), &[(0.0, 1.0)]),
        Shape::Tet4 => vec![(DVec3::splat(0.25), 1.0 / 6.0)],
        Shape::Tet10 => tetrahedron_degree_2(),
        Shape::Hex8 => layers(&square(2), &gauss(2)),
        Shape::Hex20 | Shape::Hex27 => layers(&square(3), &gauss(3)),
        Shape::Prism6 => layers(&triangle_degree_2(), &gauss(2)),
        Shape::Prism15 | Shape::Prism18 => layers(&triangle_degree_4(), &gauss(3)),
        Shape::Pyramid5 => cone(2, 3),
        Shape::Pyramid13 | Shape::Pyramid14 => cone(3, 4),
    }
}

/// Total degree to which [`points`] is exact.
#[cfg(test)]
fn degree(shape: Shape) -> i32 {
    match shape {
        Shape::Tet4 => 1,
        Shape::Tet10 | Shape::Prism6 => 2,
        Shape::Hex8 | Shape::Pyramid5 => 3,
        Shape::Tri3 | Shape::Tri6 | Shape::Prism15 | Shape::Prism18 => 4,
        Shape::Pyramid13 | Shape::Pyramid14 => 5,
        Shape::Line2 | Shape::Line3 => 5,
        Shape::Quad4 | Shape::Quad8 | Shape::Quad9 | Shape::Hex20 | Shape::Hex27 => 5,
    }
}

/// Gauss's rule on `[-1, 1]`, exact to degree `2 count - 1`.
fn gauss(count: usize) -> Vec<(f64, f64)> {
    match count {
        2 => [-1.0, 1.0]
            .map(|sign| (sign / 3.0_f64.sqrt(), 1.0))
            .to_vec(),
        3 => {
            let x = 0.6_f64.sqrt();
            vec![(-x, 5.0 / 9.0), (0.0, 8.0 / 9.0), (x, 5.0 / 9.0)]
        }
        _ => {
            let root = 2.0 / 7.0 * 1.2_f64.sqrt();
            let (near, far) = ((3.0 / 7.0 - root).sqrt(), (3.0 / 7.0 + root).sqrt());
            let share = 30.0_f64.sqrt() / 36.0;
            let pair = |x: f64, weight: f64| [(-x, weight), (x, weight)];
            [pair(near, 0.5 + share), pair(far, 0.5 - share)].concat()
        }
    }
}

fn square(count: usize) -> Vec<Weighted> {
    let line = gauss(count);
    let row = |&(y, v): &(f64, f64)| {
        line.iter()
            .map(move |&(x, w)| (DVec3::new(x, y, 0.0), v * w))
            .collect::<Vec<_>>()
    };
    line.iter().flat_map(row).collect()
}

/// A plane rule repeated at the heights of a line rule.
fn layers(plane: &[Weighted], line: &[(f64, f64)]) -> Vec<Weighted> {
    line.iter()
        .flat_map(|&(z, v)| plane.iter().map(move |&(at, w)| (at.with_z(z), v * w)))
        .collect()
}

/// Cone over the square: the volume shrinks with `(1 - z)^2`.
fn cone(plane: usize, heights: usize) -> Vec<Weighted> {
    let line: Vec<(f64, f64)> = gauss(heights)
        .into_iter()
        .map(|(t, w)| (0.5 * (1.0 + t), 0.5 * w))
        .collect();
    let base = square(plane);
    line.iter()
        .flat_map(|&(z, v)| {
            let top = 1.0 - z;
            base.iter()
                .map(move |&(at, w)| ((at * top).with_z(z), v * w * top * top))
        })
        .collect()
}

/// All distinct orders of barycentric coordinates `(a, a, 1 - 2 a)`, as points of the triangle.
fn triangle_orbit(a: f64, weight: f64) -> [Weighted; 3] {
    let b = 1.0 - 2.0 * a;
    [(a, a), (b, a), (a, b)].map(|(x, y)| (DVec3::new(x, y, 0.0), 0.5 * weight))
}

fn triangle_degree_2() -> Vec<Weighted> {
    triangle_orbit(1.0 / 6.0, 1.0 / 3.0).to_vec()
}

fn triangle_degree_4() -> Vec<Weighted> {
    [
        triangle_orbit(0.445_948_490_915_965, 0.223_381_589_678_011),
        triangle_orbit(0.091_576_213_509_771, 0.109_951_743_655_322),
    ]
    .concat()
}

fn tetrahedron_degree_2() -> Vec<Weighted> {
    let a = (5.0 - 5.0_f64.sqrt()) / 20.0;
    let b = 1.0 - 3.0 * a;
    [(a, a, a), (b, a, a), (a, b, a), (a, a, b)]
        .map(|(x, y, z)| (DVec3::new(x, y, z), 1.0 / 24.0))
        .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// Integral of `t^n` over `[-1, 1]`.
    fn line(n: i32) -> f64 {
        if n % 2 == 0 {
            2.0 / f64::from(n + 1)
        } else {
            0.0
        }
    }

    /// Integral of `x^a y^b z^c` over the reference shape.
    fn exact(shape: Shape, a: i32, b: i32, c: i32) -> f64 {
        let triangle = factorial(a) * factorial(b) / factorial(a + b + 2);
        match (shape.dimension(), shape.corner_count()) {
            (2, 3) => triangle,
            (2, _) => line(a) * line(b),
            (_, 4) => factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3),
            // int z^c (1 - z)^(a + b + 2) dz is a beta function.
            (_, 5) => {
                let n = a + b + 2;
                line(a) * line(b) * factorial(c) * factorial(n) / factorial(c + n + 1)
            }
            (_, 6) => triangle * line(c),
            _ => line(a) * line(b) * line(c),
        }
    }

    #[test]
    fn rules_are_exact_to_their_stated_degree() {
        for shape in Shape::CELLS.into_iter().chain(Shape::FACETS) {
            let degree = degree(shape);
            let highest = if shape.dimension() == 2 { 0 } else { degree };
            for (a, b, c) in (0..=degree)
                .flat_map(|a| (0..=degree).map(move |b| (a, b)))
                .flat_map(|(a, b)| (0..=highest).map(move |c| (a, b, c)))
                .filter(|(a, b, c)| a + b + c <= degree)
            {
                let monomial = |at: DVec3| at.x.powi(a) * at.y.powi(b) * at.z.powi(c);
                let sum: f64 = points(shape).iter().map(|&(at, w)| w * monomial(at)).sum();
                let error = (sum - exact(shape, a, b, c)).abs();
                assert!(
                    error < 1e-14,
                    "{shape:?}: x^{a} y^{b} z^{c} is off by {error:e}"
                );
            }
        }
    }
}
