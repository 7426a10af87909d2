//! `poecal hand-eye`: where a camera is, from poses of the flange and of what the camera saw.

use std::ffi::OsString;

use poecal::hand_eye::{HandEyeOptions, Level, hand_eye as calibrated};
use poecal::io::hand_eye::HandEyeResult;
use poecal::io::measurements::read_pose_pairs;
use poecal::io::named_files::refuse_repeats;
use poecal::io::output::{Contents, Existing, FolderPlace, write_texts};
use poecal::{Result, report};

use super::typed::command;
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
    let poses = read_pose_pairs(&arguments.poses, arguments.units)?;
    console.warnings(&poses.warnings);
    poses.understood.iter().for_each(|it| console.remark(it));
    let options = HandEyeOptions {
        camera: arguments.camera,
        flange_inverted: arguments.flange,
        target_inverted: arguments.target,
    };
    let name = |row: usize| poses.names.get(row).cloned().unwrap_or_else(|| format!("row {}", row + 1));
    let found = calibrated(&poses.flange, &poses.target, &options, &name)?;
    let command = command(typed);
    let result = HandEyeResult { found: &found, poses: &poses, names: &arguments.frames, command: &command };
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
