//! `poecal plan`: choice and number of configurations to measure, and the expected error.

use std::path::PathBuf;

use poecal_calibrate::DeviceFrameKnowledge;
use poecal_fit::analysis::PlannedSession;
use poecal_import::{ReadOptions, planned_table, read_joints, test_table};
use poecal_model::measurement::Noise;
use poecal_model::robot::Tolerance;
use poecal_model::simulate::SessionKind;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_plan::plan::{Conditions, DeviceView, PlanOptions, PlannedFit, plan as planned, test_cube, workspace_in};
use poecal_report as report;
use poecal_results::model::Model;
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_results::plan_program::plan_program;
use poecal_results::shapes::capsules_of;

use super::identify::identify;
use super::models::read_model;
use super::visits::{VisitSettings, VisitedCalibration};
use crate::DONE;
use crate::args::{FitArgs, PlanArgs, PlannedDevice, TextOutput};
use crate::console::Console;
use crate::quantity::{BelievedTolerance, WorkspaceChoice};
use crate::style::{label_paragraph, printable_path};

pub(crate) fn plan(arguments: &PlanArgs, console: &Console) -> Result<u8> {
    if !arguments.rows.is_empty() {
        return identify(arguments, console);
    }
    refuse_pictures(arguments)?;
    choose_configurations(arguments, console)
}

/// Chooses configurations.
fn choose_configurations(arguments: &PlanArgs, console: &Console) -> Result<u8> {
    let files = arguments.candidates.iter().chain(&arguments.keep_rows).map(PathBuf::as_path);
    let files = files.chain(arguments.visits.reference.iter().map(PathBuf::as_path));
    let inputs: Vec<_> = std::iter::once(arguments.model.as_path()).chain(files).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let existing = ExistingFiles::from_switch(arguments.place.force);
    let reserved = |path: &PathBuf| ReservedFile::reserve(path, existing, &inputs, &mut console.warner());
    let program = arguments.program.as_ref().map(reserved).transpose()?;
    match arguments.purpose.as_deref() {
        Some("iso9283") => return iso9283(arguments, place, program, console),
        Some(_) => return visits(arguments, place, console),
        None => {}
    }
    let page = arguments.report.as_ref().map(reserved).transpose()?;
    let options = arguments.columns.options();
    let model = read_model(&arguments.model, &arguments.chain.selection(options.as_ref().ok())?, console)?;
    console.warnings(&Vec::from_iter(model.robot.placeholder_limits()));
    let reading = model.reads(options?);
    let read = |path: &PathBuf| readings(path, &model, &reading, console);
    let list = arguments.candidates.as_ref().map(read).transpose()?;
    let mut kept = Vec::new();
    for path in &arguments.keep_rows {
        let joints = read_joints(path, &model.robot, &reading)?;
        console.warnings(&joints.warnings);
        kept.extend(joints.planned_rows());
    }
    let rows = kept.len();
    let replaced = replaced_rows(&arguments.replace_rows, rows)?;
    let workspace = match &arguments.workspace {
        WorkspaceChoice::Limits => None,
        WorkspaceChoice::Tasks(path) => Some(read(path)?),
        WorkspaceChoice::Box(corners) => Some(workspace_in(&model.robot, corners, arguments.seed)?),
    };
    let fit = fit(&arguments.fit, &model, arguments.kind, arguments.count)?;
    let options = PlanOptions {
        fit: fit.with_targets(arguments.targets as usize, arguments.target_offset),
        criterion: arguments.criterion,
        list,
        workspace,
        judge: arguments.held_out_count.map(|count| count as usize),
        kept,
        replaced,
        conditions: conditions(arguments, &model, console)?,
        seed: arguments.seed,
        ..PlanOptions::default()
    };
    let found = planned(&model.robot, &options)?;
    let report = report::PlanReport::new(&model, &options, &found, arguments.stop.as_secs_f64());
    let table = planned_table(&model.robot, &found)?;
    let as_program = arguments.program.as_ref();
    let as_program = as_program.map(|path| plan_program(path, &model.robot, &found.rows)).transpose()?;
    if let Some((place, text)) = program.zip(as_program) {
        place.write(vec![text.into()])?;
    }
    if let Some(page) = page {
        page.write(report::plan_page(&model, &options, &found, &report))?;
    }
    let text = if arguments.json { report::json(&report)? } else { report.text() };
    deliver(&arguments.place, (table, place), (text, arguments.json), console)
}

