//! A scene has one answer, whatever linear solver; where it has not, the program says so.

use std::collections::HashSet;
use std::fs;
use std::ops::ControlFlow;

use kluft_run::{MeshInput, Observer, Request};
use kluft_scene::Scene;
use kluft_solver::Iteration;
use serde_json::Value;
use tempfile::TempDir;

use crate::harness::{Run, kluft, root, scratch, summary};

/// All linear solvers.
pub const SOLVERS: [&str; 3] = ["direct", "condensed", "iterative"];

/// `summary.json` of a scene of this test with each solver; all must solve it.
pub fn solved(scene: &str, edits: &[(&str, &str)]) -> Vec<Value> {
    solved_by(&SOLVERS, scene, edits)
}

fn solved_by(solvers: &[&str], scene: &str, edits: &[(&str, &str)]) -> Vec<Value> {
    let solve = |(run, out): (Run, TempDir)| {
        assert_eq!(run.code, Some(0), "{}", run.err);
        summary(&out.path().join("out"))
    };
    ran_by(solvers, scene, edits).map(solve).collect()
}

/// Runs of a scene of this test with each solver, and the folders that hold `out`.
pub fn ran_by(
    solvers: &[&str],
    scene: &str,
    edits: &[(&str, &str)],
) -> impl Iterator<Item = (Run, TempDir)> {
    let own = root().join("tests/program/one_answer");
    let text = fs::read_to_string(own.join(scene)).expect("the scene");
    let beside = format!("geometry = \"{}/", own.display());
    let text = text.replace("geometry = \"", &beside);
    let text = edits
        .iter()
        .fold(text, |text, (from, to)| text.replace(from, to));
    solvers.iter().map(move |solver| {
        let folder = scratch();
        let file = folder.path().join("scene.toml");
        let text = format!("{text}\n[solver]\nlinear = \"{solver}\"\n");
        fs::write(&file, text).expect("written");
        (kluft(&["run".as_ref(), file.as_os_str()]), folder)
    })
}

/// The smallest, mean and largest aperture of a fracture (m).
fn apertures(said: &Value, fracture: &str) -> [f64; 3] {
    ["min", "mean", "max"].map(|which| {
        let value = &said["fractures"][fracture]["aperture"][which];
        value.as_f64().expect("a number")
    })
}

fn is_unique(said: &Value) -> bool {
    let warnings = said["warnings"].as_array().expect("warnings");
    let mut texts = warnings.iter().filter_map(Value::as_str);
    !texts.any(|text| text.contains("the state is not unique"))
}

pub fn assert_one_answer(answers: &[Value], fractures: &[&str]) {
    for fracture in fractures {
        let first = apertures(&answers[0], fracture);
        let size = first[2].max(1e-9);
        for (number, other) in answers.iter().enumerate() {
            let apart = std::iter::zip(first, apertures(other, fracture));
            let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(
                apart < 1e-3 * size,
                "{fracture}: answer {number} is {apart:e} m off"
            );
        }
    }
}

/// A wedge that nothing stops until a gap is closed: a linear solve before that throws it far off,
/// to where slip holds the other joint open. The path of the loads leads to closed walls. Their
/// slip stores more than what presses them together, which is to be said.
#[test]
fn a_wedge_ends_in_the_state_that_the_loads_lead_to() {
    let answers = solved("wedge_slips.toml", &[]);
    assert_one_answer(&answers, &["f", "g"]);
    for said in &answers {
        assert_eq!(said["fractures"]["g"]["open_area"], 0.0);
        let metastable = &said["fractures"]["g"]["undetermined"]["metastable_area"];
        assert!(metastable.as_f64().expect("an area") > 0.9, "{metastable}");
    }
}

/// Points of contact with friction that begin and cease to slide in cycles. The stress is that of a
/// column: 1 MPa on both joints, and both stick.
#[test]
fn cycles_of_contact_and_friction_end() {
    let answers = solved("wedge_sticks.toml", &[]);
    assert_one_answer(&answers, &["f", "g"]);
    for said in &answers {
        assert!(is_unique(said));
        let traction = said["fractures"]["f"]["normal_traction"]["mean"].as_f64();
        assert!((traction.expect("a traction") + 1e6).abs() < 1.0);
    }
}

