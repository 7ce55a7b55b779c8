//! Cell sizes for gmsh: a view of sizes on a former mesh, and a script that meshes a geometry by
//! it.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

use kluft_mesh::{Defect, Mesh, Shape};

use super::script::LONGEST_STRING;
use crate::atomic::write_atomically;

/// Writes `sizes` (m), one for each node, as a view that gmsh interpolates on the cells of the
/// mesh.
///
/// # Errors
/// If the file cannot be written.
pub fn write_size_field(path: &Path, mesh: &Mesh, sizes: &[f64]) -> Result<(), Defect> {
    write_atomically(path, |out| {
        writeln!(out, "View \"size\" {{")?;
        let mut line = String::new();
        for cell in 0..mesh.cells.len() {
            let shape = mesh.cells.shapes[cell];
            let corners = &mesh.cells.nodes_of(cell)[..shape.corner_count()];
            line.clear();
            line.push_str(scalar(shape));
            for (i, &node) in corners.iter().enumerate() {
                let x = mesh.nodes[node as usize];
                let comma = if i > 0 { "," } else { "" };
                // Formatting into a string cannot fail.
                let _ = write!(line, "{comma}{},{},{}", x.x, x.y, x.z);
            }
            line.push_str("){");
            for (i, &node) in corners.iter().enumerate() {
                let comma = if i > 0 { "," } else { "" };
                let _ = write!(line, "{comma}{:.4e}", sizes[node as usize]);
            }
            line.push_str("};\n");
            out.write_all(line.as_bytes())?;
        }
        writeln!(out, "}};")
    })
}

/// gmsh's word for a scalar on the corners of a cell.
fn scalar(shape: Shape) -> &'static str {
    match shape.corner_count() {
        4 => "SS(",
        5 => "SY(",
        6 => "SI(",
        _ => "SH(",
    }
}

/// Writes a script that meshes `geometry` with the sizes of a field and nothing else.
pub(super) fn write_script(path: &Path, geometry: &Path, sizes: &Path) -> Result<(), Defect> {
    let [geometry, sizes] = [quoted(geometry)?, quoted(sizes)?];
    write_atomically(path, |out| {
        writeln!(out, "Merge {geometry};")?;
        for option in [
            "SizeMin = 0",
            "SizeMax = 1e22",
            "SizeFromPoints = 0",
            "SizeExtendFromBoundary = 0",
            "SizeFromCurvature = 0",
        ] {
            writeln!(out, "Mesh.Mesh{option};")?;
        }
        writeln!(out, "Merge {sizes};")?;
        writeln!(out, "kluft_sizes = newf;")?;
        writeln!(out, "Field[kluft_sizes] = PostView;")?;
        writeln!(
            out,
            "Field[kluft_sizes].ViewIndex = PostProcessing.NbViews - 1;"
        )?;
        writeln!(out, "Background Field = kluft_sizes;")
    })
}

/// A path as a string of gmsh, which has no way to write a quote inside quotes.
fn quoted(path: &Path) -> Result<String, Defect> {
    let refuse = |problem: String| {
        let remedy = "rename the file or its folder";
        Defect::new(path.display().to_string(), problem, remedy)
    };
    let whole = std::path::absolute(path).map_err(|error| refuse(error.to_string()))?;
    let name = whole.to_str().filter(|name| name.len() <= LONGEST_STRING);
    let name = name.ok_or_else(|| refuse("gmsh cannot read a path like this".to_owned()))?;
    let quote = ['"', '\''].into_iter().find(|&quote| !name.contains(quote));
    let quote = quote.ok_or_else(|| refuse("the path has quotes of both kinds".to_owned()))?;
    Ok(format!("{quote}{name}{quote}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_stays_one_string() {
        assert_eq!(quoted(Path::new("/a b.geo")).as_deref(), Ok("\"/a b.geo\""));
        let name = "/a\"; SystemCall \"b";
        assert_eq!(quoted(Path::new(name)), Ok(format!("'{name}'")));
        assert!(quoted(Path::new("/a\"'b")).is_err());
        assert!(quoted(Path::new(&"/long".repeat(300))).is_err());
    }
}
