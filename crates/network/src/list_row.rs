//! One line of a list of fractures, and the shapes it may describe.

use std::collections::HashMap;

use csv::StringRecord;
use glam::DVec3;
use kluft_defect::{Defect, nearest};
use kluft_mesh::Orientation;

use crate::polygon::{Outline, Polygon};

/// Columns that say how a plane lies, beside dip and dip direction.
const ORIENTATIONS: [&str; 5] = ["trend", "plunge", "normal_x", "normal_y", "normal_z"];
const NORMAL: [&str; 3] = ["normal_x", "normal_y", "normal_z"];
const SHAPES: [&str; 4] = ["disc", "ellipse", "rectangle", "polygon"];

/// Corners of a disc or an ellipse unless the input says otherwise.
pub const SIDES: usize = 12;

/// File and line of a record. Its position is where the search for it began, before the comments
/// and empty lines above it.
pub(crate) fn place_of(record: &StringRecord, text: &str, file: &str) -> String {
    let (line, byte) = record
        .position()
        .map_or((1, 0), |at| (at.line(), at.byte() as usize));
    let above = text.get(byte..).unwrap_or_default().lines();
    let skipped = above.take_while(|line| line.trim().is_empty() || line.starts_with('#'));
    format!("{file}:{}", line + skipped.count() as u64)
}

/// Points out the nearest of the known names, or lists them.
pub(crate) fn suggestion(name: &str, known: &[&str]) -> String {
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known: {}", known.join(", ")),
    }
}

/// How numbers of a list are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decimals {
    /// With a point; a comma may be one between thousands.
    Point,
    /// With a point or a comma.
    PointOrComma,
}

impl Decimals {
    fn read(self, text: &str) -> Option<f64> {
        match self {
            Self::Point => text.parse().ok(),
            Self::PointOrComma => text.replacen(',', ".", 1).parse().ok(),
        }
    }

    /// What to write instead of a text that is not `wanted`.
    fn remedy(self, text: &str, wanted: &str) -> String {
        match Self::PointOrComma.read(text) {
            Some(number) if text.contains(',') && self == Self::Point => {
                format!("write {number}, with a decimal point, or separate values by semicolons")
            }
            _ => format!("write {wanted}"),
        }
    }
}

/// One line of the list.
pub(crate) struct Row<'a> {
    columns: &'a HashMap<&'static str, usize>,
    record: &'a StringRecord,
    decimals: Decimals,
    pub(crate) place: String,
    defects: &'a mut Vec<Defect>,
}

