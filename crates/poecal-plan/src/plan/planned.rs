//! A plan that was made.

use super::conditions::Refusals;
use super::expected::{CurvePoint, ExpectedErrors};
use super::rows::PlannedRow;

/// A plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The rows in the order in which to measure them.
    pub rows: Vec<PlannedRow>,
    /// Expected errors of a fit of the planned rows.
    pub expected: ExpectedErrors,
    /// Median expected errors of as many random configurations.
    pub random: ExpectedErrors,
    /// Expected errors of fewer and more planned configurations, where they were wanted.
    pub curve: Vec<CurvePoint>,
    /// Number of configurations from which 10 more gain less than 5 %.
    pub enough: Option<usize>,
    /// Unknowns of geometry, and numbers that a configuration gives.
    pub unknowns: usize,
    /// Numbers that a configuration gives.
    pub numbers: usize,
    /// Whether the robot error is a guess: 0.3 mm for each metre of reach.
    pub robot_error_is_a_guess: bool,
    /// Logarithm of the determinant of geometry's information, to compare lists of one robot.
    pub log_determinant: f64,
    /// Conditions that candidates did not fulfil.
    pub refusals: Refusals,
    /// Pairs of links whose shapes always overlap, for which collisions are not looked.
    pub left_out: Vec<(String, String)>,
    /// Joints without limits, which were taken within ±180° or ±0.5 m.
    pub without_limits: Vec<String>,
    /// Joints whose limits span more than a turn, which were taken within one.
    pub beyond_a_turn: Vec<String>,
    /// The way from row to row: sum of the largest turn of a joint, radians (of one that slides, over the length that a radian counts).
    pub travel_rad: f64,
}
