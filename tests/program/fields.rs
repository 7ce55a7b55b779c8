//! Values that vary in space and time, against closed forms and against plain numbers.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::harness::{Workshop, root};

/// The rows of a history; each maps columns to texts.
pub fn rows(out: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(out.join("history.csv")).expect("a history");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let rows = table.deserialize().collect::<Result<Vec<_>, _>>();
    rows.expect("a table")
}

/// A number of each row of a kind and name, in the order of the load steps.
pub fn numbers(rows: &[BTreeMap<String, String>], of: [&str; 2], column: &str) -> Vec<f64> {
    let own = rows
        .iter()
        .filter(|row| [&row["kind"][..], &row["name"]] == of);
    let found: Vec<f64> = own
        .map(|row| {
            row[column]
                .parse()
                .unwrap_or_else(|_| panic!("{column}: {row:?}"))
        })
        .collect();
    assert!(!found.is_empty(), "{of:?} {column}");
    found
}

pub fn assert_near(found: f64, expected: f64, share: f64) {
    assert!(
        (found / expected - 1.0).abs() < share,
        "{found:e} is not {expected:e}"
    );
}

fn scanned_joint(edits: &[(&str, &str)]) -> Workshop {
    let geometries = root().join("geometries");
    let geometry = geometries.join("inclined-joint/inclined-joint.geo");
    let beside = geometry.display().to_string();
    let own = [("../inclined-joint/inclined-joint.geo", &beside[..])];
    let scene = fs::read_to_string(geometries.join("scanned-joint/scene.toml")).expect("the scene");
    let workshop = Workshop::of(&crate::harness::edited(
        &crate::harness::edited(&scene, &own),
        edits,
    ));
    let scan = geometries.join("scanned-joint/scan.csv");
    fs::copy(scan, workshop.path("scan.csv")).expect("the scan is copied");
    workshop
}

/// Bending of both halves is quadratic, so cells of second order have it to the round-off that the
/// stiffness of a joint of 20 GPa/m leaves of displacements: 1e-8 of its closure.
#[test]
fn a_joint_whose_stiffness_is_scanned_closes_evenly_under_a_load_in_proportion() {
    let workshop = scanned_joint(&[]);
    let rows = rows(&workshop.solve("out", &[]));
    let joint = |column: &str| numbers(&rows, ["fracture", "joint"], column)[0];
    for aperture in ["aperture_min", "aperture_mean", "aperture_max"] {
        assert_near(joint(aperture), 9e-5, 1e-9);
    }
    assert_near(joint("normal_traction_mean"), -3e5, 1e-9);
    assert_near(joint("force_z"), -3e5, 1e-9);
    // Points of corners lie at the corners or beyond.
    assert!(joint("normal_traction_min") <= -3.99e5 && joint("normal_traction_max") >= -2.01e5);
}

/// The same oracle with the scan as an expression, and as one over the elevation of nothing.
#[test]
fn an_expression_says_the_same_as_samples() {
    let edit = (
        "{ file = \"scan.csv\", column = \"kn\", unit = \"GPa/m\", method = \"linear\" }",
        "{ expression = \"20 + 20*x\", unit = \"GPa/m\" }",
    );
    let workshop = scanned_joint(&[edit]);
    let rows = rows(&workshop.solve("out", &[]));
    for column in ["aperture_min", "aperture_max"] {
        let found = numbers(&rows, ["fracture", "joint"], column)[0];
        assert_near(found, 9e-5, 1e-9);
    }
}

