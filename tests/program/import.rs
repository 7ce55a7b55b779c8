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
pub const GRID: &str = r#"<?xml version="1.0"?>
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

fn imported(name: &str, text: impl AsRef<[u8]>) -> (Workshop, Run) {
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
fn joint_carries_the_load(name: &str, text: impl AsRef<[u8]>, fracture: &str) {
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

/// The joint as gmsh writes a physical surface: in a set of its own, and in that of the surface of
/// the geometry.
#[test]
fn a_fracture_that_gmsh_names_twice_is_one() {
    let text = CUBES
        .replace("2, 15, 16, 17, 18,", "2, 5, 6, 7, 8,")
        .replace(
            "TYPE=COH3D8, ELSET=joint\n3, 5, 6, 7, 8, 15, 16, 17, 18",
            "TYPE=CPS4, ELSET=Surface13\n3, 5, 6, 7, 8\n*ELSET,ELSET=fault\n3, ",
        );
    joint_carries_the_load("gmsh.inp", &text, "fault");
    let (workshop, run) = imported("gmsh.inp", &text);
    let said = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("`Surface13` (`fault`)"), "{said}");
    let scene = fs::read_to_string(workshop.path("made/scene.toml")).expect("a scene");
    assert_eq!(scene.matches("[fracture.").count(), 1, "{scene}");
}

/// A range that no memory holds, and sets named in another case than where they are defined.
#[test]
fn ranges_and_names_of_sets_are_those_of_abaqus() {
    let text = CUBES
        .replace(
            "*STEP",
            "*ELSET, ELSET=all, GENERATE\n1,18446744073709551615\n*STEP",
        )
        .replace(
            "*SURFACE, NAME=lid\n2,",
            "*ELSET, ELSET=Upper\n2\n*SURFACE, NAME=lid\nUPPER,",
        );
    joint_carries_the_load("cubes.inp", &text, "joint");
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
        ("mesh.med", "", "meshio convert"),
        ("grid.vtu", "<VTKFile", "VTK reader understands: it is cut"),
        ("grid.vtu", "words", "VTK reader understands: it has no"),
        ("grid.vtu", "words", "ParaView or meshio"),
        (
            "grid.vtu",
            &GRID.replace("0 0 0 1 0 0", "0 0 nan 1 0 0"),
            "finite numbers: 0",
        ),
        ("grid.vtu", &GRID.replace("9 9 3", "9 9 7"), "types 7"),
        ("a.inp", "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n", "not there"),
        ("a.inp", "no mesh", "it has no cells and no surfaces"),
        (
            "a.inp",
            &format!("{CUBES}*ELSET, ELSET=all, GENERATE\n1\n"),
            "`1` is no range of elements",
        ),
        (
            "a.inp",
            &CUBES.replace("2, S2", "rocks, S2"),
            "did you mean `rock`?",
        ),
    ] {
        let (_, run) = imported(name, text);
        assert_eq!(run.code, Some(2), "{}", run.err);
        let said = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(says), "{says}: {said}");
    }
}

/// The grid of the plane with its materials as GEOS has them, beside arrays that are no numbers of
/// materials.
#[test]
fn a_grid_with_the_attribute_of_geos_runs() {
    let geos = GRID.replace("Name=\"MaterialIDs\"", "Name=\"attribute\"");
    joint_carries_the_load("grid.vtu", &geos, "surface-7");
    // Floating-point numbers, as some writers have them.
    let geos = geos.replace(
        "\"Int32\" Name=\"attribute\"",
        "\"Float64\" Name=\"attribute\"",
    );
    joint_carries_the_load(
        "grid.vtu",
        geos.replace("0 1 7<", "0.0 1.0 7.0<"),
        "surface-7",
    );
}

/// Writes two cubes with a square between as the blocks 10, 20 and 7 of an Exodus file.
const EXODUS: &str = r#"
import sys
from vtkmodules.vtkCommonCore import vtkIntArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkIOExodus import vtkExodusIIWriter
points, blocks, grid = vtkPoints(), vtkIntArray(), vtkUnstructuredGrid()
for z in range(3):
    for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)):
        points.InsertNextPoint(x, y, z)
