//! Predicted poses as CSV.

use std::borrow::Cow;

use super::calibration_file::{BodyEntry, MeasuredEntry, TargetEntry, only_target};
use super::model::{Model, ModelSource};
use poecal_arm::lie::Pose;
use poecal_fit::analysis::is_within_ranges;
use poecal_fit::state::PackedValues;
use poecal_fit::uncertainty::PredictedError;
use poecal_import::JointsTable;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result, first_few, nearest_word};
use poecal_storage::csv_text::cell;
use poecal_storage::numbers::push_number;

/// Frame of predicted poses.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_results::predictions::PredictionFrame;
/// # }
/// use poecal::PredictionFrame;
/// assert_ne!(PredictionFrame::Base, PredictionFrame::Device);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PredictionFrame {
    /// The robot's base.
    Base,
    /// The measuring device of a calibration.
    Device,
}

/// Predicts the pose of the tip, or of a target ([`default_target`] without a name), in each configuration. The text has a header and rows
/// `x[m],y[m],z[m],qx,qy,qz,qw`, after the rows' `id` if they have one. Numbers read back exactly; `qw ≥ 0`.
///
/// # Errors
/// [`ErrorKind::Option`] if the model has no such target, no measuring device, or several targets that it may see.
pub fn predict(
    model: &Model,
    joints: &JointsTable,
    frame: PredictionFrame,
    target: Option<&str>,
    with_uncertainty: bool,
) -> Result<String> {
    let found = predict_readings(model, &joints.readings, frame, target, with_uncertainty)?;
    let with_ids = !joints.ids.is_empty();
    let mut out = String::with_capacity((joints.rows + 1) * 200);
    out.push_str(if with_ids { "id," } else { "" });
    out.push_str("x[m],y[m],z[m],qx,qy,qz,qw");
    out.push_str(if with_uncertainty { UNCERTAINTY_COLUMNS } else { "" });
    out.push('\n');
    for (row, pose) in found.poses.iter().enumerate() {
        if with_ids {
            out.push_str(&cell(joints.ids.get(row).map_or("", String::as_str)));
            out.push(',');
        }
        let [x, y, z]: [f64; 3] = pose.translation.into();
        let [qx, qy, qz, qw] = pose.quaternion_xyzw();
        for (column, number) in [x, y, z, qx, qy, qz, qw].into_iter().enumerate() {
            out.push_str(if column == 0 { "" } else { "," });
            push_number(&mut out, number);
        }
        if let Some((error, inside)) = found.doubts.as_ref().and_then(|doubts| doubts.get(row)) {
            for number in [error.sigma_position_m(), error.sigma_rotation_rad(), error.bound_position_m()] {
                out.push(',');
                push_number(&mut out, number);
            }
            out.push_str(if *inside { ",true" } else { ",false" });
        }
        out.push('\n');
    }
    Ok(out)
}

/// Predicted poses.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_results::model::{Model, ModelSource};
/// #     pub use poecal_results::predictions::{PredictionFrame, predict_readings};
/// # }
/// use poecal::{Model, ModelSource, PredictionFrame, predict_readings};
/// let model = Model { robot: poecal_model::simulate::scara(), source: ModelSource::Toml, path: "scara.toml".into() };
/// let found = predict_readings(&model, &[0.0; 8], PredictionFrame::Base, None, false)?;
/// assert_eq!((found.poses.len(), found.poses[0]), (2, model.robot.home));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedPoses {
    /// Name of the target that is predicted; `None` is the tip.
    pub target: Option<String>,
    /// Pose of the tip or target in the chosen frame, one for each configuration.
    pub poses: Vec<Pose>,
    /// Predicted uncertainty of each, and true if every joint is inside the sampled range; if requested.
    pub doubts: Option<Vec<(PredictedError, bool)>>,
}

