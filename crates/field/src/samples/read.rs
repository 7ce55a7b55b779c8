//! Reads samples from CSV files.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use glam::DVec3;
use kluft_defect::ordinary_text;

use super::between::Samples;
use super::sample::{Method, Sample};
use crate::coordinate::Beyond;

/// Most rows that are named one by one.
const NAMED: usize = 5;
/// Names of the columns that are coordinates (m).
const AXES: [&str; 3] = ["x", "y", "z"];

/// A table of samples: a row of names, then a row for each sample.
#[derive(Debug, Clone, Copy)]
pub struct SampleFile<'a> {
    /// The file.
    pub path: &'a Path,
    /// The column of the values.
    pub column: &'a str,
    /// Factor on them.
    pub factor: f64,
    /// How values between samples follow.
    pub method: Method,
    /// What holds beyond them.
    pub beyond: Beyond,
}

/// A defect: what is wrong, and what helps.
type Found = [String; 2];

impl SampleFile<'_> {
    /// Reads the samples. Columns `x`, `y`, `z` are their coordinates (m); in one that is not there
    /// the values do not vary. Lines that begin with `#` are comments.
    ///
    /// # Errors
    /// Every defect of the file: what is wrong with its line, and what helps.
    pub fn read(&self) -> Result<Samples, Vec<Found>> {
        let text = self.text().map_err(|found| vec![found])?;
        let mut reader = ReaderBuilder::new()
            .delimiter(delimiter(&text))
            .comment(Some(b'#'))
            .trim(Trim::All)
            .from_reader(text.as_bytes());
        let header = reader
            .headers()
            .cloned()
            .map_err(|error| self.unreadable(&error))?;
        let columns = self.columns(&header)?;
        let given = DVec3::from(columns.axes.map(|axis| f64::from(axis.is_some())));
        let mut rows = Rows::default();
        for record in reader.records() {
            match record {
                Ok(record) => rows.add(self, &columns, &record),
                Err(error) => rows.defects.extend(self.unreadable(&error)),
            }
        }
        let all = rows.finish(self)?;
        Samples::new(all, given, (self.method, self.beyond))
            .map_err(|[problem, remedy]| vec![[self.of_file(&problem), remedy]])
    }

    fn text(&self) -> Result<String, Found> {
        match ordinary_text(self.path) {
            Ok(text) => Ok(text.trim_start_matches('\u{feff}').to_owned()),
            Err(error) if error.kind() == ErrorKind::InvalidData => Err([
                self.of_file("is no text in UTF-8"),
                "save it as UTF-8".into(),
            ]),
            Err(error) => Err([
                self.of_file(&format!("cannot be read: {error}")),
                "give the path of a CSV file, relative to the folder of the scene".into(),
            ]),
        }
    }

    fn of_file(&self, problem: &str) -> String {
        format!("`{}`: {problem}", self.path.display())
    }

    fn unreadable(&self, error: &csv::Error) -> Vec<Found> {
        let remedy = "let every line have as many values as the first has names";
        vec![[self.of_file(&error.to_string()), remedy.to_owned()]]
    }

    fn columns(&self, header: &StringRecord) -> Result<Columns, Vec<Found>> {
        let places = |name: &str| -> Vec<usize> {
            let all = header.iter().enumerate();
            let own = all.filter(|(_, other)| other.eq_ignore_ascii_case(name));
            own.map(|(place, _)| place).collect()
        };
        let names: Vec<&str> = header.iter().collect();
        let names = names.join("`, `");
        let mut defects = Vec::new();
        let mut twice = |name: &str| {
            let found = places(name);
            if found.len() > 1 {
                let problem = self.of_file(&format!("two columns are called `{name}`"));
                defects.push([problem, "keep one of them".to_owned()]);
            }
            found.first().copied()
        };
        let axes = AXES.map(&mut twice);
        let value = twice(self.column);
        if axes.iter().all(Option::is_none) {
            let problem = format!("no column is called `x`, `y` or `z`: there are `{names}`");
            let remedy = "name the columns of the coordinates (m) x, y and z in the first line";
            defects.push([self.of_file(&problem), remedy.to_owned()]);
        }
        let Some(value) = value else {
            let problem = format!("no column is called `{}`", self.column);
            let remedy = format!("name one of its columns: `{names}`");
            defects.push([self.of_file(&problem), remedy]);
            return Err(defects);
        };
        match defects.is_empty() {
            true => Ok(Columns { axes, value }),
            false => Err(defects),
        }
    }
}

