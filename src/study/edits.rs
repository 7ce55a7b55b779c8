//! Changes of a scene.

use toml::{Table, Value};

/// A change of one key of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Edit {
    /// The key gets a value.
    Set(Vec<String>, Value),
    /// The key goes away.
    Remove(Vec<String>),
}

impl Edit {
    /// A key gets a value.
    pub(super) fn set(path: &[&str], value: impl Into<Value>) -> Self {
        Self::Set(owned(path), value.into())
    }

    /// A key goes away.
    pub(super) fn remove(path: &[&str]) -> Self {
        Self::Remove(owned(path))
    }

    /// Changes the scene.
    pub(super) fn apply(&self, scene: &mut Table) {
        let (Self::Set(path, _) | Self::Remove(path)) = self;
        let Some((last, sections)) = path.split_last() else {
            return;
        };
        // The scene has been checked: sections are tables, or lists of them.
        let Some(table) = below(scene, sections) else {
            return;
        };
        match self {
            Self::Set(_, value) => table.insert(last.clone(), value.clone()),
            Self::Remove(_) => table.remove(last),
        };
    }
}

/// The table at the end of a path, made if it is not there; of a list the next part of the path is
/// a number.
fn below<'t>(table: &'t mut Table, path: &[String]) -> Option<&'t mut Table> {
    let Some((first, rest)) = path.split_first() else {
        return Some(table);
    };
    let entry = table.entry(first.clone());
    match entry.or_insert_with(|| Value::Table(Table::new())) {
        Value::Table(inner) => below(inner, rest),
        Value::Array(list) => {
            let (number, rest) = rest.split_first()?;
            let inner = list.get_mut(number.parse::<usize>().ok()?)?;
            below(inner.as_table_mut()?, rest)
        }
        _ => None,
    }
}

fn owned(path: &[&str]) -> Vec<String> {
    path.iter().map(|part| (*part).to_owned()).collect()
}

/// Keys of a scene that another one changes: those to write, as sections, and those to remove.
pub(super) fn difference(from: &Table, to: &Table) -> (Table, Vec<String>) {
    let mut written = Table::new();
    let mut removed = Vec::new();
    for (key, old) in from {
        match (old, to.get(key)) {
            (_, None) => removed.push(key.clone()),
            (Value::Table(old), Some(Value::Table(new))) => {
                let (inner, gone) = difference(old, new);
                if !inner.is_empty() {
                    written.insert(key.clone(), Value::Table(inner));
                }
                removed.extend(gone.into_iter().map(|inner| format!("{key}.{inner}")));
            }
            (old, Some(new)) if same(old, new) => {}
            (_, Some(new)) => {
                written.insert(key.clone(), new.clone());
            }
        }
    }
    for (key, new) in to.iter().filter(|(key, _)| !from.contains_key(*key)) {
        written.insert(key.clone(), new.clone());
    }
    (written, removed)
}

/// `1` and `1.0` say the same in a scene.
fn same(a: &Value, b: &Value) -> bool {
    let number = |value: &Value| {
        let whole = value.as_integer().map(|number| number as f64);
        value.as_float().or(whole)
    };
    a == b || (number(a).is_some() && number(a) == number(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Table {
        text.parse().expect("TOML")
    }

    #[test]
    fn edits_change_what_they_name_and_nothing_else() {
        let mut scene = table("[mesh]\norder = 1\n[fracture.a]\naperture = 1e-4\ncutoff = 1\n");
        let edits = [
            Edit::set(&["mesh", "order"], 2),
            Edit::set(&["solver", "linear"], "direct"),
            Edit::remove(&["fracture", "a", "cutoff"]),
            Edit::remove(&["fracture", "a", "absent"]),
        ];
        for edit in &edits {
            edit.apply(&mut scene);
        }
        let wanted =
            "[mesh]\norder = 2\n[fracture.a]\naperture = 1e-4\n[solver]\nlinear = 'direct'\n";
        assert_eq!(scene, table(wanted));
    }

    #[test]
    fn an_edit_changes_one_section_of_a_list() {
        let mut scene = table("[[source]]\nrate = 1\n[[source]]\nrate = 2\n");
        Edit::set(&["source", "1", "rate"], 3).apply(&mut scene);
        Edit::set(&["source", "7", "rate"], 3).apply(&mut scene);
        assert_eq!(scene, table("[[source]]\nrate = 1\n[[source]]\nrate = 3\n"));
    }

    #[test]
    fn the_difference_is_what_turns_one_scene_into_the_other() {
        let from =
            table("[mesh]\norder = 1\nparameters = { h = 1, k = 2.0 }\n[fracture.a]\nc = 1\n");
        let to = table(
            "[mesh]\norder = 1\nparameters = { h = 0.5, k = 2 }\n[fracture.a]\n[solver]\nl = 'x'\n",
        );
        let (written, removed) = difference(&from, &to);
        assert_eq!(
            written,
            table("[mesh.parameters]\nh = 0.5\n[solver]\nl = 'x'\n")
        );
        assert_eq!(removed, ["fracture.a.c"]);
    }
}
