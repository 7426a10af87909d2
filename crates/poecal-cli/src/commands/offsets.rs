//! `poecal offsets`: the joint offsets of the best fit of one model to another.

use std::ffi::OsStr;

use poecal_formats::urdf::ChainSelection;
use poecal_numerics::error::Result;
use poecal_report as report;
use poecal_results::model::Model;
use poecal_results::offsets::ModelOffsets;

use super::joint_offsets::quote_names;
use crate::DONE;
use crate::args::{OffsetsArgs, OuterFrame};
use crate::console::Console;

pub(crate) fn offsets(arguments: &OffsetsArgs, console: &Console) -> Result<u8> {
    let place = arguments.place.reserve(&[&arguments.nominal, &arguments.actual], console)?;
    let selection = arguments.chain.selection();
    let nominal = Model::read(&arguments.nominal, &selection)?;
    // Only a URDF can have several chains; the chosen one is also that of a calibration beside it.
    let one_chain = ["toml", "json"].map(OsStr::new).contains(&arguments.actual.extension().unwrap_or_default());
    let whole = ChainSelection::default();
    let actual = Model::read(&arguments.actual, if one_chain { &whole } else { &selection })?;
    let stated = [arguments.stated_constraint(OuterFrame::Base)?, arguments.stated_constraint(OuterFrame::Tip)?];
    let explanation =
        ModelOffsets::from_robots(&nominal, &actual, stated).map_err(|error| error.in_file(&arguments.actual))?;
    for joint in &nominal.robot.joints {
        let followers = nominal.robot.followers(&joint.name);
        if !followers.is_empty() {
            console.warning(format!(
                "joint `{}` is read for {} too: each offset is that of the joint's own value, and an error of this encoder is in all of \
                 them",
                joint.name,
                quote_names(&followers)
            ));
        }
    }
    let found = report::Offsets::new(&nominal, &actual, &explanation);
    let text = if arguments.json { report::json(&found)? } else { found.text() };
    console.show(text, place, arguments.json)?;
    Ok(DONE)
}
