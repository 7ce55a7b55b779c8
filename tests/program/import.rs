//! Meshes of other programs, imported, inspected and solved.

use std::fs;

use crate::harness::{Run, Workshop, kluft, summary};

/// Two cubes on one another with a cohesive element between.
const CUBES: &str = "\
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
15, 0, 0, 1
16, 1, 0, 1
17, 1, 1, 1
18, 0, 1, 1
21, 0, 0, 2
22, 1, 0, 2
23, 1, 1, 2
24, 0, 1, 2
*ELEMENT, TYPE=C3D8, ELSET=rock
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 15, 16, 17, 18, 21, 22, 23, 24
*ELEMENT, TYPE=COH3D8, ELSET=joint
3, 5, 6, 7, 8, 15, 16, 17, 18
*SURFACE, NAME=lid
2, S2
*STEP
";

/// Squares below and above a line, numbered as materials 0 and 1, the line 7.
const GRID: &str = r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="6" NumberOfCells="3">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 1 1 0 0 1 0 1 2 0 0 2 0
</DataArray></Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 3 2 4 5 3 2</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4 8 10</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9 9 3</DataArray>
</Cells>
<CellData>
<DataArray type="Int32" Name="MaterialIDs" format="ascii">0 1 7</DataArray>
<DataArray type="Float64" Name="porosity" format="ascii">0.1 0.1 0.1</DataArray>
</CellData>
</Piece></UnstructuredGrid>
</VTKFile>
"#;

fn imported(name: &str, text: &str) -> (Workshop, Run) {
    let workshop = Workshop::of("");
    fs::remove_file(workshop.scene()).expect("removed");
    let input = workshop.path(name);
    fs::write(&input, text).expect("written");
    let out = workshop.path("made");
    let flags = ["-v".as_ref(), "-o".as_ref(), out.as_os_str()];
    let run = kluft(&[&["import".as_ref(), input.as_os_str()], &flags[..]].concat());
    (workshop, run)
}

/// Under 10 MPa from above the joint carries 10 MPa: with `x = b/b0`, `(1 + ln^2 x)(1 - x)` is 0.5.
fn joint_carries_the_load(name: &str, text: &str, fracture: &str) {
    let (workshop, run) = imported(name, text);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let scene = workshop.path("made/scene.toml");
    let solved = kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!(solved.code, Some(0), "{}", solved.err);
    let found = summary(&workshop.path("made/out"));
    let joint = &found["fractures"][fracture];
    let traction = joint["normal_traction"]["mean"]
        .as_f64()
        .expect("a traction");
    assert!((traction / -1e7 - 1.0).abs() < 1e-9, "{traction}");
    let aperture = joint["aperture"]["mean"].as_f64().expect("an aperture");
    assert!(
        (aperture / 6.022_627_52e-4 - 1.0).abs() < 1e-8,
        "{aperture:e}"
    );
}

#[test]
fn an_abaqus_file_with_cohesive_elements_runs() {
    joint_carries_the_load("cubes.inp", CUBES, "joint");
}

#[test]
fn a_grid_of_the_plane_with_materials_runs() {
    joint_carries_the_load("grid.vtu", GRID, "surface-7");
}

#[test]
fn what_is_not_taken_over_is_named_and_what_cannot_be_read_is_refused() {
    let (_, run) = imported("cubes.inp", CUBES);
    assert!(
        run.out.contains("STEP") && run.out.contains("cohesive"),
        "{}",
        run.out
    );
    let (_, run) = imported("grid.vtu", GRID);
    assert!(run.out.contains("porosity"), "{}", run.out);
    for (name, text, says) in [
        ("mesh.e", "", "meshio convert"),
        ("grid.vtu", "<VTKFile", "cannot be read"),
        ("grid.vtu", &GRID.replace("9 9 3", "9 9 7"), "types 7"),
        ("a.inp", "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n", "not there"),
    ] {
        let (_, run) = imported(name, text);
        assert_eq!(run.code, Some(2), "{}", run.err);
        let said = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(says), "{says}: {said}");
    }
}

