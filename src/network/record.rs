//! `network.json`: what was asked, what came of it, and what became of every fracture.

use kluft_network::{
    Amount, Domain, Feature, FeatureKind, Fisher, Moments, Network, NetworkFracture, Orientation,
    moments,
};
use serde::Serialize;

use super::input::Input;
use super::sets::Set;
use crate::report::Report;

/// Everything `network.json` holds.
#[derive(Debug, Serialize)]
pub(super) struct NetworkRecord {
    kluft: &'static str,
    title: String,
    domain: DomainRecord,
    sets: Vec<SetRecord>,
    /// The fractures in the geometry, in its order.
    fractures: Vec<FractureRecord>,
    /// The fractures that are not in it.
    rejected: Vec<RejectedRecord>,
    intersections: IntersectionsRecord,
    /// What is too small for the mesh and stays.
    small_features: Vec<FeatureRecord>,
    /// Gaps below this are closed (m).
    gap: f64,
    assumptions: Vec<String>,
}

#[derive(Debug, Serialize)]
struct DomainRecord {
    low: [f64; 3],
    high: [f64; 3],
    volume: f64,
}

/// Statistics of a set: asked for, over all drawn, and over those in the domain.
#[derive(Debug, Serialize)]
struct SetRecord {
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    asked: Option<Statistics>,
    #[serde(skip_serializing_if = "Option::is_none")]
    drawn: Option<Statistics>,
    inside: Statistics,
}

#[derive(Debug, Default, Serialize)]
struct Statistics {
    #[serde(skip_serializing_if = "Option::is_none")]
    count: Option<usize>,
    /// Area per volume [m^2/m^3].
    #[serde(skip_serializing_if = "Option::is_none")]
    p32: Option<f64>,
    /// Mean orientation (degrees).
    dip: f64,
    dip_direction: f64,
    /// Concentration; null if infinite.
    kappa: f64,
    /// Mean and standard deviation of the size (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    size: Option<Moments>,
}

#[derive(Debug, Serialize)]
struct FractureRecord {
    name: String,
    set: String,
    place: String,
    /// Area in the geometry, and as given (m^2).
    area: f64,
    area_given: f64,
    dip: f64,
    dip_direction: f64,
    corners: usize,
    /// What was changed besides clipping.
    changes: Vec<String>,
    /// Farthest that a corner was moved at once (m).
    farthest_move: f64,
}

#[derive(Debug, Serialize)]
struct RejectedRecord {
    name: String,
    set: String,
    reason: String,
}

#[derive(Debug, Serialize)]
struct IntersectionsRecord {
    count: usize,
    total_length: f64,
}

#[derive(Debug, Serialize)]
struct FeatureRecord {
    kind: FeatureKind,
    names: Vec<String>,
    size: f64,
    enough: f64,
    at: [f64; 3],
    text: String,
}

impl NetworkRecord {
    /// Sums up a network.
    pub(super) fn of(network: &Network, input: &Input) -> Self {
        let lengths = network
            .intersections
            .iter()
            .map(|(_, shared)| shared.length());
        Self {
            kluft: env!("CARGO_PKG_VERSION"),
            title: input.title.clone(),
            domain: domain_record(&network.domain),
            sets: input
                .sets
                .iter()
                .map(|set| set_record(network, set))
                .collect(),
            fractures: (0..network.fractures.len())
                .map(|index| fracture_record(network, index))
                .collect(),
            rejected: rejected(network),
            intersections: IntersectionsRecord {
                count: network.intersections.len(),
                // The sum of nothing would be -0.
                total_length: lengths.fold(0.0, |sum, length| sum + length),
            },
            small_features: network.features.iter().map(feature_record).collect(),
            gap: network.sizes.gap(),
            assumptions: input.assumptions.clone(),
        }
    }

    /// Tells it to the user.
    pub(super) fn tell(&self, report: &Report) {
        for assumption in &self.assumptions {
            report.entry("assumed", assumption);
        }
        for set in &self.sets {
            report.entry("set", &set.text());
        }
        let (count, length) = (self.intersections.count, self.intersections.total_length);
        let text = format!(
            "{} fractures, {count} intersections of {length:.4} m in all",
            self.fractures.len()
        );
        report.entry("made", &text);
        for one in &self.rejected {
            report.entry("left out", &format!("`{}`: {}", one.name, one.reason));
        }
        for fracture in &self.fractures {
            for change in &fracture.changes {
                report.entry("mended", &format!("`{}`: {change}", fracture.name));
            }
        }
        let moves = self.fractures.iter().map(|one| one.farthest_move);
        let farthest = moves.fold(0.0, f64::max);
        if farthest > 0.0 {
            let text = format!(
                "corners moved by at most {farthest:.3e} m, each within its plane, to close gaps below {:.3e} m",
                self.gap
            );
            report.entry("mended", &text);
        }
        for feature in &self.small_features {
            report.entry("too small", &feature.text);
        }
        if !self.small_features.is_empty() {
            let text = format!(
                "{} features stay that make poor cells; a finer mesh or other fractures avoid them",
                self.small_features.len()
            );
            report.entry("warning", &text);
        }
    }
}

fn domain_record(domain: &Domain) -> DomainRecord {
    DomainRecord {
        low: domain.low.to_array(),
        high: domain.high.to_array(),
        volume: domain.volume(),
    }
}

