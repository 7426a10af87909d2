//! The part of each residual along the motion of a joint.

use nalgebra::Vector3;

use crate::page::data::round_for_picture;
use crate::page::frames::{FrameData, PageFrames};
use crate::page::{reading_index, unit};
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Device, Quantity};
use poecal_model::robot::{Body, Joint, Robot};
use poecal_numerics::error::Result;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::residuals::{ResidualRow, Residuals};

/// Least motion that has a direction, metres per unit of a reading: a point on a joint's axis has none.
const STILL: f64 = 1e-3;

/// A target or an instrument on its body.
struct MountedFrame {
    body: Body,
    pose: Pose,
    /// The joints that move it.
    joints: Vec<bool>,
    is_pair: bool,
}

/// A robot in the configurations of the rows.
pub(crate) struct RobotMotions<'a> {
    residuals: &'a Residuals,
    robot: Robot,
    targets: Vec<MountedFrame>,
    instruments: Vec<MountedFrame>,
    /// The column of each joint's reading.
    columns: Vec<usize>,
}

impl<'a> RobotMotions<'a> {
    pub(crate) fn new(file: &CalibrationFile, residuals: &'a Residuals) -> Result<Self> {
        let robot = file.robot()?;
        let frames = PageFrames::from_calibration(file, &robot, residuals)?;
        let mounted = |frame: &FrameData<'_>| {
            let body = frame.on.map_or(Body::Base, Body::Link);
            let path = robot.joints_to(body);
            let joints = (0..robot.joints.len()).map(|joint| path.contains(&joint)).collect();
            let is_pair = frame.kind == Some(Device::Pair.word());
            Ok(MountedFrame { body, pose: frame.pose.pose()?, joints, is_pair })
        };
        let all = |frames: &[FrameData<'_>]| frames.iter().map(mounted).collect::<Result<Vec<_>>>();
        let (targets, instruments) = (all(&frames.targets)?, all(&frames.instruments)?);
        let column = |joint: &Joint| reading_index(residuals, &joint.reading.name).unwrap_or_default();
        let columns = robot.joints.iter().map(column).collect();
        Ok(RobotMotions { residuals, targets, instruments, columns, robot })
    }

    /// The part of a row's residual along the motion of its target with each reading, millimetres: of vectors alone, and `None` if the target does
    /// not move relative to the instrument.
    pub(crate) fn residual_along_motions(&self, index: usize) -> Vec<Option<f64>> {
        let mut motion = vec![Vector3::zeros(); self.residuals.readings.len()];
        let residual = self.residuals.rows().get(index).and_then(|row| self.add_motions(index, row, &mut motion));
        let part = |motion: &Vector3<f64>| {
            let length = motion.norm();
            residual.filter(|_| length > STILL).map(|residual| residual.dot(motion) / length)
        };
        motion.iter().map(part).collect()
    }

    /// Adds the motion of a row's target with each reading, and returns its residual, both in the base frame. `None` for residuals that are no
    /// vectors, or whose axes are those of another configuration.
    fn add_motions(&self, index: usize, row: &ResidualRow, motion: &mut [Vector3<f64>]) -> Option<Vector3<f64>> {
        let residual = vector_of(row)?;
        let (target, instrument) = (self.targets.get(row.target)?, self.instruments.get(row.station)?);
        if instrument.is_pair {
            return None;
        }
        let bodies = self.bodies(self.residuals.values(index));
        let motion_of = |body: Body| body.joint().and_then(|at| bodies.get(at)).copied().unwrap_or_else(Pose::identity);
        let place = (motion_of(target.body) * target.pose).translation;
        for (k, joint) in self.robot.joints.iter().enumerate() {
            // A joint that moves both moves neither relative to the other.
            let [own, other] = [target, instrument].map(|it| it.joints.get(k) == Some(&true));
            let sign = f64::from(i8::from(own) - i8::from(other));
            let before = motion_of(self.robot.body_before(k));
            let velocity = joint.screw.v() + joint.screw.w().cross(&before.inverse().act(&place));
            if let Some(motion) = self.columns.get(k).and_then(|at| motion.get_mut(*at)) {
                *motion += before.rotation * velocity * (sign * joint.reading.multiplier);
            }
        }
        Some((motion_of(instrument.body) * instrument.pose).rotation * residual)
    }

    /// The motion of each joint's link from its pose at zero. Joint effects beyond geometry are too small to turn a direction.
    fn bodies(&self, values: &[f64]) -> Vec<Pose> {
        let mut bodies: Vec<Pose> = Vec::with_capacity(self.robot.joints.len());
        for (k, joint) in self.robot.joints.iter().enumerate() {
            let value = self.columns.get(k).and_then(|at| Some((values.get(*at)?, self.residuals.readings.get(*at)?)));
            let factor = |kind| if unit(kind) == Some("mm") { 1e-3 } else { 1f64.to_radians() };
            let reading = value.map_or(0.0, |(value, (_, kind))| round_for_picture(*value) * factor(*kind));
            let before = self.robot.body_before(k).joint().and_then(|at| bodies.get(at)).copied();
            bodies.push(before.unwrap_or_else(Pose::identity) * joint.screw.exp(joint.reading.value(reading)));
        }
        bodies
    }
}

/// The residual of a row that is a vector, in the axes of its instrument, millimetres.
fn vector_of(row: &ResidualRow) -> Option<Vector3<f64>> {
    let whole = |quantity| match row.errors.get(quantity)?.residual() {
        &[x, y, z] if !(x + y + z).is_nan() => Some(Vector3::new(x, y, z).map(round_for_picture)),
        _ => None,
    };
    [Quantity::Position, Quantity::Contact].into_iter().find_map(whole)
}
