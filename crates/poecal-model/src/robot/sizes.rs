//! Sizes of the terms of joints: one prior standard deviation for each group of them.

use std::ops::{Index, IndexMut};

use poecal_arm::TermGroup;

use super::CompliantDirections;

const COUNT: usize = TermGroup::ALL.len();

/// Prior standard deviation of the terms of each group, radians or metres ([`TermGroup::is_of_lengths`]); 0 leaves a group out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes([f64; COUNT]);

impl Sizes {
    /// No terms: geometry alone.
    pub const NONE: Sizes = Sizes([0.0; COUNT]);
    /// Sizes of all groups: the common ones, and for a group that is commonly left out its usual size.
    pub const ALL: Sizes = Sizes::of_table(0);
    /// Sizes that are common among industrial robots.
    pub const COMMON: Sizes = Sizes::of_table(1);
    /// A third of these: harmless sizes if the data do not determine them.
    pub const SMALL: Sizes = Sizes::of_table(2);

    /// Sizes of a column of the table of groups.
    const fn of_table(column: usize) -> Self {
        let mut sizes = [0.0; COUNT];
        let mut at = 0;
        while at < COUNT {
            sizes[at] = TermGroup::ALL[at].row().sizes[column];
            at += 1;
        }
        Sizes(sizes)
    }

    /// Compliant directions of bearings and links that have terms of these sizes.
    #[must_use]
    pub fn gives(&self) -> CompliantDirections {
        let slides = |group: TermGroup| group.is_of_lengths() && self[group] > 0.0;
        if TermGroup::ALL.into_iter().any(slides) { CompliantDirections::All } else { CompliantDirections::Tilting }
    }

    /// The larger of both, group by group.
    #[must_use]
    pub fn max(&self, other: &Sizes) -> Sizes {
        let mut both = *self;
        TermGroup::ALL.iter().for_each(|&group| both[group] = both[group].max(other[group]));
        both
    }
}

impl Index<TermGroup> for Sizes {
    type Output = f64;

    fn index(&self, group: TermGroup) -> &f64 {
        &self.0[group as usize]
    }
}

impl IndexMut<TermGroup> for Sizes {
    fn index_mut(&mut self, group: TermGroup) -> &mut f64 {
        &mut self.0[group as usize]
    }
}
