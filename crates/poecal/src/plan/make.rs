//! A plan: configurations that determine the most, rows to judge by, and how the expected error falls with their number.

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::conditions::{Checker, Obstacle, Refusals};
use super::expected::{CurvePoint, ExpectedErrors, enough};
use super::experiment::{Blocks, Experiment, WORKSPACE, inverse, undetermined};
use super::options::{PlanCriterion, PlanOptions};
use super::order::Travel;
use super::rows::{PlannedRow, RowPart, with_returns};
use super::search::{Search, around};
use super::state::{Aim, MOST_NUMBERS, Squares, Weights};
use crate::error::{ErrorKind, Result};
use crate::linalg;
use crate::robot::{ReadingKind, Robot};
use crate::simulate::{Configurations, random};

/// Random configurations that are tried for each one of a workspace.
const ATTEMPTS: usize = 200;
/// Random lists to which a plan is compared.
const RANDOM: usize = 32;
/// Rounds of the search around each configuration, proposals for each, and the largest and smallest step in radians.
const ROUNDS: usize = 24;
const PROPOSALS: usize = 6;
const STEPS: [f64; 2] = [0.4, 0.01];
/// Numbers of configurations of the curve.
const COUNTS: [usize; 13] = [5, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100];
/// Candidates of the curve.
const OF_CURVE: usize = 800;
/// Rounds, and the power, by which the largest variance is made small.
const LARGEST_ROUNDS: usize = 6;

/// A plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The rows in the order in which to measure them.
    pub rows: Vec<PlannedRow>,
    /// Expected errors of a fit of the planned rows.
    pub expected: ExpectedErrors,
    /// Median expected errors of as many random configurations.
    pub random: ExpectedErrors,
    /// Expected errors of fewer and more planned configurations, where they were wanted.
    pub curve: Vec<CurvePoint>,
    /// Number of configurations from which 10 more gain less than 5 %.
    pub enough: Option<usize>,
    /// Unknowns of geometry, and numbers that a configuration gives.
    pub unknowns: usize,
    /// Numbers that a configuration gives.
    pub numbers: usize,
    /// Whether the robot error is a guess: 0.3 mm for each metre of reach.
    pub robot_error_is_a_guess: bool,
    /// Logarithm of the determinant of geometry's information, to compare lists of one robot.
    pub log_determinant: f64,
    /// Conditions that candidates did not fulfil.
    pub refusals: Refusals,
    /// Pairs of links whose shapes always overlap, for which collisions are not looked.
    pub left_out: Vec<(String, String)>,
    /// Joints without limits, which were taken within ±180° or ±0.5 m.
    pub without_limits: Vec<String>,
    /// The way from row to row: sum of the largest turn of a joint, radians (of one that slides, over the length that a radian counts).
    pub travel_rad: f64,
}

/// Plans a session: theory.md, *Choosing configurations*.
///
/// # Errors
/// [`ErrorKind::Option`] for kinds of measurement whose configurations cannot be chosen, and where there are fewer candidates than
/// configurations; [`ErrorKind::Problem`] if the robot has more unknowns than one fit allows.
pub fn plan(robot: &Robot, options: &PlanOptions) -> Result<Plan> {
    Planner::new(robot, options)?.plan()
}

/// Random configurations of a workspace: those in which the tip is between two corners, metres in the base frame.
///
/// # Errors
/// [`ErrorKind::Option`] if hardly any configuration within the limits of the joints has its tip there.
pub fn workspace_in(robot: &Robot, corners: &[[f64; 3]; 2], seed: u64) -> Result<Vec<f64>> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(2);
    let configurations = Configurations::new(robot);
    let mut found = Vec::new();
    let mut count = 0;
    for _ in 0..WORKSPACE * ATTEMPTS {
        let readings = configurations.random(&mut generator);
        let tip = robot.forward_kinematics(&readings).translation;
        if (0..3).all(|k| (corners[0][k]..=corners[1][k]).contains(&tip[k])) {
            found.extend(readings);
            count += 1;
            if count == WORKSPACE {
                return Ok(found);
            }
        }
    }
    if count > 0 {
        return Ok(found);
    }
    ErrorKind::Option.refuse(format!(
        "found none of {} random configurations with the tip in the box, expected one that the robot reaches: state it in the base frame",
        WORKSPACE * ATTEMPTS
    ))
}

