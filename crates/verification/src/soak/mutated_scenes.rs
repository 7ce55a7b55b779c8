//! Damaged scenes: the reader answers with defects that say something, or with a scene, which meets
//! a small mesh.

use std::any::Any;
use std::fs;
use std::ops::Range;
use std::panic::catch_unwind;

use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Defect, Draft};
use kluft_scene::{Scene, Timetable};

use super::asked::{Asked, bytes_of};
use super::damage::{flip_bits, move_stretch};
use super::random_stream::RandomStream;
use super::tally::{Verdict, finding, words_of};
use crate::report::{Finding, Study};
use crate::root;

/// The suite.
pub const STUDY: Study = Study {
    name: "mutated-scenes",
    title: "Damaged scenes",
    subject: "all scenes of `geometries/`, and two with every key: bits, words, lines, deep nests",
    run: |effort| run(&Asked::of(effort)),
};

const TEXT: &str = "Bits are flipped, words replaced by what TOML reads otherwise or not at all, \
    swapped, lines deleted, doubled or moved, and deep or long text inserted, up to three times a \
    scene. A scene that is refused must say what is wrong, where, and what to do; one that is read \
    has finite load steps, and meets a small mesh that has its groups.";

const WORDS: [&str; 40] = [
    "nan",
    "-nan",
    "inf",
    "-inf",
    "1e999",
    "-1e-999",
    "-0",
    "-0.0",
    "0x7fffffffffffffff",
    "0xffffffffffffffffff",
    "0o17",
    "0b1",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999999999",
    "1_000",
    "1e",
    "1__0",
    "true",
    "\"\"",
    "''",
    "\"\"\"",
    "\"\\u0000\"",
    "[]",
    "{}",
    "[[]]",
    "[{}]",
    "{ x = {} }",
    "1979-05-27T07:32:00Z",
    "[nan]",
    "[0, 0, 0, 0]",
    "[\"a\", 1]",
    "x.y.z",
    "Größe",
    "\u{200b}",
    "\u{feff}",
    "🪨",
    "\"🪨\"",
    "\r",
    "\0",
];

/// A scene, and a small mesh with its groups.
struct Seed {
    text: String,
    draft: Draft,
}

impl Seed {
    fn of(text: String) -> Self {
        let scene = parse(&text).unwrap_or_else(|defects| panic!("{defects:?}\n{text}"));
        let draft = small_mesh(&scene);
        Self { text, draft }
    }

    fn all() -> Vec<Self> {
        let folders = fs::read_dir(root().join("geometries")).expect("the geometries");
        let scenes = folders.map(|folder| folder.expect("an entry").path().join("scene.toml"));
        let mut files: Vec<_> = scenes.filter(|scene| scene.is_file()).collect();
        files.sort();
        let every_key = ["every_key.toml", "timed.toml"];
        files.extend(every_key.map(|name| root().join("tests/program").join(name)));
        let texts = files.iter().map(|file| bytes_of(file));
        texts
            .map(|bytes| Self::of(String::from_utf8_lossy(&bytes).into_owned()))
            .collect()
    }
}

/// A cube of 48 cells with the fractures of a scene on three planes inside, its boundaries on the
/// six faces.
fn small_mesh(scene: &Scene) -> Draft {
    const FACES: [f64; 2] = [0.0, 1.0];
    let names = scene.fractures.iter().map(|named| named.name.as_str());
    let fractures = names.filter(|name| *name != "default").enumerate();
    let faces = scene
        .boundaries
        .iter()
        .map(|named| named.name.as_str())
        .enumerate();
    let fractures = fractures.map(|(i, name)| (name, i % 3, 0.5));
    let faces = faces.map(|(i, name)| (name, i % 3, FACES[(i / 3 + 1) % 2]));
    let planes: Vec<_> = fractures.chain(faces).collect();
    let contains: Vec<_> = planes
        .iter()
        .map(|&(_, axis, at)| move |x: [f64; 3]| x[axis] == at)
        .collect();
    let patches = planes.iter().zip(&contains);
    let patches: Vec<Patch<'_>> = patches
        .map(|(&(name, ..), contains)| Patch::new(name, contains))
        .collect();
    tetrahedra([2; 3], [1.0; 3], &patches)
}

/// Where the words of a text stand: keys, values, and what is between brackets.
fn words(text: &str) -> Vec<Range<usize>> {
    let start = text.as_ptr() as usize;
    let ends = |c: char| c.is_whitespace() || "=[]{},".contains(c);
    let words = text.split(ends).filter(|word| !word.is_empty());
    let begin = |word: &str| word.as_ptr() as usize - start;
    words
        .map(|word| begin(word)..begin(word) + word.len())
        .collect()
}

fn replace_word(text: &mut String, random: &mut RandomStream) {
    let words = words(text);
    if !words.is_empty() {
        text.replace_range(random.pick(&words), random.pick(&WORDS));
    }
}

