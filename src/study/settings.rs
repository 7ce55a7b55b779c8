//! What a study sweeps: the table `[study]` of a scene, and the product of its dimensions.

use std::path::Path;

use kluft_keys::Document;
use kluft_mesh::{Defect, nearest};
use toml::{Spanned, Table, Value};

use super::dimension::{SweepDimension, SweepKind};
use super::edits::Edit;
use super::sweep;
use super::values::fractures;
use kluft_scene::Scene;
use kluft_scene::reader::{Section, Source};

/// Keys that hold the path of a file, wherever they stand.
const PATHS: [&str; 2] = ["geometry", "file"];

/// Most settings of a study; more are taken for a slip.
const MOST_SETTINGS: usize = 2000;

/// A point of the product.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Setting {
    /// Number of its choice in each dimension.
    pub(super) choices: Vec<usize>,
    /// Its folder: a number and its labels.
    pub(super) folder: String,
    /// Cost against that of the scene itself, roughly.
    pub(super) cost: f64,
}

/// What is charted.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct StudyRequest {
    /// Name of the measure; none for the first that serves.
    pub(super) measure: Option<String>,
    /// Its fracture.
    pub(super) fracture: Option<String>,
    /// Label of the closure whose limit is the reference of all.
    pub(super) reference: Option<String>,
    /// File and line.
    pub(super) place: String,
}

/// A study as the scene describes it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StudyPlan {
    /// The scene without `[study]`, its paths absolute.
    pub(super) scene: Table,
    /// What is swept.
    pub(super) dimensions: Vec<SweepDimension>,
    /// The product, cheapest first.
    pub(super) settings: Vec<Setting>,
    /// What is charted.
    pub(super) request: StudyRequest,
}

impl StudyPlan {
    /// Reads the study of a scene.
    ///
    /// # Errors
    /// Every defect of the scene or of `[study]`.
    pub(super) fn read(file: &Path, text: &str) -> Result<Self, Vec<Defect>> {
        Scene::parse_file(file, text)?;
        let name = file.display().to_string();
        let unreadable =
            |error: toml::de::Error| vec![Defect::new(&*name, error.message(), "correct the TOML")];
        let mut scene: Table = text.parse().map_err(unreadable)?;
        let folder = file.parent().unwrap_or(Path::new("."));
        make_paths_absolute(&mut scene, folder).map_err(|defect| vec![defect])?;
        let asked = scene.remove("study");
        let asked = asked.as_ref().and_then(Value::as_table);
        let source = Source::new(&name, text, Document::Scene);
        let table = source.parse();
        let root = table
            .as_ref()
            .map(|table| Section::root(&source, table.get_ref()));
        let section = root.as_ref().and_then(|root| root.section("study"));
        let (dimensions, request) = match (section, asked) {
            (Some(section), Some(asked)) => read_study(&source, section, asked, &scene),
            _ => (sweep::by_default(&scene, &name)?, StudyRequest::default()),
        };
        let defects = source.into_defects();
        if !defects.is_empty() {
            return Err(defects);
        }
        let counts = dimensions.iter().map(|dimension| dimension.choices.len());
        let count = counts.fold(1, usize::saturating_mul);
        if count > MOST_SETTINGS {
            let problem = format!("the study has {count} settings, more than {MOST_SETTINGS}");
            return Err(vec![Defect::new(name, problem, "sweep less at a time")]);
        }
        let plan = Self {
            settings: product(&dimensions),
            scene,
            dimensions,
            request,
        };
        let defects = defects_of(&plan, &name);
        defects.is_empty().then_some(plan).ok_or(defects)
    }

    /// Everything that a setting changes.
    pub(super) fn edits(&self, setting: &Setting) -> Vec<Edit> {
        let chosen = self.dimensions.iter().zip(&setting.choices);
        chosen
            .flat_map(|(dimension, &choice)| dimension.choices[choice].edits.clone())
            .collect()
    }

