//! Scenes.

use std::path::PathBuf;

use kluft_scene::in_terms_of_scene;
use kluft_solver::Discretisation;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::sound;
use crate::mesh::Mesh;

/// A scene that has been read without a defect.
#[pyclass(frozen)]
pub struct Scene {
    /// What it says.
    pub scene: kluft_scene::Scene,
}

#[pymethods]
impl Scene {
    /// Reads a text; `name` is for messages, `folder` is where its paths start.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, name: &str, folder: PathBuf) -> PyResult<Self> {
        let scene = kluft_scene::Scene::parse(text, name, &folder);
        Ok(Self {
            scene: sound(py, scene)?,
        })
    }

    /// The text of a scene file.
    #[staticmethod]
    fn text(py: Python<'_>, file: PathBuf) -> PyResult<String> {
        sound(py, kluft_scene::Scene::text(&file))
    }

    /// What is possible but hardly meant of the scene on a mesh.
    fn check(&self, py: Python<'_>, mesh: Py<Mesh>) -> PyResult<Vec<String>> {
        let draft = mesh.get().draft.clone();
        let binding = py.detach(|| {
            let problem = self.scene.problem(draft)?;
            let discretised = Discretisation::of(&problem.problem).map(drop);
            discretised.map_err(in_terms_of_scene)?;
            Ok(problem.warnings)
        });
        sound(py, binding)
    }

    /// Values that are possible but hardly meant.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.clone()
    }
}

/// The nested tables of a TOML text; none if it is no TOML.
#[pyfunction]
pub fn tables_of(py: Python<'_>, text: &str) -> PyResult<Option<Py<PyAny>>> {
    let Ok(tables) = text.parse::<toml::Table>() else {
        return Ok(None);
    };
    let json = serde_json::to_string(&tables);
    let json = json.map_err(|error| PyValueError::new_err(error.to_string()))?;
    let tables = py.import("json")?.call_method1("loads", (json,))?;
    Ok(Some(tables.unbind()))
}

/// The TOML of nested tables that are given as JSON.
#[pyfunction]
pub fn toml_of(json: &str) -> PyResult<String> {
    let wrong = |error: &dyn std::fmt::Display| PyValueError::new_err(error.to_string());
    let tables: toml::Table = serde_json::from_str(json).map_err(|error| wrong(&error))?;
    toml::to_string(&tables).map_err(|error| wrong(&error))
}