/// The same oracle with the scan as a grid of VTK: its points on the joint, linear between.
#[test]
fn a_grid_says_the_same_as_a_table() {
    let python = crate::read_back::python();
    let script = "import csv, sys, vtk\n\
        grid, kn = vtk.vtkUnstructuredGrid(), vtk.vtkDoubleArray()\n\
        points = vtk.vtkPoints()\n\
        points.SetDataTypeToDouble()\n\
        kn.SetName('kn')\n\
        lines = [line for line in open(sys.argv[1]) if line[0] != '#']\n\
        for row in csv.DictReader(lines):\n\
        \x20   place = [float(row.get(axis) or 0) for axis in 'xyz']\n\
        \x20   number = points.InsertNextPoint(place)\n\
        \x20   kn.InsertNextValue(float(row['kn']))\n\
        \x20   ids = vtk.vtkIdList()\n\
        \x20   ids.InsertNextId(number)\n\
        \x20   grid.InsertNextCell(vtk.VTK_VERTEX, ids)\n\
        grid.SetPoints(points)\n\
        grid.GetPointData().AddArray(kn)\n\
        writer = vtk.vtkXMLUnstructuredGridWriter()\n\
        writer.SetInputData(grid)\n\
        writer.SetFileName(sys.argv[2])\n\
        writer.Write()\n";
    let workshop = scanned_joint(&[("file = \"scan.csv\"", "file = \"scan.vtu\"")]);
    let run = std::process::Command::new(python)
        .args(["-c", script])
        .args([workshop.path("scan.csv"), workshop.path("scan.vtu")])
        .status();
    assert!(run.expect("Python").success());
    let rows = rows(&workshop.solve("out", &[]));
    for column in ["aperture_min", "aperture_max"] {
        let found = numbers(&rows, ["fracture", "joint"], column)[0];
        assert_near(found, 9e-5, 1e-9);
    }
    let wrong = scanned_joint(&[
        ("file = \"scan.csv\"", "file = \"scan.vtu\""),
        ("column = \"kn\"", "column = \"ks\""),
    ]);
    fs::copy(workshop.path("scan.vtu"), wrong.path("scan.vtu")).expect("copied");
    let run = wrong.run("out", &[]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(run.err.contains("`kn`"), "{}", run.err);
}

/// Water in the joint takes off what it puts on the faces.
#[test]
fn water_by_depth_leaves_an_even_closure() {
    let workshop = Workshop::new("water-by-depth", &[]);
    let rows = rows(&workshop.solve("out", &[]));
    let joint = |column: &str| numbers(&rows, ["fracture", "joint"], column)[0];
    for aperture in ["aperture_min", "aperture_max"] {
        assert_near(joint(aperture), 4e-4, 1e-9);
    }
    for traction in ["normal_traction_min", "normal_traction_max"] {
        assert_near(joint(traction), -2e6, 1e-9);
    }
    let force = numbers(&rows, ["boundary", "left"], "force_x")[0];
    assert_near(force, 2.049_05e7, 1e-9);
}

/// A front that rises with time is, at the end of each load step, the front of that time.
#[test]
fn a_pressure_front_is_at_each_step_what_its_time_says() {
    let water = "{ table = [[0, 0], [10, 98.1]], over = \"depth\", ground = 10, unit = \"kPa\" }";
    let face = "[boundary.left]\npressure = { expression = \"2e6 + 9810*depth\", ground = 10 }";
    let front = |time: &str| format!("{{ expression = \"9810*max(0, 5*{time} - z)\" }}");
    let pressed = |time: &str| {
        let text = "[boundary.left]\npressure = { expression = \"2e6 + 9810*max(0, 5*TIME - z)\" }";
        text.replace("TIME", time)
    };
    let solve = |time: &str, load: &str| {
        let (water_then, face_then) = (front(time), pressed(time));
        let load = format!("{load}[mesh]");
        let edits = [
            (water, &water_then[..]),
            (face, &face_then[..]),
            ("[mesh]", &load),
            ("order = 2", "order = 1"),
        ];
        rows(&Workshop::new("water-by-depth", &edits).solve("out", &[]))
    };
    let times = ["0.5", "1.25", "3"];
    let all = solve("time", &format!("[load]\ntimes = [{}]\n", times.join(", ")));
    for (step, time) in times.into_iter().enumerate() {
        let one = solve(time, "");
        for (of, column) in [
            (["fracture", "joint"], "aperture_min"),
            (["fracture", "joint"], "aperture_max"),
            (["fracture", "joint"], "normal_traction_mean"),
            (["boundary", "left"], "force_x"),
            (["boundary", "right"], "displacement_x"),
        ] {
            let moving = numbers(&all, of, column)[step];
            assert_near(moving, numbers(&one, of, column)[0], 1e-9);
        }
    }
    let mean = numbers(&all, ["fracture", "joint"], "aperture_mean");
    assert!(mean[0] != mean[1] && mean[1] != mean[2], "{mean:?}");
}

/// Rock and joint carry their weight from the start, by a table over depth and by an expression.
#[test]
fn a_stress_that_grows_with_depth_and_balances_the_weight_moves_nothing() {
    let stress = "[initial_stress]\n\
        zz = { table = [[0, 0], [10, -264.87]], over = \"depth\", ground = 10, unit = \"kPa\" }\n\
        xx = { expression = \"-0.5 * 26487 * depth\", ground = 10 }\n\
        yy = { value = 0, per_metre = 13e3, at = 10 }\n\
        [body]\ngravity = [0, 0, -9.81]\n[boundary.bottom]\nsymmetry = true\n";
    let left = "[boundary.left]\npressure = { expression = \"2e6 + 9810*depth\", ground = 10 }";
    let right = left.replace("left", "right");
    let edits = [
        (
            "poisson_ratio = 0.25",
            "poisson_ratio = 0.25\ndensity = 2700",
        ),
        (
            "fluid_pressure = { table = [[0, 0], [10, 98.1]], over = \"depth\", ground = 10, unit = \"kPa\" }",
            "",
        ),
        (
            left,
            &format!("{stress}[boundary.left]\nsymmetry = true")[..],
        ),
        (&right, "[boundary.right]\nsymmetry = true"),
        (
            "displacement = { x = 0.0, z = 0.0 }",
            "displacement = { y = 0.0 }",
        ),
        ("displacement = { x = 0.0 }", "displacement = { y = 0.0 }"),
    ];
    let workshop = Workshop::new("water-by-depth", &edits);
    let geo = fs::read_to_string(workshop.path("water-by-depth.geo")).expect("the geometry");
    let bottom = "bottom() = Surface In BoundingBox {-eps, -eps, -eps, 2 + eps, 1 + eps, eps};\n\
        Physical Surface(\"bottom\") = bottom();\nPhysical Volume";
    let geo = geo.replace("Physical Volume", bottom);
    fs::write(workshop.path("water-by-depth.geo"), geo).expect("written");
    let rows = rows(&workshop.solve("out", &[]));
    // An elastic column under that weight would settle by rho g h^2 / 2 E = 5e-5 m.
    for block in ["1", "2"] {
        for axis in ["x", "y", "z"] {
            let column = format!("displacement_{axis}");
            let moved = numbers(&rows, ["block", block], &column)[0];
            assert!(moved.abs() < 1e-15, "{column}: {moved:e}");
        }
    }
}

#[test]
fn what_varies_is_told_and_a_changed_file_resumes_nothing() {
    let workshop = scanned_joint(&[("order = 2", "order = 1")]);
    let run = workshop.run("out", &["-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for text in [
        "[fracture.joint.normal_stiffness]: 2.",
        "25 samples of `scan.csv`",
        "from a sample",
    ] {
        assert!(run.out.contains(text), "{text}: {}", run.out);
    }
    let scan = fs::read_to_string(workshop.path("scan.csv")).expect("the scan");
    fs::write(workshop.path("scan.csv"), scan.replace("1,1,40", "1,1,41")).expect("written");
    let run = workshop.run("out", &["--resume"]);
    assert_eq!(run.code, Some(2));
    assert!(
        run.err
            .contains("a file of values that the scene names has changed"),
        "{}",
        run.err
    );
}

/// A column of 2 m whose stiffness doubles from its foot to its top, `E = 25e9 (1 + z/2)`,
/// shortens by `p 2/25e9 ln 2` and its joint by `p / K_n`. Each cell has one modulus, of its
/// middle: an error of the second order in the cell size, a tenth of a percent here; without the
/// change it is 30 %.
#[test]
fn a_column_whose_modulus_grows_with_elevation_shortens_by_a_logarithm() {
    let scan = "{ file = \"scan.csv\", column = \"kn\", unit = \"GPa/m\", method = \"linear\" }";
    let edits = [
        (scan, "20e9"),
        (
            "young_modulus = 25e9",
            "young_modulus = { expression = \"25e9*(1 + z/2)\" }",
        ),
        ("poisson_ratio = 0.25", "poisson_ratio = 0"),
        (
            "pressure = { expression = \"1e-5 * (20e9 + 20e9*x)\" }",
            "pressure = 1e6",
        ),
        ("{ expression = \"1e-5 * (20e9 + 20e9*x)\" }", "1e6"),
    ];
    let workshop = scanned_joint(&edits);
    let rows = rows(&workshop.solve("out", &[]));
    let moved = |face: &str| numbers(&rows, ["boundary", face], "displacement_z")[0];
    let exact = -1e6 * (2.0 / 25e9 * 2_f64.ln() + 1.0 / 20e9);
    assert_near(moved("top") - moved("bottom"), exact, 3e-3);
}

/// The fault of the scene carries what is above it, whatever its stiffness. The tolerance is that
/// of the last Newton step.
#[test]
fn a_fault_with_a_stiffness_from_a_file_carries_the_load() {
    let h = ("h = {1.2, Name", "h = {2.4, Name");
    let workshop = Workshop::new("scanned-fault", &[]);
    let geo = workshop.path("scanned-fault.geo");
    let text = fs::read_to_string(&geo).expect("the geometry");
    fs::write(geo, crate::harness::edited(&text, &[h])).expect("written");
    let scan = root().join("geometries/scanned-fault/scan.csv");
    fs::copy(scan, workshop.path("scan.csv")).expect("the scan is copied");
    let rows = rows(&workshop.solve("out", &[]));
    let fault = |column: &str| numbers(&rows, ["fracture", "fault"], column)[0];
    assert_near(fault("normal_traction_mean"), -3e6, 1e-9);
    assert_near(fault("force_z"), -4.32e8, 1e-9);
    // Soft parts close, stiff ones carry.
    assert!(fault("normal_traction_min") < -6e6 && fault("normal_traction_max") > -1e6);
}

/// One fault with six samples, each the nearest in a field of its own, is six fractures of one
/// stiffness each.
#[test]
fn samples_in_a_file_are_constants_on_parts_of_a_fault() {
    const STIFFNESSES: [&str; 6] = ["2", "9", "30", "4", "15", "1.5"];
    let sampled = "{ file = \"scan.csv\", column = \"kn\", unit = \"GPa/m\", method = \"linear\" }";
    let mesh = (
        "geometry = \"scanned-fault.geo\"",
        "geometry = \"scanned-fault.geo\"\nparameters = { h = 3, h_fault = 1.5, fields = 1 }",
    );
    let law = |name: &str, stiffness: &str| {
        format!(
            "[fracture.{name}]\naperture = 2e-3\nnormal_stiffness = {stiffness}\n\
             shear_stiffness = 5e9\nclosure = \"logarithmic\"\n"
        )
    };
    let drawn = law("fault", sampled);
    let of_file = law("default", &sampled.replace("linear", "nearest"));
    let parts = STIFFNESSES.iter().zip(1..);
    let plain =
        parts.map(|(stiffness, part)| law(&format!("fault-{part}"), &format!("{stiffness}e9")));
    let plain: String = plain.collect();
    let places = [3, 9]
        .into_iter()
        .flat_map(|x| [1.5, 4.5, 7.5].map(|y| (x, y)));
    let samples = places
        .zip(STIFFNESSES)
        .map(|((x, y), kn)| format!("{x},{y},{kn}\n"));
    let samples = format!("x,y,kn\n{}", samples.collect::<String>());
    let [of_file, plain] = [of_file, plain].map(|laws| {
        let workshop = Workshop::new("scanned-fault", &[mesh, (&drawn, &laws)]);
        fs::write(workshop.path("scan.csv"), &samples).expect("written");
        rows(&workshop.solve("out", &[]))
    });
    for part in 1..=6 {
        let name = format!("fault-{part}");
        for column in ["aperture_mean", "normal_traction_min", "slip_max"] {
            let [found, wanted] =
                [&of_file, &plain].map(|rows| numbers(rows, ["fracture", &name], column)[0]);
            assert_near(found, wanted, 1e-12);
        }
    }
}
