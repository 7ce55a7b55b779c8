//! Reads the numbers of a section one after the other, in text or binary.

use std::ops::Range;
use std::str::FromStr;

use kluft_mesh::Defect;

use super::source::{Encoding, MshSource, is_space};

/// No writer needs more for a number, and decimal parsers are at risk with less usual input.
const LONGEST_NUMBER: usize = 64;

/// Items that are read at a time: enough to be worth a task, few enough to stay in the cache.
const ITEMS_PER_RANGE: usize = 8192;

/// Some items of a block that stand one behind the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ItemRange {
    pub(super) count: usize,
    /// Where they stand in the file.
    pub(super) bytes: Range<usize>,
}

/// A place in the body of a section.
pub(super) struct Cursor<'a> {
    source: MshSource<'a>,
    encoding: Encoding,
    at: usize,
    end: usize,
}

impl<'a> Cursor<'a> {
    /// At the start of a section's body, which must lie inside the file.
    pub(super) fn new(source: MshSource<'a>, encoding: Encoding, body: Range<usize>) -> Self {
        Self {
            source,
            encoding,
            at: body.start,
            end: body.end,
        }
    }

    /// An unsigned number (`size_t` of the format).
    pub(super) fn size(&mut self, what: &str) -> Result<u64, Defect> {
        match self.encoding {
            Encoding::Text => self.text(what, decimal),
            Encoding::LittleEndian => self.fixed(what).map(u64::from_le_bytes),
            Encoding::BigEndian => self.fixed(what).map(u64::from_be_bytes),
        }
    }

    /// A signed number (`int` of the format).
    pub(super) fn int(&mut self, what: &str) -> Result<i32, Defect> {
        match self.encoding {
            Encoding::Text => self.text(what, number),
            Encoding::LittleEndian => self.fixed(what).map(i32::from_le_bytes),
            Encoding::BigEndian => self.fixed(what).map(i32::from_be_bytes),
        }
    }

    /// A real number; it may be infinite or not a number.
    pub(super) fn double(&mut self, what: &str) -> Result<f64, Defect> {
        match self.encoding {
            Encoding::Text => self.text(what, number),
            Encoding::LittleEndian => self.fixed(what).map(f64::from_le_bytes),
            Encoding::BigEndian => self.fixed(what).map(f64::from_be_bytes),
        }
    }

    /// How many items follow, each of at least `numbers` numbers; never more than fit the section.
    pub(super) fn count(&mut self, what: &str, numbers: u64) -> Result<usize, Defect> {
        let at = self.at;
        let count = self.size(what)?;
        let smallest = match self.encoding {
            Encoding::Text => 2,
            _ => 4,
        };
        let room = (self.end - self.at) as u64 + 1;
        match count.checked_mul(numbers * smallest) {
            Some(bytes) if bytes <= room => Ok(count as usize),
            _ => {
                let problem = format!("the {what} is {count}, but the section ends long before");
                Err(self.source.defect_at(at, self.encoding, problem))
            }
        }
    }

    /// Steps over that many unsigned numbers.
    pub(super) fn skip_sizes(&mut self, what: &str, count: usize) -> Result<(), Defect> {
        if self.encoding == Encoding::Text {
            return (0..count).try_for_each(|_| self.size(what).map(drop));
        }
        let bytes = count.checked_mul(size_of::<u64>());
        match bytes.filter(|&bytes| bytes <= self.end - self.at) {
            Some(bytes) => self.at += bytes,
            None => return Err(self.ends_early(what)),
        }
        Ok(())
    }

    /// Steps over `items` items of so many unsigned numbers each and cuts them into ranges.
    pub(super) fn ranges(
        &mut self,
        what: &str,
        items: usize,
        numbers: usize,
    ) -> Result<Vec<ItemRange>, Defect> {
        let mut bytes = self.at..self.at;
        if self.encoding != Encoding::Text {
            self.skip_sizes(what, items * numbers)?;
        }
        let mut ranges = Vec::with_capacity(items.div_ceil(ITEMS_PER_RANGE));
        let mut left = items;
        while left > 0 {
            let count = left.min(ITEMS_PER_RANGE);
            if self.encoding == Encoding::Text {
                self.skip_sizes(what, count * numbers)?;
                bytes = bytes.end..self.at;
            } else {
                bytes = bytes.end..bytes.end + count * numbers * size_of::<u64>();
            }
            ranges.push(ItemRange {
                count,
                bytes: bytes.clone(),
            });
            left -= count;
        }
        Ok(ranges)
    }

