//! Boundary conditions of a project of OpenGeoSys as sections of boundaries and fixed points.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use kluft_keys::{quoted, section_head};
use kluft_mesh::Draft;

use super::extent::Extent;
use super::parameters::{Parameters, vector};
use super::said::Said;
use super::surfaces::{Part, part_of_mesh, read_geometry};
use super::tree::Element;

const AXES: [&str; 3] = ["x", "y", "z"];

/// What one curve does to one part of the surface.
#[derive(Default)]
struct Condition {
    displacement: BTreeMap<usize, f64>,
    traction: BTreeMap<usize, f64>,
    /// Against the outward normal.
    pressure: Option<f64>,
}

/// The parts of the surface that a project names.
struct Named<'a> {
    folder: &'a Path,
    geometry: BTreeMap<String, Extent>,
    body: &'a mut Draft,
    extent: &'a Extent,
}

/// Gravity.
pub fn body(process: &Element, said: &mut Said) {
    let force = process.word("specific_body_force").and_then(vector);
    if let Some(force) = force.filter(|force| force.iter().any(|x| *x != 0.0)) {
        said.scene += &format!("\n[body]\ngravity = {force:?}\n");
    }
}

/// The conditions of all displacements.
pub fn conditions(
    (root, folder): (&Element, &Path),
    (body, extent): (&mut Draft, &Extent),
    parameters: &Parameters,
    said: &mut Said,
) {
    let geometry = root
        .word("geometry")
        .map(|name| read_geometry(&folder.join(name)));
    let geometry = geometry
        .unwrap_or(Ok(BTreeMap::new()))
        .unwrap_or_else(|why| {
            said.notes.push(format!("the geometry is missing: {why}"));
            BTreeMap::new()
        });
    let mut named = Named {
        folder,
        geometry,
        body,
        extent,
    };
    let all = gathered(root, parameters, said);
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut groups = BTreeSet::new();
    for ((place, curve), condition) in &all {
        let count = counts.entry(place.clone()).or_default();
        *count += 1;
        let name = match *count {
            1 => place.clone(),
            count => format!("{place}-{count}"),
        };
        if *count > 1 && groups.contains(place) {
            said.notes.push(format!(
                "no counterpart: a second curve in time on `{place}`, a group of the mesh"
            ));
            continue;
        }
        match named.part(place) {
            Some(part) => {
                if part == Part::Group {
                    groups.insert(place.clone());
                }
                condition.say(&name, &part, &mut said.scene);
                said.scene += &history(curve.as_deref(), parameters);
            }
            None => said.notes.push(format!(
                "no counterpart: `{place}` is not there, or lies along no plane x, y or z and has no \
                 mesh whose nodes are those of the body"
            )),
        }
    }
}

/// What the conditions do, by their places and curves.
fn gathered(
    root: &Element,
    parameters: &Parameters,
    said: &mut Said,
) -> BTreeMap<(String, Option<String>), Condition> {
    let mut all = BTreeMap::new();
    let variables = root.get("process_variables").into_iter();
    for variable in variables.flat_map(|list| list.all("process_variable")) {
        variable.pass_over(&["components", "order", "initial_condition"]);
        let is_jump = variable
            .word("name")
            .is_some_and(|name| name != "displacement");
        let list = variable.get("boundary_conditions").into_iter();
        for condition in list.flat_map(|list| list.all("boundary_condition")) {
            let place = place_of(condition).unwrap_or_default();
            let note = if is_jump {
                jump(condition, &place, parameters)
            } else {
                match take(condition, parameters, &mut all) {
                    Ok(()) => continue,
                    Err(why) => format!("no counterpart: at `{place}`: {why}"),
                }
            };
            said.notes.push(note);
            condition.pass_over(&["type", "parameter", "component", "geometrical_set"]);
        }
    }
    all
}

