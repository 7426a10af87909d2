//! Pose of a board that fits its corners best, with the information of the corners on it (theory.md §4, *Pictures*).

use nalgebra::{Matrix2x3, Matrix2x6, Matrix3, Matrix6, Vector2, Vector3, Vector6};

use super::lens::LENS_NUMBERS;
use super::{Board, Corner, Lens, Picture, dimensions};
use poecal_arm::lie::{Pose, hat, rotation};
use poecal_numerics::linalg;

/// Number of standard deviations beyond which a corner has no weight.
const FAR: f64 = 6.0;
/// Median length of a vector of two normal numbers.
const MEDIAN: f64 = 1.177_410;
/// Fewest corners of which some may lose their weight: with fewer, any corner bends the pose to itself.
const JUDGEABLE: usize = 8;
/// Multiple of their noise from which on corners count as other points.
const ODD: f64 = 4.0;
/// Largest number of steps.
const STEPS: usize = 40;

/// A board in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    /// Pose of the board in the camera's frame.
    pub camera_from_board: Pose,
    /// Information of that pose, `Σ wJᵀJ/σ²`, of shifts (m) of the board's origin and turns (rad) about it in the camera's axes.
    pub information: Matrix6<f64>,
    /// Weights of the corners.
    pub weights: Vec<f64>,
    /// Weighted sum of squares of the residuals, in standard deviations.
    pub cost: f64,
    /// The same sum in square pixels.
    pub cost_px2: f64,
    /// Degrees of freedom: two a corner, by weight, less the six of the pose.
    pub freedom: f64,
}

/// Input of a sighting.
#[derive(Clone, Copy)]
pub struct SightingInput<'a> {
    /// The lens.
    pub lens: &'a Lens,
    /// The board.
    pub board: &'a Board,
    /// The corners.
    pub corners: &'a [Corner],
    /// Standard deviation of corners that state none, pixels.
    pub sigma_px: f64,
}

/// Residual of a corner with its derivatives, in standard deviations.
pub(crate) struct CornerResidual {
    pub(crate) error: Vector2<f64>,
    pub(crate) by_motion: Matrix2x6<f64>,
    /// Derivative by a motion of the point in the camera's frame, and by the numbers of the lens.
    pub(crate) by_point: Matrix2x3<f64>,
    pub(crate) by_lens: [[f64; LENS_NUMBERS]; 2],
}

impl<'a> SightingInput<'a> {
    /// View of a picture.
    #[must_use]
    pub fn new(picture: &'a Picture, lens: &'a Lens, board: &'a Board, sigma_px: f64) -> Self {
        SightingInput { lens, board, corners: &picture.corners, sigma_px }
    }

    /// Predicted pixel of a corner.
    #[must_use]
    pub fn project_corner(&self, corner: &Corner, camera_from_board: &Pose) -> Option<Vector2<f64>> {
        self.lens.pixel(&camera_from_board.act(self.board.points.get(corner.point as usize)?))
    }

    /// Measured minus predicted pixel of each corner; `None` if it would not be in the picture.
    #[must_use]
    pub fn errors(&self, camera_from_board: &Pose) -> Vec<Option<Vector2<f64>>> {
        let error = |corner: &Corner| Some(corner.pixel - self.project_corner(corner, camera_from_board)?);
        self.corners.iter().map(error).collect()
    }

    fn sigma(&self, corner: &Corner) -> f64 {
        corner.sigma_px.unwrap_or(self.sigma_px)
    }

