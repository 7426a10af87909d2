//! `poecal plan`: which configurations to measure, how many, and what error to expect.

use std::path::PathBuf;

use poecal::analysis::PlannedSession;
use poecal::calibration::DeviceFrameKnowledge;
use poecal::io::measurements::{ReadOptions, planned_table, read_joints};
use poecal::io::model::{Model, ModelSource};
use poecal::io::output::{Existing, FilePlace};
use poecal::io::plan_program::plan_program;
use poecal::io::shapes::capsules;
use poecal::measurement::{Noise, Quantity};
use poecal::plan::{Conditions, PlanOptions, PlannedFit, Sight, plan as planned, workspace_in};
use poecal::robot::Tolerance;
use poecal::simulate::Kind;
use poecal::{ErrorKind, Result, report};

use crate::DONE;
use crate::args::{FitArgs, Plan};
use crate::console::Console;
use crate::quantity::{BelievedTolerance, Over};
use crate::style::{labelled, shown};

pub(crate) fn plan(arguments: &Plan, console: &Console) -> Result<u8> {
    let files = arguments.candidates.iter().chain(&arguments.keep).map(PathBuf::as_path);
    let inputs: Vec<_> = std::iter::once(arguments.model.as_path()).chain(files).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let existing = Existing::forced(arguments.place.force);
    let program = arguments.program.as_ref();
    let program =
        program.map(|path| FilePlace::reserve(path, existing, &inputs, &mut console.warner())).transpose()?;
    let options = arguments.columns.options();
    let model = Model::read(&arguments.model, &arguments.chain.selection(options.as_ref().ok())?)?;
    let reading = model.reads(options?);
    let read = |path: &PathBuf| readings(path, &model, &reading, console);
    let list = arguments.candidates.as_ref().map(read).transpose()?;
    let mut kept = Vec::new();
    for path in &arguments.keep {
        kept.extend(read(path)?);
    }
    let width = model.robot.reading_names().len().max(1);
    let rows = kept.len() / width;
    let mut avoided = Vec::new();
    for &row in &arguments.replace {
        if !(1..=rows).contains(&(row as usize)) {
            return ErrorKind::Option.refuse(format!(
                "found row {row} to replace, expected one of the {rows} rows of --keep, counted from 1"
            ));
        }
        let at = (row as usize - 1) * width;
        avoided.extend_from_slice(&kept[at..at + width]);
    }
    if !arguments.replace.is_empty() {
        let stays = |row: &usize| !arguments.replace.contains(&u32::try_from(row + 1).unwrap_or(u32::MAX));
        kept =
            (0..rows).filter(stays).flat_map(|row| kept[row * width..(row + 1) * width].to_vec()).collect();
    }
    let is_replacing = !arguments.replace.is_empty();
    let count = if is_replacing { u32::try_from(rows).unwrap_or(u32::MAX) } else { arguments.count };
    let judge = if is_replacing { Some(0) } else { arguments.judge };
    let workspace = match &arguments.over {
        Over::Limits => None,
        Over::Tasks(path) => Some(read(path)?),
        Over::Box(corners) => Some(workspace_in(&model.robot, corners, arguments.seed)?),
    };
    // A nest of several beside the flange.
    let nest = [0.05, 0.0, 0.0];
    let offset = arguments.target_offset.or((arguments.targets > 1).then_some(nest));
    let options = PlanOptions {
        fit: PlannedFit {
            targets: arguments.targets as usize,
            target_offset: offset.map(Into::into),
            ..fit(&arguments.fit, &model, arguments.measure, count)?
        },
        criterion: arguments.criterion,
        list,
        workspace,
        judge: judge.map(|count| count as usize),
        avoided,
        kept,
        conditions: conditions(arguments, &model, console),
        seed: arguments.seed,
        ..PlanOptions::default()
    };
    let found = planned(&model.robot, &options)?;
    let report = report::Plan::new(&model, &options, &found);
    let table = planned_table(&model.robot, &found.rows, &report.comments())?;
    let as_program = arguments.program.as_ref();
    let as_program = as_program.map(|path| plan_program(path, &model.robot, &found.rows)).transpose()?;
    if let Some((place, text)) = program.zip(as_program) {
        place.write(vec![text.into()])?;
    }
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
            // The list is on standard output.
            text.lines().filter(|line| !line.is_empty()).for_each(|line| console.note(line));
            console.data(&table)?;
        } else {
            console.say(&text)?;
        }
    }
    Ok(DONE)
}

/// Joint readings of a file.
pub(super) fn readings(
    path: &PathBuf,
    model: &Model,
    options: &ReadOptions,
    console: &Console,
) -> Result<Vec<f64>> {
    let joints = read_joints(path, &model.robot, options)?;
    console.warnings(&joints.warnings);
    Ok(joints.readings)
}

/// The fit that will be made of so many configurations of a kind.
pub(super) fn fit(arguments: &FitArgs, model: &Model, kind: Kind, count: u32) -> Result<PlannedFit> {
    let tolerance = match &arguments.tolerance {
        BelievedTolerance::None => Some(Tolerance::WIDE),
        BelievedTolerance::Given(tolerance) => Some(*tolerance),
        BelievedTolerance::Auto | BelievedTolerance::Of(_) => {
            return ErrorKind::Option.refuse("found a --tolerance that measurements or a controller decide, expected an angle and a length, like 0.5deg,5mm, or none");
        }
    };
    Ok(PlannedFit {
        session: PlannedSession {
            kind,
            noise: Noise::new(arguments.sigma_position, arguments.sigma_rotation),
            device_free: arguments.frame == DeviceFrameKnowledge::Unknown,
        },
        count: count as usize,
        tolerance,
        corrections: arguments.corrections,
        gravity: arguments.gravity.into(),
        robot_error_m: arguments.robot_error.or_else(|| found_error_m(model)),
        ..PlannedFit::default()
    })
}

/// The error that a calibration of this robot left, if the model is one: of rows that were held out, else of those fitted.
fn found_error_m(model: &Model) -> Option<f64> {
    let ModelSource::Calibration(file) = &model.source else { return None };
    let set = file.accuracy.held_out.as_ref().unwrap_or(&file.accuracy.training);
    set.calibrated.get(Quantity::Position).map(|it| it.rms)
}

/// What a configuration must fulfil.
fn conditions(arguments: &Plan, model: &Model, console: &Console) -> Conditions {
    let it = &arguments.conditions;
    let capsules = match &model.source {
        ModelSource::Urdf(urdf) if it.self_collision => {
            let (capsules, notes) = capsules(urdf, &model.path);
            notes.iter().for_each(|note| console.remark(note));
            capsules
        }
        ModelSource::Urdf(_) | ModelSource::Toml | ModelSource::Calibration(_) => Vec::new(),
    };
    let sight = it.device.map(|place| Sight {
        place: place.into(),
        cone: it.cone.map(|half| (it.device_looks_at.unwrap_or_default().into(), half)),
        distance_m: it.distance.unwrap_or([0.0, f64::INFINITY]),
        acceptance_rad: it.acceptance,
        facing: it.facing.unwrap_or([0.0, 0.0, 1.0]).into(),
    });
    Conditions {
        margin: [it.margin.angle_rad, it.margin.length_m],
        keep_out: it.keep_out.clone(),
        floor_m: it.floor,
        separation_rad: it.separation.unwrap_or(0.0),
        sight,
        capsules,
    }
}
