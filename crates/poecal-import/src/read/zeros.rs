//! Signs and zeros of joints whose readings are those of motors.

use std::f64::consts::TAU;

use crate::MeasurementFile;
use crate::table::motors::MotorReadings;
use poecal_fit::start::{JointZeros, find_zeros};
use poecal_formats::motors::TICKS;
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result, first_few, shorten_name};

/// Fewest rows by which signs and zeros are found.
const FEWEST_ROWS: usize = 8;
/// Smallest zero that is reported, rad.
const LEAST_RAD: f64 = 0.009;

/// Share of a motor's range by which a reading may be beyond it.
const BEYOND: f64 = 0.05;

/// Finds signs and zeros, changes the readings and the account of how they are made, and states what was found.
///
/// # Errors
/// [`ErrorKind::Measurement`] if a reading is far beyond the range of its motor.
pub(crate) fn settle_zeros(found: &mut MeasurementFile, robot: &Robot, motors: &MotorReadings) -> Result<()> {
    refuse_far_ticks(&found.data, motors)?;
    let rows = found.data.len();
    if rows < FEWEST_ROWS {
        found.warnings.push(format!(
            "found {rows} rows, and signs and zeros of motors need {FEWEST_ROWS}: the readings are taken as the file of the motors has them"
        ));
        return Ok(());
    }
    let Some(zeros) = find_zeros(&found.data, robot) else { return Ok(()) };
    found.data.change_readings(u32::try_from(rows).unwrap_or(u32::MAX), |readings| zeros.apply(readings));
    found.data.change_further(|readings| zeros.apply(readings));
    if let Some(controller) = &mut found.data.controller {
        controller.turn_and_shift(&zeros.signs, &zeros.zeros);
    }
    found.notes.push(words(&zeros, &robot.reading_names()));
    if !zeros.are_evident() {
        found.warnings.push(format!(
            "other signs of the joints explain the rows nearly as well ({:.1} mm instead of {:.1} mm): turn each joint by hand, and compare its \
             direction with the model",
            1e3 * zeros.other_m,
            1e3 * zeros.misfit_m
        ));
    }
    Ok(())
}

/// Refuses raw positions that the motors of the file cannot have.
fn refuse_far_ticks(data: &Dataset, motors: &MotorReadings) -> Result<()> {
    let readings = data.controller.iter().flat_map(|it| &it.readings).enumerate();
    for (at, reading) in readings {
        let Some((column, made)) = reading.columns.iter().next() else { continue };
        let Some([least, most]) = motors.range(&reading.reading) else { continue };
        if made.unit != "ticks" || made.factor != 1.0 {
            continue;
        }
        let margin = BEYOND * (most - least);
        for row in 0..data.len() {
            let ticks = ((data.readings(row)[at] - reading.offset) * TICKS / TAU).round();
            if !(least - margin..=most + margin).contains(&ticks) {
                let place = data.place(u32::try_from(row).unwrap_or(u32::MAX));
                return ErrorKind::Measurement.refuse(format!(
                    "found {ticks} ticks of `{column}` ({place}), expected {least} to {most}, the range of the motor: state the file of this arm, as it \
                     was when the positions were read"
                ));
            }
        }
    }
    Ok(())
}

/// Signs and zeros in words.
fn words(found: &JointZeros, names: &[String]) -> String {
    let turned = names.iter().zip(&found.signs).filter(|(_, sign)| **sign < 0.0);
    let turned: Vec<String> = turned.map(|(name, _)| shorten_name(name).to_string()).collect();
    let signs = match turned.len() {
        0 => "all joints count as in the model".to_owned(),
        1 => format!("{} counts the other way", turned[0]),
        _ => format!("{} count the other way", first_few(&turned)),
    };
    let zero = |(name, zero): (&String, &Option<f64>)| {
        let zero = zero.filter(|it| it.abs() > LEAST_RAD)?;
        Some(format!("{} {:+.1} deg", shorten_name(name), zero.to_degrees()))
    };
    let zeros: Vec<String> = names.iter().zip(&found.zeros).filter_map(zero).collect();
    let zeros = if zeros.is_empty() { String::new() } else { format!("; zeros: {}", zeros.join(", ")) };
    format!(
        "motors: {signs}{zeros}; so the nominal robot misses the rows by {:.1} mm (RMS), without by {:.1} mm",
        1e3 * found.misfit_m,
        1e3 * found.before_m
    )
}