/// What becomes of a condition on a jump. One that is held needs no counterpart where the
/// displacement is held.
fn jump(condition: &Element, place: &str, parameters: &Parameters) -> String {
    let parameter = condition
        .word("parameter")
        .map(|text| parameters.named(text));
    let is_zero = |values: &[f64]| values.iter().all(|value| *value == 0.0);
    let is_held = condition.word("type") == Some("Dirichlet")
        && matches!(parameter, Some(Ok(found)) if is_zero(&found.values));
    match is_held {
        true => format!("the jump at `{place}` is held where supports are: they hold both walls"),
        false => format!("no counterpart: at `{place}`: a condition on a jump that moves"),
    }
}

/// Where a condition is.
fn place_of(condition: &Element) -> Option<String> {
    let name = condition
        .word("geometry")
        .or_else(|| condition.word("mesh"));
    name.map(str::to_owned)
}

/// Adds a condition to those of its place and curve.
///
/// # Errors
/// Why a scene cannot say it.
fn take(
    condition: &Element,
    parameters: &Parameters,
    all: &mut BTreeMap<(String, Option<String>), Condition>,
) -> Result<(), String> {
    condition.pass_over(&["geometrical_set"]);
    let place = place_of(condition).ok_or("it has no place")?;
    let kind = condition.word("type").unwrap_or_default();
    if !["Dirichlet", "Neumann", "NormalTraction"].contains(&kind) {
        return Err(format!("a condition of type {kind}"));
    }
    let text = condition.word("parameter").ok_or("it has no parameter")?;
    let parameter = parameters.named(text)?;
    let component = condition
        .word("component")
        .and_then(|text| text.parse::<usize>().ok());
    if kind == "NormalTraction" {
        let &[along_normal] = &parameter.values[..] else {
            return Err(format!("`{text}` is no number"));
        };
        all.entry((place, parameter.curve)).or_default().pressure = Some(-along_normal);
        return Ok(());
    }
    let components: Vec<(usize, f64)> = match (component, &parameter.values[..]) {
        (Some(axis), &[value]) if axis < 3 => vec![(axis, value)],
        (None, values) if values.len() <= 3 => values.iter().copied().enumerate().collect(),
        _ => return Err(format!("`{text}` has other components than its place")),
    };
    // What does not move does not care for the time.
    let still = kind == "Dirichlet" && components.iter().all(|(_, value)| *value == 0.0);
    let curve = parameter.curve.filter(|_| !still);
    let own = all.entry((place, curve)).or_default();
    match kind {
        "Dirichlet" => own.displacement.extend(components),
        _ => own.traction.extend(components),
    }
    Ok(())
}

/// The curve that scales a section.
fn history(curve: Option<&str>, parameters: &Parameters) -> String {
    let rows = curve.and_then(|name| parameters.curve(name));
    rows.map_or(String::new(), |rows| format!("history = {rows:?}\n"))
}

impl Named<'_> {
    fn part(&mut self, name: &str) -> Option<Part> {
        if let Some(extent) = self.geometry.get(name) {
            return extent.part(self.extent);
        }
        let path = self.folder.join(format!("{name}.vtu"));
        part_of_mesh(&path, name, (&mut *self.body, self.extent))
    }
}

impl Condition {
    fn say(&self, name: &str, part: &Part, scene: &mut String) {
        let components: Vec<String> = self
            .displacement
            .iter()
            .map(|(&axis, value)| format!("{} = {value:?}", AXES[axis]))
            .collect();
        let displacement = format!("displacement = {{ {} }}\n", components.join(", "));
        match part {
            Part::Point(at) => {
                *scene += &format!(
                    "\n[[fixed_point]]               # {name}\nat = {at:?}\n{displacement}"
                );
            }
            Part::Faces(_) | Part::Group => {
                *scene += &format!("\n{}\n", section_head("boundary", name));
                if let Part::Faces(place) = part {
                    *scene += &format!("where = {}\n", quoted(place));
                }
                if !self.displacement.is_empty() {
                    *scene += &displacement;
                }
                if !self.traction.is_empty() {
                    let at = |axis: usize| self.traction.get(&axis).copied().unwrap_or(0.0);
                    *scene += &format!("traction = {:?}\n", [0, 1, 2].map(at));
                }
                if let Some(pressure) = self.pressure {
                    *scene += &format!("pressure = {pressure:?}\n");
                }
            }
        }
    }
}
