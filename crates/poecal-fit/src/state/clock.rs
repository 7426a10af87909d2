//! Lag and drift of an instrument's clock, beyond those with which the joint readings of its rows were computed.

/// Error of a clock beyond the one with which the readings were computed ([`Clock`](poecal_model::measurement::Clock)). The readings of a row at the
/// time t from the middle of all change by `-(l + d t)` times their rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClockChange {
    /// Change of the lag l, seconds.
    pub lag_s: f64,
    /// Change of the drift d, seconds each second.
    pub drift: f64,
}

/// One of the two, as an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ClockTerm {
    /// Lag, seconds.
    Lag,
    /// Drift, seconds each second.
    Drift,
}

impl ClockTerm {
    /// Both terms.
    pub const ALL: [ClockTerm; 2] = [ClockTerm::Lag, ClockTerm::Drift];

    /// Standard deviation of a clock's drift against another, its prior: 50 ppm, as of plain quartz.
    pub const DRIFT_DEVIATION: f64 = 5e-5;

    /// Name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ClockTerm::Lag => "lag",
            ClockTerm::Drift => "drift",
        }
    }

    /// Change of a reading for each unit of the term, over its rate, at a time from the middle, seconds.
    #[must_use]
    pub(crate) fn factor(self, time_s: f64) -> f64 {
        match self {
            ClockTerm::Lag => -1.0,
            ClockTerm::Drift => -time_s,
        }
    }
}

impl ClockChange {
    /// True if the clock has no error.
    pub(crate) fn is_none(&self) -> bool {
        *self == ClockChange::default()
    }

    /// Value of a term.
    #[must_use]
    pub fn term(&self, term: ClockTerm) -> f64 {
        match term {
            ClockTerm::Lag => self.lag_s,
            ClockTerm::Drift => self.drift,
        }
    }

    /// Change of a reading, over its rate, at a time from the middle, seconds.
    pub(crate) fn shift(&self, time_s: f64) -> f64 {
        -(self.lag_s + self.drift * time_s)
    }
}
