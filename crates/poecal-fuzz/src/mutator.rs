//! Variations of seeds, the same in every run.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

use crate::LONGEST;

/// Texts in place of a number.
const NUMBERS: [&str; 28] = [
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "1e-9",
    "1e-300",
    "5e-324",
    "1e-16",
    "1e5",
    "999999",
    "1e6",
    "1000001",
    "-1e6",
    "1e15",
    "1e300",
    "1e308",
    "1e309",
    "-1e999",
    "nan",
    "inf",
    "-inf",
    "0,5",
    "1.000,5",
    "3.141592653589793",
    "4294967296",
    "18446744073709551616",
    "0x10",
];
/// Pieces that may be inserted anywhere.
const PIECES: [&str; 22] = [
    "\n",
    "\r",
    "\r\n",
    "\t",
    " ",
    ",",
    ";",
    "\"",
    "'",
    "\"\"",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    "&",
    "#",
    "\u{feff}",
    "\u{0}",
    "\u{1b}[2J",
    "µé\u{2028}",
];

/// Makes variations of seeds: bytes changed, inserted, removed, doubled; words and numbers replaced; parts of other seeds inserted.
#[derive(Debug)]
pub struct Mutator<'a> {
    generator: ChaCha8Rng,
    seeds: &'a [Vec<u8>],
    words: &'a [&'a str],
}

impl<'a> Mutator<'a> {
    /// Mutator of these seeds, with words that inputs contain; the same number leads to the same variations.
    #[must_use]
    pub fn new(number: u64, seeds: &'a [Vec<u8>], words: &'a [&'a str]) -> Self {
        Mutator { generator: ChaCha8Rng::seed_from_u64(number), seeds, words }
    }

    /// The next variation of some seed.
    pub fn variation(&mut self) -> Vec<u8> {
        let mut data = self.seed().to_vec();
        // Usually one change, seldom many: most inputs are then read to their end.
        for _ in 0..=self.generator.next_u64().trailing_zeros() {
            self.change(&mut data);
        }
        data.truncate(LONGEST);
        data
    }

    fn seed(&mut self) -> &'a [u8] {
        let index = self.draw_below(self.seeds.len());
        self.seeds.get(index).map_or(&[], Vec::as_slice)
    }

    /// A number from 0 to below a limit.
    fn draw_below(&mut self, limit: usize) -> usize {
        usize::try_from(self.generator.next_u64() % limit.max(1) as u64).unwrap_or(0)
    }

    /// A word at random.
    fn word(&mut self, words: &[&'a str]) -> &'a str {
        let index = self.draw_below(words.len());
        words.get(index).copied().unwrap_or_default()
    }

    /// A stretch of bytes, mostly a short one.
    fn stretch(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.draw_below(length + 1);
        let most = if self.draw_below(8) == 0 { length } else { 24 };
        let count = self.draw_below(most + 1);
        start..(start + count).min(length)
    }

    fn change(&mut self, data: &mut Vec<u8>) {
        let at = self.draw_below(data.len() + 1);
        match self.draw_below(12) {
            0 => {
                let bit = self.draw_below(8);
                if let Some(byte) = data.get_mut(at) {
                    *byte ^= 1 << bit;
                }
            }
            1 => {
                let byte = u8::try_from(self.draw_below(256)).unwrap_or(0);
                data.insert(at, byte);
            }
            2 => {
                let stretch = self.stretch(data.len());
                data.drain(stretch);
            }
            3 => {
                let piece = self.word(&PIECES);
                data.splice(at..at, piece.bytes());
            }
            4 => {
                let stretch = self.stretch(data.len());
                let doubled = data.get(stretch).unwrap_or_default().to_vec();
                data.splice(at..at, doubled);
            }
            5 | 6 => {
                let word = self.word(self.words);
                let taken = self.token_at(data, at, |byte| byte.is_ascii_alphanumeric() || byte == b'_');
                data.splice(taken, word.bytes());
            }
            7..=9 => {
                let number = self.word(&NUMBERS);
                let taken = self.token_at(data, at, |byte| byte.is_ascii_digit() || b".-+e".contains(&byte));
                data.splice(taken, number.bytes());
            }
            10 => {
                let other = self.seed();
                let stretch = self.stretch(other.len());
                data.splice(at..at, other.get(stretch).unwrap_or_default().iter().copied());
            }
            _ => self.change_line(data, at),
        }
    }

    /// The first run of bytes that belong together from here on, or an empty range at the end.
    fn token_at(&mut self, data: &[u8], at: usize, belongs: impl Fn(u8) -> bool) -> std::ops::Range<usize> {
        let rest = data.get(at..).unwrap_or_default();
        let start = at + rest.iter().position(|&byte| belongs(byte)).unwrap_or(rest.len());
        let token = data.get(start..).unwrap_or_default();
        start..start + token.iter().position(|&byte| !belongs(byte)).unwrap_or(token.len())
    }

    /// Removes or doubles the current line, or ends the text there.
    fn change_line(&mut self, data: &mut Vec<u8>, at: usize) {
        let start = data.iter().take(at).rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        let rest = data.get(start..).unwrap_or_default();
        let end = start + rest.iter().position(|&byte| byte == b'\n').map_or(rest.len(), |newline| newline + 1);
        match self.draw_below(5) {
            0 | 1 => drop(data.drain(start..end)),
            2 | 3 => {
                let line = data.get(start..end).unwrap_or_default().to_vec();
                data.splice(start..start, line);
            }
            _ => data.truncate(at),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Mutator;

    #[test]
    fn variations_are_the_same_in_every_run() {
        let seeds = [b"x[mm],y[mm]\n1,2\n".to_vec()];
        let (mut some, mut others) = (Mutator::new(7, &seeds, &["deg"]), Mutator::new(7, &seeds, &["deg"]));
        for _ in 0..20 {
            assert_eq!(some.variation(), others.variation());
        }
    }
}
