//! Witness configurations: those among the measured ones whose repeats detect the smallest shifts.

use std::collections::BTreeSet;

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::explain::{HypothesisTests, NoiseLevel, ProjectedChanges, leave_unseen_out, pick_columns};
use super::hypotheses::{find_free_columns, hypotheses};
use super::model::VisitModel;
use super::options::TrackOptions;
use super::pairs::VisitChanges;
use super::sight::{JointSight, joints};
use super::visit::{ColumnSubject, Visit};
use super::visit_judgement::earlier_visit;
use crate::calibration_file::CalibrationFile;
use poecal_model::measurement::Dataset;
use poecal_model::simulate::random::uniform_number;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::linalg;

/// Most configurations among which witnesses are chosen, evenly, and starts of the exchange.
const MOST: usize = 300;
const STARTS: usize = 4;
/// Most rounds of the exchange, which usually ends before.
const ROUNDS: usize = 30;
/// Weight of the distinction of joints relative to the size of their detectable shifts.
const APART: f64 = 0.2;
/// Weight of the detection of a displaced tool.
const OF_TOOL: f64 = 1.0;
/// Ridge of the information, as a share of its diagonal.
const RIDGE: f64 = 1e-9;
/// Standard deviation beyond which a joint is not seen, radians or metres.
const UNSEEN: f64 = 0.01;

/// Chosen configurations, and the detectable shifts of their repeats.
#[derive(Clone, Debug, PartialEq)]
pub struct Witnesses {
    /// Rows of the chosen configurations, by configuration.
    pub configurations: Vec<Vec<u32>>,
    /// The rows of these configurations; for new configurations, as if they had been measured.
    pub rows: Dataset,
    /// Detectability of each joint's shift.
    pub joints: Vec<JointSight>,
    /// Standard deviation of a visit and coordinate for which this holds, metres.
    pub sigma_m: f64,
}

/// Information of each configuration about the free unknowns and about the zeros.
struct Candidates {
    all: Vec<DMatrix<f64>>,
    /// Number of columns of free unknowns: the first ones.
    free: usize,
    /// Columns of the tool, behind the zeros.
    tool: usize,
    /// Zeros that are seen at all.
    seen: Vec<usize>,
}

impl Candidates {
    fn sum(&self, chosen: &[usize]) -> DMatrix<f64> {
        let n = self.all.first().map_or(0, DMatrix::nrows);
        chosen.iter().fold(DMatrix::zeros(n, n), |sum, at| sum + &self.all[*at])
    }

    /// Standard deviation of each zero alone, and beside all others; and of the tool as the mean over its directions.
    fn deviations(&self, sum: &DMatrix<f64>) -> (Vec<(f64, f64)>, f64) {
        let n = sum.nrows();
        let ridge = |matrix: &mut DMatrix<f64>| {
            (0..matrix.nrows()).for_each(|at| matrix[(at, at)] += RIDGE * matrix[(at, at)].max(f64::MIN_POSITIVE));
        };
        let k = self.free;
        let mut own = sum.view((0, 0), (k, k)).into_owned();
        ridge(&mut own);
        let beside = sum.view((0, k), (k, n - k)).into_owned();
        let left = sum.view((k, k), (n - k, n - k)).into_owned();
        let left = match linalg::whiten_columns(own, &beside) {
            Some(whitened) => left - whitened.tr_mul(&whitened),
            None => return (vec![(f64::INFINITY, f64::INFINITY); n - k], f64::INFINITY),
        };
        let tool = mean_information(&left, self.tool);
        let seen = left.select_rows(&self.seen).select_columns(&self.seen);
        let mut held = seen.clone();
        ridge(&mut held);
        let count = self.seen.len();
        let upper: Vec<f64> = (0..count * count).map(|at| held[(at / count, at % count)]).collect();
        let apart = linalg::cholesky(&upper, count, 0.0).map(|factor| linalg::inverse(&factor));
        let deviation = |information: f64| if information > 0.0 { information.powf(-0.5) } else { f64::INFINITY };
        let each = (0..count).map(|at| {
            let variance = apart.as_ref().map_or(f64::INFINITY, |it| it[at * count + at]);
            (deviation(seen[(at, at)]), variance.max(0.0).sqrt())
        });
        (each.collect(), if self.tool == 0 { 0.0 } else { deviation(tool) })
    }

    /// Objective of the exchange: weighted logarithms of the worst deviation of a joint alone, of one beside all others, and of the tool's.
    fn cost(&self, sum: &DMatrix<f64>) -> f64 {
        let (each, tool) = self.deviations(sum);
        let (alone, apart) =
            each.into_iter().fold((0.0, 0.0), |most: (f64, f64), it| (most.0.max(it.0), most.1.max(it.1)));
        let tool = if tool > 0.0 { OF_TOOL * tool.min(1.0).ln() } else { 0.0 };
        alone.ln() + APART * apart.min(1.0).ln() + tool
    }
}

