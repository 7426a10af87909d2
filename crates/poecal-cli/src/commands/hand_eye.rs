//! `poecal hand-eye`: pose of a camera, from poses of the flange and of the observed target.

use std::ffi::OsString;
use std::path::PathBuf;

use poecal_calibrate::{arm_too, session_of};
use poecal_fit::hand_eye::{HandEye as Found, HandEyeOptions, hand_eye as calibrated};
use poecal_import::{PosePairs, PoseSource, read_pose_pairs};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_results::hand_eye::{ArmByJoints, FrameNames, HandEyeResult};
use poecal_results::output::Contents;
use poecal_storage::named_files::refuse_repeats;

use super::frames::{FramesOutput, model, row_name};
use super::reproducing_command::{command, shell_word};
use crate::args::HandEyeArgs;
use crate::console::Console;

pub(crate) fn hand_eye(arguments: &HandEyeArgs, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.poses)?;
    let place = arguments.out.reserve(Contents::HandEye, &arguments.inputs(), console)?;
    let model = model(arguments.robot.as_ref(), &arguments.chain, console)?;
    refuse_without_use(arguments)?;
    let pictures = arguments.pictures()?;
    let robot = model.as_ref().map(|it| &it.robot);
    let source = PoseSource { units: arguments.units, robot, pictures: &pictures };
    let poses = read_pose_pairs(&arguments.poses, &source)?;
    console.warnings(&poses.warnings);
    poses.understood.iter().for_each(|it| console.remark(it));
    let is_of_corners = !poses.target.other_poses.is_empty();
    refuse_unread(arguments, is_of_corners)?;
    let options = HandEyeOptions {
        camera: arguments.camera,
        flange_inverted: arguments.flange.or(model.is_some().then_some(false)),
        target_inverted: arguments.target.or(is_of_corners.then_some(false)),
    };
    let mut found = calibrated(&poses.flange, &poses.target, &options, &row_name(&poses.names))?;
    let command = command(typed);
    let arm = robot.map(|robot| by_joints(robot, &poses, &found, arguments)).transpose()?;
    let weakens = arm.as_ref().and_then(|arm| arm.errors.as_ref().ok()?.weakens());
    weakens.into_iter().for_each(|reason| found.weaken(reason));
    let names =
        arguments.frame_names.clone().unwrap_or_else(|| robot.map_or_else(FrameNames::default, FrameNames::from_robot));
    let result = HandEyeResult { found: &found, poses: &poses, names: &names, command: &command, arm: arm.as_ref() };
    let found = FramesOutput {
        json: ("hand_eye.json", result.to_text()?),
        table: report::hand_eye(&result),
        texts: result.texts(),
        level: found.level,
    };
    arguments.out.put(place, found, console)
}

/// Additional results from the joint readings of the poses.
fn by_joints(robot: &Robot, poses: &PosePairs, found: &Found, arguments: &HandEyeArgs) -> Result<ArmByJoints> {
    let data = session_of(robot, &poses.joints, &poses.target, found)?;
    ArmByJoints::new((robot, &data), found, arm_too(robot, &data), with_arm(arguments))
}

/// The command that fits the arm with the camera: from the same pixels, or from the session that is written with --out.
fn with_arm(arguments: &HandEyeArgs) -> String {
    let mut words = vec!["poecal".to_owned(), "calibrate".to_owned()];
    words.extend(arguments.robot.iter().map(|it| it.display().to_string()));
    let chain = &arguments.chain;
    for (option, link) in [("--base-link", &chain.base_link), ("--tip-link", &chain.tip_link)] {
        words.extend(link.iter().flat_map(|link| [option.to_owned(), link.clone()]));
    }
    match (&arguments.lens, &arguments.markers) {
        (Some(lens), Some(board)) => {
            words.extend(arguments.poses.iter().map(|it| it.display().to_string()));
            words.extend(["--camera", lens, "--markers", board].map(str::to_owned));
        }
        _ => {
            let folder = arguments.out.out.clone().unwrap_or_else(|| PathBuf::from("DIR"));
            words.push(folder.join("session.csv").display().to_string());
        }
    }
    let words: Vec<String> = words.iter().map(|word| shell_word(word)).collect();
    words.join(" ")
}

/// Refuses a direction for poses that have none.
fn refuse_without_use(arguments: &HandEyeArgs) -> Result<()> {
    if arguments.robot.is_some() && arguments.flange.is_some() {
        return ErrorKind::Option
            .refuse("found --flange beside --robot, expected one of the two: by joint readings the arm's poses are base from flange");
    }
    Ok(())
}

/// Refuses options of corners without corners, and options of poses with corners.
fn refuse_unread(arguments: &HandEyeArgs, is_of_corners: bool) -> Result<()> {
    if is_of_corners && arguments.target.is_some() {
        return ErrorKind::Option
            .refuse("found --target beside corners in pixels, expected one of the two: by corners the target's poses are camera from target");
    }
    if !is_of_corners && (arguments.lens.is_some() || arguments.markers.is_some()) {
        return ErrorKind::Option.refuse(
            "found --lens or --markers and no corners in pixels, expected a second file with image, target, u[px], v[px]",
        );
    }
    Ok(())
}
