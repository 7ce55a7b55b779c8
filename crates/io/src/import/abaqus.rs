//! Reads Abaqus input files: nodes, elements, sets, surfaces, and cohesive elements as fractures.
//!
//! Keywords begin with `*`, comments with `**`; the lines behind a keyword are its data. What is
//! neither mesh nor set is passed over and named.

use std::collections::BTreeMap;

use kluft_mesh::Defect;

use super::abaqus_mesh::build;
use super::abaqus_model::{Element, Kind, Model, kind_of};
use super::abaqus_sets::Member;
use super::imported::Imported;

/// Reads the text of an Abaqus input file; `source` names it in messages.
///
/// # Errors
/// Every line that cannot be read, elements that cannot be used, and nodes that are missing.
pub fn parse_abaqus(text: &str, source: &str) -> Result<Imported, Vec<Defect>> {
    let mut file = File {
        source,
        defects: Vec::new(),
        model: Model::default(),
    };
    let mut section: Option<Section> = None;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with("**") {
            continue;
        }
        match line.strip_prefix('*') {
            Some(keyword) => section = file.begin(keyword, number),
            None => {
                if let Some(section) = &mut section {
                    file.data(section, line, number);
                }
            }
        }
    }
    if file.defects.is_empty() {
        file.check_members();
    }
    if file.defects.is_empty() {
        build(&file.model, source).map(Imported::without_copies)
    } else {
        Err(file.defects)
    }
}

/// What the lines behind a keyword are.
enum Section {
    Nodes,
    Elements {
        kind: Kind,
        set: Option<String>,
        /// Numbers of an element that goes on in the next line.
        begun: Vec<u64>,
    },
    Set {
        name: String,
        is_range: bool,
    },
    Surface(usize),
}

struct File<'a> {
    source: &'a str,
    defects: Vec<Defect>,
    model: Model,
}

