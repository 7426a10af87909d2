//! `poecal compensate`: programs for the nominal robot, corrected for the actual one.

use std::path::{Path, PathBuf};

use poecal_calibrate::AcceptedModel;
use poecal_compensate::{
    ChangeOptions, Language, ProgramOptions, StatedFrames, TableOptions, compensate_file, compensate_table,
};
use poecal_formats::urdf::ChainSelection;
use poecal_model::robot::{JointKind, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_results::calibration_file::{ControllerCounts, TaughtRobot};
use poecal_results::model::{Model, ModelSource};
use poecal_results::output::ReservedFile;

use crate::args::{Compensate, ProgramLanguage};
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn compensate(arguments: &Compensate, console: &Console) -> Result<u8> {
    let mapping = arguments.columns.columns.iter();
    let inputs = [&arguments.calibration, &arguments.program];
    let inputs: Vec<&Path> = inputs.into_iter().chain(mapping).map(PathBuf::as_path).collect();
    let place = if arguments.dry_run { None } else { arguments.place.reserve(&inputs, console)? };
    let model = Model::read(&arguments.calibration, &ChainSelection::default())?;
    let model = if arguments.of == AcceptedModel::Corrected { model.corrected_model()? } else { model };
    let ModelSource::Calibration(file) = &model.source else {
        return Err(ErrorKind::Option
            .error("found a robot model, expected a calibration.json, which has the nominal robot and the actual one")
            .in_file(&arguments.calibration));
    };
    file.gain_doubt().into_iter().for_each(|doubt| console.warning(doubt));
    let worse = arguments.require_gain && !file.has_clear_gain();
    let taught = file.taught_robot(&model.robot)?;
    let factors = factors(&model.robot, &arguments.factors, console)?;
    let robots = (&taught.robot, &model.robot);
    if let Some(language) = language(arguments)? {
        let counted = file.controller_counts(&taught.robot, arguments.third_axis)?;
        let robots = (&taught, &model.robot);
        let code = robot_program(arguments, language, robots, &factors, counted, place, console)?;
        return Ok(if worse { WORSE } else { code });
    }
    if let Some(stated) = arguments.third_axis {
        return ErrorKind::Option.refuse(format!(
            "found --third-axis {0} for a table, expected it for programs of FANUC (.ls): write `third_axis = \"{0}\"` into a mapping \
             (--columns)",
            stated.word()
        ));
    }
    let read = model.reads(arguments.columns.options()?);
    let options = TableOptions { read, check: arguments.check, change: change(arguments), each: arguments.json };
    let is_told = place.is_some() || arguments.dry_run;
    let (summary, table) = match place {
        Some(place) => place.write_by(|out| compensate_table(&arguments.program, robots, &factors, &options, out))?,
        None => compensate_table(&arguments.program, robots, &factors, &options, &mut |piece| {
            if arguments.dry_run { Ok(()) } else { console.data(piece) }
        })?,
    };
    console.warnings(&table.warnings);
    console.warnings(&summary.warnings());
    if is_told {
        let slides = |name: &str| is_sliding(&taught.robot, name);
        let what = if summary.rows == 1 { "row corrected" } else { "rows corrected" };
        console.json_or_table(arguments.json, || report::json(&summary), || summary.text(&slides, what))?;
    }
    Ok(if summary.is_whole() && !worse { DONE } else { WORSE })
}

/// Largest permitted changes of readings.
fn change(arguments: &Compensate) -> ChangeOptions {
    ChangeOptions { most_change: arguments.max_correction, nearest: arguments.nearest }
}

fn is_sliding(robot: &Robot, name: &str) -> bool {
    let joint = robot.joints.iter().find(|joint| joint.reading.name == name);
    joint.is_some_and(|joint| joint.kind == JointKind::Prismatic)
}

/// The language of a robot program; `None` for a table.
fn language(arguments: &Compensate) -> Result<Option<Language>> {
    match arguments.language {
        Some(ProgramLanguage::Table) => Ok(None),
        Some(ProgramLanguage::Robot(language)) => Ok(Some(language)),
        None => Language::of_name(&arguments.program),
    }
}

fn robot_program(
    arguments: &Compensate,
    language: Language,
    (taught, actual): (&TaughtRobot, &Robot),
    factors: &[f64],
    counted: ControllerCounts,
    place: Option<ReservedFile>,
    console: &Console,
) -> Result<u8> {
    let columns = &arguments.columns;
    let unused = columns.columns.as_ref().map(|_| "--columns").or(columns.units.as_ref().map(|_| "--units"));
    if let Some(option) = unused {
        return ErrorKind::Option.refuse(format!(
            "found {option} for a program in {}, expected it for tables (CSV) alone: programs state what the controller counted in the \
             calibration's mapping",
            language.title()
        ));
    }
    if arguments.third_axis.is_some() && language != Language::Fanuc {
        return ErrorKind::Option
            .refuse(format!("found --third-axis for a program in {}, expected one of FANUC", language.title()));
    }
    let options = ProgramOptions {
        language,
        given: read_stated_frames(arguments, language)?.with_taught_frames(&taught.base, &taught.tool),
        check: arguments.check,
        change: change(arguments),
        each: arguments.json,
        controller: counted.controller,
        is_third_axis_open: counted.is_third_axis_open,
    };
    let (out, summary) = compensate_file(&arguments.program, (&taught.robot, actual), factors, &options)?;
    let is_told = place.is_some() || arguments.dry_run;
    match place {
        Some(place) => place.write_bytes(&out)?,
        None if arguments.dry_run => {}
        None => console.bytes(&out)?,
    }
    console.warnings(&summary.changes.warnings());
    if is_told {
        let slides = |name: &str| is_sliding(&taught.robot, name);
        console.json_or_table(arguments.json, || report::json(&summary), || summary.text(&slides))?;
    }
    Ok(if summary.is_whole() { DONE } else { WORSE })
}

/// Tools and frames as stated on the command line.
fn read_stated_frames(arguments: &Compensate, language: Language) -> Result<StatedFrames> {
    let mut given = StatedFrames::default();
    for words in &arguments.tool_data {
        given.add_tool(words, language)?;
    }
    for words in &arguments.work_objects {
        given.add_frame(words, language)?;
    }
    if let Some(words) = &arguments.controller_base {
        given.set_base(words, language)?;
    }
    if let Some(words) = &arguments.controller_flange {
        given.set_flange(words, language)?;
    }
    if let Some(words) = &arguments.start {
        given.set_start(words, language)?;
    }
    Ok(given)
}

/// Values of a robot's factors: the stated ones, else their references.
fn factors(robot: &Robot, stated: &[String], console: &Console) -> Result<Vec<f64>> {
    let names: Vec<&str> = robot.factors.iter().map(|it| it.name.as_str()).collect();
    let mut values: Vec<f64> = robot.factors.iter().map(|it| it.reference).collect();
    let mut is_stated = vec![false; values.len()];
    for text in stated {
        let found = text.split_once('=').and_then(|(name, value)| {
            let index = names.iter().position(|it| *it == name.trim())?;
            Some((index, value.trim().parse::<f64>().ok().filter(|it| it.is_finite())?))
        });
        let Some((index, value)) = found else {
            let known = if names.is_empty() { "this model has no factors".to_owned() } else { names.join(", ") };
            return ErrorKind::Option
                .refuse(format!("found --factors {text}, expected NAME=VALUE with a factor of the model: {known}"));
        };
        values[index] = value;
        is_stated[index] = true;
    }
    for (factor, _) in robot.factors.iter().zip(is_stated).filter(|(_, is_stated)| !is_stated) {
        console.remark(format!(
            "factor `{}` is taken to be {}: state it by --factors {}=VALUE",
            factor.name, factor.reference, factor.name
        ));
    }
    Ok(values)
}