/// A corner that a fracture cuts off but for a short edge, on which it turns through the open gap
/// until its tip touches: rock that resists a thousandth of what the cells beside the fracture
/// would. The tip touches, and beside the edge the walls stay where they were.
#[test]
fn a_corner_that_hardly_resists_closes_its_gap() {
    let answers = solved_by(&SOLVERS[..2], "corner.toml", &[]);
    assert_one_answer(&answers, &["f"]);
    for said in &answers {
        let [smallest, _, largest] = apertures(said, "f");
        assert!(smallest == 0.0 && (largest - 1e-3).abs() < 1e-5, "{said}");
        assert!(said["steps"][0]["unresolved"].is_null());
    }
}

/// Blocks whose walls are apart at first, and slide freely: a tenth of the load pushes them as far
/// as the whole, until the walls meet. No law depends on the path.
#[test]
fn blocks_that_fly_until_they_meet_a_wall_are_held() {
    let whole = solved_by(&SOLVERS[..2], "pushed_blocks.toml", &[]);
    let parts = [("steps = [1.0]", "steps = [0.1, 1.0]")];
    let divided = solved_by(&SOLVERS[..2], "pushed_blocks.toml", &parts);
    assert_one_answer(&[whole, divided].concat(), &["east", "north"]);
}

/// A layer of 1 m^2 that nothing but a joint of a hundred-millionth of the rock's stiffness holds
/// slides by `T / K_s`, in few iterations.
#[test]
fn a_block_that_a_soft_joint_holds_slides_as_far_as_it_lets() {
    for said in solved("soft_joint.toml", &[]) {
        let slip = said["fractures"]["f"]["slip"]["mean"].as_f64();
        let slip = slip.expect("a number");
        assert!((slip - 10.0 / 1e3).abs() < 1e-6 * slip, "{slip}");
        let iterations = said["steps"][0]["newton_iterations"].as_u64();
        assert!(
            iterations.is_some_and(|count| count <= 20),
            "{iterations:?}"
        );
    }
}

/// A block above an open gap, pushed down and to a side with less than friction bears once it is
/// closed: it comes to rest, but nothing tells where.
#[test]
fn a_block_that_falls_onto_friction_is_said_to_rest_anywhere() {
    for said in solved_by(&SOLVERS[..1], "falling_block.toml", &[]) {
        let path = said["steps"][0]["unresolved"].as_str().expect("words");
        assert!(path.contains("fall through open gaps"), "{path}");
        let warnings = said["warnings"].to_string();
        assert!(warnings.contains("the path of the loads is not resolved"));
        assert!(warnings.contains("unresolved_path"));
    }
    // Pressed together from the start it does not fall.
    let closed = [("aperture = 1e-3", "aperture = 0.0")];
    for said in solved_by(&SOLVERS[..1], "falling_block.toml", &closed) {
        assert!(said["steps"][0]["unresolved"].is_null());
    }
}

/// How far a jump may be off, against the largest: by the path accuracy, or by the smallest substep
/// of a run that says so.
fn allowed(said: &Value) -> f64 {
    let steps = said["steps"].to_string();
    match steps.contains("however short it is divided") {
        true => 1.0 / 64.0,
        false => 1e-3,
    }
}

/// A block that is moved over an open gap while it closes, at three tenths of the way, and sticks
/// from then on: its slip is three tenths of 0.3 mm, also where one increment and its halves both
/// take the walls to have met at once. The largest jump is 0.31 mm.
#[test]
fn walls_that_meet_on_the_way_stick_where_they_meet() {
    let steps = [
        "",
        "[load]\nsteps = [0.7, 1.0]\n",
        "[load]\nsteps = [0.2, 1.0]\n",
    ];
    for steps in steps {
        let end = "[boundary.bottom]";
        let edits = [(end, &*format!("{steps}{end}"))];
        for said in solved_by(&SOLVERS[..1], "closing_gap.toml", &edits) {
            let slip = said["fractures"]["f"]["slip_max"].as_f64().expect("a slip");
            assert!(
                (slip - 9e-5).abs() < allowed(&said) * 3.13e-4,
                "{steps}: {slip:e} m"
            );
        }
    }
}

