//! Which rows are fitted and which are held out.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::CalibrationOptions;
use crate::error::{Error, ErrorKind, Result};
use crate::measurement::{Dataset, Set};
use crate::simulate::random;

/// The option that names measurements to judge by.
const VALIDATE: &str = "--validate";

/// Rows to fit and rows held out, each in the order of the data. Where a row states its set, that holds (and rows that state none
/// are then fitted); otherwise a seeded share of the *configurations* is held out, so that several targets seen in one
/// configuration never stand on both sides.
///
/// # Errors
/// [`ErrorKind::Option`] if the share is not in `[0, 1)`, [`ErrorKind::Problem`] if nothing is left to fit.
pub fn split_rows(data: &Dataset, options: &CalibrationOptions) -> Result<(Vec<u32>, Vec<u32>)> {
    if !(0.0..1.0).contains(&options.held_out) {
        return Err(Error::new(
            ErrorKind::Option,
            format!("found a held-out share of {}, expected a number from 0 to below 1", options.held_out),
        ));
    }
    let count = u32::try_from(data.len()).map_err(|_| {
        Error::new(ErrorKind::Problem, format!("found {} rows, expected at most {}", data.len(), u32::MAX))
    })?;
    let stated = data.observations.iter().any(|row| row.set.is_some());
    let held_out: Vec<bool> = if stated {
        data.observations.iter().map(|row| row.set == Some(Set::HeldOut)).collect()
    } else {
        random_share(data, options)
    };
    let (kept_back, fitted): (Vec<u32>, Vec<u32>) = (0..count).partition(|&row| held_out[row as usize]);
    if fitted.is_empty() {
        return Err(Error::new(
            ErrorKind::Problem,
            format!("found {count} rows of which none is to be fitted, expected some in the set `fit`"),
        ));
    }
    if stated {
        refuse_copies(data, &held_out, kept_back.len())?;
    }
    Ok((fitted, kept_back))
}

/// Refuses rows to judge by of which half or more are fitted rows over again: their errors would promise what nobody knows.
fn refuse_copies(data: &Dataset, held_out: &[bool], kept_back: usize) -> Result<()> {
    // Numbers that were written in another unit come back with other last digits.
    const SAME: f64 = 1e-9;
    let pose = |row: u32| data.observations[row as usize].measurement.pose();
    let is_held_out = |row: &u32| held_out[*row as usize];
    let is_copy = |row: u32, other: u32| {
        let (a, b) = (pose(row), pose(other));
        let targets = [row, other].map(|row| data.observations[row as usize].target);
        targets[0] == targets[1]
            && (a.translation - b.translation).amax() < SAME
            && (a.rotation - b.rotation).amax() < SAME
    };
    let mut copies: Vec<(u32, u32)> = Vec::new();
    for group in data.alike(&data.all_rows(), SAME, 2, |_| 0) {
        let (judging, fitted): (Vec<u32>, Vec<u32>) = group.into_iter().partition(is_held_out);
        copies.extend(
            judging
                .into_iter()
                .filter_map(|row| Some((row, *fitted.iter().find(|&&other| is_copy(row, other))?))),
        );
    }
    let Some(&(row, other)) = copies.first().filter(|_| 2 * copies.len() >= kept_back) else { return Ok(()) };
    Err(Error::new(
        ErrorKind::Problem,
        format!(
            "found {} of {kept_back} held-out rows that repeat fitted rows ({} as {}), expected rows that were not fitted: judge by \
             others, or fit all rows and let a share be held out (--held-out)",
            copies.len(),
            data.place(row),
            data.place(other)
        ),
    ))
}

/// Where rows state which of them are held out, a share of them has no meaning, unless it is none: then every row is fitted, but for
/// those of `--validate`. `stated_by` is what stated it, for the message. Tells whether it is stated.
///
/// # Errors
/// [`ErrorKind::Option`] if a share above 0 is asked for as well.
pub fn settle_sets(data: &mut Dataset, held_out: Option<f64>, stated_by: &str) -> Result<bool> {
    if data.observations.iter().all(|row| row.set.is_none()) {
        return Ok(false);
    }
    match held_out {
        Some(share) if share > 0.0 => {
            let message = format!(
                "found --held-out {share}, but {stated_by} already says which rows are held out, expected one of the \
                 two: leave --held-out out, or fit every row with --held-out 0"
            );
            return Err(Error::new(ErrorKind::Option, message));
        }
        // Beside --validate nothing else is held out anyway.
        Some(_) if stated_by != VALIDATE => {
            data.observations.iter_mut().for_each(|row| row.set = Some(Set::Fit));
        }
        _ => {}
    }
    Ok(true)
}

/// A seeded share of the configurations (rows with the same readings, but for what encoders jitter by, are one).
fn random_share(data: &Dataset, options: &CalibrationOptions) -> Vec<bool> {
    // Named by its first row, so that the choice does not depend on the values of the readings.
    let mut configurations = data.all_rows();
    let mut configuration = configurations.clone();
    for group in data.grouped(&configurations) {
        group.iter().for_each(|&row| configuration[row as usize] = group[0]);
    }
    configurations.retain(|&row| configuration[row as usize] == row);
    let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
    random::shuffle(&mut generator, &mut configurations);
    // At least one stays fitted, so that a share too large is refused for what is missing then.
    let most = configurations.len().saturating_sub(1);
    let count = ((options.held_out * configurations.len() as f64).round() as usize).min(most);
    let mut chosen = vec![false; data.len()];
    for &first in &configurations[..count] {
        chosen[first as usize] = true;
    }
    configuration.iter().map(|&first| chosen[first as usize]).collect()
}
