//! Tables of numbers.

/// Numbers of a study.
#[derive(Debug, Clone)]
pub struct Table {
    /// Names of the columns, with units.
    pub head: Vec<&'static str>,
    /// One entry for each column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(head: &[&'static str]) -> Self {
        Self {
            head: head.to_vec(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        assert_eq!(row.len(), self.head.len(), "an entry for each column");
        self.rows.push(row.to_vec());
    }

    /// Place of a column.
    ///
    /// # Panics
    /// If there is none of that name.
    pub fn column(&self, name: &str) -> usize {
        let found = self.head.iter().position(|head| *head == name);
        found.unwrap_or_else(|| panic!("no column {name}"))
    }

    /// Its text with commas; entries that have one are quoted.
    pub fn csv(&self) -> String {
        let rows = self
            .rows
            .iter()
            .map(|row| row.iter().map(String::as_str).collect());
        let head = std::iter::once(self.head.clone());
        head.chain(rows).map(csv_line).collect()
    }

    /// As a page prints it.
    pub fn markdown(&self) -> String {
        let rule = format!("|{}\n", "---|".repeat(self.head.len()));
        let rows = self.rows.iter();
        let rows = rows.map(|row| format!("| {} |\n", row.join(" | ")));
        format!("| {} |\n{rule}", self.head.join(" | ")) + &rows.collect::<String>()
    }
}

fn csv_line(entries: Vec<&str>) -> String {
    let quoted = entries.into_iter().map(|entry| {
        if entry.contains([',', '"']) {
            format!("\"{}\"", entry.replace('"', "\"\""))
        } else {
            entry.to_owned()
        }
    });
    quoted.collect::<Vec<String>>().join(",") + "\n"
}
