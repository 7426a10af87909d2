//! `poecal tcp`: position of a tool's tip, from poses of the flange in which it touched a fixed point.

use std::ffi::OsString;

use poecal_fit::hand_eye::tool_tip;
use poecal_import::read_flange_poses;
use poecal_numerics::error::Result;
use poecal_report as report;
use poecal_results::output::Contents;
use poecal_results::tcp::ToolResult;

use super::frames::{FramesOutput, model, row_name};
use super::reproducing_command::command;
use crate::args::TcpArgs;
use crate::console::Console;

pub(crate) fn tcp(arguments: &TcpArgs, typed: &[OsString], console: &Console) -> Result<u8> {
    let place = arguments.out.reserve(Contents::Tip, &arguments.inputs(), console)?;
    let model = model(arguments.robot.as_ref(), &arguments.chain, console)?;
    let poses = read_flange_poses(&arguments.poses, arguments.units, model.as_ref().map(|it| &it.robot))?;
    console.warnings(&poses.warnings);
    poses.understood.iter().for_each(|it| console.remark(it));
    let found = tool_tip(&poses.touches, &row_name(&poses.names)).map_err(|error| error.in_file(&arguments.poses))?;
    let command = command(typed);
    let result = ToolResult { found: &found, poses: &poses, command: &command };
    let found = FramesOutput {
        json: ("tcp.json", result.to_text()?),
        table: report::tool_tip(&result),
        texts: result.texts(),
        level: found.level,
    };
    arguments.out.put(place, found, console)
}
