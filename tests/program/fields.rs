//! Values that vary in space and time, against closed forms and against plain numbers.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::flow::sources;
use crate::harness::{Workshop, root};

/// The rows of a history; each maps columns to texts.
fn rows(out: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(out.join("history.csv")).expect("a history");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let rows = table.deserialize().collect::<Result<Vec<_>, _>>();
    rows.expect("a table")
}

/// A number of each row of a kind and name, in the order of the load steps.
fn numbers(rows: &[BTreeMap<String, String>], of: [&str; 2], column: &str) -> Vec<f64> {
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

fn assert_near(found: f64, expected: f64, share: f64) {
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

/// In the west joint the transmissivity is `T0 (1 + x)`, so that `T0 / ln 2` conducts between its
/// ends; the other three have one each.
#[test]
fn a_hydraulic_aperture_that_varies_conducts_as_the_integral_has_it() {
    let field = |b: &str| format!("{b} = {{ expression = \"1e-4 * (1 + x)^(1/3)\" }}");
    let own = "[fracture.west]\nhydraulic_aperture = 1e-4";
    for key in ["hydraulic_aperture", "aperture"] {
        let varying = format!("[fracture.west]\n{}", field(key));
        let edits = [
            (own, &varying[..]),
            (
                "parameters = { h = 0.2 }",
                "parameters = { h = 0.05 }\ndimension = 2",
            ),
        ];
        let workshop = Workshop::new("flow-star", &edits);
        let rows = sources(&workshop.solve("out", &[]));
        let pairs = [
            (1.0 / 2_f64.ln(), 3e5),
            (8.0, 1e5),
            (0.125, 0.0),
            (3.375, 2e5),
        ];
        let conducted: f64 = pairs.iter().map(|(t, p)| t * p).sum();
        let line = conducted / pairs.iter().map(|(t, _)| t).sum::<f64>();
        let rate = 1e-12 / 12e-3 / 2_f64.ln() * (3e5 - line);
        let left = rows.iter().find(|row| row.0 == "[boundary.left]");
        assert_near(left.expect("a row").2, rate, 2e-4);
    }
}

/// What is the same everywhere is what a number says, to the last bit, also where the flow follows
/// the walls.
#[test]
fn hydraulic_values_that_do_not_vary_are_numbers() {
    let solve = |keys: &str| {
        let more = format!("closure = \"linear\"\n{keys}");
        let edits = [
            ("closure = \"linear\"", &more[..]),
            (
                "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
                "times = [10, 20]",
            ),
        ];
        let workshop = Workshop::new("filling-joint", &edits);
        let out = workshop.solve("out", &[]);
        fs::read(out.join("history.csv")).expect("a history")
    };
    let plain = solve("roughness = 1.5\nresidual_hydraulic_aperture = 2e-6");
    let varying = solve(
        "roughness = { expression = \"1.5\" }\n\
         residual_hydraulic_aperture = { table = [[0, 2], [1, 2]], over = \"x\", unit = \"um\", \
         beyond = \"nearest\" }",
    );
    assert_eq!(plain, varying);
    assert_ne!(plain, solve("roughness = { expression = \"1.5 + x\" }"));
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

/// The pressure of each end of the flow star, in the order left, right, front, back.
fn star_of(ends: [&str; 4], edits: &[(&str, &str)]) -> Workshop {
    let given = ["3e5", "1e5", "0.0", "2e5"].map(|value| format!("fluid_pressure = {value}"));
    let wanted = ends.map(|value| format!("fluid_pressure = {value}"));
    let pairs = given.iter().zip(&wanted);
    let pairs = pairs.map(|(given, wanted)| (&given[..], &wanted[..]));
    let edits: Vec<(&str, &str)> = pairs.chain(edits.iter().copied()).collect();
    Workshop::new("flow-star", &edits)
}

/// A hat over the height of the end: linear between nodes, so that the rates are those of its
/// mean, to round-off.
#[test]
fn a_pressure_that_varies_along_a_boundary_drives_what_its_mean_drives() {
    let hat = "{ table = [[0, 2], [0.5, 4], [1, 2]], over = \"z\", unit = \"bar\" }";
    let ends = [hat, "1e5", "0.0", "2e5"];
    let workshop = star_of(ends, &[("h = 0.2", "h = 0.25")]);
    let rows = sources(&workshop.solve("out", &[]));
    for (side, _, rate) in crate::flow::star() {
        let name = format!("[boundary.{side}]");
        let row = rows.iter().find(|row| row.0 == name);
        assert_near(row.expect("a row").2, rate, 1e-11);
    }
}

/// Harmonic pressures in half planes of width and height 1 m whose far end has `P cos(pi z)`: where
/// they meet it is `T P cos(pi z) / (sum T cosh(pi))`. Triangles are off by the second order of
/// their size.
#[test]
fn a_pressure_that_varies_along_a_boundary_fades_as_its_closed_form() {
    let wave = "{ expression = \"1e5 * (1 + cos(PI*z))\" }";
    let edits = [
        (
            "parameters = { h = 0.2 }",
            "parameters = { h = 0.05 }\ndimension = 2",
        ),
        (
            "[fracture.west]\nhydraulic_aperture = 1e-4",
            "[fracture.west]\nhydraulic_aperture = 2e-4",
        ),
    ];
    let workshop = star_of([wave, "1e5", "1e5", "1e5"], &edits);
    let out = workshop.solve("out", &[]);
    let rows = rows(&out);
    let largest = numbers(&rows, ["fracture", "east"], "pressure_max")[0];
    let fades = 8.0 / ((8.0 + 8.0 + 0.125 + 3.375) * std::f64::consts::PI.cosh());
    assert_near((largest - 1e5) / 1e5, fades, 1e-2);
    let rate = sources(&out).into_iter().map(|row| row.2);
    // What 1 bar drives through the west joint is 6.7e-5 m3/s.
    assert!(rate.map(f64::abs).fold(0.0, f64::max) < 1e-15);
}

/// In a joint whose pressure is given all over, linear to the value at the line, what enters is
/// what the others take from there.
#[test]
fn a_pressure_given_all_over_a_fracture_may_vary_in_it() {
    let own = "[fracture.west]\nhydraulic_aperture = 1e-4";
    let given = format!("{own}\nfluid_pressure = {{ expression = \"3e5 - 2e5*x\" }}");
    let edits = [
        (own, &given[..]),
        ("[boundary.left]\nfluid_pressure = 3e5\n", ""),
    ];
    let workshop = Workshop::new("flow-star", &edits);
    let out = workshop.solve("out", &[]);
    let found = sources(&out);
    let rate = |name: &str| found.iter().find(|row| row.0 == name).expect("a row").2;
    let line = 1e5;
    let others = [
        ("right", 2e-4_f64, 1e5),
        ("front", 0.5e-4, 0.0),
        ("back", 1.5e-4, 2e5),
    ];
    let mut taken = 0.0;
    for (side, aperture, end) in others {
        let expected = aperture.powi(3) / 12e-3 * (end - line);
        let error = rate(&format!("[boundary.{side}]")) - expected;
        assert!(error.abs() < 1e-15, "{side}: {error:e}");
        taken -= expected;
    }
    assert_near(rate("[fracture.west]"), taken, 1e-11);
    let rows = rows(&out);
    let west = |column: &str| numbers(&rows, ["fracture", "west"], column)[0];
    assert_near(west("pressure_max"), 3e5, 1e-12);
    assert_near(west("pressure_mean"), 2e5, 1e-12);
}

#[test]
fn a_pressure_that_a_table_does_not_reach_is_refused_with_its_place() {
    let short = "{ table = [[0, 2e5], [0.7, 4e5]], over = \"z\" }";
    let run = star_of([short, "1e5", "0.0", "2e5"], &[]).run("out", &[]);
    assert_eq!(run.code, Some(2));
    for said in [
        "[boundary.left.fluid_pressure]",
        "from a table over z from 0 to 0.7: there is no row at (0.000000, 1.000000, ",
        "add rows that reach there",
    ] {
        assert!(run.err.contains(said), "{said}: {}", run.err);
    }
    let timed = "{ expression = \"1e5*time\" }";
    let run = star_of([timed, "1e5", "0.0", "2e5"], &[]).run("out", &[]);
    assert_eq!(run.code, Some(2));
    let said = "`fluid_pressure` does not change with time";
    assert!(run.err.contains(said), "{}", run.err);
}

/// What is the same everywhere is what a number says, to the last bit, also under a history and
/// where the flow follows the walls.
#[test]
fn pressures_that_do_not_vary_are_numbers() {
    let solve = |pressure: &str| {
        let edits = [
            ("fluid_pressure = 0.9e6", pressure),
            (
                "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
                "times = [10, 20]",
            ),
        ];
        let workshop = Workshop::new("filling-joint", &edits);
        let out = workshop.solve("out", &[]);
        fs::read(out.join("history.csv")).expect("a history")
    };
    let plain = solve("fluid_pressure = 0.9e6");
    let varying = solve("fluid_pressure = { expression = \"0.9e6 + 0*x\" }");
    assert_eq!(plain, varying);
    assert_ne!(
        plain,
        solve("fluid_pressure = { expression = \"0.9e6 + 1e5*y\" }")
    );
}
