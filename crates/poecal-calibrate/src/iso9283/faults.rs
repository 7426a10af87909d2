//! Rows that are missing, doubled or exchanged, of another pose, or of mixed conditions: each in a sentence.

use nalgebra::Vector3;

use super::STANDARD_CYCLES;
use super::rows::{PoseCell, PoseCells, TestLabels, TestRow};
use poecal_numerics::error::{ErrorKind, Result, first_few};

/// Fewest cycles of a pose.
const FEWEST: usize = 3;
/// Median distances from the middle of its pose beyond which a row is no scatter, and metres.
const BEYOND: f64 = 30.0;
const BEYOND_M: f64 = 5e-4;
/// Share of the distance between poses beyond which an error is no accuracy, and metres.
const GROSS: f64 = 0.05;
const GROSS_M: f64 = 0.02;

/// A row as messages name it.
fn row_name(row: &TestRow) -> &str {
    &row.place
}

fn refuse<T>(row: &TestRow, message: &str) -> Result<T> {
    ErrorKind::Measurement.refuse(format!("{}: {message}", row_name(row)))
}

/// Refuses rows of which no figure can be computed; else warns of what is missing, a sentence each.
///
/// # Errors
/// [`ErrorKind::Measurement`], with the row.
pub(super) fn check(cells: &PoseCells<'_>) -> Result<Vec<String>> {
    refuse_mixed_conditions(cells)?;
    for cell in cells.base.iter().chain(&cells.others) {
        refuse_doubled_rows(cell)?;
        commands(cell)?;
    }
    for cell in cells.base.iter().chain(&cells.others) {
        if cell.count() < FEWEST {
            let words = format!(
                "found {} of pose {}, expected {FEWEST} or more (the standard has {STANDARD_CYCLES}): measure more cycles",
                cycles(cell.count()),
                cell.pose
            );
            return match cell.rows.last() {
                Some(row) => refuse(row, &words),
                None => ErrorKind::Measurement.refuse(words),
            };
        }
    }
    refuse_misplaced_rows(cells)?;
    Ok(list_missing_rows(cells))
}

fn cycles(count: usize) -> String {
    if count == 1 { "1 cycle".to_owned() } else { format!("{count} cycles") }
}

/// Two speeds or loads in one figure.
fn refuse_mixed_conditions(cells: &PoseCells<'_>) -> Result<()> {
    for word in ["speed", "payload"] {
        let of = |it: &TestLabels| if word == "speed" { it.speed.clone() } else { it.payload.clone() };
        let mut rows = cells.base.iter().flat_map(|it| &it.rows);
        let Some(first) = rows.next() else { continue };
        let own = of(&first.labels);
        if let Some(other) = rows.find(|row| of(&row.labels) != own) {
            let shown = |text: &str| if text.is_empty() { "none".to_owned() } else { format!("`{text}`") };
            let message = format!(
                "found the {word} {} beside {} of {}, expected one {word} in all rows: test each {word} by a file of its own",
                shown(&of(&other.labels)),
                shown(&own),
                row_name(first)
            );
            return refuse(other, &message);
        }
    }
    Ok(())
}

/// Two rows of one pose in one cycle.
fn refuse_doubled_rows(cell: &PoseCell<'_>) -> Result<()> {
    for (k, row) in cell.rows.iter().enumerate() {
        let same = |it: &&&TestRow| !row.labels.cycle.is_empty() && it.labels.cycle == row.labels.cycle;
        if let Some(first) = cell.rows[..k].iter().find(same) {
            let message = format!(
                "found pose {} in cycle {} a second time, after {}, expected it once: remove one row, or correct its cycle",
                cell.pose,
                row.labels.cycle,
                row_name(first)
            );
            return refuse(row, &message);
        }
    }
    Ok(())
}

/// Two commands of one pose.
fn commands(cell: &PoseCell<'_>) -> Result<()> {
    const SAME_M: f64 = 2e-5;
    let Some(first) = cell.rows.first() else { return Ok(()) };
    let apart_m = |row: &TestRow| (row.commanded.translation - first.commanded.translation).norm();
    match cell.rows.iter().find(|row| apart_m(row) > SAME_M) {
        None => Ok(()),
        Some(row) => {
            let message = format!(
                "found pose {} commanded {:.3} mm from its command of {}, expected one command for each pose: correct the name of the pose, or the command",
                cell.pose,
                1e3 * apart_m(row),
                row_name(first)
            );
            refuse(row, &message)
        }
    }
}

