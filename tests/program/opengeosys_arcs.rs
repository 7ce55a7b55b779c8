//! Projects of OpenGeoSys whose boundaries are meshes of their own, on arcs, beside closed forms.

use std::f64::consts::PI;
use std::fmt::Write as _;

use crate::fields::assert_near;
use crate::harness::{Run, Workshop};
use crate::opengeosys::{imported, numbers, solved};

/// Cells along the radius and around.
const COUNTS: [usize; 2] = [16, 24];
/// The radii of the ring (m).
const RADII: [f64; 2] = [1.0, 2.0];

/// A quarter of a ring in quadrangles of first order, node `(i, j)` at the radius `i` and the angle
/// `j`.
struct Ring {
    places: Vec<[f64; 2]>,
}

impl Ring {
    fn new() -> Self {
        let [out, around] = COUNTS;
        let place = |i: usize, j: usize| {
            let radius = RADII[0] + (RADII[1] - RADII[0]) * i as f64 / out as f64;
            let angle = PI / 2.0 * j as f64 / around as f64;
            [radius * angle.cos(), radius * angle.sin()]
        };
        let places = (0..=around).flat_map(|j| (0..=out).map(move |i| place(i, j)));
        Self {
            places: places.collect(),
        }
    }

    fn node([i, j]: [usize; 2]) -> usize {
        (COUNTS[0] + 1) * j + i
    }

    fn cells() -> Vec<Vec<usize>> {
        let [out, around] = COUNTS;
        let all = (0..around).flat_map(|j| (0..out).map(move |i| [i, j]));
        let corners = |[i, j]: [usize; 2]| [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
        all.map(|cell| corners(cell).map(Self::node).to_vec())
            .collect()
    }

    /// Lines from node to node.
    fn line(nodes: impl Iterator<Item = [usize; 2]>) -> Vec<Vec<usize>> {
        let nodes: Vec<usize> = nodes.map(Self::node).collect();
        nodes.windows(2).map(<[usize]>::to_vec).collect()
    }

    /// A grid of some cells with the nodes that they have; `shifted` moves them off those of the
    /// ring (m).
    fn grid(&self, cells: &[Vec<usize>], kind: u8, shifted: f64) -> String {
        let mut nodes: Vec<usize> = cells.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut points = String::new();
        for &node in &nodes {
            let [x, y] = self.places[node];
            let _ = write!(points, "{:?} {y:?} 0 ", x + shifted);
        }
        let own = |node: &usize| nodes.binary_search(node).expect("a node").to_string();
        let corners: Vec<String> = cells.iter().flatten().map(own).collect();
        let size = cells[0].len();
        let ends: Vec<String> = (1..=cells.len()).map(|n| (n * size).to_string()).collect();
        let list = |word: &str| vec![word; cells.len()].join(" ");
        format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
             <UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n\
             {points}\n</DataArray></Points>\n<Cells>\n\
             <DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{}</DataArray>\n\
             <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{}</DataArray>\n\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{}</DataArray>\n</Cells>\n\
             <CellData><DataArray type=\"Int32\" Name=\"MaterialIDs\" format=\"ascii\">{}\
             </DataArray></CellData>\n</Piece></UnstructuredGrid>\n</VTKFile>\n",
            nodes.len(),
            cells.len(),
            corners.join(" "),
            ends.join(" "),
            list(&kind.to_string()),
            list("0"),
        )
    }
}

/// A pressure of 10 MPa within the ring, which two planes of symmetry hold.
const PROJECT: &str = r#"<?xml version="1.0"?>
<OpenGeoSysProject>
<meshes><mesh>ring.vtu</mesh><mesh>inner.vtu</mesh><mesh>x_axis.vtu</mesh>
<mesh>y_axis.vtu</mesh></meshes>
<processes><process>
<name>SD</name><type>SMALL_DEFORMATION</type>
<constitutive_relation><type>LinearElasticIsotropic</type>
<youngs_modulus>E</youngs_modulus><poissons_ratio>nu</poissons_ratio></constitutive_relation>
</process></processes>
<time_loop><processes><process ref="SD"><time_stepping><type>FixedTimeStepping</type>
<t_initial>0</t_initial><t_end>1</t_end><timesteps><pair><repeat>1</repeat>
<delta_t>1</delta_t></pair></timesteps></time_stepping></process></processes></time_loop>
<parameters>
<parameter><name>push</name><type>CurveScaled</type><curve>bag</curve><parameter>one</parameter>
</parameter>
<parameter><name>one</name><type>Constant</type><value>1</value></parameter>
<parameter><name>E</name><type>Constant</type><value>20e9</value></parameter>
<parameter><name>nu</name><type>Constant</type><value>0.3</value></parameter>
<parameter><name>zero</name><type>Constant</type><value>0</value></parameter>
</parameters>
<curves><curve><name>bag</name><coords>0 1</coords><values>-10e6 -10e6</values></curve></curves>
<process_variables><process_variable><name>displacement</name><components>2</components>
<boundary_conditions>
<boundary_condition><mesh>inner</mesh><type>NormalTraction</type><parameter>push</parameter>
</boundary_condition>
<boundary_condition><mesh>x_axis</mesh><type>Dirichlet</type><component>1</component>
<parameter>zero</parameter></boundary_condition>
<boundary_condition><mesh>y_axis</mesh><type>Dirichlet</type><component>0</component>
<parameter>zero</parameter></boundary_condition>
</boundary_conditions></process_variable></process_variables>
</OpenGeoSysProject>
"#;

/// Imports the project, with its inner boundary moved off the ring (m).
fn ring(shifted: f64) -> (Workshop, Run) {
    let ring = Ring::new();
    let [out, around] = COUNTS;
    let inner = Ring::line((0..=around).map(|j| [0, j]));
    let [x_axis, y_axis] = [0, around].map(|j| Ring::line((0..=out).map(|i| [i, j])));
    imported(&[
        ("ring.prj", PROJECT),
        ("ring.vtu", &ring.grid(&Ring::cells(), 9, 0.0)),
        ("inner.vtu", &ring.grid(&inner, 3, shifted)),
        ("x_axis.vtu", &ring.grid(&x_axis, 3, 0.0)),
        ("y_axis.vtu", &ring.grid(&y_axis, 3, 0.0)),
    ])
}

/// Lame's ring in plane strain, `u(r) = (1 + nu)/E p a^2/(b^2 - a^2) ((1 - 2 nu) r + b^2/r)`; the
/// mean of its inner side along x is 2/pi of that.
#[test]
fn a_pressure_on_an_arc_widens_a_ring_as_in_closed_form() {
    let (workshop, run) = ring(0.0);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let rows = solved(&workshop);
    let [a, b] = RADII;
    let widened = 1.3 / 20e9 * 10e6 * a * a / (b * b - a * a) * (0.4 * a + b * b / a);
    for axis in ["displacement_x", "displacement_y"] {
        let found = numbers(&rows, "inner", axis)[0];
        assert_near(found, widened * 2.0 / PI, 2e-3);
    }
}

#[test]
fn a_boundary_whose_nodes_are_not_those_of_the_body_is_told() {
    let (_workshop, run) = ring(1e-3);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let said = "no counterpart: `inner` is not there, or lies along no plane x, y or z";
    assert!(
        run.err.contains(said) || run.out.contains(said),
        "{}",
        run.err
    );
}