    /// The scene of a setting.
    pub(super) fn scene_of(&self, setting: &Setting) -> Table {
        let mut scene = self.scene.clone();
        for edit in self.edits(setting) {
            edit.apply(&mut scene);
        }
        scene
    }

    /// Label of a setting in a dimension.
    pub(super) fn label(&self, setting: &Setting, dimension: usize) -> &str {
        &self.dimensions[dimension].choices[setting.choices[dimension]].label
    }

    /// The labels of a setting in dimensions of some kinds; dimensions with one choice say nothing.
    pub(super) fn name(&self, setting: &Setting, kinds: impl Fn(SweepKind) -> bool) -> String {
        let told = self.dimensions.iter().enumerate();
        let told =
            told.filter(|(_, dimension)| dimension.choices.len() > 1 && kinds(dimension.kind));
        let labels: Vec<&str> = told.map(|(i, _)| self.label(setting, i)).collect();
        labels.join(", ")
    }

    /// The choices of a setting in dimensions of some kinds: equal for settings that differ in
    /// others only.
    pub(super) fn key(&self, setting: &Setting, kinds: impl Fn(SweepKind) -> bool) -> Vec<usize> {
        let chosen = self.dimensions.iter().zip(&setting.choices);
        let chosen = chosen.filter(|(dimension, _)| kinds(dimension.kind));
        chosen.map(|(_, &choice)| choice).collect()
    }
}

fn read_study(
    source: &Source<'_>,
    section: Section<'_, '_>,
    asked: &Table,
    scene: &Table,
) -> (Vec<SweepDimension>, StudyRequest) {
    let dimensions = sweep::read(&section, asked, scene);
    let text = |key| section.text(key).map(str::to_owned);
    let request = StudyRequest {
        measure: text("measure"),
        fracture: text("fracture"),
        reference: text("reference"),
        place: place_of_request(source, &section),
    };
    let closures = dimensions.iter().filter(|d| d.kind == SweepKind::Closure);
    let labels: Vec<&str> = closures
        .flat_map(|dimension| &dimension.choices)
        .map(|choice| choice.label.as_str())
        .collect();
    if let Some(name) = &request.reference
        && !labels.contains(&name.as_str())
    {
        let problem = format!("no entry of `closures` has the label \"{name}\"");
        let remedy = format!("write one of: {}", labels.join(", "));
        section.refuse("reference", problem, remedy);
    }
    check_fracture(&section, request.fracture.as_deref(), scene);
    section.finish();
    (dimensions, request)
}

/// File and line of what is to be charted.
fn place_of_request(source: &Source<'_>, section: &Section<'_, '_>) -> String {
    let mut keys = ["measure", "fracture"].into_iter();
    let value = keys.find_map(|key| section.table().get(key));
    source.place(&value.map_or(section.at.clone(), Spanned::span))
}

/// Refuses a fracture that is none of the scene, where the scene names them all.
fn check_fracture(section: &Section<'_, '_>, wanted: Option<&str>, scene: &Table) {
    let names: Vec<&str> = fractures(scene).map(|(name, _)| name.as_str()).collect();
    let names_all = !names.is_empty() && !names.contains(&"default");
    let Some(wanted) = wanted.filter(|wanted| names_all && !names.contains(wanted)) else {
        return;
    };
    let near = nearest(wanted, names.iter().copied());
    let near = near.map_or_else(String::new, |near| format!("did you mean \"{near}\"? "));
    let problem = format!("the scene has no fracture `{wanted}`");
    let remedy = format!("{near}the scene has: {}", names.join(", "));
    section.refuse("fracture", problem, remedy);
}

/// Makes the paths of files absolute, wherever they stand: scenes of the settings lie in other
/// folders.
fn make_paths_absolute(table: &mut Table, folder: &Path) -> Result<(), Defect> {
    for (key, value) in table.iter_mut() {
        match value {
            Value::String(path) if PATHS.contains(&key.as_str()) => make_absolute(path, folder)?,
            other => make_absolute_below(other, folder)?,
        }
    }
    Ok(())
}

