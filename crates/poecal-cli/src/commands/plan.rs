//! `poecal plan`: which configurations to measure, how many, and what error to expect.

use std::path::PathBuf;

use poecal::analysis::PlannedSession;
use poecal::calibration::DeviceFrameKnowledge;
use poecal::io::measurements::{ReadOptions, planned_table, read_joints};
use poecal::io::model::Model;
use poecal::measurement::Noise;
use poecal::plan::{PlanOptions, PlannedFit, plan as planned, workspace_in};
use poecal::robot::Tolerance;
use poecal::{ErrorKind, Result, report};

use crate::DONE;
use crate::args::Plan;
use crate::console::Console;
use crate::quantity::{BelievedTolerance, Over};
use crate::style::{labelled, shown};

pub(crate) fn plan(arguments: &Plan, console: &Console) -> Result<u8> {
    let files = arguments.candidates.iter().chain(&arguments.keep).map(PathBuf::as_path);
    let inputs: Vec<_> = std::iter::once(arguments.model.as_path()).chain(files).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let options = arguments.columns.options();
    let model = Model::read(&arguments.model, &arguments.chain.selection(options.as_ref().ok())?)?;
    let reading = model.reads(options?);
    let read = |path: &PathBuf| readings(path, &model, &reading, console);
    let list = arguments.candidates.as_ref().map(read).transpose()?;
    let mut kept = Vec::new();
    for path in &arguments.keep {
        kept.extend(read(path)?);
    }
    let workspace = match &arguments.over {
        Over::Limits => None,
        Over::Tasks(path) => Some(read(path)?),
        Over::Box(corners) => Some(workspace_in(&model.robot, corners, arguments.seed)?),
    };
    let options = PlanOptions {
        fit: fit(arguments)?,
        criterion: arguments.criterion,
        list,
        workspace,
        judge: arguments.judge.map(|count| count as usize),
        kept,
        seed: arguments.seed,
        ..PlanOptions::default()
    };
    let found = planned(&model.robot, &options)?;
    let report = report::Plan::new(&model, &options, &found);
    let table = planned_table(&model.robot, &found.rows, &report.comments())?;
    let written = place.is_some();
    let is_data = !written && !arguments.json;
    if written {
        console.deliver(table.clone(), place)?;
    }
    if arguments.json {
        console.data(&report::json(&report)?)?;
    } else {
        let mut text = report.text();
        if let Some(path) = arguments.place.out.as_ref().filter(|_| written) {
            text.push_str(&labelled("written", &shown(path)));
        }
        if is_data {
            console.note(text);
            console.data(&table)?;
        } else {
            console.say(&text)?;
        }
    }
    Ok(DONE)
}

/// Joint readings of a file.
fn readings(path: &PathBuf, model: &Model, options: &ReadOptions, console: &Console) -> Result<Vec<f64>> {
    let joints = read_joints(path, &model.robot, options)?;
    console.warnings(&joints.warnings);
    Ok(joints.readings)
}

/// The fit that will be made.
fn fit(arguments: &Plan) -> Result<PlannedFit> {
    let tolerance = match &arguments.tolerance {
        BelievedTolerance::None => Some(Tolerance::WIDE),
        BelievedTolerance::Given(tolerance) => Some(*tolerance),
        BelievedTolerance::Auto | BelievedTolerance::Of(_) => {
            return ErrorKind::Option.refuse("found a --tolerance that measurements or a controller decide, expected an angle and a length, like 0.5deg,5mm, or none");
        }
    };
    let default_nest = [0.05, 0.0, 0.0];
    let offset = arguments.target_offset.or((arguments.targets > 1).then_some(default_nest));
    Ok(PlannedFit {
        session: PlannedSession {
            kind: arguments.measure,
            noise: Noise::new(arguments.sigma_position, arguments.sigma_rotation),
            device_free: arguments.frame == DeviceFrameKnowledge::Unknown,
        },
        count: arguments.count as usize,
        tolerance,
        corrections: arguments.corrections,
        gravity: arguments.gravity.into(),
        robot_error_m: arguments.robot_error,
        targets: arguments.targets as usize,
        target_offset: offset.map(Into::into),
    })
}
