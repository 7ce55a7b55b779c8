//! Times the way from a mesh file to a checked, numbered mesh: prints the seconds of each stage,
//! one line a run. Surfaces inside the rock are taken for fractures. Cells are divided as often as
//! is said.
//!
//!     cargo bench --bench reading -- FILE.msh [RUNS [REFINE]]

#![allow(clippy::print_stdout, reason = "seconds are what it is run for")]

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use kluft_io::load_msh;
use kluft_mesh::{Defect, Faces, Mesh, SurfaceRole};
use kluft_solver::SectorNodes;

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench`.
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let file = arguments
        .next()
        .ok_or("usage: reading FILE.msh [RUNS [REFINE]]")?;
    let runs: usize = arguments.next().map_or(Ok(1), |runs| runs.parse())?;
    let refine: u32 = arguments.next().map_or(Ok(0), |times| times.parse())?;
    for _ in 0..runs {
        read(Path::new(&file), refine).map_err(|defects| defects[0].to_string())?;
    }
    Ok(())
}

fn read(file: &Path, refine: u32) -> Result<(), Vec<Defect>> {
    let start = Instant::now();
    let mut draft = load_msh(file, &std::env::temp_dir(), &Default::default())?;
    let read = start.elapsed();
    draft.refine(refine)?;
    let refined = start.elapsed();
    let faces = Faces::of(&draft);
    let paired = start.elapsed();
    let inner = faces.inner_surfaces(&draft);
    let roles: Vec<SurfaceRole> = draft.groups.iter().zip(inner).map(role).collect();
    let mesh = Mesh::build_on(draft, faces, &roles)?;
    let built = start.elapsed();
    let points = SectorNodes::of(&mesh);
    let whole = start.elapsed();
    println!(
        "parse {:.3} refine {:.3} pair {:.3} check {:.3} number {:.3} total {:.3} cells {} points {}",
        read.as_secs_f64(),
        (refined - read).as_secs_f64(),
        (paired - refined).as_secs_f64(),
        (built - paired).as_secs_f64(),
        (whole - built).as_secs_f64(),
        whole.as_secs_f64(),
        mesh.cells.len(),
        points.len(),
    );
    Ok(())
}

fn role((group, is_inner): (&kluft_mesh::Group, bool)) -> SurfaceRole {
    match (group.dimension, is_inner) {
        (2, true) => SurfaceRole::Fracture,
        (2, false) => SurfaceRole::Boundary,
        _ => SurfaceRole::Unused,
    }
}