/// Random configurations that are accepted, up to a number.
fn drawn(
    checker: &Checker<'_>,
    count: usize,
    generator: &mut ChaCha8Rng,
    mut accepts: impl FnMut(&Checker<'_>, &[f64]) -> bool,
) -> Vec<f64> {
    let (mut found, mut kept) = (Vec::new(), 0);
    for _ in 0..count * ATTEMPTS {
        let readings = checker.configurations().random(generator);
        if accepts(checker, &readings) {
            found.extend(readings);
            kept += 1;
            if kept == count {
                break;
            }
        }
    }
    found
}

/// A session to be planned, with candidates.
struct Planner<'a> {
    options: &'a PlanOptions,
    experiment: Experiment,
    candidates: Vec<f64>,
    /// Where each candidate stands in the list.
    origins: Option<Vec<usize>>,
    refusals: Refusals,
    left_out: Vec<(String, String)>,
    without_limits: Vec<String>,
    blocks: Blocks,
    kept: DMatrix<f64>,
    kept_count: usize,
    avoided: Vec<f64>,
    workspace: Vec<f64>,
    aim: Aim,
    random: Squares,
    generator: ChaCha8Rng,
}

impl<'a> Planner<'a> {
    fn new(robot: &Robot, options: &'a PlanOptions) -> Result<Self> {
        let experiment = Experiment::new(robot, &options.fit)?;
        if experiment.numbers > MOST_NUMBERS {
            return ErrorKind::Option.refuse(format!(
                "found {} numbers that are measured in a configuration, expected at most {MOST_NUMBERS}: plan for fewer targets",
                experiment.numbers
            ));
        }
        let width = experiment.width();
        let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
        let planned = experiment.robot.clone();
        let (avoided, stay) = (options.avoided(), options.fitted());
        let checker = Checker::new(&planned, &options.conditions).avoiding(&avoided, experiment.length_m());
        let mut refusals = Refusals::default();
        let (candidates, origins) = match &options.list {
            Some(list) => {
                let origins: Vec<usize> = (0..list.len() / width)
                    .filter(|&at| {
                        let found = checker.measured(&list[at * width..(at + 1) * width]);
                        // Where the robot was, no limit of a model forbids.
                        let found = found
                            .filter(|&it| it != Obstacle::Limits || options.conditions.margin != [0.0; 2]);
                        refusals.add(found);
                        found.is_none()
                    })
                    .collect();
                let own = origins.iter().flat_map(|&at| list[at * width..(at + 1) * width].to_vec());
                (own.collect(), Some(origins.clone()))
            }
            None => {
                let wanted = options.candidates.max(options.fit.count);
                let found = drawn(&checker, wanted, &mut generator, |checker, readings| {
                    let obstacle = checker.measured(readings);
                    refusals.add(obstacle);
                    obstacle.is_none()
                });
                (found, None)
            }
        };
        let workspace = match &options.workspace {
            // Some of many, at even distances.
            Some(workspace) => {
                let every = (workspace.len() / width).div_ceil(WORKSPACE).max(1);
                workspace.chunks_exact(width).step_by(every).flatten().copied().collect()
            }
            None => drawn(&checker, WORKSPACE, &mut generator, |checker, readings| {
                checker.robot(readings).is_none()
            }),
        };
        let count = candidates.len() / width;
        let new = options.new_of(RowPart::Fit, stay.len() / width);
        if count < new || workspace.is_empty() {
            let words = refusals.words();
            return ErrorKind::Option.refuse(format!(
                "found {count} configurations that can be measured among {}{}{words}, expected at least the {new} of the plan: widen the conditions, or \
                 plan fewer",
                refusals.tried,
                if words.is_empty() { "" } else { "; refused were " },
            ));
        }
        let (left_out, without_limits) = (checker.left_out.clone(), checker.without_limits());
        let blocks = experiment.blocks(&candidates)?;
        let n = blocks.columns;
        let (kept, kept_count) = if stay.is_empty() {
            (DMatrix::zeros(n, n), 0)
        } else {
            let kept = experiment.blocks(&stay)?;
            (kept.gram(0..kept.count()), kept.count())
        };
        let has_terms = n > experiment.geometry();
        let weights =
            Weights { calibrated: 1.0, corrected: if has_terms { 1.0 } else { 0.0 }, determinant: 0.0 };
        let mut aim =
            Aim::new(&experiment.prior, experiment.moments(&workspace), weights, experiment.share());
        let new = new.min(blocks.count());
        let random = random_lists(&aim, &kept, &blocks, (new, options.seed))?;
        if has_terms {
            aim.weights.calibrated = 1.0 / random.calibrated();
            aim.weights.corrected = 1.0 / random.corrected;
        }
        Ok(Planner {
            origins,
            refusals,
            left_out,
            without_limits,
            options,
            experiment,
            candidates,
            blocks,
            kept,
            kept_count,
            avoided,
            workspace,
            aim,
            random,
            generator,
        })
    }

