//! Reads results with VTK, which shares no code with the program.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::harness::root;

const SET_UP: &str = "these tests read results with VTK: run `sh scripts/setup` once, or let \
                      KLUFT_PYTHON name a Python with the packages vtk==9.7.2 and numpy";

/// The Python that has VTK.
pub fn python() -> PathBuf {
    let named = std::env::var_os("KLUFT_PYTHON").filter(|python| !python.is_empty());
    let python = named.map_or_else(|| root().join("target/venv/bin/python"), PathBuf::from);
    let has_vtk = Command::new(&python)
        .args(["-c", "import vtkmodules, numpy"])
        .output();
    let has_vtk = has_vtk.is_ok_and(|output| output.status.success());
    assert!(has_vtk, "{} has no VTK; {SET_UP}", python.display());
    python
}

/// What `tests/read_back.py` finds in a folder of results, or in a single grid.
pub fn read_back(folder: &Path) -> Value {
    let script = root().join("tests/read_back.py");
    let output = Command::new(python())
        .arg(script)
        .arg(folder)
        .output()
        .expect("Python starts");
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {complaint}", folder.display());
    serde_json::from_slice(&output.stdout).expect("the answer is JSON")
}