/// The same block, whose walls ride up by tan(30 deg) of their slip, and which hardly holds them
/// once they stick: the load `p` of their meeting has `0.3 mm - p 1 mm = p 0.3 mm tan(30 deg)`,
/// and the aperture stays what they have ridden up until then.
#[test]
fn walls_ride_up_until_they_meet() {
    let rough = "friction_angle = 80\ndilation_angle = 30\nshear_stiffness = 1e6";
    let rise = 0.3e-3 * f64::to_radians(30.0).tan();
    let aperture = rise * 0.3e-3 / (1e-3 + rise);
    let end = "[boundary.bottom]";
    for steps in ["", "[load]\nsteps = [0.2, 1.0]\n"] {
        let edits = [
            ("friction_angle = 80", rough),
            (end, &*format!("{steps}{end}")),
        ];
        for said in solved_by(&SOLVERS[..1], "closing_gap.toml", &edits) {
            let [_, mean, _] = apertures(&said, "f");
            let off = (mean - aperture).abs();
            assert!(off < allowed(&said) * 3.13e-4, "{steps}: {mean:e} m");
        }
    }
}

/// Walls of a contact without elastic slip, at the limit of friction, whose tractions must turn
/// before they slide: Newton's method stands still there without being at the end. It sees that,
/// and does not spend all its iterations first.
#[test]
fn tractions_that_turn_at_the_limit_of_friction_cost_few_iterations() {
    let said = solved_by(&SOLVERS[..1], "turning_tractions.toml", &[]);
    let steps = said[0]["steps"].as_array().expect("steps");
    let substeps = steps[1]["substeps"].as_array().expect("substeps");
    let long = substeps.iter().filter(|count| count.as_u64() > Some(30));
    assert!(long.count() * 10 < substeps.len(), "{substeps:?}");
}

/// A core in a contact without friction: pressed from above, free to the sides.
#[test]
fn apertures_beside_rock_that_floats_are_no_results() {
    for said in solved("floating_core.toml", &[]) {
        assert!(!is_unique(&said));
        let own = &said["fractures"]["f"]["undetermined"];
        let sides = own["aperture_area"].as_f64().expect("an area");
        let ends = own["slip_area"].as_f64().expect("an area");
        assert!((sides - 4.0 * 0.36).abs() < 1e-9 && (ends - 2.0 * 0.36).abs() < 1e-9);
    }
}

/// Stiff rock on soft rock, and rock that keeps its volume: the rounding of displacements times a
/// stiffness exceeds 1e-9 of the forces. Uniaxial stress: the joint carries the load, and closes by
/// `load / K_n` (1 + ...) as its logarithmic law has it, 5e-5 of the aperture.
#[test]
fn rounding_does_not_keep_a_run_from_ending() {
    let soft = [("50e3", "50e3")];
    let firm = [
        ("50e3", "50e9"),
        ("poisson_ratio = 0.0", "poisson_ratio = 0.4999999"),
    ];
    for edits in [&soft[..], &firm[..]] {
        let answers = solved("layers.toml", edits);
        for said in &answers {
            for aperture in apertures(said, "f") {
                let closed = 1e-3 - aperture;
                assert!((closed / 5e-8 - 1.0).abs() < 1e-3, "closed by {closed:e} m");
            }
        }
    }
}

/// Rock that hardly changes its volume beside a contact that slides: systems that the iterative
/// solver cannot solve well enough for Newton's method to end. A direct one goes on, and says so.
#[test]
fn where_the_iterative_solver_gives_up_a_direct_one_goes_on() {
    let answers = solved("small_corner.toml", &[]);
    assert_one_answer(&answers, &["f", "g"]);
    let tells = |said: &Value| {
        said["decisions"]
            .to_string()
            .contains("direct from step 1 on")
    };
    let tell: Vec<bool> = answers.iter().map(tells).collect();
    assert_eq!(tell, [false, false, true]);
}

/// A bond that breaks and lets its walls slide at once: however short a step is divided, one
/// increment and two differ by hundredths. What is left of it is not divided to thousandths any
/// more; the path is said not to be resolved.
#[test]
fn a_path_that_is_lost_is_not_followed_ever_more_closely() {
    for said in solved_by(&SOLVERS[..1], "breaking_bond.toml", &[]) {
        for step in said["steps"].as_array().expect("steps") {
            let path = step["unresolved"].as_str().expect("words");
            assert!(path.contains("however short it is divided"), "{path}");
            let substeps = step["substeps"].as_array().expect("substeps").len();
            assert!((10..100).contains(&substeps), "{substeps}");
        }
    }
}

