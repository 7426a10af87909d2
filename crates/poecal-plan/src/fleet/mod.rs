//! A line of robots of one type: scatter of their corrections, the line's own part of it, outlying robots, and steps in time (theory.md §9, *A line
//! of robots*).
//!
//! No robots and no files here: the input is figures of robots with their deviations; `poecal-results`'s `fleet` has the station and the ledger.

mod capability;
mod outlying_robots;
mod series;
mod steps;

pub use capability::{Capability, Interval};
pub use outlying_robots::{OutlyingRobot, outliers};
pub use series::{FigureSeries, FigureSpread, FigureValue, typical_value};
pub use steps::{FigureStep, moving_average, steps};

/// Fewest robots from which spreads, capabilities and steps are stated.
pub const FEWEST: usize = 30;
