//! The dimensions of a study: what `[study]` says, or what is swept without it.

use kluft_keys::scene::CLOSURES;
use kluft_mesh::Defect;
use toml::{Table, Value};

use super::dimension::{Choice, SweepDimension, SweepKind};
use super::edits::Edit;
use super::values::{fractures, values_of};
use kluft_scene::reader::{Entry, Section};
use kluft_scene::refused_keys;

/// Factors on cell sizes of a study that the scene does not describe.
const SIZES: [f64; 3] = [2.0, 1.4, 1.0];

/// Keys of `[study]` that hold lists.
const LISTS: [&str; 8] = [
    "meshes",
    "tolerances",
    "refinements",
    "orders",
    "quarter_points",
    "closures",
    "facets",
    "solvers",
];

/// Reads what `[study]` sweeps; `asked` is the same table as values.
pub(super) fn read(section: &Section<'_, '_>, asked: &Table, scene: &Table) -> Vec<SweepDimension> {
    let lists = [
        refinements(section, scene),
        tolerances(section, scene),
        meshes(section, scene),
    ];
    let given = lists.into_iter().find(|list| !list.is_empty());
    let meshes = given.unwrap_or_default();
    let orders = orders(section, scene);
    let fronts = fronts(section, &orders, scene);
    let mut dimensions = vec![
        ("mesh", SweepKind::Mesh, meshes),
        ("order", SweepKind::Order, orders),
        ("quarter_points", SweepKind::Fronts, fronts),
        (
            "closure",
            SweepKind::Closure,
            closures(section, asked, scene),
        ),
    ];
    let swept = values_of(section, scene);
    for (name, choices) in &swept {
        dimensions.push((name, SweepKind::Value, choices.clone()));
    }
    let named = |key, path: &[&str]| {
        let names = section.choices(key).unwrap_or_default();
        let choice = |name| Choice::new(name, vec![Edit::set(path, name)]);
        names.into_iter().map(choice).collect::<Vec<_>>()
    };
    let facets = named("facets", &["solver", "facets"]);
    let solvers = named("solvers", &["solver", "linear"]);
    dimensions.push(("facets", SweepKind::Facets, facets));
    dimensions.push(("solver", SweepKind::Solver, solvers));
    for key in LISTS {
        let is_empty = asked
            .get(key)
            .and_then(Value::as_array)
            .is_some_and(Vec::is_empty);
        if is_empty {
            let remedy = "write at least one entry, or leave the key out";
            section.refuse(key, format!("`{key}` in [study] is empty"), remedy);
        }
    }
    let dimension = |(name, kind, choices): (&str, SweepKind, Vec<Choice>)| SweepDimension {
        name: name.to_owned(),
        kind,
        choices: match choices.is_empty() {
            true => vec![Choice::new(own(kind, scene), Vec::new())],
            false => distinct(choices),
        },
    };
    dimensions.into_iter().map(dimension).collect()
}

/// What is swept where the scene has no `[study]`: cell sizes and orders.
///
/// # Errors
/// If the scene has no cell size that could be swept.
pub(super) fn by_default(scene: &Table, name: &str) -> Result<Vec<SweepDimension>, Vec<Defect>> {
    let sizes = own_sizes(scene);
    if sizes.is_empty() {
        let problem = "there is no [study], and [mesh] parameters have no cell size `h` to sweep";
        let remedy = "add a section [study], e.g. meshes = [{ h = 0.2 }, { h = 0.1 }]; `kluft study --help` shows all keys";
        return Err(vec![Defect::new(name, problem, remedy)]);
    }
    let scaled = |factor: f64| -> Vec<(String, f64)> {
        let scaled = |(name, size): &(String, f64)| (name.clone(), rounded(factor * size));
        sizes.iter().map(scaled).collect()
    };
    let meshes = SIZES.map(scaled);
    let choices = meshes.iter().map(|mesh| mesh_choice(mesh, &meshes, scene));
    Ok(vec![
        SweepDimension {
            name: "mesh".into(),
            kind: SweepKind::Mesh,
            choices: choices.collect(),
        },
        SweepDimension {
            name: "order".into(),
            kind: SweepKind::Order,
            choices: [1, 2].into_iter().map(order_choice).collect(),
        },
    ])
}

