//! Units checked by the spread of measured positions, compared with the nominal model at the same configurations.

use nalgebra::Vector3;

use super::{DoubtLocation, InputDoubt, ReadColumn, format_short};
use poecal_arm::lie::Pose;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Mount, Robot};
use poecal_model::simulate::instrument_from_target;
use poecal_numerics::distributions::{median, median_point};
use poecal_numerics::named_unit::{NamedUnit, units_of};
use poecal_numerics::unit::Unit;

/// Largest number of rows of the comparison.
const ROWS: usize = 500;
/// Fewest rows for a spread.
const FEWEST_ROWS: usize = 4;
/// Least motion of the model's tip, as a share of its reach.
const SHARE_OF_REACH: f64 = 0.05;
/// Longer tools than the model's change the spread by less than this factor.
const FACTOR: f64 = 4.0;
/// Least factors by which positions in clearly another unit are too large or too small.
const THOUSANDS: [f64; 4] = [1e3, 1e-3, 1e6, 1e-6];
/// For a unit near the stated one: the ratio of spreads is below this factor, and the relative difference of paths between rows is below
/// this share.
const NEAR: f64 = 1.5;
const ALIKE: f64 = 0.3;
/// Angles in degrees below this may be radians of a full turn.
const FULL_TURN_AS_DEGREES: f64 = 6.4;
/// Factor by which angles misread as degrees reduce the model's spread at least.
const SMALLER: f64 = 10.0;

/// Doubt about positions or joint angles whose spread only another unit explains, of the rows from `first` on. Columns are those of the joint
/// readings, then others; x of the position is the one with the number `x`.
#[must_use]
pub fn of_positions(
    robot: &Robot,
    columns: &[ReadColumn<'_>],
    x: usize,
    data: &Dataset,
    first: usize,
) -> Option<InputDoubt> {
    let step = data.len().saturating_sub(first).div_ceil(ROWS).max(1);
    let rows: Vec<usize> = (first..data.len()).step_by(step).collect();
    let input = columns.get(x).filter(|_| rows.len() >= FEWEST_ROWS)?;
    let placed = |row: &&usize| data.observations.get(**row).is_some_and(|row| row.measurement.position().is_some());
    let rows: Vec<usize> = rows.iter().filter(placed).copied().collect();
    let positions = rows.iter().filter_map(|&row| data.observations.get(row)?.measurement.position());
    let positions: Vec<Vector3<f64>> = positions.collect();
    let measured = spread(&positions);
    let tips = |angle_factor: f64| -> Vec<Vector3<f64>> {
        let tip = |&row: &usize| {
            let readings = data.readings(row).iter().zip(columns);
            let readings: Vec<f64> =
                readings.map(|(value, input)| if is_angle(input) { value * angle_factor } else { *value }).collect();
            match pair_of(robot, data, row) {
                (None, None) => robot.forward_kinematics(&readings).translation,
                pair => instrument_from_target(robot, &Pose::identity(), pair, &readings).translation,
            }
        };
        rows.iter().map(tip).collect()
    };
    let modelled = |angle_factor: f64| spread(&tips(angle_factor));
    let smallest = SHARE_OF_REACH * robot.reach_m();
    let as_read = modelled(1.0);
    if let Some(angle) = degrees_within_a_turn(columns, data, &rows)
        && measured > SMALLER * as_read
    {
        let as_radians = modelled(1f64.to_degrees());
        if as_radians > smallest && is_about(measured / as_radians, 1.0) {
            let message = angle_message(&columns[angle], measured, as_read);
            return Some(InputDoubt::new(DoubtLocation::Head(angle), message));
        }
    }
    let ratio = measured / as_read;
    let factor = THOUSANDS.into_iter().find(|factor| is_about(ratio, *factor));
    let factor = factor.or_else(|| near_unit(input.unit, ratio, &positions, &tips(1.0)))?;
    let message = || position_message(input, measured, as_read, factor);
    (as_read > smallest).then(|| InputDoubt::new(DoubtLocation::Head(x), message()))
}

/// Instrument and target of a row, if the model states their poses.
fn pair_of<'a>(robot: &'a Robot, data: &Dataset, row: usize) -> (Option<&'a Mount>, Option<&'a Mount>) {
    let Some(observation) = data.observations.get(row) else { return (None, None) };
    let find = |mounts: &'a [Mount], names: &[Option<String>], index: usize| {
        let name = names.get(index).and_then(Option::as_ref)?;
        mounts.iter().find(|mount| mount.name == *name)
    };
    (
        find(&robot.instruments, &data.stations, observation.station),
        find(&robot.mounted, &data.targets, observation.target),
    )
}

