//! `poecal predict`: poses from joint readings.

use std::path::{Path, PathBuf};

use poecal::Result;
use poecal::io::model::Model;
use poecal::io::{measurements, predictions};

use crate::DONE;
use crate::args::Predict;
use crate::console::Console;

pub(crate) fn predict(arguments: &Predict, console: &Console) -> Result<u8> {
    let mapping = arguments.columns.columns.iter();
    let inputs: Vec<&Path> =
        [&arguments.model, &arguments.joints].into_iter().chain(mapping).map(PathBuf::as_path).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let model = Model::read(&arguments.model, &arguments.chain.selection())?;
    let joints = measurements::read_joints(&arguments.joints, &model.robot, &arguments.columns.options()?)?;
    console.warnings(&joints.warnings);
    let (frame, target) = (arguments.frame, arguments.target.as_deref());
    let text = predictions::predict(&model, &joints, frame, target, arguments.with_uncertainty)?;
    console.deliver(text, place)?;
    Ok(DONE)
}
