//! Defects and failures as the exceptions of the package.

use kluft_mesh::Defect;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// The module of the package that defines the exceptions.
const MODULE: &str = "kluft.errors";

/// `kluft.InputError` with every defect.
pub fn input_error(py: Python<'_>, defects: Vec<Defect>) -> PyErr {
    let defects = defects.into_iter();
    let parts: Vec<_> = defects
        .map(|defect| (defect.place, defect.problem, defect.remedy))
        .collect();
    raised(py, "InputError", (parts,))
}

/// An exception of the package; what goes wrong on the way to it is raised instead.
pub fn raised<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyErr {
    let made = py.import(MODULE).and_then(|module| {
        let arguments = arguments.into_pyobject(py)?;
        module.getattr(name)?.call1(arguments)
    });
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// A result whose defects become an exception.
pub fn sound<T>(py: Python<'_>, result: Result<T, Vec<Defect>>) -> PyResult<T> {
    result.map_err(|defects| input_error(py, defects))
}
