//! The nominal and the actual arm as arrays of C, for kinematics on a controller.

use std::fmt::Write as _;

use nalgebra::DMatrix;
use poecal_arm::Arm;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::{CONFIGURATIONS, ExportedRobot, export_error, unreadable_error};
use crate::model::{Model, ModelSource};
use poecal_arm::lie::rotation;
use poecal_formats::proof::Difference;
use poecal_model::robot::{ControllerMap, JointKind, Robot};
use poecal_model::simulate::Configurations;
use poecal_numerics::error::Result;
use poecal_storage::numbers::format_shortest;

/// Distance (m) and angle (rad) below which two computations of a pose are the same but for rounding.
const ROUNDING: f64 = 1e-12;

/// Writes the arms, and reads them back.
pub(crate) fn write(model: &Model) -> Result<ExportedRobot> {
    let actual = &model.robot;
    let factors: Vec<f64> = actual.factors.iter().map(|it| it.reference).collect();
    let mut notes = Vec::new();
    if !factors.is_empty() {
        let names: Vec<&str> = actual.factors.iter().map(|it| it.name.as_str()).collect();
        notes.push(format!("the factors {} are at their references in this form", names.join(", ")));
    }
    let mut text = header(actual);
    if let Some(controller) = model.sums() {
        let (_, readings) = actual.arm_model(&factors)?;
        text.push_str(&write_functions(&controller.controller_map()?, &readings));
    }
    let nominal = match &model.source {
        ModelSource::Calibration(file) => Some(file.taught_robot(actual)?.robot),
        ModelSource::Urdf(_) | ModelSource::Toml => None,
    };
    let mut remains = Difference { position_m: 0.0, rotation_rad: 0.0 };
    let arms = [("nominal", nominal.as_ref()), ("actual", Some(actual))];
    for (name, robot) in arms.into_iter().filter_map(|(name, robot)| Some((name, robot?))) {
        let of = if name == "actual" { &factors[..] } else { &[] };
        let (arm, _) = robot.arm_model(of)?;
        array(&mut text, name, &arm.numbers());
        let found = compare_array(robot, of, &text, name)?;
        remains.position_m = remains.position_m.max(found.position_m);
        remains.rotation_rad = remains.rotation_rad.max(found.rotation_rad);
    }
    if !remains.is_within(ROUNDING * actual.reach_m().max(1.0), ROUNDING) {
        let message = format!(
            "the numbers read back differ by {:.1e} m and {:.1e} rad, expected rounding alone: nothing was written",
            remains.position_m, remains.rotation_rad
        );
        return Err(export_error(message));
    }
    notes.extend(super::left_out(actual));
    Ok(ExportedRobot { text, notes, remains, beside: None })
}

fn header(robot: &Robot) -> String {
    let units = |name: &str| {
        let joint = robot.joints.iter().find(|joint| joint.reading.name == name && joint.give_of.is_none());
        if joint.is_some_and(|it| it.kind == JointKind::Prismatic) { "m" } else { "rad" }
    };
    let readings: Vec<String> = robot
        .joint_reading_names()
        .iter()
        .map(|name| format!("{} [{}]", name.replace("*/", "* /"), units(name)))
        .collect();
    format!(
        "/* Arms for poecal_arm_new() of poecal.h, in the order that poecal-arm documents (Model::numbers).\n   Readings: {}. */\n",
        readings.join(", ")
    )
}

/// Functions from the controller's counts to the readings of the arms, and back.
fn write_functions(counting: &ControllerMap, readings: &[usize]) -> String {
    let function = |name: &str, (from, to): (&str, &str), row: &dyn Fn(usize) -> String| {
        let lines = (0..readings.len()).map(|at| format!("  {to}[{at}] = {};\n", row(at)));
        format!("static inline void {name}(const double *{from}, double *{to}) {{\n{}}}\n", lines.collect::<String>())
    };
    let term = |factor: f64, of: String| match factor {
        0.0 => String::new(),
        1.0 => format!(" + {of}"),
        -1.0 => format!(" - {of}"),
        _ => format!(" + {} * {of}", format_shortest(factor)),
    };
    let sum = |matrix: &DMatrix<f64>, row: usize, of: &dyn Fn(usize) -> String| -> String {
        let terms = readings.iter().enumerate().map(|(at, &it)| term(matrix[(readings[row], it)], of(at)));
        let words: String = terms.collect();
        words.strip_prefix(" + ").map_or(format!("0.0{words}"), str::to_owned)
    };
    let offset = |at: usize| counting.offsets()[readings[at]];
    let to = |row: usize| {
        sum(counting.matrix(), row, &|at| format!("counted[{at}]")) + &term(1.0, format_shortest(offset(row)))
    };
    let back = |row: usize| {
        sum(counting.inverse(), row, &|at| match offset(at) {
            0.0 => format!("readings[{at}]"),
            offset => format!("(readings[{at}] - {})", format_shortest(offset)),
        })
    };
    let names: Vec<String> = readings.iter().map(|&at| counting.names()[at].replace("*/", "* /")).collect();
    format!(
        "/* The controller counts, in rad and m: {}. */\n{}{}",
        names.join(", "),
        function("poecal_readings", ("counted", "readings"), &to),
        function("poecal_counted", ("readings", "counted"), &back)
    )
}

fn array(text: &mut String, name: &str, numbers: &[f64]) {
    let _ = write!(text, "static const double poecal_{name}[{}] = {{", numbers.len());
    for (index, number) in numbers.iter().enumerate() {
        text.push_str(if index % 6 == 0 { "\n  " } else { " " });
        text.push_str(&format_shortest(*number));
        text.push(',');
    }
    text.push_str("\n};\n");
}

/// Reads an array, and compares its arm with the robot.
fn compare_array(robot: &Robot, factors: &[f64], text: &str, name: &str) -> Result<Difference> {
    let body = text.split_once(&format!("poecal_{name}[")).and_then(|(_, rest)| rest.split_once('{'));
    let body = body.and_then(|(_, rest)| rest.split_once('}')).map(|(body, _)| body);
    let numbers = body.unwrap_or_default().split(',').map(str::trim).filter(|it| !it.is_empty());
    let numbers: Option<Vec<f64>> = numbers.map(|it| it.parse().ok()).collect();
    let arm = numbers.and_then(|numbers| Arm::from_numbers(&numbers));
    let arm = arm.ok_or_else(|| unreadable_error("numbers that are no arm, since a reading moves nothing"))?;
    let (_, readings) = robot.arm_model(factors)?;
    let count = robot.joint_reading_names().len();
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut largest = Difference { position_m: 0.0, rotation_rad: 0.0 };
    let configurations = Configurations::new(robot);
    for _ in 0..CONFIGURATIONS {
        let mut all = configurations.random(&mut generator);
        all.truncate(count);
        // Joints of other branches are at zero.
        for (index, it) in all.iter_mut().enumerate() {
            *it = if readings.contains(&index) { *it } else { 0.0 };
        }
        let q: Vec<f64> = readings.iter().filter_map(|&at| all.get(at).copied()).collect();
        all.extend_from_slice(factors);
        let (one, other) = (robot.forward_kinematics(&all), arm.forward_kinematics(&q));
        let turn = rotation::log(&(one.rotation.transpose() * other.rotation)).norm();
        largest.position_m = largest.position_m.max((one.translation - other.translation).norm());
        largest.rotation_rad = largest.rotation_rad.max(turn);
    }
    Ok(largest)
}