/// Information on the last unknowns, as the geometric mean over its directions: it describes knocks of random direction.
fn mean_information(all: &DMatrix<f64>, count: usize) -> f64 {
    let from = all.nrows() - count;
    let upper: Vec<f64> = (0..count * count).map(|k| all[(from + k / count, from + k % count)]).collect();
    let (each, _) = linalg::symmetric_eigen(&upper, count);
    let logarithms = each.iter().map(|it| it.max(f64::MIN_POSITIVE).ln()).sum::<f64>();
    (logarithms / count.max(1) as f64).exp()
}

/// Chooses `count` of the measured configurations by exchange, so that their repeats detect the smallest shift of the worst joint. With `new`,
/// readings of configurations in sequence, the choice is among these, with the measured quantities of the first measured configuration. If `target`
/// is named, it alone is measured.
///
/// # Errors
/// [`ErrorKind::Problem`] if there are fewer configurations than requested, or so few that nothing would be detected; [`ErrorKind::Option`] if no row
/// is of the target; [`ErrorKind::Model`] if the file holds no valid calibration.
pub fn witnesses(
    file: &CalibrationFile,
    measured: &Dataset,
    new: Option<&[f64]>,
    count: usize,
    target: Option<&str>,
    options: &TrackOptions,
) -> Result<Witnesses> {
    let model = VisitModel::from_calibration(file, options)?;
    let elsewhere = new.map(|readings| rows_elsewhere(&model, measured, readings)).transpose()?;
    let measured = elsewhere.as_ref().unwrap_or(measured);
    let data = &*file.at_stage(measured, file.stages());
    let same_tool = TrackOptions { tool_is_anew: false, ..*options };
    let visit = match new {
        None => earlier_visit(&model, data, &same_tool)?,
        // Configurations that were not measured do not determine the device: it is as in the calibration.
        Some(_) => Visit::from_measurements(&model, data, true, &same_tool)?,
    };
    let visit = Visit { device_is_known: options.device_is_known, ..visit };
    let rows = rows_of_target(data, target)?;
    let all = data.configurations(&rows);
    if all.len() < count {
        return ErrorKind::Problem.refuse(format!(
            "found {} {} configurations, expected at least the {count} to be chosen: ask for fewer",
            all.len(),
            if new.is_some() { "new" } else { "measured" }
        ));
    }
    let some: Vec<Vec<u32>> = all.iter().step_by(all.len().div_ceil(MOST).max(1)).cloned().collect();
    let candidates = candidates(&visit, &some, options);
    let numbers = |configurations: &[usize]| -> Vec<usize> {
        let rows = configurations.iter().flat_map(|at| &some[*at]);
        rows.flat_map(|&row| visit.starts[row as usize]..visit.starts[row as usize + 1]).collect()
    };
    let fewest = candidates.free + candidates.seen.len().min(1) + 1;
    let chosen = exchange_choices(&candidates, count.min(some.len()));
    let own = numbers(&chosen);
    if own.len() < fewest {
        return ErrorKind::Problem.refuse(format!(
            "found {count} configurations with {} measured numbers, expected more than the {fewest} that device, tool and one shift need: choose more",
            own.len()
        ));
    }
    let changes = of_repeats(&visit, &own);
    let mut hypotheses = hypotheses(&changes.jacobian, &visit, options);
    let evidence = ProjectedChanges::new(
        &changes.residual,
        &super::hypotheses::find_free_columns(&changes.jacobian, &visit, options),
    );
    leave_unseen_out(&mut hypotheses, &evidence, NoiseLevel::Known(1.0));
    let tests = HypothesisTests::new(&hypotheses);
    let freedom =
        if options.repeatability_m.is_some() { f64::INFINITY } else { (own.len() - candidates.free - 1) as f64 };
    let joints = joints(&changes, &visit, &model, (&hypotheses, &tests), (1.0, freedom), options);
    let configurations = chosen.iter().map(|at| some[*at].clone()).collect();
    let sigma_m = model.noise[poecal_model::measurement::Quantity::Position];
    Ok(Witnesses { configurations, rows: measured.clone(), joints, sigma_m })
}

/// The rows of a target, if one is named; else all.
fn rows_of_target(data: &Dataset, target: Option<&str>) -> Result<Vec<u32>> {
    let is_named = |row: &u32| {
        let own = data.observations[*row as usize].target;
        target.is_none_or(|target| data.targets.get(own).and_then(Option::as_deref) == Some(target))
    };
    let rows: Vec<u32> = data.all_rows().into_iter().filter(is_named).collect();
    if let (true, Some(target)) = (rows.is_empty(), target) {
        let names: Vec<&str> = data.targets.iter().flatten().map(String::as_str).collect();
        return ErrorKind::Option.refuse(format!(
            "found no row of target `{target}`, expected one of {}",
            poecal_numerics::error::first_few(&names)
        ));
    }
    Ok(rows)
}

