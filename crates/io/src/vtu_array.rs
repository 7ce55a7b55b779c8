//! Arrays of VTK's XML files: blocks compressed with zlib, in base64.

use std::io::{self, Write};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;

/// The attribute of a file that holds such arrays.
pub(crate) const COMPRESSOR: &str = "vtkZLibDataCompressor";
/// Bytes of a block before compression: a whole number of values of every type.
const BLOCK: usize = 1 << 17;
/// Bytes of a block that are compressed first, to see what compression gains.
const SAMPLE: usize = 1 << 12;
/// Share of the sample that must be gained: the mantissas of most fields are noise, which costs
/// time and gains next to nothing.
const LEAST_GAIN: f64 = 0.25;

/// A number that VTK's files hold.
pub(crate) trait Number: Copy + PartialOrd + std::fmt::Debug + Sync {
    /// What VTK calls the type.
    const KIND: &'static str;
    /// Appends its bytes, the lowest first.
    fn append_to(self, bytes: &mut Vec<u8>);
}

impl Number for f64 {
    const KIND: &'static str = "Float64";
    fn append_to(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Number for i32 {
    const KIND: &'static str = "Int32";
    fn append_to(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Number for u64 {
    const KIND: &'static str = "UInt64";
    fn append_to(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Number for u8 {
    const KIND: &'static str = "UInt8";
    fn append_to(self, bytes: &mut Vec<u8>) {
        bytes.push(self);
    }
}

/// An array as a file holds it.
pub(crate) struct EncodedArray {
    kind: &'static str,
    name: &'static str,
    components: u32,
    /// Smallest and largest value; none without values.
    range: Option<[String; 2]>,
    /// Number and sizes of the blocks.
    header: Vec<u8>,
    blocks: Vec<Vec<u8>>,
}

impl EncodedArray {
    /// Encodes `values`, `components` for each point or cell. Every bit comes back.
    ///
    /// # Errors
    /// If the compressor refuses them.
    pub(crate) fn of<T: Number>(
        name: &'static str,
        components: u32,
        values: &[T],
    ) -> io::Result<Self> {
        let block = BLOCK / size_of::<T>();
        // Readers want a block even of an array without values.
        let blocks = match values.is_empty() {
            true => vec![compressed(values)?],
            false => values
                .par_chunks(block)
                .map(compressed)
                .collect::<io::Result<_>>()?,
        };
        Ok(Self {
            kind: T::KIND,
            name,
            components,
            range: range(values),
            header: header(size_of_val(values), &blocks),
            blocks,
        })
    }

    /// Writes its element.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        write!(
            out,
            r#"<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="binary""#,
            self.kind, self.name, self.components
        )?;
        if let Some([min, max]) = &self.range {
            write!(out, r#" RangeMin="{min}" RangeMax="{max}""#)?;
        }
        write!(out, ">")?;
        write_base64(out, std::slice::from_ref(&self.header))?;
        write_base64(out, &self.blocks)?;
        write!(out, "</DataArray>")
    }
}

fn compressed<T: Number>(values: &[T]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(size_of_val(values));
    values.iter().for_each(|value| value.append_to(&mut bytes));
    let middle = bytes.len() / 2;
    let sample = &bytes[middle - middle.min(SAMPLE / 2)..bytes.len().min(middle + SAMPLE / 2)];
    let left = deflated(sample, Compression::fast())?.len() as f64;
    let is_worth_it = left <= (1.0 - LEAST_GAIN) * sample.len() as f64;
    let level = match is_worth_it {
        true => Compression::fast(),
        false => Compression::none(),
    };
    deflated(&bytes, level)
}

fn deflated(bytes: &[u8], level: Compression) -> io::Result<Vec<u8>> {
    // What is stored grows a little, and must not double the room it has for that.
    let room = Vec::with_capacity(bytes.len() + bytes.len() / 64 + 64);
    let mut encoder = ZlibEncoder::new(room, level);
    encoder.write_all(bytes)?;
    let mut left = encoder.finish()?;
    left.shrink_to_fit();
    Ok(left)
}

/// Number of blocks, their size before compression, that of the last one if it is smaller, and the
/// compressed size of each. They are a base64 text of their own before that of the blocks
/// (<https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>).
fn header(bytes: usize, blocks: &[Vec<u8>]) -> Vec<u8> {
    let sizes = blocks.iter().map(Vec::len);
    let header = [blocks.len(), BLOCK, bytes % BLOCK]
        .into_iter()
        .chain(sizes);
    header.flat_map(|n| (n as u64).to_le_bytes()).collect()
}

/// Writes blocks, one behind the other, as one base64 text. Large ones would take as much memory
/// again if they were made a text first.
fn write_base64(out: &mut impl Write, blocks: &[Vec<u8>]) -> io::Result<()> {
    let mut bytes = Vec::new();
    let mut text = String::new();
    for (number, block) in (1..).zip(blocks) {
        bytes.extend_from_slice(block);
        // Three bytes are four letters; only the end of all of them is filled up.
        let ready = match number == blocks.len() {
            true => bytes.len(),
            false => bytes.len() - bytes.len() % 3,
        };
        text.clear();
        BASE64_STANDARD.encode_string(&bytes[..ready], &mut text);
        out.write_all(text.as_bytes())?;
        bytes.drain(..ready);
    }
    Ok(())
}

/// The smallest and the largest of the numbers; what is not a number counts for neither.
fn range<T: Number>(values: &[T]) -> Option<[String; 2]> {
    let numbers = || {
        values
            .iter()
            .copied()
            .filter(|value| value.partial_cmp(value).is_some())
    };
    let min = numbers().reduce(|a, b| if b < a { b } else { a })?;
    let max = numbers().reduce(|a, b| if b > a { b } else { a })?;
    Some([format!("{min:?}"), format!("{max:?}")])
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    /// What the format says of an array, read back with the sizes its header names.
    fn decoded(array: &EncodedArray, blocks: usize) -> Vec<f64> {
        let mut text = Vec::new();
        for part in [std::slice::from_ref(&array.header), &array.blocks] {
            write_base64(&mut text, part).expect("written");
        }
        let header = (3 + blocks) * 8;
        let split = header.div_ceil(3) * 4;
        let (head, data) = text.split_at(split);
        let sizes: Vec<usize> = BASE64_STANDARD
            .decode(head)
            .expect("a header")
            .chunks(8)
            .map(|bytes| u64::from_le_bytes(bytes.try_into().expect("eight bytes")) as usize)
            .collect();
        assert_eq!(sizes[0], blocks);
        let mut data = &BASE64_STANDARD.decode(data).expect("blocks")[..];
        let mut values = Vec::new();
        for (index, &size) in sizes[3..].iter().enumerate() {
            let (block, rest) = data.split_at(size);
            let mut bytes = Vec::new();
            let read = ZlibDecoder::new(block).read_to_end(&mut bytes);
            let is_last = index + 1 == blocks && sizes[2] > 0;
            let wanted = if is_last { sizes[2] } else { sizes[1] };
            assert_eq!(read.expect("zlib"), wanted, "block {index}");
            let numbers = bytes.chunks(8).map(|b| b.try_into().expect("eight bytes"));
            values.extend(numbers.map(f64::from_le_bytes));
            data = rest;
        }
        assert!(data.is_empty());
        values
    }

    #[test]
    fn blocks_have_the_sizes_that_the_header_names() {
        let whole = BLOCK / 8;
        for (count, blocks) in [
            (1, 1),
            (whole - 1, 1),
            (whole, 1),
            (whole + 1, 2),
            (3 * whole, 3),
        ] {
            let values: Vec<f64> = (0..count).map(|i| (i as f64).sin()).collect();
            let array = EncodedArray::of("f", 1, &values).expect("encoded");
            assert_eq!(decoded(&array, blocks), values, "{count} values");
        }
    }

    #[test]
    fn the_range_leaves_out_what_is_no_number() {
        let array = EncodedArray::of("f", 1, &[f64::NAN, 2.0, -1.5]).expect("encoded");
        assert_eq!(array.range, Some(["-1.5".into(), "2.0".into()]));
        let none = EncodedArray::of::<f64>("f", 1, &[]).expect("encoded");
        assert_eq!(none.range, None);
    }
}