/// To the digits that matter in a size.
fn rounded(size: f64) -> f64 {
    format!("{size:.6e}").parse().unwrap_or(size)
}

/// The cell sizes among the parameters of the mesh.
fn own_sizes(scene: &Table) -> Vec<(String, f64)> {
    let parameters = scene.get("mesh").and_then(|mesh| mesh.get("parameters"));
    let parameters = parameters.and_then(Value::as_table);
    let sizes = parameters.into_iter().flatten();
    let sizes = sizes.filter(|(name, _)| is_size(name));
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|n| n as f64));
    sizes
        .filter_map(|(name, value)| Some((name.clone(), number(value)?)))
        .collect()
}

fn is_size(name: &str) -> bool {
    name == "h" || name.starts_with("h_")
}

fn meshes(section: &Section<'_, '_>, scene: &Table) -> Vec<Choice> {
    let wanted = "parameters of the mesh in braces, e.g. meshes = [{ h = 0.2 }, { h = 0.1 }]";
    let mut meshes = Vec::new();
    for entry in section.entries("meshes", wanted) {
        match entry {
            Entry::Section(entry) => meshes.push(entry.all_numbers()),
            Entry::Text(text) => {
                let problem = format!("`meshes` in [study] holds the text \"{text}\"");
                section.refuse("meshes", problem, format!("write {wanted}"));
            }
        }
    }
    let choices = meshes.iter().map(|mesh| mesh_choice(mesh, &meshes, scene));
    choices.collect()
}

/// A mesh among others; only what differs is in its label. Cells grow in number with the third
/// power of what their size shrinks by.
fn mesh_choice(mesh: &[(String, f64)], all: &[Vec<(String, f64)>], scene: &Table) -> Choice {
    let own = own_sizes(scene);
    let finer = |(name, size): &(String, f64)| {
        let own = own.iter().find(|(own, _)| own == name);
        own.map_or(1.0, |(_, own)| *own) / size
    };
    let sizes = || mesh.iter().filter(|(name, _)| is_size(name));
    let finest = sizes().map(finer).reduce(f64::max);
    let differs = |entry: &&(String, f64)| !all.iter().all(|other| other.contains(entry));
    let told = mesh.iter().filter(|entry| all.len() == 1 || differs(entry));
    let labels: Vec<String> = told
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    let set = |(name, value): &(String, f64)| Edit::set(&["mesh", "parameters", name], *value);
    Choice {
        number: sizes().next().map(|(_, size)| *size),
        cost: finest.unwrap_or(1.0).abs().powi(3),
        ..Choice::new(&labels.join(" "), mesh.iter().map(set).collect())
    }
}

/// Meshes that follow the estimated error until it is below a tolerance. The error falls about
/// with the second power of the cell size, their number grows with the third power of its inverse.
fn tolerances(section: &Section<'_, '_>, scene: &Table) -> Vec<Choice> {
    let tolerances = section.numbers("tolerances").unwrap_or_default();
    if section.has("tolerances") && section.has("meshes") {
        let problem = "both `meshes` and `tolerances` are given in [study]".into();
        let remedy = "keep one: a mesh that follows the estimated error has sizes of its own";
        section.refuse("tolerances", problem, remedy);
    }
    let own = scene.get("mesh").and_then(|mesh| mesh.get("adapt"));
    let own = own.and_then(|adapt| adapt.get("tolerance"));
    let own = own.and_then(Value::as_float);
    let largest = tolerances.iter().copied().fold(0.0, f64::max);
    let choice = |tolerance: f64| Choice {
        cost: (own.unwrap_or(largest) / tolerance).powf(1.5),
        ..Choice::new(
            &format!("tolerance={tolerance}"),
            vec![Edit::set(&["mesh", "adapt", "tolerance"], tolerance)],
        )
    };
    tolerances.into_iter().map(choice).collect()
}

