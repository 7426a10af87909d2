//! `poecal tcp`: where the tip of a tool is, from poses of the flange in which it touched a fixed point.

use std::ffi::OsString;
use std::path::PathBuf;

use poecal::hand_eye::{Level, Touches, tool_tip};
use poecal::io::measurements::read_flange_poses;
use poecal::io::model::Model;
use poecal::io::output::{Contents, Existing, FolderPlace, write_texts};
use poecal::io::tcp::ToolResult;
use poecal::{Result, report};

use super::typed::command;
use crate::args::Tcp;
use crate::console::Console;
use crate::style;
use crate::{DONE, WORSE};

pub(crate) fn tcp(arguments: &Tcp, typed: &[OsString], console: &Console) -> Result<u8> {
    let existing = Existing::forced(arguments.force);
    let reserve = |out: &PathBuf| {
        FolderPlace::reserve(out, Contents::Tip, existing, &[&arguments.poses], &mut console.warner())
    };
    let place = arguments.out.as_ref().map(reserve).transpose()?;
    let model = match &arguments.model {
        Some(path) => Some(Model::read(path, &arguments.chain.selection())?),
        None => None,
    };
    arguments.chain.refuse_without(arguments.model.as_deref())?;
    let poses = read_flange_poses(&arguments.poses, arguments.units, model.as_ref().map(|it| &it.robot))?;
    console.warnings(&poses.warnings);
    poses.understood.iter().for_each(|it| console.remark(it));
    let touches =
        Touches { flange: poses.poses.clone(), points: poses.points.clone(), tips: poses.tips.clone() };
    let name = |row: usize| poses.names.get(row).cloned().unwrap_or_else(|| format!("row {}", row + 1));
    let found = tool_tip(&touches, &name).map_err(|error| error.in_file(&arguments.poses))?;
    let command = command(typed);
    let result = ToolResult { found: &found, poses: &poses, command: &command };
    let json = result.to_text()?;
    let written =
        place.map(|place| write_texts(place, ("tcp.json", json.clone()), result.texts())).transpose()?;
    let words = written.as_ref().map_or_else(String::new, |it| style::written(&it.folder, &it.files));
    let text = if arguments.json { json } else { report::tool_tip(&result) + &words };
    let told = match (&written, arguments.json) {
        (Some(it), true) => console.data_of(&text, &it.folder),
        (Some(it), false) => console.say_of(&text, &it.folder),
        (None, true) => console.data(&text).map(|()| DONE)?,
        (None, false) => console.say(&text).map(|()| DONE)?,
    };
    Ok(if found.level == Level::DoNotUse { WORSE } else { told })
}
