//! How far each setting is from the closed form, or from what finer and finer meshes approach.

use kluft_mesh::{Defect, nearest};

use super::dimension::SweepKind;
use super::point::{Numbers, PointRecord};
use super::reference::{Limit, limit};
use super::settings::{Setting, StudyPlan};
use super::words::{or_the_scene, percent, short};
use kluft_run::Measure;

/// What is charted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Target {
    /// Name of the measure.
    pub(super) name: String,
    /// Its fracture; none for the whole body.
    pub(super) fracture: Option<String>,
    /// Whether closed forms give its errors.
    pub(super) is_compared: bool,
}

/// What settings of one physics are compared with, where there is no closed form.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reference {
    /// The physics: choices of closure and values.
    key: Vec<usize>,
    /// The settings it was extrapolated from.
    pub(super) from: String,
    /// The limit.
    pub(super) limit: Limit,
}

impl Reference {
    /// What it is extrapolated from, and how.
    pub(super) fn in_words(&self) -> String {
        let limit = &self.limit;
        let unsure = percent(limit.uncertainty / limit.value.abs());
        let value = short(limit.value);
        let rate = match limit.rate {
            Some(rate) => format!(
                "extrapolated to {value}, uncertain by {unsure}; differences shrink as cells^−{}",
                short(rate / 3.0)
            ),
            None if limit.uncertainty.is_finite() => format!(
                "the values swing, so the reference is the finest, {value}, uncertain by {unsure}"
            ),
            None => {
                "the values drift: they differ no less from mesh to mesh, so nothing is known of \
                their limit; finer meshes are needed"
                    .to_owned()
            }
        };
        format!("{}: {rate}", self.from)
    }
}

/// What came out of a setting.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Verdict {
    /// Value of the measure, if it is one number.
    pub(super) value: Option<f64>,
    /// What it should be.
    pub(super) reference: Option<f64>,
    /// Error as a share of that.
    pub(super) error: Option<f64>,
    /// Uncertainty of the reference as a share; 0 of a closed form.
    pub(super) uncertainty: f64,
}

impl Verdict {
    /// Largest error it may have.
    pub(super) fn at_most(&self) -> Option<f64> {
        self.error.map(|error| error + self.uncertainty)
    }
}

/// All settings with the same choices but for the mesh, in the order of their unknowns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MeasuredSeries {
    /// What its settings share.
    pub(super) name: String,
    /// Indices of its settings.
    pub(super) settings: Vec<usize>,
}

/// What is known of a study so far.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Assessment {
    /// What is charted; none before a setting was solved.
    pub(super) target: Option<Target>,
    /// What was asked for in its place, if no run so far has it.
    pub(super) missing: Option<Defect>,
    /// What it is compared with, where there is no closed form.
    pub(super) references: Vec<Reference>,
    /// One entry for each setting.
    pub(super) verdicts: Vec<Verdict>,
    /// All settings, by series.
    pub(super) series: Vec<MeasuredSeries>,
    /// Meshes that are one and the same, by their labels.
    pub(super) identical_meshes: Option<String>,
}

/// Assesses what has been run; `records` has an entry for each setting.
pub(super) fn assess(plan: &StudyPlan, records: &[Option<PointRecord>]) -> Assessment {
    let done: Vec<Option<&Numbers>> = records
        .iter()
        .map(|record| record.as_ref().and_then(PointRecord::numbers))
        .collect();
    let (target, missing) = target(plan, &done);
    let extrapolates = target.as_ref().filter(|target| !target.is_compared);
    let references =
        extrapolates.map_or_else(Vec::new, |target| references(plan, records, &done, target));
    let verdict = |(setting, numbers): (&Setting, &Option<&Numbers>)| {
        let measure = numbers.and_then(|numbers| find(numbers, target.as_ref()?));
        let key = reference_key(plan, setting);
        let reference = references.iter().find(|reference| reference.key == key);
        measure.map_or_else(Verdict::default, |measure| judged(measure, reference))
    };
    Assessment {
        verdicts: plan.settings.iter().zip(&done).map(verdict).collect(),
        identical_meshes: identical_meshes(plan, &done),
        series: series(plan, &done),
        target,
        missing,
        references,
    }
}

fn judged(measure: &Measure, reference: Option<&Reference>) -> Verdict {
    let Some(Reference { limit, .. }) = reference else {
        return Verdict {
            value: measure.value,
            reference: measure.exact,
            error: measure.error,
            uncertainty: 0.0,
        };
    };
    let share = |difference: f64| {
        let share = difference.abs() / limit.value.abs();
        Some(share).filter(|share| share.is_finite())
    };
    let uncertainty = share(limit.uncertainty);
    let error = measure.value.and_then(|value| share(value - limit.value));
    Verdict {
        value: measure.value,
        reference: uncertainty.map(|_| limit.value),
        error: uncertainty.and(error),
        uncertainty: uncertainty.unwrap_or(f64::INFINITY),
    }
}

