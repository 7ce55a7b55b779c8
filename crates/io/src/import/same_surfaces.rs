//! Surfaces of a mesh that hold the same faces under several names: of one surface inside the body
//! a scene can make one fracture only.

use std::collections::{BTreeMap, BTreeSet};

use kluft_mesh::{Draft, Faces, Group};

use super::imported::Imported;

impl Imported {
    /// Leaves out surfaces inside the body that others hold, and notes which: those of the same
    /// faces; and those that gmsh has named or that are of cells too, if all their faces are in
    /// others.
    pub(super) fn without_copies(mut self) -> Self {
        let mut copies = copies(&self.draft);
        if copies.is_empty() {
            return self;
        }
        let inner = inner_surfaces(&self.draft);
        copies.retain(|group, _| inner[*group]);
        if !copies.is_empty() {
            self.notes.push(note(&self.draft, &copies));
            remove(&mut self.draft, &copies);
        }
        self
    }
}

/// Groups that others hold, with those others.
type Copies = BTreeMap<usize, BTreeSet<usize>>;

/// Those of all surfaces, inside the body and outside.
fn copies(draft: &Draft) -> Copies {
    let faces = faces_of_groups(draft);
    let rank_of = |group: &usize| rank(draft, *group);
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.retain(|group| !faces[*group].is_empty());
    order.sort_by_key(rank_of);
    let mut kept: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let mut copies = Copies::new();
    for group in order {
        let own = &faces[group];
        let is_held = own.iter().all(|face| kept.contains_key(face));
        let holders = own.iter().filter_map(|face| kept.get(face)).flatten();
        let mut holders: BTreeSet<usize> = holders.copied().collect();
        if rank_of(&group) == 0 {
            holders.retain(|other| faces[*other] == *own);
        }
        if is_held && !holders.is_empty() {
            copies.insert(group, holders);
            continue;
        }
        for &face in own {
            kept.entry(face).or_default().push(group);
        }
    }
    copies
}

/// The faces of each group that is a surface of the body, or a line in the plane. Faces of the same
/// nodes have one number.
fn faces_of_groups(draft: &Draft) -> Vec<BTreeSet<u32>> {
    let surfaces = match draft.is_plane() {
        true => &draft.lines,
        false => &draft.facets,
    };
    let mut numbers: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    let mut faces = vec![BTreeSet::new(); draft.groups.len()];
    for (element, &set) in surfaces.group_set.iter().enumerate() {
        let mut nodes = surfaces.elements.nodes_of(element).to_vec();
        nodes.sort_unstable();
        let next = numbers.len() as u32;
        let number = *numbers.entry(nodes).or_insert(next);
        for &group in &draft.group_sets[set as usize] {
            faces[group].insert(number);
        }
    }
    faces
}

/// How little a group says of a surface: 0 if it has a name that somebody gave it, 1 that of gmsh
/// for a physical group, 2 that of gmsh for a part of the geometry, 3 if cells are in it too.
fn rank(draft: &Draft, group: usize) -> usize {
    let group = &draft.groups[group];
    let is_of_cells = |other: &Group| other.dimension > group.dimension && other.name == group.name;
    let kind = group.name.trim_end_matches(|c: char| c.is_ascii_digit());
    match kind {
        _ if draft.groups.iter().any(is_of_cells) => 3,
        _ if kind.len() == group.name.len() => 0,
        "PhysicalSurface" | "PhysicalLine" => 1,
        "Surface" | "Line" => 2,
        _ => 0,
    }
}

/// For each group whether it is a surface inside the body.
fn inner_surfaces(draft: &Draft) -> Vec<bool> {
    let solid = match draft.is_plane() {
        true => draft.clone().extruded(),
        false => draft.clone(),
    };
    Faces::of(&solid).inner_surfaces(&solid)
}

fn note(draft: &Draft, copies: &Copies) -> String {
    let name = |group: &usize| format!("`{}`", draft.groups[*group].name);
    let each = copies.iter().map(|(copy, holders)| {
        let holders: Vec<String> = holders.iter().map(name).collect();
        format!("{} ({})", name(copy), holders.join(", "))
    });
    let each: Vec<String> = each.collect();
    format!(
        "surfaces left out, whose faces are all in others: {}",
        each.join(", ")
    )
}

/// Takes groups out of a mesh; their elements stay.
fn remove(draft: &mut Draft, copies: &Copies) {
    let mut rest = 0..;
    let places: Vec<Option<usize>> = (0..draft.groups.len())
        .map(|group| match copies.contains_key(&group) {
            true => None,
            false => rest.next(),
        })
        .collect();
    for set in &mut draft.group_sets {
        *set = set.iter().filter_map(|group| places[*group]).collect();
    }
    let mut places = places.iter();
    let mut stays = || places.next().is_some_and(Option::is_some);
    draft.groups.retain(|_| stays());
}

