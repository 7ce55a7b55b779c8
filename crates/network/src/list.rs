//! Reads a list of fractures: one line a fracture, the header names the columns.

use std::collections::HashMap;

use csv::{ReaderBuilder, StringRecord, Trim};
use kluft_defect::Defect;

use crate::fracture::InputFracture;
use crate::list_row::{Decimals, Row, place_of, polygon, suggestion};
use crate::polygon::check_name;

const COLUMNS: [&str; 23] = [
    "name",
    "set",
    "shape",
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
    "comment",
];

/// Other names of columns, as geologists and their programs write them.
const OTHER_NAMES: [(&str, &str); 8] = [
    ("easting", "x"),
    ("northing", "y"),
    ("elevation", "z"),
    ("id", "name"),
    ("dipdir", "dip_direction"),
    ("dip_dir", "dip_direction"),
    ("dip_azimuth", "dip_direction"),
    ("azimuth", "dip_direction"),
];

/// Reads the text of a list; `file` is for messages. Fractures of a line without a set belong to
/// `set`, and a line may name no other if `only` is given.
///
/// # Errors
/// Every defect with its line and column, and a remedy.
pub fn read_list(
    text: &str,
    file: &str,
    set: &str,
    only: bool,
) -> Result<Vec<InputFracture>, Vec<Defect>> {
    let mut defects = Vec::new();
    let mut fractures = Vec::new();
    let decimals = decimals(text);
    let separator = match decimals {
        Decimals::Point => b',',
        Decimals::PointOrComma => b';',
    };
    let mut reader = ReaderBuilder::new()
        .delimiter(separator)
        .comment(Some(b'#'))
        .trim(Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let headers = match reader.headers() {
        Ok(headers) => headers.clone(),
        Err(error) => return Err(vec![broken(file, &error)]),
    };
    let columns = columns(&headers, text, file, &mut defects);
    for (number, record) in reader.records().enumerate() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                defects.push(broken(file, &error));
                continue;
            }
        };
        let place = place_of(&record, text, file);
        if let Some(defect) = torn(&headers, &record, text, &place)
            .or_else(|| surplus(&headers, &record, decimals, &place))
        {
            defects.push(defect);
            continue;
        }
        let mut row = Row::new(&columns, (&record, decimals), place, &mut defects);
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

/// How numbers are written: with decimal commas, too, if semicolons separate the column names.
fn decimals(text: &str) -> Decimals {
    let mut lines = text.lines().map(str::trim);
    let head = lines.find(|line| !line.is_empty() && !line.starts_with('#'));
    match head {
        Some(head) if head.contains(';') && !head.contains(',') => Decimals::PointOrComma,
        _ => Decimals::Point,
    }
}

