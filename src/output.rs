//! From a solution to the files that ParaView opens.

use std::path::{Path, PathBuf};

use kluft_io::{Field, Grid, Values, write_pvd, write_vtu};
use kluft_mesh::Defect;
use kluft_solver::{Solution, System};

use crate::accuracy::Accuracy;
use crate::checkpoint;

/// Writes the results of a run into one folder, step by step; the collections always list exactly
/// the steps that are complete.
pub struct Output {
    folder: PathBuf,
    rock: Vec<(f64, String)>,
    fractures: Vec<(f64, String)>,
}

impl Output {
    /// Prepares the folder.
    ///
    /// # Errors
    /// If it cannot be made or written to.
    pub fn prepare(folder: &Path) -> Result<Self, Defect> {
        let refused = |error: std::io::Error| {
            Defect::new(
                folder.display().to_string(),
                format!("the results cannot be written here: {error}"),
                "name a folder you may write to with --out DIR",
            )
        };
        std::fs::create_dir_all(folder).map_err(refused)?;
        let probe = folder.join(".kluft-probe");
        std::fs::write(&probe, b"").map_err(refused)?;
        std::fs::remove_file(&probe).map_err(refused)?;
        Ok(Self {
            folder: folder.to_owned(),
            rock: Vec::new(),
            fractures: Vec::new(),
        })
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Goes on after load steps that a former run has written, which end at `times`.
    pub fn go_on_after(&mut self, times: impl Iterator<Item = f64>) {
        for (index, time) in times.enumerate() {
            let [rock, fractures] = names(index + 1);
            self.rock.push((time, rock));
            self.fractures.push((time, fractures));
        }
    }

    /// Checks that the results of the first `count` load steps are there.
    ///
    /// # Errors
    /// Those that are not.
    pub fn check_steps(&self, count: usize) -> Result<(), Vec<Defect>> {
        let files = (1..=count).flat_map(|number| names(number).map(|name| self.path(&name)));
        let missing = files.filter(|file| !file.is_file()).map(|file| {
            let problem = "the results of a finished load step are gone";
            let remedy = "put the file back, or run without --resume: it starts from the beginning";
            Defect::new(file.display().to_string(), problem, remedy)
        });
        let missing: Vec<Defect> = missing.collect();
        match missing.is_empty() {
            true => Ok(()),
            false => Err(missing),
        }
    }

    /// Removes what another run has written: its load steps, so that the folder never holds steps of
    /// two runs, its checkpoint, and what it left unfinished.
    ///
    /// # Errors
    /// If a file cannot be removed.
    pub fn remove_former(&self) -> Result<(), Defect> {
        let remove = || -> std::io::Result<()> {
            let entries = std::fs::read_dir(&self.folder)?;
            let names = entries.map(|entry| entry.map(|entry| entry.file_name()));
            let mut names = names.collect::<std::io::Result<Vec<_>>>()?;
            names.retain(|name| name.to_str().is_some_and(is_result));
            // The checkpoint first, so that none ever continues steps that are gone, then the
            // collections, so that none ever lists a grid that is gone.
            names.sort_by_key(|name| {
                let is_collection = name.as_encoded_bytes().ends_with(b".pvd");
                (name != checkpoint::NAME, !is_collection)
            });
            names
                .iter()
                .try_for_each(|name| std::fs::remove_file(self.folder.join(name)))
        };
        remove().map_err(|error| {
            Defect::new(
                self.folder.display().to_string(),
                format!("the results of a former run cannot be removed: {error}"),
                "remove them, or name another folder with --out DIR",
            )
        })
    }

    /// Writes one load step with its time for ParaView.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write_step(
        &mut self,
        system: &System<'_>,
        solution: &Solution,
        accuracy: &Accuracy,
        time: f64,
    ) -> Result<(), Defect> {
        let [rock, fractures] = names(self.rock.len() + 1);
        let of_rock = || write_vtu(&self.path(&rock), rock_grid(system, solution, accuracy));
        let of_fractures = || {
            let grid = fracture_grid(system, solution, accuracy);
            write_vtu(&self.path(&fractures), grid)
        };
        let (rock_written, fractures_written) = rayon::join(of_rock, of_fractures);
        rock_written?;
        fractures_written?;
        self.rock.push((time, rock));
        self.fractures.push((time, fractures));
        write_pvd(&self.path("rock.pvd"), &self.rock)?;
        write_pvd(&self.path("fractures.pvd"), &self.fractures)
    }
}

/// Names of the grids of a load step.
fn names(number: usize) -> [String; 2] {
    [
        format!("rock_{number:04}.vtu"),
        format!("fractures_{number:04}.vtu"),
    ]
}