    fn plan(mut self) -> Result<Plan> {
        let new = self.options.new_of(RowPart::Fit, self.kept_count);
        let chosen = self.chosen(new);
        let width = self.experiment.width();
        let mut readings: Vec<Vec<f64>> =
            chosen.iter().map(|&at| self.candidates[at * width..(at + 1) * width].to_vec()).collect();
        let mut rows = self.blocks.only(&chosen);
        let origins: Vec<Option<usize>> =
            chosen.iter().map(|&at| self.origins.as_ref().and_then(|it| it.get(at)).copied()).collect();
        if self.options.list.is_none() && self.options.criterion == PlanCriterion::Expected {
            self.refine(&mut readings, &mut rows)?;
        }
        let (squares, log_determinant) = self.squares(&rows)?;
        let expected = ExpectedErrors::new(&self.experiment, &squares);
        let curve = if self.options.with_curve { self.curve(new, &squares)? } else { Vec::new() };
        let enough = enough(&curve);
        let rows = self.rows(readings, &origins);
        let travel = Travel::new(&self.experiment.robot, self.experiment.length_m());
        let way = |pair: &[PlannedRow]| travel.distance(&pair[0].readings, &pair[1].readings);
        Ok(Plan {
            travel_rad: rows.windows(2).map(way).sum(),
            rows,
            expected,
            random: ExpectedErrors::new(&self.experiment, &self.random),
            curve,
            enough,
            unknowns: self.experiment.geometry(),
            numbers: self.experiment.numbers,
            robot_error_is_a_guess: self.experiment.is_guess,
            log_determinant,
            refusals: self.refusals,
            left_out: self.left_out,
            without_limits: self.without_limits,
        })
    }

    /// Expected squared errors of rows beside the kept ones, and the logarithm of the determinant of geometry's information.
    fn squares(&self, rows: &Blocks) -> Result<(Squares, f64)> {
        let mut aim = self.aim.clone();
        aim.weights.determinant = 1.0;
        let gram = &self.kept + rows.gram(0..rows.count());
        let found = super::state::State::new(&aim, &gram).map(|(_, squares)| squares);
        found.map(|squares| (squares, squares.determinant)).ok_or_else(undetermined)
    }