/// The mesh of the scene with its cells divided again and again: nested meshes.
fn refinements(section: &Section<'_, '_>, scene: &Table) -> Vec<Choice> {
    let times = section.numbers("refinements").unwrap_or_default();
    if times.iter().any(|times| times.fract() != 0.0) {
        let remedy = "write refinements = [0, 1, 2]";
        let problem = "cells are divided a whole number of times".into();
        section.refuse("refinements", problem, remedy);
    }
    for other in ["meshes", "tolerances"] {
        if section.has("refinements") && section.has(other) {
            let problem = format!("both `{other}` and `refinements` are given in [study]");
            let remedy = "keep one: `refinements` divides the cells of the one mesh of the scene";
            section.refuse("refinements", problem, remedy);
        }
    }
    let own = scene.get("mesh").and_then(|mesh| mesh.get("refine"));
    let own = own.and_then(Value::as_integer).unwrap_or(0) as f64;
    let sizes = own_sizes(scene);
    // Of a mesh whose cell size has no name, a share of it.
    let size = sizes.first().map_or(1.0, |(_, size)| *size);
    let choice = |times: f64| Choice {
        number: Some(size / times.exp2()),
        cost: 8.0_f64.powf(times - own),
        ..Choice::new(
            &format!("refine={times}"),
            vec![Edit::set(&["mesh", "refine"], times as i64)],
        )
    };
    times.into_iter().map(choice).collect()
}

fn orders(section: &Section<'_, '_>, scene: &Table) -> Vec<Choice> {
    let orders = section.numbers("orders");
    let orders = orders.unwrap_or_default();
    if orders.iter().any(|order| order.fract() != 0.0) {
        let remedy = "write orders = [1, 2]";
        section.refuse("orders", "elements have order 1 or 2".into(), remedy);
    }
    for key in ["meshes", "tolerances", "orders"] {
        if is_of_file(scene) && section.has(key) {
            let problem = format!("`{key}` has no effect on a mesh file");
            let remedy = "remove it, or give the geometry instead of the file in [mesh]";
            section.refuse(key, problem, remedy);
        }
    }
    orders
        .into_iter()
        .map(|order| order_choice(order as i64))
        .collect()
}

/// Whether the mesh is read and not made.
fn is_of_file(scene: &Table) -> bool {
    let mesh = scene.get("mesh");
    mesh.is_some_and(|mesh| mesh.get("file").is_some())
}

/// Elements of second order have about eight times the nodes.
fn order_choice(order: i64) -> Choice {
    Choice {
        number: Some(order as f64),
        cost: (order as f64).powi(3),
        ..Choice::new(
            &format!("order {order}"),
            vec![Edit::set(&["mesh", "order"], order)],
        )
    }
}

/// Cells of first order have no points to move; a mesh file may hold any.
fn fronts(section: &Section<'_, '_>, orders: &[Choice], scene: &Table) -> Vec<Choice> {
    let flags = section.flags("quarter_points").unwrap_or_default();
    let has_second = match orders {
        [] => own(SweepKind::Order, scene) == "order 2" || is_of_file(scene),
        orders => orders.iter().any(|order| order.number == Some(2.0)),
    };
    if !flags.is_empty() && !has_second {
        let problem = "`quarter_points` has no effect on cells of order 1".into();
        let remedy = "write orders = [2] in [study], or order = 2 in [mesh]";
        section.refuse("quarter_points", problem, remedy);
    }
    let choice = |flag| {
        let label = match flag {
            true => "quarter points",
            false => "no quarter points",
        };
        Choice::new(label, vec![Edit::set(&["mesh", "quarter_points"], flag)])
    };
    flags.into_iter().map(choice).collect()
}

