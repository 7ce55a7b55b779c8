//! Damage to the bytes of any file.

use super::dice::Dice;

/// Flips up to four bits.
pub fn flip_bits(bytes: &mut [u8], dice: &mut Dice) {
    for _ in 0..1 + dice.below(4) {
        let at = dice.below(bytes.len());
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= 1 << dice.below(8);
        }
    }
}

/// Deletes, doubles or moves a stretch that begins and ends at one of these bytes, or anywhere.
pub fn move_stretch(bytes: &mut Vec<u8>, separators: &[Option<u8>], dice: &mut Dice) {
    let separator = dice.pick(separators);
    let mut bound = || {
        let from = dice.below(bytes.len());
        let here = |&byte: &u8| separator.is_none_or(|separator| byte == separator);
        let at = bytes[from..].iter().position(here);
        at.map_or(bytes.len(), |at| from + at)
    };
    let (a, b, target) = (bound(), bound(), bound());
    let stretch = bytes[a.min(b)..a.max(b)].to_vec();
    let doubles = dice.below(3) == 1;
    if !doubles {
        bytes.drain(a.min(b)..a.max(b));
    }
    if doubles || dice.chance(0.5) {
        let target = target.min(bytes.len());
        bytes.splice(target..target, stretch);
    }
}
