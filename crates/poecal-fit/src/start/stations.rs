//! Registration of a device with one station or several, each with a frame of its own while the targets stayed on the arm.

use std::cmp::Reverse;

use super::one_station::{at_one_station, roughly_at_one_station};
use super::registration::{Registration, polish};
use crate::state::{ClockTerm, Estimate, Session, Unknowns};
use poecal_arm::lie::Freedom;

/// Rows that determine a device frame if the targets are known: three points.
const FEWEST: usize = 3;

/// Registers the data to an estimate's screws: several closed-form starts, the best polished to the optimum. Its cost (`½ Σ e²`
/// of whitened residuals) is returned with it.
#[must_use]
pub fn register(problem: &Registration<'_>, start: &Estimate) -> (Estimate, f64) {
    if problem.session.device_free && !start.further_devices.is_empty() {
        return polish(problem, one_by_one(problem, start), problem.rows.to_vec(), 50);
    }
    at_one_station(problem, start)
}

/// Registers by the best closed form and a few iterations, to compare many hypotheses, of which the best are registered in full
/// afterwards.
#[must_use]
pub(crate) fn register_roughly(problem: &Registration<'_>, start: &Estimate) -> Estimate {
    if problem.session.device_free && !start.further_devices.is_empty() {
        return polish(problem, one_by_one(problem, start), problem.rows.to_vec(), 8).0;
    }
    roughly_at_one_station(problem, start)
}

/// Estimates each frame from its own rows, that with the most rows first; the targets estimated with it are known to the others (theory.md
/// §6, *Start*).
fn one_by_one(problem: &Registration<'_>, start: &Estimate) -> Estimate {
    let unknowns = problem.session.unknowns;
    // The data set has one station: each registration uses the rows of one station only.
    let alone = problem.session.data.without_stations();
    let mut stations: Vec<(usize, Vec<u32>)> = (0..problem.session.data.station_count())
        .map(|station| (station, problem.session.data.seen_from(station, problem.rows)))
        .filter(|(_, rows)| !rows.is_empty())
        .collect();
    // A held frame is known; a device that measures positions determines its frame best.
    stations.sort_by_key(|(station, rows)| {
        Reverse((
            !unknowns.moves_frame(*station),
            problem.session.data.device_freedom(*station, rows) == Freedom::FRAME,
            rows.len(),
        ))
    });
    let mut found = start.clone();
    let is_known = |target| !problem.targets_free || !unknowns.moves_target(target);
    let mut known: Vec<bool> = (0..start.base_from_target.len()).map(is_known).collect();
    for (station, rows) in stations {
        let target = |row: &u32| alone.observations[*row as usize].target;
        let of_known: Vec<u32> = rows.iter().copied().filter(|row| known[target(row)]).collect();
        let by_known = of_known.len() >= FEWEST.min(rows.len());
        let rows = if by_known { of_known } else { rows };
        let device_free = unknowns.moves_frame(station);
        let ranges = unknowns.ranges.iter().filter(|(at, _)| *at == station).map(|&(_, term)| (0, term));
        // All clocks are estimated together, once the frames are.
        let held_clocks = ClockTerm::ALL.map(|term| (0, term)).to_vec();
        let of_one = Unknowns { held_frames: Vec::new(), ranges: ranges.collect(), held_clocks, ..unknowns.clone() };
        let session = Session { data: &alone, noise_ratios: &[], device_free, unknowns: &of_one, ..problem.session };
        let noise = problem.session.usual_noise(station, problem.noise);
        let one = Registration { noise, session, rows: &rows, targets_free: !by_known, prior: problem.prior };
        let (seen, _) = at_one_station(&one, &found.seen_from(station));
        *found.device_mut(station) = seen.device_from_base;
        let range = seen.range(0);
        if range != found.range(station) {
            *found.range_mut(station) = range;
        }
        if !by_known {
            for row in &rows {
                let target = target(row);
                found.base_from_target[target] = seen.base_from_target[target];
                known[target] = true;
            }
        }
    }
    found
}
