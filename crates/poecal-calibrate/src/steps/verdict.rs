//! Verdict: a level with its reasons, by fixed rules (docs/theory.md §9, *Verdict*).

use serde::{Deserialize, Serialize};

use super::calibrated::CalibratedFit;
use super::figures::Figures;
use super::summary::FitSummary;
use crate::doubts::signs::Signs;
use crate::run::accuracy::JudgingError;
use crate::{AcceptedModel, Expectations};
use poecal_fit::analysis::Direction;
use poecal_fit::forensics::DiagnosisKind;

/// Level of a verdict.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Not at all: something is wrong with the input, the fit, or both.
    DoNotUse,
    /// In configurations like those that were measured.
    InsideSampledRange,
    /// Anywhere within the limits.
    Good,
}

impl Level {
    /// Message for users.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Level::DoNotUse => "do not use",
            Level::InsideSampledRange => "use inside the sampled range",
            Level::Good => "good",
        }
    }

    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Level::DoNotUse => "do_not_use",
            Level::InsideSampledRange => "inside_sampled_range",
            Level::Good => "good",
        }
    }
}

/// A level, and the reasons against a better one; for the best level, the reasons for it. And the one figure: what to expect of the model that is
/// delivered.
///
/// ```
/// use poecal_calibrate::{Level, Verdict};
/// let reasons = vec!["joint2 was moved through 27 % of its range".into()];
/// let verdict = Verdict { level: Level::InsideSampledRange, reasons, model: None, expected_error_mm: None, bound95_mm: None };
/// assert!(verdict.level < Level::Good);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Verdict {
    /// How far it may be used.
    pub level: Level,
    /// Sentences with the deciding figures.
    pub reasons: Vec<String>,
    /// The model that is delivered: the corrected one where it has terms. Missing in older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<AcceptedModel>,
    /// Expected error of its predictions in configurations like those that were measured, millimetres (RMS); absent where no use is advised, or
    /// nothing is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected_error_mm: Option<f64>,
    /// Mean of the distances that 95 % of its errors do not exceed there, millimetres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound95_mm: Option<f64>,
}

/// What speaks against a level, before the expected errors of a model do.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Judged {
    /// Against any use, of whatever model.
    against: Vec<String>,
    /// That the screws are no better than nominal: nothing was shown of this robot.
    no_better: Option<String>,
    /// That the errors of the calibrated model are too large.
    too_large: Option<String>,
    /// Axes that ended where none of this robot is; said where nothing else speaks against use.
    drifted: Vec<String>,
    /// Against use outside the sampled range.
    everywhere: Vec<String>,
    /// Unknowns that are determined weakly.
    weakly: usize,
    reach_m: f64,
}

/// Whether errors are larger than those of any rigid robot of this reach.
fn is_too_large(error: &JudgingError, reach_m: f64) -> bool {
    error.metres() > TOO_LARGE * reach_m
}

impl Judged {
    /// The same with this against any use.
    pub(crate) fn against(mut self, reason: String) -> Self {
        self.against.insert(0, reason);
        self
    }

    /// The verdict on the calibrated model, with these expected errors.
    pub(crate) fn of_calibrated(&self, expected: &Expectations) -> Verdict {
        self.verdict(AcceptedModel::Calibrated, self.too_large.as_ref(), expected)
    }

    /// The verdict on the corrected model, with its error on rows that were not fitted (or on those that were, without such) and these expected
    /// errors.
    pub(crate) fn of_corrected(&self, error: &JudgingError, expected: &Expectations) -> Verdict {
        // Terms may describe what no rigid robot does.
        let too_large = self.too_large.as_ref().filter(|_| is_too_large(error, self.reach_m));
        self.verdict(AcceptedModel::Corrected, too_large, expected)
    }

    fn verdict(&self, model: AcceptedModel, too_large: Option<&String>, expected: &Expectations) -> Verdict {
        let all = self.against.iter().chain(&self.no_better).chain(too_large);
        let mut against: Vec<String> = all.cloned().collect();
        if against.is_empty() {
            against.clone_from(&self.drifted);
        }
        let (mut level, mut reasons) = if !against.is_empty() {
            (Level::DoNotUse, against)
        } else if self.everywhere.is_empty() {
            (Level::Good, Vec::new())
        } else {
            (Level::InsideSampledRange, self.everywhere.clone())
        };
        if let (Some(measured), Some(range)) = (expected.measured, expected.range)
            && level != Level::DoNotUse
            && range.sigma_m > RANGE * measured.sigma_m
        {
            level = Level::InsideSampledRange;
            reasons.push(format!(
                "the expected error anywhere within the limits is {:.3} mm, {:.1} times that at the measured configurations",
                1e3 * range.sigma_m,
                range.sigma_m / measured.sigma_m
            ));
        }
        if level == Level::Good {
            reasons = vec![in_favour(expected, self.weakly)];
        }
        let expected = expected.measured.filter(|_| level != Level::DoNotUse);
        Verdict {
            level,
            reasons,
            model: Some(model),
            expected_error_mm: expected.map(|it| 1e3 * it.sigma_m),
            bound95_mm: expected.map(|it| 1e3 * it.bound_m),
        }
    }
}

