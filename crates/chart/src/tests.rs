//! A chart as others read it: well-formed, with all its texts, finite.

use quick_xml::escape::unescape;
use quick_xml::events::Event;
use quick_xml::{Reader, XmlVersion};

use super::*;

fn sample() -> Chart {
    let line = |factor: f64, rate: i32| -> Vec<(f64, f64)> {
        let sizes = [1e2_f64, 1e3, 1e4, 1e5];
        sizes
            .iter()
            .map(|n| (*n, factor * n.powi(rate).recip()))
            .collect()
    };
    let mut fails = line(3.0, 1);
    fails[3].1 = f64::NAN;
    Chart {
        series: vec![
            Series::line("ours <linear> & exact", line(1.0, 1)),
            Series::line("theirs", fails),
            Series::scatter("exact", vec![(1e3, 0.0)]),
        ],
        failure: "no convergence".into(),
        rates: vec![Rate {
            series: 0,
            rate: -1.0,
        }],
        front: true,
        ..Chart::new(
            "Error over unknowns",
            Axis::logarithmic("unknowns"),
            Axis::logarithmic("error of the aperture (relative)").from(1e-8),
        )
    }
}

/// All texts, and all attributes by name.
fn parsed(svg: &str) -> (Vec<String>, Vec<(String, String)>) {
    let mut reader = Reader::from_str(svg);
    let (mut texts, mut attributes) = (Vec::new(), Vec::new());
    let mut text = String::new();
    loop {
        match reader.read_event().expect("well-formed XML") {
            Event::Start(tag) | Event::Empty(tag) => {
                for attribute in tag.attributes() {
                    let attribute = attribute.expect("an attribute");
                    let name = attribute.key.as_ref().to_owned();
                    let value = attribute.normalized_value(XmlVersion::Implicit1_0);
                    attributes.push((name, value.expect("a value").into_owned()));
                }
            }
            Event::Text(part) => text += &part.xml10_content(),
            Event::GeneralRef(name) => {
                let entity = format!("&{};", name.into_inner());
                text += &unescape(&entity).expect("an entity");
            }
            Event::End(_) => texts.push(std::mem::take(&mut text).trim().to_owned()),
            Event::Eof => return (texts, attributes),
            _ => {}
        }
    }
}

#[test]
fn the_document_is_xml_with_all_texts_and_finite_coordinates() {
    let svg = sample().svg();
    let (texts, attributes) = parsed(&svg);
    for wanted in [
        "Error over unknowns",
        "unknowns",
        "error of the aperture (relative)",
        "ours <linear> & exact",
        "theirs",
        "exact",
        "no convergence",
        "best of all",
        "−1",
        "10³",
        "10⁻⁴",
        "≤ 10⁻⁸",
    ] {
        assert!(
            texts.iter().any(|text| text == wanted),
            "{wanted}: {texts:?}"
        );
    }
    for (name, value) in attributes {
        if ["x", "y", "points", "x1", "y1", "x2", "y2"].contains(&name.as_str()) {
            let numbers = value.split([' ', ',']).filter(|part| !part.is_empty());
            for number in numbers {
                let number: f64 = number.parse().expect("a number");
                assert!(
                    number.is_finite() && (0.0..20_000.0).contains(&number),
                    "{number}"
                );
            }
        }
    }
}

#[test]
fn failures_are_crosses_only_where_something_failed() {
    let mut chart = sample();
    chart.series[1].points.pop();
    assert!(!chart.svg().contains("no convergence"));
}

#[test]
fn the_front_is_what_nothing_beats() {
    let mut chart = sample();
    chart.series[2].points = vec![(2e3, 1e-7), (9e4, 1e-3), (f64::NAN, 1.0)];
    assert_eq!(
        chart.front_points(),
        [(1e2, 1e-2), (1e3, 1e-3), (2e3, 1e-7)]
    );
}

#[test]
fn what_nothing_beats_is_found_among_ties_and_holes() {
    let points = [
        (2.0, 1.0),
        (1.0, 3.0),
        (1.0, 2.0),
        (3.0, 1.0),
        (f64::INFINITY, 0.0),
        (4.0, 0.5),
    ];
    assert_eq!(front(&points), [2, 0, 5]);
    assert!(front(&[(1.0, f64::NAN)]).is_empty());
}