/// The first fractures of the network of small features in PorePy's benchmarks, and a polygon as
/// dfnWorks writes it: the domain is that of the list.
#[test]
fn lists_of_other_programs_become_networks() {
    let porepy = "0,0,0,1,2.25,1\n\
        0.05,0.25,0.5,0.95,0.25,0.5,0.95,2,0.5,0.05,2,0.5\n\
        0.5,0.05,0.95,0.5,0.05,0.05,0.5,0.3,0.05,0.5,0.3,0.95\n";
    let dfnworks = "nPolygons: 1\n4 {0, 0, 1} {2, 0, 1} {2, 1, 1} {0, 1, 1} \n";
    for (name, text, areas) in [
        ("network.csv", porepy, &[0.9 * 1.75, 0.25 * 0.9][..]),
        ("polygons.dat", dfnworks, &[2.0]),
    ] {
        let workshop = Workshop::of("");
        let (input, out) = (workshop.path(name), workshop.path("made"));
        fs::write(&input, text).expect("written");
        let run = kluft(&[
            "network".as_ref(),
            input.as_os_str(),
            "-v".as_ref(),
            "--keep-small".as_ref(),
            "-o".as_ref(),
            out.as_os_str(),
        ]);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert!(run.out.contains("a list of"), "{}", run.out);
        let record = fs::read_to_string(out.join("network.json")).expect("a record");
        let record: serde_json::Value = serde_json::from_str(&record).expect("JSON");
        let fractures = record["fractures"].as_array().expect("fractures");
        let found: Vec<f64> = fractures
            .iter()
            .map(|fracture| fracture["area"].as_f64().expect("an area"))
            .collect();
        assert_eq!(found.len(), areas.len());
        for (found, area) in found.iter().zip(areas) {
            assert!((found / area - 1.0).abs() < 1e-9, "{found} {area}");
        }
    }
}

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
    let workshop = Workshop::of("");
    fs::remove_file(workshop.scene()).expect("removed");
    for (name, text) in [
        ("column.vtu", mesh),
        ("column.gml", geometry),
        ("column.prj", project),
    ] {
        fs::write(workshop.path(name), text).expect("written");
    }
    let run = kluft(&[
        "import".as_ref(),
        workshop.path("column.prj").as_os_str(),
        "-o".as_ref(),
        workshop.path("made").as_os_str(),
        "-v".as_ref(),
    ]);
    (workshop, run)
}

type Rows = Vec<std::collections::BTreeMap<String, String>>;

/// Runs the scene that was made; its history.
fn solved(workshop: &Workshop) -> Rows {
    let scene = workshop.path("made/scene.toml");
    let run = kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let history = fs::read_to_string(workshop.path("made/out/history.csv")).expect("a history");
    let mut table = csv::Reader::from_reader(history.as_bytes());
    table.deserialize().map(|row| row.expect("a row")).collect()
}

