//! Reads a list of fractures: one line a fracture, the header names the columns.

use std::collections::HashMap;

use csv::{ReaderBuilder, StringRecord, Trim};
use glam::DVec3;
use lie_mesh::Defect;

use crate::network::Given;
use crate::orientation::Orientation;
use crate::polygon::{Outline, Polygon, check_name};

const COLUMNS: [&str; 17] = [
    "name",
    "set",
    "shape",
    "x",
    "y",
    "z",
    "dip",
    "dip_direction",
    "radius",
    "semi_major",
    "semi_minor",
    "length",
    "width",
    "rotation",
    "sides",
    "points",
    "comment",
];

const SHAPES: [&str; 4] = ["disc", "ellipse", "rectangle", "polygon"];

/// Corners of a disc or an ellipse unless the list says otherwise.
pub const SIDES: usize = 12;

/// Reads the text of a list; `file` is for messages. Fractures of a line without a set belong to
/// `set`, and a line may name no other if `only` is given.
///
/// # Errors
/// Every defect with its line and column, and a remedy.
pub fn read_list(text: &str, file: &str, set: &str, only: bool) -> Result<Vec<Given>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut fractures = Vec::new();
    let mut reader = ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let columns = match reader.headers() {
        Ok(headers) => columns(headers, text, file, &mut defects),
        Err(error) => return Err(vec![broken(file, &error)]),
    };
    for (number, record) in reader.records().enumerate() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                defects.push(broken(file, &error));
                continue;
            }
        };
        let mut row = Row::new(&columns, &record, (text, file), &mut defects);
        if columns.contains_key("shape") {
            fractures.extend(fracture(&mut row, number, set, only));
        }
    }
    repeated_names(&fractures, &mut defects);
    if defects.is_empty() {
        Ok(fractures)
    } else {
        Err(defects)
    }
}

fn broken(file: &str, error: &csv::Error) -> Defect {
    let line = error.position().map_or(1, csv::Position::line);
    let remedy = "write UTF-8 text, with quotes around values that hold a comma";
    Defect::new(format!("{file}:{line}"), error.to_string(), remedy)
}

/// File and line of a record. Its position is where the search for it began, before the comments
/// and empty lines above it.
fn place(record: &StringRecord, text: &str, file: &str) -> String {
    let (line, byte) = record
        .position()
        .map_or((1, 0), |at| (at.line(), at.byte() as usize));
    let above = text.get(byte..).unwrap_or_default().lines();
    let skipped = above.take_while(|line| line.trim().is_empty() || line.starts_with('#'));
    format!("{file}:{}", line + skipped.count() as u64)
}

/// Number of each known column; unknown, doubled and missing ones are defects.
fn columns(
    headers: &StringRecord,
    text: &str,
    file: &str,
    defects: &mut Vec<Defect>,
) -> HashMap<&'static str, usize> {
    let place = place(headers, text, file);
    let mut found = HashMap::new();
    for (index, name) in headers.iter().enumerate() {
        let name = name.trim_start_matches('\u{feff}');
        let known = COLUMNS.iter().copied().find(|known| *known == name);
        let Some(known) = known else {
            defects.push(Defect::new(
                &place,
                format!("unknown column `{name}`"),
                suggestion(name, &COLUMNS),
            ));
            continue;
        };
        if found.insert(known, index).is_some() {
            defects.push(Defect::new(
                &place,
                format!("column `{name}` stands twice"),
                "remove one of them",
            ));
        }
    }
    if !found.contains_key("shape") && defects.is_empty() {
        let remedy =
            "begin with a line of column names, e.g. name,shape,x,y,z,dip,dip_direction,radius";
        defects.push(Defect::new(&place, "there is no column `shape`", remedy));
    }
    found
}

/// Points out the nearest of the known names, or lists them.
fn suggestion(name: &str, known: &[&str]) -> String {
    let alike = |known: &&&str| (strsim::normalized_damerau_levenshtein(name, known) * 1e6) as u64;
    match known
        .iter()
        .max_by_key(alike)
        .filter(|near| alike(near) >= 500_000)
    {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known: {}", known.join(", ")),
    }
}

fn repeated_names(fractures: &[Given], defects: &mut Vec<Defect>) {
    let mut first: HashMap<&str, &str> = HashMap::new();
    for fracture in fractures {
        if let Some(other) = first.insert(&fracture.name, &fracture.place) {
            let problem = format!("the name `{}` is taken ({other})", fracture.name);
            defects.push(Defect::new(
                &fracture.place,
                problem,
                "give each fracture a name of its own",
            ));
        }
    }
}

/// One line of the list.
struct Row<'a> {
    columns: &'a HashMap<&'static str, usize>,
    record: &'a StringRecord,
    place: String,
    defects: &'a mut Vec<Defect>,
}

impl<'a> Row<'a> {
    fn new(
        columns: &'a HashMap<&'static str, usize>,
        record: &'a StringRecord,
        (text, file): (&str, &str),
        defects: &'a mut Vec<Defect>,
    ) -> Self {
        Self {
            columns,
            record,
            place: place(record, text, file),
            defects,
        }
    }

