//! Judgement of a visit: the steps in order.

use super::explain::{
    HypothesisTests, HypothesisVerdict, MotionHypothesis, NoiseLevel, ProjectedChanges, TriedHypothesis, explain,
    leave_unseen_out,
};
use super::hypotheses::{find_free_columns, hypotheses};
use super::joint_combinations::several_zeros;
use super::model::VisitModel;
use super::options::{JudgingBasis, RobotCondition, TrackOptions};
use super::pairs::VisitChanges;
use super::sight::JointSight;
use super::visit::Visit;
use super::visit_judgement::{Baseline, JudgedVisit};
use super::visit_result::{ChangeExplanation, VisitResult, explanation};
use super::{sight, visit_sentences};
use crate::calibration_file::CalibrationFile;
use poecal_fit::analysis::{JointCoverage, coverage};
use poecal_fit::state::{PackedValues, Session};
use poecal_model::measurement::{Dataset, Quantity};
use poecal_numerics::error::Result;

/// Largest ratio of the scatter beside the best explanation to that of noise and model errors. Beyond it no single change explains the changes, or
/// the calibration is of another robot.
const BEYOND: f64 = 5.0;
/// Changes in standard deviations below which a row is a copy: rounding of a device that is fitted.
const ROUNDING: f64 = 1e-6;
/// Largest share of the changes that an explanation beyond the linear range may leave.
const NEARLY: f64 = 0.3;

/// Judges by a visit whether a robot is unchanged since its calibration. `earlier` are the rows of the calibration, or of an earlier visit: rows that
/// repeat their configurations are compared with them, others with the delivered model.
///
/// # Errors
/// [`ErrorKind::Problem`](poecal_numerics::error::ErrorKind::Problem) if the rows are too few, of other targets or of other instruments;
/// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) if the file holds no valid calibration, or none with known errors though rows must
/// be judged by it.
///
/// ```
/// use poecal_calibrate::{CalibrationOptions, calibrate};
/// use poecal_results::calibration_file::{CalibrationFile, Inputs};
/// use poecal_model::simulate::{SessionKind, Simulation, elbow};
/// use poecal_results::track::{Baseline, RobotCondition, TrackOptions, track};
/// let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
/// // The same rows again: nothing has changed.
/// let earlier = Baseline { data: &made.data, is_own: true };
/// let found = track(&file, &made.data, Some(earlier), &TrackOptions::default())?;
/// assert_eq!((found.state, found.repeated), (RobotCondition::Unchanged, 60));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
pub fn track(
    file: &CalibrationFile,
    data: &Dataset,
    earlier: Option<Baseline<'_>>,
    options: &TrackOptions,
) -> Result<VisitResult> {
    let judged = JudgedVisit::from_rows(file, data, earlier, options)?;
    let JudgedVisit { model, visit, data, changes, level, .. } = &judged;
    let evidence = ProjectedChanges::new(&changes.residual, &find_free_columns(&changes.jacobian, visit, options));
    let mut hypotheses = hypotheses(&changes.jacobian, visit, options);
    leave_unseen_out(&mut hypotheses, &evidence, *level);
    let tests = HypothesisTests::new(&hypotheses);
    let stated = stated_variance(*level, judged.judged_by);
    let verdict =
        complete_verdict(explain(&evidence, &hypotheses, &tests, *level), stated, (&evidence, &mut hypotheses));
    let mut notes = judged.notes.clone();
    if judged.repeated == data.len() && changes.residual.iter().all(|it| it.abs() < ROUNDING) {
        notes.push(visit_sentences::describe_copy());
    }
    let named = |it: &TriedHypothesis| explanation(it, &hypotheses[it.at], &verdict, model, data);
    let mut explanation = verdict.best.as_ref().map(named);
    let mut alternatives: Vec<ChangeExplanation> = verdict.nearly.iter().map(named).collect();
    let is_far = explanation.as_ref().is_some_and(ChangeExplanation::is_far);
    let (change_m, own_noise_m) = in_metres(changes, &verdict, verdict.left);
    let noise_m = stated.map_or(own_noise_m, |variance| changes.largest_sigma() * variance.sqrt());
    let left_m = left_m(changes, &verdict);
    let usual_m = usual_m(changes, *level, model);
    // For a large shift of a zero, its nonlinear part remains.
    let is_nearly = is_far && left_m < NEARLY * change_m;
    let is_unexplained = !is_nearly && own_noise_m > BEYOND * usual_m;
    if is_unexplained {
        (explanation, alternatives) = (None, Vec::new());
        notes.push(visit_sentences::describe_unexplained(change_m, usual_m, visit.device_is_known));
    } else if verdict.is_wider {
        notes.push(visit_sentences::describe_wider_scatter(
            stated.is_some(),
            explanation.is_some(),
            verdict.variance.sqrt(),
        ));
    }
    notes.extend(explanation.as_ref().filter(|_| is_far).map(visit_sentences::describe_far_shift));
    let joints = sights(&judged, (&hypotheses, &tests), &verdict, options);
    // Beside a shift beyond the linear range, others are not determined.
    let shifts = (!is_unexplained && !is_far).then(|| sight::shifts(&evidence, &hypotheses, &verdict));
    Ok(VisitResult {
        options: *options,
        state: if is_unexplained || explanation.is_some() {
            RobotCondition::Changed
        } else {
            RobotCondition::Unchanged
        },
        judged_by: judged.judged_by,
        rows: data.len(),
        repeated: judged.repeated,
        explanation,
        alternatives,
        joints: sight::with_shifts(joints, shifts.unwrap_or_default()),
        ranges: ranges(model, data),
        change_m,
        left_m,
        noise_m,
        freedom: verdict.freedom,
        error_m: error_m(visit),
        notes,
    })
}

