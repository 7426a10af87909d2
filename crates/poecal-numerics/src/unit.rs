//! Units of unknowns and of measured numbers.

/// SI unit of a number, with the one used in messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Metres; shown in millimetres.
    Metre,
    /// Radians; shown in degrees.
    Radian,
    /// A number without unit.
    One,
    /// Seconds; shown in milliseconds.
    Second,
}

impl Unit {
    /// A number in the unit of messages.
    #[must_use]
    pub fn in_shown_unit(self, si: f64) -> f64 {
        match self {
            Unit::Metre | Unit::Second => si * 1e3,
            Unit::Radian => si.to_degrees(),
            Unit::One => si,
        }
    }

    /// SI number of one in the unit of messages.
    #[must_use]
    pub fn from_shown(self, shown: f64) -> f64 {
        match self {
            Unit::Metre | Unit::Second => shown * 1e-3,
            Unit::Radian => shown.to_radians(),
            Unit::One => shown,
        }
    }

    /// Symbol of the unit of messages: `mm`, `deg`, `ms`, or nothing.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::Metre => "mm",
            Unit::Radian => "deg",
            Unit::One => "",
            Unit::Second => "ms",
        }
    }

    /// Metres of a number, if a radian counts `length_m` metres. So does a number without unit, which is by radians, and a second: a
    /// joint turns by a radian in it.
    #[must_use]
    pub fn metres(self, length_m: f64) -> f64 {
        match self {
            Unit::Metre => 1.0,
            Unit::Radian | Unit::One | Unit::Second => length_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metres_are_shown_in_millimetres_and_radians_in_degrees() {
        for (unit, si, shown, symbol) in [
            (Unit::Metre, 0.002, 2.0, "mm"),
            (Unit::Radian, std::f64::consts::PI, 180.0, "deg"),
            (Unit::One, 0.3, 0.3, ""),
        ] {
            assert_eq!((unit.in_shown_unit(si), unit.from_shown(shown), unit.symbol()), (shown, si, symbol));
        }
    }
}
