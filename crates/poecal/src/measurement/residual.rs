//! The contract of every measurement type: residual, and sensitivity of the prediction.

use nalgebra::{Matrix3, Vector3};

use crate::lie::{Pose, TargetTwist};

/// Standard deviations by which a residual is whitened: theory.md §4 (17).
///
/// ```
/// let noise = poecal::measurement::Noise { position_m: 5e-5, rotation_rad: 1e-4 };
/// assert_eq!(noise.position_m, 5e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Of each position component, metres.
    pub position_m: f64,
    /// Of each rotation component, radians.
    pub rotation_rad: f64,
}

/// Interface of a measurement type: residual `e = measured ⊖ predicted`, and sensitivity S of the *prediction*, which moves by `S · twist`
/// under a target twist (theory.md §4 (14) to (17)).
pub trait Residual {
    /// Number of residual rows.
    fn dim(&self) -> usize;

    /// Writes the whitened residual for the predicted `device_from_target` into `out[..dim]`.
    fn residual(&self, predicted: &Pose, noise: &Noise, out: &mut [f64]);

    /// Writes the whitened sensitivity of the prediction to each column twist: `out[row * stride + column]`, for `dim` rows.
    fn project(
        &self,
        predicted: &Pose,
        columns: &[TargetTwist],
        noise: &Noise,
        stride: usize,
        out: &mut [f64],
    );

    /// The whitened residual as force and torque on the target: `f` and `τ` such that `f·v + τ·ω` is the descent of `½ |e|²` along a
    /// target twist `(v; ω)`, to first order in the residual, and its second derivative is that of the target's place and turn
    /// (theory.md §6 (31a)).
    /// `None` where that does not hold: the solver then does not use the full Hessian.
    fn wrench(&self, predicted: &Pose, noise: &Noise) -> Option<(Vector3<f64>, Vector3<f64>)>;

    /// First residual row that does not depend on the linear part of a target twist. From it on, rows are zero in columns that only
    /// translate the target, and the accumulation skips them. `dim` if there is none.
    fn rotation_row(&self) -> usize;

    /// Measured position, metres, device frame.
    fn position(&self) -> Vector3<f64>;

    /// Measured `device_from_target` rotation, if any.
    fn orientation(&self) -> Option<Matrix3<f64>>;
}
