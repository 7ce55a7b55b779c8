//! A closed disc that slides against friction under compression.

use glam::DVec3;

use super::inclined_crack::{profiles, reached, table};
use super::scene;
use crate::report::{Effort, Finding, Study, percent};

pub const PAGE: Study = Study {
    name: "inclined-penny",
    title: "Inclined disc with friction",
    subject: "C. M. Segedin, Proc. Camb. Phil. Soc. 47, 1951; J. D. Eshelby, Proc. R. Soc. A 241, \
              1957",
    run,
};

const CLOSED_FORM: &str = "
With E = 25 GPa, nu = 0.25, G = 10 GPa, p = 100 MPa, psi = 20 degrees, phi = 30 degrees, a = 1 m, in
unbounded rock:

    driving shear     t = p sin psi (cos psi - sin psi tan phi)          25.38567 MPa
    normal traction   -p sin²psi                                         -11.697778 MPa
    slip              8 (1 - nu) t / (pi (2 - nu) G) sqrt(a² - r²)       2.770460e-3 m at the centre";

/// Sizes at the front and in the middle (m), and growth (m a metre).
const MESHES: [[f64; 3]; 3] = [[0.12, 0.3, 0.6], [0.06, 0.2, 0.5], [0.03, 0.1, 0.35]];

const PROBLEM: &str = "A closed disc of radius 1 m in a cube of side 20 m, pressed by 100 MPa at \
    20 degrees to its plane, slides against a friction of 30 degrees; its walls are in contact \
    without a stiffness (`geometries/inclined-penny`). Second-order tetrahedra with quarter \
    points. \"Inside\" leaves out the ring next to the front that the scene names (`ring`, a share \
    of the radius).";

fn run(_: Effort) -> Finding {
    let mesh = |[h, middle, grow]: [f64; 3]| {
        format!("parameters = {{ h = {h}, h_disc = {middle}, grow = {grow} }}\norder = 2")
    };
    let cases = MESHES.map(|sizes| (sizes[0], scene::run("inclined-penny", &mesh(sizes), &[])));
    let [(coarsest, coarse), .., (finest, fine)] = &cases;
    let meshes = [(*coarsest, coarse), (*finest, fine)];
    let chart = profiles("Disc with friction", 2.770_460e-3, DVec3::length, &meshes);
    Finding::new([reached(fine), fine.unknowns().to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("inclined-penny-slip", chart)
        .table(table(&cases))
        .shows(format!(
            "With h = {finest} m at the front the slip is {} off in L2 ({} with h = {coarsest} m), \
             inside {} in L2 and {} at most; the normal traction inside {} in L2.",
            percent(fine.error("slip_l2")),
            percent(coarse.error("slip_l2")),
            percent(fine.error("slip_l2_inside")),
            percent(fine.error("slip_max_inside")),
            percent(fine.error("normal_traction_l2_inside")),
        ))
}
