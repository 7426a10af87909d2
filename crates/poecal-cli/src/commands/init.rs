//! `poecal init`: a folder to start a calibration from.

use std::process::ExitCode;

use poecal::Result;
use poecal::io::model::Model;
use poecal::io::output::{Project, write_project};

use crate::args::Init;
use crate::console::Console;

pub(crate) fn init(arguments: &Init, console: &Console) -> Result<ExitCode> {
    let chain = arguments.chain.selection();
    let model = Model::read(&arguments.model, &chain)?;
    let project = Project {
        model: &model,
        chain: &chain,
        kind: arguments.measure.into(),
        count: arguments.count as usize,
        seed: arguments.seed,
    };
    let written = write_project(&arguments.out, &project)?;
    console.say(&format!(
        "written       {}\n              {}\nnext          read {}: measure, fill in measurements.csv, and run\n              \
         `poecal calibrate` in that folder\n",
        written.folder.display(),
        written.files.join(", "),
        written.folder.join("README.md").display()
    ))?;
    Ok(ExitCode::SUCCESS)
}
