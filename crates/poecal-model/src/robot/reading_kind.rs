//! Kinds of readings: the value of a joint, or another quantity that joints depend on.

use super::JointKind;

/// Kind of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadingKind {
    /// Revolute joint, radians.
    Angle,
    /// Prismatic joint, metres.
    Length,
    /// No joint ([`Robot::factors`](super::Robot)), in the unit of its column.
    Factor,
}

impl ReadingKind {
    /// All kinds.
    pub const ALL: [ReadingKind; 3] = [ReadingKind::Angle, ReadingKind::Length, ReadingKind::Factor];

    /// Symbol of the unit in messages; 1 for a factor.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            ReadingKind::Angle => "deg",
            ReadingKind::Length => "mm",
            ReadingKind::Factor => "1",
        }
    }

    /// Symbol behind a value; empty for a factor.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        if self == ReadingKind::Factor { "" } else { self.symbol() }
    }

    /// Value in that unit.
    #[must_use]
    pub fn in_shown_unit(self, value: f64) -> f64 {
        match self {
            ReadingKind::Angle => value.to_degrees(),
            ReadingKind::Length => 1e3 * value,
            ReadingKind::Factor => value,
        }
    }
}

impl From<JointKind> for ReadingKind {
    fn from(kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => ReadingKind::Angle,
            JointKind::Prismatic => ReadingKind::Length,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_shown_in_degrees_and_factors_as_they_are() {
        assert_eq!((ReadingKind::Angle.symbol(), ReadingKind::Angle.in_shown_unit(0.5f64.to_radians())), ("deg", 0.5));
        assert_eq!(ReadingKind::Factor.in_shown_unit(21.5), 21.5);
    }
}
