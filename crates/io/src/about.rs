//! What a grid says of itself beside its values.

use std::io::{self, Write};

use crate::xml::escape;

/// Facts about a grid. Readers other than VTK's know no texts there, so that a fact is the name of
/// a number: `fracture fault` is the number of the fracture `fault`, `title My scene` is 1.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct About {
    /// The time that it speaks of.
    pub time: Option<f64>,
    /// Facts, each with its number.
    pub facts: Vec<(String, i32)>,
}

impl About {
    /// As the field data of a file.
    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        if self.time.is_none() && self.facts.is_empty() {
            return Ok(());
        }
        write!(out, "<FieldData>")?;
        if let Some(time) = self.time {
            // The name by which VTK knows a time.
            write!(
                out,
                r#"<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time:e}</DataArray>"#
            )?;
        }
        for (fact, number) in &self.facts {
            let fact = escape(fact);
            write!(
                out,
                r#"<DataArray type="Int32" Name="{fact}" NumberOfTuples="1" format="ascii">{number}</DataArray>"#
            )?;
        }
        write!(out, "</FieldData>")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(about: &About) -> String {
        let mut out = Vec::new();
        about.write(&mut out).expect("written");
        String::from_utf8(out).expect("text")
    }

    #[test]
    fn facts_are_names_of_numbers_and_cannot_bend_the_file() {
        let about = About {
            time: Some(0.1),
            facts: vec![("fracture a\"<b>&\u{1}".into(), 3)],
        };
        let text = written(&about);
        assert!(
            text.contains(r#"Name="fracture a&quot;&lt;b&gt;&amp;\u{1}""#),
            "{text}"
        );
        assert!(text.contains(">3</DataArray>") && text.contains(">1e-1</DataArray>"));
        assert_eq!(text.matches("<DataArray").count(), 2);
        assert_eq!(written(&About::default()), "");
    }
}