/// Detectable shift of each joint's zero.
fn sights(
    judged: &JudgedVisit,
    tests: (&[MotionHypothesis], &HypothesisTests),
    verdict: &HypothesisVerdict,
    options: &TrackOptions,
) -> Vec<JointSight> {
    let level = (verdict.variance, verdict.freedom);
    sight::joints(&judged.changes, &judged.visit, &judged.model, tests, level, options)
}

/// Part of each joint's range that the rows sample.
fn ranges(model: &VisitModel, data: &Dataset) -> Vec<JointCoverage> {
    let packed = PackedValues::from_dataset(&model.robot, data);
    let mut all = coverage(&Session::new(&model.robot, data, &packed, false), &data.all_rows());
    let gives = |name: &str| model.robot.joints.iter().any(|it| it.name == name && it.give_of.is_some());
    all.retain(|it| !gives(&it.joint));
    all
}

/// The variance of a number if it was stated: by repeats.
fn stated_variance(level: NoiseLevel, judged_by: JudgingBasis) -> Option<f64> {
    match level {
        NoiseLevel::Known(variance) if judged_by == JudgingBasis::Repeats => Some(variance),
        NoiseLevel::Known(_) | NoiseLevel::Found(..) => None,
    }
}

/// Root mean square change of positions that the best explanation leaves, metres.
fn left_m(changes: &VisitChanges, verdict: &HypothesisVerdict) -> f64 {
    let (gain, rank) = verdict.best.as_ref().map_or((0.0, 0), |it| (it.gain, it.rank));
    in_metres(changes, verdict, (verdict.left.0 - gain, verdict.left.1 - rank as f64)).0
}

/// The verdict. If it leaves more than the stated noise (variance), the zeros of several joints that leave less replace it. The stated noise is kept,
/// and an excess is a change without a name yet.
fn complete_verdict(
    verdict: HypothesisVerdict,
    stated: Option<f64>,
    (evidence, hypotheses): (&ProjectedChanges, &mut Vec<MotionHypothesis>),
) -> HypothesisVerdict {
    let several =
        stated.filter(|_| verdict.is_wider).and_then(|variance| several_zeros(evidence, hypotheses, variance));
    let Some((several, complete)) = several else { return verdict };
    hypotheses.push(several);
    complete
}

/// Standard deviation of a coordinate that noise and errors of the model explain, metres.
fn usual_m(changes: &VisitChanges, level: NoiseLevel, model: &VisitModel) -> f64 {
    let variance = match level {
        NoiseLevel::Known(variance) => variance,
        NoiseLevel::Found(..) => 1.0,
    };
    model.own_m().max(changes.largest_sigma() * variance.sqrt())
}

/// Root mean square error of measured positions, metres.
fn error_m(visit: &Visit) -> f64 {
    let is_place = visit.quantities.contains(&Quantity::Position);
    visit.rms() * if is_place { 3f64.sqrt() } else { 1.0 }
}

/// Root mean square change of positions in metres from squares in variances, and the standard deviation of a coordinate.
fn in_metres(changes: &VisitChanges, verdict: &HypothesisVerdict, (squares, _): (f64, f64)) -> (f64, f64) {
    let count = changes.residual.len().max(1) as f64;
    let largest = changes.largest_sigma();
    ((3.0 * squares.max(0.0) / count).sqrt() * largest, largest * verdict.variance.sqrt())
}
