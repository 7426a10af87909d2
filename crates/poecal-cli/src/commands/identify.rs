//! `poecal plan --rows`: identifiability by measurements in stated configurations.

use poecal_calibrate::DeviceFrameKnowledge;
use poecal_fit::analysis::{PlannedSession, identify as foresee, identify_measured};
use poecal_import as measurements;
use poecal_model::measurement::Noise;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_plan::plan::{PlannedFit, expected_errors};
use poecal_report as report;
use poecal_storage::named_files::refuse_repeats;

use super::models::read_model;
use crate::DONE;
use crate::args::PlanArgs;
use crate::console::Console;

pub(super) fn identify(arguments: &PlanArgs, console: &Console) -> Result<u8> {
    refuse_repeats(&arguments.rows)?;
    let options = arguments.columns.options().and_then(|options| arguments.cameras.add(options));
    let model = read_model(&arguments.model, &arguments.chain.selection(options.as_ref().ok())?, console)?;
    let options = model.reads(options?);
    let session = PlannedSession {
        kind: arguments.kind,
        noise: Noise::new(arguments.fit.sigma_position, arguments.fit.sigma_rotation),
        device_free: arguments.fit.device_frame == DeviceFrameKnowledge::Unknown,
    };
    let has_pictures = !options.cameras.is_empty() || !options.boards.is_empty();
    // Expected errors for kinds that are chosen freely: for others the covered workspace is not known.
    let mut expected = None;
    let found = if session.kind.is_touched() || has_pictures {
        let file = measurements::read(&arguments.rows, &model.robot, &options)?;
        console.said_of(&file);
        if has_pictures && file.data.pictures.is_empty() {
            return Err(Error::new(
                ErrorKind::Option,
                "found --camera or --markers and rows without pixels, expected corners with u[px] and v[px] beside the joints",
            ));
        }
        identify_measured(&model.robot, &file.data, &session)?
    } else {
        let mut readings = Vec::new();
        for path in &arguments.rows {
            let joints = measurements::read_joints(path, &model.robot, &options)?;
            console.warnings(&joints.warnings);
            readings.extend(joints.readings);
        }
        let found = foresee(&model.robot, &readings, &session)?;
        if session.kind.is_chosen_freely() {
            let robot_error = arguments.fit.robot_error.or_else(|| model.left_error());
            let fit = PlannedFit { session, robot_error, ..PlannedFit::default() };
            expected = Some(expected_errors(&model.robot, &readings, &fit)?);
        }
        found
    };
    let files: Vec<String> = arguments.rows.iter().map(|path| path.display().to_string()).collect();
    let report = report::Identify::new(&model, &files, &session, (&found, expected));
    console.json_or_table(arguments.json, || report::json(&report), || report.text())?;
    Ok(DONE)
}