impl File<'_> {
    fn refuse(&mut self, line: usize, problem: String, remedy: &str) {
        let place = format!("{}:{line}", self.source);
        self.defects.push(Defect::new(place, problem, remedy));
    }

    /// What a keyword begins, if it is a part of a mesh.
    fn begin(&mut self, keyword: &str, line: usize) -> Option<Section> {
        let mut parts = keyword.split(',').map(str::trim);
        let name = parts.next().unwrap_or_default().to_uppercase();
        let parameters: BTreeMap<String, String> = parts
            .map(|part| {
                let (key, value) = part.split_once('=').unwrap_or((part, ""));
                let value = value.trim().trim_matches('"');
                (key.trim().to_uppercase(), value.to_owned())
            })
            .collect();
        let text = |key: &str| parameters.get(key).cloned().unwrap_or_default();
        match name.as_str() {
            "NODE" => Some(Section::Nodes),
            "ELEMENT" => self.elements(&text("TYPE"), parameters.get("ELSET").cloned(), line),
            "ELSET" => {
                let name = text("ELSET");
                self.model.sets.define(&name);
                Some(Section::Set {
                    name,
                    is_range: parameters.contains_key("GENERATE"),
                })
            }
            "SURFACE" => Some(Section::Surface(self.model.surface(&text("NAME")))),
            _ => {
                self.model.ignored.insert(name);
                None
            }
        }
    }

    /// Begins elements of a type, which belong to a set if it is given.
    fn elements(&mut self, name: &str, set: Option<String>, line: usize) -> Option<Section> {
        let Some(kind) = kind_of(name) else {
            let problem = format!("elements of type `{name}` cannot be used");
            let remedy = "mesh with tetrahedra, hexahedra, wedges or pyramids (C3D4, C3D8, C3D6, \
                          C3D5 and their quadratic forms), or plane strain elements";
            self.refuse(line, problem, remedy);
            return None;
        };
        if let Some(set) = &set {
            self.model.sets.define(set);
        }
        Some(Section::Elements {
            kind,
            set,
            begun: Vec::new(),
        })
    }

    fn data(&mut self, section: &mut Section, line: &str, number: usize) {
        let words: Vec<&str> = line
            .trim_end_matches(',')
            .split(',')
            .map(str::trim)
            .collect();
        match section {
            Section::Nodes => self.node(&words, number),
            Section::Elements { kind, set, begun } => {
                let whole: Option<Vec<u64>> = words.iter().map(|word| word.parse().ok()).collect();
                let Some(whole) = whole else {
                    let problem = format!("`{line}` is no element");
                    return self.refuse(number, problem, "write the numbers of element and nodes");
                };
                begun.extend(whole);
                if begun.len() <= kind.node_count() && line.ends_with(',') {
                    return;
                }
                let numbers = std::mem::take(begun);
                self.element(*kind, set.as_deref(), &numbers, number);
            }
            Section::Set { name, is_range } => match *is_range {
                true => self.range(name, &words, number),
                false => self.members(name, &words, number),
            },
            Section::Surface(index) => self.face(*index, &words, number),
        }
    }

    /// Adds a range of elements to a set.
    fn range(&mut self, set: &str, words: &[&str], line: usize) {
        match Member::range(words) {
            Some(range) => self.model.sets.define(set).add(range),
            None => {
                let problem = format!("`{}` is no range of elements", words.join(", "));
                let remedy = "write the first number, the last and the increment, or list the \
                              numbers without GENERATE";
                self.refuse(line, problem, remedy);
            }
        }
    }

    /// Adds elements and other sets to a set.
    fn members(&mut self, set: &str, words: &[&str], line: usize) {
        let set = self.model.sets.define(set);
        for word in words.iter().filter(|word| !word.is_empty()) {
            set.add(Member::of(word, line));
        }
    }

    /// Adds a face of an element, or of all elements of a set, to a surface.
    fn face(&mut self, surface: usize, words: &[&str], line: usize) {
        let face = words.get(1).and_then(|face| face.strip_prefix(['S', 's']));
        match (
            words.first(),
            face.and_then(|face| face.parse::<usize>().ok()),
        ) {
            (Some(of), Some(face)) => {
                let faces = &mut self.model.surfaces[surface].faces;
                faces.push((Member::of(of, line), face));
            }
            _ => {
                let what = "SURFACE of nodes or shells".to_owned();
                self.model.ignored.insert(what);
            }
        }
    }

    /// Refuses members that are neither numbers nor sets.
    fn check_members(&mut self) {
        for (line, [problem, remedy]) in self.model.unknown_members() {
            self.refuse(line, problem, &remedy);
        }
    }

    fn node(&mut self, words: &[&str], line: usize) {
        let tag = words.first().and_then(|word| word.parse::<u64>().ok());
        let coordinates: Option<Vec<f64>> = words.iter().skip(1).map(|w| number(w)).collect();
        match (tag, coordinates.as_deref()) {
            (Some(tag), Some(&[x, y, ref rest @ ..])) => {
                let place = [x, y, rest.first().copied().unwrap_or(0.0)];
                if self.model.nodes.insert(tag, place).is_some() {
                    let remedy = "write the assembly as one part (flatten it), so that each node \
                                  has a number of its own";
                    self.refuse(line, format!("node {tag} stands twice"), remedy);
                }
            }
            _ => {
                let problem = format!("`{}` is no node", words.join(", "));
                self.refuse(line, problem, "write number, x, y, z");
            }
        }
    }

    fn element(&mut self, kind: Kind, set: Option<&str>, numbers: &[u64], line: usize) {
        let Some((&tag, nodes)) = numbers.split_first() else {
            return;
        };
        if nodes.len() != kind.node_count() {
            let problem = format!(
                "element {tag} has {} nodes, and its type {}",
                nodes.len(),
                kind.node_count()
            );
            return self.refuse(line, problem, "write all its nodes");
        }
        let element = Element {
            kind,
            nodes: nodes.to_vec(),
        };
        if self.model.elements.insert(tag, element).is_some() {
            let remedy = "write the assembly as one part (flatten it)";
            self.refuse(line, format!("element {tag} stands twice"), remedy);
        }
        if let Some(set) = set {
            self.model.sets.define(set).add(Member::element(tag));
        }
    }
}

