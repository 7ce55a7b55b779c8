//! Sets of elements of an Abaqus input file. The case of their names does not count.

use std::collections::{BTreeMap, BTreeSet};

use kluft_mesh::nearest;

/// A member of a set or surface, as it is written.
pub(super) enum Member {
    /// Elements from `first` to `last` whose numbers lie `step` apart, as far as they are there.
    Range { first: u64, last: u64, step: u64 },
    /// All elements of a set that is named in a line of the file.
    Set { name: String, line: usize },
}

impl Member {
    /// An element by its number, or else a set by its name.
    pub(super) fn of(word: &str, line: usize) -> Self {
        match word.parse::<u64>() {
            Ok(element) => Self::element(element),
            Err(_) => Self::Set {
                name: word.trim_matches('"').to_owned(),
                line,
            },
        }
    }

    pub(super) fn element(element: u64) -> Self {
        Self::Range {
            first: element,
            last: element,
            step: 1,
        }
    }

    /// The first element, the last and the increment, which may be missing.
    pub(super) fn range(words: &[&str]) -> Option<Self> {
        let numbers: Option<Vec<u64>> = words.iter().map(|word| word.parse().ok()).collect();
        let (first, last, step) = match *numbers?.as_slice() {
            [first, last] => (first, last, 1),
            [first, last, step] => (first, last, step.max(1)),
            _ => return None,
        };
        (first <= last).then_some(Self::Range { first, last, step })
    }

    /// Takes in the next member if its numbers follow on those of this one.
    fn takes_in(&mut self, next: &Self) -> bool {
        let Self::Range { last, step: 1, .. } = self else {
            return false;
        };
        let Self::Range {
            first,
            last: end,
            step: 1,
        } = next
        else {
            return false;
        };
        let follows = last.checked_add(1) == Some(*first);
        if follows {
            *last = *end;
        }
        follows
    }
}

/// A set of elements.
pub(super) struct Set {
    /// Its name as it is written first.
    name: String,
    members: Vec<Member>,
}

impl Set {
    /// Adds a member.
    pub(super) fn add(&mut self, member: Member) {
        let last = self.members.last_mut();
        if !last.is_some_and(|last| last.takes_in(&member)) {
            self.members.push(member);
        }
    }
}

/// All sets of a file.
#[derive(Default)]
pub(super) struct Sets(BTreeMap<String, Set>);

impl Sets {
    /// The set of a name, an empty one if there is none yet.
    pub(super) fn define(&mut self, name: &str) -> &mut Set {
        let set = || Set {
            name: name.to_owned(),
            members: Vec::new(),
        };
        self.0.entry(key(name)).or_insert_with(set)
    }