/// The rows of the first measured configuration as if they had been measured in others, once in each.
fn rows_elsewhere(model: &VisitModel, measured: &Dataset, readings: &[f64]) -> Result<Dataset> {
    let first = measured.configurations(&measured.all_rows()).into_iter().next().unwrap_or_default();
    let width = model.robot.reading_names().len();
    let mut seen = BTreeSet::new();
    let is_new = |one: &&[f64]| seen.insert(one.iter().map(|it| it.to_bits()).collect::<Vec<u64>>());
    let once: Vec<f64> = readings.chunks(width.max(1)).filter(is_new).flatten().copied().collect();
    measured.as_if_at(&first, &once, width)
}

/// Changes of rows from their own repeats, as if nothing had changed.
fn of_repeats(visit: &Visit, numbers: &[usize]) -> VisitChanges {
    let sigma = visit.sigma.select_rows(numbers) * std::f64::consts::SQRT_2;
    let mut jacobian = visit.jacobian.select_rows(numbers);
    jacobian.row_iter_mut().zip(sigma.iter()).for_each(|(mut row, sigma)| row /= *sigma);
    VisitChanges { residual: sigma.map(|_| 0.0), jacobian, sigma, scatter: (0.0, 0.0), rows: Vec::new() }
}

fn candidates(visit: &Visit, configurations: &[Vec<u32>], options: &TrackOptions) -> Candidates {
    let information = |rows: &Vec<u32>| {
        let own = rows.iter().flat_map(|&row| visit.starts[row as usize]..visit.starts[row as usize + 1]);
        let changes = of_repeats(visit, &own.collect::<Vec<usize>>());
        let free = find_free_columns(&changes.jacobian, visit, options);
        let zeros = pick_columns(&changes.jacobian, &visit.columns, |of| matches!(of, ColumnSubject::Zero(_)));
        let tool = pick_columns(&changes.jacobian, &visit.columns, |of| {
            matches!(of, ColumnSubject::Target(_)) && !options.tool_is_anew
        });
        let (k, n) = (free.ncols(), zeros.ncols());
        let mut both = DMatrix::zeros(free.nrows(), k + n + tool.ncols());
        both.columns_mut(0, k).copy_from(&free);
        both.columns_mut(k, n).copy_from(&zeros);
        both.columns_mut(k + n, tool.ncols()).copy_from(&tool);
        ((k, tool.ncols()), both.tr_mul(&both))
    };
    let (counts, all): (Vec<(usize, usize)>, Vec<DMatrix<f64>>) = configurations.iter().map(information).unzip();
    let (free, mut tool) = counts.first().copied().unwrap_or_default();
    let zeros = all.first().map_or(0, DMatrix::nrows) - free - tool;
    if tool > 6 {
        // With several targets the tool is seen well.
        tool = 0;
    }
    let all: Vec<DMatrix<f64>> =
        all.into_iter().map(|it| it.view((0, 0), (free + zeros + tool, free + zeros + tool)).into_owned()).collect();
    let found = Candidates { all, free, tool, seen: (0..zeros).collect() };
    let every: Vec<usize> = (0..configurations.len()).collect();
    let share = configurations.len() as f64 / 8.0;
    let (deviations, _) = found.deviations(&(found.sum(&every) / share.max(1.0)));
    let seen = (0..zeros).filter(|&at| deviations[at].0 < UNSEEN).collect();
    Candidates { seen, ..found }
}

/// The best choice of several starts.
fn exchange_choices(candidates: &Candidates, count: usize) -> Vec<usize> {
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let total = candidates.all.len();
    let mut best: Option<(f64, Vec<usize>)> = None;
    for _ in 0..STARTS {
        let mut chosen: Vec<usize> = Vec::with_capacity(count);
        while chosen.len() < count {
            let drawn = ((uniform_number(&mut generator) * total as f64) as usize).min(total - 1);
            if !chosen.contains(&drawn) {
                chosen.push(drawn);
            }
        }
        let mut cost = candidates.cost(&candidates.sum(&chosen));
        for _ in 0..ROUNDS {
            let mut is_better = false;
            for place in 0..count {
                let without: Vec<usize> =
                    chosen.iter().copied().enumerate().filter(|(at, _)| *at != place).map(|it| it.1).collect();
                let rest = candidates.sum(&without);
                let others = (0..total).filter(|at| !chosen.contains(at));
                let costs = others.map(|at| (candidates.cost(&(&rest + &candidates.all[at])), at));
                let Some((least, at)) = costs.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
                if least < cost - 1e-9 {
                    (cost, chosen[place], is_better) = (least, at, true);
                }
            }
            if !is_better {
                break;
            }
        }
        if best.as_ref().is_none_or(|best| cost < best.0) {
            best = Some((cost, chosen));
        }
    }
    let mut chosen = best.map_or_else(Vec::new, |it| it.1);
    chosen.sort_unstable();
    chosen
}