    /// What stands in a column; empty counts as nothing.
    fn text(&self, column: &'static str) -> Option<&'a str> {
        let text = self.record.get(*self.columns.get(column)?)?;
        (!text.is_empty()).then_some(text)
    }

    fn refuse(&mut self, column: &str, problem: &str, remedy: &str) {
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
        let number = text
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite() && fits(*number));
        if number.is_none() {
            self.refuse(
                column,
                &format!("`{text}` is not {wanted}"),
                &format!("write {wanted}"),
            );
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

fn fracture(row: &mut Row<'_>, number: usize, set: &str, only: bool) -> Option<Given> {
    let named_set = row.text("set").unwrap_or(set).to_owned();
    if only && named_set != set {
        let remedy = format!("leave the column out, or write {set}");
        row.refuse(
            "set",
            &format!("set `{named_set}` in the list of set `{set}`"),
            &remedy,
        );
    }
    let name = row
        .text("name")
        .map_or_else(|| format!("{named_set}-{}", number + 1), str::to_owned);
    for (column, name) in [("name", &name), ("set", &named_set)] {
        if let Err((problem, remedy)) = check_name(name) {
            row.refuse(column, &problem, &remedy);
        }
    }
    Some(Given {
        name,
        set: named_set,
        place: row.place.clone(),
        polygon: polygon(row)?,
    })
}

fn polygon(row: &mut Row<'_>) -> Option<Polygon> {
    let outline = match row.text("shape") {
        Some("polygon") => return through_points(row),
        Some("disc") => disc(row),
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
    let dip = row.number(
        "dip",
        |dip| (0.0..=90.0).contains(&dip),
        "an angle from 0 to 90 degrees",
    );
    let turn = |angle: f64| (-360.0..=360.0).contains(&angle);
    let dip_direction = row.number(
        "dip_direction",
        turn,
        "an angle in degrees, clockwise from north",
    );
    let orientation = Orientation {
        dip: dip?,
        dip_direction: dip_direction?,
    };
    Some(Polygon::placed(
        outline?,
        DVec3::new(x?, y?, z?),
        orientation,
    ))
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
    let point = |text: &str| -> Option<DVec3> {
        let numbers: Vec<f64> = text
            .split_whitespace()
            .map_while(|word| word.parse().ok())
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

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = "\
# four fractures
name, set, shape, x, y, z, dip, dip_direction, radius, semi_major, semi_minor, length, width, rotation, points
a, north, disc, 1, 2, 3, 30, 90, 2,,,,,,
b, north, ellipse, 1, 2, 3, 30, 90,, 2, 1,,, 45,
# a comment between
c, , rectangle, 1, 2, 3, 90, 0,,,, 4, 2,,
d, , polygon,,,,,,,,,,,, 0 0 0; 2 0 0; 0 2 0
";

    #[test]
    fn every_shape_is_read() {
        let list = read_list(LIST, "list.csv", "rest", false).expect("a list");
        let pi = std::f64::consts::PI;
        for (fracture, (name, set, area)) in list.iter().zip([
            ("a", "north", 4.0 * pi),
            ("b", "north", 2.0 * pi),
            ("c", "rest", 8.0),
            ("d", "rest", 2.0),
        ]) {
            assert_eq!((fracture.name.as_str(), fracture.set.as_str()), (name, set));
            assert!((fracture.polygon.area() - area).abs() < 1e-12);
        }
        assert_eq!(list.len(), 4);
        assert_eq!(list[2].place, "list.csv:6");
    }

    #[test]
    fn every_defect_is_told_at_once_with_line_and_column() {
        let text = LIST
            .replace("disc, 1", "disk, one")
            .replace("ellipse, 1", "ellipse, one")
            .replace("rectangle, 1, 2, 3, 90", "rectangle, 1, 2, 3, 95")
            .replace("2 0 0;", "2 0;");
        let defects = read_list(&text, "list.csv", "rest", false).expect_err("defects");
        let text: Vec<String> = defects.iter().map(ToString::to_string).collect();
        for (defect, parts) in text.iter().zip([
            ["list.csv:3, column `shape`", "did you mean `disc`?"],
            ["list.csv:4, column `x`", "`one` is not a coordinate"],
            ["list.csv:6, column `dip`", "0 to 90"],
            ["list.csv:7, column `points`", "`2 0` is not a point"],
        ]) {
            assert!(parts.iter().all(|part| defect.contains(part)), "{defect}");
        }
        assert_eq!(text.len(), 4, "{text:#?}");
    }

    #[test]
    fn misspelt_columns_are_told_with_the_nearest() {
        let text = LIST.replace("dip_direction,", "dip_diretion,");
        let defects = read_list(&text, "list.csv", "rest", false).expect_err("defects");
        assert!(defects[0].problem.contains("`dip_diretion`"));
        assert!(defects[0].remedy.contains("`dip_direction`"));
    }

    #[test]
    fn names_stand_once() {
        let text = LIST.replace("\nb,", "\na,");
        let defects = read_list(&text, "list.csv", "rest", false).expect_err("defects");
        assert!(
            defects[0].problem.contains("`a` is taken (list.csv:3)"),
            "{}",
            defects[0]
        );
    }

    #[test]
    fn other_sets_are_refused_in_the_list_of_one() {
        let defects = read_list(LIST, "list.csv", "rest", true).expect_err("defects");
        assert_eq!(defects.len(), 2);
    }

    #[test]
    fn values_of_other_shapes_are_refused() {
        let text = LIST.replace("disc, 1, 2, 3, 30, 90, 2,,", "disc, 1, 2, 3, 30, 90, 2, 5,");
        let defects = read_list(&text, "list.csv", "rest", false).expect_err("defects");
        assert!(
            defects[0].problem.contains("a disc has no `semi_major`"),
            "{}",
            defects[0]
        );
    }
}