/// A line whose quotes are not closed: the values that follow, on other lines too, would belong to
/// the one that the quote opens.
fn torn(headers: &StringRecord, record: &StringRecord, text: &str, place: &str) -> Option<Defect> {
    let start = record.position().map_or(0, |at| at.byte() as usize);
    let mut behind = text.get(start..).unwrap_or_default().lines();
    let line = behind.find(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let mut values = line
        .unwrap_or_default()
        .split([',', ';'])
        .map(str::trim_start);
    let opens = values.any(|value| value.starts_with('"'));
    let is_odd = line.unwrap_or_default().matches('"').count() % 2 == 1;
    let last = record.len().checked_sub(1)?;
    let swallows = |value: &str| value.contains(['\n', '\r']);
    let column = match record.iter().position(swallows) {
        Some(column) => column,
        // It ends at a quote of a later value, or at the end of the file.
        None if opens && is_odd => {
            let mut columns = (0..record.len()).rev();
            let holds_more = |column: &usize| record[*column].contains([',', ';']);
            columns.find(holds_more).unwrap_or(last)
        }
        None => return None,
    };
    let place = match headers.get(column) {
        Some(name) => format!("{place}, column `{name}`"),
        None => place.to_owned(),
    };
    let remedy = "close it on the same line, or remove it";
    Some(Defect::new(
        place,
        "a quote is opened here and not closed",
        remedy,
    ))
}

/// A line with more values than there are columns: which of them belongs where, nobody knows.
fn surplus(
    headers: &StringRecord,
    record: &StringRecord,
    decimals: Decimals,
    place: &str,
) -> Option<Defect> {
    let mut behind = record.iter().skip(headers.len());
    if behind.all(str::is_empty) {
        return None;
    }
    let (found, wanted) = (record.len(), headers.len());
    let remedy = match decimals {
        Decimals::PointOrComma => {
            "write one value for each column, with quotes around values that hold a semicolon"
        }
        Decimals::Point => {
            "write one value for each column: decimal points in the place of decimal commas (or \
             semicolons between the values), and quotes around values that hold a comma"
        }
    };
    Some(Defect::new(
        place,
        format!("the line has {found} values for {wanted} columns"),
        remedy,
    ))
}

fn broken(file: &str, error: &csv::Error) -> Defect {
    let line = error.position().map_or(1, csv::Position::line);
    let remedy = "write UTF-8 text, with quotes around values that hold a comma";
    Defect::new(format!("{file}:{line}"), error.to_string(), remedy)
}

/// Number of each known column; unknown, doubled and missing ones are defects.
fn columns(
    headers: &StringRecord,
    text: &str,
    file: &str,
    defects: &mut Vec<Defect>,
) -> HashMap<&'static str, usize> {
    let place = place_of(headers, text, file);
    let mut found = HashMap::new();
    for (index, name) in headers.iter().enumerate() {
        let name = name.trim_start_matches('\u{feff}');
        let plain = name.to_lowercase().replace([' ', '-'], "_");
        let other = OTHER_NAMES.iter().find(|(other, _)| *other == plain);
        let meant = other.map_or(&*plain, |(_, meant)| meant);
        let known = COLUMNS.iter().copied().find(|known| *known == meant);
        let Some(known) = known else {
            defects.push(Defect::new(
                &place,
                format!("unknown column `{name}`"),
                suggestion(name, &COLUMNS),
            ));
            continue;
        };
        if let Some(first) = found.insert(known, index) {
            let problem = match headers.get(first) {
                Some(first) if first != name => {
                    format!("columns `{first}` and `{name}` mean the same: {known}")
                }
                _ => format!("column `{name}` stands twice"),
            };
            defects.push(Defect::new(&place, problem, "remove one of them"));
        }
    }
    if !found.contains_key("shape") && defects.is_empty() {
        let remedy =
            "begin with a line of column names, e.g. name,shape,x,y,z,dip,dip_direction,radius";
        defects.push(Defect::new(&place, "there is no column `shape`", remedy));
    }
    found
}

