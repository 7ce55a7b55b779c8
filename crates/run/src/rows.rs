//! Rows of tables whose values go by the names of their columns.

use glam::DVec3;
use kluft_io::printable::cell;
use kluft_solver::Step;

use crate::spread::Spread;

/// The columns that every row begins with.
pub const HEAD: [&str; 5] = ["step", "time", "phase", "kind", "name"];

/// Values by the names of their columns.
pub struct Row(Vec<(String, String)>);

impl Row {
    /// A row of a load step, counted from 1, that speaks of something of a kind.
    pub fn of((number, step): (usize, &Step), kind: &str, name: &str) -> Self {
        let phase = step.phase.as_deref().unwrap_or_default();
        let time = format!("{:e}", step.load.time);
        let values = [
            number.to_string(),
            time,
            cell(phase),
            kind.to_owned(),
            cell(name),
        ];
        let columns = HEAD.into_iter().map(str::to_owned);
        Self(columns.zip(values).collect())
    }

    fn get(&self, column: &str) -> &str {
        let found = self.0.iter().find(|(name, _)| name == column);
        found.map_or("", |(_, value)| value)
    }

    /// Puts a number into a column.
    pub fn number(&mut self, column: &str, value: f64) {
        self.0.push((column.to_owned(), format!("{value:e}")));
    }

    /// Puts a spread into `column_min`, `column_mean` and `column_max`.
    pub fn spread(&mut self, column: &str, spread: Spread) {
        let Spread { min, mean, max } = spread;
        for (part, value) in [("min", min), ("mean", mean), ("max", max)] {
            self.number(&format!("{column}_{part}"), value);
        }
    }

    /// Puts components into `column_x`, `column_y` and `column_z`.
    pub fn vector(&mut self, column: &str, vector: DVec3) {
        for (axis, value) in ["x", "y", "z"].into_iter().zip(vector.to_array()) {
            self.number(&format!("{column}_{axis}"), value);
        }
    }
}

/// Adds rows to a table, which begins with the names of its columns; what a row does not have is
/// empty.
pub fn add_to(text: &mut String, columns: &[&str], rows: &[Row]) {
    let mut table = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail.
    if text.is_empty() {
        let _ = table.write_record(columns);
    }
    for row in rows {
        let _ = table.write_record(columns.iter().map(|column| row.get(column)));
    }
    let bytes = table.into_inner().unwrap_or_default();
    text.push_str(&String::from_utf8_lossy(&bytes));
}
