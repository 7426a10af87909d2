//! Dictionaries of square markers.

use std::sync::Arc;

use crate::error::{Error, Result};

/// A dictionary of OpenCV: `DICT_4X4_50` to `DICT_7X7_1000`, `DICT_ARUCO_ORIGINAL`, `DICT_APRILTAG_…`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dictionary {
    name: &'static str,
    bits: usize,
    /// Wrong bits with which its markers are still distinguished.
    correctable: u32,
    codes: Arc<[u64]>,
}

/// Name, family, number of markers, and correctable bits: the markers of a family are the same.
const KNOWN: [(&str, &str, usize, u32); 22] = [
    ("DICT_4X4_100", "DICT_4X4", 100, 1),
    ("DICT_4X4_1000", "DICT_4X4", 1000, 0),
    ("DICT_4X4_250", "DICT_4X4", 250, 1),
    ("DICT_4X4_50", "DICT_4X4", 50, 1),
    ("DICT_5X5_100", "DICT_5X5", 100, 3),
    ("DICT_5X5_1000", "DICT_5X5", 1000, 2),
    ("DICT_5X5_250", "DICT_5X5", 250, 2),
    ("DICT_5X5_50", "DICT_5X5", 50, 3),
    ("DICT_6X6_100", "DICT_6X6", 100, 5),
    ("DICT_6X6_1000", "DICT_6X6", 1000, 4),
    ("DICT_6X6_250", "DICT_6X6", 250, 5),
    ("DICT_6X6_50", "DICT_6X6", 50, 6),
    ("DICT_7X7_100", "DICT_7X7", 100, 8),
    ("DICT_7X7_1000", "DICT_7X7", 1000, 6),
    ("DICT_7X7_250", "DICT_7X7", 250, 8),
    ("DICT_7X7_50", "DICT_7X7", 50, 9),
    ("DICT_APRILTAG_16h5", "DICT_APRILTAG_16h5", 30, 0),
    ("DICT_APRILTAG_25h9", "DICT_APRILTAG_25h9", 35, 0),
    ("DICT_APRILTAG_36h10", "DICT_APRILTAG_36h10", 2320, 0),
    ("DICT_APRILTAG_36h11", "DICT_APRILTAG_36h11", 587, 0),
    ("DICT_ARUCO_MIP_36h12", "DICT_ARUCO_MIP_36h12", 250, 12),
    ("DICT_ARUCO_ORIGINAL", "DICT_ARUCO_ORIGINAL", 1024, 0),
];

/// The codes of the families.
const CODES: &str = include_str!("dictionaries.txt");

impl Dictionary {
    /// The dictionary with a name, in any case, with or without `DICT_` or `DICT_APRILTAG_`.
    ///
    /// # Errors
    /// If there is none, with the known names.
    pub fn from_name(name: &str) -> Result<Self> {
        let same = |known: &str| {
            known.eq_ignore_ascii_case(name)
                || known.strip_prefix("DICT_").is_some_and(|it| it.eq_ignore_ascii_case(name))
                || known.strip_prefix("DICT_APRILTAG_").is_some_and(|it| it.eq_ignore_ascii_case(name))
        };
        let known = KNOWN.iter().find(|it| same(it.0));
        known.and_then(Dictionary::read).ok_or_else(|| {
            let names = KNOWN.map(|it| it.0).join(", ");
            Error::new(format!("found the dictionary {name:?}, expected one of {names}"))
        })
    }

    fn read((name, family, count, correctable): &(&'static str, &str, usize, u32)) -> Option<Self> {
        let mut words = CODES
            .lines()
            .map(|line| line.split(' '))
            .find_map(|mut words| (words.next()? == *family).then_some(words))?;
        let bits: usize = words.next()?.parse().ok()?;
        let digits = (bits * bits).div_ceil(4);
        let codes = words.next()?;
        let code = |at: usize| u64::from_str_radix(codes.get(at * digits..(at + 1) * digits)?, 16).ok();
        let codes = (0..*count).map(code).collect::<Option<_>>()?;
        Some(Dictionary { name, bits, correctable: *correctable, codes })
    }

    /// The smallest sufficient dictionary of each set with the same initial markers.
    #[must_use]
    pub fn smallest_with(markers: usize) -> Vec<Self> {
        let mut all: Vec<Dictionary> = KNOWN.iter().filter_map(Dictionary::read).collect();
        all.retain(|it| it.len() >= markers);
        all.sort_by_key(Dictionary::len);
        let mut smallest: Vec<Dictionary> = Vec::new();
        for dictionary in all {
            if !smallest.iter().any(|it| it.is_alike(&dictionary)) {
                smallest.push(dictionary);
            }
        }
        smallest
    }

    /// True if another one has the same initial markers.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        self.bits == other.bits && self.codes.first() == other.codes.first()
    }

    /// Name of the dictionary.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Number of its markers.
    #[must_use]
    pub fn len(&self) -> usize {
        self.codes.len()
    }

    /// True if it has no markers, which none is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.codes.is_empty()
    }

    /// Bits along a side, without the border.
    #[must_use]
    pub fn bits(&self) -> usize {
        self.bits
    }

    /// True if the cell of a marker is black; cells count from its upper left one, without the border. Cells outside are border: black.
    #[must_use]
    pub fn is_black(&self, id: usize, column: usize, row: usize) -> bool {
        if column >= self.bits || row >= self.bits {
            return true;
        }
        self.codes.get(id).is_none_or(|code| code >> (row * self.bits + column) & 1 == 1)
    }

    /// The marker of a code with few wrong bits, the number of quarter turns clockwise by which it is turned, and the number of wrong bits.
    pub(crate) fn find(&self, code: u64) -> Option<(usize, usize, u32)> {
        // Half of the correctable bits: a marker is found beside others, and a wrong one costs more than a missing one.
        let most = self.correctable.div_ceil(2).min(2);
        let mut back = code;
        let mut best = (most + 1, 0, 0);
        for turns in 0..4 {
            for (id, own) in self.codes.iter().enumerate() {
                let wrong = (own ^ back).count_ones();
                if wrong < best.0 {
                    best = (wrong, id, turns);
                }
            }
            back = turned_back(back, self.bits);
        }
        (best.0 <= most).then_some((best.1, best.2, best.0))
    }
}

/// A code a quarter turn anticlockwise.
fn turned_back(code: u64, bits: usize) -> u64 {
    let bit = |column: usize, row: usize| code >> (row * bits + column) & 1;
    // The last column becomes the first row.
    let cells = (0..bits * bits).map(|at| (at, bit(bits - 1 - at / bits, at % bits)));
    cells.fold(0, |turned, (at, value)| turned | value << at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_marker_is_found_with_its_turn() {
        for dictionary in Dictionary::smallest_with(17) {
            let bits = dictionary.bits();
            for id in [0, 7, 16] {
                let mut code = dictionary.codes[id];
                for turns in 0..4 {
                    assert_eq!(dictionary.find(code), Some((id, turns, 0)), "{}", dictionary.name());
                    // Three quarter turns back are one forward.
                    for _ in 0..3 {
                        code = turned_back(code, bits);
                    }
                }
            }
        }
        assert_eq!(Dictionary::from_name("4x4_100").unwrap().len(), 100);
        assert_eq!(Dictionary::smallest_with(60).iter().filter(|it| it.bits() == 4).count(), 1);
    }
}
