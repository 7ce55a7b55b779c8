//! Damaged .msh files: the reader answers with defects or with a draft that is sound, and so does
//! the mesh that is built of it.

use std::any::Any;
use std::fs;
use std::panic::catch_unwind;
use std::path::Path;

use kluft_io::parse_msh;
use kluft_mesh::{Defect, Draft, TaggedElements};
use kluft_scene::Scene;

use super::asked::{Asked, bytes_of};
use super::damage::{flip_bits, move_stretch};
use super::random_stream::RandomStream;
use super::tally::{Verdict, finding, words_of};
use crate::report::{Finding, Study};
use crate::root;

/// The suite.
pub const STUDY: Study = Study {
    name: "mutated-meshes",
    title: "Damaged meshes",
    subject: "small .msh files as text and binary: bits, counts, words, lines and sections",
    run: |effort| run(&Asked::of(effort)),
};

/// Address space that a reader of small files may ask for in all (kB).
const MOST_ADDRESS_SPACE: u64 = 400_000;

const TEXT: &str = "Bits are flipped, counts and tags overwritten, words replaced by numbers \
    that no file should hold, and lines and sections deleted, doubled, moved or cut off, up to \
    three times a file. A file that is still read must give a draft whose indices, coordinates \
    and groups are sound, and a scene with its joint and a support meets the mesh that is built of it. All files \
    together may take at most 0.4 GB of address space.";

const SEEDS: [&str; 4] = ["text", "binary", "partitioned", "sparse"];

/// Rock cut by the joint that every seed has, held at a face.
const SCENE: &str = r#"
[mesh]
file = "damaged.msh"
[rock.default]
young_modulus = 1e9
poisson_ratio = 0.2
[fracture."joint one"]
aperture = 1e-4
normal_stiffness = 1e9
shear_stiffness = 1e9
[boundary.7]
displacement = { x = 0.0, y = 0.0, z = 0.0 }
"#;

const NUMBERS: [&str; 16] = [
    "0",
    "-1",
    "1",
    "3",
    "4",
    "13",
    "34",
    "2147483647",
    "-2147483648",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "NaN",
    "-inf",
    "1e-999999999999",
    "0.00000000000000000000000000000000000000000000000000000000000000000001",
];

const LARGE: [u64; 8] = [
    0,
    1,
    u64::MAX,
    i64::MAX as u64,
    1 << 32,
    1 << 60,
    0x7ff8_0000_0000_0000,
    1 << 20,
];

fn overwrite(bytes: &mut [u8], random: &mut RandomStream) {
    let number = random.pick(&LARGE).to_le_bytes();
    let width = random.pick(&[4, 8]);
    let at = if random.chance(0.5) {
        random.below(bytes.len())
    } else {
        count_place(bytes, random)
    };
    if let Some(field) = bytes.get_mut(at..at + width) {
        field.copy_from_slice(&number[..width]);
    }
}

/// Where a count of a binary section may stand: near the begin of the section.
fn count_place(bytes: &[u8], random: &mut RandomStream) -> usize {
    let sections = ["Entities", "PartitionedEntities", "Nodes", "Elements"];
    let marker = format!("${}\n", random.pick(&sections));
    let mut windows = bytes.windows(marker.len());
    let begin = windows.position(|window| window == marker.as_bytes());
    begin.unwrap_or(0) + marker.len() + 4 * random.below(24)
}

/// Replaces one word by a number.
fn replace_word(bytes: &mut Vec<u8>, random: &mut RandomStream) {
    let from = random.below(bytes.len());
    let space = |byte: &u8| byte.is_ascii_whitespace();
    let Some(begin) = bytes[from..].iter().position(space).map(|at| from + at + 1) else {
        return;
    };
    let length = bytes[begin..].iter().position(space).unwrap_or(0);
    bytes.splice(begin..begin + length, random.pick(&NUMBERS).bytes());
}

fn mutated(seeds: &[Vec<u8>], random: &mut RandomStream) -> Vec<u8> {
    let mut bytes = random.pick(seeds);
    for _ in 0..1 + random.below(3) {
        match random.below(7) {
            0 => flip_bits(&mut bytes, random),
            1 | 2 => overwrite(&mut bytes, random),
            3 | 4 => replace_word(&mut bytes, random),
            5 => move_stretch(&mut bytes, &[Some(b'\n'), Some(b'$'), None], random),
            _ if random.below(4) == 0 => bytes.truncate(random.below(bytes.len())),
            _ => {}
        }
    }
    bytes
}

