//! Targets, instruments and tip at their calibrated poses.

use poecal_arm::lie::Pose;
use poecal_fit::state::{Estimate, RangeModel, Session};
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::{MEASURED, Mount, Robot};

/// A target as calibrated.
///
/// ```
/// # use poecal_calibrate::CalibrationOptions;
/// # use poecal_model::measurement::SessionKind;
/// # use poecal_model::simulate::{Simulation, elbow};
/// # use poecal_calibrate::calibrate;
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let [measured] = &calibration.targets[..] else { unreachable!() };
/// assert!(measured.name.as_deref() == Some("measured") && measured.is_frame);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedTarget {
    /// Name; `None` is the tip itself ([`CalibrationOptions::move_tip`](crate::CalibrationOptions::move_tip)).
    pub name: Option<String>,
    /// True if its orientation was measured; otherwise only the position is meaningful.
    pub is_frame: bool,
    /// `tip_from_target` in the calibrated robot; for a target of its `mounted`, which is on a body of its own, at zero joint values.
    pub tip_from_target: Pose,
}

/// A station of the device, as calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedStation {
    /// Name, if the measurements name it.
    pub name: Option<String>,
    /// `base_from_device` of the station; for an instrument on the robot, at zero joint values.
    pub base_from_device: Pose,
    /// Noise of its rows that state none.
    pub noise: Noise,
    /// Zero and scale of its distances.
    pub range: RangeModel,
    /// Kind of the station: an instrument, an anchor, a socket, a plane, a sphere, a direction, a pair of configurations.
    pub kind: &'static str,
    /// Radius of a sphere with that of the probe, known or fitted, metres.
    pub radius_m: Option<f64>,
}

/// The stations of the device.
pub(crate) fn stations(session: &Session<'_>, estimate: &Estimate, noise: Noise) -> Vec<CalibratedStation> {
    let data = session.data;
    let of = |station| CalibratedStation {
        noise: session.usual_noise(station, noise),
        range: estimate.range(station),
        kind: data.station_word(station),
        radius_m: data.sphere_reading(station).map(|reading| reading - estimate.range(station).zero_m),
        name: data.stations.get(station).cloned().flatten(),
        base_from_device: estimate.device_at_zero(station).inverse(),
    };
    (0..data.station_count()).map(of).collect()
}

/// Pose of a tip that was not measured.
#[derive(Clone, Copy)]
pub(crate) enum UnmeasuredTip {
    /// On the last joint as in the nominal model.
    Nominal,
    /// `base_from_tip` at zero joint values.
    At(Pose),
}

/// Measured components of the tip.
#[derive(Clone, Copy, PartialEq)]
enum MeasuredTip {
    Nothing,
    Place,
    Pose,
}

/// The calibrated robot with its tip, and the targets in that tip. The tip is placed as `tip` states, with two exceptions. A target or an instrument
/// exactly at the model's tip moves it; so does, with `move_tip`, the target without a name (if measured as points, with the orientation of `tip`).
/// Targets and instruments of the model with bodies of their own stay on these.
pub(crate) fn place_tip(
    robot: &Robot,
    data: &Dataset,
    frames: &[bool],
    estimate: &Estimate,
    move_tip: bool,
    tip: UnmeasuredTip,
) -> (Robot, Vec<CalibratedTarget>) {
    let mut calibrated = robot.with_screws(&estimate.screws());
    calibrated.terms.clone_from(&estimate.terms);
    calibrated.terms.retain(|it| it.coefficient != 0.0);
    let last_joint = calibrated.tip_body().joint().and_then(|joint| calibrated.joints.get(joint));
    calibrated.home = last_joint.map_or_else(Pose::identity, |joint| joint.frame) * robot.last_joint_from_tip();
    let is_tip = |name: &Option<String>| move_tip && name.is_none();
    let named = data.targets.iter().zip(frames).find(|(name, _)| is_tip(name));
    let named = match named {
        None => MeasuredTip::Nothing,
        Some((_, true)) => MeasuredTip::Pose,
        Some((_, false)) => MeasuredTip::Place,
    };
    let seen = place_mounts(robot, &mut calibrated, (data, frames), estimate, named);
    for (target, name) in data.targets.iter().enumerate() {
        if is_tip(name) {
            let seen = estimate.base_from_target[target];
            let rotation = if frames[target] { seen.rotation } else { calibrated.home.rotation };
            calibrated.home = Pose::new(rotation, seen.translation);
        }
    }
    if let UnmeasuredTip::At(pose) = tip {
        calibrated.home = match seen {
            MeasuredTip::Nothing => pose,
            MeasuredTip::Place => Pose::new(pose.rotation, calibrated.home.translation),
            MeasuredTip::Pose => calibrated.home,
        };
    }
    let tip_from_base = calibrated.home.inverse();
    let targets = data
        .targets
        .iter()
        .enumerate()
        .map(|(target, name)| {
            let is_frame = frames[target];
            let tip_from_target = tip_from_base * estimate.base_from_target[target];
            let rotation = if is_frame { tip_from_target.rotation } else { nalgebra::Matrix3::identity() };
            CalibratedTarget {
                name: name.clone().or_else(|| (!move_tip).then(|| MEASURED.to_owned())),
                is_frame,
                tip_from_target: Pose::new(rotation, tip_from_target.translation),
            }
        })
        .collect();
    (calibrated, targets)
}

/// Moves the measured targets and the instruments of the model to their calibrated poses. A target at the tip moves the tip too, or else an
/// instrument there, unless it was already `seen`; returns the measured components of the tip.
fn place_mounts(
    robot: &Robot,
    calibrated: &mut Robot,
    (data, frames): (&Dataset, &[bool]),
    estimate: &Estimate,
    seen_tip: MeasuredTip,
) -> MeasuredTip {
    let mut seen_tip = seen_tip;
    for (target, name) in data.targets.iter().enumerate() {
        let name = name.as_deref().unwrap_or(MEASURED);
        let known = calibrated.mounted.iter().position(|mount| mount.name == name);
        if let Some(index) = known {
            let Mount { name, body, .. } = calibrated.mounted[index].clone();
            let seen = estimate.base_from_target[target];
            let nominal = calibrated.base_from(&calibrated.mounted[index]);
            let rotation = if frames[target] { seen.rotation } else { nominal.rotation };
            let pose = Pose::new(rotation, seen.translation);
            if seen_tip == MeasuredTip::Nothing && robot.is_at_tip(&robot.mounted[index]) {
                seen_tip = MeasuredTip::Pose;
                calibrated.home = pose;
            }
            calibrated.mounted[index] = calibrated.mount(&name, body, &pose);
        }
    }
    for (station, name) in data.stations.iter().enumerate() {
        let known = calibrated.instruments.iter().position(|mount| Some(&mount.name) == name.as_ref());
        if let Some(index) = known {
            let Mount { name, body, .. } = calibrated.instruments[index].clone();
            let pose = estimate.device_at_zero(station).inverse();
            if seen_tip == MeasuredTip::Nothing && robot.is_at_tip(&robot.instruments[index]) {
                seen_tip = MeasuredTip::Pose;
                calibrated.home = pose;
            }
            calibrated.instruments[index] = calibrated.mount(&name, body, &pose);
        }
    }
    seen_tip
}
