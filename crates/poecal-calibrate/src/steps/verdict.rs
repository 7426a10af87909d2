//! The verdict on a calibration, by fixed rules (docs/theory.md §9, *Verdict*).

use super::calibrated_fit::CalibratedFit;
use super::figures::Figures;
use super::judging_rows::{JudgingRows, WORTH};
use super::level::{Gain, Level, Verdict};
use super::summary::FitSummary;
use crate::doubts::diagnostics::ResidualDiagnostics;
use crate::run::accuracy::JudgingError;
use crate::{AcceptedModel, Expectations};
use poecal_fit::analysis::Direction;
use poecal_fit::forensics::DiagnosisKind;

/// Reasons against a level, before the expected errors of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LevelObjections {
    /// Reasons against any use of any model.
    against: Vec<String>,
    /// True if axes of joints were fitted.
    moves_joints: bool,
    /// Errors of the nominal model, with targets and devices fitted, and of the calibrated one on the rows that judge.
    nominal: JudgingError,
    calibrated: JudgingError,
    /// Statement that the screws are no better than nominal: the rows show nothing of this robot.
    no_better: Option<String>,
    /// Statement that the rows do not show whether the screws are better.
    unclear: Option<String>,
    /// Statement that the errors of the calibrated model are too large.
    too_large: Option<String>,
    /// Axes that ended beyond any axis of this robot; reported if there is no other reason against use.
    drifted: Vec<String>,
    /// Reasons against use outside the sampled range.
    everywhere: Vec<String>,
    /// Unknowns that are determined weakly.
    weakly: usize,
    reach_m: f64,
}

/// True if errors are larger than those of any rigid robot of this reach.
fn is_too_large(error: &JudgingError, reach_m: f64) -> bool {
    error.metres() > TOO_LARGE * reach_m
}

impl LevelObjections {
    /// Adds a reason against any use.
    pub(crate) fn with_objection(mut self, reason: String) -> Self {
        self.against.insert(0, reason);
        self
    }

    /// Adds a reason against use outside the sampled range.
    pub(crate) fn against_good(mut self, reason: String) -> Self {
        self.everywhere.insert(0, reason);
        self
    }

    /// The verdict on the calibrated model, with these expected errors.
    pub(crate) fn of_calibrated(&self, expected: &Expectations) -> Verdict {
        let against = [self.no_better.as_ref(), self.too_large.as_ref(), self.unclear.as_ref()];
        self.verdict(AcceptedModel::Calibrated, against, [expected, expected])
    }

    /// The verdict on the corrected model, with the expected errors of it and of the calibrated model. `error` is its error on rows that were not
    /// fitted, or without such on the fitted ones.
    pub(crate) fn of_corrected(&self, error: &JudgingError, expected: [&Expectations; 2]) -> Verdict {
        // Terms may describe effects that no rigid robot has, and improve a model whose axes are right.
        let too_large = self.too_large.as_ref().filter(|_| is_too_large(error, self.reach_m));
        let is_no_better = error.rms > (1.0 - WORTH) * self.nominal.rms;
        let [no_better, unclear] = [&self.no_better, &self.unclear].map(|it| it.as_ref().filter(|_| is_no_better));
        self.verdict(AcceptedModel::Corrected, [no_better, too_large, unclear], expected)
    }

