//! Base and tip of a corrected model in those of the calibrated one. Both are a choice unless they were measured, and both models of a session make
//! the same (theory.md §8 (38f)).

use nalgebra::Vector3;

use crate::run::calibrated_places::{UnmeasuredTip, place_tip};
use poecal_arm::lie::Pose;
use poecal_fit::state::{Estimate, InstrumentMount, Session, sample_rows};
use poecal_model::offsets::TaughtFrames;
use poecal_model::robot::{Body, Robot};

/// Pairs of points that decide, and the fewest configurations.
const POINTS: usize = 3000;
const FEWEST: usize = 100;
/// Weight of a radian of the tip in metres: rotations decide what positions leave undetermined.
const RADIAN_M: f64 = 0.01;

/// A model of a session: the nominal robot of its kind, with the fitted estimate.
#[derive(Clone, Copy)]
pub(crate) struct SessionModel<'a> {
    pub(crate) session: Session<'a>,
    pub(crate) estimate: &'a Estimate,
}

impl SessionModel<'_> {
    /// Body and position (base frame, zero joint values) of everything measured or measuring that the robot moves.
    fn moving_bodies(&self) -> Vec<(Body, Vector3<f64>)> {
        let Estimate { tree, base_from_target, .. } = self.estimate;
        let targets = tree.targets().iter().zip(base_from_target).map(|(body, pose)| (*body, pose.translation));
        let instruments = tree.instruments().iter().enumerate().filter_map(|(station, stand)| match stand {
            InstrumentMount::On(body) => Some((*body, self.estimate.device_at_zero(station).inverse().translation)),
            InstrumentMount::Target(_) => None,
        });
        targets.chain(instruments).filter(|(body, _)| body.joint().is_some()).collect()
    }

    /// The robot with its tip as measured, or else as in the nominal model.
    fn robot(&self, frames: &[bool], move_tip: bool) -> Robot {
        let Session { robot, data, .. } = self.session;
        place_tip(robot, data, frames, self.estimate, move_tip, UnmeasuredTip::Nominal).0
    }
}

/// Motion of the base that brings a model's predictions in the base frame nearest to the calibrated model's, by least squares over all measured
/// points and the tip; none if the base is known. Also returns the model's `base_from_tip` at zero, with that base and the best tool.
pub(crate) fn frames([model, calibrated]: [SessionModel<'_>; 2], rows: &[u32], move_tip: bool) -> (Pose, Pose) {
    let data = calibrated.session.data;
    let frames = data.frames(rows);
    let both = [model, calibrated].map(|it| (it.robot(&frames, move_tip), it.moving_bodies()));
    let rows = sample_rows(rows, (POINTS / both[0].1.len().max(1)).max(FEWEST));
    let (mut tips, mut points) = (Vec::with_capacity(rows.len()), Vec::new());
    for row in rows {
        let seen = both.each_ref().map(|(robot, moving)| {
            let values = robot.joint_values(data.readings(row as usize));
            let places: Vec<Vector3<f64>> =
                moving.iter().map(|(body, place)| robot.motion_of(*body, &values).act(place)).collect();
            (robot.motion(&values) * robot.home, places)
        });
        let [(tip, places), (other_tip, other_places)] = seen;
        tips.push((tip, other_tip));
        points.extend(places.into_iter().zip(other_places));
    }
    let taught = TaughtFrames::with_points(&tips, &points, RADIAN_M, !calibrated.session.base_free());
    (taught.base, taught.tip(&both[0].0.home))
}
