//! Effect of a growing share of gross errors on a calibration, by loss.

use rayon::prelude::*;
use serde::Serialize;

use super::ReproductionOptions;
use poecal_calibrate::{CalibrationOptions, Loss, Models, RobustLoss, calibrate};
use poecal_fit::state::{PackedValues, Session};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_model::simulate::{GrossErrors, SessionKind, Simulation, elbow, gantry, scara, seven_axis};
use poecal_numerics::error::Result;

/// Shares of wrong rows, percent.
const SHARES: [u32; 11] = [0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50];
/// Rows of a session.
const ROWS: usize = 150;
/// Number of noise-free rows that judge a calibration.
const JUDGING: usize = 200;

/// Effect of gross errors on many simulated sessions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Breakdown {
    /// Number of sessions for each loss and share: the robots in turn, by poses and by points.
    pub sessions: usize,
    /// Rows of a session.
    pub rows: usize,
    /// Seed.
    pub seed: u64,
    /// Entries by loss, then by share.
    pub entries: Vec<BreakdownEntry>,
}

/// One loss and one share of gross errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BreakdownEntry {
    /// `off` (least squares), `huber`, `cauchy` or `tukey`.
    pub robust: String,
    /// Share of wrong rows, percent.
    pub share_percent: u32,
    /// Ratio of the held-out error to that of least squares on the same session without gross errors: median over the sessions.
    pub error_ratio_median: f64,
    /// The same ratio, 95th percentile.
    pub error_ratio_p95: f64,
    /// Share of suspected gross rows; null if there are none.
    pub gross_rows_suspected: Option<f64>,
    /// Share of suspected rows among the others.
    pub other_rows_suspected: f64,
}

/// Spoils simulated sessions of an elbow, a SCARA, a 7-axis arm and a gantry, by poses and by points, and calibrates with every loss.
/// [`ReproductionOptions::trials`] is the number of sessions.
///
/// # Errors
/// Those of [`calibrate`].
pub fn breakdown(options: &ReproductionOptions) -> Result<Breakdown> {
    let robots = [elbow(), scara(), seven_axis(), gantry()];
    let outcomes: Vec<Vec<BreakdownOutcome>> = (0..options.trials)
        .into_par_iter()
        .map(|trial| {
            let kind = if (trial / robots.len()).is_multiple_of(2) { SessionKind::POSE } else { SessionKind::POINT };
            session(&robots[trial % robots.len()], kind, options.seed.wrapping_add(trial as u64))
        })
        .collect::<Result<_>>()?;
    let entries = losses().into_iter().enumerate().flat_map(|(l, (word, _))| {
        let outcomes = &outcomes;
        SHARES.iter().enumerate().map(move |(s, &share_percent)| {
            let own: Vec<&BreakdownOutcome> = outcomes.iter().map(|session| &session[l * SHARES.len() + s]).collect();
            entry(word, share_percent, &own)
        })
    });
    Ok(Breakdown { sessions: options.trials, rows: ROWS, seed: options.seed, entries: entries.collect() })
}

fn losses() -> [(&'static str, RobustLoss); 4] {
    let loss = |loss: Loss| (loss.word(), RobustLoss::Loss(loss));
    [("off", RobustLoss::Off), loss(Loss::Huber), loss(Loss::Cauchy), loss(Loss::Tukey)]
}

/// One loss and share on one session.
struct BreakdownOutcome {
    ratio: f64,
    gross: usize,
    others: usize,
    gross_suspected: usize,
    others_suspected: usize,
}

/// One session with every loss and share.
fn session(robot: &Robot, kind: SessionKind, seed: u64) -> Result<Vec<BreakdownOutcome>> {
    let simulation = Simulation { count: ROWS, seed, ..Simulation::default() };
    let made = simulation.run(robot, kind)?;
    let judging = simulation.held_out(&made, kind, JUDGING)?;
    let fit = |data: &Dataset, robust| {
        calibrate(
            robot,
            data,
            &CalibrationOptions { held_out: Some(0.0), robust, diagnose: false, ..Default::default() },
        )
    };
    let clean = held_out_m(robot, &judging, &fit(&made.data, RobustLoss::Off)?.models);
    let mut outcomes = Vec::with_capacity(4 * SHARES.len());
    for (_, robust) in losses() {
        for share in SHARES {
            let mut data = made.data.clone();
            let gross =
                GrossErrors { share: f64::from(share) / 100.0, seed, ..GrossErrors::default() }.spoil(&mut data);
            let found = fit(&data, robust)?;
            let is_gross = |row: &u32| gross.binary_search(row).is_ok();
            let gross_suspected = found.robustness.suspects().filter(is_gross).count();
            outcomes.push(BreakdownOutcome {
                ratio: held_out_m(robot, &judging, &found.models) / clean,
                gross: gross.len(),
                others: data.len() - gross.len(),
                gross_suspected,
                others_suspected: found.robustness.suspects().count() - gross_suspected,
            });
        }
    }
    Ok(outcomes)
}

/// Root mean square position error on rows free of noise.
fn held_out_m(robot: &Robot, judging: &Dataset, models: &Models) -> f64 {
    let packed = PackedValues::from_dataset(robot, judging);
    let rows: Vec<u32> = (0..u32::try_from(judging.len()).unwrap_or(u32::MAX)).collect();
    let errors = Session::new(robot, judging, &packed, true).errors(&rows, &models.calibrated);
    (errors.iter().map(|e| e.position_m().norm_squared()).sum::<f64>() / errors.len().max(1) as f64).sqrt()
}

fn entry(word: &str, share_percent: u32, outcomes: &[&BreakdownOutcome]) -> BreakdownEntry {
    let mut ratios: Vec<f64> = outcomes.iter().map(|outcome| outcome.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios.get((share * ratios.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    let sum = |of: fn(&BreakdownOutcome) -> usize| outcomes.iter().map(|outcome| of(outcome)).sum::<usize>();
    let share = |suspected: usize, all: usize| (all > 0).then(|| suspected as f64 / all as f64);
    BreakdownEntry {
        robust: word.to_owned(),
        share_percent,
        error_ratio_median: at(0.5),
        error_ratio_p95: at(0.95),
        gross_rows_suspected: share(sum(|o| o.gross_suspected), sum(|o| o.gross)),
        other_rows_suspected: share(sum(|o| o.others_suspected), sum(|o| o.others)).unwrap_or(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_loss_meets_every_share_of_gross_errors() {
        let found = breakdown(&ReproductionOptions { trials: 1, ..ReproductionOptions::default() }).unwrap();
        assert_eq!((found.sessions, found.entries.len()), (1, 4 * 11));
    }
}
