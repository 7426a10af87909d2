//! A plan: the most informative configurations, judging rows, and the decrease of the expected error with their number.

use nalgebra::DMatrix;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::blocks::ConfigurationRows;
use super::candidates::{draw, draw_measurable, keep_measurable, thin_out};
use super::change::MOST_NUMBERS;
use super::conditions::{Checker, RefusalCounts};
use super::error_curve::{ExpectedErrors, sufficient_count};
use super::experiment::{PlannedExperiment, WORKSPACE, undetermined_error};
use super::options::{PlanCriterion, PlanOptions};
use super::order::TravelDistance;
use super::plan_result::Plan;
use super::rows::{PlannedRow, RowPurpose};
use super::search::PlanSearch;
use super::state::{CriterionContext, CriterionWeights, WorkspaceErrors};
use poecal_model::robot::Robot;
use poecal_model::simulate::random;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Random lists to which a plan is compared.
const RANDOM: usize = 32;

/// Plans a session: theory.md, *Choosing configurations*.
///
/// # Errors
/// [`ErrorKind::Option`] for kinds of measurement whose configurations cannot be chosen, and if there are fewer candidates than configurations;
/// [`ErrorKind::Problem`] if the robot has more unknowns than one fit allows.
pub fn plan(robot: &Robot, options: &PlanOptions) -> Result<Plan> {
    Planner::new(robot, options)?.plan()
}

/// A session to be planned, with candidates.
pub(crate) struct Planner<'a> {
    pub(crate) options: &'a PlanOptions,
    pub(crate) experiment: PlannedExperiment,
    pub(crate) candidates: Vec<f64>,
    /// Index of each candidate in the list.
    pub(crate) origins: Option<Vec<usize>>,
    pub(crate) refusals: RefusalCounts,
    pub(crate) left_out: Vec<(String, String)>,
    pub(crate) without_limits: Vec<String>,
    pub(crate) blocks: ConfigurationRows,
    pub(crate) kept: DMatrix<f64>,
    pub(crate) kept_count: usize,
    pub(crate) avoided: Vec<f64>,
    pub(crate) workspace: Vec<f64>,
    pub(crate) aim: CriterionContext,
    pub(crate) random: WorkspaceErrors,
    pub(crate) generator: ChaCha8Rng,
}

impl<'a> Planner<'a> {
    fn new(robot: &Robot, options: &'a PlanOptions) -> Result<Self> {
        let experiment = PlannedExperiment::new(robot, &options.fit)?;
        refuse_many_numbers(&experiment)?;
        let width = experiment.width();
        let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
        let planned = experiment.robot.clone();
        let (avoided, stay) = (options.avoided_readings(), options.fitted_readings());
        let checker = Checker::new(&planned, &options.conditions).with_avoided(&avoided, experiment.length_m());
        let mut refusals = RefusalCounts::default();
        let (candidates, origins) = match &options.list {
            Some(list) => keep_measurable(&checker, (list, width), &options.conditions, &mut refusals),
            None => {
                let wanted = options.candidates.max(options.fit.count);
                (draw_measurable(&checker, wanted, &mut generator, &mut refusals), None)
            }
        };
        let workspace = match &options.workspace {
            Some(workspace) => thin_out(workspace, width),
            None => draw(&checker, WORKSPACE, &mut generator, |checker, readings| checker.robot(readings).is_none()),
        };
        let count = candidates.len() / width;
        let new = options.new_of(RowPurpose::Fit, stay.len() / width);
        if count < new || workspace.is_empty() {
            return Err(too_few(count, new, &refusals));
        }
        let (left_out, without_limits) = (checker.left_out.clone(), checker.without_limits());
        let blocks = experiment.blocks(&candidates)?;
        let n = blocks.columns;
        let (kept, kept_count) = kept_information(&experiment, &stay, n)?;
        let has_terms = n > experiment.geometry();
        let mut aim = aim_at(&experiment, &workspace, has_terms);
        let new = new.min(blocks.count());
        let random = random_lists(&aim, &kept, &blocks, (new, options.seed))?;
        if has_terms {
            aim.weights.calibrated = 1.0 / random.calibrated_error();
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
        let new = self.options.new_of(RowPurpose::Fit, self.kept_count);
        let chosen = self.choose(new);
        let width = self.experiment.width();
        let mut readings: Vec<Vec<f64>> =
            chosen.iter().map(|&at| self.candidates[at * width..(at + 1) * width].to_vec()).collect();
        let mut rows = self.blocks.select(&chosen);
        let origins: Vec<Option<usize>> =
            chosen.iter().map(|&at| self.origins.as_ref().and_then(|it| it.get(at)).copied()).collect();
        if self.options.list.is_none() && self.options.criterion == PlanCriterion::Expected {
            self.refine(&mut readings, &mut rows)?;
        }
        let (squares, log_determinant) = self.squares(&rows)?;
        let expected = ExpectedErrors::new(&self.experiment, &squares);
        let curve = if self.options.with_curve { self.curve(new, &squares)? } else { Vec::new() };
        let enough = sufficient_count(&curve);
        let rows = self.rows(readings, &origins);
        let travel = TravelDistance::new(&self.experiment.robot, self.experiment.length_m());
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
            beyond_a_turn: if self.options.list.is_some() {
                Vec::new()
            } else {
                self.experiment.robot.readings_beyond_a_turn()
            },
        })
    }

    /// Expected squared errors of rows added to the kept ones, and the logarithm of the determinant of geometry's information.
    fn squares(&self, rows: &ConfigurationRows) -> Result<(WorkspaceErrors, f64)> {
        let mut aim = self.aim.clone();
        aim.weights.determinant = 1.0;
        let gram = &self.kept + rows.gram(0..rows.count());
        let found = super::state::CovarianceState::new(&aim, &gram).map(|(_, squares)| squares);
        found.map(|squares| (squares, squares.determinant)).ok_or_else(undetermined_error)
    }
}