/// Predicts as [`predict`], from readings one after the other in the order of [`Robot::reading_names`](poecal_model::robot::Robot::reading_names)
/// (radians, metres).
///
/// # Errors
/// As [`predict`].
pub fn predict_readings(
    model: &Model,
    readings: &[f64],
    frame: PredictionFrame,
    target: Option<&str>,
    with_uncertainty: bool,
) -> Result<PredictedPoses> {
    let target = match target {
        Some(name) if is_tip(model, name) => None,
        Some(name) => Some(name),
        None => default_target(model, frame, with_uncertainty)?,
    };
    let (robot, tip_from_target) = match target {
        None => (Cow::Borrowed(&model.robot), Pose::identity()),
        Some(name) => robot_with_target(model, name)?,
    };
    let frame_from_base = match frame {
        PredictionFrame::Base => Pose::identity(),
        PredictionFrame::Device => device_from_base(model)?,
    };
    let doubts = if with_uncertainty { Some(doubts(model, readings, target)?) } else { None };
    let poses = robot.forward_kinematics_of(readings);
    let poses = poses.map(|base_from_tip| frame_from_base * base_from_tip * tip_from_target).collect();
    Ok(PredictedPoses { target: target.map(str::to_owned), poses, doubts })
}

/// Ratio of the tip's expected error to a measured target's from which on the reason is stated.
const WORSE: f64 = 1.5;
/// Name of the tip as a requested target.
const TIP: &str = "tip";

/// True if a name denotes the tip, and not a target.
fn is_tip(model: &Model, name: &str) -> bool {
    let Robot { targets, mounted, .. } = &model.robot;
    name == TIP && !targets.iter().any(|(it, _)| it == TIP) && !mounted.iter().any(|it| it.name == TIP)
}

/// The targets that a calibration measured, with their entries.
fn measured_targets(model: &Model) -> Vec<(&str, &TargetEntry)> {
    let ModelSource::Calibration(file) = &model.source else { return Vec::new() };
    let is_measured = |it: &TargetEntry| it.measured_entry() != MeasuredEntry::Nothing;
    file.targets.iter().filter(|(_, it)| is_measured(it)).map(|(name, it)| (name.as_str(), it)).collect()
}

/// The default target of a prediction; `None` is the tip. In the device's frame it is the only measured one, which the device sees. In the base frame
/// it is the tip. With the expected error it is the first measured target on the robot, since the position of a tip on its link was not measured.
///
/// # Errors
/// [`ErrorKind::Option`] if several targets were measured that the device may see.
pub fn default_target(model: &Model, frame: PredictionFrame, with_uncertainty: bool) -> Result<Option<&str>> {
    match frame {
        PredictionFrame::Device => single_target(model),
        PredictionFrame::Base if with_uncertainty => Ok(on_robot(model)),
        PredictionFrame::Base => Ok(None),
    }
}

/// The first target that was measured on the robot; of the states of one target the last. `None` if the tip itself was measured.
fn on_robot(model: &Model) -> Option<&str> {
    let robot = &model.robot;
    let is_at_tip = |name: &str| robot.mounted.iter().any(|it| it.name == name && robot.is_at_tip(it));
    if measured_targets(model).iter().any(|(name, _)| is_at_tip(name)) {
        return None;
    }
    let moves = |it: &TargetEntry| !matches!(it.on, Some(BodyEntry::Base));
    let names: Vec<&str> = measured_targets(model).into_iter().filter(|(_, it)| moves(it)).map(|it| it.0).collect();
    only_target(&names).or_else(|| names.first().copied())
}

/// Note on a prediction with its expected error. It states the default target if none was named, and the option for the other. For a tip that was not
/// measured it states the reason of the larger error.
///
/// # Errors
/// As [`predict`].
pub fn remark(
    model: &Model,
    joints: &JointsTable,
    frame: PredictionFrame,
    target: Option<&str>,
) -> Result<Option<String>> {
    let Some(first) = on_robot(model) else { return Ok(None) };
    match target {
        None if frame == PredictionFrame::Base => {
            let which = match measured_targets(model).len() {
                ..=1 => format!("the measured target `{first}`"),
                count => format!("`{first}`, the first of {count} measured targets"),
            };
            Ok(Some(format!("predicted {which}; --target tip predicts the tip, which was not measured")))
        }
        Some(name) if is_tip(model, name) => {
            let rms_mm = |target: Option<&str>| {
                let found = doubts(model, &joints.readings, target)?;
                let squares: f64 = found.iter().map(|(error, _)| error.sigma_position_m().powi(2)).sum();
                Ok(1e3 * (squares / found.len().max(1) as f64).sqrt())
            };
            let (tip_mm, first_mm) = (rms_mm(None)?, rms_mm(Some(first))?);
            Ok((tip_mm > WORSE * first_mm).then(|| format!(
                "the tip was not measured: its position on the last link is known to {tip_mm:.2} mm (RMS), that of `{first}`, which was \
                 measured, to {first_mm:.2} mm (--target {first})"
            )))
        }
        _ => Ok(None),
    }
}

