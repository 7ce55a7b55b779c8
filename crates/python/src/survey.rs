//! What a mesh is like, for tables.

use kluft_mesh::{Contact, Draft, Faces, FractureSurvey, Mesh, SurfaceRole, Survey};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::sound;

/// Surveys a mesh; surfaces of these names are fractures, or all inner ones.
pub fn survey<'py>(
    py: Python<'py>,
    draft: Draft,
    fractures: Option<&[String]>,
) -> PyResult<Bound<'py, PyDict>> {
    let surveyed = py.detach(|| {
        let faces = Faces::of(&draft);
        let mut roles = faces.guessed_roles(&draft);
        if let Some(names) = fractures {
            for (role, group) in roles.iter_mut().zip(&draft.groups) {
                let is_fracture = group.dimension == 2 && names.contains(&group.name);
                *role = match is_fracture {
                    true => SurfaceRole::Fracture,
                    false if *role == SurfaceRole::Fracture => SurfaceRole::Unused,
                    false => *role,
                };
            }
        }
        let mesh = Mesh::build_on(draft, faces, &roles)?;
        let survey = Survey::of(&mesh);
        Ok((mesh, survey))
    });
    let (mesh, survey) = sound(py, surveyed)?;
    let tables = PyDict::new(py);
    let rows = mesh.fractures.iter().zip(&survey.fractures);
    let rows = rows.map(|(name, found)| fracture(py, name, found));
    tables.set_item("fractures", rows.collect::<PyResult<Vec<_>>>()?)?;
    let rows = survey.contacts.iter();
    let rows = rows.map(|found| contact(py, &mesh, found));
    tables.set_item("contacts", rows.collect::<PyResult<Vec<_>>>()?)?;
    let rows = survey.blocks.iter().map(|block| {
        let row = PyDict::new(py);
        row.set_item("cells", block.cells)?;
        row.set_item("volume", block.volume)?;
        Ok(row)
    });
    tables.set_item("blocks", rows.collect::<PyResult<Vec<_>>>()?)?;
    let quality = &survey.quality.of_cell;
    let sum: f64 = quality.iter().sum();
    tables.set_item("mean_quality", sum / quality.len() as f64)?;
    let worst = quality.iter().copied().fold(1.0, f64::min);
    tables.set_item("worst_quality", worst)?;
    Ok(tables)
}

fn fracture<'py>(
    py: Python<'py>,
    name: &str,
    found: &FractureSurvey,
) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    // A closed surface has no mean orientation.
    let open = |value: f64| (!found.closed).then_some(value);
    row.set_item("fracture", name)?;
    row.set_item("facets", found.facets)?;
    row.set_item("area", found.area)?;
    row.set_item("dip", open(found.orientation.dip))?;
    row.set_item("dip_direction", open(found.orientation.dip_direction))?;
    row.set_item("deviation", open(found.orientation.deviation))?;
    row.set_item("components", found.components)?;
    row.set_item("tip_length", found.tip_length)?;
    row.set_item("trace_length", found.trace_length)?;
    row.set_item("branching_length", found.branching_length)?;
    Ok(row)
}

fn contact<'py>(py: Python<'py>, mesh: &Mesh, found: &Contact) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    let [first, second] = found.fractures.map(|index| &mesh.fractures[index as usize]);
    row.set_item("first", first)?;
    row.set_item("second", second)?;
    row.set_item("crossing_length", found.crossing_length)?;
    row.set_item("first_ends_length", found.ending_length[0])?;
    row.set_item("second_ends_length", found.ending_length[1])?;
    row.set_item("rim_length", found.rim_length)?;
    row.set_item("smallest_angle", found.smallest_angle)?;
    Ok(row)
}
