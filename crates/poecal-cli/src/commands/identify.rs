//! `poecal identify`: identifiability by measurements in given configurations.

use poecal::analysis::{PlannedSession, identify as foresee, identify_touching};
use poecal::calibration::DeviceFrameKnowledge;
use poecal::io::measurements;
use poecal::io::model::Model;
use poecal::io::named_files::refuse_repeats;
use poecal::measurement::{Noise, Quantity};
use poecal::{Result, report};

use crate::DONE;
use crate::args::Identify;
use crate::console::Console;

pub(crate) fn identify(arguments: &Identify, console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.joints)?;
    let options = arguments.columns.options();
    let model = Model::read(&arguments.model, &arguments.chain.selection(options.as_ref().ok())?)?;
    let options = model.reads(options?);
    let usual = PlannedSession::default();
    let session = PlannedSession {
        kind: arguments.kind,
        noise: Noise::new(
            arguments.sigma_position.unwrap_or(usual.noise[Quantity::Position]),
            arguments.sigma_rotation.unwrap_or(usual.noise[Quantity::Rotation]),
        ),
        device_free: arguments.frame == DeviceFrameKnowledge::Unknown,
    };
    let found = if session.kind.is_touched() {
        let file = measurements::read(&arguments.joints, &model.robot, &options)?;
        console.warnings(&file.warnings);
        identify_touching(&model.robot, &file.data, &session)?
    } else {
        let mut readings = Vec::new();
        for path in &arguments.joints {
            let joints = measurements::read_joints(path, &model.robot, &options)?;
            console.warnings(&joints.warnings);
            readings.extend(joints.readings);
        }
        foresee(&model.robot, &readings, &session)?
    };
    let files: Vec<String> = arguments.joints.iter().map(|path| path.display().to_string()).collect();
    let report = report::Identify::new(&model, &files, &session, &found);
    console.json_or_table(arguments.json, || report::json(&report), || report.text())?;
    Ok(DONE)
}
