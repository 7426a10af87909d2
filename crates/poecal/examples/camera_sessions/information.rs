//! Cramér-Rao bound of predicted poses, from differences of the kinematics: no part of the calibration is used.

use nalgebra::{DMatrix, Matrix6, SMatrix, Vector6};
use poecal_arm::lie::Pose;
use poecal_model::camera::{CommonError, move_pose};
use poecal_model::measurement::deviation;
use poecal_model::robot::Robot;
use poecal_model::simulate::SimulatedPictures;

use crate::session::{PictureSession, places, register_deviations, true_pose, whitenings};

/// Step of the differences, rad and m.
const STEP: f64 = 1e-6;
/// Share of the largest eigenvalue below which a direction is another parameterisation of the same arm.
const SAME: f64 = 1e-9;

/// Motions of each axis, of the held object and of the fixed one, for the largest robot here.
const UNKNOWNS: usize = 6 * (6 + 2);
type Derivative = SMatrix<f64, 6, UNKNOWNS>;

/// Best information of a session's pictures about poses in the further configurations.
pub(crate) struct Information {
    covariance: DMatrix<f64>,
    derivatives: Vec<Derivative>,
}

impl Information {
    /// Information by the known noise of the corners, and a common error of those of a picture.
    pub(crate) fn from_session(session: &PictureSession, common: CommonError) -> Self {
        let PictureSession { made, data, others, .. } = session;
        let unknowns = 0..6 * (made.actual.joints.len() + 2);
        let changed: Vec<[SimulatedPictures; 2]> =
            unknowns.map(|unknown| [STEP, -STEP].map(|step| change_session(made, unknown, step))).collect();
        let mut information = DMatrix::<f64>::zeros(UNKNOWNS, UNKNOWNS);
        for (row, whitening) in whitenings(session, common).iter().enumerate() {
            let by = whitening * derivative(&changed, data.readings(row));
            information += by.transpose() * by;
        }
        let eigen = information.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let mut covariance = DMatrix::<f64>::zeros(UNKNOWNS, UNKNOWNS);
        for (k, value) in eigen.eigenvalues.iter().enumerate().filter(|(_, value)| **value > SAME * largest) {
            let vector = eigen.eigenvectors.column(k);
            covariance += vector * vector.transpose() / *value;
        }
        let derivatives = (0..others.len()).map(|row| derivative(&changed, others.readings(row))).collect();
        Information { covariance, derivatives }
    }

    /// Covariances of the poses.
    pub(crate) fn spreads(&self) -> Vec<Matrix6<f64>> {
        self.derivatives.iter().map(|by| by * &self.covariance * by.transpose()).collect()
    }

    /// Root mean squares of shift (m) and turn (rad): lower bound for any unbiased estimate.
    pub(crate) fn least_errors(&self) -> [f64; 2] {
        let spreads = self.spreads();
        let mean = |first: usize| {
            let squares = spreads.iter().map(|it| (first..first + 3).map(|k| it[(k, k)]).sum::<f64>());
            (squares.sum::<f64>() / spreads.len() as f64).sqrt()
        };
        [mean(0), mean(3)]
    }

    /// The information with the device's frame registered in the further configurations.
    pub(crate) fn with_registration(&self, session: &PictureSession) -> Self {
        let derivatives = register_deviations(&places(session), &self.derivatives);
        Information { covariance: self.covariance.clone(), derivatives }
    }
}

/// Derivative of the pose of the held object relative to the fixed one, by motions of each axis, of the held object and of the fixed one.
fn derivative(changed: &[[SimulatedPictures; 2]], readings: &[f64]) -> Derivative {
    let mut found = Derivative::zeros();
    for (unknown, sides) in changed.iter().enumerate() {
        let [more, less] = sides.each_ref().map(|side| true_pose(side, &side.actual, readings));
        found.set_column(unknown, &(deviation(&more, &less) / (2.0 * STEP)));
    }
    found
}

fn change_session(made: &SimulatedPictures, unknown: usize, step: f64) -> SimulatedPictures {
    let mut found = made.clone();
    let (part, k) = (unknown / 6, unknown % 6);
    let mut motion = Vector6::zeros();
    motion[k] = step;
    let joints = made.actual.joints.len();
    match part.checked_sub(joints) {
        None => found.actual = with_moved_axis(&made.actual, part, &motion),
        Some(0) => found.tip_from_held = move_pose(&made.tip_from_held, &motion),
        Some(_) => found.base_from_other = move_pose(&made.base_from_other, &motion),
    }
    found
}

/// The robot with an axis moved about its own point, and the tip unchanged.
fn with_moved_axis(robot: &Robot, joint: usize, motion: &Vector6<f64>) -> Robot {
    let mut found = robot.clone();
    let point = Pose::from_translation(robot.joints[joint].frame.translation);
    let about = move_pose(&point, motion) * point.inverse();
    found.joints[joint].screw = robot.joints[joint].screw.transform(&about);
    found
}
