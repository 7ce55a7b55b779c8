//! Curves of probes over the load steps.

use std::collections::HashMap;

use csv::StringRecord;
use kluft_chart::Chart;

use super::curves::{APERTURE, Curves, Measured, TIME, chart, spread};

/// What is charted where it is: columns, of which several are the components of a vector whose
/// length is meant; title; axis.
const CHARTS: [(&[&str], &str, Measured); 6] = [
    (
        &["displacement_x", "displacement_y", "displacement_z"],
        "Displacement at probes",
        ("displacement", "m"),
    ),
    (
        &["principal_min"],
        "Most compressive stress at probes",
        ("stress", "Pa"),
    ),
    (&["aperture"], "Aperture at probes", APERTURE),
    (
        &["normal_traction"],
        "Normal traction at probes",
        ("traction", "Pa"),
    ),
    (&["slip"], "Slip at probes", ("slip", "m")),
    (
        &["pressure"],
        "Fluid pressure at probes",
        ("pressure", "Pa"),
    ),
];

/// The curves of the probes in a `probes.csv`; none of a run of one step.
pub fn of_probes(text: &str) -> Vec<Chart> {
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let Ok(head) = table.headers().cloned() else {
        return Vec::new();
    };
    let rows: Vec<StringRecord> = table.records().filter_map(Result::ok).collect();
    let charts = CHARTS.iter().filter_map(|(columns, title, axis)| {
        let curves = curves(&head, &rows, columns)?;
        let varies = curves.iter().any(|(_, points)| spread(points) > 0.0);
        varies.then(|| chart(title, [TIME, *axis], curves))
    });
    charts.collect()
}

/// A curve for each point of each probe that has these columns; none if the table has them not.
fn curves(head: &StringRecord, rows: &[StringRecord], columns: &[&str]) -> Option<Curves> {
    let place = |name: &str| head.iter().position(|known| known == name);
    let [probe, point, time] = ["probe", "point", "time"].map(place);
    let (probe, point, time) = (probe?, point?, time?);
    let columns = columns.iter().map(|column| place(column));
    let columns: Vec<usize> = columns.collect::<Option<_>>()?;
    let mut curves: Curves = Vec::new();
    let mut known: HashMap<(&str, &str), usize> = HashMap::new();
    for row in rows {
        let number = |place: &usize| row.get(*place)?.parse::<f64>().ok();
        let values: Option<Vec<f64>> = columns.iter().map(number).collect();
        let (Some(time), Some(values)) = (number(&time), values) else {
            continue;
        };
        let key = (&row[probe], &row[point]);
        let index = *known.entry(key).or_insert_with(|| {
            curves.push((name(key), Vec::new()));
            curves.len() - 1
        });
        curves[index].1.push((time, measure(&values)));
    }
    alone_without_number(&mut curves);
    Some(curves)
}

/// A value, or the length of a vector.
fn measure(values: &[f64]) -> f64 {
    match values {
        [value] => *value,
        _ => values.iter().map(|value| value * value).sum::<f64>().sqrt(),
    }
}

fn name((probe, point): (&str, &str)) -> String {
    match point {
        "mean" => probe.to_owned(),
        _ => format!("{probe}, point {point}"),
    }
}

/// A probe of one point goes by its name.
fn alone_without_number(curves: &mut Curves) {
    let names: Vec<String> = curves.iter().map(|(name, _)| name.clone()).collect();
    for (name, _) in curves {
        let Some(probe) = name.strip_suffix(", point 1").map(str::to_owned) else {
            continue;
        };
        if !names.contains(&format!("{probe}, point 2")) {
            *name = probe;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str =
        "step,time,phase,probe,point,displacement_x,displacement_y,displacement_z,aperture\n";

    /// Lengths of vectors over time; a probe has values only while it is in something.
    #[test]
    fn probes_have_curves_over_time() {
        let rows = "1,1,,crown,1,,,,\n1,1,,joint,1,,,,1e-4\n1,1,,joint,2,,,,2e-4\n\
                    2,2,,crown,1,0,0,0,\n2,2,,joint,1,,,,1e-4\n2,2,,joint,2,,,,1e-4\n\
                    3,3,,crown,1,3e-3,0,-4e-3,\n";
        let charts = of_probes(&(HEAD.to_owned() + rows));
        let titles: Vec<&str> = charts.iter().map(|chart| chart.title.as_str()).collect();
        assert_eq!(titles, ["Displacement at probes", "Aperture at probes"]);
        let crown = &charts[0].series[0];
        assert_eq!(crown.name, "crown");
        assert_eq!(crown.points.len(), 2);
        assert!(
            (crown.points[1].1 - 5.0).abs() < 1e-12,
            "{:?}",
            crown.points
        );
        assert_eq!(charts[0].y.title, "displacement (mm)");
        assert_eq!(charts[1].series[0].name, "joint, point 2");
    }

    #[test]
    fn one_step_and_no_probes_have_no_curves() {
        let row = "1,1,,crown,1,1e-3,0,0,\n";
        assert!(of_probes(&(HEAD.to_owned() + row)).is_empty());
        assert!(of_probes("").is_empty());
    }
}