/// A number, with an exponent of D as Fortran writes it.
fn number(word: &str) -> Option<f64> {
    let number = word.replace(['d', 'D'], "e").parse::<f64>().ok();
    number.filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kluft_mesh::Draft;

    /// Two cubes on one another, a cohesive element between.
    const CUBES: &str = "\
** two blocks
*HEADING
 a comment
*NODE, NSET=ALL
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0.
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
15, 0, 0, 1.0D0
16, 1, 0, 1
17, 1, 1, 1
18, 0, 1, 1
21, 0, 0, 2
22, 1, 0, 2
23, 1, 1, 2
24, 0, 1, 2
*Element, type=C3D8R, elset=\"lower rock\"
1, 1, 2, 3, 4,
5, 6, 7, 8
*Element, type=C3D8, elset=upper
2, 15, 16, 17, 18, 21, 22, 23, 24
*Element, type=COH3D8, elset=joint
3, 5, 6, 7, 8, 15, 16, 17, 18
*Elset, elset=both, generate
1, 2, 1
*Surface, name=top
upper, S2
*MATERIAL, NAME=rock
";

    fn sizes(draft: &Draft) -> Vec<(usize, &str, usize)> {
        let (cells, facets) = (
            draft.group_sizes(&draft.cells),
            draft.group_sizes(&draft.facets),
        );
        let groups = draft.groups.iter().enumerate();
        groups
            .map(|(index, group)| {
                (
                    group.dimension,
                    group.name.as_str(),
                    cells[index] + facets[index],
                )
            })
            .collect()
    }

    #[test]
    fn sets_surfaces_and_cohesive_elements_become_groups() {
        let Imported { draft, notes } = parse_abaqus(CUBES, "a.inp").expect("a mesh");
        assert_eq!(draft.nodes.len(), 12);
        let mut found = sizes(&draft);
        found.sort_unstable();
        let expected = [
            (2, "joint", 1),
            (2, "top", 1),
            (3, "both", 2),
            (3, "lower rock", 1),
            (3, "upper", 1),
        ];
        assert_eq!(found, expected);
        // The face at the top, its normal outwards.
        let top = draft.facets.elements.nodes_of(1).iter();
        let heights: Vec<f64> = top.map(|&node| draft.nodes[node as usize][2]).collect();
        assert_eq!(heights, [2.0; 4]);
        let told = notes.join("; ");
        for part in ["1 cohesive elements", "`top`: 1 faces", "MATERIAL"] {
            assert!(told.contains(part), "{part}: {told}");
        }
    }

    #[test]
    fn every_defect_is_told_with_its_line() {
        let text = CUBES
            .replace("C3D8R", "C3D27")
            .replace("3, 1, 1, 0\n", "3, one, 1, 0\n")
            .replace("2, 15, 16, 17, 18, 21, 22, 23, 24", "2, 15, 16, 17");
        let defects = parse_abaqus(&text, "a.inp").expect_err("defects");
        let told: Vec<String> = defects.iter().map(ToString::to_string).collect();
        for (told, part) in told.iter().zip([
            "a.inp:7: `3, one",
            "a.inp:21: elements of type `C3D27`",
            "a.inp:25: element 2 has 3",
        ]) {
            assert!(told.starts_with(part), "{told}");
        }
        assert_eq!(told.len(), 3, "{told:#?}");
        let missing = CUBES.replace("24, 0, 1, 2\n", "");
        let defects = parse_abaqus(&missing, "a.inp").expect_err("defects");
        assert!(
            defects[0].problem.contains("not there: 24"),
            "{}",
            defects[0]
        );
    }
}