    /// Points of the corners with their rays.
    #[must_use]
    pub fn rays(&self) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let of =
            |corner: &Corner| Some((*self.board.points.get(corner.point as usize)?, self.lens.ray(&corner.pixel)?));
        self.corners.iter().filter_map(of).collect()
    }

    /// Dimensions of the points that were seen.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        let points: Vec<Vector3<f64>> = self.rays().iter().map(|(point, _)| *point).collect();
        dimensions(&points)
    }

    /// Residual and derivative of a corner, in standard deviations; `q = R P + p` moves by `δ + ω × R P`.
    pub(crate) fn corner_residual(&self, corner: &Corner, pose: &Pose) -> Option<CornerResidual> {
        let point = self.board.points.get(corner.point as usize)?;
        let arm = pose.rotation * point;
        let found = self.lens.projection(&(arm + pose.translation))?;
        let weight = 1.0 / self.sigma(corner);
        let mut by_motion = Matrix2x6::zeros();
        by_motion.fixed_view_mut::<2, 3>(0, 0).copy_from(&(found.by_point * weight));
        by_motion.fixed_view_mut::<2, 3>(0, 3).copy_from(&(found.by_point * hat(&arm) * -weight));
        Some(CornerResidual {
            error: (corner.pixel - found.pixel) * weight,
            by_motion,
            by_point: found.by_point * weight,
            by_lens: found.by_lens.map(|row| row.map(|value| value * weight)),
        })
    }

    /// Weights by the residuals of corners at a pose.
    fn weights(&self, pose: &Pose) -> Vec<f64> {
        let lengths: Vec<Option<f64>> = self
            .corners
            .iter()
            .zip(self.errors(pose))
            .map(|(corner, error)| Some(error?.norm() / self.sigma(corner)))
            .collect();
        let mut known: Vec<f64> = lengths.iter().flatten().copied().collect();
        known.sort_unstable_by(f64::total_cmp);
        let scale = known.get(known.len() / 2).map_or(1.0, |median| (median / MEDIAN).max(1.0));
        let is_judged = known.len() >= JUDGEABLE;
        let weight = |length: &Option<f64>| match length {
            Some(length) if is_judged => (1.0 - (length / (FAR * scale)).powi(2)).max(0.0).powi(2),
            Some(_) => 1.0,
            None => 0.0,
        };
        lengths.iter().map(weight).collect()
    }

    /// Information, gradient and cost at a pose.
    fn sums(&self, pose: &Pose, weights: &[f64]) -> (Matrix6<f64>, Vector6<f64>, f64) {
        let mut sums = (Matrix6::zeros(), Vector6::zeros(), 0.0);
        for (corner, weight) in self.corners.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
            let Some(CornerResidual { error, by_motion, .. }) = self.corner_residual(corner, pose) else {
                // A corner that the camera could not see costs more than any that it sees.
                sums.2 += weight * UNSEEN * UNSEEN;
                continue;
            };
            sums.0 += by_motion.transpose() * by_motion * *weight;
            sums.1 += by_motion.transpose() * error * *weight;
            sums.2 += weight * error.norm_squared();
        }
        sums
    }

    /// Information of a pose by corners with their current weights.
    #[must_use]
    pub fn information(&self, pose: &Pose) -> Matrix6<f64> {
        let weights: Vec<f64> = self.corners.iter().map(|corner| corner.weight).collect();
        self.sums(pose, &weights).0
    }

    /// True if the residuals at a pose exceed the noise of corners so much that one of them is another point.
    #[must_use]
    pub fn is_odd(&self, pose: &Pose) -> bool {
        let weights: Vec<f64> = self.corners.iter().map(|corner| corner.weight).collect();
        let freedom = 2.0 * weights.iter().sum::<f64>() - 6.0;
        self.sums(pose, &weights).2 > ODD * ODD * freedom.max(1.0)
    }

    /// Nearest pose to a start that fits the corners best; `robust` reduces the weight of corners that do not fit the others. `None` if too
    /// few corners can be seen.
    #[must_use]
    pub fn sighting(&self, start: &Pose, robust: bool) -> Option<Sighting> {
        let mut pose = *start;
        let mut weights = vec![1.0; self.corners.len()];
        for _ in 0..if robust { ROUNDS } else { 1 } {
            pose = self.refine_pose(pose, &weights)?;
            if !robust {
                break;
            }
            let new = self.weights(&pose);
            let change = weights.iter().zip(&new).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            weights = new;
            if change < 1e-3 {
                break;
            }
        }
        let (information, _, cost) = self.sums(&pose, &weights);
        Some(self.sighting_at(pose, information, cost, weights))
    }

    /// Sighting near a pose, to first order, although the best pose of the corners is another one: a flat board that is tilted in the
    /// opposite direction looks almost the same.
    #[must_use]
    pub fn sighting_near(&self, pose: &Pose) -> Option<Sighting> {
        let weights = self.weights(pose);
        let (information, gradient, _) = self.sums(pose, &weights);
        let mut step = linalg::cholesky_6(information)?.solve(&gradient);
        let turn = step.fixed_rows::<3>(3).norm();
        if turn > MOST_TURN {
            step *= MOST_TURN / turn;
        }
        let next = move_pose(pose, &step);
        let (_, _, cost) = self.sums(&next, &weights);
        Some(self.sighting_at(next, information, cost, weights))
    }

    fn sighting_at(&self, pose: Pose, information: Matrix6<f64>, cost: f64, weights: Vec<f64>) -> Sighting {
        let errors = self.errors(&pose);
        let squares =
            errors.iter().zip(&weights).map(|(error, weight)| weight * error.map_or(0.0, |it| it.norm_squared()));
        Sighting {
            camera_from_board: pose,
            information,
            cost,
            cost_px2: squares.sum(),
            freedom: 2.0 * weights.iter().sum::<f64>() - 6.0,
            weights,
        }
    }

    /// Levenberg-Marquardt on the pose.
    fn refine_pose(&self, start: Pose, weights: &[f64]) -> Option<Pose> {
        let mut pose = start;
        let mut now = self.sums(&pose, weights);
        let mut damping = 1e-6;
        for _ in 0..STEPS {
            let (information, gradient, cost) = now;
            let mut damped = information;
            for k in 0..6 {
                damped[(k, k)] *= 1.0 + damping;
                damped[(k, k)] += f64::MIN_POSITIVE;
            }
            let step = linalg::cholesky_6(damped).map(|factor| factor.solve(&gradient));
            let Some(step) = step.filter(|step| step.iter().all(|it| it.is_finite())) else { break };
            let next = move_pose(&pose, &step);
            let found = self.sums(&next, weights);
            if found.2 < cost {
                (pose, now, damping) = (next, found, damping * 0.1);
                // The remaining gain is below a millionth of a standard deviation.
                if gradient.dot(&step) < 1e-12 {
                    break;
                }
            } else if gradient.dot(&step) < 1e-12 * (1.0 + cost) || damping > 1e12 {
                break;
            } else {
                damping = (damping * 10.0).max(1e-6);
            }
        }
        let errors = self.errors(&pose);
        let seen = errors.iter().zip(weights).filter(|(error, weight)| **weight > 0.0 && error.is_some());
        (seen.count() >= 3).then_some(pose)
    }
}

/// Largest turn of a step to first order, rad.
const MOST_TURN: f64 = 0.1;
/// Residual of a corner that the camera cannot see, in standard deviations.
const UNSEEN: f64 = 1e4;
/// Largest number of rounds of weights.
const ROUNDS: usize = 15;

/// A pose after a shift of its origin and a rotation about it, in the axes of its parent frame.
#[must_use]
pub fn move_pose(pose: &Pose, step: &Vector6<f64>) -> Pose {
    let turn: Matrix3<f64> = rotation::exp(&Vector3::new(step[3], step[4], step[5]));
    Pose::new(turn * pose.rotation, pose.translation + Vector3::new(step[0], step[1], step[2]))
}