/// The same for all tables in a value.
fn make_absolute_below(value: &mut Value, folder: &Path) -> Result<(), Defect> {
    match value {
        Value::Table(table) => make_paths_absolute(table, folder),
        Value::Array(array) => {
            let mut entries = array.iter_mut();
            entries.try_for_each(|entry| make_absolute_below(entry, folder))
        }
        _ => Ok(()),
    }
}

fn make_absolute(path: &mut String, folder: &Path) -> Result<(), Defect> {
    let beside = folder.join(&*path);
    // One that is not there is refused by the runs.
    let absolute = std::path::absolute(&beside).unwrap_or(beside);
    *path = absolute.into_os_string().into_string().map_err(|other| {
        let problem = "a study needs a folder whose name is UTF-8";
        let remedy = "rename the folder, or move the scene and its files to another one";
        Defect::new(other.display().to_string(), problem, remedy)
    })?;
    Ok(())
}

/// Defects of the choices under which no setting is a scene, so that a slip costs no run.
fn defects_of(plan: &StudyPlan, name: &str) -> Vec<Defect> {
    let parse = |setting: &Setting| {
        let place = format!("{name}, [study] {}", plan.name(setting, |_| true));
        let text = plan.scene_of(setting).to_string();
        // Lines of a text that nobody has written are no help.
        let found = Scene::parse(&text, &place, Path::new("")).err()?;
        let found = found.into_iter().map(|defect| Defect {
            place: place.clone(),
            ..defect
        });
        Some(found.collect())
    };
    let found: Vec<Option<Vec<Defect>>> = plan.settings.iter().map(parse).collect();
    let mut defects: Vec<Defect> = Vec::new();
    for (i, dimension) in plan.dimensions.iter().enumerate() {
        for choice in 0..dimension.choices.len() {
            let own = plan.settings.iter().zip(&found);
            let mut own = own.filter(|(setting, _)| setting.choices[i] == choice);
            let first = own.next().and_then(|(_, found)| found.as_ref());
            let Some(first) = first.filter(|_| own.all(|(_, found)| found.is_some())) else {
                continue;
            };
            let is_new = |defect: &&Defect| defects.iter().all(|d| d.problem != defect.problem);
            let new: Vec<Defect> = first.iter().filter(is_new).cloned().collect();
            defects.extend(new);
        }
    }
    defects
}

/// All combinations, cheapest first; numbered in the order of the dimensions.
fn product(dimensions: &[SweepDimension]) -> Vec<Setting> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for dimension in dimensions {
        let count = dimension.choices.len();
        let longer = |choices: Vec<usize>| {
            (0..count).map(move |choice| [choices.as_slice(), &[choice]].concat())
        };
        all = all.into_iter().flat_map(longer).collect();
    }
    let setting = |(number, choices): (usize, Vec<usize>)| {
        let chosen = || dimensions.iter().zip(&choices);
        let labels = chosen().filter(|(dimension, _)| dimension.choices.len() > 1);
        let labels = labels.map(|(dimension, &choice)| dimension.choices[choice].label.as_str());
        let labels: Vec<&str> = labels.collect();
        Setting {
            folder: folder(number + 1, &labels.join("-")),
            cost: chosen()
                .map(|(d, &choice)| d.choices[choice].cost)
                .product(),
            choices,
        }
    };
    let mut settings: Vec<Setting> = all.into_iter().enumerate().map(setting).collect();
    settings.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    settings
}

/// A name that any file system takes.
fn folder(number: usize, labels: &str) -> String {
    let plain = |c: char| match c {
        c if c.is_ascii_alphanumeric() || "._+-".contains(c) => c,
        _ => '_',
    };
    let name: String = labels.chars().map(plain).take(60).collect();
    format!("{number:03}-{name}")
        .trim_end_matches('-')
        .to_owned()
}

#[cfg(test)]
mod tests;