/// Refuses pictures that no rows name.
fn refuse_pictures(arguments: &PlanArgs) -> Result<()> {
    if arguments.cameras.files().next().is_some() || !arguments.cameras.markers.is_empty() {
        return ErrorKind::Option.refuse(
            "found --camera or --markers without --rows, expected both with pictures that were taken, --rows FILE",
        );
    }
    Ok(())
}

/// The rows to replace among so many, counted from 0.
fn replaced_rows(replace: &[u32], rows: usize) -> Result<Vec<usize>> {
    if let Some(row) = replace.iter().find(|&&row| !(1..=rows).contains(&(row as usize))) {
        return ErrorKind::Option.refuse(format!(
            "found row {row} to replace, expected one of the {rows} rows of --keep-rows, counted from 1"
        ));
    }
    Ok(replace.iter().map(|&row| row as usize - 1).collect())
}

/// The poses of a test of ISO 9283.
fn iso9283(
    arguments: &PlanArgs,
    place: Option<ReservedFile>,
    program: Option<ReservedFile>,
    console: &Console,
) -> Result<u8> {
    let visits = &arguments.visits;
    let is_of_visits = !visits.reference.is_empty() || visits.tool.is_some() || visits.repeatability.is_some();
    if is_of_visits || arguments.candidates.is_some() || arguments.conditions.device.is_some() {
        return ErrorKind::Option.refuse(
            "found --purpose iso9283 with an option of visits, expected --workspace, --floor-height, --count, --program, --out and links alone",
        );
    }
    let stated = match &arguments.workspace {
        WorkspaceChoice::Limits => None,
        WorkspaceChoice::Box(corners) => Some(*corners),
        WorkspaceChoice::Tasks(_) => {
            return ErrorKind::Option
                .refuse("--workspace: found a file, expected a cube or a plane with --purpose iso9283, like 800,-200,300:1200,200,700mm");
        }
    };
    let model = read_model(&arguments.model, &arguments.chain.selection(None)?, console)?;
    console.warnings(&Vec::from_iter(model.robot.placeholder_limits()));
    let cube = test_cube(&model.robot, stated, arguments.conditions.floor_height)?;
    let cycles = arguments.count as usize;
    let rows = cube.rows(cycles);
    let as_program = arguments.program.as_ref().map(|path| plan_program(path, &model.robot, &rows)).transpose()?;
    if let Some((place, text)) = program.zip(as_program) {
        place.write(vec![text.into()])?;
    }
    let told = report::TestPlan::new(&cube, cycles);
    let text = if arguments.json { report::json(&told)? } else { told.text() };
    deliver(&arguments.place, (test_table(&model.robot, &cube, cycles)?, place), (text, arguments.json), console)
}