    fn verdict(
        &self,
        model: AcceptedModel,
        [no_better, too_large, unclear]: [Option<&String>; 3],
        [expected, of_calibrated]: [&Expectations; 2],
    ) -> Verdict {
        let confirmed = self.confirm_nominal(of_calibrated);
        let no_better = no_better.filter(|_| confirmed.is_none());
        let all = self.against.iter().chain(no_better).chain(too_large);
        let mut against: Vec<String> = all.cloned().collect();
        if against.is_empty() {
            against.clone_from(&self.drifted);
        }
        let gain = expected.nominal.map(|it| Gain::of_interval(it.gain_interval_m2()));
        let (level, mut reasons) = if !against.is_empty() {
            (Level::DoNotUse, against)
        } else if !self.moves_joints {
            (Level::Located, vec!["the axes of the joints were held".to_owned()])
        } else {
            let (level, mut reasons) = self.use_of_axes(expected);
            let no_gain = match gain {
                _ if confirmed.is_some() => None,
                Some(Gain::Clear) => unclear.cloned(),
                _ => Some(no_clear_gain(expected)),
            };
            if let Some(reason) = no_gain {
                reasons.insert(0, reason);
                (Level::MeasuredConfigurations, reasons)
            } else {
                (level, reasons)
            }
        };
        if level == Level::Good {
            reasons = vec![in_favour(expected, self.weakly)];
        }
        let is_usable = level != Level::DoNotUse;
        let measured = expected.measured.filter(|_| is_usable);
        let nominal = expected.nominal.filter(|_| is_usable && self.moves_joints);
        Verdict {
            level,
            reasons,
            model: Some(model),
            expected_error_mm: measured.map(|it| 1e3 * it.sigma_m),
            bound95_mm: measured.map(|it| 1e3 * it.bound_m),
            sampled_range_error_mm: expected.sampled.filter(|_| is_usable).map(|it| 1e3 * it.sigma_m),
            nominal_error_mm: nominal.map(|it| 1e3 * it.apart_m),
            gain: gain.filter(|_| nominal.is_some()),
            confirmed: confirmed.filter(|_| is_usable),
        }
    }

    /// The level of a model that predicts better than the nominal one, and the reasons against a better level.
    fn use_of_axes(&self, expected: &Expectations) -> (Level, Vec<String>) {
        let mut reasons = self.everywhere.clone();
        if let (Some(measured), Some(range)) = (expected.measured, expected.range)
            && range.sigma_m > RANGE * measured.sigma_m
        {
            reasons.push(format!(
                "the expected error anywhere within the limits is {:.3} mm, {:.1} times that at the measured configurations",
                1e3 * range.sigma_m,
                range.sigma_m / measured.sigma_m
            ));
        }
        (if reasons.is_empty() { Level::Good } else { Level::InsideSampledRange }, reasons)
    }

    /// Statement that the axes of the nominal model are confirmed: the distance of the fitted ones is within their uncertainty, theory.md §9,
    /// *Verdict*.
    fn confirm_nominal(&self, expected: &Expectations) -> Option<String> {
        let (sampled, nominal) = expected.sampled.zip(expected.nominal)?;
        let [before_m, after_m] = [&self.nominal, &self.calibrated].map(JudgingError::metres);
        let is_of_a_robot = before_m > 0.0 && before_m <= USUAL * self.reach_m;
        let is_known = sampled.sigma_m <= RANGE * before_m;
        let is_the_same = nominal.apart_m <= SAME_AXES * sampled.sigma_m && after_m >= AS_BEFORE * before_m;
        (self.moves_joints && is_of_a_robot && is_known && is_the_same).then(|| {
            format!(
                "the axes of your model: the fitted ones predict within {:.3} mm (RMS) of it anywhere inside the sampled range, \
                 less than their own expected error ({:.3} mm)",
                1e3 * nominal.apart_m,
                1e3 * sampled.sigma_m
            )
        })
    }
}

/// Statement that the nominal model may be better inside the sampled range.
fn no_clear_gain(expected: &Expectations) -> String {
    let (Some(sampled), Some(nominal)) = (expected.sampled, expected.nominal) else {
        return "too few rows to decide if this model predicts better than the nominal one in other configurations"
            .to_owned();
    };
    format!(
        "anywhere inside the sampled range an error of {:.3} mm (RMS) is expected, and the nominal model is {:.3} mm from this one: no clear gain there",
        1e3 * sampled.sigma_m,
        1e3 * nominal.apart_m
    )
}

