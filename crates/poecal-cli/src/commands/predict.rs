//! `poecal predict`: poses from joint readings.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use poecal_calibrate::AcceptedModel;
use poecal_formats::urdf::named_link;
use poecal_import as measurements;
use poecal_numerics::error::Result;
use poecal_results::predictions;

use super::models::read_model;
use crate::DONE;
use crate::args::{Predict, with_mapping};
use crate::console::Console;

pub(crate) fn predict(arguments: &Predict, console: &Console) -> Result<u8> {
    let mapping = arguments.columns.columns.iter();
    let inputs: Vec<&Path> =
        [&arguments.model, &arguments.joints].into_iter().chain(mapping).map(PathBuf::as_path).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let options = arguments.columns.options();
    let target = arguments.target.as_deref();
    // Only a URDF has links.
    let has_links = !["toml", "json"].map(OsStr::new).contains(&arguments.model.extension().unwrap_or_default());
    let mounted = target.filter(|target| has_links && target.contains('=')).map(named_link).transpose()?;
    let selection = arguments.chain.selection().join(&[], mounted.as_slice())?;
    let model = read_model(&arguments.model, &with_mapping(selection, options.as_ref().ok())?, console)?;
    let model = match arguments.of {
        AcceptedModel::Corrected => {
            let corrected = model.corrected_model()?;
            if !corrected.robot.terms.iter().all(|it| it.coefficient == 0.0) && corrected.robot.gravity.is_some() {
                console.remark(
                    "predicted by the corrected model, with what the joints do beyond geometry; --model calibrated is geometry alone",
                );
            }
            corrected
        }
        AcceptedModel::Calibrated => model,
    };
    let joints = measurements::read_joints(&arguments.joints, &model.robot, &model.reads(options?))?;
    console.warnings(&joints.warnings);
    let (frame, target) = (arguments.output_frame, mounted.as_ref().map(|(name, _)| name.as_str()).or(target));
    if arguments.with_uncertainty
        && let Some(remark) = predictions::remark(&model, &joints, frame, target)?
    {
        console.remark(remark);
    }
    let text = predictions::predict(&model, &joints, frame, target, arguments.with_uncertainty)?;
    console.deliver(text, place)?;
    Ok(DONE)
}