/// Configurations of visits to a calibrated robot.
fn visits(arguments: &PlanArgs, place: Option<ReservedFile>, console: &Console) -> Result<u8> {
    let links = &arguments.chain.chain;
    let has_links = links.base_link.is_some() || links.tip_link.is_some();
    if has_links
        || arguments.program.is_some()
        || arguments.conditions.floor_height.is_some()
        || !matches!(arguments.workspace, WorkspaceChoice::Limits)
    {
        return ErrorKind::Option
            .refuse("found --workspace, --program, --floor-height or links with --purpose drift, expected none of them: a calibration.json has its configurations");
    }
    let device_is_known = match arguments.conditions.device {
        None => None,
        Some(PlannedDevice::IsKnown(is_known)) => Some(is_known),
        Some(PlannedDevice::At(_)) => {
            return ErrorKind::Option.refuse("--device: found a place, expected known or refit with --purpose drift");
        }
    };
    let stated = VisitSettings {
        calibration: &arguments.model,
        reference: &arguments.visits.reference,
        meaning: arguments.columns.options()?,
        device_is_known,
        tool_is_anew: arguments.visits.tool.unwrap_or(false),
        repeatability_m: arguments.visits.repeatability,
    };
    let visited = VisitedCalibration::read(stated, console)?;
    let count = arguments.count as usize;
    let (told, table) = visited.plan_visit("--purpose drift", count, None, arguments.candidates.as_ref())?;
    let text = if arguments.json { report::json(&told)? } else { told.text() };
    deliver(&arguments.place, (table, place), (text, arguments.json), console)
}

/// Delivers a list and its remarks.
fn deliver(
    out: &TextOutput,
    (table, place): (String, Option<ReservedFile>),
    (mut text, is_json): (String, bool),
    console: &Console,
) -> Result<u8> {
    let written = place.is_some();
    if written {
        console.deliver(table.clone(), place)?;
    }
    if is_json {
        console.data(&text)?;
    } else if written {
        if let Some(path) = &out.out {
            text.push_str(&label_paragraph("written", &printable_path(path)));
        }
        console.say(&text)?;
    } else {
        // The list is on standard output.
        text.lines().filter(|line| !line.is_empty()).for_each(|line| console.note(line));
        console.data(&table)?;
    }
    Ok(DONE)
}

/// Joint readings of a file.
pub(super) fn readings(path: &PathBuf, model: &Model, options: &ReadOptions, console: &Console) -> Result<Vec<f64>> {
    let joints = read_joints(path, &model.robot, options)?;
    console.warnings(&joints.warnings);
    Ok(joints.readings)
}

/// The planned fit of so many configurations of a kind.
pub(super) fn fit(arguments: &FitArgs, model: &Model, kind: SessionKind, count: u32) -> Result<PlannedFit> {
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
            device_free: arguments.device_frame == DeviceFrameKnowledge::Unknown,
        },
        count: count as usize,
        tolerance,
        corrections: arguments.corrections,
        gravity: arguments.gravity.into(),
        robot_error: arguments.robot_error.or_else(|| model.left_error()),
        ..PlannedFit::default()
    })
}

/// Conditions on a configuration.
fn conditions(arguments: &PlanArgs, model: &Model, console: &Console) -> Result<Conditions> {
    let it = &arguments.conditions;
    let (capsules, notes) = if it.self_collision { capsules_of(model) } else { Default::default() };
    notes.iter().for_each(|note| console.remark(note));
    let device = match it.device {
        Some(PlannedDevice::IsKnown(_)) => {
            return ErrorKind::Option.refuse(
                "--device: found known or refit, expected a place like 1500,0,800mm, or --purpose drift, which plans visits to a calibrated robot",
            );
        }
        Some(PlannedDevice::At(place)) => Some(place),
        None => None,
    };
    let sight = device.map(|place| DeviceView {
        place: place.into(),
        cone: it.device_half_angle.map(|half| (it.device_aim.unwrap_or_default().into(), half)),
        distance_m: it.distance.unwrap_or([0.0, f64::INFINITY]),
        acceptance_rad: it.target_half_angle,
        facing: it.target_normal.unwrap_or([0.0, 0.0, 1.0]).into(),
    });
    Ok(Conditions {
        margin: it.margin.as_ref().map(|margin| [margin.angle_rad, margin.length_m]),
        keep_out: it.keep_out.clone(),
        floor_m: it.floor_height,
        separation_rad: it.separation.unwrap_or(0.0),
        sight,
        capsules,
    })
}
