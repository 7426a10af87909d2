//! Measurements while the robot moved: rates of the readings, and times.

use serde::{Deserialize, Serialize};

/// Clock of an instrument relative to that of the joint readings, with which readings of rows in motion were computed. A measurement at the
/// time t of its instrument belongs to the readings at `t - l - d (t - m)`. Here l is the lag, d the drift, and m the middle of all such rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// The instrument: index into [`Dataset::stations`](crate::measurement::Dataset::stations).
    pub station: usize,
    /// Time of the instrument less that of the readings in the middle, seconds.
    pub lag_s: f64,
    /// Growth of the lag, seconds each second.
    pub drift: f64,
    /// The middle of all rows in motion by the clock of the instrument, seconds.
    pub middle_s: f64,
}

/// Rows that were measured while the robot moved.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MovingRows {
    /// Rate of each reading, rad/s or m/s: those of one row after the other.
    pub rates: Vec<f64>,
    /// Time of each row from the middle of all, by the clock of its instrument, seconds.
    pub times_s: Vec<f64>,
    /// The clocks of their instruments.
    pub clocks: Vec<Clock>,
}

impl MovingRows {
    /// The clock of an instrument, if rows of it were measured in motion.
    #[must_use]
    pub fn clock(&self, station: usize) -> Option<&Clock> {
        self.clocks.iter().find(|it| it.station == station)
    }

    /// Adds the rows of another data set, whose instruments have other indices here.
    pub(crate) fn extend(&mut self, other: &MovingRows, station_of: impl Fn(usize) -> usize) {
        self.rates.extend_from_slice(&other.rates);
        self.times_s.extend_from_slice(&other.times_s);
        for clock in &other.clocks {
            let station = station_of(clock.station);
            if self.clock(station).is_none() {
                self.clocks.push(Clock { station, ..*clock });
            }
        }
    }
}
