//! `poecal compensate`: programs for the nominal robot, corrected for the actual one.

use std::path::{Path, PathBuf};

use poecal::compensate::{TableOptions, compensate_table};
use poecal::io::model::{Model, ModelSource};
use poecal::io::urdf::ChainSelection;
use poecal::robot::JointKind;
use poecal::{Error, ErrorKind, Result, Robot, report};

use crate::DONE;
use crate::args::{Compensate, PredictedModel};
use crate::console::Console;

pub(crate) fn compensate(arguments: &Compensate, console: &Console) -> Result<u8> {
    let mapping = arguments.columns.columns.iter();
    let inputs = [&arguments.calibration, &arguments.program];
    let inputs: Vec<&Path> = inputs.into_iter().chain(mapping).map(PathBuf::as_path).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let model = Model::read(&arguments.calibration, &ChainSelection::default())?;
    let model = match arguments.of {
        PredictedModel::Corrected => model.corrected()?,
        PredictedModel::Calibrated => model,
    };
    let ModelSource::Calibration(file) = &model.source else {
        let message = "found a robot model, expected a calibration.json, which has the nominal robot and the actual one";
        return Err(Error::new(ErrorKind::Option, message).in_file(&arguments.calibration));
    };
    let nominal = file.nominal_robot()?;
    let factors = factors(&model.robot, &arguments.factors, console)?;
    let options = TableOptions {
        read: arguments.columns.options()?,
        check: arguments.check,
        nearest: arguments.nearest,
    };
    let is_file = place.is_some();
    let robots = (&nominal, &model.robot);
    let (summary, table) = match place {
        Some(place) => {
            place.write_by(|out| compensate_table(&arguments.program, robots, &factors, &options, out))?
        }
        None => compensate_table(&arguments.program, robots, &factors, &options, &mut |piece| {
            console.data(piece)
        })?,
    };
    console.warnings(&table.warnings);
    console.warnings(&summary.warnings());
    if is_file {
        let slides = |name: &str| {
            let joint = nominal.joints.iter().find(|joint| joint.reading.name == name);
            joint.is_some_and(|joint| joint.kind == JointKind::Prismatic)
        };
        console.json_or_table(arguments.json, || report::json(&summary), || summary.text(&slides, "rows"))?;
    }
    Ok(DONE)
}

/// Values of a robot's factors: those that are stated, else their references.
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
            let known =
                if names.is_empty() { "this model has no factors".to_owned() } else { names.join(", ") };
            let message =
                format!("found --factor {text}, expected NAME=VALUE with a factor of the model: {known}");
            return Err(Error::new(ErrorKind::Option, message));
        };
        values[index] = value;
        is_stated[index] = true;
    }
    for (factor, _) in robot.factors.iter().zip(is_stated).filter(|(_, is_stated)| !is_stated) {
        console.remark(format!(
            "factor `{}` is taken to be {}: state it by --factor {}=VALUE",
            factor.name, factor.reference, factor.name
        ));
    }
    Ok(values)
}