fn find<'a>(numbers: &'a Numbers, target: &Target) -> Option<&'a Measure> {
    let fits =
        |measure: &&Measure| measure.name == target.name && measure.fracture == target.fracture;
    numbers.measures.iter().find(fits)
}

/// What is charted. Where no run has what is asked for, something that serves, and a defect.
fn target(plan: &StudyPlan, done: &[Option<&Numbers>]) -> (Option<Target>, Option<Defect>) {
    let solved = || done.iter().flatten();
    let Some(first) = solved().next() else {
        return (None, None);
    };
    let all: Vec<&Measure> = solved().flat_map(|numbers| &numbers.measures).collect();
    let largest = first.largest_fracture.as_deref();
    let request = &plan.request;
    let asked = (request.measure.as_deref(), request.fracture.as_deref());
    let found = chosen(&all, asked, largest);
    let is_missing = found.is_none() && asked != (None, None);
    let found = found
        .or_else(|| chosen(&all, (None, asked.1), largest))
        .or_else(|| chosen(&all, (None, None), largest));
    let target = found.map(|found| Target {
        name: found.name.clone(),
        fracture: found.fracture.clone(),
        is_compared: all.iter().any(|other| {
            other.name == found.name && other.fracture == found.fracture && other.error.is_some()
        }),
    });
    (target, is_missing.then(|| missing(plan, first)))
}

/// The measure with a name and a fracture, as far as they are given. Without a name, the first with
/// an error; without one, the mean aperture of the fracture or of the largest.
fn chosen<'m>(
    all: &[&'m Measure],
    (name, fracture): (Option<&str>, Option<&str>),
    largest: Option<&str>,
) -> Option<&'m Measure> {
    let on = |measure: &Measure, wanted: Option<&str>| measure.fracture.as_deref() == wanted;
    let mut own = all.to_vec();
    own.retain(|measure| fracture.is_none() || on(measure, fracture));
    let found = match name {
        Some(name) => own.iter().find(|measure| measure.name == name),
        None => {
            let of = fracture.or(largest);
            let mean = || {
                let mut all = own.iter();
                all.find(|measure| measure.name == "mean_aperture" && on(measure, of))
            };
            let compared = own.iter().find(|measure| measure.error.is_some());
            compared.or_else(mean).or(own.first())
        }
    };
    found.copied()
}

/// What is asked for and no run has.
fn missing(plan: &StudyPlan, numbers: &Numbers) -> Defect {
    let request = &plan.request;
    let on = request
        .fracture
        .as_ref()
        .map_or_else(String::new, |name| format!(" on `{name}`"));
    let problem = match &request.measure {
        Some(name) => format!("the runs have no measure `{name}`{on}"),
        None => format!("the runs have no measure{on}"),
    };
    let names = numbers.measures.iter().map(|measure| measure.name.as_str());
    let wanted = request.measure.as_deref();
    let near = wanted.and_then(|wanted| nearest(wanted, names).filter(|near| *near != wanted));
    let near = near.map_or_else(String::new, |near| format!("did you mean \"{near}\"? "));
    let known = numbers
        .measures
        .iter()
        .map(|measure| match &measure.fracture {
            Some(fracture) => format!("{} of {fracture}", measure.name),
            None => measure.name.clone(),
        });
    let known = known.collect::<Vec<_>>().join(", ");
    let remedy = format!("{near}measures of the runs: {known}");
    Defect::new(request.place.as_str(), problem, remedy)
}

/// The physics that a setting is compared with: its own, or that of the closure asked for.
fn reference_key(plan: &StudyPlan, setting: &Setting) -> Vec<usize> {
    let mut setting = setting.clone();
    let closure = plan
        .dimensions
        .iter()
        .position(|d| d.kind == SweepKind::Closure);
    if let (Some(label), Some(closure)) = (&plan.request.reference, closure) {
        let choices = &plan.dimensions[closure].choices;
        let named = choices.iter().position(|choice| choice.label == *label);
        setting.choices[closure] = named.unwrap_or(setting.choices[closure]);
    }
    plan.key(&setting, SweepKind::is_physics)
}

