//! Bodies that change while a run lasts: what stays carries its stress, what comes is free of it,
//! what goes lets go.

use kluft_io::{Grid, Values};
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Draft, Group};
use kluft_run::{Ending, MeshInput, Outcome, Request, StepResult, run};
use kluft_scene::Scene;

/// What tells the volumes of a box apart: the name of the one that a place is in.
type Volume = fn([f64; 3]) -> &'static str;

const YOUNG: f64 = 10e9;

fn plane(name: &'static str, axis: usize, at: f64) -> (&'static str, usize, f64) {
    (name, axis, at)
}

/// A unit cube of `counts` cells, its volumes and its physical planes.
fn draft(counts: [usize; 3], volume: Volume, planes: &[(&'static str, usize, f64)]) -> Draft {
    let tests: Vec<_> = planes
        .iter()
        .map(|&(_, axis, at)| move |x: [f64; 3]| (x[axis] - at).abs() < 1e-9)
        .collect();
    let patches: Vec<Patch<'_>> = (planes.iter().zip(&tests))
        .map(|((name, ..), test)| Patch::new(name, test))
        .collect();
    let mut draft = tetrahedra(counts, [1.0; 3], &patches);
    let mut names: Vec<&str> = Vec::new();
    for cell in 0..draft.cells.elements.len() {
        let nodes = draft.cells.elements.nodes_of(cell);
        let mut centre = [0.0; 3];
        for &node in nodes {
            for (sum, x) in centre.iter_mut().zip(draft.nodes[node as usize]) {
                *sum += x / nodes.len() as f64;
            }
        }
        let name = volume(centre);
        let known = names.iter().position(|other| *other == name);
        let index = known.unwrap_or(names.len());
        if known.is_none() {
            names.push(name);
            draft.groups.push(Group {
                dimension: 3,
                tag: 100 + index as i32,
                name: name.to_owned(),
            });
            let group = draft.groups.len() - 1;
            draft.group_sets.push(vec![group]);
        }
        let first = draft.group_sets.len() - names.len();
        draft.cells.group_set[cell] = (first + index) as u32;
    }
    draft
}

fn outcome(text: &str, draft: Draft) -> Outcome {
    let done = ended(text, draft);
    assert_eq!(done.ending, Ending::Solved, "{:?}", done.ending);
    done
}

fn ended(text: &str, draft: Draft) -> Outcome {
    let folder = std::path::Path::new(".");
    let head = "title = \"stages\"\n[mesh]\nfile = \"in memory.msh\"\n";
    let scene = Scene::parse(&format!("{head}{text}"), "a scene in memory", folder);
    let scene = scene.unwrap_or_else(|defects| panic!("{defects:?}"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let pool = pool.expect("threads");
    let mesh = MeshInput::Draft(Box::new(draft));
    let done = run(Request::in_memory(&scene, mesh, &pool), &mut ());
    done.unwrap_or_else(|defects| panic!("{defects:?}"))
}

fn field<'a>(grid: &'a Grid, name: &str) -> &'a [f64] {
    let mut fields = grid.point_fields.iter().chain(&grid.cell_fields);
    match &fields
        .find(|field| field.name == name)
        .expect("a field")
        .values
    {
        Values::Real(values) => values,
        Values::Integer(_) => panic!("{name} are numbers"),
    }
}

/// Component of the displacement at all points of a place.
fn moved(step: &StepResult, axis: usize, is_there: impl Fn(&[f64; 3]) -> bool) -> Vec<f64> {
    let values = field(&step.rock, "displacement").chunks(3);
    let points = step.rock.points.iter().zip(values);
    let own = points.filter(|(x, _)| is_there(x));
    own.map(|(_, u)| u[axis]).collect()
}

fn assert_all(values: &[f64], expected: f64, tolerance: f64) {
    assert!(!values.is_empty(), "nothing there");
    for value in values {
        let off = (value - expected).abs();
        assert!(
            off <= tolerance * expected.abs(),
            "{value:e} instead of {expected:e}"
        );
    }
}

const ROCK: &str = "[rock.default]\nyoung_modulus = 10e9\npoisson_ratio = 0.0\ndensity = 2500\n";

/// A column under an initial stress of 4 MPa loses its upper half: without lateral strain the lower
/// half lengthens by `sigma H / E` in the end, and by its share of that as far as the cut lets go.
#[test]
fn a_cut_lets_go_as_much_as_it_is_asked_to() {
    let volume = |x: [f64; 3]| if x[2] > 0.5 { "upper" } else { "lower" };
    let planes = [plane("bottom", 2, 0.0), plane("top", 2, 1.0)];
    let text = format!(
        "{ROCK}[initial_stress]\nzz = -4e6\n[boundary.bottom]\nsymmetry = true\n\
         [[fixed_point]]\nat = [0, 0, 0]\ndisplacement = {{ x = 0.0, y = 0.0 }}\n\
         [[fixed_point]]\nat = [1, 0, 0]\ndisplacement = {{ y = 0.0 }}\n\
         [boundary.top]\npressure = 4e6\nhistory = [[0, 1]]\n\
         [[load.phase]]\nname = \"in situ\"\nuntil = 1\n\
         [[load.phase]]\nname = \"part\"\nuntil = 2\nsteps = 2\nremove = [\"upper\"]\nrelease = 0.4\n\
         [[load.phase]]\nname = \"rest\"\nuntil = 3\nsteps = 2\n"
    );
    let done = outcome(&text, draft([2, 2, 4], volume, &planes));
    let whole = 4e6 * 0.5 / YOUNG;
    let shares = [0.0, 0.2, 0.4, 0.7, 1.0];
    for (step, share) in done.steps.iter().zip(shares) {
        let at_cut = moved(step, 2, |x| x[2] == 0.5);
        let largest = at_cut.iter().fold(0.0, |most, u: &f64| u.abs().max(most));
        if share == 0.0 {
            assert!(largest < 1e-12 * whole, "{largest:e} in place");
        } else {
            assert_all(&at_cut, share * whole, 1e-10);
        }
    }
    let last = done.steps.last().expect("steps");
    assert!(last.rock.points.iter().all(|x| x[2] <= 0.5 || x[2] > 0.5));
    assert_eq!(last.rock.shapes.len() * 2, done.steps[0].rock.shapes.len());
    let stress = field(&last.rock, "stress").chunks(6);
    assert!(
        stress.map(|s| s[2].abs()).fold(0.0, f64::max) < 1e-3,
        "free of stress"
    );
}

/// A bar is stretched; a second one is put beside it, and both are stretched on: the second knows
/// of what came after it only.
#[test]
fn what_is_added_starts_free_of_stress() {
    let volume = |x: [f64; 3]| if x[1] > 0.5 { "second" } else { "first" };
    let planes = [plane("left", 0, 0.0), plane("right", 0, 1.0)];
    let text = format!(
        "{ROCK}[boundary.left]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
         [boundary.right]\ndisplacement = {{ x = 1e-4, y = 0.0, z = 0.0 }}\n\
         history = [[0, 0], [1, 1], [2, 1], [3, 2.5]]\n\
         [[load.phase]]\nname = \"one\"\nuntil = 1\n\
         [[load.phase]]\nname = \"beside\"\nuntil = 2\nadd = [\"second\"]\n\
         [[load.phase]]\nname = \"both\"\nuntil = 3\n"
    );
    let done = outcome(&text, draft([4, 4, 2], volume, &planes));
    let in_bar = |step: &StepResult, second: bool| -> Vec<f64> {
        let cells = 0..step.rock.shapes.len();
        let grid = &step.rock;
        let own = cells.filter(|&cell| {
            let nodes = &grid.nodes[grid.offsets[cell] as usize..grid.offsets[cell + 1] as usize];
            let middle: f64 = nodes.iter().map(|&n| grid.points[n as usize][1]).sum();
            (middle / nodes.len() as f64 > 0.5) == second
        });
        own.map(|cell| field(grid, "stress")[6 * cell]).collect()
    };
    assert_all(&in_bar(&done.steps[0], false), 1e-4 * YOUNG, 1e-10);
    assert_all(&in_bar(&done.steps[1], false), 1e-4 * YOUNG, 1e-10);
    let beside = in_bar(&done.steps[1], true);
    let largest = beside.iter().fold(0.0, |most, s: &f64| s.abs().max(most));
    assert!(
        largest < 1e-9 * 1e-4 * YOUNG,
        "{largest:e} Pa in what was just added"
    );
    assert_all(&in_bar(&done.steps[2], false), 2.5e-4 * YOUNG, 1e-10);
    assert_all(&in_bar(&done.steps[2], true), 1.5e-4 * YOUNG, 1e-9);
    // The second bar has moved with the first since it came: the ends are in one plane.
    assert_all(&moved(&done.steps[2], 0, |x| x[0] == 1.0), 2.5e-4, 1e-10);
}

/// The corner of a block with an initial stress in all directions, in one go and in three stages.
#[test]
fn elastic_rock_forgets_the_order_of_cuts() {
    let volume = |x: [f64; 3]| match x.map(|x| x > 0.5) {
        [true, true, true] => "corner",
        [true, false, true] => "edge",
        [true, _, false] => "foot",
        _ => "rest",
    };
    let planes = [
        plane("left", 0, 0.0),
        plane("front", 1, 0.0),
        plane("bottom", 2, 0.0),
    ];
    let rock = "[rock.default]\nyoung_modulus = 10e9\npoisson_ratio = 0.3\n\
                [initial_stress]\nxx = -6e6\nyy = -3e6\nzz = -4e6\nxy = 1e6\n\
                [boundary.left]\nsymmetry = true\n[boundary.front]\nsymmetry = true\n\
                [boundary.bottom]\nsymmetry = true\n[solver]\nlinear = \"direct\"\n";
    let phases = |lists: &[&str]| -> String {
        let phase = |(index, remove): (usize, &&str)| {
            let until = index + 1;
            format!("[[load.phase]]\nname = \"{until}\"\nuntil = {until}\nremove = [{remove}]\n")
        };
        lists.iter().enumerate().map(phase).collect()
    };
    let of = |lists: &[&str]| {
        let text = format!("{rock}{}", phases(lists));
        let done = outcome(&text, draft([4; 3], volume, &planes));
        let last = done.steps.last().expect("steps").clone();
        (
            field(&last.rock, "displacement").to_vec(),
            field(&last.rock, "stress").to_vec(),
        )
    };
    let at_once = of(&["\"corner\", \"edge\", \"foot\""]);
    let staged = of(&["\"corner\"", "\"foot\"", "\"edge\""]);
    for (one, other) in [(&at_once.0, &staged.0), (&at_once.1, &staged.1)] {
        assert_eq!(one.len(), other.len());
        let size = one
            .iter()
            .fold(0.0, |most: f64, value| value.abs().max(most));
        let apart = one
            .iter()
            .zip(other)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(size > 0.0 && apart < 1e-9 * size, "{apart:e} of {size:e}");
    }
}

/// Aperture over that without load of the logarithmic law (Nagel 2017) under `q K_n0 b0`: the root
/// of `(1 + ln^2 x) (1 - x) = q`, by bisection.
fn logarithmic(q: f64) -> f64 {
    let (mut low, mut high) = (1e-9_f64, 1.0);
    for _ in 0..200 {
        let x = 0.5 * (low + high);
        if (1.0 + x.ln() * x.ln()) * (1.0 - x) > q {
            low = x;
        } else {
            high = x;
        }
    }
    low
}

/// Two columns side by side, each with a joint: one goes, the other is loaded on. Its joint stands
/// where the closure law has it for the whole load.
#[test]
fn joints_keep_their_state_when_the_body_changes() {
    let volume = |x: [f64; 3]| if x[0] > 0.5 { "right" } else { "left" };
    let planes = [
        plane("joint", 2, 0.5),
        plane("bottom", 2, 0.0),
        plane("top", 2, 1.0),
    ];
    let text = format!(
        "{ROCK}[fracture.joint]\naperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 1e10\n\
         closure = \"logarithmic\"\nfriction_angle = 30\n\
         [boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
         [boundary.top]\npressure = 3e6\nhistory = [[0, 0], [1, 1], [2, 1], [3, 2]]\n\
         [[load.phase]]\nname = \"both\"\nuntil = 1\n\
         [[load.phase]]\nname = \"one\"\nuntil = 2\nremove = [\"right\"]\n\
         [[load.phase]]\nname = \"on\"\nuntil = 3\n"
    );
    let done = outcome(&text, draft([2, 2, 4], volume, &planes));
    let apertures = [0.3, 0.3, 0.6].map(|q| 1e-4 * logarithmic(q));
    for (step, aperture) in done.steps.iter().zip(apertures) {
        assert_all(field(&step.fracture_grid, "aperture"), aperture, 1e-8);
        assert_all(field(&step.fracture_grid, "opening"), aperture - 1e-4, 1e-8);
    }
    let facets = |step: usize| done.steps[step].fracture_grid.shapes.len();
    assert_eq!(
        facets(0),
        2 * facets(1),
        "facets go with the rock on one side of them"
    );
}

/// A draft whose crack is below a height alone.
fn below(mut made: Draft, height: f64) -> Draft {
    let crack = made
        .groups
        .iter()
        .position(|g| g.name == "crack")
        .expect("a crack");
    let set = made
        .group_sets
        .iter()
        .position(|s| s[..] == [crack])
        .expect("its set") as u32;
    let facets = &made.facets;
    let kept: Vec<usize> = (0..facets.elements.len())
        .filter(|&facet| {
            let nodes = facets.elements.nodes_of(facet);
            let top = nodes
                .iter()
                .map(|&n| made.nodes[n as usize][2])
                .fold(0.0, f64::max);
            facets.group_set[facet] != set || top <= height
        })
        .collect();
    let mut elements = kluft_mesh::Elements::new();
    for &facet in &kept {
        elements.push(
            facets.elements.shapes[facet],
            facets.elements.nodes_of(facet),
        );
    }
    made.facets = kluft_mesh::TaggedElements {
        tags: kept.iter().map(|&f| made.facets.tags[f]).collect(),
        group_set: kept.iter().map(|&f| made.facets.group_set[f]).collect(),
        elements,
    };
    made
}

/// Where two walls that have moved apart are bridged, they stay where they are.
#[test]
fn a_bridge_over_an_open_crack_holds_it_where_it_is() {
    let volume = |x: [f64; 3]| if x[2] > 0.5 { "bridge" } else { "rock" };
    let planes = [
        plane("crack", 0, 0.5),
        plane("left", 0, 0.0),
        plane("right", 0, 1.0),
    ];
    let text = format!(
        "{ROCK}[fracture.crack]\naperture = 1e-3\nnormal_stiffness = 1e9\nshear_stiffness = 1e9\n\
         closure = \"linear\"\n\
         [boundary.left]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
         [boundary.right]\ndisplacement = {{ x = 1e-4, y = 0.0, z = 0.0 }}\nhistory = [[0, 0], [1, 1]]\n\
         [[load.phase]]\nname = \"open\"\nuntil = 1\n\
         [[load.phase]]\nname = \"bridge\"\nuntil = 2\nadd = [\"bridge\"]\n"
    );
    let done = outcome(&text, below(draft([4, 2, 4], volume, &planes), 0.5));
    // Springs of 1e9 Pa/m before 1 m of 10e9 Pa: the crack takes 10/11 of the stretch.
    let open = 1e-4 * 10.0 / 11.0;
    assert_all(&opening_of(&done.steps[0]), open, 1e-9);
    assert_all(&opening_of(&done.steps[1]), open, 1e-9);
    let stress = field(&done.steps[1].rock, "stress").chunks(6).map(|s| s[0]);
    let of_rock = YOUNG * 1e-4 / 11.0;
    for found in stress {
        let off = found.abs().min((found - of_rock).abs());
        assert!(
            off < 1e-8 * of_rock,
            "{found:e} Pa is neither none nor {of_rock:e}"
        );
    }
}

fn opening_of(step: &StepResult) -> Vec<f64> {
    field(&step.fracture_grid, "opening").to_vec()
}

/// A column with a joint across it, 1 m high, under 3 MPa; `phases` say what becomes of the joint.
fn jointed_column(phases: &str) -> Outcome {
    let planes = [
        plane("joint", 2, 0.5),
        plane("bottom", 2, 0.0),
        plane("top", 2, 1.0),
    ];
    let text = format!(
        "{ROCK}[fracture.joint]\naperture = 1e-3\nnormal_stiffness = 1e10\nshear_stiffness = 1e10\n\
         closure = \"linear\"\n\
         [boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
         [boundary.top]\npressure = 3e6\nhistory = [[0, 0], [1, 1], [2, 1], [3, 0]]\n{phases}"
    );
    outcome(&text, draft([2, 2, 4], |_| "rock", &planes))
}

fn top(step: &StepResult) -> Vec<f64> {
    moved(step, 2, |x| x[2] == 1.0)
}

const SHORTENED: f64 = -3e6 / YOUNG;
const CLOSED: f64 = -3e6 / 1e10;

/// A joint that is grouted while it is closed stays closed when the load goes.
#[test]
fn a_joint_that_is_removed_stays_as_it_is() {
    let done = jointed_column(
        "[[load.phase]]\nname = \"loaded\"\nuntil = 1\n\
         [[load.phase]]\nname = \"grouted\"\nuntil = 2\nremove = [\"joint\"]\n\
         [[load.phase]]\nname = \"let go\"\nuntil = 3\n",
    );
    assert_all(&opening_of(&done.steps[0]), CLOSED, 1e-9);
    for (step, height) in done
        .steps
        .iter()
        .zip([CLOSED + SHORTENED, CLOSED + SHORTENED, CLOSED])
    {
        assert_all(&top(step), height, 1e-9);
    }
    assert!(done.steps[2].fracture_grid.shapes.is_empty());
}

/// A joint that comes while its rock is loaded closes as one that had been there, as far as the
/// phase lets go of what held its walls.
#[test]
fn a_joint_that_is_added_closes_under_the_load_that_is_there() {
    let done = jointed_column(
        "[[load.phase]]\nname = \"loaded\"\nuntil = 1\n\
         [[load.phase]]\nname = \"cut\"\nuntil = 2\nsteps = 2\nadd = [\"joint\"]\n\
         [[load.phase]]\nname = \"let go\"\nuntil = 3\n",
    );
    assert!(done.steps[0].fracture_grid.shapes.is_empty());
    assert_all(&top(&done.steps[0]), SHORTENED, 1e-9);
    for (step, share) in done.steps[1..].iter().zip([0.5, 1.0]) {
        assert_all(&opening_of(step), share * CLOSED, 1e-9);
        assert_all(&top(step), SHORTENED + share * CLOSED, 1e-9);
    }
    for left in [opening_of(&done.steps[3]), top(&done.steps[3])].concat() {
        assert!(left.abs() < 1e-9 * SHORTENED.abs(), "{left:e}");
    }
}

/// A block leans on a wall by friction, pressed against it, and loses what it stands on. By statics
/// the joint carries its weight then, if friction can; else it falls, and is named.
#[test]
fn friction_on_a_joint_takes_the_weight_of_what_is_cut_under_it() {
    let volume = |x: [f64; 3]| match [x[0] > 0.5, x[2] > 0.5] {
        [false, _] => "wall",
        [true, true] => "block",
        [true, false] => "support",
    };
    let planes = [
        plane("joint", 0, 0.5),
        plane("left", 0, 0.0),
        plane("right", 0, 1.0),
        plane("bottom", 2, 0.0),
    ];
    let text = |pressure: f64| {
        format!(
            "{ROCK}[body]\ngravity = [0, 0, -9.81]\n\
             [fracture.joint]\naperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 1e10\n\
             closure = \"logarithmic\"\nfriction_angle = 30\n\
             [boundary.left]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
             [boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n\
             [boundary.right]\npressure = {pressure}\n\
             [[load.phase]]\nname = \"stands\"\nuntil = 1\n\
             [[load.phase]]\nname = \"cut\"\nuntil = 2\nsteps = 2\nremove = [\"support\"]\n"
        )
    };
    let weight = 2500.0 * 9.81 * 0.25;
    let done = outcome(&text(2e5), draft([4, 4, 4], volume, &planes));
    let last = done.steps.last().expect("steps");
    let (_, joint) = &last.fractures[0];
    let shear = joint.force[2].abs();
    assert!((shear / weight - 1.0).abs() < 1e-6, "{shear} of {weight}");
    let normal = joint.force[0].abs();
    assert!((normal / 1e5 - 1.0).abs() < 1e-6, "{normal}");
    let loose = ended(&text(1e4), draft([4, 4, 4], volume, &planes));
    match loose.ending {
        Ending::NotConverged(why) => assert!(why.contains("joint"), "{why}"),
        other => panic!("{other:?}, where friction carries half the weight"),
    }
}