fn swap_words(text: &mut String, random: &mut RandomStream) {
    let words = words(text);
    if !words.is_empty() {
        let (a, b) = (random.pick(&words), random.pick(&words));
        let (first, second) = if a.start <= b.start { (a, b) } else { (b, a) };
        let (one, two) = (
            text[first.clone()].to_owned(),
            text[second.clone()].to_owned(),
        );
        text.replace_range(second, &one);
        text.replace_range(first, &two);
    }
}

/// Something deep or long in the place of a word or at the end.
fn overgrow(text: &mut String, random: &mut RandomStream) {
    let size = 1 << random.below(13);
    let growth = match random.below(6) {
        0 => "[".repeat(size),
        1 => "{ x = ".repeat(size),
        2 => format!("{}1{}", "[".repeat(size), "]".repeat(size)),
        3 => format!("{}1{}", "{ x = ".repeat(size), " }".repeat(size)),
        4 => format!("{}b = 1", "a.".repeat(size)),
        _ => "long ".repeat(size),
    };
    let words = words(text);
    if words.is_empty() || random.chance(0.5) {
        text.push_str(&format!("\n{growth}\n"));
    } else {
        text.replace_range(random.pick(&words), &growth);
    }
}

fn mutated(text: &str, random: &mut RandomStream) -> String {
    let mut text = text.to_owned();
    let of_bytes = |text: &str, damage: &mut dyn FnMut(&mut Vec<u8>)| {
        let mut bytes = text.as_bytes().to_vec();
        damage(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    };
    for _ in 0..1 + random.below(3) {
        match random.below(16) {
            0..3 => text = of_bytes(&text, &mut |bytes| flip_bits(bytes, random)),
            3..8 => replace_word(&mut text, random),
            8..11 => swap_words(&mut text, random),
            11..15 => {
                text = of_bytes(&text, &mut |b| move_stretch(b, &[Some(b'\n')], random));
            }
            _ => overgrow(&mut text, random),
        }
    }
    text
}

fn parse(text: &str) -> Result<Scene, Vec<Defect>> {
    // Where the samples are that a scene names.
    let folder = root().join("geometries/scanned-joint");
    Scene::parse(text, "scene.toml", &folder)
}

/// What is wrong with a refusal; nothing if each defect says what is wrong, where, and what to do.
fn is_poor(defects: &[Defect]) -> Option<String> {
    if defects.is_empty() {
        return Some("refused without a reason".to_owned());
    }
    let mut poor = defects.iter().filter(|defect| {
        let parts = [&defect.place, &defect.problem, &defect.remedy];
        parts.iter().any(|part| part.trim().is_empty())
    });
    poor.next().map(|defect| format!("{defect:?}"))
}

fn refused(defects: &[Defect], outcome: &str) -> Verdict {
    match is_poor(defects) {
        Some(what) => Verdict::missed("refused without place, problem or remedy", what),
        None => Verdict::held(outcome),
    }
}

fn judged(text: &str, draft: &Draft) -> Verdict {
    let scene = match parse(text) {
        Ok(scene) => scene,
        Err(defects) => {
            if let Some(lost) = defects.iter().find(|d| !d.place.starts_with("scene.toml:")) {
                return Verdict::missed("refused without a line", format!("{lost:?}"));
            }
            return refused(&defects, "refused by the reader");
        }
    };
    let steps: Vec<f64> = match &scene.timetable {
        Timetable::Factors(factors) => factors.clone(),
        Timetable::Times { ends, .. } => ends.iter().map(|end| end.time).collect(),
    };
    let is_finite = scene.body.gravity.is_finite() && steps.iter().all(|step| step.is_finite());
    if steps.is_empty() || !is_finite {
        return Verdict::missed("a scene that cannot be", format!("{steps:?}"));
    }
    match scene.problem(draft.clone()) {
        Ok(_) => Verdict::held("accepted"),
        Err(defects) => refused(&defects, "refused beside its mesh"),
    }
}

/// Runs the suite.
pub fn run(asked: &Asked) -> Finding {
    let seeds = Seed::all();
    let verdicts = asked.each(2_000, 1_000_000, |number| {
        let mut random = RandomStream::new(asked.seed, number);
        let seed = &seeds[random.below(seeds.len())];
        let text = mutated(&seed.text, &mut random);
        let panicked = |panic: Box<dyn Any + Send>| Verdict::missed("panic", words_of(&*panic));
        let judged = catch_unwind(|| judged(&text, &seed.draft));
        let mut verdict = judged.unwrap_or_else(panicked);
        if let Some(miss) = &mut verdict.miss {
            let name = format!("scene-{}-{number}.toml", asked.seed);
            *miss = format!("{}: {miss}", asked.keep(&name, text.as_bytes()));
        }
        verdict
    });
    finding(TEXT, &verdicts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_seeds_meet_their_small_meshes() {
        let outcomes = Seed::all().into_iter();
        let outcomes = outcomes.map(|seed| judged(&seed.text, &seed.draft).outcome);
        let accepted = outcomes.filter(|outcome| outcome == "accepted").count();
        assert!(
            accepted > 5,
            "only {accepted} scenes are accepted undamaged"
        );
    }
}