/// The only target that a calibration measured; `None` if that is the tip.
fn single_target(model: &Model) -> Result<Option<&str>> {
    let names: Vec<&str> = measured_targets(model).into_iter().map(|(name, _)| name).collect();
    match (names.as_slice(), only_target(&names)) {
        ([], _) => Ok(None),
        (_, Some(only)) => Ok(Some(only)),
        (several, None) => {
            Err(ErrorKind::Option.error(format!(
                "found {} targets that the device may see ({}), expected the name of one for --output-frame device: write --target {}",
                several.len(),
                first_few(several),
                several[0]
            )).in_file(&model.path))
        }
    }
}

/// Expected root mean square distance and angle, 95 % bound of the distance, and whether every joint is inside the sampled range.
const UNCERTAINTY_COLUMNS: &str = ",sigma_position[m],sigma_rotation[rad],bound95_position[m],inside_sampled_range";

/// Predicted uncertainty of each row.
fn doubts(model: &Model, readings: &[f64], target: Option<&str>) -> Result<Vec<(PredictedError, bool)>> {
    let ModelSource::Calibration(file) = &model.source else {
        return Err(ErrorKind::Option
            .error(
                "found a robot model without uncertainty, expected a calibration.json for \
                       --with-uncertainty: calibrate first",
            )
            .in_file(&model.path));
    };
    let (uncertainty, indices) = file.uncertainty(&[target]).map_err(|error| error.in_file(&model.path))?;
    let width = model.robot.reading_names().len();
    let packed = PackedValues::new(&model.robot, readings, width);
    let errors = uncertainty.predictions(&packed, indices.first().copied().unwrap_or_default());
    let sampled = |row: &[f64]| is_within_ranges(&model.robot, &file.coverage, row);
    Ok(errors.into_iter().zip(readings.chunks_exact(width.max(1)).map(sampled)).collect())
}

/// The robot with its tip on the body of a target, and the target in that tip.
fn robot_with_target<'a>(model: &'a Model, name: &str) -> Result<(Cow<'a, Robot>, Pose)> {
    let robot = &model.robot;
    if let Some((_, pose)) = robot.targets.iter().find(|(known, _)| known == name) {
        return Ok((Cow::Borrowed(robot), *pose));
    }
    if let Some(mount) = robot.mounted.iter().find(|mount| mount.name == name) {
        return Ok((Cow::Owned(robot.with_tip_at(mount)), Pose::identity()));
    }
    let mounted = robot.mounted.iter().map(|mount| mount.name.as_str());
    let names: Vec<&str> = robot.targets.iter().map(|(known, _)| known.as_str()).chain(mounted).collect();
    let expected = match nearest_word(name, names.iter().copied()) {
        Some(near) => format!("expected one of {}; did you mean `{near}`?", first_few(&names)),
        None if !names.is_empty() => format!("expected one of {}", first_few(&names)),
        None => "expected none: the model has no targets, leave out --target to predict the tip".to_owned(),
    };
    Err(ErrorKind::Option.error(format!("found no target `{name}`, {expected}")).in_file(&model.path))
}

fn device_from_base(model: &Model) -> Result<Pose> {
    match &model.source {
        ModelSource::Calibration(file) => {
            let first = file.stations.first().and_then(|station| station.instrument.as_ref());
            let is_moved =
                |name: &&String| file.instruments.get(*name).is_some_and(|instrument| instrument.on != BodyEntry::Base);
            if let Some(name) = first.filter(is_moved) {
                return Err(ErrorKind::Option.error(format!(
                    "found the instrument `{name}` on the robot, expected one beside it for --output-frame device: use --output-frame base"
                )).in_file(&model.path));
            }
            let found = match file.last_station() {
                Some(station) => station.base_from_device.pose(),
                None => file.base_from_device(),
            };
            let base_from_device = found.map_err(|error| error.in_file(&model.path))?;
            Ok(base_from_device.inverse())
        }
        ModelSource::Urdf(_) | ModelSource::Toml => Err(ErrorKind::Option
            .error(
                "found a robot model without a measuring device, expected a calibration.json for \
                           --output-frame device: use --output-frame base",
            )
            .in_file(&model.path)),
    }
}