#[test]
fn the_band_has_a_name_and_a_place_and_notes_stand_in_the_chart() {
    let mut chart = sample();
    chart.series[0].note = Some("−0.97".into());
    chart.band = Some(Band {
        below: 1e-7,
        name: "nobody knows".into(),
    });
    let (texts, _) = parsed(&chart.svg());
    for wanted in ["nobody knows", "−0.97", "10⁻⁷"] {
        assert!(
            texts.iter().any(|text| text == wanted),
            "{wanted}: {texts:?}"
        );
    }
    chart.band = None;
    let (texts, _) = parsed(&chart.svg());
    assert!(!texts.iter().any(|text| text == "nobody knows"));
}

#[test]
fn series_beyond_the_colours_have_markers_of_their_own() {
    let at = (1000, 1000);
    let looks: Vec<_> = (0..12)
        .map(|i| (style::marker(i, at), i % style::COLOURS.len()))
        .collect();
    for (i, look) in looks.iter().enumerate() {
        assert!(!looks[..i].contains(look), "series {i} looks like another");
    }
}

#[test]
fn charts_without_data_are_charts() {
    let empty = Chart::new("Nothing", Axis::linear("x"), Axis::logarithmic("y"));
    parsed(&empty.svg());
    let mut alone = empty.clone();
    alone.series = vec![Series::line(
        "alone",
        vec![(1.0, f64::NAN), (f64::NAN, 1.0)],
    )];
    parsed(&alone.svg());
}

#[test]
fn a_narrow_chart_has_the_same_texts_and_fits_a_telephone() {
    let texts = |svg: &str| -> Vec<String> {
        let (texts, _) = parsed(svg);
        texts.into_iter().filter(|text| !text.is_empty()).collect()
    };
    let chart = sample();
    let (wide, narrow) = (texts(&chart.svg()), texts(&chart.narrow_svg()));
    for name in [
        "ours <linear> & exact",
        "theirs",
        "exact",
        "best of all",
        "unknowns",
    ] {
        let name = name.to_owned();
        assert!(wide.contains(&name) && narrow.contains(&name), "{name}");
    }
    let (_, attributes) = parsed(&chart.narrow_svg());
    let width = attributes.iter().find(|(name, _)| name == "width");
    let width: f64 = width.expect("a width").1.parse().expect("a number");
    assert!(width <= 390.0, "{width}");
}

/// Letters are about half as wide as high, and the drawing has ten units a pixel.
#[test]
fn the_title_of_a_narrow_chart_fits() {
    let mut chart = sample();
    chart.title = "Error of the largest opening of the joint against wall time".into();
    let svg = chart.narrow_svg();
    let end = svg.find(&chart.title).expect("a title");
    let head = &svg[svg[..end].rfind("<text").expect("its tag")..end];
    let number = |name: &str| -> f64 {
        let rest = head.split_once(&format!("{name}=\"")).expect(name).1;
        rest.split('"')
            .next()
            .and_then(|text| text.parse().ok())
            .expect(name)
    };
    let units = svg.split_once("viewBox=\"0 0 ").expect("a box").1;
    let width: f64 = units
        .split(' ')
        .next()
        .and_then(|text| text.parse().ok())
        .expect("a width");
    let length = 0.5 * number("font-size") * chart.title.len() as f64;
    assert!(number("x") + length < width, "{head}: {length} of {width}");
}

#[test]
fn every_colour_of_a_drawing_has_its_shades() {
    let svg = sample().svg();
    let (head, drawing) = svg.split_once("</style>").expect("a style sheet");
    let (_, attributes) = parsed(&svg);
    let paints = attributes
        .iter()
        .filter(|(name, _)| name == "fill" || name == "stroke");
    let paints = paints.filter(|(_, value)| value.starts_with('#'));
    let mut count = 0;
    for (name, colour) in paints {
        let rule = format!("[{name}='{colour}']{{{name}:#");
        assert_eq!(head.matches(&rule).count(), 2, "{rule}: light and dark");
        count += 1;
    }
    assert!(count > 10 && !drawing.contains("<style"));
}