/// What is wrong with a draft; nothing if all its indices, numbers and groups are sound.
pub fn unsound(draft: &Draft) -> Option<&'static str> {
    let groups = draft.groups.len();
    let mut sets = draft.group_sets.iter();
    let checks = [
        (draft.nodes.len() == draft.node_tags.len(), "tags of nodes"),
        (
            draft.nodes.as_flattened().iter().all(|x| x.is_finite()),
            "coordinates",
        ),
        (
            sets.all(|set| set.is_sorted_by(|a, b| a < b) && set.iter().all(|&g| g < groups)),
            "sets of groups",
        ),
        (are_sound(draft, &draft.cells, 3), "cells"),
        (are_sound(draft, &draft.facets, 2), "facets"),
    ];
    let mut wrong = checks.into_iter().filter(|(is_sound, _)| !is_sound);
    wrong.next().map(|(_, what)| what)
}

fn are_sound(draft: &Draft, tagged: &TaggedElements, dimension: usize) -> bool {
    let elements = &tagged.elements;
    let count = elements.len();
    let is_sound = |i: usize| {
        let shape = elements.shapes[i];
        let nodes = elements.nodes_of(i);
        shape.dimension() == dimension
            && nodes.len() == shape.node_count()
            && nodes
                .iter()
                .all(|&node| (node as usize) < draft.nodes.len())
            && (tagged.group_set[i] as usize) < draft.group_sets.len()
    };
    [
        tagged.tags.len(),
        tagged.group_set.len(),
        elements.offsets.len() - 1,
    ] == [count; 3]
        && (0..count).all(is_sound)
}

/// Most address space this process has ever had (kB); none where the system does not tell.
fn peak_address_space() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmPeak:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// How far a file comes.
fn judged(bytes: &[u8], scene: &Scene) -> Verdict {
    let refused = |defects: Vec<Defect>, outcome: &str| {
        if defects.is_empty() {
            return Verdict::missed("refused without a reason", "refused without a reason");
        }
        Verdict::held(outcome)
    };
    let draft = match parse_msh(bytes, "damaged.msh") {
        Ok(draft) => draft,
        Err(defects) => return refused(defects, "refused by the reader"),
    };
    if let Some(what) = unsound(&draft) {
        return Verdict::missed("an unsound draft", format!("{what} are not sound"));
    }
    match scene.problem(draft) {
        Ok(_) => Verdict::held("accepted"),
        Err(defects) => refused(defects, "refused by the mesh"),
    }
}

/// Runs the suite.
pub fn run(asked: &Asked) -> Finding {
    let folder = root().join("crates/io/tests/data");
    let seeds = SEEDS.map(|name| bytes_of(&folder.join(format!("{name}.msh"))));
    let scene = Scene::parse(SCENE, "scene.toml", Path::new(".")).expect("a sound scene");
    let before = peak_address_space();
    let mut verdicts = asked.each(2_000, 1_000_000, |number| {
        let bytes = mutated(&seeds, &mut RandomStream::new(asked.seed, number));
        let panicked = |panic: Box<dyn Any + Send>| Verdict::missed("panic", words_of(&*panic));
        let mut verdict = catch_unwind(|| judged(&bytes, &scene)).unwrap_or_else(panicked);
        if let Some(miss) = &mut verdict.miss {
            let name = format!("mesh-{}-{number}.msh", asked.seed);
            *miss = format!("{}: {miss}", asked.keep(&name, &bytes));
        }
        verdict
    });
    let grown = before
        .zip(peak_address_space())
        .map(|(before, after)| after - before);
    if let Some(grown) = grown.filter(|&grown| grown > MOST_ADDRESS_SPACE) {
        let what = format!("{} MB of address space were reserved", grown / 1000);
        verdicts.push(Verdict::missed("too much memory", what));
    }
    finding(TEXT, &verdicts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seeds_themselves_are_accepted() {
        let folder = root().join("crates/io/tests/data");
        let scene = Scene::parse(SCENE, "scene.toml", Path::new(".")).expect("a sound scene");
        for name in SEEDS {
            let bytes = bytes_of(&folder.join(format!("{name}.msh")));
            assert_eq!(judged(&bytes, &scene).outcome, "accepted", "{name}");
        }
    }

    #[test]
    fn an_unsound_draft_is_seen() {
        let folder = root().join("crates/io/tests/data/text.msh");
        let mut draft = parse_msh(&bytes_of(&folder), "text").expect("a draft");
        assert_eq!(unsound(&draft), None);
        draft.cells.elements.nodes[0] = draft.nodes.len() as u32;
        assert_eq!(unsound(&draft), Some("cells"));
        draft.nodes[0][0] = f64::NAN;
        assert_eq!(unsound(&draft), Some("coordinates"));
    }
}