/// Reports every fracture whose name another one before it has.
pub fn repeated_names(fractures: &[InputFracture], defects: &mut Vec<Defect>) {
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

fn fracture(row: &mut Row<'_>, number: usize, set: &str, only: bool) -> Option<InputFracture> {
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
    Some(InputFracture {
        name,
        set: named_set,
        place: row.place.clone(),
        polygon: polygon(row)?,
    })
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
    fn geologists_words_mean_the_same() {
        let read = |head: &str, value: &str, shape: &str| {
            let text = format!("shape,x,y,z,dip,radius,{head}\n{shape},1,2,3,30,2,{value}\n");
            read_list(&text, "list.csv", "rest", false).map(|list| list[0].polygon.clone())
        };
        let plain = read("dip_direction", "135", "disc").expect("a list");
        for (head, value, shape) in [
            ("dipdir", "135", "disc"),
            ("azimuth", "135", "disk"),
            ("dip_azimuth", "135", "disc"),
            ("strike", "45", "disc"),
            ("strike", "-315", "disk"),
            ("Dip Direction", "135", "Disc"),
            ("DIP-DIR", "135", "DISK"),
        ] {
            let found = read(head, value, shape).expect(head);
            let corners = plain.corners().iter().zip(found.corners());
            let apart = corners.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(apart < 1e-12, "{head} {shape}: {apart}");
        }
        let both = read("dipdir,strike", "135,45", "disc").expect_err("two directions");
        assert!(both[0].to_string().contains("column `strike`"), "{both:?}");
        let twice = read("dipdir,azimuth", "135,135", "disc").expect_err("a column twice");
        let twice = twice[0].to_string();
        assert!(
            twice.contains("`dipdir` and `azimuth` mean the same: dip_direction"),
            "{twice}"
        );
        let surveyed = "Shape,Easting,Northing,Elevation,Dip,Azimuth,Radius\ndisc,1,2,3,30,135,2\n";
        let found = read_list(surveyed, "list.csv", "rest", false).expect("a list");
        assert_eq!(found[0].polygon.corners(), plain.corners());
    }

    #[test]
    fn every_defect_is_told_at_once_with_line_and_column() {
        let text = LIST
            .replace("disc, 1", "dics, one")
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

    #[test]
    fn values_beyond_the_columns_are_refused_with_the_decimal_comma_as_a_remedy() {
        let text = "name,set,shape,x,y,z,dip,dip_direction,radius\n\
            f1,s,disc,5,1,5,2,5,3,70,135,3,0\n\
            f2,s,disc,5,1,5,70,135,3,,\n\
            f3,s,disc,\"5,5\",1,5,70,135,3\n";
        let defects = read_list(text, "list.csv", "rest", false).expect_err("defects");
        let text: Vec<String> = defects.iter().map(ToString::to_string).collect();
        assert_eq!(text.len(), 2, "{text:#?}");
        for part in [
            "list.csv:2: the line has 13 values for 9 columns",
            "decimal points",
        ] {
            assert!(text[0].contains(part), "{}", text[0]);
        }
        for part in [
            "list.csv:4, column `x`: `5,5` is not",
            "write 5.5, with a decimal point",
        ] {
            assert!(text[1].contains(part), "{}", text[1]);
        }
    }

    #[test]
    fn semicolons_separate_values_with_decimal_commas() {
        let commas = "# meant in metres\nname;shape;x;y;z;dip;dip_direction;radius;points\n\
            f1;disc;5,1;5,2;5.3;70;135;3,0;\n\
            f2;polygon;;;;;;;\"0 0 0; 2,5 0 0; 0 2 0\"\n";
        let points = "name,shape,x,y,z,dip,dip_direction,radius,points\n\
            f1,disc,5.1,5.2,5.3,70,135,3.0,\nf2,polygon,,,,,,,0 0 0; 2.5 0 0; 0 2 0\n";
        let [commas, points] = [commas, points].map(|text| {
            let list = read_list(text, "list.csv", "rest", false)
                .expect("a list")
                .into_iter();
            list.map(|one| (one.name, one.polygon)).collect::<Vec<_>>()
        });
        assert_eq!(commas, points);
    }

    #[test]
    fn a_quote_that_is_not_closed_is_told_where_it_opens() {
        let closed = "name,shape,x,y,z,dip,dip_direction,radius,comment\n\
            a,disc,1,2,3,30,90,2,\"in, the tunnel\"\nb,disc,1,2,3,30,90,2,\"a 5\"\" pipe\"\n";
        assert!(read_list(closed, "list.csv", "rest", false).is_ok());
        for (from, to, place) in [
            ("a,disc", "a,\"disc", "list.csv:2, column `shape`"),
            ("tunnel\"", "tunnel", "list.csv:2, column `comment`"),
            ("b,disc", "b,\"disc", "list.csv:3, column `shape`"),
            ("pipe\"\n", "pipe\n", "list.csv:3, column `comment`"),
            ("pipe\"\n", "pipe", "list.csv:3, column `comment`"),
        ] {
            let text = closed.replace(from, to);
            let defects = read_list(&text, "list.csv", "rest", false).expect_err(to);
            let text = defects[0].to_string();
            assert!(
                text.contains(place) && text.contains("not closed"),
                "{to}: {text}"
            );
            assert_eq!(defects.len(), 1, "{defects:#?}");
        }
    }
}
