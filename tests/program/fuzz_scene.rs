//! Damaged scenes: the reader must answer with defects that say something, or with a scene, and
//! never panic. `KLUFT_FUZZ_RUNS` sets the number of scenes, by default 4000.

use std::panic::catch_unwind;
use std::path::Path;

use kluft_scene::{Scene, Timetable};

use crate::harness::root;

/// A scene with every key.
const EVERY_KEY: &str = include_str!("every_key.toml");
/// A scene with phases and histories, which exclude load factors.
const TIMED: &str = include_str!("timed.toml");

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

/// The generator xorshift64*: the same scenes on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    fn pick<T: Clone>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())].clone()
    }
}

fn seeds() -> Vec<String> {
    let folders = std::fs::read_dir(root().join("geometries")).expect("the geometries");
    let scenes = folders.map(|folder| folder.expect("an entry").path().join("scene.toml"));
    let mut scenes: Vec<_> = scenes.filter(|scene| scene.is_file()).collect();
    scenes.sort();
    let texts = scenes
        .iter()
        .map(|scene| std::fs::read_to_string(scene).expect("a scene"));
    texts.chain([EVERY_KEY, TIMED].map(str::to_owned)).collect()
}

fn flip_bytes(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= 1 << random.below(8);
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Where the words of a text stand: keys, values, and what is between brackets.
fn words(text: &str) -> Vec<std::ops::Range<usize>> {
    let start = text.as_ptr() as usize;
    let ends = |c: char| c.is_whitespace() || "=[]{},".contains(c);
    let words = text.split(ends).filter(|word| !word.is_empty());
    words
        .map(|word| word.as_ptr() as usize - start..word.as_ptr() as usize - start + word.len())
        .collect()
}

fn replace_word(text: &mut String, random: &mut Random) {
    let words = words(text);
    if !words.is_empty() {
        text.replace_range(random.pick(&words), random.pick(&WORDS));
    }
}

fn swap_words(text: &mut String, random: &mut Random) {
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

/// Deletes, doubles or moves a line.
fn move_line(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    if lines.is_empty() {
        return String::new();
    }
    let line = random.pick(&lines);
    match random.below(3) {
        0 => drop(lines.remove(random.below(lines.len()))),
        1 => lines.insert(random.below(lines.len()), line),
        _ => {
            lines.remove(random.below(lines.len()));
            lines.insert(random.below(lines.len() + 1), line);
        }
    }
    lines.join("\n")
}

/// Something deep or long in the place of a word or at the end.
fn overgrow(text: &mut String, random: &mut Random) {
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
    match random.below(2) {
        0 if !words.is_empty() => text.replace_range(random.pick(&words), &growth),
        _ => text.push_str(&format!("\n{growth}\n")),
    }
}

fn mutated(seeds: &[String], random: &mut Random) -> String {
    let mut text = random.pick(seeds);
    for _ in 0..1 + random.below(3) {
        match random.below(16) {
            0..3 => text = flip_bytes(&text, random),
            3..8 => replace_word(&mut text, random),
            8..11 => swap_words(&mut text, random),
            11..15 => text = move_line(&text, random),
            _ => overgrow(&mut text, random),
        }
    }
    text
}

fn parse(text: &str) -> Result<Scene, Vec<kluft_mesh::Defect>> {
    Scene::parse(text, "scene.toml", Path::new("folder"))
}

/// Whether the text makes a scene; panics if the answer is no good.
fn judge(text: &str) -> bool {
    match parse(text) {
        Ok(scene) => {
            assert!(scene.body.gravity.is_finite());
            let steps: Vec<f64> = match scene.timetable {
                Timetable::Factors(factors) => factors,
                Timetable::Times { ends, .. } => ends.iter().map(|end| end.time).collect(),
            };
            assert!(!steps.is_empty() && steps.iter().all(|step| step.is_finite()));
            true
        }
        Err(defects) => {
            assert!(!defects.is_empty(), "refused without a reason");
            for defect in defects {
                let parts = [&defect.place, &defect.problem, &defect.remedy];
                assert!(
                    parts.iter().all(|part| !part.trim().is_empty()),
                    "{defect:?}"
                );
                assert!(defect.place.starts_with("scene.toml:"), "{defect:?}");
            }
            false
        }
    }
}

#[test]
fn damaged_scenes_give_defects_or_scenes() {
    let runs = std::env::var("KLUFT_FUZZ_RUNS")
        .ok()
        .and_then(|runs| runs.parse().ok());
    let runs: usize = runs.unwrap_or(4000);
    let seeds = seeds();
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut sound = 0;
    for run in 0..runs {
        let text = mutated(&seeds, &mut random);
        match catch_unwind(|| judge(&text)) {
            Ok(is_sound) => sound += usize::from(is_sound),
            Err(_) => {
                let path = std::env::temp_dir().join(format!("kluft-fuzz-{run}.toml"));
                std::fs::write(&path, text).expect("written");
                panic!("run {run}: {}", path.display());
            }
        }
    }
    println!("fuzz: {runs} damaged scenes, {sound} still sound, 0 panics");
    assert!(
        runs < 100 || (sound > 0 && sound < runs),
        "{sound} of {runs} were sound"
    );
}

#[test]
fn the_seeds_themselves_are_sound() {
    for seed in seeds() {
        parse(&seed).expect("a scene");
    }
}
