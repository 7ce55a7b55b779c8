//! Physical groups: how many elements they hold and what the scene makes of them.

use kluft_keys::section_head;
use kluft_mesh::{Draft, SurfaceRole, sample};
use kluft_solver::{SpringStiffness, Support, SurfaceLoad};

use super::findings::GroupFinding;
use kluft_scene::{BoundaryEntry, LoadEntry, Scene, repeated_name};

/// What is said of a mesh that names no volumes or no surfaces, and how names are made.
pub fn missing(draft: &Draft) -> Option<String> {
    let has = |dimension| {
        draft
            .groups
            .iter()
            .any(|group| group.dimension == dimension)
    };
    let surfaces = "`Physical Surface(\"NAME\") = {...};` for each fracture, support and load";
    match (has(3), has(2)) {
        (_, true) => None,
        (true, false) => Some(format!(
            "the mesh has no physical surfaces, so a scene can name no fracture and no boundary: \
             add to the geometry {surfaces}"
        )),
        (false, false) => Some(format!(
            "the mesh has no physical groups, so a scene can name no rock, fracture or boundary: \
             add to the geometry `Physical Volume(\"rock\") = {{...}};` and {surfaces}"
        )),
    }
}

/// What is said of names that several groups of one dimension have.
pub fn repeated(draft: &Draft) -> Vec<String> {
    let mut told = Vec::new();
    for group in draft.groups.iter().filter(|group| group.dimension >= 2) {
        let kind = match group.dimension {
            2 => "surfaces",
            _ => "volumes",
        };
        let tags = repeated_name(&draft.groups, &group.name, group.dimension);
        let text = tags.map(|tags| {
            format!(
                "{} physical {kind} are called `{}`, with the numbers {}: a scene cannot name one of \
                 them; let one group hold the elements of all, or give each a name of its own",
                tags.len(),
                group.name,
                sample(&tags)
            )
        });
        told.extend(text.filter(|text| !told.contains(text)));
    }
    told
}

/// All groups; without roles (the scene names groups that are not there) the surfaces' are unknown.
pub fn list(
    draft: &Draft,
    inner: &[bool],
    roles: Option<&[SurfaceRole]>,
    scene: Option<&Scene>,
) -> Vec<GroupFinding> {
    let (cells, facets) = (
        draft.group_sizes(&draft.cells),
        draft.group_sizes(&draft.facets),
    );
    // Lines of the plane are surfaces of its cells.
    let raised = usize::from(draft.is_extruded);
    let groups = draft.groups.iter().enumerate();
    groups
        .map(|(index, group)| {
            let (role, detail) = match group.dimension {
                3 => ("rock", rock(scene, &group.name)),
                2 => surface(
                    scene,
                    &group.name,
                    roles.map(|roles| roles[index]),
                    inner[index],
                ),
                _ => ("unused", String::new()),
            };
            GroupFinding {
                name: group.name.clone(),
                dimension: group.dimension - raised.min(group.dimension),
                tag: group.tag,
                elements: match group.dimension {
                    3 => Some(cells[index]),
                    2 => Some(facets[index]),
                    _ => None,
                },
                role,
                detail,
            }
        })
        .collect()
}

fn rock(scene: Option<&Scene>, name: &str) -> String {
    let Some(scene) = scene else {
        return String::new();
    };
    let names = [name, "default"];
    let found = names
        .into_iter()
        .find(|name| scene.rocks.iter().any(|entry| entry.name == *name));
    found.map_or("no rock is given".into(), |name| section_head("rock", name))
}

fn surface(
    scene: Option<&Scene>,
    name: &str,
    role: Option<SurfaceRole>,
    inside: bool,
) -> (&'static str, String) {
    let side = if inside {
        "inside the rock"
    } else {
        "on the outside"
    };
    let guessed = |text: &str| match scene {
        None => format!("guessed: {text}"),
        Some(_) => String::new(),
    };
    match role {
        None => ("unknown", side.into()),
        Some(SurfaceRole::Fracture) => ("fracture", guessed("rock on both sides")),
        Some(SurfaceRole::Boundary) => {
            let entry = scene.and_then(|scene| {
                let mut entries = scene.boundaries.iter();
                entries.find(|entry| entry.name == name)
            });
            let acts = entry.map(|entry| what_acts(&entry.value));
            (
                "boundary",
                acts.unwrap_or_else(|| guessed("no rock behind it")),
            )
        }
        Some(SurfaceRole::Unused) if inside => ("welded", "not named in the scene".into()),
        Some(SurfaceRole::Unused) => ("free", "not named in the scene".into()),
    }
}

fn what_acts(entry: &BoundaryEntry) -> String {
    let load = entry.load.as_ref().map(|load| match load {
        LoadEntry::Uniform(SurfaceLoad::Pressure(p)) => format!("pressure {p} Pa"),
        LoadEntry::Uniform(SurfaceLoad::Traction(t)) => {
            format!("traction ({}, {}, {}) Pa", t.x, t.y, t.z)
        }
        LoadEntry::Varying(load) => {
            let fields = load.fields.iter();
            let fields = fields.map(|field| format!("{} by {}", field.key, field.origin));
            fields.collect::<Vec<_>>().join(", ")
        }
    });
    let support = entry.support.map(|support| match support {
        Support::Symmetry => "symmetry".to_owned(),
        Support::Displacement(components) => {
            let varies = |axis: usize| {
                let mut fields = entry.displacement_fields.iter();
                fields.find(|(own, _)| *own == axis).map(|(_, field)| field)
            };
            let named = ["x", "y", "z"].into_iter().zip(components).enumerate();
            let parts = named.filter_map(|(index, (axis, value))| match varies(index) {
                Some(field) => Some(format!("{axis} by {}", field.origin)),
                None => Some(format!("{axis} = {} m", value?)),
            });
            format!("displacement {}", parts.collect::<Vec<_>>().join(", "))
        }
    });
    let springs = entry.springs.as_ref().map(|springs| {
        let fields = springs.fields.iter();
        let fields: Vec<String> = fields
            .map(|field| format!("{} by {}", field.key, field.origin))
            .collect();
        match (&springs.stiffness, fields.is_empty()) {
            (SpringStiffness::Outside { .. }, _) => "springs of unbounded rock".to_owned(),
            (_, true) => "springs".to_owned(),
            (_, false) => fields.join(", "),
        }
    });
    let points = entry.history.as_ref().map(|history| history.points.len());
    let history = points.map(|count| format!("history of {count} points"));
    [load, support, springs, history]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join("; ")
}
