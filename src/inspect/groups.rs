//! Physical groups: how many elements they hold and what the scene makes of them.

use kluft_keys::section_head;
use kluft_mesh::{Draft, SurfaceRole, sample};
use kluft_solver::{SpringStiffness, Support, SurfaceLoad};

use super::findings::GroupFinding;
use kluft_scene::{BoundaryEntry, LoadEntry, Roles, Scene, repeated_name};

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
            "the mesh has no physical surfaces, so a scene can name no fracture, and boundaries \
             by their place only (`where`): add to the geometry {surfaces}"
        )),
        (false, false) => Some(format!(
            "the mesh has no physical groups, so a scene can name no rock and no fracture, and \
             boundaries by their place only (`where`): add to the geometry `Physical Volume(\"rock\") = {{...}};` and {surfaces}"
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

/// What groups are.
#[derive(Clone, Copy)]
pub struct GroupRoles<'a> {
    pub of_group: &'a [SurfaceRole],
    /// Whether all of a group belongs to a fracture that is another; empty if no group does.
    pub on_fracture: &'a [bool],
}

impl<'a> GroupRoles<'a> {
    /// What a scene makes of them.
    pub fn of(roles: &'a Roles) -> Self {
        Self {
            of_group: &roles.of_group,
            on_fracture: &roles.on_fracture,
        }
    }

    /// What they are likely to be, without a scene.
    pub fn guessed(of_group: &'a [SurfaceRole]) -> Self {
        Self {
            of_group,
            on_fracture: &[],
        }
    }
}

/// All groups; without roles (the scene names groups that are not there) the surfaces' are unknown.
pub fn list(
    draft: &Draft,
    inner: &[bool],
    roles: Option<GroupRoles<'_>>,
    scene: Option<&Scene>,
) -> Vec<GroupFinding> {
    let (cells, facets) = (
        draft.group_sizes(&draft.cells),
        draft.group_sizes(&draft.facets),
    );
    // Lines of the plane are surfaces of its cells.
    let raised = usize::from(draft.is_extruded);
    let place = |index: usize| {
        let on_fracture = roles.is_some_and(|roles| roles.on_fracture.get(index) == Some(&true));
        match (inner[index], on_fracture) {
            (false, _) => Place::Outside,
            (true, false) => Place::Inside,
            (true, true) => Place::OnFracture,
        }
    };
    let groups = draft.groups.iter().enumerate();
    groups
        .map(|(index, group)| {
            let (role, detail) = match group.dimension {
                3 => ("rock", rock(scene, &group.name)),
                2 => surface(
                    scene,
                    &group.name,
                    roles.map(|roles| roles.of_group[index]),
                    place(index),
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

/// Where a surface lies.
#[derive(Clone, Copy)]
enum Place {
    Outside,
    Inside,
    /// Inside, and all of it on a fracture that is another group.
    OnFracture,
}

fn surface(
    scene: Option<&Scene>,
    name: &str,
    role: Option<SurfaceRole>,
    place: Place,
) -> (&'static str, String) {
    let side = match place {
        Place::Outside => "on the outside",
        Place::Inside | Place::OnFracture => "inside the rock",
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
        Some(SurfaceRole::Unused) => {
            let role = match place {
                Place::Outside => "free",
                Place::Inside => "welded",
                Place::OnFracture => "on fracture",
            };
            (role, "not named in the scene".into())
        }
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
