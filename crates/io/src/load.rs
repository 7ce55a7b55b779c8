//! Reads `.msh` files of any version, older ones by way of gmsh.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use kluft_mesh::{Defect, Draft, Elements, Group, TaggedElements};

use crate::gmsh::convert_mesh;
use crate::msh::{bytes_of, older_names, older_version, parse_msh};

/// Cells from which on a mesh outgrows the caches, so that it pays to arrange it.
const LARGE: usize = 20_000;

/// Reads an MSH file of any version; gmsh converts those before 4.1 to a file in `scratch_dir`,
/// which is removed again. Large meshes are arranged ([`Draft::arrange`]); small ones keep the
/// order of the file.
///
/// # Errors
/// As [`crate::read_msh`], and what gmsh says against the file.
pub fn load_msh(path: &Path, scratch_dir: &Path) -> Result<Draft, Vec<Defect>> {
    let (mut draft, bytes) = load(path, scratch_dir)?;
    if draft.cells.elements.len() >= LARGE {
        // To give back the memory of a large file takes the system a while.
        rayon::join(|| drop(bytes), || draft.arrange());
    }
    Ok(draft)
}

/// The draft, and the bytes that it was read from where they are still there.
fn load(path: &Path, scratch_dir: &Path) -> Result<(Draft, Vec<u8>), Vec<Defect>> {
    let name = path.display().to_string();
    let bytes = bytes_of(path).map_err(|defect| vec![defect])?;
    let Some(version) = older_version(&bytes, &name).map_err(|defect| vec![defect])? else {
        return parse_msh(&bytes, &name).map(|draft| (draft, bytes));
    };
    let named = older_names(&bytes, &name);
    drop(bytes);
    let mut draft = load_older(path, scratch_dir)?;
    rename(&mut draft.groups, &named);
    if version < 4.0 {
        drop_repeated(&mut draft.cells);
        drop_repeated(&mut draft.facets);
    }
    Ok((draft, Vec::new()))
}

/// Gives groups the names of the file: gmsh cuts those that hold a quote.
fn rename(groups: &mut [Group], named: &[Group]) {
    let key = |group: &Group| (group.dimension, group.tag);
    for group in groups {
        if let Some(named) = named.iter().find(|named| key(named) == key(group)) {
            group.name.clone_from(&named.name);
        }
    }
}

fn load_older(path: &Path, scratch_dir: &Path) -> Result<Draft, Vec<Defect>> {
    let converted = scratch_name(path, scratch_dir);
    let draft = convert_mesh(path, &converted)
        .and_then(|()| bytes_of(&converted).map_err(|defect| vec![defect]))
        .and_then(|bytes| parse_msh(&bytes, &path.display().to_string()));
    // It may not exist, and the answer does not depend on its removal.
    let _ = std::fs::remove_file(&converted);
    draft
}

fn scratch_name(path: &Path, scratch_dir: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    scratch_dir.join(format!(".{stem}.{}.msh41.msh", std::process::id()))
}

/// Version 2 lists an element once for each of its physical groups, turned round where the group
/// sees the surface reversed; gmsh keeps all the copies, each with all groups.
fn drop_repeated(elements: &mut TaggedElements) {
    let mut seen: HashSet<(u32, Vec<u32>)> = HashSet::with_capacity(elements.tags.len());
    let mut kept = TaggedElements::new();
    for index in 0..elements.elements.len() {
        let mut nodes = elements.elements.nodes_of(index).to_vec();
        nodes.sort_unstable();
        let set = elements.group_set[index];
        if seen.insert((set, nodes)) {
            keep_element(
                &mut kept,
                &elements.elements,
                index,
                elements.tags[index],
                set,
            );
        }
    }
    *elements = kept;
}

fn keep_element(kept: &mut TaggedElements, from: &Elements, index: usize, tag: u64, set: u32) {
    kept.elements.push(from.shapes[index], from.nodes_of(index));
    kept.tags.push(tag);
    kept.group_set.push(set);
}
