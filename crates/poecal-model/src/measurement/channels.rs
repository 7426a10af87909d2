//! Numbers of a measurement: their names and quantities.

use std::ops::{Deref, Range};

use super::{ByQuantity, Quantity};

/// Largest number of values of one measurement.
pub const NUMBERS: usize = 6;

/// One number of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Name of the number in columns of files.
    pub name: &'static str,
    /// Quantity.
    pub quantity: Quantity,
}

impl Channel {
    /// Index among the components of its quantity.
    #[must_use]
    pub fn component(&self) -> usize {
        self.quantity.component_names().iter().position(|name| *name == self.name).unwrap_or_default()
    }
}

/// Numbers of a function, with the indices of those of each quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channels {
    all: &'static [Channel],
    /// First index of each quantity, and their number.
    parts: ByQuantity<(u8, u8)>,
}

impl Channels {
    /// Channels of a function.
    ///
    /// # Panics
    /// With more than [`NUMBERS`] channels, or those of one quantity not one after the other: a constant of these does not compile.
    #[must_use]
    pub const fn new(all: &'static [Channel]) -> Self {
        assert!(all.len() <= NUMBERS, "a measurement has at most six numbers");
        let mut parts = [(0, 0); Quantity::ALL.len()];
        let mut k = 0;
        while k < all.len() {
            let (first, count) = &mut parts[all[k].quantity as usize];
            if *count == 0 {
                *first = k as u8;
            }
            assert!((*first + *count) as usize == k, "channels of one quantity follow one another");
            *count += 1;
            k += 1;
        }
        Channels { all, parts: ByQuantity::of_values(parts) }
    }

    /// Indices of the numbers of a quantity; empty if it is not measured.
    #[must_use]
    #[inline]
    pub fn range(&self, quantity: Quantity) -> Range<usize> {
        let (first, count) = self.parts[quantity];
        usize::from(first)..usize::from(first + count)
    }

    /// Indices of the numbers of a quantity with their components: in order if all are measured, else by name.
    #[inline]
    pub fn components(&self, quantity: Quantity) -> impl Iterator<Item = (usize, usize)> {
        let own = self.range(quantity);
        let (first, all) = (own.start, own.len() == quantity.components());
        own.map(move |k| (k, if all { k - first } else { self.all[k].component() }))
    }

    /// True if a number of this quantity is measured.
    #[must_use]
    #[inline]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.parts[quantity].1 > 0
    }
}

impl IntoIterator for &Channels {
    type Item = &'static Channel;
    type IntoIter = std::slice::Iter<'static, Channel>;

    fn into_iter(self) -> Self::IntoIter {
        self.all.iter()
    }
}

impl Deref for Channels {
    type Target = [Channel];

    fn deref(&self) -> &[Channel] {
        self.all
    }
}
