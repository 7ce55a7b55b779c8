//! What a scene makes of the physical groups of a mesh.

use std::collections::BTreeSet;

use kluft_keys::section_head;
use kluft_mesh::{Defect, Draft, Group, SurfaceRole, nearest, sample};

use crate::history::PhaseEntry;
use crate::scene::Scene;
use crate::warning::Doubt;

/// Name under which a section serves all groups without one of their own.
pub(crate) const DEFAULT: &str = "default";

/// What a scene makes of the groups of a mesh.
pub struct Roles {
    /// One entry for each group; only those of surfaces count.
    pub of_group: Vec<SurfaceRole>,
    /// Whether all that a group holds belongs to a fracture that is another group.
    pub on_fracture: Vec<bool>,
    /// What becomes of surfaces that the scene does not name.
    pub decisions: Vec<String>,
    /// What of it is hardly meant.
    pub warnings: Vec<String>,
}

/// Gives roles to the groups of a mesh; `inner` tells which of them are surfaces inside the rock.
///
/// # Errors
/// Names of the scene that are no group of the mesh, or one of the wrong dimension.
pub fn roles(scene: &Scene, draft: &Draft, inner: &[bool]) -> Result<Roles, Vec<Defect>> {
    let (without_name, shared) = (unnamed_by_mistake(scene, draft), sharing(draft));
    let is_taken = |group: usize| inner[group] && !without_name[group];
    let of_group = surface_roles(scene, draft, is_taken)?;
    let unused = |holds: &dyn Fn(usize) -> bool| -> Vec<&str> {
        let groups = draft.groups.iter().enumerate();
        let chosen = groups.filter(|(index, group)| {
            group.dimension == 2 && of_group[*index] == SurfaceRole::Unused && holds(*index)
        });
        chosen.map(|(_, group)| group.name.as_str()).collect()
    };
    let moves = |group: usize| {
        let mut others = shared.iter().filter(|(own, _)| *own == group);
        others.any(|(_, other)| of_group[*other] == SurfaceRole::Fracture)
    };
    let has_default = scene.fractures.iter().any(|entry| entry.name == DEFAULT);
    let skipped = |group: usize| has_default && inner[group] && without_name[group];
    let decisions = unused_surfaces([
        &unused(&|group| inner[group] && !moves(group)),
        &unused(&|group| inner[group] && moves(group)),
        &unused(&|group| !inner[group]),
    ]);
    let warnings = skipped_surfaces(&unused(&|group| skipped(group) && !moves(group)));
    let warnings = warnings.and_then(|text| scene.warning(Doubt::UnnamedSurfaces, &text));
    Ok(Roles {
        on_fracture: (0..draft.groups.len()).map(moves).collect(),
        of_group,
        decisions,
        warnings: warnings.into_iter().collect(),
    })
}

/// Surfaces that have no name in a file that names others: interfaces of a partition, or what lost
/// its name to another group. What the scene names itself, by its place or as what lies between
/// volumes, says nothing of the file.
fn unnamed_by_mistake(scene: &Scene, draft: &Draft) -> Vec<bool> {
    let is_surface = |group: &Group| group.dimension == 2;
    let has_name = |group: &Group| group.name != group.tag.to_string();
    let placed = scene.boundaries.iter().filter(|e| e.value.place.is_some());
    let between = scene.fractures.iter().filter(|e| e.value.between.is_some());
    let named_here = placed.map(|e| &e.name).chain(between.map(|e| &e.name));
    let named_here: Vec<&String> = named_here.collect();
    let is_of_file = |group: &Group| has_name(group) && !named_here.contains(&&group.name);
    let names = draft.groups.iter().any(|g| is_surface(g) && is_of_file(g));
    let groups = draft.groups.iter();
    groups
        .map(|group| names && is_surface(group) && !has_name(group))
        .collect()
}

/// Pairs of groups of which all that the first holds belongs to the second too.
fn sharing(draft: &Draft) -> Vec<(usize, usize)> {
    let used: BTreeSet<u32> = draft.facets.group_set.iter().copied().collect();
    let sets: Vec<&Vec<usize>> = used
        .iter()
        .map(|&s| &draft.group_sets[s as usize])
        .collect();
    let of = |group: usize| sets.iter().filter(move |set| set.contains(&group));
    let pairs = (0..draft.groups.len()).flat_map(|own| {
        let first = of(own).next().into_iter().flat_map(|set| set.iter());
        let others = first.filter(move |other| **other != own);
        others
            .filter(move |other| of(own).all(|set| set.contains(other)))
            .map(move |other| (own, *other))
    });
    pairs.collect()
}

