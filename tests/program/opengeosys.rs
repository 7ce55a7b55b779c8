//! Projects of OpenGeoSys, imported and solved, beside closed forms and beside what OpenGeoSys has
//! stored for its own tests (ufz/ogs, Tests/Data/LIE/Mechanics, BSD 3-clause; numbers alone, the
//! meshes are made here).

use std::fs;

use crate::harness::{Run, Workshop, kluft};
use crate::import::GRID;
use crate::lie_project::Story;

/// Three squares on one another, material 2, with lines 0 and 1 between.
const COLUMN: &str = r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="5">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 0 1 0 1 1 0 0 2 0 1 2 0 0 3 0 1 3 0
</DataArray></Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">
0 1 3 2 2 3 5 4 4 5 7 6 2 3 4 5</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4 8 12 14 16</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9 9 9 3 3</DataArray>
</Cells>
<CellData>
<DataArray type="Int32" Name="MaterialIDs" format="ascii">2 2 2 0 1</DataArray>
</CellData>
</Piece></UnstructuredGrid>
</VTKFile>
"#;

const GEOMETRY: &str = r#"<?xml version="1.0"?>
<OpenGeoSysGLI><name>column</name>
<points>
<point id="0" x="0" y="0" z="0" name="CORNER"/><point id="1" x="0" y="3" z="0"/>
<point id="2" x="1" y="0" z="0"/><point id="3" x="1" y="3" z="0"/>
</points>
<polylines>
<polyline id="0" name="BOTTOM"><pnt>0</pnt><pnt>2</pnt></polyline>
<polyline id="1" name="TOP"><pnt>1</pnt><pnt>3</pnt></polyline>
<polyline id="2" name="ACROSS"><pnt>0</pnt><pnt>3</pnt></polyline>
</polylines>
</OpenGeoSysGLI>
"#;

const PROJECT: &str = r#"<?xml version="1.0" encoding="ISO-8859-1"?>
<OpenGeoSysProject>
<mesh>column.vtu</mesh><geometry>column.gml</geometry>
<processes><process>
<name>SD</name><type>SMALL_DEFORMATION_WITH_LIE</type><integration_order>2</integration_order>
<constitutive_relation><type>LinearElasticIsotropic</type>
<youngs_modulus>E</youngs_modulus><poissons_ratio>nu</poissons_ratio></constitutive_relation>
<fracture_model><type>LinearElasticIsotropic</type>
<normal_stiffness>Kn</normal_stiffness><shear_stiffness>Kn</shear_stiffness>
<penalty_aperture_cutoff>1e-5</penalty_aperture_cutoff><tension_cutoff>0</tension_cutoff>
</fracture_model>
<fracture_properties><material_id>0</material_id><initial_aperture>b</initial_aperture>
</fracture_properties>
<fracture_properties><material_id>1</material_id><initial_aperture>b</initial_aperture>
</fracture_properties>
<reference_temperature>T</reference_temperature>
</process></processes>
<time_loop><processes><process ref="SD"><time_stepping><type>FixedTimeStepping</type>
<t_initial>0</t_initial><t_end>3</t_end><timesteps><pair><repeat>10</repeat>
<delta_t>1</delta_t></pair></timesteps></time_stepping></process></processes></time_loop>
<parameters>
<parameter><name>pull</name><type>CurveScaled</type><curve>ramp</curve><parameter>force</parameter>
</parameter>
<parameter><name>force</name><type>Constant</type><value>1e5</value></parameter>
<parameter><name>E</name><type>Constant</type><value>200e9</value></parameter>
<parameter><name>nu</name><type>Constant</type><value>0</value></parameter>
<parameter><name>Kn</name><type>Constant</type><value>20e9</value></parameter>
<parameter><name>b</name><type>Constant</type><value>1e-5</value></parameter>
<parameter><name>zero</name><type>Constant</type><value>0</value></parameter>
</parameters>
<curves><curve><name>ramp</name><coords>0 1 3</coords><values>0 1 -1</values></curve></curves>
<process_variables><process_variable><name>displacement</name><components>2</components>
<boundary_conditions>
<boundary_condition><geometrical_set>column</geometrical_set><geometry>BOTTOM</geometry>
<type>Dirichlet</type><component>1</component><parameter>zero</parameter></boundary_condition>
<boundary_condition><geometrical_set>column</geometrical_set><geometry>CORNER</geometry>
<type>Dirichlet</type><component>0</component><parameter>zero</parameter></boundary_condition>
<boundary_condition><geometrical_set>column</geometrical_set><geometry>TOP</geometry>
<type>Neumann</type><component>1</component><parameter>pull</parameter></boundary_condition>
<boundary_condition><geometrical_set>column</geometrical_set><geometry>ACROSS</geometry>
<type>Neumann</type><component>0</component><parameter>force</parameter></boundary_condition>
<boundary_condition><geometrical_set>column</geometrical_set><geometry>TOP</geometry>
<type>Robin</type><component>0</component><parameter>force</parameter></boundary_condition>
</boundary_conditions></process_variable></process_variables>
</OpenGeoSysProject>
"#;

