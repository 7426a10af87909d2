//! Several targets under one name: rows of one configuration at several positions that keep their distances.

use nalgebra::Vector3;

use super::diagnosis::format_short;
use super::fitter::Fitter;
use super::{Diagnosis, DiagnosisKind};
use poecal_model::measurement::{Dataset, Measurement};
use poecal_numerics::distributions::median;

/// Distance (share of the reach) and angle (radians) above which rows of one configuration contradict each other: a hundred times a robot's
/// repeatability.
const CONTRADICTION_SHARE: f64 = 5e-3;
const CONTRADICTION_RAD: f64 = 0.035;
/// Fewest configurations with the same positions.
const FEWEST: usize = 3;
/// Least share of these among the configurations with several positions.
const SHARE: f64 = 2.0 / 3.0;
/// Largest deviation of a distance from the usual one, as a share of it.
const TOLERANCE: f64 = 0.1;

/// Positions of one configuration, in the order of their first rows.
struct ObservedPositions {
    rows: Vec<u32>,
    first: Vec<Vector3<f64>>,
    /// Distances between all pairs, sorted.
    distances: Vec<f64>,
}

/// Diagnosis of contradicting rows, grouped by configuration and target, as rows of several targets.
pub(crate) fn diagnose<'a>(
    fitter: &Fitter<'_>,
    data: &Dataset,
    groups: impl Iterator<Item = &'a [u32]>,
) -> Option<Diagnosis> {
    let is_placed = |row: &u32| data.observations[*row as usize].measurement.is_place();
    let groups = groups.filter(|rows| rows.iter().all(is_placed));
    let several: Vec<ObservedPositions> =
        groups.map(|rows| places(fitter, data, rows)).filter(|places| places.first.len() > 1).collect();
    let count = most_frequent(several.iter().map(|places| places.first.len()).collect())?;
    let alike: Vec<&ObservedPositions> = several.iter().filter(|places| places.first.len() == count).collect();
    let pairs = count * (count - 1) / 2;
    let at = |pair: usize| move |places: &&ObservedPositions| places.distances.get(pair).copied().unwrap_or(0.0);
    let distances: Vec<f64> = (0..pairs).map(|pair| median(alike.iter().map(at(pair))).unwrap_or(0.0)).collect();
    let keeps = |places: &&&ObservedPositions| {
        places.distances.iter().zip(&distances).all(|(found, usual)| (found - usual).abs() <= TOLERANCE * usual)
    };
    let alike: Vec<&ObservedPositions> = alike.iter().filter(keeps).copied().collect();
    if alike.len() < FEWEST || (alike.len() as f64) < SHARE * several.len() as f64 || is_shift(&alike) {
        return None;
    }
    let (nearest, furthest) = (distances.first()? * 1e3, distances.last()? * 1e3);
    let apart = if pairs == 1 {
        format!("{} mm apart", format_short(furthest))
    } else {
        format!("{} to {} mm apart", format_short(nearest), format_short(furthest))
    };
    let mut rows: Vec<u32> = alike.iter().flat_map(|places| places.rows.iter().copied()).collect();
    rows.sort_unstable();
    let example = alike.first()?.rows.get(..2)?;
    Some(Diagnosis {
        kind: DiagnosisKind::TargetsUnnamed,
        statement: format!(
            "each of {} configurations has rows at {count} places that are always {apart} (such as {} and {}), as {count} \
             targets are: add a column `target` that names which one each row saw",
            alike.len(),
            data.place(example[0]),
            data.place(example[1]),
        ),
        rows,
        before_mm: furthest,
        after_mm: 0.0,
    })
}

/// Positions of the rows of a configuration: rows that do not contradict a position's first row belong to it.
fn places(fitter: &Fitter<'_>, data: &Dataset, rows: &[u32]) -> ObservedPositions {
    let mut first: Vec<&Measurement> = Vec::new();
    for seen in rows.iter().filter_map(|&row| data.observations.get(row as usize)) {
        let seen = &seen.measurement;
        if first.len() < MOST && first.iter().all(|first| contradiction_m(fitter, first, seen).is_some()) {
            first.push(seen);
        }
    }
    let first: Vec<Vector3<f64>> = first.iter().map(|seen| seen.pose().translation).collect();
    let others = |(k, place): (usize, &Vector3<f64>)| {
        first.iter().take(k).map(|other| (place - other).norm()).collect::<Vec<_>>()
    };
    let mut distances: Vec<f64> = first.iter().enumerate().flat_map(others).collect();
    distances.sort_unstable_by(f64::total_cmp);
    ObservedPositions { rows: rows.to_vec(), first, distances }
}

/// Largest number of different positions.
const MOST: usize = 12;

/// True if the second position is the first one, shifted by the same vector everywhere and measured later: then the device was moved.
fn is_shift(alike: &[&ObservedPositions]) -> bool {
    let shift = |places: &&ObservedPositions| match places.first.as_slice() {
        [first, second, ..] => second - first,
        _ => Vector3::zeros(),
    };
    let shifts: Vec<Vector3<f64>> = alike.iter().map(shift).collect();
    let middle = shifts.iter().sum::<Vector3<f64>>() / shifts.len().max(1) as f64;
    let is_same = shifts.iter().all(|shift| (shift - middle).norm() <= TOLERANCE * middle.norm());
    let in_one_go = |places: &&ObservedPositions| match (places.rows.iter().min(), places.rows.iter().max()) {
        (Some(low), Some(high)) => (high - low) as usize + 1 == places.rows.len(),
        _ => false,
    };
    is_same && !alike.iter().all(in_one_go)
}

/// The most frequent number; the larger one of equally frequent numbers.
fn most_frequent(mut numbers: Vec<usize>) -> Option<usize> {
    numbers.sort_unstable();
    numbers.chunk_by(|a, b| a == b).max_by_key(|same| same.len())?.first().copied()
}

/// Distance of two measurements of one kind in one configuration, metres, if it exceeds a robot's repeatability.
pub(crate) fn contradiction_m(fitter: &Fitter<'_>, a: &Measurement, b: &Measurement) -> Option<f64> {
    let (apart_m, turn) = a.distance_and_angle(b)?;
    (apart_m > CONTRADICTION_SHARE * fitter.reach_m() || turn > CONTRADICTION_RAD).then_some(apart_m)
}
