//! Test whether poses of a camera are predicted better if the arm is fitted with the camera.

use crate::acceptance::AcceptedModel;
use crate::run::accuracy::ModelAccuracy;
use crate::run::options::CalibrationOptions;
use crate::steps::calibrate::calibrate;
use poecal_arm::lie::Pose;
use poecal_fit::hand_eye::{CameraMounting, HandEye, PoseList};
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// Errors of held-out poses, root mean square, by the arm of the model and by an arm that was fitted with the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmFitComparison {
    /// Number of these poses.
    pub rows: usize,
    /// Errors by the arm as it is: millimetres and degrees.
    pub held: (f64, f64),
    /// Errors by an arm whose axes were fitted too.
    pub fitted: (f64, f64),
}

impl ArmFitComparison {
    /// True if the fitted arm predicts these poses evidently better.
    #[must_use]
    pub fn is_better(&self) -> bool {
        const EVIDENT: f64 = 1.0 / 0.9;
        self.gain() > EVIDENT
    }

    /// Ratio of the position error of the arm as it is to that of the fitted arm.
    #[must_use]
    pub fn gain(&self) -> f64 {
        self.held.0 / self.fitted.0.max(f64::MIN_POSITIVE)
    }

    /// Reason why the frames are no better than within their bounds, if the arm's own errors dominate the residuals of the poses: these depend on the
    /// poses, while the bounds treat them as noise.
    #[must_use]
    pub fn weakens(&self) -> Option<String> {
        const MOST: f64 = 2.0;
        (self.gain() > MOST).then(|| {
            format!(
                "the arm's own errors are most of what remains: fitted with the camera it predicts other poses {:.1} times better ({:.2} mm instead of \
                 {:.2} mm, RMS)",
                self.gain(),
                self.fitted.0,
                self.held.0
            )
        })
    }
}

/// The session of a hand-eye calibration whose arm's poses are known by joint readings, in the form that `calibrate` reads. It has one configuration
/// after the other, of the rows that count. Each row is the pose of the object on the flange in the other frame.
///
/// # Errors
/// [`ErrorKind::Measurement`](poecal_numerics::error::ErrorKind::Measurement) if the readings are not those of the robot.
pub fn session_of(robot: &Robot, joints: &[f64], target: &PoseList, found: &HandEye) -> Result<Dataset> {
    let names = robot.reading_names();
    let width = names.len().max(1);
    let mut data = Dataset::new(names);
    let rows = joints.chunks_exact(width).zip(&target.poses).zip(&found.rows);
    for ((readings, pose), _) in rows.filter(|(_, row)| row.is_fitted) {
        let camera_from_target: Pose = if found.directions.target_inverted { pose.inverse() } else { *pose };
        let (name, measured) = match found.camera {
            CameraMounting::InHand => ("camera", camera_from_target.inverse()),
            CameraMounting::Beside => ("target", camera_from_target),
        };
        data.push(readings, Some(name), Measurement::of_pose(&measured))?;
    }
    Ok(data)
}

/// Errors of held-out poses of such a session with the arm as it is, and fitted too; `None` if no rows could be held out.
///
/// # Errors
/// Those of [`calibrate`], such as too few poses.
pub fn arm_too(robot: &Robot, data: &Dataset) -> Result<Option<ArmFitComparison>> {
    let found = calibrate(robot, data, &CalibrationOptions::default())?;
    let Some(errors) = found.accuracy.held_out else { return Ok(None) };
    let is_corrected = found.verdict.model == Some(AcceptedModel::Corrected);
    let delivered = errors.corrected.filter(|_| is_corrected).unwrap_or(errors.calibrated);
    let of = |model: &ModelAccuracy| (model.position_mm().rms, model.rotation_deg().map_or(0.0, |it| it.rms));
    Ok(Some(ArmFitComparison { rows: errors.count, held: of(&errors.registered), fitted: of(&delivered) }))
}
