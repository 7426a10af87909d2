//! `poecal hand-eye`: where a camera is, from poses of the flange and of what the camera saw.

use std::ffi::OsString;
use std::path::PathBuf;

use poecal::calibration::{arm_too, session_of};
use poecal::hand_eye::{HandEye as Found, HandEyeOptions, Level, hand_eye as calibrated};
use poecal::io::hand_eye::{ArmByJoints, FrameNames, HandEyeResult};
use poecal::io::measurements::{PosePairs, PoseSource, read_pose_pairs};
use poecal::io::model::Model;
use poecal::io::named_files::refuse_repeats;
use poecal::io::output::{Contents, Existing, FolderPlace, write_texts};
use poecal::robot::Robot;
use poecal::{ErrorKind, Result, report};

use super::typed::{command, shell_word};
use crate::args::HandEye;
use crate::console::Console;
use crate::style;
use crate::{DONE, WORSE};

pub(crate) fn hand_eye(arguments: &HandEye, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.poses)?;
    let existing = Existing::forced(arguments.force);
    let reserve = |out: &std::path::PathBuf| {
        FolderPlace::reserve(out, Contents::HandEye, existing, &arguments.inputs(), &mut console.warner())
    };
    let place = arguments.out.as_ref().map(reserve).transpose()?;
    let model = match &arguments.model {
        Some(path) => Some(Model::read(path, &arguments.chain.selection())?),
        None => None,
    };
    refuse_without_use(arguments)?;
    let pictures = arguments.pictures()?;
    let robot = model.as_ref().map(|it| &it.robot);
    let source = PoseSource { units: arguments.units, robot, pictures: &pictures };
    let poses = read_pose_pairs(&arguments.poses, &source)?;
    console.warnings(&poses.warnings);
    poses.understood.iter().for_each(|it| console.remark(it));
    let options = HandEyeOptions {
        camera: arguments.camera,
        flange_inverted: arguments.flange.or(model.is_some().then_some(false)),
        target_inverted: arguments.target.or((!poses.target.other_poses.is_empty()).then_some(false)),
    };
    let name = |row: usize| poses.names.get(row).cloned().unwrap_or_else(|| format!("row {}", row + 1));
    let found = calibrated(&poses.flange, &poses.target, &options, &name)?;
    let command = command(typed);
    let arm = robot.map(|robot| by_joints(robot, &poses, &found, arguments)).transpose()?;
    let names =
        arguments.frames.clone().unwrap_or_else(|| robot.map_or_else(FrameNames::default, FrameNames::of));
    let result =
        HandEyeResult { found: &found, poses: &poses, names: &names, command: &command, arm: arm.as_ref() };
    let json = result.to_text()?;
    let written = match place {
        Some(place) => Some(write_texts(place, ("hand_eye.json", json.clone()), result.texts())?),
        None => None,
    };
    let words = written.as_ref().map_or_else(String::new, |it| style::written(&it.folder, &it.files));
    let text = if arguments.json { json } else { report::hand_eye(&result) + &words };
    let told = match (&written, arguments.json) {
        (Some(it), true) => console.data_of(&text, &it.folder),
        (Some(it), false) => console.say_of(&text, &it.folder),
        (None, true) => console.data(&text).map(|()| DONE)?,
        (None, false) => console.say(&text).map(|()| DONE)?,
    };
    Ok(if found.level == Level::DoNotUse { WORSE } else { told })
}

/// What the joint readings of the poses add.
fn by_joints(robot: &Robot, poses: &PosePairs, found: &Found, arguments: &HandEye) -> Result<ArmByJoints> {
    let data = session_of(robot, &poses.joints, &poses.target, found)?;
    ArmByJoints::new((robot, &data), found, arm_too(robot, &data), with_arm(arguments))
}

/// The command that fits the arm with the camera: from the same pixels, or from the session that is written with --out.
fn with_arm(arguments: &HandEye) -> String {
    let mut words = vec!["poecal".to_owned(), "calibrate".to_owned()];
    words.extend(arguments.model.iter().map(|it| it.display().to_string()));
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
            let folder = arguments.out.clone().unwrap_or_else(|| PathBuf::from("DIR"));
            words.push(folder.join("session.csv").display().to_string());
        }
    }
    let words: Vec<String> = words.iter().map(|word| shell_word(word)).collect();
    words.join(" ")
}

/// Refuses options that would have no effect.
fn refuse_without_use(arguments: &HandEye) -> Result<()> {
    arguments.chain.refuse_without(arguments.model.as_deref())?;
    if arguments.model.is_some() && arguments.flange.is_some() {
        return ErrorKind::Option
            .refuse("found --flange beside --model, expected one of the two: by joint readings the arm's poses are base from flange");
    }
    Ok(())
}