fn numbers(rows: &Rows, name: &str, column: &str) -> Vec<f64> {
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

/// A joint with friction and dilation between blocks that nearly nothing deforms, closed by 1e-6 m
/// and slid to 1e-5 m and back to -1e-5 m.
fn sheared() -> String {
    let condition = |place: &str, axis: usize, parameter: &str| {
        format!(
            "<boundary_condition><geometry>{place}</geometry><type>Dirichlet</type>\
             <component>{axis}</component><parameter>{parameter}</parameter></boundary_condition>"
        )
    };
    let conditions = [
        condition("BOTTOM", 0, "zero"),
        condition("BOTTOM", 1, "zero"),
        condition("TOP", 0, "slip"),
        condition("TOP", 1, "closure"),
    ];
    let parameter = |name: &str, value: &str| {
        format!(
            "<parameter><name>{name}</name><type>Constant</type><value>{value}</value></parameter>"
        )
    };
    let scaled = |name: &str| {
        format!(
            "<parameter><name>{name}</name><type>CurveScaled</type><curve>{name}</curve>\
             <parameter>one</parameter></parameter>"
        )
    };
    let constants = [
        [("E", "2e18"), ("nu", "0.3"), ("K", "20e9")],
        [("phi", "22"), ("psi", "10"), ("c", "1e3")],
        [("b", "1e-5"), ("zero", "0"), ("one", "1")],
    ];
    let constants = constants.as_flattened().iter();
    let constants: String = constants
        .map(|(name, value)| parameter(name, value))
        .collect();
    let end = PROJECT.find("<time_loop>").expect("steps");
    let begin = PROJECT.find("</processes>").expect("an end");
    let law = PROJECT.find("<fracture_model>").expect("a law");
    format!(
        "{}<fracture_model><type>Coulomb</type><normal_stiffness>K</normal_stiffness>\
         <shear_stiffness>K</shear_stiffness><friction_angle>phi</friction_angle>\
         <dilatancy_angle>psi</dilatancy_angle><cohesion>c</cohesion>\
         <penalty_aperture_cutoff>1e-5</penalty_aperture_cutoff><tension_cutoff>1</tension_cutoff>\
         </fracture_model><fracture_properties><material_id>7</material_id>\
         <initial_aperture>b</initial_aperture></fracture_properties></process>{}\
         <time_loop><processes><process><time_stepping><type>FixedTimeStepping</type>\
         <t_initial>0</t_initial><t_end>4</t_end><timesteps><pair><repeat>8</repeat>\
         <delta_t>0.5</delta_t></pair></timesteps></time_stepping></process></processes></time_loop>\
         <parameters>{}{}{}</parameters><curves>\
         <curve><name>slip</name><coords>0 1 2 4</coords><values>0 0 1e-5 -1e-5</values></curve>\
         <curve><name>closure</name><coords>0 1 4</coords><values>0 -1e-6 -1e-6</values></curve>\
         </curves><process_variables><process_variable><name>displacement</name>\
         <boundary_conditions>{}</boundary_conditions></process_variable></process_variables>\
         </OpenGeoSysProject>",
        &PROJECT[..law],
        &PROJECT[begin..end],
        constants,
        scaled("slip"),
        scaled("closure"),
        conditions.concat(),
    )
}

/// With plastic slips `p`, `q` of both ways, `t = c + tan(phi) s` and `s = K (1e-6 + tan(psi) (p +
/// q))`. OpenGeoSys has stored 110096.66 and 45481.94 Pa for its test `coulomb_load_path`, of which
/// this is the path. Blocks of 1e15 Pa instead of 2e18 Pa give way by 2e-4 at most.
#[test]
fn a_joint_of_opengeosys_slides_and_opens_as_it_does_there() {
    let geometry = GEOMETRY.replace("y=\"3\"", "y=\"2\"");
    let (workshop, run) = project_on([GRID, &geometry, &sheared()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("1e15"), "{}", run.out);
    let rows = solved(&workshop);
    let last = |column: &str| *numbers(&rows, "surface-7", column).last().expect("a row");
    let (k, c) = (20e9, 1e3);
    let [phi, psi] = [22_f64, 10.0].map(|angle| angle.to_radians().tan());
    let both = k * (1.0 + phi * psi);
    let there = (k * 1e-5 - c - phi * k * 1e-6) / both;
    let back = (k * (1e-5 + there) - c - phi * k * (1e-6 + psi * there)) / both;
    let across = k * (1e-6 + psi * (there + back));
    for (wanted, stored) in [(across, 110_096.66), (c + phi * across, 45_481.94)] {
        assert!(
            (wanted / stored - 1.0_f64).abs() < 1e-4,
            "{wanted} {stored}"
        );
    }
    for (found, wanted) in [
        (-last("normal_traction_mean"), across),
        (last("shear_traction_mean"), c + phi * across),
    ] {
        assert!((found / wanted - 1.0).abs() < 2e-4, "{found} {wanted}");
    }
}