fn closures(section: &Section<'_, '_>, asked: &Table, scene: &Table) -> Vec<Choice> {
    let wanted = "names of closure laws or keys of fractures in braces, e.g. closures = [\"contact\", { label = \"cut\", cutoff_aperture = 1e-6 }]";
    let values = asked.get("closures").and_then(Value::as_array);
    let entries = section.entries("closures", wanted).into_iter();
    let entries = entries.zip(values.into_iter().flatten());
    let mut choices = Vec::new();
    for (entry, value) in entries {
        match entry {
            Entry::Text(name) => {
                let keys = Table::from_iter([("closure".to_owned(), Value::from(name))]);
                choices.push((name.to_owned(), keys));
            }
            Entry::Section(entry) => {
                let label = entry.text("label").map(str::to_owned);
                let mut keys = value.as_table().cloned().unwrap_or_default();
                keys.remove("label");
                choices.push((label.unwrap_or_else(|| label_of(&keys)), keys));
            }
        }
    }
    for (_, keys) in &choices {
        let name = keys.get("closure").and_then(Value::as_str);
        if let Some(name) = name.filter(|name| !CLOSURES.contains(name)) {
            let problem = format!("unknown closure law \"{name}\"");
            let remedy = format!("write one of {}", CLOSURES.join(", "));
            section.refuse("closures", problem, remedy);
        }
    }
    let choice = |(label, keys): (String, Table)| Choice::new(&label, closure_edits(&keys, scene));
    let choices: Vec<Choice> = choices.into_iter().map(choice).collect();
    refuse_one_law_twice(section, &choices);
    choices
}

/// Refuses one law under two labels: the second would be missing in all tables and charts.
fn refuse_one_law_twice(section: &Section<'_, '_>, choices: &[Choice]) {
    for (i, choice) in choices.iter().enumerate() {
        let is_same = |other: &&Choice| {
            !choice.edits.is_empty() && other.edits == choice.edits && other.label != choice.label
        };
        if let Some(other) = choices[..i].iter().find(is_same) {
            let problem = format!("\"{}\" and \"{}\" are one law", other.label, choice.label);
            section.refuse(
                "closures",
                problem,
                "remove one of them, or correct its keys",
            );
        }
    }
}

fn label_of(keys: &Table) -> String {
    let labels = keys.iter().map(|(key, value)| match value {
        Value::String(text) if key == "closure" => text.clone(),
        Value::String(text) => format!("{key}={text}"),
        value => format!("{key}={value}"),
    });
    labels.collect::<Vec<_>>().join(" ")
}

/// Keys of all fractures; what a new law would refuse goes away, and what is `false`.
fn closure_edits(keys: &Table, scene: &Table) -> Vec<Edit> {
    let is_off = |value: &Value| *value == Value::Boolean(false);
    let mut edits = Vec::new();
    for (name, fracture) in fractures(scene) {
        if let Some(law) = keys.get("closure").and_then(Value::as_str) {
            let angle = keys.get("friction_angle");
            let angle = angle.or(fracture.get("friction_angle"));
            let has_friction = angle.is_some_and(|angle| !is_off(angle));
            let refused = refused_keys(law, has_friction).into_iter();
            let refused = refused.filter(|key| fracture.get(key).is_some());
            edits.extend(refused.map(|key| Edit::remove(&["fracture", name, key])));
        }
        edits.extend(keys.iter().map(|(key, value)| match is_off(value) {
            true => Edit::remove(&["fracture", name, key]),
            false => Edit::set(&["fracture", name, key], value.clone()),
        }));
    }
    edits
}

/// What the scene itself has in a dimension.
fn own(kind: SweepKind, scene: &Table) -> &'static str {
    let order = scene.get("mesh").and_then(|mesh| mesh.get("order"));
    match kind {
        SweepKind::Order if order.and_then(Value::as_integer) == Some(2) => "order 2",
        SweepKind::Order => "order 1",
        SweepKind::Mesh
        | SweepKind::Fronts
        | SweepKind::Closure
        | SweepKind::Value
        | SweepKind::Facets
        | SweepKind::Solver => "as in the scene",
    }
}

/// Equal entries are one; others with the same label get a number.
fn distinct(choices: Vec<Choice>) -> Vec<Choice> {
    let mut found: Vec<Choice> = Vec::new();
    for mut choice in choices {
        if found.iter().any(|other| other.edits == choice.edits) {
            continue;
        }
        let alike = found
            .iter()
            .filter(|other| other.label == choice.label)
            .count();
        if alike > 0 {
            choice.label = format!("{} ({})", choice.label, alike + 1);
        }
        found.push(choice);
    }
    found
}