    /// The candidates of the list, by the criterion.
    fn chosen(&self, count: usize) -> Vec<usize> {
        let travel = Travel::new(&self.experiment.robot, self.experiment.length_m());
        let (width, least) = (self.experiment.width(), self.options.conditions.separation_rad);
        let at = |index: usize| &self.candidates[index * width..(index + 1) * width];
        let apart = |a: usize, b: usize| least <= 0.0 || travel.distance(at(a), at(b)) >= least;
        let best = |aim: &Aim, kept: &DMatrix<f64>, blocks: &Blocks| {
            Search { aim, kept, blocks, apart: &apart }.list(count, self.options.seed)
        };
        if self.options.criterion == PlanCriterion::Expected {
            return best(&self.aim, &self.kept, &self.blocks);
        }
        let g = self.experiment.geometry();
        let blocks = self.blocks.first(g);
        let kept = self.kept.view((0, 0), (g, g)).into_owned();
        let aim = |moments: DMatrix<f64>, determinant: f64| {
            let calibrated = if determinant > 0.0 { 0.0 } else { 1.0 };
            Aim::new(
                &self.experiment.prior,
                moments,
                Weights { calibrated, corrected: 0.0, determinant },
                self.experiment.share(),
            )
        };
        match self.options.criterion {
            PlanCriterion::Expected | PlanCriterion::D => {
                best(&aim(DMatrix::identity(g, g), 1.0), &kept, &blocks)
            }
            PlanCriterion::A => best(&aim(DMatrix::identity(g, g), 0.0), &kept, &blocks),
            PlanCriterion::E | PlanCriterion::G => {
                self.largest(&kept, &blocks, |moments| best(&aim(moments, 0.0), &kept, &blocks))
            }
        }
    }

