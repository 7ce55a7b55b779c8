//! Reads gmsh's `.msh` files, of version 4.1 with the crate `mshio` behind a guard.

mod cursor;
mod draft;
mod elements;
mod entities;
mod groups;
mod guard;
mod header;
mod mshio_calls;
mod names;
mod nodes;
mod sections;
mod source;
mod tags;
mod write;

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use kluft_defect::open_ordinary;
use kluft_mesh::{Defect, Draft, Group};
use memchr::memmem;
use rayon::prelude::*;

pub use draft::shape_of_gmsh_element;
use header::Format;
use source::MshSource;
pub use write::write_msh;

/// Reads an MSH 4.1 file, text or binary; coordinates are taken as metres.
///
/// # Errors
/// Every kind of defect of the file: unreadable, damaged, another version, element types that
/// cannot be used, nodes that are missing or have no unique tag.
pub fn read_msh(path: &Path) -> Result<Draft, Vec<Defect>> {
    let bytes = bytes_of(path).map_err(|defect| vec![defect])?;
    parse_msh(&bytes, &path.display().to_string())
}

/// Parses the bytes of an MSH 4.1 file; `source` names the file in messages.
///
/// # Errors
/// As [`read_msh`].
pub fn parse_msh(bytes: &[u8], source: &str) -> Result<Draft, Vec<Defect>> {
    let source = MshSource {
        name: source,
        bytes,
    };
    match header::read(source) {
        Ok(Format::Current(encoding)) => draft::build(guard::survey(source, encoding)?),
        Ok(Format::Older(version)) => Err(vec![older(source, version)]),
        Err(defect) => Err(vec![defect]),
    }
}

/// The version of an MSH file if it is before 4.1; `name` names the file in messages.
pub(crate) fn older_version(bytes: &[u8], name: &str) -> Result<Option<f64>, Defect> {
    let format = header::read(MshSource { name, bytes })?;
    Ok(match format {
        Format::Current(_) => None,
        Format::Older(version) => Some(version),
    })
}

/// The groups that an older file names; none if it names none, or nothing that can be read.
pub(crate) fn older_names(bytes: &[u8], name: &str) -> Vec<Group> {
    const HEAD: &[u8] = b"$PhysicalNames";
    let source = MshSource { name, bytes };
    let found = memmem::find(bytes, HEAD).map(|head| head + HEAD.len());
    let named = found.and_then(|start| {
        let length = memmem::find(&bytes[start..], b"\n$EndPhysicalNames")?;
        names::read(source, &bytes[start..start + length], start).ok()
    });
    named.unwrap_or_default()
}

/// Whether an MSH 4.1 file holds elements of a dimension.
pub(crate) fn holds_elements(path: &Path, dimension: usize) -> Result<bool, Defect> {
    let bytes = bytes_of(path)?;
    let name = path.display().to_string();
    let source = MshSource {
        name: &name,
        bytes: &bytes,
    };
    match header::read(source)? {
        Format::Current(encoding) => guard::holds_elements(source, encoding, dimension),
        Format::Older(version) => Err(older(source, version)),
    }
}

fn older(source: MshSource, version: f64) -> Defect {
    source.defect(
        format!("this is an MSH file of version {version}, not 4.1"),
        "convert it: `gmsh IN.msh -save -save_all -format msh41 -bin -o OUT.msh`",
    )
}

/// The bytes of an ordinary file.
pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, Defect> {
    read_bytes(path).map_err(|error| {
        let problem = format!("cannot be read: {error}");
        Defect::new(
            path.display().to_string(),
            problem,
            "check the path and the permissions",
        )
    })
}

/// Large files are read by several tasks: copying them out of the system's cache takes as long as
/// the parsing of a binary one.
fn read_bytes(path: &Path) -> io::Result<Vec<u8>> {
    const PART: usize = 2 << 20;
    let length = open_ordinary(path)?.metadata()?.len();
    let length = usize::try_from(length).map_err(io::Error::other)?;
    if length < 8 * PART {
        return std::fs::read(path);
    }
    let mut bytes = vec![0; length];
    let parts = bytes.par_chunks_mut(PART).enumerate();
    parts.try_for_each(|(number, part)| {
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start((number * PART) as u64))?;
        file.read_exact(part)
    })?;
    Ok(bytes)
}