fn fracture_record(network: &Network, index: usize) -> FractureRecord {
    let fracture = &network.fractures[index];
    let Orientation { dip, dip_direction } = Orientation::of_normal(fracture.polygon.normal());
    FractureRecord {
        name: fracture.name.clone(),
        set: fracture.set.clone(),
        place: fracture.place.clone(),
        area: network.area(index),
        area_given: fracture.area_given,
        dip,
        dip_direction,
        corners: fracture.polygon.corners().len(),
        changes: fracture.changes.clone(),
        farthest_move: fracture.farthest_move,
    }
}

fn rejected(network: &Network) -> Vec<RejectedRecord> {
    let all = network.rejected.iter();
    all.map(|one| RejectedRecord {
        name: one.name.clone(),
        set: one.set.clone(),
        reason: one.reason.clone(),
    })
    .collect()
}

fn feature_record(feature: &Feature) -> FeatureRecord {
    FeatureRecord {
        kind: feature.kind,
        names: feature.names.clone(),
        size: feature.size,
        enough: feature.enough,
        at: feature.at.to_array(),
        text: feature_text(feature),
    }
}

fn feature_text(feature: &Feature) -> String {
    let names: Vec<String> = feature
        .names
        .iter()
        .map(|name| format!("`{name}`"))
        .collect();
    let names = names.join(", ");
    let (size, enough, at) = (feature.size, feature.enough, feature.at);
    let place = format!("at ({:.4}, {:.4}, {:.4})", at.x, at.y, at.z);
    match feature.kind {
        FeatureKind::ShortIntersection => {
            format!("{names} meet in a line of {size:.3e} m, below {enough:.3e} m, {place}")
        }
        FeatureKind::Gap | FeatureKind::GapToFace => {
            format!("{names} come as close as {size:.3e} m, below {enough:.3e} m, {place}")
        }
        FeatureKind::SmallAngle => {
            format!("{names} meet at {size:.2} degrees, below {enough}, {place}")
        }
        FeatureKind::CloseLines => format!(
            "lines on the first of {names} come as close as {size:.3e} m, below {enough:.3e} m, {place}"
        ),
    }
}

fn set_record(network: &Network, set: &Set) -> SetRecord {
    let all = network.fractures.iter().enumerate();
    let of_set = all.filter(|(_, fracture)| fracture.set == set.name);
    let (numbers_of_own, own): (Vec<usize>, Vec<&NetworkFracture>) = of_set.unzip();
    let area: f64 = numbers_of_own
        .iter()
        .map(|&index| network.area(index))
        .sum();
    let (asked, drawn) = match &set.drawn {
        Some((asked, drawn)) => {
            let poles: Vec<_> = drawn.iter().map(|one| one.pole).collect();
            let sizes: Vec<f64> = drawn.iter().map(|one| one.size).collect();
            let all = numbers(
                Fisher::estimate(&poles),
                Some(drawn.len()),
                None,
                Some(moments(&sizes)),
            );
            let (count, p32) = match asked.amount {
                Amount::Count(count) => (Some(count), None),
                Amount::P32(p32) => (None, Some(p32)),
            };
            (
                Some(numbers(
                    asked.orientation,
                    count,
                    p32,
                    Some(asked.size.moments()),
                )),
                Some(all),
            )
        }
        None => (None, None),
    };
    let (fisher, sizes) = match &set.drawn {
        Some((_, drawn)) => {
            let inside = || drawn.iter().filter(|one| one.area_inside > 0.0);
            let poles: Vec<_> = inside().map(|one| one.pole).collect();
            let sizes: Vec<f64> = inside().map(|one| one.size).collect();
            (Fisher::estimate(&poles), Some(moments(&sizes)))
        }
        None => {
            let poles: Vec<_> = own.iter().map(|fracture| upward(fracture)).collect();
            (Fisher::estimate(&poles), None)
        }
    };
    let p32 = area / network.domain.volume();
    SetRecord {
        name: set.name.clone(),
        asked,
        drawn,
        inside: numbers(fisher, Some(own.len()), Some(p32), sizes),
    }
}

fn upward(fracture: &NetworkFracture) -> glam::DVec3 {
    let normal = fracture.polygon.normal();
    if normal.z < 0.0 { -normal } else { normal }
}

fn numbers(
    fisher: Fisher,
    count: Option<usize>,
    p32: Option<f64>,
    size: Option<Moments>,
) -> Statistics {
    Statistics {
        count,
        p32,
        dip: fisher.mean.dip,
        dip_direction: fisher.mean.dip_direction,
        kappa: fisher.kappa,
        size,
    }
}

impl SetRecord {
    fn text(&self) -> String {
        let mut parts = Vec::new();
        for (numbers, which) in [(&self.asked, "asked"), (&self.drawn, "drawn")] {
            if let Some(numbers) = numbers {
                parts.push(format!("{which} {}", numbers.text()));
            }
        }
        parts.push(format!("in the domain {}", self.inside.text()));
        format!("{}: {}", self.name, parts.join("; "))
    }
}

impl Statistics {
    fn text(&self) -> String {
        let mut parts = Vec::new();
        parts.extend(self.count.map(|count| format!("{count} fractures")));
        parts.extend(self.p32.map(|p32| format!("P32 {p32:.4} m2/m3")));
        parts.push(format!(
            "dip {:.1}, dip direction {:.1}",
            self.dip, self.dip_direction
        ));
        if self.kappa.is_finite() {
            parts.push(format!("kappa {:.2}", self.kappa));
        }
        parts.extend(
            self.size
                .map(|size| format!("size {:.3} ± {:.3} m", size.mean, size.sd)),
        );
        parts.join(", ")
    }
}