/// Semicolons or tabs where the first line has no comma.
fn delimiter(text: &str) -> u8 {
    let header = text.lines().find(|line| !line.starts_with('#'));
    let has = |c: char| header.is_some_and(|line| line.contains(c));
    if has(';') && !has(',') {
        b';'
    } else if has('\t') && !has(',') {
        b'\t'
    } else {
        b','
    }
}

/// Where the numbers stand in a row.
struct Columns {
    axes: [Option<usize>; 3],
    value: usize,
}

#[derive(Default)]
struct Rows {
    all: Vec<Sample>,
    /// Line of each position, by the bits of its coordinates.
    lines: BTreeMap<[u64; 3], u64>,
    defects: Vec<Found>,
}

impl Rows {
    fn add(&mut self, file: &SampleFile<'_>, columns: &Columns, record: &StringRecord) {
        let line = record.position().map_or(0, csv::Position::line);
        let mut number = |place: usize| {
            let text = record.get(place).unwrap_or_default();
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            if number.is_none() {
                let problem = format!("line {line}: `{text}` is no finite number");
                let remedy = "write a number with a decimal point, or take the line out";
                self.defects
                    .push([file.of_file(&problem), remedy.to_owned()]);
            }
            number
        };
        let axes = columns.axes.map(|axis| axis.map_or(Some(0.0), &mut number));
        let value = number(columns.value);
        let ([Some(x), Some(y), Some(z)], Some(value)) = (axes, value) else {
            return;
        };
        // 0 and -0 are one place.
        let key = [x, y, z].map(|x| (x + 0.0).to_bits());
        if let Some(first) = self.lines.insert(key, line) {
            let problem = format!("line {line}: the position of line {first} again");
            self.defects
                .push([file.of_file(&problem), "keep one of them".to_owned()]);
        }
        self.all.push(Sample {
            position: DVec3::new(x, y, z),
            value: file.factor * value,
        });
    }

    fn finish(mut self, file: &SampleFile<'_>) -> Result<Vec<Sample>, Vec<Found>> {
        if self.all.is_empty() && self.defects.is_empty() {
            let remedy = "write a line of numbers for each sample below the line of names";
            self.defects
                .push([file.of_file("there are no samples"), remedy.to_owned()]);
        }
        let more = self.defects.len().saturating_sub(NAMED);
        self.defects.truncate(NAMED);
        if let (Some(last), true) = (self.defects.last_mut(), more > 0) {
            last[0] += &format!(" (and {more} more lines have defects)");
        }
        match self.defects.is_empty() {
            true => Ok(self.all),
            false => Err(self.defects),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Samples, Vec<Found>> {
        let name = format!("kluft-field-{}-{:p}.csv", std::process::id(), text.as_ptr());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, text).expect("written");
        let file = SampleFile {
            path: &path,
            column: "kn",
            factor: 1e9,
            method: Method::Nearest,
            beyond: Beyond::Refuse,
        };
        let samples = file.read();
        std::fs::remove_file(&path).expect("removed");
        samples
    }

    #[test]
    fn columns_are_found_by_their_names_in_any_order() {
        for text in [
            "# a scan\nkn,Y,x,note\n2,0,0,a\n5,10,0,b\n",
            "\u{feff}x;kn;y\n0;2;0\n0;5;10\n",
        ] {
            let samples = read(text).expect(text);
            assert_eq!(samples.count(), 2);
            assert_eq!(samples.at(DVec3::new(3.0, 8.0, 99.0)), 5e9);
        }
    }

    #[test]
    fn every_defect_of_a_file_is_named_with_its_line() {
        for (text, says) in [
            (
                "x,kn\n0,1\n1,nan\n2,\n0,3\n",
                vec![
                    "line 3: `nan`",
                    "line 4: ``",
                    "line 5: the position of line 2",
                ],
            ),
            ("x,y\n0,1\n", vec!["no column is called `kn`"]),
            ("a,kn\n0,1\n", vec!["no column is called `x`"]),
            ("x,kn\n", vec!["no samples"]),
            ("x,kn,kn\n0,1,2\n", vec!["two columns are called `kn`"]),
            ("x,kn\n0,1,2\n", vec!["line: 2"]),
            ("x,kn\na,b\nc,d\ne,f\ng,h\n", vec!["line 2", "3 more"]),
        ] {
            let defects = read(text).expect_err(text);
            let all: Vec<String> = defects.into_iter().flatten().collect();
            for says in says {
                assert!(all.join("\n").contains(says), "{text}: {all:?}");
            }
        }
    }
}
