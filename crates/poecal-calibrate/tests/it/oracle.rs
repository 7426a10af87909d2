//! Faults of robots and of sessions are planted in the fitted rows; clean rows of the same robot judge the predicted bounds.

use poecal_testing::sessions::geometry;
use std::collections::BTreeMap;

use nalgebra::Vector3;
use poecal_calibrate::{
    CalibrationOptions, JudgedCalibration, Level, PredictedUncertainty, RobustLoss, calibrate, judge,
};
use poecal_model::measurement::{ByQuantity, Dataset, Measurement, Quantity};
use poecal_model::simulate::{SessionKind, Simulation, elbow, random};
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};
use rayon::prelude::*;

/// Sessions, half of them with stated noise.
const SESSIONS: usize = 240;
const NOISE_M: f64 = 5e-5;

/// A row: readings in radians, position in metres.
#[derive(Clone)]
struct Row {
    readings: Vec<f64>,
    place: Vector3<f64>,
}

/// One of some values.
fn draw_one_of<T: Copy>(generator: &mut ChaCha8Rng, of: &[T]) -> T {
    of[draw_below(generator, of.len())]
}

fn draw_below(generator: &mut ChaCha8Rng, count: usize) -> usize {
    (generator.next_u64() % count as u64) as usize
}

/// Effects of the robot that its model does not describe, in all rows, including those that judge.
fn add_physical_effect(rows: &mut [Row], generator: &mut ChaCha8Rng) -> &'static str {
    let kind =
        draw_one_of(generator, &["none", "none", "none", "gear", "ripple", "backlash", "sag", "scale", "rounded"]);
    let joint = draw_below(generator, 6);
    match kind {
        "gear" => {
            let factor = 1.0 + draw_one_of(generator, &[1e-4, 3e-4, 1e-3, 3e-3]);
            rows.iter_mut().for_each(|row| row.readings[joint] *= factor);
        }
        "ripple" => {
            let (size, times) =
                (draw_one_of(generator, &[0.01f64, 0.03, 0.1]).to_radians(), draw_one_of(generator, &[1.0, 2.0, 3.0]));
            rows.iter_mut().for_each(|row| row.readings[joint] += size * (times * row.readings[joint]).sin());
        }
        "backlash" => {
            let size = draw_one_of(generator, &[0.01f64, 0.03, 0.1]).to_radians();
            rows.iter_mut().for_each(|row| row.readings[joint] += size * draw_one_of(generator, &[-1.0, 1.0]));
        }
        "sag" => {
            let size = draw_one_of(generator, &[1e-4, 3e-4, 1e-3]);
            let first = rows[0].place;
            rows.iter_mut().for_each(|row| row.place.z -= size * (row.place - first).xy().norm());
        }
        "scale" => {
            let factor = 1.0 + draw_one_of(generator, &[1e-5, 1e-4, 1e-3]);
            rows.iter_mut().for_each(|row| row.place *= factor);
        }
        "rounded" => {
            let step = draw_one_of(generator, &[0.01f64, 0.1, 0.5]).to_radians();
            rows.iter_mut().flat_map(|row| &mut row.readings).for_each(|value| *value = (*value / step).round() * step);
        }
        _ => {}
    }
    kind
}

/// Faults of a session, in the fitted rows alone.
fn fault(rows: &mut Vec<Row>, generator: &mut ChaCha8Rng) -> &'static str {
    let faults = [
        "none",
        "none",
        "cell",
        "bias",
        "duplicates",
        "repeats",
        "shuffled",
        "drift",
        "noise",
        "rounded places",
        "half a joint",
        "frozen",
        "few",
        "zeros",
        "columns",
        "sign",
        "moved",
    ];
    let kind = draw_one_of(generator, &faults);
    let count = rows.len();
    let (joint, first) = (draw_below(generator, 6), draw_below(generator, count));
    let last = count.min(first + 2 + draw_below(generator, count / 2 - 2));
    match kind {
        "cell" => {
            for _ in 0..draw_one_of(generator, &[1, 3, 10]) {
                let (row, factor) = (draw_below(generator, count), draw_one_of(generator, &[1.01, -1.0, 10.0, 0.1]));
                match draw_below(generator, 9) {
                    cell @ 0..6 => rows[row].readings[cell] *= factor,
                    cell => rows[row].place[cell - 6] *= factor,
                }
            }
        }
        "bias" => {
            let size = draw_one_of(generator, &[1e-4, 5e-4, 2e-3, 1e-2]);
            rows[first..last].iter_mut().for_each(|row| row.place.x += size);
        }
        "duplicates" => {
            let times = draw_one_of(generator, &[2, 5]);
            let some = rows[..(count / times).max(12)].to_vec();
            *rows = (0..times).flat_map(|_| some.clone()).collect();
        }
        "repeats" => {
            let some = rows[..draw_one_of(generator, &[10, 15, 20])].to_vec();
            let again = (0..count).map(|k| {
                let mut row = some[k % some.len()].clone();
                row.readings.iter_mut().for_each(|value| *value += 8.7e-5 * random::normal(generator));
                row.place += 1e-5 * random::normal_vector(generator);
                row
            });
            *rows = again.collect();
        }
        "shuffled" => {
            for row in first + 1..last {
                let other = first + draw_below(generator, row - first + 1);
                let place = rows[row].place;
                rows[row].place = std::mem::replace(&mut rows[other].place, place);
            }
        }
        "drift" => {
            let size = draw_one_of(generator, &[2e-4, 1e-3, 5e-3]);
            rows.iter_mut().enumerate().for_each(|(k, row)| row.place.x += size * k as f64 / count as f64);
        }
        "noise" => {
            let size = draw_one_of(generator, &[5e-4, 2e-3]);
            rows[first..last].iter_mut().for_each(|row| row.place += size * random::normal_vector(generator));
        }
        "rounded places" => {
            let step = draw_one_of(generator, &[1e-4, 1e-3]);
            rows.iter_mut().for_each(|row| row.place = row.place.map(|value| (value / step).round() * step));
        }
        "half a joint" => {
            let mut values: Vec<f64> = rows.iter().map(|row| row.readings[joint]).collect();
            values.sort_by(f64::total_cmp);
            rows.retain(|row| row.readings[joint] < values[count / 2]);
        }
        "frozen" => {
            let value = rows[first].readings[joint];
            rows[first..last].iter_mut().for_each(|row| row.readings[joint] = value);
        }
        "few" => rows.truncate(draw_one_of(generator, &[12, 14, 16, 20, 30])),
        "zeros" => rows[first..last.min(first + 10)].iter_mut().for_each(|row| row.place = Vector3::zeros()),
        "columns" => rows[first..last].iter_mut().for_each(|row| row.readings.swap(joint.min(4), joint.min(4) + 1)),
        "sign" => rows[first..last].iter_mut().for_each(|row| row.readings[joint] = -row.readings[joint]),
        "moved" => rows[count * 4 / 5..].iter_mut().for_each(|row| row.place += Vector3::new(0.0, 3e-3, 4e-3)),
        _ => {}
    }
    kind
}

