//! Studies, what they find, and the pages that say so.
//!
//! A study is a name, a heading and a function; what it finds is a list of parts, in the order in
//! which a page has them. One writer makes all pages of it.

mod markdown;
mod numbers;
mod table;
mod writer;

use kluft_chart::Chart;

pub use numbers::{digits, largest, missed, percent};
pub use table::Table;
pub use writer::{Layout, Report};

/// How much of a study to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// A few values, for tests.
    Quick,
    /// All that its page shows.
    Full,
}

/// Something that is run, and written about.
#[derive(Debug, Clone, Copy)]
pub struct Study {
    /// Name on the command line and of its files.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What the overview says of it: what it sweeps and how far, or whose closed form it has.
    pub subject: &'static str,
    /// Runs it.
    pub run: fn(Effort) -> Finding,
}

/// What a study found.
#[derive(Debug, Clone)]
pub struct Finding {
    /// Its entries in the overview, in a few words each.
    pub summary: Vec<String>,
    /// What its page says, in order.
    pub parts: Vec<Part>,
    /// Cases in which the program did not hold what is promised.
    pub misses: Vec<String>,
}

/// A part of a page.
#[derive(Debug, Clone)]
pub enum Part {
    /// A heading.
    Heading(&'static str),
    /// Paragraphs, empty lines between them; indented ones stay as they are.
    Text(String),
    /// A chart by the name of its file.
    Chart(&'static str, Chart),
    /// Numbers in a file of their own.
    Numbers(Numbers),
}

/// A table in a file.
#[derive(Debug, Clone)]
pub struct Numbers {
    /// Name of the file; that of the study if there is none.
    pub name: Option<&'static str>,
    /// Its rows.
    pub table: Table,
    /// Whether the page has the table too, if it is short.
    pub is_shown: bool,
}

impl Finding {
    /// A finding that so far is its entries in the overview.
    pub fn new<const N: usize>(summary: [String; N]) -> Self {
        Self {
            summary: summary.into(),
            parts: Vec::new(),
            misses: Vec::new(),
        }
    }

    fn with(mut self, part: Part) -> Self {
        self.parts.push(part);
        self
    }

    /// Adds a heading.
    pub fn heading(self, heading: &'static str) -> Self {
        self.with(Part::Heading(heading))
    }

    /// Adds paragraphs.
    pub fn text(self, text: impl Into<String>) -> Self {
        self.with(Part::Text(text.into()))
    }

    /// Adds a chart.
    pub fn chart(self, name: &'static str, chart: Chart) -> Self {
        self.with(Part::Chart(name, chart))
    }

    /// Adds charts.
    pub fn charts(self, charts: impl IntoIterator<Item = (&'static str, Chart)>) -> Self {
        let add = |finding: Self, (name, chart)| finding.chart(name, chart);
        charts.into_iter().fold(self, add)
    }

    /// Adds a paragraph, and charts, each with the paragraph that belongs to it below.
    pub fn story(
        mut self,
        texts: impl IntoIterator<Item = String>,
        charts: impl IntoIterator<Item = (&'static str, Chart)>,
    ) -> Self {
        let mut texts = texts.into_iter().map(Part::Text);
        self.parts.extend(texts.next());
        for (name, chart) in charts {
            self.parts.push(Part::Chart(name, chart));
            self.parts.extend(texts.next());
        }
        self
    }

    /// Adds numbers that the page shows if they are few, and a file with them.
    pub fn table(self, table: Table) -> Self {
        self.with(Part::Numbers(Numbers {
            name: None,
            table,
            is_shown: true,
        }))
    }

    /// The same in a file of another name than the study's.
    pub fn table_in(self, name: &'static str, table: Table) -> Self {
        self.with(Part::Numbers(Numbers {
            name: Some(name),
            table,
            is_shown: true,
        }))
    }

    /// Adds a file with numbers that the page does not show.
    pub fn numbers(self, table: Table) -> Self {
        self.with(Part::Numbers(Numbers {
            name: None,
            table,
            is_shown: false,
        }))
    }

    /// Says which cases did not hold what is promised.
    pub fn missing(mut self, misses: Vec<String>) -> Self {
        self.misses.extend(misses);
        self
    }

    /// Its charts by the names of their files.
    pub fn all_charts(&self) -> impl Iterator<Item = (&'static str, &Chart)> {
        self.parts.iter().filter_map(|part| match part {
            Part::Chart(name, chart) => Some((*name, chart)),
            _ => None,
        })
    }

    /// Its first table.
    ///
    /// # Panics
    /// If it has none.
    pub fn first_table(&self) -> &Table {
        let mut tables = self.parts.iter().filter_map(|part| match part {
            Part::Numbers(numbers) => Some(&numbers.table),
            _ => None,
        });
        tables.next().expect("a table")
    }

    /// What it says, without headings, charts and tables.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().filter_map(|part| match part {
            Part::Text(text) => Some(text.as_str()),
            _ => None,
        })
    }
}
