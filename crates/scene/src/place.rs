//! Where outer faces lie: comparisons of expressions, all of which hold.

use glam::DVec3;
use kluft_field::Expression;

/// Faces off an equality by less than this share of the size of the body lie on it.
const NEAR: f64 = 1e-6;

/// Where a part of the outer surface lies.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePlace {
    text: String,
    comparisons: Vec<Comparison>,
}

#[derive(Debug, Clone, PartialEq)]
struct Comparison {
    left: Side,
    relation: Relation,
    right: Side,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Relation {
    Equal,
    Below,
    Above,
}

/// A side of a comparison.
#[derive(Debug, Clone, PartialEq)]
enum Side {
    Value(Box<Expression>),
    /// The lowest coordinate of the body along an axis.
    Lowest(usize),
    /// The highest.
    Highest(usize),
}

impl SurfacePlace {
    /// Reads comparisons with commas between them, such as `z = max` or `0 < x < 1, z = max`: `min`
    /// and `max` alone stand for the ends of the body along the coordinate they are compared with.
    ///
    /// # Errors
    /// What is wrong with the text, and what helps.
    pub fn read(text: &str) -> Result<Self, [String; 2]> {
        let mut comparisons = Vec::new();
        for condition in conditions(text) {
            let (sides, relations) = parts(condition);
            if relations.is_empty() {
                let problem = format!("`{condition}` compares nothing");
                return Err([problem, "write z = max, x > 1 or x^2 + y^2 = 25".into()]);
            }
            for (pair, &relation) in sides.windows(2).zip(&relations) {
                comparisons.push(Comparison {
                    left: side(pair[0], pair[1])?,
                    relation,
                    right: side(pair[1], pair[0])?,
                });
            }
        }
        Ok(Self {
            text: text.to_owned(),
            comparisons,
        })
    }

    /// The text it was read from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether a face with these corners (m) lies there, in a body that reaches from `low` to
    /// `high`.
    pub fn holds(&self, corners: &[DVec3], [low, high]: [DVec3; 2]) -> bool {
        let size = (high - low).length();
        let meets = |comparison: &Comparison, at: DVec3| {
            let beyond = |at| comparison.difference(at, [low, high]);
            let steps = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| NEAR * size * axis);
            let slopes = steps.map(|step| (beyond(at + step) - beyond(at - step)) / 2.0);
            // What the difference of the sides changes by over that share of the size.
            let near = DVec3::from(slopes).length();
            let value = beyond(at);
            match comparison.relation {
                Relation::Equal => value.abs() <= near,
                Relation::Below => value <= near,
                Relation::Above => value >= -near,
            }
        };
        let mut all = self.comparisons.iter();
        all.all(|comparison| corners.iter().all(|&at| meets(comparison, at)))
    }
}

impl Comparison {
    fn difference(&self, at: DVec3, [low, high]: [DVec3; 2]) -> f64 {
        let value = |side: &Side| match side {
            Side::Value(expression) => expression.at(at, 0.0),
            Side::Lowest(axis) => low[*axis],
            Side::Highest(axis) => high[*axis],
        };
        value(&self.left) - value(&self.right)
    }
}

/// The parts between commas that no parentheses hold.
fn conditions(text: &str) -> Vec<&str> {
    let mut depth = 0_i32;
    let is_comma = |sign: char| {
        depth += i32::from(sign == '(') - i32::from(sign == ')');
        sign == ',' && depth == 0
    };
    text.split(is_comma).map(str::trim).collect()
}

/// The sides of a comparison, and the relations between them.
fn parts(condition: &str) -> (Vec<&str>, Vec<Relation>) {
    let (mut sides, mut relations) = (Vec::new(), Vec::new());
    let mut rest = condition;
    while let Some(at) = rest.find(['=', '<', '>']) {
        let (side, after) = rest.split_at(at);
        sides.push(side.trim());
        relations.push(match after.chars().next() {
            Some('<') => Relation::Below,
            Some('>') => Relation::Above,
            _ => Relation::Equal,
        });
        let after = &after[1..];
        rest = after.strip_prefix('=').unwrap_or(after);
    }
    sides.push(rest.trim());
    (sides, relations)
}

fn side(text: &str, other: &str) -> Result<Side, [String; 2]> {
    if text == "min" || text == "max" {
        let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == other) else {
            let problem = format!("`{text}` is compared with `{other}`");
            let remedy = format!("compare it with a coordinate alone: z = {text}");
            return Err([problem, remedy]);
        };
        return Ok(match text {
            "min" => Side::Lowest(axis),
            _ => Side::Highest(axis),
        });
    }
    let expression = Expression::read(text, 1.0, 0.0)?;
    if expression.depends_on_time() {
        let problem = "the place of faces does not change with time".to_owned();
        return Err([problem, "compare values of x, y, z".into()]);
    }
    Ok(Side::Value(Box::new(expression)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square at an elevation, in a body from (0, 0, 0) to (4, 1, 2).
    fn holds(text: &str, elevation: f64) -> bool {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let corners = corners.map(|(x, y)| DVec3::new(x, y, elevation));
        let place = SurfacePlace::read(text).expect(text);
        place.holds(&corners, [DVec3::ZERO, DVec3::new(4.0, 1.0, 2.0)])
    }

    #[test]
    fn faces_lie_where_all_comparisons_hold() {
        for text in [
            "z = max",
            "max = z",
            "z == 2",
            "x + z <= 3, z>1.9",
            "z = max, 0 < x < 1",
        ] {
            assert!(holds(text, 2.0), "{text}");
            assert!(!holds(text, 0.5), "{text}");
        }
        assert!(holds("z = min", 1e-7) && !holds("z = min", 1e-4));
        assert!(holds("min(x, 5) < 2", 0.0) && !holds("x < 0.5", 0.0));
        assert!(holds("(x - 0.5)^2 + (y - 0.5)^2 = 0.5", 0.0));
    }

    #[test]
    fn what_is_no_place_is_refused() {
        for (text, says) in [
            ("z", "compares nothing"),
            ("", "compares nothing"),
            ("z = max,", "compares nothing"),
            ("x + y = max", "compared with `x + y`"),
            ("z = top", "unknown names: `top`"),
            ("x = time", "time"),
            ("x = ", "empty"),
        ] {
            let [problem, _] = SurfacePlace::read(text).expect_err(text);
            assert!(problem.contains(says), "{text}: {problem}");
        }
    }
}
