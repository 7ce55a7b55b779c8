//! The six junctions that random materials fill: gmsh geometries, each meshed once.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use kluft_io::Dimension;
use kluft_mesh::Draft;
use tempfile::TempDir;

use super::asked::bytes_of;
use crate::root;
use crate::scenes::meshed_file;

/// A junction.
pub struct Junction {
    /// Name of its geometry.
    pub name: &'static str,
    /// Its fractures.
    pub fractures: &'static [&'static str],
    /// Where it stands, if not in `geometries/`: the beginning, before the faces of the cube.
    script: Option<&'static str>,
}

/// How a junction is meshed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fineness {
    /// Large cells of order 1.
    Coarse,
    /// Larger cells of order 2.
    Quadratic,
    /// Cells of order 1 so small that the iterative solver is the cheapest.
    Fine,
}

/// Every junction.
pub const JUNCTIONS: [Junction; 6] = [
    junction("wedge", &["f", "g"], Some(WEDGE)),
    junction("x-junction", &["east", "north"], None),
    junction("t-junction", &["through", "abutting"], None),
    junction("nest", &["f"], Some(NEST)),
    junction("corner", &["f", "g"], Some(CORNER)),
    junction("three-planes", &["x_plane", "y_plane", "z_plane"], None),
];

const fn junction(
    name: &'static str,
    fractures: &'static [&'static str],
    script: Option<&'static str>,
) -> Junction {
    Junction {
        name,
        fractures,
        script,
    }
}

/// Two planes that cross at 5 degrees.
const WEDGE: &str = r#"t = 0.5 * Tan(5 * Pi / 180); Rectangle(1) = {0, 0, 0, 1, 1};
Point(101) = {0, 0.5, 0}; Point(102) = {1, 0.5, 0};
Point(103) = {0, 0.5 - t, 0}; Point(104) = {1, 0.5 + t, 0};
Line(101) = {101, 102}; Line(102) = {103, 104};
BooleanFragments{ Surface{1}; Delete; }{ Line{101, 102}; Delete; }
Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Surface{:}; }
Extrude {0, 1, 0} { Surface{:}; Layers{Ceil(1.6 / h)}; }
Coherence;
f() = Surface In BoundingBox{-e, -e, 0.5 - e, 1 + e, 1 + e, 0.5 + e};
g() = Surface In BoundingBox{-e, -e, 0.5 - t - e, 0.5 + e, 1 + e, 0.5 + e};
g() += Surface In BoundingBox{0.5 - e, -e, 0.5 - e, 1 + e, 1 + e, 0.5 + t + e};
"#;

/// A cube in a cube.
const NEST: &str = r#"Box(1) = {0, 0, 0, 1, 1, 1}; Box(2) = {0.2, 0.2, 0.2, 0.6, 0.6, 0.6};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
f() = Surface In BoundingBox{0.2 - e, 0.2 - e, 0.2 - e, 0.8 + e, 0.8 + e, 0.8 + e};
g() = {};
"#;

/// A small block at a corner of the cube.
const CORNER: &str = r#"s = 0.8; Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {s, s, s, 1 - s, 1 - s, 1 - s};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
f() = Surface In BoundingBox{s - e, s - e, s - e, s + e, 1 + e, 1 + e};
g() = Surface In BoundingBox{s - e, s - e, s - e, 1 + e, s + e, 1 + e};
g() += Surface In BoundingBox{s - e, s - e, s - e, 1 + e, 1 + e, s + e};
"#;

const FACES: &str = r#"left() = Surface In BoundingBox{-e, -e, -e, e, 1 + e, 1 + e};
right() = Surface In BoundingBox{1 - e, -e, -e, 1 + e, 1 + e, 1 + e};
front() = Surface In BoundingBox{-e, -e, -e, 1 + e, e, 1 + e};
back() = Surface In BoundingBox{-e, 1 - e, -e, 1 + e, 1 + e, 1 + e};
bottom() = Surface In BoundingBox{-e, -e, -e, 1 + e, 1 + e, e};
top() = Surface In BoundingBox{-e, -e, 1 - e, 1 + e, 1 + e, 1 + e};
g() -= {f(), left(), right(), front(), back(), bottom(), top()};
Physical Volume("rock") = Volume{:};
Physical Surface("left") = left(); Physical Surface("right") = right();
Physical Surface("front") = front(); Physical Surface("back") = back();
Physical Surface("bottom") = bottom(); Physical Surface("top") = top();
Physical Surface("f") = f();
If (#g() > 0)
  Physical Surface("g") = g();
EndIf
Mesh.MeshSizeMax = h;
"#;

impl Junction {
    /// The text of its geometry.
    pub fn geometry(&self) -> String {
        let Some(script) = self.script else {
            let file = format!("geometries/{0}/{0}.geo", self.name);
            return String::from_utf8_lossy(&bytes_of(&root().join(file))).into_owned();
        };
        let head = "SetFactory(\"OpenCASCADE\");\nDefineConstant[ h = {0.35, Name \"h\"} ];\n";
        format!("{head}e = 1e-5;\n{script}{FACES}")
    }

    /// The section of a scene that makes its mesh.
    pub fn section(&self, fineness: Fineness) -> String {
        let (size, order) = fineness.size();
        let name = self.name;
        format!(
            "[mesh]\ngeometry = \"{name}.geo\"\nparameters = {{ h = {size} }}\norder = {order}\n"
        )
    }
}

impl Fineness {
    /// Cell size (m) and order of the cells.
    fn size(self) -> (f64, u32) {
        match self {
            Self::Coarse => (0.4, 1),
            Self::Quadratic => (0.6, 2),
            Self::Fine => (0.09, 1),
        }
    }
}

/// The meshes of all junctions, each made when it is needed first.
pub struct Meshes {
    folder: TempDir,
    made: [[OnceLock<Draft>; 3]; 6],
}

impl Meshes {
    /// None so far.
    ///
    /// # Panics
    /// If there is no place for temporary files.
    pub fn none() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
            made: Default::default(),
        }
    }

    /// The mesh of a junction by its number.
    ///
    /// # Panics
    /// If gmsh does not make it.
    pub fn of(&self, junction: usize, fineness: Fineness) -> Draft {
        let made = self.made[junction][fineness as usize].get_or_init(|| {
            let own = &JUNCTIONS[junction];
            let file = self.file(own);
            let (size, order) = fineness.size();
            meshed_file(&file, &[("h", size)], order, Dimension::Volumes)
        });
        made.clone()
    }

    fn file(&self, junction: &Junction) -> PathBuf {
        let file: &Path = self.folder.path();
        let file = file.join(format!("{}.geo", junction.name));
        fs::write(&file, junction.geometry()).expect("a writable folder");
        file
    }
}