/// Calibrated error over the reach above which the data describe no rigid robot: elastic gears and links have a tenth of it.
const TOO_LARGE: f64 = 1e-2;
/// Error over the reach above which no model of a robot is confirmed: nominal models have half of it.
const USUAL: f64 = 2e-3;
/// Distance of the predictions of fitted axes from those of the nominal model, over their expected error, up to which they are the same. Fits of two
/// sessions of one robot differ by 0.3 to 0.65, and by 0.75 and more if a zero moved by 0.05°.
const SAME_AXES: f64 = 0.7;
/// Ratio of the error of the calibrated model to that of a nominal one from which they are the same.
const AS_BEFORE: f64 = 0.8;
/// Residuals per unknown below which a fit mostly reproduces its data.
const REDUNDANCY: f64 = 1.5;
/// Residuals per unknown below which a fit cannot be tested.
const TESTED: f64 = 3.0;
/// Distance of an axis from nominal, as a share of the reach and as an angle, beyond any robot of that model.
const ANOTHER_SHARE: f64 = 0.1;
const ANOTHER_RAD: f64 = 0.35;
/// Most axes that the statement names.
const MOST_NAMED: usize = 3;
/// Least share of its range through which a joint must have moved.
const COVERED: f64 = 0.5;
/// Largest ratio of the worst block's error to that of random folds.
const BLOCKS: f64 = 2.0;
/// Largest ratio of the expected error anywhere to that at measured configurations.
const RANGE: f64 = 2.0;

/// Input of a verdict.
pub(crate) struct VerdictInput<'a> {
    pub(crate) fit: &'a CalibratedFit<'a>,
    pub(crate) summary: &'a FitSummary,
    pub(crate) figures: &'a Figures,
    pub(crate) signs: &'a ResidualDiagnostics,
    /// Mistakes in the input, a sentence each.
    pub(crate) mistakes: Vec<String>,
}

/// The verdict, except for the expected errors of the model.
pub(crate) fn judge_level(grounds: &VerdictInput<'_>) -> LevelObjections {
    let (run, reach_m) = (&grounds.fit.run, grounds.fit.reach_m());
    let moves_joints = run.unknowns.moves_joints(run.robot.joints.len());
    let judging = JudgingRows::from_fit(grounds.fit, grounds.figures);
    let [no_better, unclear] = if moves_joints { judging.no_better() } else { [None, None] };
    let JudgingRows { place, errors: [before, after], .. } = judging;
    let too_large = is_too_large(&after, reach_m).then(|| {
        let JudgingError { what, rms, unit } = &after;
        format!(
            "the {what} of the calibrated model {place} is {rms:.1} {} (RMS), more than 1 % of the robot's reach",
            unit.symbol()
        )
    });
    LevelObjections {
        against: against_use(grounds),
        moves_joints,
        nominal: before,
        calibrated: after,
        no_better,
        unclear,
        too_large,
        drifted: describe_drifted_axes(grounds),
        everywhere: against_use_everywhere(grounds),
        weakly: grounds.figures.identifiability.weakly_determined(),
        reach_m,
    }
}

fn against_use(grounds: &VerdictInput<'_>) -> Vec<String> {
    let mut reasons = grounds.mistakes.clone();
    if !grounds.fit.robust.fitted.report.termination.is_success() {
        reasons.push("the fit did not converge".to_owned());
    }
    // Unknowns that the prior determines need no measurements.
    let remainder = &grounds.summary.remainder;
    let unknowns = if grounds.fit.run.prior.is_some() {
        remainder.effective_unknowns
    } else {
        grounds.figures.identifiability.parameters as f64
    };
    if (remainder.numbers as f64) < REDUNDANCY * unknowns {
        reasons.push(format!(
            "{} numbers measured in different configurations for {unknowns:.0} unknowns that they determine are too few to judge the fit",
            remainder.numbers
        ));
    }
    reasons
}

/// Axes farther from nominal than any axis of this robot. The zero of a joint moves all later axes.
fn describe_drifted_axes(grounds: &VerdictInput<'_>) -> Vec<String> {
    if grounds.signs.diagnosis.iter().any(|it| it.kind == DiagnosisKind::JointZero) {
        return Vec::new();
    }
    let reach_m = grounds.fit.reach_m();
    let joints = grounds.fit.run.robot.joints.iter().zip(&grounds.figures.trust.joints);
    joints
        .filter(|(_, it)| it.shift_m > ANOTHER_SHARE * reach_m || it.tilt_rad > ANOTHER_RAD)
        .map(|(joint, it)| {
            format!(
                "the axis of {} ended {:.0} mm and {:.1} deg from nominal: check whether the model is that of this robot, \
                 and the columns those of its joints",
                joint.name,
                1e3 * it.shift_m,
                it.tilt_rad.to_degrees()
            )
        })
        .take(MOST_NAMED)
        .collect()
}

