//! Damage to the bytes of any file.

use super::random_stream::RandomStream;

/// Flips up to four bits.
pub fn flip_bits(bytes: &mut [u8], random: &mut RandomStream) {
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= 1 << random.below(8);
        }
    }
}

/// Deletes, doubles or moves a stretch that begins and ends at one of these bytes, or anywhere.
pub fn move_stretch(bytes: &mut Vec<u8>, separators: &[Option<u8>], random: &mut RandomStream) {
    let separator = random.pick(separators);
    let mut bound = || {
        let from = random.below(bytes.len());
        let here = |&byte: &u8| separator.is_none_or(|separator| byte == separator);
        let at = bytes[from..].iter().position(here);
        at.map_or(bytes.len(), |at| from + at)
    };
    let (a, b, target) = (bound(), bound(), bound());
    let stretch = bytes[a.min(b)..a.max(b)].to_vec();
    let doubles = random.below(3) == 1;
    if !doubles {
        bytes.drain(a.min(b)..a.max(b));
    }
    if doubles || random.chance(0.5) {
        let target = target.min(bytes.len());
        bytes.splice(target..target, stretch);
    }
}