/// The limit of every physics with three meshes of one series: of the highest order, and of the
/// first facet rule and solver that have them. As long as a higher order is still to be run, a
/// lower one says nothing: coarse meshes of first order may settle far from the limit.
fn references(
    plan: &StudyPlan,
    records: &[Option<PointRecord>],
    done: &[Option<&Numbers>],
    target: &Target,
) -> Vec<Reference> {
    let awaited = |series: &MeasuredSeries| {
        let own = &plan.settings[series.settings[0]];
        let same = |setting: &Setting| {
            plan.key(setting, SweepKind::is_physics) == plan.key(own, SweepKind::is_physics)
        };
        let mut all = plan.settings.iter().zip(records);
        all.any(|(setting, record)| {
            record.is_none() && same(setting) && order(plan, setting) > order(plan, own)
        })
    };
    let mut found: Vec<(f64, Reference)> = Vec::new();
    for series in series(plan, done)
        .into_iter()
        .filter(|series| !awaited(series))
    {
        let numbers = series.settings.iter().filter_map(|&i| Some((i, done[i]?)));
        let values = numbers.filter_map(|(i, n)| Some((i, n.cells, find(n, target)?.value?)));
        let values: Vec<(usize, usize, f64)> = values.collect();
        let sizes = values
            .iter()
            .map(|(_, cells, value)| ((*cells as f64).cbrt().recip(), *value));
        let setting = &plan.settings[series.settings[0]];
        let order = order(plan, setting);
        // Numbers that sum up a smooth solution may converge twice as fast; at fronts they do not.
        let Some(limit) = limit(&sizes.collect::<Vec<_>>(), order) else {
            continue;
        };
        let key = plan.key(setting, SweepKind::is_physics);
        let cells = values
            .iter()
            .rev()
            .take(3)
            .map(|(_, cells, _)| cells.to_string());
        let cells = cells.collect::<Vec<_>>().join(", ");
        let reference = Reference {
            from: format!("{} with {cells} cells", series.name),
            key,
            limit,
        };
        match found
            .iter_mut()
            .find(|(_, other)| other.key == reference.key)
        {
            Some(other) if other.0 < order => *other = (order, reference),
            Some(_) => {}
            None => found.push((order, reference)),
        }
    }
    found.into_iter().map(|(_, reference)| reference).collect()
}

/// Two meshes of a series with as many cells and unknowns: the geometry does not heed what is
/// swept.
fn identical_meshes(plan: &StudyPlan, done: &[Option<&Numbers>]) -> Option<String> {
    let mesh = plan
        .dimensions
        .iter()
        .position(|d| d.kind == SweepKind::Mesh)?;
    let size = |i: usize| done[i].map(|numbers| (numbers.cells, numbers.unknowns));
    let label = |i: usize| plan.label(&plan.settings[i], mesh);
    series(plan, done).iter().find_map(|series| {
        let mut pairs = series.settings.windows(2);
        let pair = pairs.find(|pair| size(pair[0]).is_some() && size(pair[0]) == size(pair[1]))?;
        Some(format!("{} and {}", label(pair[0]), label(pair[1])))
    })
}

fn order(plan: &StudyPlan, setting: &Setting) -> f64 {
    let chosen = plan.dimensions.iter().zip(&setting.choices);
    let mut orders = chosen.filter(|(dimension, _)| dimension.kind == SweepKind::Order);
    let number = orders
        .next()
        .and_then(|(dimension, &choice)| dimension.choices[choice].number);
    let own = plan.scene.get("mesh").and_then(|mesh| mesh.get("order"));
    let own = own.and_then(toml::Value::as_integer).unwrap_or(1);
    number.unwrap_or(own as f64)
}

/// All settings by series, in the order of the dimensions.
fn series(plan: &StudyPlan, done: &[Option<&Numbers>]) -> Vec<MeasuredSeries> {
    let but_mesh = |kind: SweepKind| kind != SweepKind::Mesh;
    let mut found: Vec<(Vec<usize>, MeasuredSeries)> = Vec::new();
    for (i, setting) in plan.settings.iter().enumerate() {
        let key = plan.key(setting, but_mesh);
        match found.iter_mut().find(|(other, _)| *other == key) {
            Some((_, series)) => series.settings.push(i),
            None => {
                let name = or_the_scene(plan.name(setting, but_mesh));
                let settings = vec![i];
                found.push((key, MeasuredSeries { name, settings }));
            }
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    let mut all: Vec<MeasuredSeries> = found.into_iter().map(|(_, series)| series).collect();
    for series in &mut all {
        series
            .settings
            .sort_by_key(|&i| done[i].map_or(usize::MAX, |numbers| numbers.unknowns));
    }
    all
}

impl Assessment {
    /// Points of a series that have an error, over some number of theirs.
    pub(super) fn points(
        &self,
        series: &MeasuredSeries,
        records: &[Option<PointRecord>],
        x: impl Fn(&Numbers) -> f64,
    ) -> Vec<(f64, f64)> {
        let point = |&i: &usize| {
            let numbers = records[i].as_ref()?.numbers()?;
            Some((x(numbers), self.drawn_error(i)?))
        };
        series.settings.iter().filter_map(point).collect()
    }

    /// Error of a setting to six digits: what differs by rounding beats nothing.
    pub(super) fn drawn_error(&self, index: usize) -> Option<f64> {
        let error = self.verdicts[index].error?;
        format!("{error:.5e}").parse().ok()
    }

    /// Uncertainties of the references of all settings with an error, as shares; 0 of closed forms.
    pub(super) fn uncertainties(&self) -> impl Iterator<Item = f64> {
        let known = self.verdicts.iter();
        let known = known.filter(|verdict| verdict.error.is_some());
        known.map(|verdict| verdict.uncertainty)
    }
}

#[cfg(test)]
mod tests;
