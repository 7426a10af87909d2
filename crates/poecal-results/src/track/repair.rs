//! Recalibration of one joint with everything else held.

use nalgebra::DMatrix;

use super::explain::{
    ExplanationKind, HypothesisTests, HypothesisVerdict, MotionHypothesis, ProjectedChanges, explain,
};
use super::hypotheses::{find_free_columns, hypotheses};
use super::model::VisitModel;
use super::options::{JudgingBasis, MOST_RAD, TrackOptions};
use super::visit::ColumnSubject;
use super::visit_judgement::{Baseline, JudgedVisit};
use super::visit_result::explanation;
use crate::calibration_file::{CalibrationFile, JointRepair, RecalibratedEntry, RecalibrationSources, RepairedPart};
use poecal_arm::lie::{Pose, Twist};
use poecal_model::measurement::Dataset;
use poecal_model::robot::JointKind;
use poecal_numerics::error::{ErrorKind, Result};

/// A calibration with one joint recalibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct RecalibratedJoint {
    /// The new calibration.
    pub file: CalibrationFile,
    /// The change.
    pub repair: JointRepair,
    /// Reference by which the rows were judged.
    pub judged_by: JudgingBasis,
    /// Further notes, a sentence each.
    pub notes: Vec<String>,
}

/// Recalibrates the zero or the axis of one joint by the rows of a visit. Everything else is as in the calibration, with its covariance, which is the
/// prior. Repeated rows are compared with earlier rows, so that they add no information on anything else. `sources` are the files.
///
/// # Errors
/// [`ErrorKind::Option`] if there is no such joint; [`ErrorKind::Problem`] if the rows do not determine it, contradict that it alone changed, or show
/// a change of more than 2°; and as [`track`](super::track).
pub fn recalibrate(
    file: &CalibrationFile,
    data: &Dataset,
    earlier: Option<Baseline<'_>>,
    options: &TrackOptions,
    (joint, part): (&str, RepairedPart),
    sources: RecalibrationSources,
) -> Result<RecalibratedJoint> {
    let JudgedVisit { model, data, visit, changes, level, judged_by, repeated, notes } =
        JudgedVisit::from_rows(file, data, earlier, options)?;
    let at = find_joint(&model, joint)?;
    let (of, what) = match part {
        RepairedPart::Zero => (ColumnSubject::Zero(at), "zero"),
        RepairedPart::Axis => (ColumnSubject::Axis(at), "axis"),
    };
    let all = hypotheses(&changes.jacobian, &visit, options);
    let is_own = |it: &&MotionHypothesis| it.of == [of];
    let free_columns = find_free_columns(&changes.jacobian, &visit, options);
    let evidence = ProjectedChanges::new(&changes.residual, &free_columns);
    let found = all.iter().find(is_own).and_then(|it| Some((it, evidence.try_hypothesis(0, it)?)));
    let Some((hypothesis, tried)) = found.filter(|(it, tried)| tried.rank == it.columns.ncols()) else {
        return ErrorKind::Problem.refuse(format!(
            "found rows that do not show the {what} of joint `{joint}`, expected some that do: measure configurations that `poecal track --plan` chooses, \
             and state --device known where the device stands as it did"
        ));
    };
    // The remainder must be noise beside it.
    let beside = side_by_side(&free_columns, &hypothesis.columns);
    let rest: Vec<MotionHypothesis> =
        all.iter().filter(|it| it.kind <= ExplanationKind::Zero && it.of != [of]).cloned().collect();
    let verdict =
        explain(&ProjectedChanges::new(&changes.residual, &beside), &rest, &HypothesisTests::new(&rest), level);
    refuse_others(&verdict, &rest, (&model, &data), (what, joint))?;
    let variance = verdict.variance;
    let step: Vec<f64> = tried.step.iter().map(|it| it.0).collect();
    if tried.step.iter().zip(&hypothesis.turns).any(|((value, _), turns)| *turns && value.abs() > MOST_RAD) {
        return ErrorKind::Problem.refuse(format!(
            "found the {what} of joint `{joint}` off by more than 2 deg, expected less, where rows are linear functions of it: calibrate anew"
        ));
    }
    let turns = model.robot.joints[at].kind == JointKind::Revolute;
    let covariance = (&tried.covariance * variance).as_slice().to_vec();
    let twists = if part == RepairedPart::Axis { axis_twists(&visit.axes[at], turns) } else { Vec::new() };
    let repair = JointRepair { joint: joint.to_owned(), part, step, twists, covariance };
    let (size, sigma) = repair.size();
    let shown = |value: f64| if turns || part == RepairedPart::Axis { value.to_degrees() } else { 1e3 * value };
    let provenance = RecalibratedEntry {
        joint: joint.to_owned(),
        part,
        size: shown(size),
        sigma: shown(sigma),
        motion: repair.motion(&model.robot),
        rows: data.len(),
        repeated,
        measurements: sources.measurements,
        calibration: sources.calibration,
        sha256: sources.sha256,
    };
    Ok(RecalibratedJoint { file: file.with_repair(&repair, provenance)?, repair, judged_by, notes })
}

/// The joint that is to be recalibrated.
fn find_joint(model: &VisitModel, joint: &str) -> Result<usize> {
    let own = model.joints.iter().find(|&&at| model.robot.joints[at].name == joint);
    let Some(&at) = own else {
        let names: Vec<&str> = model.joints.iter().map(|&at| model.robot.joints[at].name.as_str()).collect();
        return ErrorKind::Option.refuse(format!(
            "found joint `{joint}` to be calibrated anew, expected one of {}",
            poecal_numerics::error::first_few(&names)
        ));
    };
    Ok(at)
}

/// Columns of two matrices side by side.
fn side_by_side(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut beside = DMatrix::zeros(left.nrows(), left.ncols() + right.ncols());
    beside.columns_mut(0, left.ncols()).copy_from(left);
    beside.columns_mut(left.ncols(), right.ncols()).copy_from(right);
    beside
}

/// Motions by the unknowns of an axis, base frame.
fn axis_twists(axis: &Pose, turns: bool) -> Vec<Twist> {
    let unknowns: &[usize] = if turns { &[0, 1, 3, 4] } else { &[3, 4] };
    let twists = unknowns.iter().map(|&k| {
        let unit = nalgebra::Vector6::ith(k, 1.0);
        Twist::from_vector(&(axis.adjoint() * unit))
    });
    twists.collect()
}

/// Refuses rows by which something else changed too.
fn refuse_others(
    verdict: &HypothesisVerdict,
    rest: &[MotionHypothesis],
    (model, data): (&VisitModel, &Dataset),
    (what, joint): (&str, &str),
) -> Result<()> {
    let Some(other) = &verdict.best else { return Ok(()) };
    let other = explanation(other, &rest[other.at], verdict, model, data);
    ErrorKind::Problem.refuse(format!(
        "found rows that contradict that the {what} of joint `{joint}` alone changed ({} did too), expected no other change: calibrate anew",
        other.names.first().filter(|name| !name.is_empty()).map_or_else(|| "device or tool".to_owned(), |name| format!("`{name}`"))
    ))
}