/// Initial stress of a million times what the joint's stiffness and aperture make of a stress: its
/// aperture is less than the smallest number, its stiffness more than the largest.
#[test]
fn a_law_that_no_longer_answers_is_named_whatever_the_solver() {
    let edits = [
        ("50e3", "50e9"),
        (
            "normal_stiffness = 2e10",
            "normal_stiffness = 2e3\nfriction_angle = 30",
        ),
        (
            "[boundary.bottom]",
            "[initial_stress]\nzz = -5e6\n[boundary.bottom]",
        ),
    ];
    for (run, _) in ran_by(&SOLVERS, "layers.toml", &edits) {
        assert_eq!(run.code, Some(1), "{}", run.err);
        let why = "a number is no longer finite at fracture `f`, facet at node";
        assert!(run.err.contains(why), "{}", run.err);
    }
}

/// A core that a fluid holds in its place, beside nearly nothing: it floats, and where it slides to
/// depends on the linear solver. No path decides that, and none is said to.
#[test]
fn a_core_that_a_fluid_holds_is_said_to_float() {
    let answers = solved("core_slides.toml", &[]);
    let differ = |a: &Value, b: &Value| {
        let [a, b] = [a, b].map(|said| apertures(said, "f"));
        (a[0] - b[0]).abs() > 1e-3 * a[2]
    };
    assert!(answers.iter().any(|other| differ(other, &answers[0])));
    for said in &answers {
        assert!(!is_unique(said), "{said}");
        assert!(said["steps"][0]["unresolved"].is_null(), "{said}");
    }
}

/// `number` equal load steps, for a scene that begins its boundaries with this line.
fn in_steps(number: u32, line: &str) -> String {
    let shares: Vec<String> = (1..=number)
        .map(|step| (f64::from(step) / f64::from(number)).to_string())
        .collect();
    format!("[load]\nsteps = [{}]\n{line}", shares.join(", "))
}

/// A core whose walls are apart, but come close enough to bear shear by their cohesion: they slide
/// until they do. Only that friction holds the core, so its slip is a result, and where it sticks
/// must be followed.
#[test]
fn a_core_that_cohesion_holds_slides_as_far_in_one_step_as_in_ten() {
    let end = "[boundary.bottom]";
    let slips = [1, 10].map(|number| {
        let edits = [(end, &*in_steps(number, end))];
        let said = &solved_by(&SOLVERS[..1], "bonded_core.toml", &edits)[0];
        assert!(is_unique(said), "{said}");
        said["fractures"]["f"]["slip_max"].as_f64().expect("a slip")
    });
    let largest_jump = 6.53e-6;
    assert!(
        (slips[0] - slips[1]).abs() < 1e-3 * largest_jump,
        "{slips:?}"
    );
}

/// A corner that slides until the joints below it meet, a thirtieth of the way: a hundredth of the
/// load moves it by its whole slip. An increment that meets in its second half and its two halves
/// do the same in it, so that they agree whatever happens afterwards.
#[test]
fn a_corner_that_others_stop_rests_in_the_same_place_or_the_run_says_so() {
    let end = "[boundary.bottom]";
    let answers = [1, 10].map(|number| {
        let edits = [(end, &*in_steps(number, end))];
        solved_by(&SOLVERS[..1], "stopped_corner.toml", &edits).remove(0)
    });
    let slips = [0, 1].map(|i| {
        let slip = &answers[i]["fractures"]["f"]["slip"]["mean"];
        slip.as_f64().expect("a slip")
    });
    let mut said = answers.iter().map(|said| said["steps"].to_string());
    let says_so = said.any(|steps| steps.contains("however short it is divided"));
    let largest_jump = 5.704e-5;
    let differ = (slips[0] - slips[1]).abs();
    assert!(says_so || differ < 1e-3 * largest_jump, "{slips:?}");
}

/// A wedge whose upper joint slides until the lower one does, within a tenth of the load, and
/// sticks from then on. In the first hundredths of it an increment may lead nowhere; then a longer
/// one stands, and the run says so.
#[test]
fn walls_that_slide_until_others_do_have_slid_in_one_step_as_in_ten_or_the_run_says_so() {
    let end = "[boundary.bottom]";
    let answers = [1, 2, 10].map(|number| {
        let edits = [(end, &*in_steps(number, end))];
        solved_by(&SOLVERS[..1], "relieved_wedge.toml", &edits).remove(0)
    });
    let is_resolved = |said: &&Value| !said["warnings"].to_string().contains("not resolved");
    let slips: Vec<f64> = answers
        .iter()
        .filter(is_resolved)
        .map(|said| said["fractures"]["f"]["slip_max"].as_f64().expect("a slip"))
        .collect();
    let largest_jump = 1.36e-3;
    let apart = slips.iter().map(|slip| (slip - slips[0]).abs());
    assert!(slips.len() > 1, "{slips:?}");
    assert!(apart.fold(0.0, f64::max) < 1e-3 * largest_jump, "{slips:?}");
}

