//! Training and held-out rows.

use std::collections::BTreeMap;

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use crate::CalibrationOptions;
use poecal_fit::uncertainty::FEWEST_VALIDATED;
use poecal_model::measurement::{Dataset, Set};
use poecal_model::simulate::random;
use poecal_numerics::error::{ErrorKind, Result};

/// Default share of the configurations that is held out.
const USUAL: f64 = 0.3;
/// Fewest configurations that are held out by default: with fewer, cross-validation of all judges better.
pub const FEWEST_HELD_OUT: usize = 12;
/// Option that names measurements for validation.
const VALIDATE: &str = "--validate";

/// Training and held-out rows, each in the order of the data. Sets stated by rows hold (rows without one are fitted). Otherwise a seeded share of the
/// *configurations* is held out, so that targets of one configuration are never in both sets. With few configurations none is held out by default
/// ([`CalibrationOptions::held_out`]).
///
/// # Errors
/// [`ErrorKind::Option`] if the share is not in `[0, 1)`, [`ErrorKind::Problem`] if no row is left to fit.
pub fn split_rows(data: &Dataset, options: &CalibrationOptions) -> Result<(Vec<u32>, Vec<u32>)> {
    if let Some(share) = options.held_out.filter(|share| !(0.0..1.0).contains(share)) {
        return ErrorKind::Option
            .refuse(format!("found a held-out share of {share}, expected a number from 0 to below 1"));
    }
    let count = u32::try_from(data.len())
        .map_err(|_| ErrorKind::Problem.error(format!("found {} rows, expected at most {}", data.len(), u32::MAX)))?;
    let stated = data.observations.iter().any(|row| row.set.is_some());
    let held_out: Vec<bool> = if stated {
        data.observations.iter().map(|row| row.set == Some(Set::HeldOut)).collect()
    } else {
        random_share(data, options)
    };
    let (held_out_count, fitted): (Vec<u32>, Vec<u32>) = (0..count).partition(|&row| held_out[row as usize]);
    if fitted.is_empty() {
        return ErrorKind::Problem
            .refuse(format!("found {count} rows of which none is to be fitted, expected some in the set `fit`"));
    }
    if stated {
        refuse_copies(data, &held_out, held_out_count.len())?;
    }
    Ok((fitted, held_out_count))
}

/// Refuses held-out rows if half or more of them are copies of fitted rows: their errors would be too small.
fn refuse_copies(data: &Dataset, held_out: &[bool], held_out_count: usize) -> Result<()> {
    // Numbers converted from another unit differ in the last digits.
    const SAME: f64 = 1e-9;
    let seen = |row: u32| &data.observations[row as usize].measurement;
    let is_held_out = |row: &u32| held_out[*row as usize];
    let is_copy = |row: u32, other: u32| {
        let apart = seen(row).distance_and_angle(seen(other));
        let targets = [row, other].map(|row| data.observations[row as usize].target);
        targets[0] == targets[1] && apart.is_some_and(|(apart, turned)| apart < SAME && turned < SAME)
    };
    let mut copies: Vec<(u32, u32)> = Vec::new();
    for group in data.group_similar(&data.all_rows(), SAME, 2, |_| 0) {
        let (judging, fitted): (Vec<u32>, Vec<u32>) = group.into_iter().partition(is_held_out);
        copies.extend(
            judging.into_iter().filter_map(|row| Some((row, *fitted.iter().find(|&&other| is_copy(row, other))?))),
        );
    }
    let Some(&(row, other)) = copies.first().filter(|_| 2 * copies.len() >= held_out_count) else {
        return Ok(());
    };
    ErrorKind::Problem.refuse(format!(
            "found {} of {held_out_count} held-out rows that repeat fitted rows ({} as {}), expected rows that were not fitted: judge by \
             others, or fit all rows and let a share be held out (--held-out)",
            copies.len(),
            data.place(row),
            data.place(other)
        ))
}

/// Applies the stated sets. If rows state their set, `held_out` must be absent or 0; 0 fits all rows except those of `--validate`. `stated_by` names
/// the source in the message. Returns whether sets are stated.
///
/// # Errors
/// [`ErrorKind::Option`] if a share above 0 is requested as well.
pub fn settle_sets(data: &mut Dataset, held_out: Option<f64>, stated_by: &str) -> Result<bool> {
    if data.observations.iter().all(|row| row.set.is_none()) {
        return Ok(false);
    }
    match held_out {
        Some(share) if share > 0.0 => {
            return ErrorKind::Option.refuse(format!(
                "found --held-out {share}, but {stated_by} already says which rows are held out, expected one of the \
                 two: leave --held-out out, or fit every row with --held-out 0"
            ));
        }
        // With --validate nothing else is held out.
        Some(_) if stated_by != VALIDATE => {
            data.observations.iter_mut().for_each(|row| row.set = Some(Set::Fit));
        }
        _ => {}
    }
    Ok(true)
}

/// A seeded share of the configurations (rows whose readings agree within encoder jitter are one).
fn random_share(data: &Dataset, options: &CalibrationOptions) -> Vec<bool> {
    // Keyed by the first row, so that the choice does not depend on the values of the readings.
    let mut configurations = data.all_rows();
    let mut configuration = configurations.clone();
    for group in data.group_configurations(&configurations) {
        group.iter().for_each(|&row| configuration[row as usize] = group[0]);
    }
    in_motion_together(data, &mut configuration);
    configurations.retain(|&row| configuration[row as usize] == row);
    let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
    random::shuffle(&mut generator, &mut configurations);
    // At least one stays fitted: a share too large is then refused by the count of numbers.
    let most = configurations.len().saturating_sub(1);
    let share = options.held_out.unwrap_or(USUAL);
    let mut count = ((share * configurations.len() as f64).round() as usize).min(most);
    if is_open(data, options) && count < FEWEST_HELD_OUT {
        count = 0;
    }
    let mut chosen = vec![false; data.len()];
    for &first in &configurations[..count] {
        chosen[first as usize] = true;
    }
    configuration.iter().map(|&first| chosen[first as usize]).collect()
}

/// True if the default may be to fit all rows. It may not if limits are stated, which only held-out rows decide; nor for pictures, whose corners
/// cross-validation does not predict; nor for rows in motion, which are no configurations; nor for fewer than cross-validation leaves out.
fn is_open(data: &Dataset, options: &CalibrationOptions) -> bool {
    options.held_out.is_none()
        && options.accept.is_none()
        && data.pictures.is_empty()
        && data.observations.iter().all(|row| data.motion(row).is_none())
        && data.len() >= FEWEST_VALIDATED
}

/// Number of configurations, if all are fitted by default because too few would have been held out.
pub(crate) fn too_few_to_hold_out(data: &Dataset, options: &CalibrationOptions, held_out: &[u32]) -> Option<usize> {
    let is_stated = data.observations.iter().any(|row| row.set.is_some());
    let is_chosen = is_open(data, options) && held_out.is_empty() && !is_stated;
    is_chosen.then(|| data.configurations(&data.all_rows()).len())
}

/// Groups rows in motion that are near in time, which are nearly one configuration: those of each two seconds are held out together.
fn in_motion_together(data: &Dataset, configuration: &mut [u32]) {
    const TOGETHER_S: f64 = 2.0;
    let mut firsts: BTreeMap<(usize, i64), u32> = BTreeMap::new();
    for (row, (observation, own)) in (0..).zip(data.observations.iter().zip(configuration)) {
        if let Some((_, time_s)) = data.motion(observation) {
            let part = (time_s / TOGETHER_S).floor() as i64;
            *own = *firsts.entry((observation.station, part)).or_insert(row);
        }
    }
}
