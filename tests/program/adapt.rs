//! Meshes that follow the estimated error.

use serde_json::Value;

use crate::harness::{Workshop, summary};

const COARSE: (&str, &str) = (
    "parameters = { h = 0.08, half = 10 }",
    "parameters = { h = 0.4 }\norder = 2\nadapt = { tolerance = 0.1 }",
);

fn measure<'a>(said: &'a Value, name: &str) -> &'a Value {
    let measures = said["measures"].as_array().expect("measures");
    let found = measures.iter().find(|measure| measure["name"] == name);
    found.unwrap_or_else(|| panic!("{name}"))
}

/// Refined until the estimate is below a tenth; the closed form (Sneddon 1946) confirms it.
#[test]
fn a_penny_is_refined_until_its_opening_is_good_enough() {
    let workshop = Workshop::new("penny", &[COARSE]);
    let out = workshop.solve("out", &[]);
    let said = summary(&out);
    let meshes = said["meshes"].as_array().expect("meshes");
    let error = |mesh: &Value| mesh["error"].as_f64().expect("an error");
    let (first, last) = (&meshes[0], &meshes[meshes.len() - 1]);
    assert!(
        meshes.len() > 1 && error(first) > 0.1 && error(last) <= 0.1,
        "{meshes:?}"
    );
    assert_eq!(last["unknowns"], said["unknowns"]["total"]);
    assert!(
        measure(&said, "volume")["error"]
            .as_f64()
            .expect("an error")
            < 0.1
    );
    let crack = &said["fractures"]["penny"];
    let share = crack["aperture_uncertainty"]
        .as_f64()
        .expect("an uncertainty");
    assert!(share / crack["aperture"]["mean"].as_f64().expect("an aperture") < 0.1);
    let decisions = said["decisions"].to_string();
    for text in ["quarter points", "10 % was asked for"] {
        assert!(decisions.contains(text), "{text:?} is not in {decisions}");
    }
    assert!(out.join("sizes.pos").is_file());
}

#[test]
fn a_budget_ends_the_search() {
    let budget = (
        COARSE.0,
        COARSE.1.replace("0.1 }", "1e-6, max_unknowns = 5e3 }"),
    );
    let workshop = Workshop::new("penny", &[(budget.0, &budget.1)]);
    let said = summary(&workshop.solve("out", &[]));
    assert!(
        said["decisions"]
            .to_string()
            .contains("the budget is spent")
    );
    let unknowns = said["unknowns"]["total"].as_f64().expect("a number");
    assert!(unknowns < 1.5e4, "{unknowns}");
}