/// Least relative reduction of the error on held-out rows.
const WORTH: f64 = 0.02;
/// Calibrated error over the reach above which no rigid robot is described: elastic gears and links have a tenth of it.
const TOO_LARGE: f64 = 1e-2;
/// Residuals per unknown below which a fit mostly reproduces its data.
const REDUNDANCY: f64 = 1.5;
/// Residuals per unknown below which a fit cannot be tested.
const TESTED: f64 = 3.0;
/// Distance of an axis from nominal, as a share of the reach and as an angle, that no robot of that model has.
const ANOTHER_SHARE: f64 = 0.1;
const ANOTHER_RAD: f64 = 0.35;
/// Most axes named for it.
const MOST_NAMED: usize = 3;
/// Least share of its range through which a joint must have moved.
const COVERED: f64 = 0.5;
/// Largest ratio of the worst block's error to that of random folds.
const BLOCKS: f64 = 2.0;
/// Largest ratio of the expected error anywhere to that at measured configurations.
const RANGE: f64 = 2.0;

/// Input of a verdict.
pub(crate) struct Grounds<'a> {
    pub(crate) fit: &'a CalibratedFit<'a>,
    pub(crate) summary: &'a FitSummary,
    pub(crate) figures: &'a Figures,
    pub(crate) signs: &'a Signs,
    /// Mistakes in the input, a sentence each.
    pub(crate) mistakes: Vec<String>,
}

/// The verdict, but for the expected errors of the model.
pub(crate) fn judged(grounds: &Grounds<'_>) -> Judged {
    // Suspected rows do not count.
    let Figures { accuracy, robustness, .. } = grounds.figures;
    let (run, reach_m) = (&grounds.fit.run, grounds.fit.reach_m());
    let (set, name) = match &accuracy.held_out {
        Some(set) => (robustness.held_out_rest.as_ref().unwrap_or(set), "held-out"),
        None => (robustness.training_rest.as_ref().unwrap_or(&accuracy.training), "fitted"),
    };
    let [before, after] = [&set.registered, &set.calibrated].map(|model| model.judging(set.count));
    let (registered, calibrated, unit) = (before.rms, after.rms, after.unit.symbol());
    let moves_joints = run.unknowns.moves_joints(run.robot.joints.len());
    let is_no_better = moves_joints && calibrated > (1.0 - WORTH) * registered;
    let no_better = is_no_better.then(|| {
        format!(
            "on {name} rows the calibrated screws are no better than the nominal ones ({calibrated:.3} {unit} against {registered:.3} {unit})"
        )
    });
    let too_large = is_too_large(&after, reach_m).then(|| {
        format!(
            "the {} of the calibrated model on {name} rows is {calibrated:.1} {unit} (RMS), more than 1 % of the robot's reach",
            after.what
        )
    });
    Judged {
        against: against_use(grounds),
        no_better,
        too_large,
        drifted: drifted(grounds),
        everywhere: against_use_everywhere(grounds),
        weakly: grounds.figures.identifiability.weakly(),
        reach_m,
    }
}

fn against_use(grounds: &Grounds<'_>) -> Vec<String> {
    let mut reasons = grounds.mistakes.clone();
    if !grounds.fit.robust.fitted.report.termination.is_success() {
        reasons.push("the fit did not converge".to_owned());
    }
    let unknowns = grounds.figures.identifiability.parameters;
    if (grounds.summary.remainder.numbers as f64) < REDUNDANCY * unknowns as f64 {
        reasons.push(format!(
            "{} numbers measured in different configurations for {unknowns} unknowns are too few to judge the fit",
            grounds.summary.remainder.numbers
        ));
    }
    reasons
}

/// Axes farther from nominal than any axis of this robot. The zero of a joint turns all later axes.
fn drifted(grounds: &Grounds<'_>) -> Vec<String> {
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

/// Undetermined directions, but for those of joints of one reading: no configuration separates them, and no prediction does.
fn undetermined_directions(grounds: &Grounds<'_>) -> usize {
    let reading = |name: &String| {
        grounds
            .fit
            .run
            .robot
            .joints
            .iter()
            .find(|joint| joint.name == *name)
            .map(|joint| joint.reading.name.as_str())
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

fn against_use_everywhere(grounds: &Grounds<'_>) -> Vec<String> {
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
    if trust.cross_validation.is_none()
        || (grounds.summary.remainder.numbers as f64) < TESTED * unknowns as f64
    {
        reasons.push(format!(
            "{} rows with {} measured numbers for {unknowns} unknowns are too few to test the fit",
            run.fit_rows.len(),
            grounds.summary.remainder.numbers
        ));
    }
    for (coverage, joint) in trust.coverage.iter().zip(&run.robot.joints) {
        if let Some(share) = coverage.share(joint.kind).filter(|share| *share < COVERED) {
            reasons.push(format!(
                "{} was moved through {:.0} % of its range only",
                coverage.joint,
                100.0 * share
            ));
        }
    }
    let open = undetermined_directions(grounds);
    if open > 0 {
        let is = if open == 1 { "is" } else { "are" };
        reasons.push(format!("{open} of {unknowns} unknowns {is} not determined by these configurations"));
    }
    if let Some((found, worst)) = trust.cross_validation.as_ref().and_then(|it| Some((it, it.worst()?)))
        && let Some((quantity, rms)) = worst.rms.leading()
        && let Some(of_random) = found.random.rms.get(quantity)
        && rms > BLOCKS * of_random
    {
        let unit = quantity.unit();
        reasons.push(format!(
            "cross-validation: the error of {} is {:.3} {}, {:.1} times that of random rows",
            worst.name,
            unit.shown(rms),
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
    format!(
        "all unknowns are determined{weakly}, every joint was moved through half of its range or more{expected}"
    )
}