    /// A list with a small largest variance: means of squares whose weights go with a power of the variances of the list before.
    fn largest(
        &self,
        kept: &DMatrix<f64>,
        blocks: &Blocks,
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
                let weights =
                    nalgebra::DVector::from_iterator(g, values.iter().map(|it| (it / most).powi(3)));
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

    /// Looks around each configuration for better ones.
    fn refine(&mut self, readings: &mut [Vec<f64>], rows: &mut Blocks) -> Result<()> {
        let robot = &self.experiment.robot;
        let checker =
            Checker::new(robot, &self.options.conditions).avoiding(&self.avoided, self.experiment.length_m());
        let travel = Travel::new(robot, self.experiment.length_m());
        let least = self.options.conditions.separation_rad;
        let kinds: Vec<ReadingKind> =
            robot.reading_names().iter().map(|name| robot.reading_kind(name)).collect();
        for round in 0..ROUNDS {
            let share = round as f64 / (ROUNDS - 1) as f64;
            let step = STEPS[0] * (STEPS[1] / STEPS[0]).powf(share);
            let (mut proposals, mut owners) = (Vec::new(), Vec::new());
            for (owner, own) in readings.iter().enumerate() {
                for proposal in 0..PROPOSALS {
                    let mut near = own.clone();
                    // All joints, or one alone.
                    let only = (proposal % 2 == 1)
                        .then(|| (random::uniform(&mut self.generator) * kinds.len() as f64) as usize);
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
                    let near = checker.configurations().nearest(&near);
                    if checker.measured(&near).is_none() {
                        proposals.extend(near);
                        owners.push(owner);
                    }
                }
            }
            let blocks = self.experiment.blocks(&proposals)?;
            let width = self.experiment.width();
            around(&self.aim, &self.kept, rows, &blocks, &owners, |row, proposal| {
                let own = &proposals[proposal * width..(proposal + 1) * width];
                let others = readings.iter().enumerate().filter(|it| it.0 != row);
                let is_apart =
                    least <= 0.0 || others.clone().all(|(_, it)| travel.distance(own, it) >= least);
                if is_apart {
                    readings[row].copy_from_slice(own);
                }
                is_apart
            });
        }
        Ok(())
    }

    /// Expected errors of lists of other lengths, each the beginning of the next.
    fn curve(&self, new: usize, planned: &Squares) -> Result<Vec<CurvePoint>> {
        let most = COUNTS.last().copied().unwrap_or(0);
        let every = (self.blocks.count() / OF_CURVE).max(1);
        let some: Vec<usize> = (0..self.blocks.count()).step_by(every).collect();
        let blocks = self.blocks.only(&some);
        let search = Search { aim: &self.aim, kept: &self.kept, blocks: &blocks, apart: &|_, _| true };
        let order = search.greedy(Vec::new(), most.min(blocks.count()));
        let mut points = Vec::new();
        let mut counts: Vec<usize> = COUNTS.iter().copied().filter(|&count| count <= order.len()).collect();
        counts.push(new);
        counts.sort_unstable();
        counts.dedup();
        // What exchanges gain at the planned number, they gain at others.
        let here = search.squares(&order[..new.min(order.len())]).ok_or_else(undetermined)?;
        let gain = Squares {
            noise: ratio(planned.noise, here.noise),
            true_noise: ratio(planned.true_noise, here.true_noise),
            terms: ratio(planned.terms, here.terms),
            corrected: ratio(planned.corrected, here.corrected),
            determinant: 0.0,
        };
        for count in counts {
            let squares = if count == new {
                *planned
            } else {
                let found = search.squares(&order[..count]).ok_or_else(undetermined)?;
                Squares {
                    noise: found.noise * gain.noise,
                    true_noise: found.true_noise * gain.true_noise,
                    terms: found.terms * gain.terms,
                    corrected: found.corrected * gain.corrected,
                    determinant: 0.0,
                }
            };
            let expected = ExpectedErrors::new(&self.experiment, &squares);
            points.push(CurvePoint { count: count + self.kept_count, expected });
        }
        Ok(points)
    }

    /// The rows in the order of measuring: those to fit by travel, then those to judge by, and the first one now and again.
    fn rows(&mut self, readings: Vec<Vec<f64>>, origins: &[Option<usize>]) -> Vec<PlannedRow> {
        let travel = Travel::new(&self.experiment.robot, self.experiment.length_m());
        let judged = self.options.new_of(RowPart::Judge, 0);
        let width = self.experiment.width();
        let mut left: Vec<usize> = (0..self.workspace.len() / width).collect();
        random::shuffle(&mut self.generator, &mut left);
        let checker = Checker::new(&self.experiment.robot, &self.options.conditions)
            .avoiding(&self.avoided, self.experiment.length_m());
        let stated = self.options.workspace.is_some();
        let can_be = |at: &&usize| {
            let found = checker.measured(&self.workspace[**at * width..(**at + 1) * width]);
            found.is_none_or(|it| stated && it == Obstacle::Limits)
        };
        let judges: Vec<Vec<f64>> = left
            .iter()
            .filter(can_be)
            .take(judged)
            .map(|&at| self.workspace[at * width..(at + 1) * width].to_vec())
            .collect();
        let mut rows: Vec<PlannedRow> = Vec::new();
        let home = vec![0.0; width];
        for (part, all) in [(RowPart::Fit, &readings), (RowPart::Judge, &judges)] {
            let start = rows.last().map_or(home.clone(), |row| row.readings.clone());
            let slices: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
            for at in travel.ordered(&start, &slices) {
                let candidate = if part == RowPart::Fit { origins.get(at).copied().flatten() } else { None };
                rows.push(PlannedRow { readings: all[at].clone(), part, returns: false, candidate });
            }
        }
        if self.options.replaced.is_empty() { with_returns(rows) } else { self.replaced(rows) }
    }

    /// The kept rows in their order, with new ones in the places of those that are replaced.
    fn replaced(&self, mut new: Vec<PlannedRow>) -> Vec<PlannedRow> {
        let mut rows = self.options.kept.clone();
        for old in self.options.replaced_rows() {
            let Some(found) = new.iter().position(|it| it.part == old.part) else { continue };
            let found = new.remove(found);
            for row in rows.iter_mut().filter(|row| row.readings == old.readings) {
                row.readings.clone_from(&found.readings);
                row.candidate = found.candidate;
            }
        }
        rows
    }
}

fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 1.0 }
}

/// Median expected squared errors of random lists.
fn random_lists(
    aim: &Aim,
    kept: &DMatrix<f64>,
    blocks: &Blocks,
    (count, seed): (usize, u64),
) -> Result<Squares> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(1);
    let mut order: Vec<usize> = (0..blocks.count()).collect();
    let search = Search { aim, kept, blocks, apart: &|_, _| true };
    let mut found = Vec::new();
    for _ in 0..RANDOM {
        random::shuffle(&mut generator, &mut order);
        found.push(search.squares(&order[..count]).ok_or_else(undetermined)?);
    }
    let median = |of: fn(&Squares) -> f64| {
        let mut values: Vec<f64> = found.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    Ok(Squares {
        noise: median(|it| it.noise),
        true_noise: median(|it| it.true_noise),
        terms: median(|it| it.terms),
        corrected: median(|it| it.corrected),
        determinant: 0.0,
    })
}
