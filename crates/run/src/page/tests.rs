//! Pages of hostile and of large runs.

use super::*;
use crate::flow_summary::{SourceFlow, StepFlow};
use crate::measure::Measure;
use crate::provenance::InputFile;
use crate::spread::Spread;
use crate::summary::FractureSummary;
use kluft_io::{Field, Grid, Values};
use kluft_mesh::Shape;

const BAD: &str = "</pre></title><script>alert('x')</script>\u{1b}[2J";

fn fracture() -> FractureSummary {
    let spread = Spread {
        min: 1e-5,
        mean: 2e-5,
        max: 3e-5,
    };
    FractureSummary {
        facets: 12,
        area: 1.0,
        aperture: spread,
        normal_traction: spread,
        shear_traction: spread,
        slip: spread,
        slip_max: 0.0,
        force: [0.0; 3],
        open_area: 0.0,
        sliding_area: 0.0,
        closed_area: 1.0,
        below_cutoff_area: 0.0,
        below_cutoff_facets: 0,
        overlap_area: 0.0,
        undetermined: Default::default(),
        aperture_uncertainty: Some(1e-7),
        slip_uncertainty: None,
    }
}

/// A summary in which every text is hostile.
fn hostile(fractures: usize) -> Summary {
    let mut summary = Summary {
        title: BAD.into(),
        decisions: vec![BAD.into(); 1000],
        warnings: vec![BAD.into(); 1000],
        fractures: (0..fractures)
            .map(|i| (format!("{BAD}{i}"), fracture()))
            .collect(),
        measures: vec![Measure {
            name: BAD.into(),
            fracture: Some(BAD.into()),
            value: Some(1.0),
            exact: Some(1.1),
            error: Some(0.1),
        }],
        ending: Some(Ending::NotConverged(BAD.into())),
        ..Summary::default()
    };
    summary.provenance.command = Some(BAD.into());
    summary.provenance.gmsh = Some(BAD.into());
    summary.provenance.inputs.push(InputFile {
        file: BAD.into(),
        xxh3_128: "0".into(),
    });
    let flow = |rate: f64| StepFlow {
        inflow: rate,
        outflow: rate,
        stored: 0.0,
        mass_error: 0.0,
        mass_rounding: 0.0,
        flux_error: 0.05,
        sources: vec![SourceFlow {
            name: BAD.into(),
            pressure: 1.0,
            rate,
            volume: 0.0,
        }],
    };
    summary.steps = (1..=1000)
        .map(|i| StepSummary {
            load: None,
            time: f64::from(i),
            phase: Some(BAD.into()),
            completed: 1.0,
            measures: None,
            fractures: Vec::new(),
            flow: Some(flow(f64::from(i))),
        })
        .collect();
    summary
}

use crate::summary::StepSummary;

/// A rough surface of so many triangles, whose fields are noise.
fn noise(triangles: usize) -> Shown {
    let side = (triangles as f64).sqrt();
    let random = |i: usize| ((i as f64 * 12.9898).sin() * 43_758.547).fract();
    let points: Vec<[f64; 3]> = (0..3 * triangles)
        .map(|i| {
            let (facet, corner) = (i / 3, i % 3);
            let (x, y) = ((facet as f64 % side).floor(), (facet as f64 / side).floor());
            let (dx, dy) = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][corner];
            [x + dx, y + dy, random(facet)]
        })
        .collect();
    let field = |name: &'static str| Field {
        name,
        components: 1,
        values: Values::Real((0..3 * triangles).map(random).collect()),
    };
    let grid = Grid {
        shapes: vec![Shape::Tri3; triangles],
        offsets: (0..=triangles as u32).map(|facet| 3 * facet).collect(),
        nodes: (0..3 * triangles as u32).collect(),
        point_fields: FIELDS.map(|(name, ..)| field(name)).into(),
        cell_fields: Vec::new(),
        points,
    };
    Shown {
        surface: Surface::of(&grid, &fields()),
        body: [[0.0, 0.0, -side], [side; 3]],
    }
}

fn html(summary: &Summary, shown: Option<&Shown>, scene: &str) -> String {
    let told = Told {
        summary,
        history: "step,time,kind,name,aperture_mean,normal_traction_mean\n\
            1,1,fracture,<script>,1e-4,-1\n2,2,fracture,<script>,2e-4,-2\n",
        probes: "",
        iterations: &Iterations::default(),
        shown,
        strength: None,
        scene: Some(scene),
    };
    told.html()
}

#[test]
fn no_name_of_a_scene_is_markup() {
    let page = html(&hostile(3), Some(&noise(50)), BAD);
    assert!(!page.contains("<script") && !page.contains('\u{1b}'));
    assert!(page.matches("&lt;script&gt;").count() > 100);
    assert_eq!(
        page.matches("<details>").count(),
        page.matches("</details>").count()
    );
    assert!(is_page(&page));
}

#[test]
fn a_page_needs_no_other_file() {
    let page = html(&hostile(3), Some(&noise(50)), "title = \"x\"");
    for outside in ["http:", "https:", "src=", "url(", "@import", "<link"] {
        // The namespace of SVG is a name, not an address that anything opens.
        let page = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.matches("href=\"data:image/png;base64,").count() == MOST_PICTURES);
}

#[test]
fn a_page_of_the_largest_run_stays_small() {
    let scene = "[fracture.\"a\"]\n".repeat(100_000);
    let page = html(&hostile(5000), Some(&noise(300_000)), &scene);
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    for said in [
        "4700 more fractures",
        "rest of the scene",
        "900 more are in summary.json",
    ] {
        assert!(page.contains(said), "{said}");
    }
}

#[test]
fn a_run_that_found_nothing_has_a_page() {
    let summary = Summary {
        ending: Some(Ending::NotConverged("too hard".into())),
        ..Summary::default()
    };
    let page = html(&summary, None, "");
    assert!(page.contains("Not converged: 0 load steps"));
}