fn imported_project(project: &str) -> (Workshop, Run) {
    project_on([COLUMN, GEOMETRY, project])
}

fn project_on([mesh, geometry, project]: [&str; 3]) -> (Workshop, Run) {
    imported(&[
        ("column.prj", project),
        ("column.vtu", mesh),
        ("column.gml", geometry),
    ])
}

/// Imports a project, the first of some files, into the folder `made`.
pub fn imported(files: &[(&str, &str)]) -> (Workshop, Run) {
    let workshop = Workshop::of("");
    fs::remove_file(workshop.scene()).expect("removed");
    for (name, text) in files {
        fs::write(workshop.path(name), text).expect("written");
    }
    let run = kluft(&[
        "import".as_ref(),
        workshop.path(files[0].0).as_os_str(),
        "-o".as_ref(),
        workshop.path("made").as_os_str(),
        "-v".as_ref(),
    ]);
    (workshop, run)
}

pub type Rows = Vec<std::collections::BTreeMap<String, String>>;

/// Runs the scene that was made; its history.
pub fn solved(workshop: &Workshop) -> Rows {
    let scene = workshop.path("made/scene.toml");
    let run = kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let history = fs::read_to_string(workshop.path("made/out/history.csv")).expect("a history");
    let mut table = csv::Reader::from_reader(history.as_bytes());
    table.deserialize().map(|row| row.expect("a row")).collect()
}

pub fn numbers(rows: &Rows, name: &str, column: &str) -> Vec<f64> {
    let own = rows.iter().filter(|row| row["name"] == name);
    own.map(|row| row[column].parse().expect("a number"))
        .collect()
}

/// A column with two joints, pulled and then pushed: each joint opens and closes by `t/K_n`, three
/// metres of rock stretch by `3 t/E`.
#[test]
fn a_project_of_opengeosys_becomes_a_scene_that_runs() {
    let (workshop, run) = imported_project(PROJECT);
    assert_eq!(run.code, Some(0), "{}", run.err);
    for said in ["reference_temperature", "`ACROSS`", "Robin"] {
        assert!(run.out.contains(said), "{said}: {}", run.out);
    }
    let scene = workshop.path("made/scene.toml");
    let run = kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let history = fs::read_to_string(workshop.path("made/out/history.csv")).expect("a history");
    let mut table = csv::Reader::from_reader(history.as_bytes());
    let rows = table.deserialize::<std::collections::BTreeMap<String, String>>();
    let rows: Vec<_> = rows.map(|row| row.expect("a row")).collect();
    let found = |name: &str, column: &str| -> Vec<f64> {
        let own = rows.iter().filter(|row| row["name"] == name);
        own.map(|row| row[column].parse().expect("a number"))
            .collect()
    };
    for (step, factor) in [1.0, 0.0, -1.0].into_iter().enumerate() {
        let traction = factor * 1e5;
        let wanted = 1e-5 + traction / 20e9;
        for joint in ["surface-0", "surface-1"] {
            for end in ["aperture_min", "aperture_max"] {
                assert!((found(joint, end)[step] - wanted).abs() < 1e-9 * 1e-5);
            }
        }
        let wanted = 3.0 * traction / 200e9 + 2.0 * traction / 20e9;
        assert!((found("TOP", "displacement_y")[step] - wanted).abs() < 1e-9 * 1e-5);
    }
}