/// Surfaces that the scene does not name: inside the rock, inside on a fracture, and outside.
fn unused_surfaces([inside, on_fractures, outside]: [&[&str]; 3]) -> Vec<String> {
    let line = |names: &[&str], what: &str| {
        (!names.is_empty()).then(|| format!("{}: not named in the scene, {what}", names.join(", ")))
    };
    let lines = [
        line(
            inside,
            "so welded (name it under [fracture] to let it move)",
        ),
        line(
            on_fractures,
            "but part of a fracture that is, and moves with it",
        ),
        line(outside, "so free"),
    ];
    lines.into_iter().flatten().collect()
}

/// Surfaces that `[fracture.default]` does not serve.
fn skipped_surfaces(names: &[&str]) -> Option<String> {
    let first = names.first()?;
    let head = section_head("fracture", first);
    Some(format!(
        "surfaces inside the rock without a name, {}, stay welded: where other surfaces have names, \
         [fracture.default] serves those only (interfaces of a partition are no joints); a section \
         {head} makes one a fracture",
        names.join(", ")
    ))
}

/// What each group of the draft is, going by the scene. Surfaces that the scene does not name are
/// fractures if there is a `[fracture.default]` that serves them, and unused otherwise.
///
/// # Errors
/// Names of the scene that are no group of the mesh, or one of the wrong dimension.
fn surface_roles(
    scene: &Scene,
    draft: &Draft,
    is_served: impl Fn(usize) -> bool,
) -> Result<Vec<SurfaceRole>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut roles = vec![SurfaceRole::Unused; draft.groups.len()];
    let mut probed = Vec::new();
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
    let is_named = |name: &str| scene.boundaries.iter().any(|entry| entry.name == name);
    for entry in &scene.probes {
        // What a probe alone names is free.
        let own = entry.value.boundary().filter(|name| !is_named(name));
        let Some(name) = own.filter(|name| !probed.contains(name)) else {
            continue;
        };
        probed.push(name);
        assign(name, &entry.place, SurfaceRole::Boundary, &mut roles);
    }
    defects.extend(volume_names(scene, &draft.groups));
    if scene.fractures.iter().any(|entry| entry.name == DEFAULT) {
        for (group, role) in roles.iter_mut().enumerate() {
            let unnamed = *role == SurfaceRole::Unused && draft.groups[group].dimension == 2;
            if unnamed && is_served(group) {
                let place = "[fracture.default]";
                let own = twice(&draft.groups, &draft.groups[group].name, 2, place);
                defects.extend(own.filter(|defect| !defects.contains(defect)));
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
    let phases = scene.phases();
    let unknown: Vec<Defect> = phases
        .iter()
        .filter_map(|p| unknown_rock(scene, p))
        .collect();
    if !unknown.is_empty() {
        return unknown;
    }
    let is_added = |name: &str| phases.iter().any(|p| p.added_as.as_deref() == Some(name));
    let named = scene.rocks.iter().filter(|entry| entry.name != DEFAULT);
    let named = named.filter(|entry| !is_added(&entry.name));
    named
        .filter_map(|entry| find_group(groups, &entry.name, 3, &entry.place).err())
        .collect()
}

/// What a phase is said to add something as, if the scene has no such rock.
fn unknown_rock(scene: &Scene, phase: &PhaseEntry) -> Option<Defect> {
    let name = phase.added_as.as_deref()?;
    let rocks = || scene.rocks.iter().map(|entry| entry.name.as_str());
    if rocks().any(|own| own == name) {
        return None;
    }
    let remedy = match nearest(name, rocks()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("add a section {}", section_head("rock", name)),
    };
    let problem = format!("`added_as` names a rock `{name}` that the scene has not");
    Some(Defect::new(&phase.place, problem, remedy))
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
    if let Some(defect) = twice(groups, name, dimension, place) {
        return Err(defect);
    }
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

/// What is wrong if several groups of a dimension have one name: none of them is meant more than
/// the others.
fn twice(groups: &[Group], name: &str, dimension: usize, place: &str) -> Option<Defect> {
    let tags = repeated_name(groups, name, dimension)?;
    let kind = kind(dimension);
    Some(Defect::new(
        place,
        format!(
            "{} physical {kind}s are called `{name}`, with the numbers {}",
            tags.len(),
            sample(&tags)
        ),
        format!("let one physical {kind} hold the elements of all, or give each a name of its own"),
    ))
}

/// The numbers of the groups of a dimension and a name, if there are several.
pub fn repeated_name(groups: &[Group], name: &str, dimension: usize) -> Option<Vec<u64>> {
    let own = groups
        .iter()
        .filter(|g| g.dimension == dimension && g.name == name);
    let tags: Vec<u64> = own
        .map(|group| u64::from(group.tag.unsigned_abs()))
        .collect();
    (tags.len() > 1).then_some(tags)
}

fn capital(word: &str) -> String {
    let (first, rest) = word.split_at(1);
    first.to_uppercase() + rest
}
