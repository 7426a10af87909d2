//! Whether a robot is still as it was calibrated, by a few measurements: which joint is not, what cannot be seen, and how large a shift
//! would be found (theory.md §9, *Has it drifted*).

mod by_model;
mod explain;
mod hypotheses;
mod judged;
mod pairs;
mod repair;
mod sight;
mod visit;
mod witness;
mod words;

pub use explain::Kind;
pub use judged::Earlier;
pub use repair::{Repaired, recalibrate};
pub use sight::{JointSight, Unseen};
pub use witness::{Witnesses, witnesses};

use serde::Serialize;

use crate::error::Result;
use crate::io::calibration_file::CalibrationFile;
use crate::measurement::{Dataset, Quantity};
use explain::{Evidence, Hypothesis, Tests, Tried, Verdict, explain, leave_unseen_out};
use hypotheses::{free, hypotheses};
use judged::Judged;
use pairs::Changes;
use visit::{Model, Of, Visit};

/// Shift beyond which rows are no linear function of it: a new calibration is due, radians.
const MOST_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// The same of a slide, metres.
const MOST_M: f64 = 0.02;

/// What is known of the visits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackOptions {
    /// Whether the device stands where it stood at the calibration; otherwise its frame is free.
    pub device_is_known: bool,
    /// Whether the tool was mounted anew, so that its targets are free.
    pub tool_is_anew: bool,
    /// Standard deviation of a visit and coordinate, metres; `None`: what repeats within a visit, and what no change explains.
    pub repeatability_m: Option<f64>,
}

/// Whether the robot is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// The changes are no more than noise.
    Unchanged,
    /// They are.
    Changed,
}

/// By what the rows were judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JudgedBy {
    /// Earlier rows of the same configurations.
    Repeats,
    /// The model that is delivered: the corrected one, if there is one.
    Model,
}

/// An unknown of an explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Its value, radians, metres or a share.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Whether it is an angle.
    pub turns: bool,
}

/// What explains the changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Its kind.
    pub kind: Kind,
    /// Names of the joints, targets or devices.
    pub names: Vec<String>,
    /// Whether the first joint slides, so that its zero is a length.
    pub slides: bool,
    /// Its unknowns.
    pub sizes: Vec<Size>,
    /// Squares that it explains, in variances of a number.
    pub gain: f64,
}

/// What a visit shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// Whether the robot is as it was.
    pub state: State,
    /// By what the rows were judged.
    pub judged_by: JudgedBy,
    /// Rows of the visit, and those among them that repeat earlier ones.
    pub rows: usize,
    /// Of these, how many repeat configurations of the earlier visit.
    pub repeated: usize,
    /// The simplest explanation that suffices; `None` of an unchanged robot.
    pub explanation: Option<Explanation>,
    /// Others that explain the changes nearly as well.
    pub alternatives: Vec<Explanation>,
    /// What of each joint's zero would be found, and what cannot be seen.
    pub joints: Vec<JointSight>,
    /// Root mean square change of measured places with what is free fitted, metres: noise of both visits is in it.
    pub change_m: f64,
    /// The same of what the explanation leaves.
    pub left_m: f64,
    /// Standard deviation of each coordinate that the tests used, metres.
    pub noise_m: f64,
    /// Degrees of freedom of that.
    pub freedom: f64,
    /// Root mean square error of the delivered model in this visit, metres: with the frame of the device fitted, unless that is known.
    pub error_m: f64,
    /// What else is to be said, a sentence each.
    pub notes: Vec<String>,
}