grid.SetPoints(points)
blocks.SetName("ObjectId")
for kind, nodes, block in ((12, range(8), 10), (12, range(4, 12), 20), (9, range(4, 8), 7)):
    grid.InsertNextCell(kind, len(nodes), list(nodes))
    blocks.InsertNextValue(block)
grid.GetCellData().AddArray(blocks)
writer = vtkExodusIIWriter()
writer.SetFileName(sys.argv[1])
writer.SetInputData(grid)
writer.Write()
"#;

#[test]
fn an_exodus_mesh_runs() {
    let folder = Workshop::of("");
    let file = folder.path("cubes.e");
    let python = crate::read_back::python();
    let written = std::process::Command::new(python)
        .args(["-c".as_ref(), EXODUS.as_ref(), file.as_os_str()])
        .status();
    assert!(written.expect("Python starts").success());
    let mesh = fs::read(&file).expect("the mesh");
    joint_carries_the_load("cubes.e", &mesh, "surface-7");
}

/// Two cubes of the blocks 10 and 20 with side sets of these numbers: the faces between, below and
/// above. Where numbers are shared with blocks, side sets come behind.
#[test]
fn side_sets_of_an_exodus_mesh_are_fractures_and_boundaries() {
    for (numbers, between) in [("7,8,9", "surface-7"), ("10,20,30", "surface-30")] {
        let folder = Workshop::of("");
        let file = folder.path("cubes.e");
        let written = std::process::Command::new(crate::read_back::python())
            .args(["-c", include_str!("exodus_sides.py")])
            .arg(&file)
            .arg(numbers)
            .status();
        assert!(written.expect("Python starts").success());
        let mesh = fs::read(&file).expect("the mesh");
        joint_carries_the_load("cubes.e", &mesh, between);
        let (workshop, _) = imported("cubes.e", &mesh);
        let scene = fs::read_to_string(workshop.path("made/scene.toml")).expect("a scene");
        assert_eq!(scene.matches("[fracture.").count(), 1, "{scene}");
        assert!(scene.contains("Surfaces on the outside, free"), "{scene}");
    }
}

#[test]
fn exodus_without_a_python_with_vtk_says_what_to_install() {
    let folder = Workshop::of("");
    let file = folder.path("cubes.e");
    fs::write(&file, "no mesh").expect("written");
    let with = |python: &str| {
        let run = crate::harness::command(crate::harness::KLUFT)
            .args(["import".as_ref(), file.as_os_str(), "-o".as_ref()])
            .arg(folder.path("made"))
            .env("KLUFT_PYTHON", python)
            .output()
            .expect("the program starts");
        assert_eq!(run.status.code(), Some(2));
        let said = String::from_utf8_lossy(&run.stderr);
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let nowhere = with("/nowhere/python");
    for part in ["/nowhere/python", "sh scripts/setup", "KLUFT_PYTHON"] {
        assert!(nowhere.contains(part), "{part}: {nowhere}");
    }
    let python = crate::read_back::python();
    let broken = with(&python.to_string_lossy());
    assert!(broken.contains("it is no Exodus file"), "{broken}");
}

/// The first fractures of the network of small features in PorePy's benchmarks, and a polygon as
/// dfnWorks writes it: the domain is that of the list.
#[test]
fn lists_of_other_programs_become_networks() {
    let porepy = "0,0,0,1,2.25,1\n\
        0.05,0.25,0.5,0.95,0.25,0.5,0.95,2,0.5,0.05,2,0.5\n\
        0.5,0.05,0.95,0.5,0.05,0.05,0.5,0.3,0.05,0.5,0.3,0.95\n";
    let dfnworks = "nPolygons: 1\n4 {0, 0, 1} {2, 0, 1} {2, 1, 1} {0, 1, 1} \n";
    let rectangles = "nUserRect: 2 \n \nRadii: \n0.6 \n1.0 \n\nAspect_Ratio: \n1 \n0.65 \n\n\
        Beta: \n0 \n0 \n\nAngleOption: \ndegree \ndegree \n\nTranslation: \n[-0.4, 0, 0] \n\
        [0, 0, 0] \n\nuserOrientationOption: 0 \n \nNormal: \n[0, 0, 1] \n[1, 0, 0] \n";
    for (name, text, areas) in [
        ("rectangles.dat", rectangles, &[1.44, 2.6][..]),
        ("network.csv", porepy, &[0.9 * 1.75, 0.25 * 0.9]),
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