    /// The names of the sets with those of all elements that are in them.
    pub(super) fn named<'a, T>(
        &'a self,
        all: &'a BTreeMap<u64, T>,
    ) -> impl Iterator<Item = (&'a str, Vec<u64>)> {
        let sets = self.0.values();
        sets.map(move |set| (set.name.as_str(), self.elements(&set.members, all)))
    }

    /// Those of all elements that members stand for, ascending, each once.
    pub(super) fn elements<T>(&self, members: &[Member], all: &BTreeMap<u64, T>) -> Vec<u64> {
        let mut open: Vec<&Member> = members.iter().collect();
        let (mut found, mut seen) = (Vec::new(), BTreeSet::new());
        while let Some(member) = open.pop() {
            match member {
                Member::Range { first, last, step } => {
                    let own = all.range(*first..=*last).map(|(&element, _)| element);
                    found.extend(own.filter(|element| (element - first) % step == 0));
                }
                Member::Set { name, .. } => {
                    let set = self.0.get(&key(name));
                    let set = set.filter(|_| seen.insert(key(name)));
                    open.extend(set.into_iter().flat_map(|set| &set.members));
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The members of all sets.
    pub(super) fn members(&self) -> impl Iterator<Item = &Member> {
        self.0.values().flat_map(|set| &set.members)
    }

    /// For a member that is no set of these: its line, what is wrong with it, and a remedy.
    pub(super) fn unknown(&self, member: &Member) -> Option<(usize, [String; 2])> {
        let Member::Set { name, line } = member else {
            return None;
        };
        let own = key(name);
        if self.0.contains_key(&own) {
            return None;
        }
        let near = nearest(&own, self.0.keys().map(String::as_str));
        let remedy = match near.and_then(|near| self.0.get(near)) {
            Some(set) => format!("did you mean `{}`?", set.name),
            None => "name a set of elements of this file, or write the number of one".to_owned(),
        };
        let problem = format!("`{name}` is neither a set of elements nor the number of one");
        Some((*line, [problem, remedy]))
    }
}

/// What names that differ in case alone have in common.
fn key(name: &str) -> String {
    name.to_ascii_uppercase()
}

#[cfg(test)]
mod tests {
    use kluft_mesh::Defect;

    use crate::import::parse_abaqus;

    /// Elements 1 and 7 on the two sides of a triangle.
    const TETS: &str = "\
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, 0, 0, -1
*ELEMENT, TYPE=C3D4, ELSET=Bot
1, 1, 2, 3, 4
*ELEMENT, TYPE=C3D4, ELSET=BOT
7, 1, 3, 2, 5
";

    /// Names of groups with their sizes.
    fn groups(rest: &str) -> Result<Vec<(String, usize)>, Vec<Defect>> {
        let draft = parse_abaqus(&format!("{TETS}{rest}"), "a.inp")?.draft;
        let cells = draft.group_sizes(&draft.cells);
        let facets = draft.group_sizes(&draft.facets);
        let sizes = cells
            .iter()
            .zip(&facets)
            .map(|(cells, facets)| cells + facets);
        let names = draft.groups.iter().map(|group| group.name.clone());
        let mut found: Vec<_> = names.zip(sizes).collect();
        found.sort();
        Ok(found)
    }

    fn has(rest: &str, expected: &[(&str, usize)]) {
        let found = groups(rest).expect("a mesh");
        let found: Vec<(&str, usize)> = found.iter().map(|(name, n)| (&name[..], *n)).collect();
        assert_eq!(found, expected, "{rest}");
    }

    #[test]
    fn ranges_hold_the_elements_that_are_there() {
        for (range, size) in [
            ("1,18446744073709551615", 2),
            ("1, 2000000000, 3", 2),
            ("1, 2000000000, 4,", 1),
            ("2, 7", 1),
        ] {
            let text = format!("*ELSET, ELSET=a, GENERATE\n{range}\n");
            has(&text, &[("Bot", 2), ("a", size)]);
        }
    }

    #[test]
    fn what_is_no_range_is_refused() {
        for line in ["5", "Bot", "7, 1", "1, 2, 3, 4"] {
            let text = format!("*ELSET, ELSET=a, GENERATE\n{line}\n");
            let defects = groups(&text).expect_err("no range");
            let told = defects[0].to_string();
            for part in ["a.inp:12: ", "is no range", "the first number"] {
                assert!(told.contains(part), "{part}: {told}");
            }
        }
    }

    #[test]
    fn names_are_found_in_any_case_and_members_count_once() {
        has("", &[("Bot", 2)]);
        let surface = "*SURFACE, NAME=lid\nBOT, S2\nbot, S2\n1, S2\n";
        has(surface, &[("Bot", 2), ("lid", 2)]);
        let twice = "*SURFACE, NAME=lid\n1, S2\n*SURFACE, NAME=LID\n7, S2\n1, S2\n";
        has(twice, &[("Bot", 2), ("lid", 2)]);
        has("*ELSET, ELSET=a\nbot, 7, 7,\n", &[("Bot", 2), ("a", 2)]);
        // Sets of one another, and one that is defined behind.
        let rings = "*ELSET, ELSET=a\nB, 1\n*ELSET, ELSET=b\na\n";
        has(rings, &[("Bot", 2), ("a", 1), ("b", 1)]);
    }

    #[test]
    fn members_that_are_nothing_are_refused() {
        for (text, line, remedy) in [
            ("*SURFACE, NAME=lid\nbott, S2\n", 12, "did you mean `Bot`?"),
            ("*ELSET, ELSET=a\n1, bott\n", 12, "did you mean `Bot`?"),
            (
                "*ELSET, ELSET=a\n1\nquartzite\n",
                13,
                "name a set of elements",
            ),
        ] {
            let defects = groups(text).expect_err("no member");
            let told = defects[0].to_string();
            assert!(told.starts_with(&format!("a.inp:{line}: `")), "{told}");
            assert!(told.contains(remedy), "{remedy}: {told}");
            assert_eq!(defects.len(), 1);
        }
    }
}
