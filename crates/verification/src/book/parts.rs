//! Parts that every page has.

use crate::report::Finding;

impl Finding {
    /// Adds the closed form and its source; results follow.
    pub fn closed_form(self, closed_form: &str, source: &str) -> Self {
        self.heading("Closed form")
            .text(closed_form)
            .text(format!("Source: {source}."))
            .heading("Result")
    }

    /// Adds what the results show.
    pub fn shows(self, text: impl Into<String>) -> Self {
        self.heading("What it shows").text(text)
    }
}
