//! Parameters and curves of a project of OpenGeoSys.

use std::collections::BTreeMap;

use super::tree::Element;

/// What a parameter is, as far as a scene can say it.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its numbers, without the curve.
    pub values: Vec<f64>,
    /// The curve that scales it in time.
    pub curve: Option<String>,
}

/// All parameters and curves by their names.
#[derive(Debug, Default)]
pub struct Parameters {
    known: BTreeMap<String, Parameter>,
    /// Types of those that a scene has no counterpart for.
    strange: BTreeMap<String, String>,
    curves: BTreeMap<String, Vec<[f64; 2]>>,
}

/// Numbers with spaces between.
pub fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split_whitespace()
        .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect()
}

/// Three components of which the third may be missing.
pub fn vector(text: &str) -> Option<[f64; 3]> {
    let mut all = numbers(text)?;
    all.resize(3, 0.0);
    all.try_into().ok()
}

impl Parameters {
    /// Those of a project.
    pub fn of(project: &Element) -> Self {
        let mut all = Self::default();
        let entries = project.get("parameters").into_iter();
        let entries: Vec<&Element> = entries.flat_map(|list| list.all("parameter")).collect();
        // Scaled ones may stand before those that they scale.
        for scaled in [false, true] {
            for entry in &entries {
                all.add(entry, scaled);
            }
        }
        for curve in project
            .get("curves")
            .into_iter()
            .flat_map(|list| list.all("curve"))
        {
            let rows = |name: &str| curve.word(name).and_then(numbers);
            if let (Some(name), Some(at), Some(values)) =
                (curve.word("name"), rows("coords"), rows("values"))
            {
                let rows = at.into_iter().zip(values).map(|(at, value)| [at, value]);
                all.curves.insert(name.to_owned(), rows.collect());
            }
        }
        all
    }

    fn add(&mut self, entry: &Element, scaled: bool) {
        let (Some(name), Some(kind)) = (entry.word("name"), entry.word("type")) else {
            return;
        };
        let found = match kind {
            "Constant" if !scaled => {
                let text = entry.word("value").or_else(|| entry.word("values"));
                text.and_then(numbers).map(|values| Parameter {
                    values,
                    curve: None,
                })
            }
            "CurveScaled" if scaled => {
                let of = entry.word("parameter").and_then(|of| self.known.get(of));
                of.filter(|of| of.curve.is_none()).map(|of| Parameter {
                    values: of.values.clone(),
                    curve: entry.word("curve").map(str::to_owned),
                })
            }
            _ => None,
        };
        match found {
            Some(parameter) => {
                self.known.insert(name.to_owned(), parameter);
            }
            None => {
                self.strange.insert(name.to_owned(), kind.to_owned());
            }
        }
    }

    /// A parameter that an element names, or numbers that stand there.
    ///
    /// # Errors
    /// Why there are no numbers.
    pub fn named(&self, text: &str) -> Result<Parameter, String> {
        if let Some(known) = self.known.get(text) {
            return Ok(known.clone());
        }
        if let Some(values) = numbers(text).filter(|values| !values.is_empty()) {
            return Ok(Parameter {
                values,
                curve: None,
            });
        }
        Err(match self.strange.get(text) {
            Some(kind) => format!("the parameter `{text}` of type {kind} has no counterpart"),
            None => format!("the parameter `{text}` is not there"),
        })
    }

    /// The rows of a curve, time and factor.
    pub fn curve(&self, name: &str) -> Option<&[[f64; 2]]> {
        self.curves.get(name).map(Vec::as_slice)
    }
}
