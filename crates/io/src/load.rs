//! Reads `.msh` files of any version, older ones by way of gmsh.

use std::collections::HashSet;
use std::path::Path;

use kluft_mesh::{Defect, Draft, Elements, Group, TaggedElements};

use crate::gmsh::{GmshOptions, convert_mesh};
use crate::msh::{bytes_of, older_names, older_version, parse_msh};

/// Cells from which on a mesh outgrows the caches, so that it pays to arrange it.
const LARGE: usize = 20_000;

/// Reads an MSH file of any version; gmsh converts those before 4.1, and may write in
/// `scratch_dir` meanwhile. Large meshes are arranged ([`Draft::arrange`]); small ones keep the
/// order of the file.
///
/// # Errors
/// As [`crate::read_msh`], and what gmsh says against the file.
pub fn load_msh(path: &Path, scratch_dir: &Path, gmsh: &GmshOptions) -> Result<Draft, Vec<Defect>> {
    let (mut draft, bytes) = load(path, scratch_dir, gmsh)?;
    // To give back the memory of a large file takes the system a while.
    rayon::join(|| drop(bytes), || arrange_large(&mut draft));
    Ok(draft)
}

/// Arranges a mesh if it is large, as [`load_msh`] does.
pub fn arrange_large(draft: &mut Draft) {
    if draft.cells.elements.len() >= LARGE {
        draft.arrange();
    }
}

/// The draft, and the bytes that it was read from where they are still there.
fn load(
    path: &Path,
    scratch_dir: &Path,
    gmsh: &GmshOptions,
) -> Result<(Draft, Vec<u8>), Vec<Defect>> {
    let name = path.display().to_string();
    let bytes = bytes_of(path).map_err(|defect| vec![defect])?;
    let Some(version) = older_version(&bytes, &name).map_err(|defect| vec![defect])? else {
        return parse_msh(&bytes, &name).map(|draft| (draft, bytes));
    };
    if !bytes.starts_with(b"$") {
        let problem = "there is white space before $MeshFormat: gmsh would take this for a script";
        return Err(vec![Defect::new(name, problem, "remove the white space")]);
    }
    let named = older_names(&bytes, &name);
    drop(bytes);
    let converted = convert_mesh(path, scratch_dir, gmsh)?;
    let mut draft = parse_msh(&converted, &name)?;
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
