//! From a list of fractures or a description of random sets to a geometry and a scene.

mod apertures;
mod body;
mod input;
mod keys;
mod passages;
mod record;
mod scene;
mod sets;

use std::io::Write;
use std::path::{Path, PathBuf};

use kluft_io::{ClaimedFolder, GmshOptions, sync_folder, write_atomically};
use kluft_mesh::Defect;
use kluft_network::{Domain, Grouping, Network, write_geo};

use crate::failure::Failure;
use crate::printing::shell_path;
use crate::report::{Report, Verbosity};
use crate::run::{RunOptions, run};
use body::included;
use input::{Input, Overrides};
use record::NetworkRecord;
use scene::MADE;

/// The files that are made beside the geometry.
const SCENE: &str = "scene.toml";
const RECORD: &str = "network.json";
/// By which a geometry is known.
const BY: &str = "made by `kluft network` from";

/// How to make a network.
#[derive(Debug, Clone)]
pub struct NetworkOptions {
    /// Folder for geometry, scene and statistics.
    pub out: PathBuf,
    /// Name of the geometry file, without `.geo`.
    pub name: String,
    /// What gets a physical surface of its own.
    pub grouping: Grouping,
    /// Box of rock, instead of the one in the input.
    pub domain: Option<Domain>,
    /// Cell size away from fractures (m), instead of the one in the input.
    pub h: Option<f64>,
    /// Whether features too small for the mesh stay as they are.
    pub keep_small: bool,
    /// How wide the fractures of a list are for water (m), if any is to flow in them.
    pub hydraulic_aperture: Option<f64>,
    /// Whether the scene is run as well.
    pub run: bool,
    /// How the program was called.
    pub command: String,
    /// How a run starts gmsh, and what a geometry may do.
    pub gmsh: GmshOptions,
    /// How much to tell.
    pub verbosity: Verbosity,
}

/// Makes `NAME.geo`, `scene.toml` and `network.json` from a list (`.csv`) or a description
/// (`.toml`) of fractures.
///
/// # Errors
/// Every defect of the input; fractures that overlap in one plane; files that cannot be written.
pub fn make_network(file: &Path, options: &NetworkOptions) -> Result<(), Failure> {
    let report = Report::new(options.verbosity);
    let overrides = Overrides {
        domain: options.domain,
        h: options.h,
        keep_small: options.keep_small,
        hydraulic_aperture: options.hydraulic_aperture,
    };
    let input = Input::read(file, &overrides)?;
    sets::check_grouping(&input.sets, options.grouping)?;
    let name = file.file_name().unwrap_or_default().display();
    report.entry("network", &format!("{name}  {}", input.title));
    let network = Network::build(input.domain, input.sizes, input.given.clone())?;
    let record = NetworkRecord::of(&network, &input);
    record.tell(&report);
    if network.fractures.is_empty() {
        return Err(Failure::BadInput(vec![Defect::new(
            file.display().to_string(),
            "no fracture is left in the domain",
            "compare the domain with the centres of the fractures; -v lists why each was left out",
        )]));
    }
    write(file, options, &input, &network, &record)?;
    let scene = options.out.join(SCENE);
    if !options.run {
        report.entry("next", &format!("kluft run {}", shell_path(&scene)));
        return Ok(());
    }
    let running = RunOptions {
        out: None,
        threads: None,
        ranks: None,
        verbosity: options.verbosity,
        resume: false,
        report: true,
        is_tied: false,
        command: options.command.clone(),
        gmsh_arguments: Vec::new(),
        gmsh: options.gmsh.clone(),
    };
    run(&scene, &running)
}

fn write(
    file: &Path,
    options: &NetworkOptions,
    input: &Input,
    network: &Network,
    record: &NetworkRecord,
) -> Result<(), Failure> {
    let geometry = format!("{}.geo", options.name);
    let folder = claim(file, &options.out, &geometry)?;
    let name = file.file_name().unwrap_or_default().display();
    let title = format!("{}: {BY} {name}", input.title);
    let write_text = |name: &str, text: &str| {
        folder.write(name, |path| {
            write_atomically(path, |out| out.write_all(text.as_bytes()))
        })
    };
    let body = input.body.as_ref();
    let body = body.map(|body| included(body, folder.path())).transpose()?;
    let text = write_geo(network, options.grouping, &title, body.as_deref());
    write_text(&geometry, &text)?;
    let scene = scene::text(input, network, options.grouping, &geometry);
    write_text(SCENE, &scene)?;
    let record = serde_json::to_string_pretty(record).unwrap_or_default();
    write_text(RECORD, &(record + "\n"))?;
    Ok(sync_folder(folder.path())?)
}

/// The folder for the files of a network; nothing is written over that this command has not made.
fn claim(file: &Path, folder: &Path, geometry: &str) -> Result<ClaimedFolder, Failure> {
    let mut folder = ClaimedFolder::claim(folder)?;
    protect(&folder.path().join(SCENE))?;
    let names = [geometry, SCENE, RECORD];
    if !folder.has_list() {
        let made = names.into_iter().filter(|name| is_made(&folder, name));
        let made: Vec<&str> = made.collect();
        folder.list(made.into_iter())?;
    }
    folder.protect(names.into_iter(), &[file])?;
    folder.list(names.into_iter())?;
    Ok(folder)
}

/// Whether a file in a folder without a list says that this command has made it.
fn is_made(folder: &ClaimedFolder, name: &str) -> bool {
    let Ok(text) = std::fs::read_to_string(folder.path().join(name)) else {
        return false;
    };
    match name {
        SCENE => text.starts_with(MADE),
        RECORD => text.starts_with("{\n  \"kluft\": "),
        _ => text.lines().next().is_some_and(|line| line.contains(BY)),
    }
}

/// A scene that somebody wrote is not ours to replace.
fn protect(scene: &Path) -> Result<(), Defect> {
    let Ok(text) = std::fs::read_to_string(scene) else {
        return Ok(());
    };
    if text.starts_with(MADE) {
        return Ok(());
    }
    Err(Defect::new(
        scene.display().to_string(),
        "there is a scene that this command has not made, or that was protected",
        "name another folder with -o DIR, or remove the scene",
    ))
}
