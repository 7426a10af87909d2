//! Choice of candidates by the criterion of a plan, and improvement near them.

use nalgebra::DMatrix;

use super::blocks::ConfigurationRows;
use super::conditions::Checker;
use super::experiment::inverse;
use super::make::Planner;
use super::options::PlanCriterion;
use super::order::TravelDistance;
use super::search::{PlanSearch, improve_nearby};
use super::state::{CriterionContext, CriterionWeights};
use poecal_model::robot::ReadingKind;
use poecal_model::simulate::random;
use poecal_numerics::error::Result;
use poecal_numerics::linalg;

/// Rounds of the search around each configuration, proposals for each, and the largest and smallest step in radians.
const ROUNDS: usize = 24;
const PROPOSALS: usize = 6;
const STEPS: [f64; 2] = [0.4, 0.01];
/// Rounds, and the power, by which the largest variance is reduced.
const LARGEST_ROUNDS: usize = 6;

impl Planner<'_> {
    /// The candidates of the list, by the criterion.
    pub(crate) fn choose(&self, count: usize) -> Vec<usize> {
        let travel = TravelDistance::new(&self.experiment.robot, self.experiment.length_m());
        let (width, least) = (self.experiment.width(), self.options.conditions.separation_rad);
        let at = |index: usize| &self.candidates[index * width..(index + 1) * width];
        let apart = |a: usize, b: usize| least <= 0.0 || travel.distance(at(a), at(b)) >= least;
        let best = |aim: &CriterionContext, kept: &DMatrix<f64>, blocks: &ConfigurationRows| {
            PlanSearch { aim, kept, blocks, apart: &apart }.list(count, self.options.seed)
        };
        if self.options.criterion == PlanCriterion::Expected {
            return best(&self.aim, &self.kept, &self.blocks);
        }
        let g = self.experiment.geometry();
        let blocks = self.blocks.first_columns(g);
        let kept = self.kept.view((0, 0), (g, g)).into_owned();
        let aim = |moments: DMatrix<f64>, determinant: f64| {
            let calibrated = if determinant > 0.0 { 0.0 } else { 1.0 };
            CriterionContext::new(
                &self.experiment.prior,
                moments,
                CriterionWeights { calibrated, corrected: 0.0, determinant },
                self.experiment.share(),
            )
        };
        match self.options.criterion {
            PlanCriterion::Expected | PlanCriterion::D => best(&aim(DMatrix::identity(g, g), 1.0), &kept, &blocks),
            PlanCriterion::A => best(&aim(DMatrix::identity(g, g), 0.0), &kept, &blocks),
            PlanCriterion::E | PlanCriterion::G => {
                self.choose_minimax(&kept, &blocks, |moments| best(&aim(moments, 0.0), &kept, &blocks))
            }
        }
    }

    /// A list with a small largest variance: the weights of its mean squares follow a power of the variances of the list before.
    pub(crate) fn choose_minimax(
        &self,
        kept: &DMatrix<f64>,
        blocks: &ConfigurationRows,
        best: impl Fn(DMatrix<f64>) -> Vec<usize>,
    ) -> Vec<usize> {
        let g = self.experiment.geometry();
        let is_e = self.options.criterion == PlanCriterion::E;
        let mut moments =
            if is_e { DMatrix::identity(g, g) } else { self.aim.moments.view((0, 0), (g, g)).into_owned() };
        let mut found: Option<(f64, Vec<usize>)> = None;
        for _ in 0..LARGEST_ROUNDS {
            let chosen = best(moments.clone());
            let h = kept + blocks.gram(chosen.iter().copied()) + &self.experiment.prior;
            let Some(covariance) = inverse(&h) else { break };
            let value = if is_e {
                let (values, vectors) = linalg::symmetric_eigen(covariance.as_slice(), g);
                let most = values.last().copied().unwrap_or(0.0);
                let weights = nalgebra::DVector::from_iterator(g, values.iter().map(|it| (it / most).powi(3)));
                moments = &vectors * DMatrix::from_diagonal(&weights) * vectors.transpose();
                most
            } else {
                let each = self.experiment.each_moment(&self.workspace);
                let variances: Vec<f64> = each.iter().map(|rows| (rows * &covariance).dot(rows)).collect();
                let most = variances.iter().copied().fold(0.0, f64::max);
                moments = DMatrix::zeros(g, g);
                for (rows, variance) in each.iter().zip(&variances) {
                    moments += rows.transpose() * rows * ((variance / most).powi(3) / each.len() as f64);
                }
                most
            };
            if found.as_ref().is_none_or(|(least, _)| value < *least) {
                found = Some((value, chosen));
            }
        }
        found.map(|it| it.1).unwrap_or_default()
    }

    /// Searches around each configuration for better ones.
    pub(crate) fn refine(&mut self, readings: &mut [Vec<f64>], rows: &mut ConfigurationRows) -> Result<()> {
        let robot = &self.experiment.robot;
        let checker =
            Checker::new(robot, &self.options.conditions).with_avoided(&self.avoided, self.experiment.length_m());
        let travel = TravelDistance::new(robot, self.experiment.length_m());
        let least = self.options.conditions.separation_rad;
        let kinds: Vec<ReadingKind> = robot.reading_names().iter().map(|name| robot.reading_kind(name)).collect();
        for round in 0..ROUNDS {
            let share = round as f64 / (ROUNDS - 1) as f64;
            let step = STEPS[0] * (STEPS[1] / STEPS[0]).powf(share);
            let (mut proposals, mut owners) = (Vec::new(), Vec::new());
            for (owner, own) in readings.iter().enumerate() {
                for proposal in 0..PROPOSALS {
                    let mut near = own.clone();
                    // All joints, or a single one.
                    let only = (proposal % 2 == 1)
                        .then(|| (random::uniform_number(&mut self.generator) * kinds.len() as f64) as usize);
                    for (joint, (value, kind)) in near.iter_mut().zip(&kinds).enumerate() {
                        let by = step * random::normal(&mut self.generator);
                        if only.is_none_or(|only| only == joint) {
                            match kind {
                                ReadingKind::Angle => *value += by,
                                ReadingKind::Length => *value += by * self.experiment.length_m(),
                                ReadingKind::Factor => {}
                            }
                        }
                    }
                    let near = checker.configurations().nearest_to(&near);
                    if checker.obstacle_to_measuring(&near).is_none() {
                        proposals.extend(near);
                        owners.push(owner);
                    }
                }
            }
            let blocks = self.experiment.blocks(&proposals)?;
            let width = self.experiment.width();
            improve_nearby(&self.aim, &self.kept, rows, &blocks, &owners, |row, proposal| {
                let own = &proposals[proposal * width..(proposal + 1) * width];
                let others = readings.iter().enumerate().filter(|it| it.0 != row);
                let is_apart = least <= 0.0 || others.clone().all(|(_, it)| travel.distance(own, it) >= least);
                if is_apart {
                    readings[row].copy_from_slice(own);
                }
                is_apart
            });
        }
        Ok(())
    }
}
