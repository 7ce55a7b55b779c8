//! Values by an expression of position and time.

use std::fmt;

use exmex::prelude::*;
use exmex::{FloatOpsFactory, MakeOperators, MatchLiteral, Operator, literal_matcher_from_pattern};
use glam::DVec3;

use crate::calls;
use crate::coordinate::{Coordinate, Place};
use crate::precedence;

/// Longest text of an expression, in bytes.
const LONGEST: usize = 2000;

literal_matcher_from_pattern!(Numbers, r"^([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?");

/// The operators of expressions.
#[derive(Debug, Clone)]
struct Operators;

impl MakeOperators<f64> for Operators {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        let mut all = FloatOpsFactory::<f64>::make();
        // Euler's number would hide slips such as `1 e6`; it is `exp(1)`.
        all.retain(|operator| !["e", "E"].contains(&operator.repr()));
        all.push(Operator::make_unary("step", |a| f64::from(a >= 0.0)));
        all
    }
}

type Parsed = FlatEx<f64, Operators, Numbers>;

/// An expression of `x`, `y`, `z`, `depth` and `time`, times a factor.
#[derive(Clone)]
pub struct Expression {
    text: String,
    parsed: Parsed,
    /// What the variables of the parsed expression are, in its order.
    variables: Vec<Coordinate>,
    factor: f64,
    ground: f64,
}

impl Expression {
    /// Reads an expression; its values are multiplied by `factor`, and `ground` is the elevation
    /// (m) where the depth is 0.
    ///
    /// # Errors
    /// What is wrong with the text, and what helps.
    pub fn read(text: &str, factor: f64, ground: f64) -> Result<Self, [String; 2]> {
        if text.len() > LONGEST {
            let problem = format!("the expression has {} characters", text.len());
            return Err([problem, format!("write at most {LONGEST}")]);
        }
        precedence::check(text, &functions(|own| own.unary().is_ok()))?;
        let callable = functions(|own| own.unary().is_ok() || own.bin().is_ok());
        if let Some(name) = calls::unknown(text, &callable).first() {
            let problem = match Coordinate::named(name) {
                Some(_) => format!("`{name}` is no function; a sign of multiplication is missing"),
                None => format!("the expression has a function that is not known: `{name}`"),
            };
            return Err([problem, format!("write numbers, {}", known())]);
        }
        let parsed = Parsed::parse(&calls::between(text)?).map_err(|error| {
            // Its parser counts operators and values.
            let why = match error.msg() {
                counts if counts.contains(" ops and ") => {
                    "an operator between two values, or a value beside an operator or in a \
                     function, is missing"
                }
                other => other,
            };
            let problem = format!("the expression cannot be read: {why}");
            [problem, format!("write numbers, {}", known())]
        })?;
        let mut variables = Vec::new();
        let mut unknown = Vec::new();
        for name in parsed.var_names() {
            match Coordinate::named(name) {
                Some(variable) => variables.push(variable),
                None => unknown.push(format!("`{name}`")),
            }
        }
        if !unknown.is_empty() {
            let problem = format!("the expression has unknown names: {}", unknown.join(", "));
            return Err([problem, format!("write numbers, {}", known())]);
        }
        Ok(Self {
            text: text.to_owned(),
            parsed,
            variables,
            factor,
            ground,
        })
    }

    /// The value at a position (m) and a time; not a number where it has none.
    pub fn at(&self, position: DVec3, time: f64) -> f64 {
        let place = Place {
            position,
            time,
            ground: self.ground,
        };
        let mut values = [0.0; Coordinate::NAMES.len()];
        for (value, variable) in values.iter_mut().zip(&self.variables) {
            *value = variable.of(&place);
        }
        let values = &values[..self.variables.len()];
        self.factor * self.parsed.eval(values).unwrap_or(f64::NAN)
    }

    /// Whether it has the time in it.
    pub fn depends_on_time(&self) -> bool {
        self.variables.contains(&Coordinate::Time)
    }

    /// Whether it has the elevation in it.
    pub fn depends_on_elevation(&self) -> bool {
        let elevations = [Coordinate::Z, Coordinate::Depth];
        self.variables.iter().any(|own| elevations.contains(own))
    }

    /// Whether it has a coordinate in it.
    pub fn depends_on_place(&self) -> bool {
        self.variables.iter().any(|own| *own != Coordinate::Time)
    }
}

