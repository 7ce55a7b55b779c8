//! Flow in meshes of the plane, and between walls that are pushed through each other.

use std::fs;
use std::path::Path;

use crate::harness::{Workshop, edited, root, summary};

/// A joint of 4 m through a rectangle, with a node in its middle.
const STRIP: &str = "
Point(1) = {0, 0, 0}; Point(2) = {4, 0, 0}; Point(3) = {4, 1, 0}; Point(4) = {4, 2, 0};
Point(5) = {0, 2, 0}; Point(6) = {0, 1, 0}; Point(7) = {2, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6};
Line(6) = {6, 1}; Line(7) = {6, 7}; Line(8) = {7, 3};
Curve Loop(1) = {1, 2, -8, -7, 6}; Plane Surface(1) = {1};
Curve Loop(2) = {7, 8, 3, 4, 5}; Plane Surface(2) = {2};
Physical Surface(\"rock\") = {1, 2}; Physical Curve(\"bed\") = {7, 8};
Physical Curve(\"left\") = {5, 6}; Physical Curve(\"right\") = {2, 3};
Mesh.MeshSizeMin = 0.5; Mesh.MeshSizeMax = 0.5;
";

const FED: &str = "
[mesh]
geometry = \"strip.geo\"
dimension = 2
[fluid]
viscosity = 1e-3
[fracture.bed]
aperture = 1e-4
[boundary.left]
fluid_pressure = 0.0
[boundary.right]
fluid_pressure = 0.0
[[source]]
SOURCE
[probe.quarter]
at = [1.0, 1.0, 0.0]
fracture = \"bed\"
";

/// The last value of each row of a table under a column.
fn column(file: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(file).expect("a table");
    let mut rows = text.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let head = rows.next().expect("a head");
    let at = head.iter().position(|own| *own == name).expect("a column");
    rows.map(|row| row[at].parse().expect("a number")).collect()
}

/// Pressure at a quarter of the joint (Pa) and what the source gives (m3/s and metre).
fn fed(source: &str) -> [f64; 2] {
    let workshop = Workshop::of(&edited(FED, &[("SOURCE", source)]));
    fs::write(workshop.path("strip.geo"), STRIP).expect("a geometry");
    let out = workshop.solve("out", &[]);
    let pressures = column(&out.join("probes.csv"), "pressure");
    let rates = column(&out.join("sources.csv"), "rate");
    [pressures[0], rates[2]]
}

/// With `T = b^3 / (12 mu)` and a half of the joint to either side of its middle, `q = 2 T p / 2`
/// for a pressure there, and `p = q 2 / (2 T)` for a rate, of which a quarter has the half. A rate
/// along the middle half, evenly, gives `q / 2 (1 / T)` where that begins.
#[test]
fn sources_in_the_plane_feed_a_metre_of_thickness() {
    let transmissivity = 1e-12 / 12e-3;
    let rate = 1e-7;
    let whole = [5e3, 1e4 * transmissivity];
    let of_rate = [0.5 * rate / transmissivity, rate];
    for (source, wanted) in [
        ("at = [2, 1, 0]\nradius = 0.01\npressure = 1e4", whole),
        ("at = [2, 1, 0]\nradius = 0.01\nrate = 1e-7", of_rate),
        (
            "from = [2, 0.5, 0]\nto = [2, 1.5, 0]\nradius = 0.1\nrate = 1e-7",
            of_rate,
        ),
        ("points = [[1, 1, 0], [3, 1, 0]]\nrate = 1e-7", of_rate),
    ] {
        let found = fed(source);
        for (found, wanted) in found.iter().zip(wanted) {
            let off = found / wanted - 1.0;
            assert!(off.abs() < 1e-9, "{source}: {found}, not {wanted}");
        }
    }
}

/// Two triangles; OpenCASCADE leaves such elevations.
#[test]
fn rounding_in_the_elevation_of_a_plane_mesh_does_not_matter() {
    let mesh = |elevations: [&str; 4]| {
        let [a, b, c, d] = elevations;
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n\
             $PhysicalNames\n3\n1 1 \"bottom\"\n1 2 \"top\"\n2 3 \"rock\"\n$EndPhysicalNames\n\
             $Nodes\n4\n1 0 0 {a}\n2 1 0 {b}\n3 1 1 {c}\n4 0 1 {d}\n$EndNodes\n\
             $Elements\n4\n1 1 2 1 1 1 2\n2 1 2 2 2 3 4\n3 2 2 3 1 1 2 3\n4 2 2 3 1 1 3 4\n\
             $EndElements\n"
        )
    };
    let scene = "[mesh]\nfile = \"m.msh\"\n\
                 [rock.rock]\nyoung_modulus = 1e9\npoisson_ratio = 0.25\n\
                 [boundary.bottom]\ndisplacement = { x = 0, y = 0 }\n\
                 [boundary.top]\npressure = 1e6\n[boundary.left]\nwhere = \"x = min\"\nsymmetry = true\n";
    let workshop = Workshop::of(scene);
    let energy = |elevations| {
        fs::write(workshop.path("m.msh"), mesh(elevations)).expect("a mesh");
        let said = summary(&workshop.solve("out", &[]));
        said["measures"].to_string()
    };
    let rounded = energy(["0", "1e-17", "-3e-17", "0"]);
    assert_eq!(rounded, energy(["0"; 4]));
}

/// A linear joint with `K b0 = 5 MPa` under 9 MPa, once all its water has left: its walls overlap,
/// which the run says, at `b0 - sigma / K`.
#[test]
fn water_leaves_walls_that_are_pushed_through_each_other() {
    let geometry = root().join("geometries/inclined-joint/inclined-joint.geo");
    let scene = |time: &str| {
        format!(
            "[mesh]\ngeometry = \"{}\"\nparameters = {{ h = 0.45, dip = 0 }}\n\
             [rock.rock]\nyoung_modulus = 25e9\npoisson_ratio = 0.0\n\
             [fracture.joint]\naperture = 1e-4\nnormal_stiffness = 50e9\nshear_stiffness = 20e9\n\
             closure = \"linear\"\nresidual_hydraulic_aperture = 2e-6\n\
             [boundary.bottom]\ndisplacement = {{ x = 0, y = 0, z = 0 }}\n\
             [boundary.top]\npressure = 9e6\n{time}\n\
             [boundary.left]\nfluid_pressure = 0.0\n\
             [fluid]\nviscosity = 1e-3\ncompressibility = 4e-10\n",
            geometry.display()
        )
    };
    let timed = "history = [[0, 0], [1, 1]]\n[load]\ntimes = [1, 1e9]";
    let workshop = Workshop::of(&scene(timed));
    let run = workshop.run("out", &[]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let said = summary(&workshop.path("out"));
    assert!(
        said["warnings"].to_string().contains("overlap"),
        "{}",
        said["warnings"]
    );
    let aperture = &said["fractures"]["joint"]["aperture"];
    for of in ["min", "max"] {
        let found = aperture[of].as_f64().expect("a number");
        assert!((found + 8e-5).abs() < 1e-9, "{of}: {found}");
    }
}
