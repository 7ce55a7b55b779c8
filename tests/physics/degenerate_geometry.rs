//! Fractures in every awkward position: each solves as split nodes do, or is refused by name; and
//! which side counts as plus changes no aperture.

use std::collections::BTreeMap;

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_mesh::{Defect, Draft, Mesh, Shape};
use kluft_solver::{Problem, Support};

use kluft_verification::methods::split_nodes::{TOLERANCE, compare};
use kluft_verification::scenes::networks;
use kluft_verification::scenes::{self, EXACT, joint};

type Contains<'a> = &'a dyn Fn([f64; 3]) -> bool;

fn draft(patches: &[(&str, Contains<'_>)]) -> Draft {
    let patches: Vec<Patch<'_>> = patches
        .iter()
        .map(|&(name, contains)| Patch { name, contains })
        .collect();
    scenes::box_draft([4; 3], [1.0; 3], &patches)
}

/// A random problem, held to split nodes.
fn check(draft: Draft, adapt: impl Fn(&mut Problem)) -> Problem {
    let mut problem = scenes::problem(scenes::build(draft), joint(EXACT));
    networks::randomise(&mut problem, 3);
    adapt(&mut problem);
    let (error, _) = compare(&problem, &scenes::solve(&problem));
    assert!(error < TOLERANCE, "{error:e}");
    problem
}

fn refusal(draft: Draft) -> Defect {
    let roles = scenes::roles(&draft);
    let mut defects = Mesh::build(draft, &roles).expect_err("a defect");
    assert_eq!(defects.len(), 1, "{defects:?}");
    defects.remove(0)
}

fn as_they_are(_: &mut Problem) {}

#[test]
fn one_fracture_that_crosses_itself() {
    let cross = check(draft(&[("cross", &|x| x[0] == 0.5)]), as_they_are);
    assert_eq!(cross.mesh.sectors.count.iter().max(), Some(&2));
    // Facets of two planes under one name.
    let mut both = draft(&[("cross", &|x| x[0] == 0.5), ("other", &|x| x[2] == 0.5)]);
    let (last, first) = (
        both.group_sets.len() as u32 - 1,
        both.group_sets.len() as u32 - 2,
    );
    for set in &mut both.facets.group_set {
        *set = if *set == last { first } else { *set };
    }
    both.groups.pop();
    both.group_sets.pop();
    let cross = check(both, as_they_are);
    assert_eq!(cross.mesh.fractures, ["cross"]);
    assert_eq!(cross.mesh.sectors.count.iter().max(), Some(&4));
}

/// The first of them has the facets; an area counts once.
#[test]
fn two_fractures_that_share_facets() {
    let low: Contains<'_> = &|x| x[2] == 0.5 && x[0] <= 0.75;
    let high: Contains<'_> = &|x| x[2] == 0.5 && x[0] >= 0.25;
    let shared = check(draft(&[("low", low), ("high", high)]), as_they_are);
    let area: f64 = shared.mesh.facet_areas().iter().map(|a| a.length()).sum();
    assert!((area - 1.0).abs() < 1e-12, "{area}");
    let of = |number: u32| {
        shared
            .mesh
            .facets
            .fracture
            .iter()
            .filter(|&&f| f == number)
            .count()
    };
    assert_eq!((of(0), of(1)), (24, 8));
}

#[test]
fn a_fracture_inside_another_is_refused_by_name() {
    let whole: Contains<'_> = &|x| x[2] == 0.5;
    let part: Contains<'_> = &|x| x[2] == 0.5 && x[0] <= 0.5;
    let defect = refusal(draft(&[("whole", whole), ("part", part)]));
    assert!(defect.place.contains("part"), "{defect}");
}

#[test]
fn one_facet_with_two_tags() {
    let (a, b): (Contains<'_>, Contains<'_>) = (&|x| x[2] == 0.5, &|x| x[0] == 0.5);
    let mut draft = draft(&[("a", a), ("b", b)]);
    let count = draft.groups.len();
    draft.group_sets.push(vec![count - 2, count - 1]);
    let both = draft.group_sets.len() as u32 - 1;
    let of_a = draft
        .facets
        .group_set
        .iter()
        .position(|&set| set == both - 2);
    draft.facets.group_set[of_a.expect("facets of a")] = both;
    let problem = check(draft, as_they_are);
    assert_eq!(problem.mesh.facets.elements.len(), 64);
}

#[test]
fn a_fracture_between_two_rocks() {
    let between: Contains<'_> = &|x| x[2] == 0.5;
    let crossing: Contains<'_> = &|x| x[0] == 0.5 && x[2] >= 0.25;
    check(
        draft(&[("between", between), ("crossing", crossing)]),
        |problem| {
            problem.rocks.push(lie_core::Rock {
                young_modulus: 2e9,
                poisson_ratio: 0.4,
                density: 0.0,
                anisotropy: None,
            });
            for cell in 0..problem.mesh.cells.len() {
                let corners = problem.mesh.corners(&problem.mesh.cells, cell);
                problem.rock_of_cell[cell] = u32::from(kluft_mesh::facet_centre(&corners).z > 0.5);
            }
        },
    );
}

/// Makes the faces of one tetrahedron the facets of fracture "closed".
fn enclose(draft: &mut Draft, tetrahedron: impl Fn(&[DVec3]) -> bool) {
    let set = draft.group_sets.iter().position(|set| {
        set.iter()
            .any(|&group| draft.groups[group].name == "closed")
    });
    let cells = &draft.cells.elements;
    let corners = |cell: usize| -> Vec<DVec3> {
        cells
            .nodes_of(cell)
            .iter()
            .map(|&n| draft.nodes[n as usize].into())
            .collect()
    };
    let found = (0..cells.len()).find(|&cell| tetrahedron(&corners(cell)));
    let nodes = cells.nodes_of(found.expect("such a tetrahedron")).to_vec();
    for face in Shape::Tet4.faces() {
        let face: Vec<u32> = face
            .nodes
            .iter()
            .map(|&local| nodes[local as usize])
            .collect();
        draft.facets.elements.push(Shape::Tri3, &face);
        draft.facets.tags.push(draft.facets.tags.len() as u64 + 1);
        draft.facets.group_set.push(set.expect("the group") as u32);
    }
}

/// Exactly `count` corners on the face x = 0, and away from the others.
fn touches(corners: &[DVec3], count: usize) -> bool {
    let away = |x: &DVec3| x.y > 0.0 && x.y < 1.0 && x.z > 0.0 && x.z < 1.0;
    corners.iter().all(away) && corners.iter().filter(|x| x.x == 0.0).count() == count
}

#[test]
fn a_closed_fracture_that_touches_the_boundary() {
    let never: Contains<'_> = &|_| false;
    for count in [0, 1, 2] {
        let mut draft = draft(&[("closed", never)]);
        enclose(&mut draft, |corners| touches(corners, count));
        let problem = check(draft, as_they_are);
        assert_eq!(problem.mesh.block_count, 2);
    }
    let mut draft = draft(&[("closed", never)]);
    enclose(&mut draft, |corners| touches(corners, 3));
    let defect = refusal(draft);
    assert!(
        defect.place.contains("closed") && defect.problem.contains("outer boundary"),
        "{defect}"
    );
}

#[test]
fn fractures_that_meet_at_their_tips() {
    let parts: [Contains<'_>; 4] = [
        &|x| x[2] == 0.5 && x[0] <= 0.5,
        &|x| x[2] == 0.5 && x[0] >= 0.5,
        &|x| x[0] == 0.5 && x[2] <= 0.5,
        &|x| x[0] == 0.5 && x[2] >= 0.5 && x[1] <= 0.5,
    ];
    let names = ["a", "b", "c", "d"];
    for members in [
        vec![0, 1],
        vec![0, 2],
        vec![0, 1, 2],
        vec![0, 3],
        vec![0, 1, 2, 3],
    ] {
        let patches: Vec<_> = members.iter().map(|&i| (names[i], parts[i])).collect();
        let problem = check(draft(&patches), as_they_are);
        let most = problem.mesh.sectors.count.iter().max();
        assert_eq!(most, Some(&(members.len() as u32)));
    }
}

/// Its corners span a volume, but a curved edge turns a part of it inside out.
#[test]
fn a_curved_cell_that_folds_over_itself_is_refused_by_name() {
    let mut draft = kluft_mesh::structured::cells_of(Shape::Tet10, [2; 3], [1.0; 3], &[]);
    let nodes = draft.cells.elements.nodes_of(7).to_vec();
    let opposite = draft.nodes[nodes[9] as usize];
    draft.nodes[nodes[4] as usize] = opposite;
    let problem = scenes::problem(scenes::build(draft), joint(EXACT));
    let defects = kluft_solver::Discretisation::of(&problem).expect_err("a folded cell");
    assert!(defects[0].place.contains("cell"), "{defects:?}");
    assert!(defects[0].remedy.contains("HighOrderOptimize"));
}

/// Apertures by facet and node of a network, mirrored at z = 0 or not, under a load.
fn apertures(mut draft: Draft, mirrored: bool) -> BTreeMap<(usize, u32), f64> {
    let sign = if mirrored { -1.0 } else { 1.0 };
    for node in &mut draft.nodes {
        node[2] *= sign;
    }
    if mirrored {
        // The mirror turns the cells inside out.
        let cells = &mut draft.cells.elements;
        for cell in 0..cells.len() {
            let start = cells.range(cell).start;
            cells.nodes.swap(start, start + 1);
        }
    }
    let mut problem = scenes::problem(networks::built(draft), joint(EXACT));
    scenes::support(
        &mut problem,
        "bottom",
        Support::Displacement([Some(0.0); 3]),
    );
    scenes::load(&mut problem, "top", DVec3::new(1e6, -0.6e6, -7e6 * sign));
    scenes::load(&mut problem, "right", DVec3::new(-3e6, 0.5e6, 0.2e6 * sign));
    let solution = scenes::solve(&problem);
    let elements = &problem.mesh.facets.elements;
    let mut apertures = BTreeMap::new();
    for facet in 0..elements.len() {
        for point in elements.range(facet) {
            let key = (facet, elements.nodes[point]);
            apertures.insert(key, solution.facet_points[point].aperture);
        }
    }
    apertures
}

#[test]
fn the_choice_of_the_plus_side_changes_no_aperture() {
    for seed in [1, 2] {
        let draft = networks::meshed(&networks::polygons(seed), 0.3).expect("a mesh");
        let (straight, mirrored) = (apertures(draft.clone(), false), apertures(draft, true));
        assert_eq!(straight.len(), mirrored.len());
        for (key, aperture) in &straight {
            // Newton's tolerance.
            assert!((mirrored[key] / aperture - 1.0).abs() < 1e-8, "{key:?}");
        }
    }
}