/// Judges by a visit whether a robot is as it was when it was calibrated. `earlier` are the rows of the calibration, or of an earlier visit:
/// rows that repeat their configurations are compared with them, others with the delivered model.
///
/// # Errors
/// [`ErrorKind::Problem`](crate::ErrorKind::Problem) if the rows are too few, of other targets or of other instruments;
/// [`ErrorKind::Model`](crate::ErrorKind::Model) if the file holds no valid calibration, or none whose errors are known where rows must be
/// judged by it.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, calibrate};
/// use poecal::io::calibration_file::{CalibrationFile, Inputs};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// use poecal::track::{Earlier, State, TrackOptions, track};
/// let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), Kind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
/// // The same rows again: nothing has changed.
/// let earlier = Earlier { data: &made.data, is_own: true };
/// let found = track(&file, &made.data, Some(earlier), &TrackOptions::default())?;
/// assert_eq!((found.state, found.repeated), (State::Unchanged, 60));
/// # Ok::<(), poecal::Error>(())
/// ```
pub fn track(
    file: &CalibrationFile,
    data: &Dataset,
    earlier: Option<Earlier<'_>>,
    options: &TrackOptions,
) -> Result<Tracked> {
    let judged = Judged::of(file, data, earlier, options)?;
    let Judged { model, visit, data, changes, level, judged_by, repeated, mut notes, .. } = judged;
    let evidence = Evidence::new(&changes.residual, &free(&changes.jacobian, &visit, options));
    let mut hypotheses = hypotheses(&changes.jacobian, &visit, options);
    leave_unseen_out(&mut hypotheses, &evidence, level);
    let tests = Tests::new(&hypotheses);
    let verdict = explain(&evidence, &hypotheses, &tests, level);
    if verdict.is_wider {
        notes.push(words::wider(options.repeatability_m.is_some(), verdict.variance.sqrt()));
    }
    let named = |it: &Tried| explanation(it, &hypotheses[it.at], &verdict, &model, &data);
    let explanation = verdict.best.as_ref().map(named);
    let alternatives: Vec<Explanation> = verdict.nearly.iter().map(named).collect();
    notes.extend(explanation.as_ref().filter(|it| it.is_far()).map(|it| words::far(it)));
    let joints = sight::joints(
        &changes,
        &visit,
        &model,
        (&hypotheses, &tests),
        (verdict.variance, verdict.freedom),
        options,
    );
    let (change_m, noise_m) = in_metres(&changes, &verdict, verdict.left);
    let gain = verdict.best.as_ref().map_or((0.0, 0), |it| (it.gain, it.rank));
    let (left_m, _) =
        in_metres(&changes, &verdict, (verdict.left.0 - gain.0, verdict.left.1 - gain.1 as f64));
    Ok(Tracked {
        state: if verdict.best.is_some() { State::Changed } else { State::Unchanged },
        judged_by,
        rows: data.len(),
        repeated,
        explanation,
        alternatives,
        joints,
        change_m,
        left_m,
        noise_m,
        freedom: verdict.freedom,
        error_m: error_m(&visit),
        notes,
    })
}

/// Root mean square of places, metres a coordinate.
fn rms(visit: &Visit) -> f64 {
    let own = visit.residual.iter().zip(&visit.quantities).filter(|(_, it)| it.unit() == crate::Unit::Metre);
    let (sum, count) = own.fold((0.0, 0.0), |(sum, count), (value, _)| (sum + value * value, count + 1.0));
    if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
}

/// Root mean square error of measured places, metres.
fn error_m(visit: &Visit) -> f64 {
    let is_place = visit.quantities.contains(&Quantity::Position);
    rms(visit) * if is_place { 3f64.sqrt() } else { 1.0 }
}

/// Root mean square change of places in metres from squares in variances, and the standard deviation of a coordinate.
fn in_metres(changes: &Changes, verdict: &Verdict, (squares, _): (f64, f64)) -> (f64, f64) {
    let count = changes.residual.len().max(1) as f64;
    let mean: f64 = changes.sigma.iter().copied().fold(0.0, f64::max);
    let sigma = mean * verdict.variance.sqrt();
    ((3.0 * squares.max(0.0) / count).sqrt() * mean, sigma)
}

/// An explanation with names and sizes.
fn explanation(
    tried: &Tried,
    hypothesis: &Hypothesis,
    verdict: &Verdict,
    model: &Model,
    data: &Dataset,
) -> Explanation {
    let joint = |joint: usize| model.robot.joints[joint].name.clone();
    let named = |names: &[Option<String>], at: usize| names.get(at).cloned().flatten().unwrap_or_default();
    let names = hypothesis.of.iter().map(|of| match *of {
        Of::Device(station) => named(&data.stations, station),
        Of::Target(target) => named(&data.targets, target),
        Of::Lengths => String::new(),
        Of::Zero(at) | Of::Axis(at) | Of::Give(at) => joint(at),
    });
    let slides = hypothesis.of.first().is_some_and(|of| match *of {
        Of::Zero(at) => model.robot.joints[at].kind == crate::robot::JointKind::Prismatic,
        _ => false,
    });
    let scale = verdict.variance.sqrt();
    let sizes = tried.step.iter().zip(&hypothesis.turns);
    let sizes = sizes.map(|(&(value, sigma), &turns)| Size { value, sigma: scale * sigma, turns });
    Explanation {
        kind: hypothesis.kind,
        names: names.collect(),
        slides,
        sizes: sizes.collect(),
        gain: tried.gain / verdict.variance,
    }
}

impl Explanation {
    /// Length of its angles or of its lengths, radians or metres, with its standard deviation along it; `None` where it has none.
    #[must_use]
    pub fn size(&self, turns: bool) -> Option<(f64, f64)> {
        let own: Vec<&Size> = self.sizes.iter().filter(|it| it.turns == turns).collect();
        if let [only] = own.as_slice() {
            return Some((only.value, only.sigma));
        }
        let length = own.iter().map(|it| it.value * it.value).sum::<f64>().sqrt();
        let along = own.iter().map(|it| (it.value * it.sigma).powi(2)).sum::<f64>().sqrt()
            / length.max(f64::MIN_POSITIVE);
        (!own.is_empty()).then_some((length, along))
    }

    /// Whether it is too far for what is linear.
    #[must_use]
    pub fn is_far(&self) -> bool {
        matches!(self.kind, Kind::Zero | Kind::TwoZeros | Kind::Axis)
            && self.sizes.iter().any(|it| it.turns && it.value.abs() > MOST_RAD)
    }
}