fn dataset(rows: &[Row]) -> Dataset {
    let mut data = Dataset::new(elbow().reading_names());
    for row in rows {
        data.push(&row.readings, None, Measurement::point(row.place)).unwrap();
    }
    data
}

/// The level, and a mark of exceeded bounds: fewer than 80 % of the errors inside, or more than twice the expected error.
type Outcome = (Level, Option<bool>);

fn session(seed: u64) -> (String, bool, Option<Outcome>) {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let simulation = Simulation { count: 400, seed: 21 + seed % 7, ..Simulation::default() };
    let made = simulation.run(&elbow(), SessionKind::POINT).unwrap();
    let mut rows: Vec<Row> = (0..made.data.len())
        .map(|row| Row {
            readings: made.data.readings(row).to_vec(),
            place: made.data.observations[row].measurement.pose().translation,
        })
        .collect();
    let robot = add_physical_effect(&mut rows, &mut generator);
    let mut fitted = rows[..draw_one_of(&mut generator, &[40, 60, 100, 200])].to_vec();
    let wrong = fault(&mut fitted, &mut generator);
    let is_stated = seed.is_multiple_of(2);
    let usual = CalibrationOptions { diagnose: true, move_tip: true, ..geometry() };
    let options = match draw_below(&mut generator, 4) {
        0 => CalibrationOptions { held_out: Some(0.0), ..usual },
        1 => CalibrationOptions { held_out: Some(0.5), ..usual },
        2 => CalibrationOptions { robust: RobustLoss::Off, ..usual },
        _ => usual,
    };
    // A stated noise that is too large or too small is one of the faults.
    let sigma_m = NOISE_M * draw_one_of(&mut generator, &[1.0, 1.0, 1.0, 0.2, 5.0]);
    let options = CalibrationOptions {
        sigma: ByQuantity::default().with_value(Quantity::Position, is_stated.then_some(sigma_m)),
        ..options
    };
    let words = format!("{robot}, {wrong}");
    let Ok(found) = calibrate(&made.nominal, &dataset(&fitted), &options) else {
        return (words, is_stated, None);
    };
    let predicted = found.trust.uncertainty.as_ref().map(|uncertainty| PredictedUncertainty {
        uncertainty,
        targets: &[0],
        coverage: &found.trust.coverage,
    });
    let subject = JudgedCalibration {
        calibrated: &found.robot,
        nominal: &found.nominal,
        base_from_device: found.base_from_device,
        further_base_from_device: &[],
        ranges: &[],
        frame: found.frame,
        noise: found.noise,
        refit_frame: false,
        refit_tool: false,
        uncertainty: predicted,
    };
    let judgement = judge(&subject, &dataset(&rows[200..])).unwrap();
    let broken = judgement.promised.map(|kept| {
        kept.position_mm().inside_bound95 < 0.8
            || judgement.calibrated.position_mm().rms > 2.0 * kept.position_mm().expected_rms
    });
    (words, is_stated, Some((found.verdict.level, broken)))
}

#[test]
fn promises_of_good_calibrations_are_kept() {
    let sessions = trials(SESSIONS);
    let all: Vec<_> = sessions.seeds().into_par_iter().map(|seed| (seed, session(seed))).collect();
    let mut levels: BTreeMap<(bool, Level), (usize, usize)> = BTreeMap::new();
    for (seed, (words, is_stated, outcome)) in &all {
        let Some((level, broken)) = outcome else { continue };
        let count = levels.entry((*is_stated, *level)).or_default();
        count.0 += 1;
        if *broken == Some(true) {
            count.1 += 1;
            println!("seed {seed}: {words}: {} is broken, noise stated: {is_stated}", level.words());
        }
    }
    println!("{} sessions", sessions.count);
    for ((is_stated, level), (count, broken)) in &levels {
        println!("noise stated {is_stated}, {}: {broken} of {count} broken", level.words());
    }
    for is_stated in [false, true] {
        let (count, broken) = levels.get(&(is_stated, Level::Good)).copied().unwrap_or_default();
        // Enough of them to detect one in ten.
        let enough = 25.0 / SESSIONS as f64 - sessions.more_of_a_share(25.0 / SESSIONS as f64);
        assert!(count as f64 >= enough * sessions.count as f64, "{count}");
        let share = 0.03 + sessions.more_of_a_share(0.03);
        assert!(broken as f64 <= share * count as f64, "{broken} of {count}");
    }
}