/// Rows that were measured far from the others of their pose.
fn refuse_misplaced_rows(cells: &PoseCells<'_>) -> Result<()> {
    let middles: Vec<(Vector3<f64>, f64)> = cells.base.iter().map(PoseCell::middle).collect();
    for (at, cell) in cells.base.iter().enumerate() {
        let (middle, scatter) = middles[at];
        let limit = (BEYOND * scatter).max(BEYOND_M);
        let off = |row: &TestRow| (row.position_m - middle).norm();
        let Some(row) = cell.rows.iter().find(|row| off(row) > limit) else { continue };
        let distance = |other: usize| (row.position_m - middles[other].0).norm();
        let nearest = (0..middles.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        let other = nearest.filter(|&other| other != at && distance(other) < 0.5 * off(row));
        let Some(other) = other else {
            let message = format!(
                "found a position {:.3} mm from the other rows of pose {}, which scatter by {:.3} mm, expected one of this pose: leave the row out, or measure it again",
                1e3 * off(row),
                cell.pose,
                1e3 * scatter
            );
            return refuse(row, &message);
        };
        let partner = cells.base[other].rows.iter().find(|it| off(it) < distance(other).max(limit));
        let exchanged = match partner {
            Some(partner) => format!("exchange it with {}", row_name(partner)),
            None => "correct its pose".to_owned(),
        };
        let message = format!(
            "found the position of pose {} ({:.3} mm from its others) in a row of pose {}, expected one within {:.3} mm of {}'s others: {exchanged}",
            cells.base[other].pose,
            1e3 * distance(other),
            cell.pose,
            1e3 * limit,
            cell.pose
        );
        return refuse(row, &message);
    }
    Ok(())
}

/// Missing rows, a sentence each.
fn list_missing_rows(cells: &PoseCells<'_>) -> Vec<String> {
    let mut said = Vec::new();
    let most = cells.base.iter().map(PoseCell::count).max().unwrap_or(0);
    let mut all: Vec<&str> = Vec::new();
    for row in cells.base.iter().flat_map(|it| &it.rows) {
        let cycle = row.labels.cycle.as_str();
        if !cycle.is_empty() && !all.contains(&cycle) {
            all.push(cycle);
        }
    }
    for cell in &cells.base {
        let has = |cycle: &&&str| cell.rows.iter().any(|row| row.labels.cycle == ***cycle);
        let lacks: Vec<&str> = all.iter().filter(|it| !has(it)).copied().collect();
        let place = cell.rows.last().map_or("", |row| row_name(row));
        if !lacks.is_empty() {
            let words = if lacks.len() == 1 { "cycle" } else { "cycles" };
            said.push(format!(
                "{place}: found no row of pose {} in {words} {}, expected every pose in every cycle: measure again, since its figures are of {} cycles only",
                cell.pose,
                first_few(&lacks),
                cell.count()
            ));
        } else if cell.count() < most {
            said.push(format!(
                "{place}: found {} of pose {}, expected {most} as of the others: distances pair rows by their order, so name cycles in a column `cycle`",
                cycles(cell.count()),
                cell.pose
            ));
        }
    }
    let fewest = cells.base.iter().map(PoseCell::count).min().unwrap_or(0);
    if fewest < STANDARD_CYCLES {
        said.push(format!(
            "found {}, expected {STANDARD_CYCLES} for a test of ISO 9283 (clause 6.11): the intervals are of those that were measured",
            cycles(fewest)
        ));
    }
    said.extend(cells.base.iter().filter_map(describe_copied_rows));
    said
}

/// Two rows of a pose with the same digits.
fn describe_copied_rows(cell: &PoseCell<'_>) -> Option<String> {
    let pair = cell.rows.iter().enumerate().find_map(|(k, row)| {
        let first = cell.rows[..k].iter().find(|it| it.position_m == row.position_m)?;
        Some((first, row))
    });
    let (first, row) = pair?;
    Some(format!(
        "{}: found the position of {} to the last digit, expected scatter: remove the row if it is a copy, which makes RP too small",
        row_name(row),
        row_name(first)
    ))
}

/// Refuses barycentres that are too far from their commands for an accuracy: names of poses that were exchanged, or another unit or frame.
///
/// # Errors
/// [`ErrorKind::Measurement`], with the pose.
pub(super) fn refuse_gross(cells: &[PoseCell<'_>], errors: &[Vector3<f64>], is_fitted: bool) -> Result<()> {
    let places: Vec<Vector3<f64>> = cells.iter().map(|it| it.commanded_pose().translation).collect();
    let apart = |a: &Vector3<f64>| places.iter().map(|b| (a - b).norm()).fold(0.0, f64::max);
    let size = places.iter().map(apart).fold(0.0, f64::max);
    let worst = errors.iter().enumerate().max_by(|a, b| a.1.norm().total_cmp(&b.1.norm()));
    let limit = (GROSS * size).max(GROSS_M);
    let Some((at, error)) = worst.filter(|it| it.1.norm() > limit) else { return Ok(()) };
    let (frame, remedy) = if is_fitted {
        ("the fitted frame", "correct the names of poses, the unit, or the commands")
    } else {
        ("the stated frame", "correct the unit, or leave the frame to be fitted with --device-frame unknown")
    };
    let message = format!(
        "found the barycentre of pose {} {:.1} mm from its command in {frame}, expected one within {:.1} mm: {remedy}",
        cells[at].pose,
        1e3 * error.norm(),
        1e3 * limit
    );
    match cells[at].rows.first() {
        Some(row) => refuse(row, &message),
        None => ErrorKind::Measurement.refuse(message),
    }
}
