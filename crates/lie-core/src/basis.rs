//! Shape functions of all shapes from their nodes and a list of monomials.
//!
//! Each shape spans the monomials `x^a y^b z^c (1 - z)^-d` of its table (`d > 0` in pyramids only).
//! The shape functions are the combinations that are 1 at one node and 0 at the others; their
//! coefficients are the inverse of the matrix of monomials at nodes, solved for once a run.
//!
//! Spaces: complete quadratic in simplices; tensor products in hexahedra and prisms with middles of
//! faces, serendipity without; pyramids after M. Bergot, G. Cohen and M. Duruflé, "Higher-order
//! finite elements for hybrid meshes using new nodal pyramidal elements", J. Sci. Comput. 42
//! (2010), whose faces agree with those of the neighbours.

use faer::Mat;
use faer::linalg::solvers::Solve;
use glam::DVec3;
use kluft_mesh::Shape;

/// Powers of `x`, `y`, `z` and `1 / (1 - z)`.
type Monomial = [i32; 4];

/// Shape functions of one shape.
#[derive(Debug, Clone)]
pub struct Basis {
    monomials: Vec<Monomial>,
    /// `coefficients[node][monomial]`.
    coefficients: Vec<Vec<f64>>,
}

impl Basis {
    pub(crate) fn of(shape: Shape) -> Self {
        let nodes = shape.reference_nodes();
        let monomials = monomials(shape);
        let count = nodes.len();
        assert_eq!(monomials.len(), count, "one monomial a node in a {shape:?}");
        let at_nodes = Mat::from_fn(count, count, |node, m| value(monomials[m], nodes[node]));
        let inverse = at_nodes
            .full_piv_lu()
            .solve(Mat::<f64>::identity(count, count));
        let coefficients = (0..count)
            .map(|node| (0..count).map(|m| inverse[(m, node)]).collect())
            .collect();
        Self {
            monomials,
            coefficients,
        }
    }

    /// Values of all shape functions at a reference point.
    pub fn values(&self, at: DVec3) -> Vec<f64> {
        let monomials: Vec<f64> = self.monomials.iter().map(|&m| value(m, at)).collect();
        let combine = |row: &Vec<f64>| row.iter().zip(&monomials).map(|(c, m)| c * m).sum();
        self.coefficients.iter().map(combine).collect()
    }

    /// Gradients of all shape functions in reference coordinates.
    pub fn gradients(&self, at: DVec3) -> Vec<DVec3> {
        let monomials: Vec<DVec3> = self.monomials.iter().map(|&m| gradient(m, at)).collect();
        let combine = |row: &Vec<f64>| row.iter().zip(&monomials).map(|(c, m)| *c * *m).sum();
        self.coefficients.iter().map(combine).collect()
    }
}

/// `x^a y^b z^c (1 - z)^-d`; at the apex of a pyramid its limit from inside.
fn value([a, b, c, d]: Monomial, at: DVec3) -> f64 {
    let top = 1.0 - at.z;
    if d > 0 && top == 0.0 {
        return 0.0;
    }
    at.x.powi(a) * at.y.powi(b) * at.z.powi(c) * top.powi(-d)
}

fn gradient([a, b, c, d]: Monomial, at: DVec3) -> DVec3 {
    let lowered = |n: i32, monomial: Monomial| match n {
        0 => 0.0,
        n => f64::from(n) * value(monomial, at),
    };
    DVec3::new(
        lowered(a, [a - 1, b, c, d]),
        lowered(b, [a, b - 1, c, d]),
        lowered(c, [a, b, c - 1, d]) + lowered(d, [a, b, c, d + 1]),
    )
}

/// Monomials of total degree up to `degree` in `x`, `y` and, in space, `z`.
fn complete(degree: i32, in_space: bool) -> Vec<Monomial> {
    let highest = if in_space { degree } else { 0 };
    let all = (0..=highest).flat_map(|c| tensor(degree).map(move |[a, b]| [a, b, c, 0]));
    all.filter(|[a, b, c, _]| a + b + c <= degree).collect()
}

/// Powers of `x` and `y` up to `degree` each.
fn tensor(degree: i32) -> impl Iterator<Item = [i32; 2]> {
    (0..=degree).flat_map(move |b| (0..=degree).map(move |a| [a, b]))
}

/// Serendipity: powers up to 2 each, of which the sum of those above 1 is at most 2.
fn serendipity(in_space: bool) -> Vec<Monomial> {
    let highest = if in_space { 2 } else { 0 };
    let all = (0..=highest).flat_map(|c| tensor(2).map(move |[a, b]| [a, b, c, 0]));
    let superlinear = |n: i32| if n > 1 { n } else { 0 };
    all.filter(|&[a, b, c, _]| superlinear(a) + superlinear(b) + superlinear(c) <= 2)
        .collect()
}

fn monomials(shape: Shape) -> Vec<Monomial> {
    let layers = |plane: Vec<Monomial>, degree: i32| -> Vec<Monomial> {
        (0..=degree)
            .flat_map(|c| {
                plane
                    .iter()
                    .map(move |&[a, b, ..]| [a, b, c, 0])
                    .collect::<Vec<_>>()
            })
            .collect()
    };
    let square =
        |degree: i32| -> Vec<Monomial> { tensor(degree).map(|[a, b]| [a, b, 0, 0]).collect() };
    let with = |mut list: Vec<Monomial>, more: &[Monomial]| {
        list.extend_from_slice(more);
        list
    };
    match shape {
        Shape::Line2 => vec![[0; 4], [1, 0, 0, 0]],
        Shape::Line3 => vec![[0; 4], [1, 0, 0, 0], [2, 0, 0, 0]],
        Shape::Tri3 => complete(1, false),
        Shape::Tri6 => complete(2, false),
        Shape::Quad4 => square(1),
        Shape::Quad8 => serendipity(false),
        Shape::Quad9 => square(2),
        Shape::Tet4 => complete(1, true),
        Shape::Tet10 => complete(2, true),
        Shape::Hex8 => layers(square(1), 1),
        Shape::Hex20 => serendipity(true),
        Shape::Hex27 => layers(square(2), 2),
        Shape::Prism6 => layers(complete(1, false), 1),
        Shape::Prism15 => with(
            layers(complete(2, false), 1),
            &[[0, 0, 2, 0], [1, 0, 2, 0], [0, 1, 2, 0]],
        ),
        Shape::Prism18 => layers(complete(2, false), 2),
        Shape::Pyramid5 => with(complete(1, true), &[[1, 1, 0, 1]]),
        Shape::Pyramid13 => with(complete(2, true), &BILINEAR),
        Shape::Pyramid14 => with(with(complete(2, true), &BILINEAR), &[[2, 2, 0, 2]]),
    }
}

/// `xy / (1 - z)` times 1, `x` and `y`.
const BILINEAR: [Monomial; 3] = [[1, 1, 0, 1], [2, 1, 0, 1], [1, 2, 0, 1]];
