//! Sizes that are tried.

use crate::robot::TermGroup;

/// Sizes that are tried, radians or metres, in order: from a precise robot's to those of plastic gears.
const OF_MOMENTS: &[f64] = &[0.0, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2];
const OF_VALUES: &[f64] = &[0.0, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2];
const OF_FACTORS: &[f64] = &[0.0, 1e-6, 1e-5, 1e-4, 1e-3];
const OF_PAYLOADS: &[f64] = &[0.0, 1e-5, 3e-5, 1e-4, 3e-4];
const OF_LENGTHS: &[f64] = &[0.0, 1e-5, 3e-5, 1e-4, 3e-4];
/// Groups whose sizes are chosen in turn; those of gravity are of one size.
pub(super) const CHOSEN: [(&[TermGroup], &[f64]); 9] = [
    (&[TermGroup::Sag, TermGroup::Tilt], OF_MOMENTS),
    (&[TermGroup::Ratio], OF_VALUES),
    (&[TermGroup::Harmonics], OF_VALUES),
    (&[TermGroup::Wobble], OF_VALUES),
    (&[TermGroup::Backlash], OF_VALUES),
    (&[TermGroup::Factors], OF_FACTORS),
    (&[TermGroup::Payload], OF_PAYLOADS),
    (&[TermGroup::Shift], OF_VALUES),
    (&[TermGroup::Runout], OF_LENGTHS),
];