/// Factor by which positions in another unit would be too large or too small, for units near the stated one. The paths from row to row must
/// then be as long as the model's. A long tool changes the spread as much, but not these paths.
fn near_unit(stated: NamedUnit, ratio: f64, positions: &[Vector3<f64>], tips: &[Vector3<f64>]) -> Option<f64> {
    let ways = |of: &[Vector3<f64>]| -> Vec<f64> { of.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect() };
    let (measured, modelled) = (ways(positions), ways(tips));
    let usual = median(modelled.iter().copied())?;
    let factors = units_of(Unit::Metre).map(|unit| stated.to_si(1.0) / unit.to_si(1.0));
    let is_near = |factor: &f64| !is_about(1.0, *factor) && (ratio / factor).ln().abs() < NEAR.ln();
    factors.filter(is_near).find(|factor| {
        let apart = measured.iter().zip(&modelled).map(|(way, model)| (way / factor - model).abs());
        median(apart).is_some_and(|apart| apart < ALIKE * usual)
    })
}

/// Median distance from the middle, which a few corrupt rows do not change.
fn spread(positions: &[Vector3<f64>]) -> f64 {
    let middle = median_point(positions);
    median(positions.iter().map(|position| (position - middle).norm())).unwrap_or(0.0)
}

fn is_about(ratio: f64, expected: f64) -> bool {
    ratio > expected / FACTOR && ratio < expected * FACTOR
}

fn is_angle(input: &ReadColumn<'_>) -> bool {
    input.unit.si_unit() == Unit::Radian
}

/// The first joint angle, if all are in degrees and as small as radians.
fn degrees_within_a_turn(columns: &[ReadColumn<'_>], data: &Dataset, rows: &[usize]) -> Option<usize> {
    let columns = columns.get(..data.reading_names().len())?;
    let first = columns.iter().position(is_angle)?;
    let are_degrees = columns.iter().filter(|it| is_angle(it)).all(|it| it.unit.symbol() == "deg");
    let largest = FULL_TURN_AS_DEGREES.to_radians();
    let small = |&row: &usize| {
        let readings = data.readings(row).iter().zip(columns);
        readings.filter(|(_, column)| is_angle(column)).all(|(value, _)| value.abs() <= largest)
    };
    (are_degrees && rows.iter().all(small)).then_some(first)
}

fn angle_message(input: &ReadColumn<'_>, measured: f64, modelled: f64) -> String {
    format!(
        "found joint angles of at most {FULL_TURN_AS_DEGREES} deg that move the model's tip by {} mm where the positions \
         spread over {} mm, expected about the same: most likely they are in rad, not deg; write `{}[rad]` in the header \
         (and so for each joint), or the unit in the mapping",
        format_short(1e3 * modelled),
        format_short(1e3 * measured),
        input.name
    )
}

/// Name of a unit in a message.
fn spoken_unit(symbol: &str) -> &str {
    if symbol == "in" { "inches" } else { symbol }
}

/// Message about positions; `factor` is the measured spread over that of the model, as a ratio of units.
fn position_message(input: &ReadColumn<'_>, measured: f64, modelled: f64, factor: f64) -> String {
    let stated = input.unit;
    let model = format!(
        "the model's lengths are {} times too {}",
        format_short(factor.max(1.0 / factor)),
        if factor > 1.0 { "small" } else { "large" }
    );
    let likely = units_of(Unit::Metre)
        .find(|unit| (unit.to_si(1.0) * factor / stated.to_si(1.0) - 1.0).abs() < 1e-9)
        .map(|unit| unit.symbol());
    let advice = match likely {
        Some(likely) => format!(
            "most likely they are in {}, not {} (or {model}); write `x[{likely}],y[{likely}],z[{likely}]` in the \
             header, or the unit in the mapping",
            spoken_unit(likely),
            spoken_unit(stated.symbol())
        ),
        None => format!("most likely {model}; correct its unit, or the unit of the positions"),
    };
    format!(
        "found positions that spread over {} {stated} where the model moves its tip by {} {stated}, expected about the \
         same: {advice}",
        format_short(stated.from_si(measured)),
        format_short(stated.from_si(modelled)),
        stated = stated.symbol(),
    )
}