#[test]
fn projects_without_mechanics_are_refused() {
    for (edit, says) in [
        (
            ("SMALL_DEFORMATION_WITH_LIE", "HEAT_CONDUCTION"),
            "HEAT_CONDUCTION",
        ),
        (("<mesh>column.vtu</mesh>", ""), "names no mesh"),
        (("</OpenGeoSysProject>", ""), "not complete"),
    ] {
        let (_, run) = imported_project(&PROJECT.replace(edit.0, edit.1));
        assert_eq!(run.code, Some(2), "{}", run.err);
        assert!(run.err.contains(says), "{says}: {}", run.err);
    }
    let (_, run) = imported_project(&PROJECT.replace("<value>20e9</value>", "<value>x</value>"));
    assert!(
        run.out.contains("`normal_stiffness` is missing"),
        "{}",
        run.out
    );
}

/// What the import of a story said, and the history of its scene.
fn told(story: &Story<'_>, mesh: &str) -> (Run, Rows) {
    let (workshop, run) = project_on([mesh, &story.geometry(), &story.project()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let rows = solved(&workshop);
    (run, rows)
}

fn assert_near(found: f64, wanted: f64, tolerance: f64) {
    assert!(
        (found - wanted).abs() <= tolerance * wanted.abs(),
        "{found:e} instead of {wanted:e}"
    );
}

/// What OpenGeoSys stores has this many digits.
const STORED: f64 = 1e-9;

/// Constants of [`rubbing`] for this ratio of Poisson's.
fn rubbing_constants(nu: &str) -> [[&str; 2]; 11] {
    [
        ["E", "2e18"],
        ["nu", nu],
        ["Kn", "20e9"],
        ["Ks", "20e9"],
        ["phi", "22"],
        ["psi", "10"],
        ["c", "1e3"],
        ["b", "1e-5"],
        ["zero", "0"],
        ["one", "1"],
        ["minus", "-1"],
    ]
}

/// Two squares that nearly nothing deforms, and between them a joint with friction and dilation.
fn rubbing<'a>(constants: &'a [[&'a str; 2]]) -> Story<'a> {
    Story {
        size: [1.0, 2.0],
        law: "<type>Coulomb</type><friction_angle>phi</friction_angle>\
              <dilatancy_angle>psi</dilatancy_angle><cohesion>c</cohesion>\
              <penalty_aperture_cutoff>1e-5</penalty_aperture_cutoff>\
              <tension_cutoff>1</tension_cutoff>",
        fractures: &[7],
        constants,
        curves: &[],
        conditions: &[],
        steps: (8, 0.5),
    }
}

/// `coulomb_load_path`: a joint with friction and dilation between blocks that nearly nothing
/// deforms, closed by 1e-6 m and slid to 1e-5 m and back to -1e-5 m. Blocks of 1e15 Pa instead of
/// 2e18 Pa give way by 2e-4 at most. The closed form, with plastic slips `p`, `q` of both ways:
/// `t = c + tan(phi) s` and `s = K (1e-6 + tan(psi) (p + q))`.
#[test]
fn a_joint_of_opengeosys_slides_and_opens_as_it_does_there() {
    let constants = rubbing_constants("0.3");
    let story = Story {
        curves: &[
            ["slip", "0 1 2 4", "0 0 1e-5 -1e-5", "one"],
            ["closure", "0 1 4", "0 -1e-6 -1e-6", "one"],
        ],
        conditions: &[
            ["displacement", "BOTTOM", "Dirichlet", "0", "zero"],
            ["displacement", "BOTTOM", "Dirichlet", "1", "zero"],
            ["displacement", "TOP", "Dirichlet", "0", "slip"],
            ["displacement", "TOP", "Dirichlet", "1", "closure"],
        ],
        ..rubbing(&constants)
    };
    let (run, rows) = told(&story, GRID);
    assert!(run.out.contains("1e15"), "{}", run.out);
    let (k, c) = (20e9, 1e3);
    let [phi, psi] = [22_f64, 10.0].map(|angle| angle.to_radians().tan());
    let both = k * (1.0 + phi * psi);
    let there = (k * 1e-5 - c - phi * k * 1e-6) / both;
    let back = (k * (1e-5 + there) - c - phi * k * (1e-6 + psi * there)) / both;
    // Slips so far, load step, and the tractions that OpenGeoSys has stored.
    for (slips, step, stored) in [
        (there, 3, [51_425.479_53, 21_777.242_406]),
        (there + back, 7, [110_096.661_47, 45_481.938_612]),
    ] {
        let across = k * (1e-6 + psi * slips);
        let closed = [across, c + phi * across];
        for (column, sign, of) in [
            ("normal_traction_mean", -1.0, 0),
            ("shear_traction_mean", 1.0, 1),
        ] {
            assert_near(closed[of], stored[of], 1e-6);
            assert_near(
                sign * numbers(&rows, "surface-7", column)[step],
                closed[of],
                2e-4,
            );
        }
    }
}

/// `single_joint_displacement_controlled`: a joint with cohesion alone, that rises by 1.1916, gives
/// way in a block that is pressed by 1e-5 m.
#[test]
fn a_joint_with_cohesion_slides_as_in_opengeosys() {
    let story = Story {
        size: [0.05, 0.1],
        law: "<type>Coulomb</type><friction_angle>zero</friction_angle>\
              <dilatancy_angle>zero</dilatancy_angle><cohesion>c</cohesion>\
              <penalty_aperture_cutoff>1e-7</penalty_aperture_cutoff>\
              <tension_cutoff>1</tension_cutoff>",
        fractures: &[7],
        constants: &[
            ["E", "170e6"],
            ["nu", "0.22"],
            ["Kn", "1e12"],
            ["Ks", "1e9"],
            ["c", "2e3"],
            ["b", "1e-5"],
            ["zero", "0"],
            ["push", "-1e-5"],
        ],
        curves: &[["load", "0 1", "0 1", "push"]],
        conditions: &[
            ["displacement", "BOTTOM", "Dirichlet", "1", "zero"],
            ["displacement", "CORNER", "Dirichlet", "0", "zero"],
            ["displacement", "TOP", "Dirichlet", "1", "load"],
        ],
        steps: (10, 0.1),
    };
    let mesh = GRID.replace(
        "0 0 0 1 0 0 1 1 0 0 1 0 1 2 0 0 2 0",
        "0 0 0 0.05 0 0 0.05 0.07979 0 0 0.02021 0 0.05 0.1 0 0 0.1 0",
    );
    let (_, rows) = told(&story, &mesh);
    for (column, stored) in [
        ("normal_traction_mean", -1_678.415_575_7),
        ("shear_traction_mean", 2_000.0),
        ("aperture_mean", 9.998_321_584_5e-6),
        ("slip_mean", 1.008_529_403_1e-5),
    ] {
        assert_near(numbers(&rows, "surface-7", column)[9], stored, STORED);
    }
}

/// `cohesive_zone_load_path`: a joint is torn, released, pressed below the cutoff of its law, and
/// torn off.
#[test]
fn a_cohesive_joint_tears_as_in_opengeosys() {
    let ramp = "0 20 0 -8 0 20 40";
    let story = Story {
        size: [1.0, 2.0],
        law: "<type>CohesiveZoneModeI</type><fracture_toughness>Gc</fracture_toughness>\
              <peak_normal_traction>peak</peak_normal_traction>\
              <penalty_aperture_cutoff>4e-6</penalty_aperture_cutoff>\
              <tension_cutoff>1</tension_cutoff>",
        fractures: &[7],
        constants: &[
            ["E", "1e14"],
            ["nu", "0"],
            ["Kn", "1e12"],
            ["Ks", "1e12"],
            ["Gc", "200"],
            ["peak", "1e7"],
            ["b", "1e-5"],
            ["zero", "0"],
            ["half", "5e-7"],
            ["other", "-5e-7"],
        ],
        curves: &[
            ["top", "0 20 40 50 60 80 100", ramp, "half"],
            ["bottom", "0 20 40 50 60 80 100", ramp, "other"],
        ],
        conditions: &[
            ["displacement", "TOP", "Dirichlet", "1", "top"],
            ["displacement", "BOTTOM", "Dirichlet", "1", "bottom"],
            ["displacement", "RIGHT", "Dirichlet", "0", "zero"],
        ],
        steps: (10, 10.0),
    };
    let (_, rows) = told(&story, GRID);
    let tractions = numbers(&rows, "surface-7", "normal_traction_mean");
    let apertures = numbers(&rows, "surface-7", "aperture_mean");
    for (step, traction, aperture) in [
        (1, 6_711_409.396, 2.986_577_181_2e-5),
        (2, 3_355_704.698, 1.993_288_590_6e-5),
        (4, -19_600_345.458, 2.392_006_909_2e-6),
        (7, 6_711_409.396, 2.986_577_181_2e-5),
    ] {
        assert_near(tractions[step], traction, STORED);
        assert_near(apertures[step], aperture, STORED);
    }
    for (step, aperture) in [(5, 1e-5), (9, 5e-5)] {
        assert_near(apertures[step], aperture, STORED);
        assert!(tractions[step].abs() < STORED * 1e7, "{}", tractions[step]);
    }
}

/// `elastic_push_pull_two_fractures`: pulled and pushed from the right, beside two joints that stay
/// as they are, then from above. Its supports hold displacement and jumps apart, those of a scene
/// both walls.
#[test]
fn two_joints_are_pushed_and_pulled_as_in_opengeosys() {
    let times = "0 1  3 4 5  7 8 9 10";
    let story = Story {
        size: [1.0, 3.0],
        law: "<type>LinearElasticIsotropic</type>\
              <penalty_aperture_cutoff>1e-5</penalty_aperture_cutoff>\
              <tension_cutoff>0</tension_cutoff>",
        fractures: &[0, 1],
        constants: &[
            ["E", "200e9"],
            ["nu", "0"],
            ["Kn", "20e9"],
            ["Ks", "20e9"],
            ["b", "1e-5"],
            ["zero", "0"],
            ["force", "1e5"],
        ],
        curves: &[
            ["right", times, "0 1 -1 0 0  0 0 1 0", "force"],
            ["top", times, "0 0  0 0 1 -1 0 1 0", "force"],
        ],
        conditions: &[
            ["displacement", "LEFT", "Dirichlet", "0", "zero"],
            ["displacement", "BOTTOM", "Dirichlet", "1", "zero"],
            ["displacement", "RIGHT", "Neumann", "0", "right"],
            ["displacement", "TOP", "Neumann", "1", "top"],
            ["displacement_jump1", "END", "Dirichlet", "0", "zero"],
        ],
        steps: (5, 1.0),
    };
    let (run, rows) = told(&story, COLUMN);
    assert!(run.out.contains("the jump at `END`"), "{}", run.out);
    // OpenGeoSys has stored its results up to a time of 3.
    for (step, stored) in [(0, 5e-7), (2, -5e-7)] {
        assert_near(
            numbers(&rows, "RIGHT", "displacement_x")[step],
            stored,
            STORED,
        );
        for joint in ["surface-0", "surface-1"] {
            assert_near(numbers(&rows, joint, "aperture_mean")[step], 1e-5, STORED);
        }
    }
    let pulled = 3.0 * 1e5 / 200e9 + 2.0 * 1e5 / 20e9;
    assert_near(numbers(&rows, "TOP", "displacement_y")[4], pulled, STORED);
}

/// `mohr_coulomb_load_path_nu0p3`: pure shear of 20 kPa and then -30 kPa on a joint that is closed
/// by 1e-6 m. It slides both ways, so the traction across follows from the cohesion of 1 kPa.
#[test]
fn a_joint_under_shear_tractions_slides_both_ways() {
    let times = "0 1 2 4 10";
    let constants = rubbing_constants("0");
    let story = Story {
        curves: &[
            ["closure", "0 1 10", "0 -1e-6 -1e-6", "one"],
            ["shear", times, "0 0 20e3 -30e3 -30e3", "one"],
            ["against", times, "0 0 20e3 -30e3 -30e3", "minus"],
        ],
        conditions: &[
            ["displacement", "LEFT", "Neumann", "1", "against"],
            ["displacement", "RIGHT", "Neumann", "1", "shear"],
            ["displacement", "TOP", "Neumann", "0", "shear"],
            ["displacement", "TOP", "Dirichlet", "1", "closure"],
            ["displacement", "BOTTOM", "Dirichlet", "0", "zero"],
            ["displacement", "BOTTOM", "Dirichlet", "1", "zero"],
        ],
        ..rubbing(&constants)
    };
    let (_, rows) = told(&story, GRID);
    let across = numbers(&rows, "surface-7", "normal_traction_mean");
    let along = numbers(&rows, "surface-7", "shear_traction_mean");
    for (step, shear) in [(3, 20e3), (7, 30e3)] {
        assert_near(along[step], shear, 1e-7);
        assert_near(
            across[step],
            (1e3 - shear) / 22_f64.to_radians().tan(),
            1e-7,
        );
    }
}