impl<'a> Row<'a> {
    pub(crate) fn new(
        columns: &'a HashMap<&'static str, usize>,
        (record, decimals): (&'a StringRecord, Decimals),
        place: String,
        defects: &'a mut Vec<Defect>,
    ) -> Self {
        Self {
            columns,
            record,
            decimals,
            place,
            defects,
        }
    }

    /// What stands in a column; empty counts as nothing.
    pub(crate) fn text(&self, column: &'static str) -> Option<&'a str> {
        let text = self.record.get(*self.columns.get(column)?)?;
        (!text.is_empty()).then_some(text)
    }

    pub(crate) fn refuse(&mut self, column: &str, problem: &str, remedy: &str) {
        let place = format!("{}, column `{column}`", self.place);
        self.defects.push(Defect::new(place, problem, remedy));
    }

    fn optional(
        &mut self,
        column: &'static str,
        fits: fn(f64) -> bool,
        wanted: &str,
    ) -> Option<f64> {
        let text = self.text(column)?;
        let number = self.decimals.read(text);
        let number = number.filter(|number| number.is_finite() && fits(*number));
        if number.is_none() {
            let remedy = self.decimals.remedy(text, wanted);
            self.refuse(column, &format!("`{text}` is not {wanted}"), &remedy);
        }
        number
    }

    fn number(&mut self, column: &'static str, fits: fn(f64) -> bool, wanted: &str) -> Option<f64> {
        if self.text(column).is_none() {
            self.refuse(column, "the value is missing", &format!("write {wanted}"));
        }
        self.optional(column, fits, wanted)
    }

    fn length(&mut self, column: &'static str) -> Option<f64> {
        self.number(column, |x| x > 0.0, "a length in metres, greater than 0")
    }

    fn rotation(&mut self) -> f64 {
        self.optional("rotation", |_| true, "an angle in degrees")
            .unwrap_or(0.0)
    }

    fn sides(&mut self) -> usize {
        let wanted = "a whole number of sides, 3 to 100";
        let sides = self.optional(
            "sides",
            |n| (3.0..=100.0).contains(&n) && n.fract() == 0.0,
            wanted,
        );
        sides.map_or(SIDES, |sides| sides as usize)
    }

    /// Reports values in columns that mean nothing for this shape.
    fn unused(&mut self, shape: &str, used: &[&str]) {
        let of_shapes = [
            "x",
            "y",
            "z",
            "dip",
            "dip_direction",
            "trend",
            "plunge",
            "normal_x",
            "normal_y",
            "normal_z",
            "strike",
            "radius",
            "semi_major",
            "semi_minor",
            "length",
            "width",
            "rotation",
            "sides",
            "points",
        ];
        for column in of_shapes
            .into_iter()
            .filter(|column| !used.contains(column))
            .filter(|column| !used.contains(&"dip") || !ORIENTATIONS.contains(column))
        {
            if self.text(column).is_some() {
                let problem = format!("a {shape} has no `{column}`");
                self.refuse(
                    column,
                    &problem,
                    &format!("leave it empty; a {shape} has {}", used.join(", ")),
                );
            }
        }
    }
}

/// The polygon that a line describes.
pub(crate) fn polygon(row: &mut Row<'_>) -> Option<Polygon> {
    let shape = row.text("shape").map(str::to_lowercase);
    let outline = match shape.as_deref() {
        Some("polygon") => return through_points(row),
        Some("disc" | "disk") => disc(row),
        Some("ellipse") => ellipse(row),
        Some("rectangle") => rectangle(row),
        Some(other) => {
            let problem = format!("unknown shape `{other}`");
            row.refuse("shape", &problem, &suggestion(other, &SHAPES));
            return None;
        }
        None => {
            row.refuse(
                "shape",
                "the value is missing",
                &format!("write one of {}", SHAPES.join(", ")),
            );
            return None;
        }
    };
    let mut coordinate = |column| row.number(column, |_| true, "a coordinate in metres");
    let (x, y, z) = (coordinate("x"), coordinate("y"), coordinate("z"));
    let orientation = orientation(row);
    Some(Polygon::placed(
        outline?,
        DVec3::new(x?, y?, z?),
        orientation?,
    ))
}

/// How the plane of a line lies: by dip and dip direction, by trend and plunge of its normal, or by
/// its normal.
fn orientation(row: &mut Row<'_>) -> Option<Orientation> {
    let ways = [
        &["dip", "dip_direction", "strike"][..],
        &["trend", "plunge"],
        &NORMAL,
    ];
    let mut given = ways
        .iter()
        .filter(|way| way.iter().any(|c| row.text(c).is_some()));
    let (way, second) = (given.next(), given.next());
    if let Some(second) = second {
        let problem = "the orientation is given in two ways";
        let remedy = "keep dip and dip_direction, trend and plunge, or the normal";
        row.refuse(second[0], problem, remedy);
        return None;
    }
    let steep = |angle: f64| (0.0..=90.0).contains(&angle);
    let turn = |angle: f64| (-360.0..=360.0).contains(&angle);
    let clockwise = "an angle in degrees, clockwise from north";
    match way {
        Some(&["trend", ..]) => {
            let trend = row.number("trend", turn, clockwise);
            let plunge = row.number("plunge", steep, "an angle from 0 to 90 degrees");
            Some(Orientation::of_trend_and_plunge(trend?, plunge?))
        }
        Some(&["normal_x", ..]) => {
            let mut part = |column| row.number(column, |_| true, "a part of a normal");
            let parts = NORMAL.map(&mut part);
            let normal = DVec3::new(parts[0]?, parts[1]?, parts[2]?);
            if normal == DVec3::ZERO {
                row.refuse("normal_x", "the normal has no length", "write one that has");
                return None;
            }
            Some(Orientation::of_normal(normal))
        }
        _ => {
            let dip = row.number("dip", steep, "an angle from 0 to 90 degrees");
            let dip_direction = dip_direction(row);
            Some(Orientation {
                dip: dip?,
                dip_direction: dip_direction?,
            })
        }
    }
}

/// The dip direction, or by the right-hand rule the strike and a quarter turn: who looks along the
/// strike has the dip on the right.
fn dip_direction(row: &mut Row<'_>) -> Option<f64> {
    let turn = |angle: f64| (-360.0..=360.0).contains(&angle);
    let wanted = "an angle in degrees, clockwise from north";
    if row.text("strike").is_none() {
        return row.number("dip_direction", turn, wanted);
    }
    if row.text("dip_direction").is_some() {
        let remedy = "write one of them";
        row.refuse("strike", "there is a dip direction as well", remedy);
    }
    let strike = row.number("strike", turn, wanted)?;
    Some((strike + 90.0) % 360.0)
}

fn disc(row: &mut Row<'_>) -> Option<Outline> {
    row.unused(
        "disc",
        &[
            "x",
            "y",
            "z",
            "dip",
            "dip_direction",
            "strike",
            "radius",
            "rotation",
            "sides",
        ],
    );
    let (radius, rotation, sides) = (row.length("radius"), row.rotation(), row.sides());
    Some(Outline::Disc {
        radius: radius?,
        sides,
        rotation,
    })
}

fn ellipse(row: &mut Row<'_>) -> Option<Outline> {
    let used = [
        "x",
        "y",
        "z",
        "dip",
        "dip_direction",
        "strike",
        "semi_major",
        "semi_minor",
        "rotation",
        "sides",
    ];
    row.unused("ellipse", &used);
    let (semi_major, semi_minor) = (row.length("semi_major"), row.length("semi_minor"));
    let (rotation, sides) = (row.rotation(), row.sides());
    Some(Outline::Ellipse {
        semi_major: semi_major?,
        semi_minor: semi_minor?,
        rotation,
        sides,
    })
}

fn rectangle(row: &mut Row<'_>) -> Option<Outline> {
    row.unused(
        "rectangle",
        &[
            "x",
            "y",
            "z",
            "dip",
            "dip_direction",
            "strike",
            "length",
            "width",
            "rotation",
        ],
    );
    let (length, width, rotation) = (row.length("length"), row.length("width"), row.rotation());
    Some(Outline::Rectangle {
        length: length?,
        width: width?,
        rotation,
    })
}

fn through_points(row: &mut Row<'_>) -> Option<Polygon> {
    row.unused("polygon", &["points"]);
    let remedy = "write \"x y z; x y z; x y z\", three points or more, in metres";
    let Some(text) = row.text("points") else {
        row.refuse("points", "the value is missing", remedy);
        return None;
    };
    let decimals = row.decimals;
    let point = |text: &str| -> Option<DVec3> {
        let numbers: Vec<f64> = text
            .split_whitespace()
            .map_while(|word| decimals.read(word))
            .collect();
        let is_whole = numbers.len() == text.split_whitespace().count();
        let point = DVec3::from(<[f64; 3]>::try_from(numbers).ok()?);
        (is_whole && point.is_finite()).then_some(point)
    };
    let mut corners = Vec::new();
    for text in text.trim_end_matches(';').split(';') {
        let Some(corner) = point(text) else {
            row.refuse(
                "points",
                &format!("`{}` is not a point", text.trim()),
                remedy,
            );
            return None;
        };
        corners.push(corner);
    }
    Polygon::through(&corners)
        .map_err(|(problem, remedy)| row.refuse("points", &problem, &remedy))
        .ok()
}
