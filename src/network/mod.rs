//! From a list of fractures or a description of random sets to a geometry and a scene.

mod input;
mod keys;
mod passages;
mod record;
mod scene;
mod sets;

use std::io::Write;
use std::path::{Path, PathBuf};

use kluft_io::write_atomically;
use kluft_mesh::Defect;
use kluft_network::{Domain, Grouping, Network, write_geo};

use crate::failure::Failure;
use crate::report::{Report, Verbosity};
use input::{Input, Overrides};
use record::NetworkRecord;
use scene::MADE;

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
    };
    let input = Input::read(file, &overrides)?;
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
    write(file, options, &input, &network, &record).map_err(|defect| vec![defect])?;
    let scene = options.out.join("scene.toml");
    report.entry("next", &format!("kluft run {}", scene.display()));
    Ok(())
}

fn write(
    file: &Path,
    options: &NetworkOptions,
    input: &Input,
    network: &Network,
    record: &NetworkRecord,
) -> Result<(), Defect> {
    let folder = &options.out;
    let path = |name: &str| folder.join(name);
    std::fs::create_dir_all(folder).map_err(|error| {
        let problem = format!("the folder cannot be made: {error}");
        let remedy = "name a folder you may write to with -o DIR";
        Defect::new(folder.display().to_string(), problem, remedy)
    })?;
    let scene = path("scene.toml");
    protect(&scene)?;
    let name = file.file_name().unwrap_or_default().display();
    let geometry = format!("{}.geo", options.name);
    let title = format!("{}: made by `kluft network` from {name}", input.title);
    let write_text =
        |path: &Path, text: &str| write_atomically(path, |out| out.write_all(text.as_bytes()));
    write_text(
        &path(&geometry),
        &write_geo(network, options.grouping, &title),
    )?;
    write_text(
        &scene,
        &scene::text(input, network, options.grouping, &geometry),
    )?;
    write_atomically(&path("network.json"), |out| {
        serde_json::to_writer_pretty(&mut *out, record)?;
        out.write_all(b"\n")
    })
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
