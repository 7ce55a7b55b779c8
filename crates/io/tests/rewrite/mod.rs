//! Other forms of the same mesh file.

use std::str::Lines;

/// Turns all binary numbers of a little-endian file round.
pub(crate) fn swap_byte_order(bytes: &[u8]) -> Vec<u8> {
    let mut swap = Swap {
        bytes: bytes.to_vec(),
        at: 0,
    };
    swap.seek("$MeshFormat\n4.1 1 8\n");
    swap.number(4);
    swap.seek("$Entities\n");
    let counts: Vec<u64> = (0..4).map(|_| swap.number(8)).collect();
    for (dimension, &count) in counts.iter().enumerate() {
        for _ in 0..count {
            swap.number(4);
            swap.numbers(8, if dimension == 0 { 3 } else { 6 });
            for _ in 0..1 + usize::from(dimension > 0) {
                let tags = swap.number(8);
                swap.numbers(4, tags);
            }
        }
    }
    swap.seek("$Nodes\n");
    let blocks = swap.number(8);
    swap.numbers(8, 3);
    for _ in 0..blocks {
        swap.numbers(4, 3);
        let nodes = swap.number(8);
        swap.numbers(8, 4 * nodes);
    }
    swap.seek("$Elements\n");
    let blocks = swap.number(8);
    swap.numbers(8, 3);
    for _ in 0..blocks {
        swap.numbers(4, 2);
        let width = [0, 3, 4, 0, 5][swap.number(4) as usize];
        let elements = swap.number(8);
        swap.numbers(8, width * elements);
    }
    swap.bytes
}

struct Swap {
    bytes: Vec<u8>,
    at: usize,
}

impl Swap {
    fn seek(&mut self, marker: &str) {
        let rest = &self.bytes[self.at..];
        let found = rest
            .windows(marker.len())
            .position(|window| window == marker.as_bytes());
        self.at += found.expect("the marker") + marker.len();
    }

    fn number(&mut self, width: usize) -> u64 {
        let field = &mut self.bytes[self.at..self.at + width];
        let value = field
            .iter()
            .rev()
            .fold(0, |value, &byte| value << 8 | u64::from(byte));
        field.reverse();
        self.at += width;
        value
    }

    fn numbers(&mut self, width: usize, count: u64) {
        for _ in 0..count {
            self.number(width);
        }
    }
}

/// Gives the nodes of a text file other tags.
pub(crate) fn retag(text: &str, rename: impl Fn(u64) -> u64) -> String {
    let mut retag = Retag {
        lines: text.lines(),
        written: String::new(),
        rename,
    };
    while let Some(line) = retag.copy() {
        match line {
            "$Nodes" => retag.nodes(),
            "$Elements" => retag.elements(),
            _ => {}
        }
    }
    retag.written
}

struct Retag<'a, F> {
    lines: Lines<'a>,
    written: String,
    rename: F,
}

impl<'a, F: Fn(u64) -> u64> Retag<'a, F> {
    fn write(&mut self, words: &[String]) {
        self.written += &words.join(" ");
        self.written += "\n";
    }

    fn copy(&mut self) -> Option<&'a str> {
        let line = self.lines.next()?;
        self.write(&[line.to_owned()]);
        Some(line)
    }

    fn numbers(line: Option<&str>) -> Vec<u64> {
        let words = line.expect("a line").split_whitespace();
        words.map(|word| word.parse().expect("a number")).collect()
    }

    fn nodes(&mut self) {
        let head = Self::numbers(self.lines.next());
        let tags: Vec<u64> = (1..=head[1]).map(&self.rename).collect();
        let bounds = [tags.iter().min(), tags.iter().max()].map(|tag| *tag.expect("a node"));
        self.write(&[head[0], head[1], bounds[0], bounds[1]].map(|number| number.to_string()));
        for _ in 0..head[0] {
            let count = Self::numbers(self.copy())[3];
            for _ in 0..count {
                let tag = Self::numbers(self.lines.next())[0];
                self.write(&[(self.rename)(tag).to_string()]);
            }
            (0..count).for_each(|_| assert!(self.copy().is_some()));
        }
    }

    fn elements(&mut self) {
        let blocks = Self::numbers(self.copy())[0];
        for _ in 0..blocks {
            let count = Self::numbers(self.copy())[3];
            for _ in 0..count {
                let mut words = Self::numbers(self.lines.next());
                words[1..]
                    .iter_mut()
                    .for_each(|tag| *tag = (self.rename)(*tag));
                let words: Vec<String> = words.iter().map(u64::to_string).collect();
                self.write(&words);
            }
        }
    }
}
