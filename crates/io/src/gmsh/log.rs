//! What gmsh says: its errors and warnings.

use kluft_mesh::Defect;

const SHOWN: usize = 10;
/// Most lines that are told apart.
const MOST: usize = 1000;
/// What helps against an error in a geometry.
pub(super) const IN_A_GEOMETRY: &str = "correct the geometry; `gmsh FILE` shows it";
/// What helps against an error in a mesh file that is only rewritten.
pub(super) const IN_A_MESH: &str = "write the mesh file again: gmsh cannot read it";

/// The lines of a run that matter, each once.
#[derive(Debug, Default)]
pub(super) struct Log {
    pub(super) errors: Vec<String>,
    pub(super) warnings: Vec<String>,
}

impl Log {
    /// gmsh prints errors and warnings to either stream.
    pub(super) fn parse(output: &str, errors: &str) -> Self {
        let mut log = Self::default();
        let lines = output.lines().chain(errors.lines());
        lines.for_each(|line| log.take(line));
        log
    }

    fn take(&mut self, line: &str) {
        let Some((level, message)) = line.split_once(':') else {
            return;
        };
        let lines = match level.trim_end() {
            "Error" | "Fatal" => &mut self.errors,
            "Warning" => &mut self.warnings,
            _ => return,
        };
        let message = message.trim();
        let is_new = lines.len() < MOST && !lines.iter().any(|known| known == message);
        if is_new && !is_summary(message) {
            lines.push(message.to_owned());
        }
    }

    /// One defect for each error, at the place that gmsh names.
    pub(super) fn defects(&self, input: &str, remedy: &str) -> Vec<Defect> {
        let errors = self.errors.iter().take(SHOWN);
        let defects = errors.map(|error| defect_of(input, error, remedy));
        let mut defects: Vec<Defect> = defects.collect();
        let more = self.errors.len().saturating_sub(SHOWN);
        if more > 0 {
            let problem = format!("gmsh reports {more} more errors");
            defects.push(Defect::new(input, problem, remedy));
        }
        defects
    }
}

/// The frame of gmsh's "Mesh generation error summary", which says nothing new.
fn is_summary(message: &str) -> bool {
    let counts = |unit| {
        message
            .strip_suffix(unit)
            .is_some_and(|n| n.trim().parse::<u32>().is_ok())
    };
    message.is_empty()
        || message.bytes().all(|byte| byte == b'-')
        || message.starts_with("Mesh generation error summary")
        || message.starts_with("Check the full log")
        || ["errors", "error", "warnings", "warning"]
            .into_iter()
            .any(counts)
}

/// `'block.geo', line 3: syntax error` names its place itself.
fn defect_of(input: &str, error: &str, remedy: &str) -> Defect {
    let located = error.strip_prefix('\'').and_then(|rest| {
        let (file, rest) = rest.split_once("', line ")?;
        let (line, problem) = rest.split_once(": ")?;
        Some((format!("{file}, line {line}"), problem))
    });
    let (place, problem) = located.unwrap_or_else(|| (input.to_owned(), error));
    Defect::new(place, format!("gmsh: {problem}"), remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_keep_their_lines_and_lose_the_summary() {
        let stderr = "Error   : 'a.geo', line 3: syntax error ({)\n\
            Error   : No elements in volume 1 \n\
            Error   : ------------------------------\n\
            Error   : Mesh generation error summary\n\
            Error   :     0 warnings\n\
            Error   :     3 errors\n\
            Error   : Check the full log for details\n\
            Error   : No elements in volume 1 \n\
            Warning : careful: x\n";
        let log = Log::parse("Info    : Error   : no\n", stderr);
        let defects = log.defects("in.geo", IN_A_GEOMETRY);
        let places: Vec<&str> = defects.iter().map(|defect| defect.place.as_str()).collect();
        assert_eq!(places, ["a.geo, line 3", "in.geo"]);
        assert_eq!(defects[0].problem, "gmsh: syntax error ({)");
        assert_eq!(log.warnings, ["careful: x"]);
    }
}
