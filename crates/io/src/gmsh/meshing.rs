//! From a geometry to a mesh: kept from before, or made in the first way that succeeds.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use kluft_mesh::Defect;

use super::attempts::{Attempt, attempts, is_worth_another};
use super::cache::{MeshCache, Record};
use super::ending::{cannot_start, judge};
use super::log::IN_A_GEOMETRY;
use super::made::{check_cells, check_made};
use super::options::{Dimension, Meshed, Meshing};
use super::review::reviewed;
use super::run::{Gmsh, Scope, path_argument};
use super::version::version_of;
use super::workspace::Workspace;
use super::{file_format, ingredients, parameters, size_field};
use crate::fingerprint::Fingerprint;
use crate::msh::bytes_of;

/// Name of what gmsh writes in its workspace.
pub(super) const MADE: &str = "made.msh";
/// Without a window, with errors and warnings only.
pub(super) const QUIETLY: [&str; 3] = ["-nopopup", "-v", "2"];

/// Runs gmsh, unless the same mesh was made before and kept.
///
/// Where the geometry does not choose how volumes are meshed, another way is tried when gmsh's
/// usual one fails.
///
/// # Errors
/// A geometry that is missing or would do more than describe a body, parameters that gmsh would
/// silently ignore, gmsh not installed, everything that gmsh reports as an error (it writes a mesh
/// even then), and, with the code [`super::NOT_MESHED`], time or space that ran out.
pub fn mesh_geometry(meshing: &Meshing) -> Result<Meshed, Vec<Defect>> {
    mesh_with(&Gmsh::from_environment(meshing.gmsh), meshing)
}

pub(super) fn mesh_with(gmsh: &Gmsh, meshing: &Meshing) -> Result<Meshed, Vec<Defect>> {
    check(meshing)?;
    let review = reviewed(meshing.geometry, meshing.gmsh)?;
    let scripts = review.scripts().map(std::fs::read);
    let scripts: Vec<Vec<u8>> = scripts.map(Result::unwrap_or_default).collect();
    let attempts = attempts(&scripts, meshing.parameters, meshing.dimension);
    let kept = meshing.gmsh.cache.as_ref().and_then(|cache| {
        let program = gmsh.find().ok()?;
        let key = ingredients::sum(meshing, &review, attempts, &program)?;
        Some(Kept { cache, key })
    });
    if let Some(meshed) = kept.as_ref().and_then(|kept| kept.fetch(meshing.output)) {
        return Ok(meshed);
    }
    let scope = Scope {
        folder: None,
        reads: review.reads(meshing.geometry),
    };
    let mut meshed = make(gmsh, meshing, (attempts, &scripts), scope)?;
    if let Some(kept) = kept {
        kept.keep(meshing.output, &mut meshed);
    }
    Ok(meshed)
}

/// The place of a mesh among those that are kept.
struct Kept<'a> {
    cache: &'a MeshCache,
    key: Fingerprint,
}

impl Kept<'_> {
    fn fetch(&self, output: &Path) -> Option<Meshed> {
        let record = self.cache.fetch(self.key, output)?;
        Some(Meshed {
            warnings: record.warnings,
            version: record.version,
            seconds: record.seconds,
            is_kept: true,
        })
    }

    /// A mesh that cannot be kept is as good as any.
    fn keep(&self, output: &Path, meshed: &mut Meshed) {
        let about = Record {
            sum: String::new(),
            seconds: meshed.seconds,
            warnings: meshed.warnings.clone(),
            version: meshed.version.clone(),
        };
        if let Err(error) = self.cache.keep(self.key, output, about) {
            let problem = format!("the mesh is not kept for other runs: {error}");
            meshed.warnings.push(problem);
        }
    }
}

/// Lets gmsh make a mesh, in the first of some ways that succeeds.
fn make(
    gmsh: &Gmsh,
    meshing: &Meshing,
    (attempts, scripts): (&[Attempt], &[Vec<u8>]),
    mut scope: Scope,
) -> Result<Meshed, Vec<Defect>> {
    let one = |defect| vec![defect];
    let workspace = Workspace::beside(meshing.output).map_err(one)?;
    scope.folder = Some(workspace.folder().to_owned());
    let inputs = inputs(meshing, scripts, &workspace).map_err(one)?;
    scope.reads.extend(meshing.sizes.map(Path::to_owned));
    let made = workspace.path(MADE);
    let start = Instant::now();
    let mut failed = Vec::new();
    let mut left = attempts.iter();
    let warnings = loop {
        let Some(attempt) = left.next() else {
            return Err(failed);
        };
        let arguments = arguments(meshing, *attempt, (&inputs, &made));
        let is_last = left.len() == 0;
        let tried = try_once(gmsh, meshing, &arguments, &scope);
        // What is wrong with the last is told by who reads it.
        let is_judged_later = is_last || meshing.dimension == Dimension::Surfaces;
        let sound = |made: &Path| {
            if is_judged_later {
                Ok(())
            } else {
                check_cells(made)
            }
        };
        match tried.and_then(|warnings| sound(&made).map(|()| warnings)) {
            Ok(warnings) => break warnings,
            Err(defects) if !is_last && is_worth_another(&defects) => {
                failed.extend(defects.into_iter().next());
                // It must not be taken for that of the next.
                let _ = std::fs::remove_file(&made);
            }
            Err(defects) => return Err(beside_former(defects, &failed, attempts)),
        }
    };
    workspace.publish(MADE, meshing.output).map_err(one)?;
    let number = failed.len();
    let failed = failures(&failed, attempts, None).into_iter();
    let used = (number > 0).then(|| format!("meshed in another way: {}", attempts[number].name));
    Ok(Meshed {
        warnings: failed.chain(used).chain(warnings).collect(),
        version: version_of(gmsh),
        seconds: start.elapsed().as_secs_f64(),
        is_kept: false,
    })
}

