//! Search for a single zero of a joint that explains about as much as a whole calibration.

use crate::steps::calibrated_fit::CalibratedFit;
use poecal_fit::parameters::{Parameter, ValueTerm};
use poecal_fit::problem::Problem;
use poecal_fit::start::free_parameters;
use poecal_fit::state::{Estimate, Session, sample_rows};
use poecal_model::robot::{JointKind, Term};
use poecal_numerics::error::shorten_name;
use poecal_numerics::solve::LeastSquares as _;

/// Steps of the fit of one zero, which is nearly linear.
const STEPS: usize = 5;
/// Largest share of the nominal robot's squared errors on held-out rows that remains with one zero.
const LEAVES: f64 = 0.5;
/// Factor by which the remaining error with any other zero is larger.
const OTHERS: f64 = 1.3;
/// Largest ratio to the remaining error of the whole calibration.
const WORSE: f64 = 1.6;
/// Most rows that are fitted, and that judge.
const MOST: usize = 500;
/// Fewest held-out rows that show it.
const FEWEST: usize = 5;

/// A zero with the remaining share of the squared errors of held-out rows.
struct SingleOffset {
    joint: usize,
    value: f64,
    leaves: f64,
}

/// Proposes to fit the zero of one joint alone if it predicts the held-out rows about as well as all unknowns: with few rows it is the better model.
pub(crate) fn one_zero(fit: &CalibratedFit<'_>) -> Option<String> {
    let (run, session) = (&fit.run, fit.session());
    let is_usual = run.unknowns.are_usual() && session.device_free;
    if !is_usual || run.held_out_rows.len() < FEWEST {
        return None;
    }
    // Thousands of rows determine it no better, and would cost time.
    let rows = sample_rows(&fit.weighted_rows(), MOST);
    let held_out = sample_rows(&run.held_out_rows, MOST);
    let registration = run.registration(session, &rows, fit.noise(), true);
    let free = free_parameters(&registration, &rows);
    let squares =
        |estimate: &Estimate| Problem::new(session, held_out.clone(), free.clone(), fit.noise()).normal(estimate).cost;
    let registered = squares(&fit.start.registered);
    let whole = squares(&fit.estimate) / registered;
    let of_joint = |joint: usize| zero(fit, (&session, &rows, &free), joint, &squares);
    let mut all: Vec<SingleOffset> = (0..run.robot.joints.len()).filter_map(of_joint).collect();
    all.iter_mut().for_each(|it| it.leaves /= registered);
    all.sort_by(|a, b| a.leaves.total_cmp(&b.leaves));
    let best = all.first()?;
    let is_alone = all.get(1).is_none_or(|next| next.leaves > OTHERS * best.leaves);
    if !(best.leaves < LEAVES && best.leaves < WORSE * whole && is_alone) {
        return None;
    }
    let joint = run.robot.joints.get(best.joint)?;
    let value = match joint.kind {
        JointKind::Revolute => format!("{:.2} deg", best.value.to_degrees()),
        JointKind::Prismatic => format!("{:.2} mm", 1e3 * best.value),
    };
    let (name, own, all) = (shorten_name(&joint.name), best.leaves.sqrt(), whole.sqrt());
    Some(format!(
        "the zero of {name} alone, off by {value}, leaves {own:.2} of the nominal robot's errors on held-out rows, all unknowns {all:.2}: \
         with so few rows, calibrate with --fix joints --free {name}.offset"
    ))
}

/// The zero of a joint, fitted together with the unknowns of a registration.
fn zero(
    fit: &CalibratedFit<'_>,
    (session, rows, free): (&Session<'_>, &[u32], &[Parameter]),
    joint: usize,
    squares: &impl Fn(&Estimate) -> f64,
) -> Option<SingleOffset> {
    let kind = fit.run.robot.joints.get(joint)?.kind;
    let mut all = free.to_vec();
    let place = all.iter().position(|it| it.target_motions().is_some()).unwrap_or(all.len());
    all.insert(place, Parameter::ValueTerm(ValueTerm { joint, kind, term: Term::OFFSET }));
    let problem = Problem::new(*session, rows.to_vec(), all, fit.noise());
    let mut estimate = fit.start.registered.clone();
    for _ in 0..STEPS {
        let step = problem.normal(&estimate).full_step()?;
        estimate = problem.layout().retract(&estimate, &step);
    }
    let value = estimate.coefficient(joint, Term::OFFSET);
    let leaves = squares(&estimate);
    (value.is_finite() && leaves.is_finite()).then_some(SingleOffset { joint, value, leaves })
}
