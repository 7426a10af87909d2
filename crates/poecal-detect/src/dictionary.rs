//! Dictionaries of square markers.

use calib_targets_aruco::{Matcher, builtins, resolve_dictionary};

use crate::error::{Error, Result};

/// A dictionary of OpenCV: `DICT_4X4_50` to `DICT_7X7_1000`, `DICT_ARUCO_ORIGINAL`, `DICT_APRILTAG_…`.
#[derive(Clone, Copy, Debug)]
pub struct Dictionary {
    inner: calib_targets_aruco::Dictionary,
}

impl PartialEq for Dictionary {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Dictionary {
    /// The dictionary with a name, in any case, with or without `DICT_`.
    ///
    /// # Errors
    /// If there is none, with the names that there are.
    pub fn named(name: &str) -> Result<Self> {
        let same = |known: &&&str| {
            known.eq_ignore_ascii_case(name)
                || known.strip_prefix("DICT_").is_some_and(|it| it.eq_ignore_ascii_case(name))
        };
        let known = builtins::BUILTIN_DICTIONARY_NAMES.iter().find(same);
        let inner = known.and_then(|it| resolve_dictionary(it)).ok_or_else(|| {
            let names = builtins::BUILTIN_DICTIONARY_NAMES.join(", ");
            Error::new(format!("found the dictionary {name:?}, expected one of {names}"))
        })?;
        Ok(Dictionary { inner })
    }

    /// Of dictionaries with the same markers in the beginning the smallest one that has so many.
    #[must_use]
    pub fn smallest(markers: usize) -> Vec<Self> {
        let all = builtins::BUILTIN_DICTIONARY_NAMES.iter().filter_map(|name| resolve_dictionary(name));
        let mut all: Vec<Dictionary> = all.map(|inner| Dictionary { inner }).collect();
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

    /// Whether another one has the same markers in the beginning.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        let (own, other) = (self.inner, other.inner);
        own.marker_size() == other.marker_size() && own.codes().first() == other.codes().first()
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.inner.name()
    }

    /// How many markers it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.inner.codes().len()
    }

    /// Whether it has no markers, which none is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inner.codes().is_empty()
    }

    /// Bits along a side, without the border.
    #[must_use]
    pub fn bits(&self) -> usize {
        self.inner.marker_size()
    }

    /// Whether the cell of a marker is black; cells count from its upper left one, without the border. What is outside is border: black.
    #[must_use]
    pub fn is_black(&self, id: usize, column: usize, row: usize) -> bool {
        let bits = self.bits();
        if column >= bits || row >= bits {
            return true;
        }
        self.inner.codes().get(id).is_none_or(|code| code >> (row * bits + column) & 1 == 1)
    }

    /// What finds a marker among its rotations, with so many wrong bits as its neighbours in the dictionary bear.
    pub(crate) fn matcher(&self) -> Matcher {
        // Half of what the dictionary can correct: a marker is found beside others, and a wrong one costs more than a missing one.
        Matcher::new(self.inner, self.inner.max_correction_bits().div_ceil(2).min(2))
    }
}