/// Refuses configurations with more measured components than the updates of a plan allow.
fn refuse_many_numbers(experiment: &PlannedExperiment) -> Result<()> {
    if experiment.numbers > MOST_NUMBERS {
        return ErrorKind::Option.refuse(format!(
            "found {} numbers that are measured in a configuration, expected at most {MOST_NUMBERS}: plan for fewer targets",
            experiment.numbers
        ));
    }
    Ok(())
}

/// The information of the rows that stay, and their number.
fn kept_information(experiment: &PlannedExperiment, stay: &[f64], columns: usize) -> Result<(DMatrix<f64>, usize)> {
    if stay.is_empty() {
        return Ok((DMatrix::zeros(columns, columns), 0));
    }
    let kept = experiment.blocks(stay)?;
    Ok((kept.gram(0..kept.count()), kept.count()))
}

/// The aim of a plan whose errors are not yet weighted against each other.
fn aim_at(experiment: &PlannedExperiment, workspace: &[f64], has_terms: bool) -> CriterionContext {
    let weights = CriterionWeights { calibrated: 1.0, corrected: if has_terms { 1.0 } else { 0.0 }, determinant: 0.0 };
    CriterionContext::new(&experiment.prior, experiment.moments(workspace), weights, experiment.share())
}

/// The error of too few configurations for the plan.
fn too_few(count: usize, new: usize, refusals: &RefusalCounts) -> Error {
    let words = refusals.words();
    ErrorKind::Option.error(format!(
        "found {count} configurations that can be measured among {}{}{words}, expected at least the {new} of the plan: widen the conditions, or \
         plan fewer",
        refusals.tried,
        if words.is_empty() { "" } else { "; refused were " },
    ))
}

/// Median expected squared errors of random lists.
fn random_lists(
    aim: &CriterionContext,
    kept: &DMatrix<f64>,
    blocks: &ConfigurationRows,
    (count, seed): (usize, u64),
) -> Result<WorkspaceErrors> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(1);
    let mut order: Vec<usize> = (0..blocks.count()).collect();
    let search = PlanSearch { aim, kept, blocks, apart: &|_, _| true };
    let mut found = Vec::new();
    for _ in 0..RANDOM {
        random::shuffle(&mut generator, &mut order);
        found.push(search.squares(&order[..count]).ok_or_else(undetermined_error)?);
    }
    let median = |of: fn(&WorkspaceErrors) -> f64| {
        let mut values: Vec<f64> = found.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    Ok(WorkspaceErrors {
        noise: median(|it| it.noise),
        true_noise: median(|it| it.true_noise),
        terms: median(|it| it.terms),
        corrected: median(|it| it.corrected),
        determinant: 0.0,
    })
}
