//! How large the terms of joints are: one prior standard deviation for each group of them.

use std::ops::{Index, IndexMut};

/// A group of terms whose coefficients are of one size.
///
/// ```
/// use poecal::robot::TermGroup;
/// assert_eq!(TermGroup::Sag.name(), "sag");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TermGroup {
    /// Gears that give about the joint's own axis under weight; radians at the largest moment.
    Sag,
    /// Bearings and links that give across the axis under weight; radians at the largest moment.
    Tilt,
    /// Ratios of gears; radians each radian.
    Ratio,
    /// First and second harmonic of the joint's own value; radians of amplitude.
    Harmonics,
    /// Second harmonic across the axis; radians of amplitude.
    Wobble,
    /// Half the play of gears: of factors whose names begin with `approach`, radians each unit.
    Backlash,
    /// Of all other factors, radians each unit.
    Factors,
}

impl TermGroup {
    /// All groups.
    pub const ALL: [TermGroup; 7] = [
        TermGroup::Sag,
        TermGroup::Tilt,
        TermGroup::Ratio,
        TermGroup::Harmonics,
        TermGroup::Wobble,
        TermGroup::Backlash,
        TermGroup::Factors,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            TermGroup::Sag => "sag",
            TermGroup::Tilt => "tilt",
            TermGroup::Ratio => "ratio",
            TermGroup::Harmonics => "harmonics",
            TermGroup::Wobble => "wobble",
            TermGroup::Backlash => "backlash",
            TermGroup::Factors => "factors",
        }
    }
}

/// Prior standard deviation of the terms of each group, radians ([`TermGroup`]); 0 leaves a group out.
///
/// ```
/// use poecal::robot::{Sizes, TermGroup};
/// let mut sizes = Sizes::COMMON;
/// sizes[TermGroup::Tilt] = 0.0;
/// assert!(sizes[TermGroup::Sag] == 1e-3 && sizes != Sizes::NONE);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes([f64; TermGroup::ALL.len()]);

impl Sizes {
    /// No term at all: geometry alone.
    pub const NONE: Sizes = Sizes([0.0; TermGroup::ALL.len()]);
    /// Sizes of all groups: the common ones, and of a group that is commonly left out what is usual where it is not.
    pub(crate) const ALL: Sizes = Sizes([1e-3, 1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-5]);
    /// Sizes that are common among industrial robots.
    pub const COMMON: Sizes = Sizes([1e-3, 1e-3, 1e-4, 1e-4, 0.0, 0.0, 0.0]);
}

impl Sizes {
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