    /// Checks that nothing but white space is left.
    pub(super) fn finish(self) -> Result<(), Defect> {
        let rest = &self.source.bytes[self.at..self.end];
        if rest.iter().all(|&byte| is_space(byte)) {
            return Ok(());
        }
        Err(self.defect("the section goes on where its counts say it ends"))
    }

    /// A defect right here.
    pub(super) fn defect(&self, problem: impl Into<String>) -> Defect {
        self.source.defect_at(self.at, self.encoding, problem)
    }

    fn fixed<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Defect> {
        let rest = &self.source.bytes[self.at..self.end];
        let chunk = *rest.first_chunk().ok_or_else(|| self.ends_early(what))?;
        self.at += N;
        Ok(chunk)
    }

    fn text<T>(&mut self, what: &str, parse: fn(&[u8]) -> Option<T>) -> Result<T, Defect> {
        let rest = &self.source.bytes[self.at..self.end];
        let Some(start) = rest.iter().position(|&byte| !is_space(byte)) else {
            return Err(self.ends_early(what));
        };
        let rest = &rest[start..];
        let length = rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len());
        self.at += start;
        let value = parse(&rest[..length]).ok_or_else(|| self.unreadable(what, &rest[..length]))?;
        self.at += length;
        Ok(value)
    }

    fn ends_early(&self, what: &str) -> Defect {
        self.defect(format!("the section ends where the {what} should be"))
    }

    fn unreadable(&self, what: &str, token: &[u8]) -> Defect {
        let shown = String::from_utf8_lossy(&token[..token.len().min(20)]).into_owned();
        self.defect(format!("`{}` is not a valid {what}", shown.escape_debug()))
    }
}

/// Digits only. Large files are mostly such numbers; `str::parse` is slower, and takes a `+`.
fn decimal(token: &[u8]) -> Option<u64> {
    token.iter().try_fold(0_u64, |value, byte| {
        let digit = byte.wrapping_sub(b'0');
        let shifted = value.checked_mul(10)?;
        (digit < 10).then(|| shifted.checked_add(digit.into()))?
    })
}

/// mshio takes no leading `+`.
fn number<T: FromStr>(token: &[u8]) -> Option<T> {
    if token.len() > LONGEST_NUMBER || token.first() == Some(&b'+') {
        return None;
    }
    std::str::from_utf8(token).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cursor(bytes: &[u8], encoding: Encoding) -> Cursor<'_> {
        let source = MshSource { name: "t", bytes };
        Cursor::new(source, encoding, 0..bytes.len())
    }

    #[test]
    fn the_same_numbers_in_all_encodings() {
        let text = b" 7\r\n-3\t1.5e-3 \n".to_vec();
        let little = [
            &7_u64.to_le_bytes()[..],
            &(-3_i32).to_le_bytes(),
            &1.5e-3_f64.to_le_bytes(),
        ];
        let big = [
            &7_u64.to_be_bytes()[..],
            &(-3_i32).to_be_bytes(),
            &1.5e-3_f64.to_be_bytes(),
        ];
        for (bytes, encoding) in [
            (text, Encoding::Text),
            (little.concat(), Encoding::LittleEndian),
            (big.concat(), Encoding::BigEndian),
        ] {
            let mut cursor = cursor(&bytes, encoding);
            assert_eq!(cursor.size("size"), Ok(7));
            assert_eq!(cursor.int("int"), Ok(-3));
            assert_eq!(cursor.double("double"), Ok(1.5e-3));
            assert_eq!(cursor.finish(), Ok(()));
        }
    }

    #[test]
    fn numbers_that_are_none() {
        for token in ["-1", "+1", "1.5", "18446744073709551616", "1x", "\u{b2}"] {
            assert!(
                cursor(token.as_bytes(), Encoding::Text).size("x").is_err(),
                "{token}"
            );
        }
        for token in ["+1", "2147483648", "1e3", "--1"] {
            assert!(
                cursor(token.as_bytes(), Encoding::Text).int("x").is_err(),
                "{token}"
            );
        }
    }

    #[test]
    fn counts_are_bounded_by_the_bytes_that_exist() {
        assert_eq!(cursor(b"2 1 1", Encoding::Text).count("n", 1), Ok(2));
        assert!(cursor(b"3 1 1", Encoding::Text).count("n", 1).is_err());
        let huge = u64::MAX.to_le_bytes();
        assert!(cursor(&huge, Encoding::LittleEndian).count("n", 4).is_err());
        assert!(
            cursor(&huge, Encoding::LittleEndian)
                .skip_sizes("n", usize::MAX)
                .is_err()
        );
    }
}
