//! Result of planning.

use super::conditions::RefusalCounts;
use super::error_curve::{CurvePoint, ExpectedErrors};
use super::rows::PlannedRow;

/// A plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The rows in the order of measurement.
    pub rows: Vec<PlannedRow>,
    /// Expected errors of a fit of the planned rows.
    pub expected: ExpectedErrors,
    /// Median expected errors of as many random configurations.
    pub random: ExpectedErrors,
    /// Expected errors of fewer and more planned configurations, if they were requested.
    pub curve: Vec<CurvePoint>,
    /// Number of configurations from which 10 more gain less than 5 %.
    pub enough: Option<usize>,
    /// Number of unknowns of geometry.
    pub unknowns: usize,
    /// Number of components measured in a configuration.
    pub numbers: usize,
    /// True if the robot error is a guess: 0.3 mm for each metre of reach.
    pub robot_error_is_a_guess: bool,
    /// Logarithm of the determinant of geometry's information, to compare lists of one robot.
    pub log_determinant: f64,
    /// Conditions that candidates did not meet.
    pub refusals: RefusalCounts,
    /// Pairs of links whose shapes always overlap, which are not checked for collisions.
    pub left_out: Vec<(String, String)>,
    /// Joints without limits, which were taken within ±180° or ±0.5 m.
    pub without_limits: Vec<String>,
    /// Joints whose limits span more than a turn, which were taken within one.
    pub beyond_a_turn: Vec<String>,
    /// Length of the path from row to row: sum of the largest turn of a joint, radians (for a sliding joint, over the length that a radian counts).
    pub travel_rad: f64,
}
