//! Damaged files: the reader must answer with defects or with a draft that is sound, and never
//! panic or reserve absurd memory. `KLUFT_FUZZ_RUNS` sets the number of files, by default 4000.

use std::panic::catch_unwind;

use kluft_io::parse_msh;
use kluft_mesh::{Draft, TaggedElements};

const SEEDS: [&[u8]; 4] = [
    include_bytes!("data/text.msh"),
    include_bytes!("data/binary.msh"),
    include_bytes!("data/partitioned.msh"),
    include_bytes!("data/sparse.msh"),
];

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

/// The generator xorshift64*: the same files on every machine.
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

    fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }
}

fn flip_bytes(bytes: &mut [u8], random: &mut Random) {
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= 1 << random.below(8);
        }
    }
}

fn overwrite(bytes: &mut [u8], random: &mut Random) {
    let number = random.pick(&LARGE).to_le_bytes();
    let width = random.pick(&[4, 8]);
    let at = match random.below(2) {
        0 => random.below(bytes.len()),
        _ => count_place(bytes, random),
    };
    if let Some(field) = bytes.get_mut(at..at + width) {
        field.copy_from_slice(&number[..width]);
    }
}

/// Where a count of a binary section may stand: near the begin of the section.
fn count_place(bytes: &[u8], random: &mut Random) -> usize {
    let marker = random.pick(&[
        "$Entities\n",
        "$PartitionedEntities\n",
        "$Nodes\n",
        "$Elements\n",
    ]);
    let mut windows = bytes.windows(marker.len());
    let begin = windows
        .position(|window| window == marker.as_bytes())
        .unwrap_or(0);
    begin + marker.len() + 4 * random.below(24)
}

/// Replaces one word by a number.
fn replace_word(bytes: &mut Vec<u8>, random: &mut Random) {
    let from = random.below(bytes.len());
    let space = |byte: &u8| byte.is_ascii_whitespace();
    let Some(begin) = bytes[from..].iter().position(space).map(|at| from + at + 1) else {
        return;
    };
    let length = bytes[begin..].iter().position(space).unwrap_or(0);
    bytes.splice(begin..begin + length, random.pick(&NUMBERS).bytes());
}

/// Deletes, doubles or moves a stretch: a line, a section, or just some bytes.
fn move_stretch(bytes: &mut Vec<u8>, random: &mut Random) {
    let separator = random.pick(&[Some(b'\n'), Some(b'$'), None]);
    let mut bound = || {
        let from = random.below(bytes.len());
        let here = |&byte: &u8| separator.is_none_or(|separator| byte == separator);
        bytes[from..]
            .iter()
            .position(here)
            .map_or(bytes.len(), |at| from + at)
    };
    let (a, b, target) = (bound(), bound(), bound());
    let stretch = bytes[a.min(b)..a.max(b)].to_vec();
    let target = target.min(bytes.len());
    match random.below(3) {
        0 => drop(bytes.drain(a.min(b)..a.max(b))),
        1 => drop(bytes.splice(target..target, stretch)),
        _ => {
            bytes.drain(a.min(b)..a.max(b));
            let target = target.min(bytes.len());
            bytes.splice(target..target, stretch);
        }
    }
}

fn mutated(random: &mut Random) -> Vec<u8> {
    let mut bytes = random.pick(&SEEDS).to_vec();
    for _ in 0..1 + random.below(3) {
        match random.below(7) {
            0 => flip_bytes(&mut bytes, random),
            1 | 2 => overwrite(&mut bytes, random),
            3 | 4 => replace_word(&mut bytes, random),
            5 => move_stretch(&mut bytes, random),
            _ if random.below(4) == 0 => bytes.truncate(random.below(bytes.len())),
            _ => {}
        }
    }
    bytes
}

fn assert_sound(draft: &Draft) {
    assert_eq!(draft.nodes.len(), draft.node_tags.len());
    assert!(draft.nodes.as_flattened().iter().all(|x| x.is_finite()));
    let groups = draft.groups.len();
    assert!(
        draft
            .group_sets
            .iter()
            .flatten()
            .all(|&group| group < groups)
    );
    assert!(
        draft
            .group_sets
            .iter()
            .all(|set| set.is_sorted_by(|a, b| a < b))
    );
    assert_sound_elements(draft, &draft.cells, 3);
    assert_sound_elements(draft, &draft.facets, 2);
}

fn assert_sound_elements(draft: &Draft, tagged: &TaggedElements, dimension: usize) {
    let elements = &tagged.elements;
    assert_eq!(elements.len(), tagged.tags.len());
    assert_eq!(elements.len(), tagged.group_set.len());
    assert_eq!(elements.len() + 1, elements.offsets.len());
    assert!(
        elements
            .shapes
            .iter()
            .all(|shape| shape.dimension() == dimension)
    );
    assert!(
        elements
            .nodes
            .iter()
            .all(|&node| (node as usize) < draft.nodes.len())
    );
    let sets = tagged.group_set.iter();
    assert!(
        sets.into_iter()
            .all(|&set| (set as usize) < draft.group_sets.len())
    );
    for index in 0..elements.len() {
        assert_eq!(
            elements.nodes_of(index).len(),
            elements.shapes[index].node_count()
        );
    }
}

/// Most address space this process has ever had [kB]; none where the system does not tell.
fn peak_address_space() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmPeak:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

#[test]
fn damaged_files_give_defects_or_sound_drafts() {
    let runs = std::env::var("KLUFT_FUZZ_RUNS")
        .ok()
        .and_then(|runs| runs.parse().ok());
    let runs: usize = runs.unwrap_or(4000);
    let before = peak_address_space();
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut sound = 0;
    for run in 0..runs {
        let bytes = mutated(&mut random);
        let parsed = catch_unwind(|| parse_msh(&bytes, "fuzz"));
        match parsed {
            Ok(Ok(draft)) => {
                assert_sound(&draft);
                sound += 1;
            }
            Ok(Err(defects)) => assert!(!defects.is_empty(), "run {run}"),
            Err(_) => {
                let path = std::env::temp_dir().join(format!("kluft-fuzz-{run}.msh"));
                std::fs::write(&path, bytes).expect("written");
                panic!("run {run} panicked: {}", path.display());
            }
        }
    }
    println!("fuzz: {runs} damaged .msh files, {sound} still readable and sound, 0 panics");
    assert!(
        runs < 100 || (sound > 0 && sound < runs),
        "{sound} of {runs} files were readable"
    );
    if let (Some(before), Some(after)) = (before, peak_address_space()) {
        assert!(
            after - before < 400_000,
            "{} MB were reserved",
            (after - before) / 1000
        );
    }
}

#[test]
fn the_seeds_themselves_are_read() {
    for seed in SEEDS {
        let draft = parse_msh(seed, "seed").expect("a draft");
        assert_sound(&draft);
        assert!(!draft.cells.elements.is_empty() && !draft.facets.elements.is_empty());
    }
}