/// A joint that lets go of its shear as it opens: beyond 0.53 of the load no state is near, and one
/// wall after the other snaps open. Loads that grow past that at once lead to the same state.
#[test]
fn walls_that_snap_open_end_where_the_whole_load_leads_them() {
    let end = "[boundary.bottom]";
    let once = solved("snapping_joint.toml", &[]);
    let often = solved("snapping_joint.toml", &[(end, &in_steps(10, end))]);
    for said in &often {
        let warnings = said["warnings"].to_string();
        assert!(
            warnings.contains("walls snap to another place"),
            "{warnings}"
        );
    }
    assert_one_answer(&[once, often].concat(), &["east", "north"]);
}

/// One load step ends where ten do, to a `share` of what `of` reads of `summary.json`.
fn assert_one_step_is_ten(scene: &str, share: f64, of: fn(&Value) -> f64) {
    let end = "[boundary.bottom]";
    let [once, often] = [1, 10].map(|number| {
        let edits = [(end, &*in_steps(number, end))];
        of(&solved_by(&SOLVERS[..1], scene, &edits)[0])
    });
    assert!((once - often).abs() < share * often, "{once:e}, {often:e}");
}

/// A joint slides from the beginning and sticks at one place from five eighths of the load on, soon
/// after the middle: all increments that begin there have it stick from there on.
#[test]
fn walls_that_stop_early_in_an_increment_have_slid_on() {
    assert_one_step_is_ten("stops_early.toml", 5e-4, |said| {
        said["fractures"]["g"]["slip_max"].as_f64().expect("a slip")
    });
}

/// A joint slides from the beginning until, at 7 % of the load, gaps of another close and stop it.
/// It sticks at the end of an increment and of its halves, and its own tractions do not tell that
/// it has slid.
#[test]
fn walls_that_slide_until_others_meet_early_in_an_increment_have_slid() {
    assert_one_step_is_ten("meets_early.toml", 2e-4, |said| {
        said["fractures"]["east"]["slip_max"]
            .as_f64()
            .expect("a slip")
    });
}

/// A joint with cohesion slides in one direction in the first sixteenth of the load, and across it
/// from then on: an increment and its halves make the same of the beginning.
#[test]
fn walls_that_turn_early_in_an_increment_have_slid_in_both_directions() {
    assert_one_step_is_ten("turns_early.toml", 1e-3, |said| apertures(said, "g")[1]);
}

/// The iterations of a run, as they come.
#[derive(Default)]
struct Iterations(Vec<Iteration>);

impl Observer for Iterations {
    fn iteration(&mut self, _number: usize, iteration: &Iteration) -> ControlFlow<()> {
        self.0.push(*iteration);
        ControlFlow::Continue(())
    }
}

/// Where one increment to the middle of a substep fails, the next substep is shorter than that: no
/// increment fails in the same way twice. Only in the smallest substeps is one tried anew, in
/// earnest.
#[test]
fn the_half_of_a_substep_that_failed_is_not_tried_again() {
    const MANY: usize = 15;
    let place = root().join("tests/program/one_answer");
    let scene = fs::read_to_string(place.join("relieved_wedge.toml")).expect("the scene");
    let text = format!("{scene}[solver]\nlinear = \"direct\"\n[load]\nsteps = [0.5]\n");
    let scene = Scene::parse(&text, "scene.toml", &place).expect("a sound scene");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut found = Iterations::default();
    let request = Request::in_memory(&scene, MeshInput::OfScene, &pool);
    kluft_run::run(request, &mut found).expect("no defects");
    let is_longer = |own: &[Iteration]| own.iter().all(|own| (32.0 * own.share).fract() == 0.0);
    let residuals = |own: &[Iteration]| -> Vec<u64> {
        own.iter().map(|own| own.force_residual.to_bits()).collect()
    };
    let parts = found.0.windows(MANY).filter(|own| is_longer(own));
    let parts: Vec<Vec<u64>> = parts.map(residuals).collect();
    let distinct: HashSet<&Vec<u64>> = parts.iter().collect();
    assert!(parts.len() > 200, "{}", parts.len());
    assert_eq!(distinct.len(), parts.len());
}
