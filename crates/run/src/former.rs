//! What a folder without a list of its files, of an older version or copied, says that a command
//! has written there.

use std::path::Path;

use serde_json::Value;

use crate::checkpoint;
use crate::flow::SOURCES;
use crate::history;
use crate::page;
use crate::probes;
use crate::strength_summary;

/// The list of the grids of the last load step.
pub const TOGETHER: &str = "results.vtm";

/// The files that the collections, the summary and the report of an inspection name, and these
/// themselves. What nothing names is not ours.
pub fn named_files(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    for kind in ["rock", "fractures"] {
        let collection = format!("{kind}.pvd");
        if let Some(grids) = read(&collection).and_then(|text| listed(&text)) {
            names.extend(grids);
            names.push(collection);
        }
    }
    // The list of the last load step, beside the collections that list its grids too.
    let of_last = "type=\"vtkMultiBlockDataSet\"";
    if !names.is_empty() && read(TOGETHER).is_some_and(|text| text.contains(of_last)) {
        names.push(TOGETHER.into());
    }
    let json = |name: &str, key: &str| -> Option<Value> {
        let value: Value = serde_json::from_str(&read(name)?).ok()?;
        (value["kluft"].is_string() && value[key].is_array()).then_some(value)
    };
    if let Some(summary) = json("summary.json", "steps") {
        names.push("summary.json".into());
        let seconds = |stage: &str| summary["seconds"][stage].as_f64().unwrap_or(0.0);
        if seconds("mesh") + seconds("mesh_spared") > 0.0 {
            names.push("mesh.msh".into());
        }
        if summary["flow"].is_object() {
            names.push(SOURCES.into());
        }
        if summary["strength_reduction"].is_object() {
            names.extend(strength_summary::GRIDS.map(String::from));
        }
        if summary["meshes"]
            .as_array()
            .is_some_and(|meshes| !meshes.is_empty())
        {
            names.push("sizes.pos".into());
        }
    }
    if json("inspect.json", "unresolved_patches").is_some() {
        names.extend(["inspect.json", "inspect.vtu"].map(String::from));
    }
    if read(history::NAME).is_some_and(|text| history::is_history(&text)) {
        names.push(history::NAME.into());
    }
    if read(probes::NAME).is_some_and(|text| probes::is_probes(&text)) {
        names.push(probes::NAME.into());
    }
    if read(page::NAME).is_some_and(|text| page::is_page(&text)) {
        names.push(page::NAME.into());
    }
    if checkpoint::is_checkpoint(&folder.join(checkpoint::NAME)) {
        names.push(checkpoint::NAME.into());
    }
    names
}

/// The grids that a collection lists; none if it is not one of ours.
fn listed(text: &str) -> Option<Vec<String>> {
    if !text.contains("<VTKFile type=\"Collection\"") {
        return None;
    }
    let grids = text.split("file=\"").skip(1);
    let grids = grids.map(|rest| {
        let name = rest.split('"').next().unwrap_or_default();
        is_step(name).then(|| name.to_owned())
    });
    grids.collect()
}

/// Whether a run writes the fields of load steps, or lists of them, under this name.
pub fn is_step(name: &str) -> bool {
    let of_kind = |kind: &str| {
        let Some(rest) = name.strip_prefix(kind) else {
            return false;
        };
        let numbers = rest.strip_prefix('_').and_then(|rest| {
            let piece = rest.strip_suffix(".vtu");
            piece.or_else(|| rest.strip_suffix(".pvtu"))
        });
        let is_number =
            |text: &str| text.len() >= 4 && text.bytes().all(|byte| byte.is_ascii_digit());
        // A piece has a number of its own behind that of the step.
        let are_numbers = |text: &str| text.splitn(2, '_').all(is_number);
        rest == ".pvd" || numbers.is_some_and(are_numbers)
    };
    of_kind("rock") || of_kind("fractures")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(files: &[(&str, &str)]) -> Vec<String> {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).expect("written");
        }
        named_files(folder.path())
    }

    fn collection(names: &[&str]) -> String {
        let list: String = names
            .iter()
            .map(|name| format!("<DataSet timestep=\"1\" file=\"{name}\"/>"))
            .collect();
        format!("<VTKFile type=\"Collection\">{list}</VTKFile>")
    }

    #[test]
    fn grids_are_those_that_collections_list() {
        let found = named(&[
            ("rock.pvd", &collection(&["rock_0001.vtu"])),
            ("fractures.pvd", "title = \"a scene\""),
            ("rock_2024.vtu", ""),
        ]);
        assert_eq!(found, ["rock_0001.vtu", "rock.pvd"]);
        let strange = collection(&["rock_0001.vtu", "../precious"]);
        assert!(named(&[("rock.pvd", &strange)]).is_empty());
    }

    #[test]
    fn a_mesh_is_ours_if_gmsh_made_it() {
        let summary = |seconds: f64, meshes: &str| {
            format!(
                "{{\"kluft\": \"0.1.0\", \"steps\": [], \"meshes\": {meshes}, \
                 \"seconds\": {{\"mesh\": {seconds}}}}}"
            )
        };
        let of = |seconds, meshes| named(&[("summary.json", &summary(seconds, meshes))]);
        assert_eq!(of(0.0, "[]"), ["summary.json"]);
        assert_eq!(of(0.5, "[1]"), ["summary.json", "mesh.msh", "sizes.pos"]);
        assert!(named(&[("summary.json", "{\"steps\": []}")]).is_empty());
    }

    #[test]
    fn inspections_and_checkpoints_are_known_by_their_heads() {
        let inspection = "{\"kluft\": \"0.1.0\", \"unresolved_patches\": []}";
        let found = named(&[
            ("inspect.json", inspection),
            ("resume.bin", "kluft checkpoint 3\n..."),
        ]);
        assert_eq!(found, ["inspect.json", "inspect.vtu", "resume.bin"]);
        assert!(named(&[("resume.bin", "mine"), ("inspect.json", "{}")]).is_empty());
    }
}
