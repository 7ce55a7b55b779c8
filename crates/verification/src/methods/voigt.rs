//! The linear tetrahedron as in textbooks, for the split-node formulation.

use glam::DVec3;

/// `V B^T D B` in Voigt order xx, yy, zz, xy, yz, xz with engineering shear strains.
pub fn tetrahedron(x: &[DVec3], e: f64, nu: f64) -> [[f64; 12]; 12] {
    let volume = (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) / 6.0;
    let mut b = [[0.0; 12]; 6];
    for a in 0..4 {
        // The gradient of a shape function: the opposite face over three times the volume.
        let [p, q, r] = [1, 2, 3].map(|i| x[(a + i) % 4]);
        let mut g = (q - p).cross(r - p);
        g /= g.dot(x[a] - p);
        for (row, column, value) in [
            (0, 0, g.x),
            (1, 1, g.y),
            (2, 2, g.z),
            (3, 0, g.y),
            (3, 1, g.x),
            (4, 1, g.z),
            (4, 2, g.y),
            (5, 0, g.z),
            (5, 2, g.x),
        ] {
            b[row][3 * a + column] = value;
        }
    }
    let d = isotropic(e, nu);
    let mut stiffness = [[0.0; 12]; 12];
    for (i, row) in stiffness.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let work = |k: usize| (0..6).map(|l| b[k][i] * d[k][l] * b[l][j]).sum::<f64>();
            *entry = volume * (0..6).map(work).sum::<f64>();
        }
    }
    stiffness
}

fn isotropic(e: f64, nu: f64) -> [[f64; 6]; 6] {
    let factor = e / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let mut d = [[0.0; 6]; 6];
    for i in 0..3 {
        d[i][..3].fill(factor * nu);
        d[i][i] = factor * (1.0 - nu);
        d[i + 3][i + 3] = factor * (0.5 - nu);
    }
    d
}