/// Undetermined directions, except those of joints of one reading: no configuration separates them, and no prediction does.
fn undetermined_directions(grounds: &VerdictInput<'_>) -> usize {
    let reading = |name: &String| {
        grounds.fit.run.robot.joints.iter().find(|joint| joint.name == *name).map(|joint| joint.reading.name.as_str())
    };
    let is_one_reading = |direction: &&Direction| {
        let mut readings = direction.joints.iter().map(reading);
        let first = readings.next().flatten();
        direction.joints.len() > 1 && first.is_some() && readings.all(|other| other == first)
    };
    let found = &grounds.figures.identifiability;
    let followers: usize = found.unidentifiable.iter().filter(is_one_reading).map(|it| it.directions).sum();
    (found.parameters - found.rank).saturating_sub(followers)
}

fn against_use_everywhere(grounds: &VerdictInput<'_>) -> Vec<String> {
    let Figures { trust, robustness, .. } = grounds.figures;
    let run = &grounds.fit.run;
    let absurd = grounds.signs.noise.iter().filter(|doubt| doubt.is_absurd);
    let mut reasons: Vec<String> = absurd.map(|doubt| doubt.statement.clone()).collect();
    if robustness.suspects_many() {
        let suspects = robustness.suspects().count();
        reasons.push(format!(
            "{suspects} of {} rows {}",
            robustness.rows.len(),
            if suspects == 1 { "is a suspected outlier" } else { "are suspected outliers" }
        ));
    }
    let unknowns = grounds.figures.identifiability.parameters;
    if trust.cross_validation.is_none() || (grounds.summary.remainder.numbers as f64) < TESTED * unknowns as f64 {
        reasons.push(format!(
            "{} rows with {} measured numbers for {unknowns} unknowns are too few to test the fit",
            run.fit_rows.len(),
            grounds.summary.remainder.numbers
        ));
    }
    for (coverage, joint) in trust.coverage.iter().zip(&run.robot.joints) {
        if let Some(share) = coverage.share(joint.kind).filter(|share| *share < COVERED) {
            let range = if coverage.is_of_a_turn(joint.kind) { "a turn" } else { "its range" };
            let (name, share) = (&coverage.joint, 100.0 * share);
            reasons.push(format!("{name} was moved through {share:.0} % of {range} only"));
        }
    }
    let open = undetermined_directions(grounds);
    if open > 0 {
        let is = if open == 1 { "is" } else { "are" };
        reasons.push(format!("{open} of {unknowns} unknowns {is} not determined by these configurations"));
    }
    if let Some((found, worst)) = trust.cross_validation.as_ref().and_then(|it| Some((it, it.worst_block()?)))
        && let Some((quantity, rms)) = worst.rms.leading_value()
        && let Some(of_random) = found.inside.get(quantity).or(found.random.rms.get(quantity))
        && rms > BLOCKS * of_random
    {
        let unit = quantity.unit();
        reasons.push(format!(
            "cross-validation: the error of {} is {:.3} {}, {:.1} times that of random rows",
            worst.name,
            unit.in_shown_unit(rms),
            unit.symbol(),
            rms / of_random
        ));
    }
    reasons
}

fn in_favour(expected: &Expectations, weakly: usize) -> String {
    let expected = expected.range.map_or(String::new(), |range| {
        format!(", and the expected error anywhere within the limits is {:.3} mm (RMS)", 1e3 * range.sigma_m)
    });
    let weakly = if weakly > 0 { format!(" ({weakly} weakly)") } else { String::new() };
    format!("all unknowns are determined{weakly}, every joint was moved through half of its range or more{expected}")
}
