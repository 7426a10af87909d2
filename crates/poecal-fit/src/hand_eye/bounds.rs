//! Bounds of a frame: distance and angle within which the true frame is with 95 % probability.

use nalgebra::{DMatrix, Matrix3, SMatrix, Vector3};

use super::equations::{FramePair, UNKNOWNS};
use super::noise::{FrameCovariance, PoseNoise};
use poecal_arm::lie::{Pose, hat};
use poecal_numerics::distributions::f_quantile;

/// Probability outside the bounds.
const OUTSIDE: f64 = 0.05;

/// A frame with its uncertainty.
///
/// ```
/// # use poecal_fit::hand_eye::FrameEstimate;
/// # use poecal_arm::lie::Pose;
/// let placed = FrameEstimate { pose: Pose::identity(), ..FrameEstimate::default() };
/// assert_eq!(placed.bound95_m, 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameEstimate {
    /// Pose in its parent.
    pub pose: Pose,
    /// Distance of its origin from the true one that 95 % of such results do not exceed, metres.
    pub bound95_m: f64,
    /// Angle between its axes and the true ones that 95 % of such results do not exceed, radians.
    pub bound95_rad: f64,
    /// Standard deviations of its position along the parent's axes, metres.
    pub sigma_m: Vector3<f64>,
    /// Standard deviations of its orientation about the parent's axes, radians.
    pub sigma_rad: Vector3<f64>,
}

impl Default for FrameEstimate {
    fn default() -> Self {
        let none = Vector3::zeros();
        FrameEstimate { pose: Pose::identity(), bound95_m: 0.0, bound95_rad: 0.0, sigma_m: none, sigma_rad: none }
    }
}

/// One of the two frames, in its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrameSide {
    /// The outer frame, inverted: the camera in its parent.
    Camera,
    /// The inner frame: the target in its parent.
    Target,
}

type FrameJacobian = SMatrix<f64, 6, 12>;

/// The frame of a side, and the linear map from a step of the unknowns to its shift and turn in its parent. The frames are those of
/// `point` of the target.
pub(crate) fn frame_of_side(frames: &FramePair, point: &Vector3<f64>, side: FrameSide) -> (Pose, FrameJacobian) {
    let mut map = FrameJacobian::zeros();
    match side {
        FrameSide::Camera => {
            let pose = frames.outer.inverse();
            let turn = -pose.rotation;
            map.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
            map.fixed_view_mut::<3, 3>(0, 3).copy_from(&(turn * hat(&frames.outer.translation)));
            map.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
            (pose, map)
        }
        FrameSide::Target => {
            let turn = frames.inner.rotation;
            map.fixed_view_mut::<3, 3>(0, 6).copy_from(&Matrix3::identity());
            map.fixed_view_mut::<3, 3>(0, 9).copy_from(&(turn * hat(point)));
            map.fixed_view_mut::<3, 3>(3, 9).copy_from(&turn);
            (frames.inner * Pose::from_translation(-point), map)
        }
    }
}

/// The frame of a side with its bounds, from the rows of its fit.
pub(crate) fn bound_frame(
    spread: &FrameCovariance,
    frames: &FramePair,
    point: &Vector3<f64>,
    side: FrameSide,
) -> FrameEstimate {
    let (pose, map) = frame_of_side(frames, point, side);
    let all = map_covariance(&map, &spread.covariance);
    let parts: Vec<(SMatrix<f64, 6, 6>, f64)> =
        spread.by_part.iter().map(|(part, freedom)| (map_covariance(&map, part), *freedom)).collect();
    let of = |at: usize| {
        let block = |of: &SMatrix<f64, 6, 6>| of.fixed_view::<3, 3>(at, at).into_owned();
        let by_part: Vec<(f64, f64)> = parts.iter().map(|(part, freedom)| (block(part).trace(), *freedom)).collect();
        (length_within(&block(&all), &by_part), block(&all).diagonal().map(|it| it.max(0.0).sqrt()))
    };
    let ((bound95_m, sigma_m), (bound95_rad, sigma_rad)) = (of(0), of(3));
    FrameEstimate { pose, bound95_m, bound95_rad, sigma_m, sigma_rad }
}

/// `M C Mᵀ`.
pub(crate) fn map_covariance(map: &FrameJacobian, covariance: &[f64]) -> SMatrix<f64, 6, 6> {
    let covariance = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_row_slice(covariance);
    map * covariance * map.transpose()
}

/// Length that 95 % of vectors of this covariance do not exceed, whose variances are known with the degrees of freedom of their parts.
/// The sum of squares is approximated by one of fewer squares with the same mean and variance (satterthwaite1946).
pub(crate) fn length_within(covariance: &Matrix3<f64>, parts: &[(f64, f64)]) -> f64 {
    let trace = covariance.trace();
    if trace <= 0.0 || !trace.is_finite() {
        return 0.0;
    }
    let squares = trace * trace / (covariance * covariance).trace();
    let uncertain: f64 = parts.iter().map(|(share, freedom)| (share / trace).powi(2) / freedom).sum();
    let freedom = (1.0 / uncertain.max(1e-6)).max(1.0);
    (trace * f_quantile(OUTSIDE, squares, freedom)).sqrt()
}

/// Ratio by which frames of two fits differ; above 1 they differ by more than noise. It is their squared distance, in units of its own
/// standard deviation, over the value that chance exceeds with a probability. One side alone is compared.
pub(crate) fn difference(
    one: (&FramePair, &Vector3<f64>, &FrameCovariance, &PoseNoise),
    other: (&FramePair, &Vector3<f64>, &FrameCovariance, &PoseNoise),
    side: FrameSide,
    probability: f64,
) -> Option<f64> {
    let (first, map) = frame_of_side(one.0, one.1, side);
    let (second, second_map) = frame_of_side(other.0, other.1, side);
    let turn = poecal_arm::lie::rotation::log(&(second.rotation * first.rotation.transpose()));
    let shift = second.translation - first.translation;
    let both = map_covariance(&map, &one.2.covariance) + map_covariance(&second_map, &other.2.covariance);
    let step = nalgebra::DVector::from_iterator(6, shift.iter().chain(turn.iter()).copied());
    let matrix = DMatrix::from_fn(6, 6, |i, j| both[(i, j)]);
    let squares = step.dot(&poecal_numerics::linalg::solve_symmetric(matrix, &step)?) / 6.0;
    let least = |noise: &PoseNoise| noise.freedom.iter().copied().fold(f64::INFINITY, f64::min);
    let freedom = least(one.3).min(least(other.3)).clamp(1.0, 1e6);
    Some(squares / f_quantile(probability, 6.0, freedom))
}
