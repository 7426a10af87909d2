//! Chosen rows of measurements, and rows of several measurements joined.

use poecal_model::measurement::Dataset;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PySlice};

use crate::arguments::unexpected_error;
use crate::errors::{argument, no_row, raise};

/// Permitted keys of rows.
const KEYS: &str = "a slice, a row, a list of rows, or a True or False for each row";

/// The rows that `key` chooses of `count`, as NumPy does: a slice, an integer, integers, or a mask.
pub(crate) fn choose_rows(key: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<usize>> {
    if let Ok(slice) = key.cast::<PySlice>() {
        let length = isize::try_from(count).unwrap_or(isize::MAX);
        let found = slice.indices(length)?;
        let row = |at: usize| found.start + found.step * at.cast_signed();
        return Ok((0..found.slicelength).filter_map(|at| usize::try_from(row(at)).ok()).collect());
    }
    if let Some(row) = integer(key) {
        return Ok(vec![row_of(row, count)?]);
    }
    let entries: Vec<Bound<'_, PyAny>> = key.extract().map_err(|_| unexpected_error("rows", key, KEYS))?;
    let mask: Option<Vec<bool>> = entries.iter().map(|entry| entry.extract().ok()).collect();
    match mask {
        Some(mask) if mask.len() == count => Ok((0..count).filter(|&row| mask.get(row) == Some(&true)).collect()),
        Some(mask) if !mask.is_empty() => {
            let message = format!("found a mask of {} entries, expected {count}, one for each row", mask.len());
            Err(argument("rows", message))
        }
        _ => entries
            .iter()
            .map(|entry| row_of(integer(entry).ok_or_else(|| unexpected_error("rows", entry, KEYS))?, count))
            .collect(),
    }
}

/// An integer of Python or NumPy, which a bool is not here.
fn integer(value: &Bound<'_, PyAny>) -> Option<isize> {
    let is_mask = value.is_instance_of::<PyBool>() || value.extract::<bool>().is_ok();
    if is_mask { None } else { value.extract().ok() }
}

/// A row, counted from the end if it is negative.
fn row_of(row: isize, count: usize) -> PyResult<usize> {
    let from_start = if row < 0 { row.saturating_add_unsigned(count) } else { row };
    match usize::try_from(from_start) {
        Ok(found) if found < count => Ok(found),
        _ => Err(no_row(row, count)),
    }
}

/// These rows with all of their attributes. Targets, instruments and files that none of them names are removed.
pub(crate) fn part(data: &Dataset, rows: &[usize]) -> PyResult<Dataset> {
    let mut found = Dataset::new(data.reading_names().to_vec());
    let mut files = vec![None; data.files.len()];
    let observations = || rows.iter().filter_map(|&row| Some((row, data.observations.get(row)?)));
    // In the order of the whole, so that all rows are the whole.
    let mut seen = [vec![false; data.targets.len()], vec![false; data.station_count()]];
    for (_, observation) in observations() {
        for (seen, index) in seen.iter_mut().zip([observation.target, observation.station]) {
            seen.get_mut(index).into_iter().for_each(|seen| *seen = true);
        }
    }
    let [targets, stations] = seen;
    let named = |index: usize| data.targets.get(index).and_then(Option::as_deref);
    let targets: Vec<usize> =
        targets.iter().enumerate().map(|(at, seen)| if *seen { found.target_index(named(at)) } else { 0 }).collect();
    let station = |index: usize| data.stations.get(index).and_then(Option::as_deref);
    let is_named = stations.iter().enumerate().any(|(at, seen)| *seen && station(at).is_some());
    let stations: Vec<usize> = stations
        .iter()
        .enumerate()
        .map(|(at, seen)| if *seen && is_named { found.station_index(station(at)) } else { 0 })
        .collect();
    for (row, observation) in observations() {
        let mut observation = *observation;
        observation.target = targets.get(observation.target).copied().unwrap_or_default();
        observation.station = stations.get(observation.station).copied().unwrap_or_default();
        let file = observation.source.file as usize;
        if let (Some(path), Some(known)) = (data.files.get(file), files.get_mut(file)) {
            let index = known.or_else(|| found.files.iter().position(|other| other == path));
            let index = index.unwrap_or_else(|| {
                found.files.push(path.clone());
                found.files.len() - 1
            });
            *known = Some(index);
            observation.source.file = u32::try_from(index).unwrap_or_default();
        }
        found.push_observation(data.readings(row), observation).map_err(raise)?;
        found.ids.extend(data.ids.get(row).cloned());
    }
    Ok(found)
}

/// The rows of all parts, in sequence. Joints, targets and instruments of one name are one.
pub(crate) fn join_datasets(parts: &[&Dataset]) -> PyResult<Dataset> {
    let Some((first, others)) = parts.split_first() else {
        return Err(argument("parts", "found none, expected at least one"));
    };
    let sorted = |data: &Dataset| {
        let mut names = data.reading_names().to_vec();
        names.sort_unstable();
        names
    };
    let mut all = (*first).clone();
    for (at, other) in others.iter().enumerate() {
        if sorted(other) != sorted(first) {
            let (found, expected) = (other.reading_names().join(", "), first.reading_names().join(", "));
            let message = format!("found readings of {found}, expected those of the first: {expected}");
            return Err(argument(&format!("parts[{}]", at + 1), message));
        }
        all.extend(other).map_err(raise)?;
    }
    let rows: Vec<usize> = (0..all.len()).collect();
    part(&all, &rows)
}