/// What gmsh reads: the geometry, or a script that meshes it by given sizes, and the file format
/// where a script would choose another.
fn inputs(
    meshing: &Meshing,
    scripts: &[Vec<u8>],
    workspace: &Workspace,
) -> Result<Vec<PathBuf>, Defect> {
    let mut inputs = vec![meshing.geometry.to_owned()];
    if let Some(sizes) = meshing.sizes {
        inputs[0] = workspace.path("sized.geo");
        size_field::write_script(&inputs[0], meshing.geometry, sizes)?;
    }
    if file_format::is_chosen(scripts) {
        inputs.push(workspace.path("format.geo"));
        file_format::write_script(&inputs[1])?;
    }
    Ok(inputs)
}

/// Why each of the first ways failed; in the same way, where the `last` failed for the same reason.
fn failures(failed: &[Defect], attempts: &[Attempt], last: Option<&Defect>) -> Vec<String> {
    let failed = failed.iter().zip(attempts);
    let told = failed.map(|(defect, way)| match &defect.problem {
        why if last.is_some_and(|last| last.problem == *why) => {
            format!("{} failed in the same way", way.name)
        }
        why => format!("{} failed: {why}", way.name),
    });
    told.collect()
}

/// The defects of the last way, the first with why the ways before it failed.
fn beside_former(mut defects: Vec<Defect>, failed: &[Defect], attempts: &[Attempt]) -> Vec<Defect> {
    let former = failures(failed, attempts, defects.first());
    if let Some(first) = defects.first_mut().filter(|_| !former.is_empty()) {
        first.problem = format!("{}; before, {}", first.problem, former.join("; "));
    }
    defects
}

/// Runs gmsh once; its warnings.
fn try_once(
    gmsh: &Gmsh,
    meshing: &Meshing,
    arguments: &[OsString],
    scope: &Scope,
) -> Result<Vec<String>, Vec<Defect>> {
    let ended = gmsh.run(arguments, scope);
    let ended = ended.map_err(|error| vec![cannot_start(gmsh, &error)])?;
    let warnings = judge(gmsh, (meshing.geometry, IN_A_GEOMETRY), &ended)?;
    let made = scope.folder.as_deref().unwrap_or(Path::new("")).join(MADE);
    let asked = (meshing.geometry, meshing.dimension);
    check_made(&made, asked, meshing.output).map_err(|defect| vec![defect])?;
    Ok(warnings)
}

fn check(meshing: &Meshing) -> Result<(), Vec<Defect>> {
    let place = meshing.geometry.display().to_string();
    let bytes = bytes_of(meshing.geometry).map_err(|defect| {
        let problem = format!("the geometry {}", defect.problem);
        vec![Defect { problem, ..defect }]
    })?;
    let script = String::from_utf8_lossy(&bytes);
    let mut defects = parameters::check(&place, &script, meshing.parameters);
    if !(1..=2).contains(&meshing.order) {
        let problem = format!("elements of order {} cannot be used", meshing.order);
        defects.push(Defect::new(place, problem, "ask for order 1 or 2"));
    }
    if defects.is_empty() {
        Ok(())
    } else {
        Err(defects)
    }
}

fn arguments(
    meshing: &Meshing,
    attempt: Attempt,
    (inputs, made): (&[PathBuf], &Path),
) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = inputs.iter().map(|input| path_argument(input)).collect();
    arguments.extend([
        match meshing.dimension {
            Dimension::Surfaces => "-2".into(),
            Dimension::Volumes => "-3".into(),
        },
        "-format".into(),
        "msh41".into(),
        "-bin".into(),
        "-order".into(),
        meshing.order.to_string().into(),
    ]);
    let given = meshing.parameters.iter();
    let given = given.map(|(name, value)| (name.as_str(), *value));
    for (name, value) in attempt.options.iter().copied().chain(given) {
        arguments.extend([
            "-setnumber".into(),
            name.into(),
            format!("{value:e}").into(),
        ]);
    }
    arguments.extend(QUIETLY.map(OsString::from));
    arguments.extend(["-o".into(), path_argument(made)]);
    arguments
}
