//! JSON for people: what lies shallow has lines of its own, and what lies deep shares one.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::{CompactFormatter, Formatter, PrettyFormatter};

/// Objects and lists one in another down to which each value has its own line. Below are the
/// numbers of single fractures and sources of all load steps, of which there may be many.
const DEPTH: usize = 4;

/// Writes a value.
///
/// # Errors
/// If it cannot be written.
pub fn write(out: &mut dyn Write, value: &impl Serialize) -> io::Result<()> {
    let mut out = io::BufWriter::new(out);
    let mut serializer = Serializer::with_formatter(&mut out, Shallow::default());
    value.serialize(&mut serializer)?;
    out.write_all(b"\n")?;
    out.flush()
}

/// Formats values by how deep they lie.
#[derive(Default)]
struct Shallow {
    pretty: PrettyFormatter<'static>,
    depth: usize,
}

impl Shallow {
    /// The formatter of what lies in the present object or list.
    fn inside(&mut self) -> Either<'_> {
        match self.depth <= DEPTH {
            true => Either::Pretty(&mut self.pretty),
            false => Either::Compact,
        }
    }
}

enum Either<'a> {
    Pretty(&'a mut PrettyFormatter<'static>),
    Compact,
}

/// Forwards a call to the formatter of the depth.
macro_rules! forward {
    ($self:ident.$call:ident($($argument:expr),*)) => {
        match $self.inside() {
            Either::Pretty(pretty) => pretty.$call($($argument),*),
            Either::Compact => CompactFormatter.$call($($argument),*),
        }
    };
}

impl Formatter for Shallow {
    fn begin_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth += 1;
        forward!(self.begin_array(out))
    }

    fn end_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        let written = forward!(self.end_array(out));
        self.depth -= 1;
        written
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        forward!(self.begin_array_value(out, first))
    }

    fn end_array_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        forward!(self.end_array_value(out))
    }

    fn begin_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth += 1;
        forward!(self.begin_object(out))
    }

    fn end_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        let written = forward!(self.end_object(out));
        self.depth -= 1;
        written
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        forward!(self.begin_object_key(out, first))
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        forward!(self.begin_object_value(out))
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        forward!(self.end_object_value(out))
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// What is written is the same value, and what lies deep takes one line.
    #[test]
    fn values_are_whole_and_deep_ones_short() {
        let deep = json!({ "aperture": { "min": 1.5, "max": [2.5, null] }, "empty": {} });
        let value = json!({ "a": [], "steps": [{ "fractures": { "x": deep, "y": deep } }] });
        let mut bytes = Vec::new();
        write(&mut bytes, &value).expect("written");
        let text = String::from_utf8(bytes).expect("a text");
        assert_eq!(serde_json::from_str::<Value>(&text).expect("JSON"), value);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        let line = r#""x": {"aperture":{"max":[2.5,null],"min":1.5},"empty":{}},"#;
        assert!(lines.contains(&line), "{text}");
        assert!(lines.contains(&r#""a": [],"#), "{text}");
    }
}