/// Names of those functions that `are` meant.
fn functions(are: impl Fn(&Operator<'_, f64>) -> bool) -> Vec<String> {
    let all = Operators::make();
    let named = all
        .iter()
        .filter(|own| own.repr().starts_with(char::is_alphabetic));
    let meant = named.filter(|own| are(own));
    meant.map(|own| own.repr().to_owned()).collect()
}

/// What an expression may be made of.
fn known() -> String {
    let variables = Coordinate::NAMES.map(|(name, _)| name).join(", ");
    format!(
        "{variables}, + - * / ^, min(a, b), max(a, b), sqrt, exp, ln, log10, sin, cos, tan, abs, step, PI"
    )
}

impl fmt::Debug for Expression {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} * ({})", self.factor, self.text)
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        let own = (&self.text, self.factor, self.ground);
        own == (&other.text, other.factor, other.ground)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_have_the_values_of_mathematics() {
        let at = DVec3::new(3.0, 4.0, -5.0);
        for (text, value) in [
            ("1e6 * (1 - z/100)", 1.05e6),
            ("-(x^2) + 2.5e-1", -8.75),
            ("2 - x^2", -7.0),
            ("max(0, 1 - x/(2*time))", 0.25),
            ("max(0, min(x, y)) + min(max(x, y), max(1, min(9, y)))", 7.0),
            ("sqrt(x^2 + y^2) * step(x - 3)", 5.0),
            ("step(x - 3.1)", 0.0),
            ("depth * 2", 15.0 * 2.0),
            ("sin(PI/2)", 1.0),
            ("10 - 5 + 2 - 10/5*2", 3.0),
            ("x - y - z", 4.0),
            ("(-x)^3", -27.0),
            ("2^-1", 0.5),
            ("7", 7.0),
        ] {
            let expression = Expression::read(text, 10.0, 10.0).expect(text);
            let found = expression.at(at, 2.0);
            assert!(
                (found - 10.0 * value).abs() <= 1e-14 * found.abs(),
                "{text}: {found}"
            );
        }
        let moves = |text: &str| Expression::read(text, 1.0, 0.0).map(|e| e.depends_on_time());
        assert_eq!((moves("x + time"), moves("x")), (Ok(true), Ok(false)));
        let spread = |text: &str| Expression::read(text, 1.0, 0.0).map(|e| e.depends_on_place());
        assert_eq!((spread("depth"), spread("2*time")), (Ok(true), Ok(false)));
    }

    /// Whatever a slip makes of an expression, it is refused or has a value, and nothing panics.
    #[test]
    fn no_text_is_too_odd_to_be_judged() {
        let parts = [
            "x", "z", "depth", "time", "1", "2.5e-3", ".", "e", "+", "-", "*", "/", "^", "(", ")",
            ",", "min", "max(", "sqrt", "step(", "PI", "π", "atan2", "{", "}", " ", "é", "_", "==",
            "signum", "log10(", "τ",
        ];
        let mut state = 7_u64;
        let mut draw = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as usize % below
        };
        let mut read = 0;
        for _ in 0..30_000 {
            let text: String = (0..1 + draw(9)).map(|_| parts[draw(parts.len())]).collect();
            if let Ok(expression) = Expression::read(&text, 1.0, 0.0) {
                let _ = expression.at(DVec3::new(0.5, 1.0, -2.0), 1.0);
                read += 1;
            }
        }
        assert!(read > 300, "{read}");
    }

    #[test]
    fn what_is_no_expression_is_refused_with_what_may_stand_there() {
        for (text, says) in [
            ("", "empty"),
            ("2x", "cannot be read"),
            ("1 e6", "cannot be read"),
            ("pressure * 2", "unknown names: `pressure`"),
            ("foo(x)", "not known: `foo`"),
            ("2 + system (1)", "not known: `system`"),
            ("x(1 - y)", "`x` is no function"),
            ("(x", "cannot be read"),
            ("x > 2", "cannot be read"),
            ("é", "cannot be read"),
        ] {
            let [problem, remedy] = Expression::read(text, 1.0, 0.0).expect_err(text);
            assert!(problem.contains(says), "{text}: {problem}");
            assert!(remedy.contains("depth, time"), "{text}: {remedy}");
        }
        assert!(Expression::read(&"-".repeat(3000), 1.0, 0.0).is_err());
        assert!(Expression::read(&"(".repeat(1999), 1.0, 0.0).is_err());
        let root = Expression::read("sqrt(x)", 1.0, 0.0).expect("an expression");
        assert!(root.at(-DVec3::X, 0.0).is_nan());
    }
}