#[cfg(test)]
mod tests {
    use crate::import::parse_abaqus;

    /// A tetrahedron above another, as gmsh writes them: `Surface6` lies between.
    const TETS: &str = "\
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, 0, 0, -1
*ELEMENT, type=CPS3, ELSET=Surface5
1, 1, 2, 4
*ELEMENT, type=CPS3, ELSET=Surface6
2, 1, 2, 3
*ELEMENT, type=C3D4, ELSET=Volume1
3, 1, 2, 3, 4
*ELEMENT, type=C3D4, ELSET=Volume2
4, 1, 3, 2, 5
";

    /// Two squares, `Line3` between.
    const SQUARES: &str = "\
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 1, 2, 0
6, 0, 2, 0
*ELEMENT, type=T3D2, ELSET=Line3
1, 3, 4
*ELEMENT, type=CPS4, ELSET=Surface1
2, 1, 2, 3, 4
*ELEMENT, type=CPS4, ELSET=Surface2
3, 4, 3, 5, 6
";

    /// Names of the groups of a dimension, each with the number of its elements, and the notes.
    fn groups(text: &str, dimension: usize) -> (Vec<String>, String) {
        let imported = parse_abaqus(text, "a.inp").expect("a mesh");
        let draft = imported.draft;
        let sizes = match dimension {
            2 => draft.group_sizes(&draft.facets),
            _ => draft.group_sizes(&draft.lines),
        };
        let named = draft.groups.iter().zip(sizes);
        let own = named.filter(|(group, _)| group.dimension == dimension);
        let mut names: Vec<String> = own
            .map(|(group, n)| format!("{} {n}", group.name))
            .collect();
        names.sort();
        (names, imported.notes.join("; "))
    }

    #[test]
    fn a_surface_inside_the_body_has_one_name() {
        let unnamed = "*ELSET,ELSET=PhysicalSurface7\n1, \n";
        for (sets, kept, told) in [
            ("", &["Surface5 1", "Surface6 1"][..], ""),
            (
                &format!("*ELSET,ELSET=fault\n2, \n{unnamed}"),
                &["PhysicalSurface7 1", "Surface5 1", "fault 1"],
                "others: `Surface6` (`fault`)",
            ),
            // One group of several parts of the geometry.
            (
                "*ELSET,ELSET=fault\n1, 2, \n",
                &["Surface5 1", "fault 2"],
                "others: `Surface6` (`fault`)",
            ),
            (
                "*ELSET,ELSET=PhysicalSurface7\n2, \n",
                &["PhysicalSurface7 1", "Surface5 1"],
                "others: `Surface6` (`PhysicalSurface7`)",
            ),
            (
                "*ELSET,ELSET=fault\n2\n*ELSET,ELSET=joint\n2\n",
                &["Surface5 1", "fault 1"],
                "others: `joint` (`fault`), `Surface6` (`fault`)",
            ),
            (
                "*SURFACE, NAME=seam\n3, S1\n",
                &["Surface5 1", "seam 1"],
                "others: `Surface6` (`seam`)",
            ),
            (
                "*ELSET,ELSET=all,GENERATE\n1, 4\n*ELSET,ELSET=fault\n2\n",
                &["Surface5 1", "fault 1"],
                "others: `all` (`Surface5`, `fault`), `Surface6` (`fault`)",
            ),
        ] {
            let (names, notes) = groups(&format!("{TETS}{sets}"), 2);
            assert_eq!(names, kept, "{sets}");
            assert!(notes.contains(told), "{told}: {notes}");
            assert_eq!(notes.contains("left out"), !told.is_empty(), "{notes}");
        }
    }

    #[test]
    fn a_line_in_the_plane_has_one_name() {
        let (names, notes) = groups(&format!("{SQUARES}*ELSET,ELSET=fault\n1, \n"), 1);
        assert_eq!(names, ["fault 1"]);
        assert!(notes.contains("`Line3` (`fault`)"), "{notes}");
    }

    #[test]
    fn names_of_groups_outside_stay() {
        let sets = "*ELSET,ELSET=load\n1\n*ELSET,ELSET=top\n1\n";
        let (names, _) = groups(&format!("{TETS}{sets}"), 2);
        assert_eq!(names, ["Surface5 1", "Surface6 1", "load 1", "top 1"]);
    }
}
