//! What a scene makes of the physical groups of a mesh.

use kluft_mesh::{Defect, Draft, Group, SurfaceRole, nearest};

use crate::scene::Scene;

/// Name under which a section serves all groups without one of their own.
pub(crate) const DEFAULT: &str = "default";

/// What a scene makes of the groups of a mesh.
pub struct Roles {
    /// One entry for each group; only those of surfaces count.
    pub of_group: Vec<SurfaceRole>,
    /// What becomes of surfaces that the scene does not name.
    pub decisions: Vec<String>,
}

/// Gives roles to the groups of a mesh; `inner` tells which of them are surfaces inside the rock.
///
/// # Errors
/// Names of the scene that are no group of the mesh, or one of the wrong dimension.
pub fn roles(scene: &Scene, draft: &Draft, inner: &[bool]) -> Result<Roles, Vec<Defect>> {
    let of_group = surface_roles(scene, draft, |group| inner[group])?;
    let unused = |inside: bool| -> Vec<&str> {
        let groups = draft.groups.iter().zip(&of_group).zip(inner);
        let chosen = groups.filter(|((group, role), inner)| {
            group.dimension == 2 && **role == SurfaceRole::Unused && **inner == inside
        });
        chosen.map(|((group, _), _)| group.name.as_str()).collect()
    };
    let decisions = unused_surfaces(&unused(true), &unused(false));
    Ok(Roles {
        of_group,
        decisions,
    })
}

/// Surfaces that the scene does not name, inside the rock and outside.
fn unused_surfaces(inside: &[&str], outside: &[&str]) -> Vec<String> {
    let line = |names: &[&str], what: &str| {
        (!names.is_empty()).then(|| format!("{}: not named in the scene, {what}", names.join(", ")))
    };
    let lines = [
        line(
            inside,
            "so welded (name it under [fracture] to let it move)",
        ),
        line(outside, "so free"),
    ];
    lines.into_iter().flatten().collect()
}

/// What each group of the draft is, going by the scene. Surfaces that the scene does not name are
/// fractures if there is a `[fracture.default]` and they lie inside the rock, and unused otherwise.
///
/// # Errors
/// Names of the scene that are no group of the mesh, or one of the wrong dimension.
fn surface_roles(
    scene: &Scene,
    draft: &Draft,
    is_inside: impl Fn(usize) -> bool,
) -> Result<Vec<SurfaceRole>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut roles = vec![SurfaceRole::Unused; draft.groups.len()];
    let mut assign = |name: &str, place: &str, role: SurfaceRole, roles: &mut Vec<SurfaceRole>| {
        match find_group(&draft.groups, name, 2, place) {
            Ok(group) if roles[group] == SurfaceRole::Unused => roles[group] = role,
            Ok(_) => defects.push(Defect::new(
                place,
                format!("surface `{name}` is both a fracture and a boundary"),
                "a fracture lies inside the rock, a boundary outside; remove one of the sections",
            )),
            Err(defect) => defects.push(defect),
        }
    };
    for entry in scene.fractures.iter().filter(|entry| entry.name != DEFAULT) {
        assign(&entry.name, &entry.place, SurfaceRole::Fracture, &mut roles);
    }
    for entry in &scene.boundaries {
        assign(&entry.name, &entry.place, SurfaceRole::Boundary, &mut roles);
    }
    defects.extend(volume_names(scene, &draft.groups));
    if scene.fractures.iter().any(|entry| entry.name == DEFAULT) {
        for (group, role) in roles.iter_mut().enumerate() {
            let unnamed = *role == SurfaceRole::Unused && draft.groups[group].dimension == 2;
            if unnamed && is_inside(group) {
                *role = SurfaceRole::Fracture;
            }
        }
    }
    if defects.is_empty() {
        Ok(roles)
    } else {
        Err(defects)
    }
}

fn volume_names(scene: &Scene, groups: &[Group]) -> Vec<Defect> {
    let named = scene.rocks.iter().filter(|entry| entry.name != DEFAULT);
    named
        .filter_map(|entry| find_group(groups, &entry.name, 3, &entry.place).err())
        .collect()
}

fn kind(dimension: usize) -> &'static str {
    ["point", "curve", "surface", "volume"][dimension.min(3)]
}

/// The group of a dimension and a name; `place` is where the scene speaks of it.
///
/// # Errors
/// If the mesh has none, with the nearest name or what it has instead.
pub(crate) fn find_group(
    groups: &[Group],
    name: &str,
    dimension: usize,
    place: &str,
) -> Result<usize, Defect> {
    let fits = |group: &Group| group.dimension == dimension;
    if let Some(found) = groups
        .iter()
        .position(|group| fits(group) && group.name == name)
    {
        return Ok(found);
    }
    let wanted = kind(dimension);
    let declare = format!(
        "give the {wanted} a physical group: Physical {}(\"{name}\") = {{...}};",
        capital(wanted)
    );
    if let Some(other) = groups.iter().find(|group| group.name == name) {
        let found = kind(other.dimension);
        return Err(Defect::new(
            place,
            format!("`{name}` is a physical {found} of the mesh, not a physical {wanted}"),
            declare,
        ));
    }
    let known: Vec<&str> = groups
        .iter()
        .filter(|g| fits(g))
        .map(|g| g.name.as_str())
        .collect();
    let remedy = match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => format!("the mesh has none at all: {declare}"),
        None => format!("physical {wanted}s of the mesh: {}", known.join(", ")),
    };
    Err(Defect::new(
        place,
        format!("the mesh has no physical {wanted} `{name}`"),
        remedy,
    ))
}

fn capital(word: &str) -> String {
    let (first, rest) = word.split_at(1);
    first.to_uppercase() + rest
}
