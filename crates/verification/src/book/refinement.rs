//! Errors on ever finer meshes or in ever shorter steps, and the orders in which they fall.

use kluft_chart::{Axis, Chart, Rate, Series};

use crate::report::{Finding, Table, digits, largest};

/// Errors of one quantity.
pub struct Refinement {
    /// What is refined, and whose error it is.
    pub name: String,
    /// Sizes, falling, each with its error.
    pub errors: Vec<(f64, f64)>,
}

impl Refinement {
    /// Of an error at each of some sizes.
    pub fn of(name: impl Into<String>, errors: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            name: name.into(),
            errors: errors.into_iter().collect(),
        }
    }

    /// Orders between one size and the next.
    pub fn orders(&self) -> Vec<f64> {
        let pairs = self.errors.windows(2);
        let order = |pair: &[(f64, f64)]| {
            let [coarse, fine] = [pair[0], pair[1]];
            (coarse.1 / fine.1).ln() / (coarse.0 / fine.0).ln()
        };
        pairs.map(order).collect()
    }

    /// The last of its orders.
    pub fn last_order(&self) -> f64 {
        self.orders().last().copied().unwrap_or(f64::NAN)
    }

    /// The error at the smallest size.
    pub fn finest(&self) -> f64 {
        self.errors.last().map_or(f64::NAN, |error| error.1)
    }
}

/// The lowest of the last orders.
pub fn lowest_order(refinements: &[Refinement]) -> f64 {
    let orders = refinements.iter().map(Refinement::last_order);
    orders.fold(f64::INFINITY, f64::min)
}

/// The largest error at the smallest sizes.
pub fn largest_left(refinements: &[Refinement]) -> f64 {
    largest(refinements.iter().map(Refinement::finest))
}

/// How a page shows refinements.
pub struct Shown {
    /// Name of its files.
    pub file: &'static str,
    /// Title of its chart.
    pub title: &'static str,
    /// What the sizes are, with their unit.
    pub size: &'static str,
    /// The rate that a triangle shows, if there is one.
    pub rate: Option<f64>,
}

impl Shown {
    /// Adds chart and table to a page.
    pub fn on(&self, page: Finding, refinements: &[Refinement]) -> Finding {
        page.chart(self.file, self.chart(refinements))
            .table_in(self.file, self.table(refinements))
    }

    fn table(&self, refinements: &[Refinement]) -> Table {
        let mut table = Table::new(&["of", self.size, "error", "order"]);
        for refinement in refinements {
            let orders = refinement.orders();
            for (index, (size, error)) in refinement.errors.iter().enumerate() {
                let order = index.checked_sub(1).map(|before| orders[before]);
                table.push([
                    refinement.name.clone(),
                    digits(*size),
                    format!("{error:.2e}"),
                    order.map_or(String::new(), |order| format!("{order:.2}")),
                ]);
            }
        }
        table
    }

    fn chart(&self, refinements: &[Refinement]) -> Chart {
        let series = refinements.iter();
        let series = series.map(|own| Series::line(own.name.clone(), own.errors.clone()));
        let rates = self.rate.map(|rate| Rate { series: 0, rate });
        Chart {
            series: series.collect(),
            rates: rates.into_iter().collect(),
            ..Chart::new(
                self.title,
                Axis::logarithmic(self.size),
                Axis::logarithmic("error (relative)"),
            )
        }
    }
}
