//! Positions and distances in a wrong unit, judged by the reach of the robot.

use nalgebra::Vector3;

use super::{DoubtLocation, InputDoubt, ReadColumn, SHARE, format_short, state_it};
use poecal_model::measurement::Observation;
use poecal_model::robot::Robot;
use poecal_numerics::distributions::{median, median_point};

/// Motion below which a coordinate counts as still, as a share of the reach.
const STILL: f64 = 1e-2;
/// Largest motion, in reaches, of a coordinate in the right unit beside another one in a wrong unit.
const RIGHT_REACHES: f64 = 4.0;
/// Positions with a spread of more than this many reaches are in a wrong unit.
pub const REACHES: f64 = 20.0;

/// Doubt about distances that differ by more than the robot reaches: their unit must be smaller. `slides_m` is the motion of prismatic joints
/// without limits.
#[must_use]
pub fn of_ranges(robot: &Robot, slides_m: f64, rows: &[Observation]) -> Option<InputDoubt> {
    let ranged = || rows.iter().filter_map(|row| Some((row.measurement.range()?, row)));
    let middle = median(ranged().map(|(range, _)| range))?;
    let reach = robot.reach_m() + slides_m;
    let far = |range: f64| (range - middle).abs() > 2.0 * reach;
    let count = ranged().filter(|(range, _)| far(*range)).count();
    let (range, row) = ranged().max_by(|a, b| (a.0 - middle).abs().total_cmp(&(b.0 - middle).abs()))?;
    if !far(range) || (count as f64) < SHARE * ranged().count() as f64 {
        return None;
    }
    let message = format!(
        "found distances up to {} m from their middle, where the robot reaches {} m, expected another unit, most likely mm; write \
         the unit in the header, as `distance[mm]`",
        format_short((range - middle).abs()),
        format_short(reach)
    );
    Some(InputDoubt::new(DoubtLocation::Line(row.source.line as usize), message))
}

/// Doubt about positions of columns x, y, z whose spread reveals that their unit must be smaller.
#[must_use]
pub fn of_positions(
    robot: &Robot,
    columns: [ReadColumn<'_>; 3],
    slides_m: f64,
    rows: &[Observation],
) -> Option<InputDoubt> {
    // The reach does not contain prismatic joints without limits.
    let reach = robot.reach_m() + slides_m;
    let placed = || rows.iter().filter_map(|row| Some((row.measurement.position()?, row)));
    let positions: Vec<Vector3<f64>> = placed().map(|(position, _)| position).collect();
    let middle = median_point(&positions);
    let far = positions.iter().filter(|position| (*position - middle).norm() > 2.0 * reach).count();
    let (apart, line) = placed()
        .map(|(position, row)| (position - middle, row.source.line))
        .max_by(|a, b| a.0.norm().total_cmp(&b.0.norm()))?;
    let spread = apart.norm();
    if spread <= REACHES * reach || spread > 1e3 * REACHES * reach || (far as f64) < SHARE * positions.len() as f64 {
        return None;
    }
    let far_of = |axis: usize| positions.iter().fold(0.0, |most: f64, it| most.max((it[axis] - middle[axis]).abs()));
    let message = positions_message(columns, [0, 1, 2].map(far_of), apart, reach)?;
    Some(InputDoubt::new(DoubtLocation::Line(line as usize), message))
}

/// Message about positions far from their middle, by the largest distance in each coordinate; `None` without a smaller unit.
fn positions_message(columns: [ReadColumn<'_>; 3], far: [f64; 3], apart: Vector3<f64>, reach: f64) -> Option<String> {
    // The columns in a wrong unit: a header may state the unit of one of three wrongly. A column without
    // motion reveals nothing.
    let is_right = |axis: usize| (STILL * reach..=RIGHT_REACHES * reach).contains(&far[axis]);
    let own: Vec<usize> = (0..3).filter(|axis| !is_right(*axis)).collect();
    let own = if own.is_empty() { vec![0, 1, 2] } else { own };
    let mut headers = Vec::new();
    for input in own.iter().map(|axis| columns[*axis]) {
        let smaller = match input.unit.symbol() {
            "m" | "cm" | "in" => "mm",
            "mm" => "um",
            "um" => "nm",
            _ => return None,
        };
        headers.push((input.name, smaller));
    }
    let (first, smaller) = headers.first()?;
    let unit = columns[own[0]].unit;
    let what = match own.len() {
        3 => "positions".to_owned(),
        1 => format!("values of `{first}`"),
        _ => format!(
            "values of {}",
            headers.iter().map(|(name, _)| format!("`{name}`")).collect::<Vec<_>>().join(" and ")
        ),
    };
    let others: Vec<&str> = (0..3).filter(|axis| !own.contains(axis)).map(|axis| columns[axis].name).collect();
    let others = match others.as_slice() {
        [] => String::new(),
        [one] => format!(", beside `{one}`, which it can reach"),
        several => format!(", beside `{}`, which it can reach", several.join("` and `")),
    };
    let written: Vec<String> = headers.iter().map(|(name, unit)| format!("{name}[{unit}]")).collect();
    Some(format!(
        "found {what} up to {} {stated} from their middle, where the robot reaches {} {stated}{others}, expected another \
         unit, most likely {smaller}; write `{}` in the header, or {}",
        format_short(unit.from_si(if own.len() == 3 { apart.norm() } else { apart[own[0]].abs() })),
        format_short(unit.from_si(reach)),
        written.join(","),
        state_it(columns[own[0]].unit_from, smaller),
        stated = unit.symbol(),
    ))
}
