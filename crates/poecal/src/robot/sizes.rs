//! How large the terms of joints are: one prior standard deviation for each group of them.

use std::ops::{Index, IndexMut};

use super::Gives;
use crate::unit::Unit;

/// A group of terms whose coefficients are of one size.
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
    /// Second harmonic across the axis, and first where bearings give in all directions; radians of amplitude.
    Wobble,
    /// Half the play of gears: of factors whose names begin with `approach`, radians each unit.
    Backlash,
    /// Of all other factors, radians each unit.
    Factors,
    /// Gears, bearings and links that give under a payload: of the factor `payload`, radians each kilogram at full lever.
    Payload,
    /// Bearings and links that shift under weight; metres.
    Shift,
    /// First and second harmonic along three axes; metres of amplitude.
    Runout,
}

impl TermGroup {
    /// All groups.
    pub const ALL: [TermGroup; 10] = [
        TermGroup::Sag,
        TermGroup::Tilt,
        TermGroup::Ratio,
        TermGroup::Harmonics,
        TermGroup::Wobble,
        TermGroup::Backlash,
        TermGroup::Factors,
        TermGroup::Payload,
        TermGroup::Shift,
        TermGroup::Runout,
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
            TermGroup::Payload => "payload",
            TermGroup::Shift => "shift",
            TermGroup::Runout => "runout",
        }
    }

    /// Unit of its sizes.
    #[must_use]
    pub fn unit(self) -> Unit {
        match self {
            TermGroup::Shift | TermGroup::Runout => Unit::Metre,
            TermGroup::Sag
            | TermGroup::Tilt
            | TermGroup::Ratio
            | TermGroup::Harmonics
            | TermGroup::Wobble
            | TermGroup::Backlash
            | TermGroup::Factors
            | TermGroup::Payload => Unit::Radian,
        }
    }

    /// That unit in words.
    pub(super) fn unit_words(self) -> &'static str {
        if self.unit() == Unit::Metre { "metres" } else { "radians" }
    }

    /// Symbol of a thousandth of that unit, in which people read effects.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        if self.unit() == Unit::Metre { "mm" } else { "mrad" }
    }

    /// The same of its sizes: of a payload each kilogram.
    #[must_use]
    pub fn symbol_of_sizes(self) -> &'static str {
        if self == TermGroup::Payload { "mrad/kg" } else { self.symbol() }
    }
}

/// Prior standard deviation of the terms of each group, radians or metres ([`TermGroup::unit`]); 0 leaves a group out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes([f64; TermGroup::ALL.len()]);

impl Sizes {
    /// No term at all: geometry alone.
    pub const NONE: Sizes = Sizes([0.0; TermGroup::ALL.len()]);
    /// Sizes of all groups: the common ones, and of a group that is commonly left out what is usual where it is not.
    pub(crate) const ALL: Sizes = Sizes([1e-3, 1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-5, 1e-4, 1e-4, 3e-5]);
    /// Sizes that are common among industrial robots.
    pub const COMMON: Sizes = Sizes([1e-3, 1e-3, 1e-4, 1e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    /// A third of these: what does no harm where nothing tells the size.
    pub const SMALL: Sizes = Sizes([3e-4, 3e-4, 3e-5, 3e-5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

impl Sizes {
    /// In which directions bearings and links give that have terms of these sizes.
    #[must_use]
    pub fn gives(&self) -> Gives {
        let slides = |group: TermGroup| group.unit() == Unit::Metre && self[group] > 0.0;
        if TermGroup::ALL.into_iter().any(slides) { Gives::All } else { Gives::Tilting }
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
