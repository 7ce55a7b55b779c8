//! gmsh played by scripts that behave as it does, well or badly.

use std::path::PathBuf;

use super::*;

const BOX: &str = "SetFactory(\"OpenCASCADE\");\nDefineConstant[ h = 1 ];\nBox(1) = {0, 0, 0, 1, 1, 1};\n\
    MeshSize{:} = h;\n";

/// A folder of its own, with the geometry in it; removed in the end.
struct Scene {
    folder: PathBuf,
}

impl Scene {
    fn new(name: &str, geometry: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("kluft-gmsh-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a temporary folder");
        fs::write(folder.join("in.geo"), geometry).expect("written");
        Self { folder }
    }

    fn mesh(
        &self,
        program: &str,
        parameters: &[(String, f64)],
    ) -> Result<Vec<String>, Vec<Defect>> {
        let gmsh = Gmsh {
            program: program.into(),
        };
        let meshing = Meshing {
            geometry: &self.folder.join("in.geo"),
            parameters,
            order: 1,
            sizes: None,
            output: &self.folder.join("out put.msh"),
        };
        mesh_with(&gmsh, &meshing)
    }

    fn fails_with(&self, problem: &str) {
        let defects = self.mesh("gmsh", &[]).expect_err(problem);
        assert!(
            defects.iter().any(|d| d.to_string().contains(problem)),
            "{defects:?}"
        );
        assert_eq!(
            fs::read_dir(&self.folder).expect("there").count(),
            1,
            "nothing is left behind"
        );
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

#[test]
fn a_parameter_changes_the_mesh() {
    let scene = Scene::new("parameter", BOX);
    let size = |h: f64| {
        let warnings = scene.mesh("gmsh", &[("h".to_owned(), h)]).expect("a mesh");
        assert_eq!(warnings, Vec::<String>::new());
        fs::metadata(scene.folder.join("out put.msh"))
            .expect("written")
            .len()
    };
    assert!(size(0.3) > 2 * size(1.0));
}

#[test]
fn warnings_are_handed_on() {
    let scene = Scene::new("warning", &format!("{BOX}Warning(\"look here\");\n"));
    assert_eq!(scene.mesh("gmsh", &[]), Ok(vec!["look here".to_owned()]));
}

#[test]
fn errors_name_the_line() {
    Scene::new("syntax", &format!("{BOX}Bxo(3) = {{1}};\n"))
        .fails_with("in.geo, line 5: gmsh: syntax");
    Scene::new("variable", &format!("{BOX}k = nix;\n"))
        .fails_with("line 5: gmsh: Unknown variable");
}

#[test]
fn a_run_without_volume_elements_fails() {
    Scene::new("empty", "x = 1;\n").fails_with("no volume elements");
    let surface_only = format!("{BOX}Physical Surface(1) = {{1}};\n");
    Scene::new("surface", &surface_only).fails_with("no volume elements");
    Scene::new("exit", &format!("{BOX}Exit;\n")).fails_with("wrote no mesh");
}

#[test]
fn a_missing_program_is_named_with_its_remedy() {
    let defects = Scene::new("missing", BOX)
        .mesh("no-such-gmsh", &[])
        .expect_err("not there");
    let text = defects[0].to_string();
    assert!(
        text.contains("apt-get install gmsh") && text.contains("KLUFT_GMSH"),
        "{text}"
    );
}

#[test]
fn a_program_that_fails_silently_is_noticed() {
    let defects = Scene::new("false", BOX)
        .mesh("false", &[])
        .expect_err("fails");
    assert!(
        defects[0].problem.contains("without an error message"),
        "{defects:?}"
    );
}

#[test]
fn a_missing_geometry_and_a_wrong_order_are_defects() {
    let scene = Scene::new("order", BOX);
    let fails = |geometry: &Path, order| {
        let meshing = Meshing {
            geometry,
            parameters: &[],
            order,
            sizes: None,
            output: Path::new("out.msh"),
        };
        mesh_geometry(&meshing).is_err()
    };
    assert!(fails(&scene.folder.join("in.geo"), 3));
    assert!(fails(&scene.folder.join("nix.geo"), 1));
    assert!(fails(&scene.folder, 1));
}