/// Whether a run writes files of this name beside its mesh and its summary, or leaves them if it is
/// killed.
fn is_result(name: &str) -> bool {
    let unfinished = name
        .strip_prefix('.')
        .and_then(|name| name.strip_suffix(".tmp"));
    let of_gmsh = [".tmp.msh", ".tmp.geo", ".msh41.msh"].iter();
    let is_mesh = name.starts_with('.') && of_gmsh.into_iter().any(|end| name.ends_with(end));
    let name = unfinished.unwrap_or(name);
    let is_summary = unfinished.is_some() && ["summary.json", "sizes.pos"].contains(&name);
    is_mesh || is_summary || name == checkpoint::NAME || is_step(name)
}

/// Whether [`Output::write_step`] writes files of this name.
fn is_step(name: &str) -> bool {
    let of_kind = |kind: &str| {
        let Some(rest) = name.strip_prefix(kind) else {
            return false;
        };
        let number = rest
            .strip_prefix('_')
            .and_then(|rest| rest.strip_suffix(".vtu"));
        let is_number =
            |text: &str| text.len() >= 4 && text.bytes().all(|byte| byte.is_ascii_digit());
        rest == ".pvd" || number.is_some_and(is_number)
    };
    of_kind("rock") || of_kind("fractures")
}

/// The rock, with one copy of a node for each of its sectors.
fn rock_grid(system: &System<'_>, solution: &Solution, accuracy: &Accuracy) -> Grid {
    let mesh = &system.problem.mesh;
    let points = &system.discretisation.points;
    let rocks = system.problem.rock_of_cell.iter().map(|&rock| rock as i32);
    let displacements = solution.displacements.iter().map(|u| u.to_array());
    Grid {
        points: points
            .node
            .iter()
            .map(|&node| mesh.nodes[node as usize].to_array())
            .collect(),
        shapes: mesh.cells.shapes.clone(),
        offsets: mesh.cells.offsets.clone(),
        nodes: points.of_cell_node.clone(),
        point_fields: vec![real("displacement", displacements)],
        cell_fields: vec![
            real("stress", solution.stresses.iter().copied()),
            integer("rock", rocks),
            real(
                "stress_error",
                accuracy.stress_errors.iter().map(|&error| [error]),
            ),
        ],
    }
}

/// The fractures; every facet has its own points, so that fields may jump between facets.
fn fracture_grid(system: &System<'_>, solution: &Solution, accuracy: &Accuracy) -> Grid {
    let mesh = &system.problem.mesh;
    let elements = &mesh.facets.elements;
    let results = &solution.facet_nodes(system.problem, &system.discretisation.interface);
    let vectors = |of: fn(&kluft_solver::FacetResult) -> glam::DVec3| {
        results.iter().map(move |result| of(result).to_array())
    };
    let normals = mesh
        .facet_areas()
        .into_iter()
        .map(|area| area.normalize().to_array());
    let mut grid = Grid {
        points: elements
            .nodes
            .iter()
            .map(|&node| mesh.nodes[node as usize].to_array())
            .collect(),
        shapes: elements.shapes.clone(),
        offsets: elements.offsets.clone(),
        nodes: (0..elements.nodes.len() as u32).collect(),
        point_fields: vec![
            real("aperture", results.iter().map(|result| [result.aperture])),
            real("opening", results.iter().map(|result| [result.opening])),
            real("slip", vectors(|result| result.slip)),
            real("jump", vectors(|result| result.jump)),
            real("traction", vectors(|result| result.traction)),
            real(
                "normal_traction",
                results.iter().map(|result| [result.normal_traction]),
            ),
            integer("state", results.iter().map(|result| result.state as i32)),
        ],
        cell_fields: vec![
            real("normal", normals),
            integer(
                "fracture",
                mesh.facets.fracture.iter().map(|&fracture| fracture as i32),
            ),
        ],
    };
    if let Some(jumps) = &accuracy.jumps {
        let of_facets = mesh.facets.fracture.iter();
        let of_facets = of_facets.map(|&fracture| [jumps.aperture[fracture as usize]]);
        let field = real("aperture_uncertainty", of_facets);
        grid.cell_fields.push(field);
    }
    grid
}

/// A field of `N` numbers a point or cell.
pub(crate) fn real<const N: usize>(
    name: &'static str,
    values: impl Iterator<Item = [f64; N]>,
) -> Field {
    let values: Vec<[f64; N]> = values.collect();
    Field {
        name,
        components: N as u32,
        values: Values::Real(values.into_flattened()),
    }
}

pub(crate) fn integer(name: &'static str, values: impl Iterator<Item = i32>) -> Field {
    Field {
        name,
        components: 1,
        values: Values::Integer(values.collect()),
    }
}
