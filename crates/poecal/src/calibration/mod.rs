//! From a robot and measurements to a calibrated robot: the steps by name, and nothing computed here.

mod accuracy;
mod doubts;
mod fit;
mod judge;
mod noise;
mod repeatability;
mod robust;
mod split;
mod trust;
mod verdict;

pub use accuracy::{Accuracy, ModelAccuracy, SetAccuracy, Statistic, set_accuracy};
pub use fit::fit_screws;
pub use judge::{Judgement, Refitted, Subject, judge};
pub use noise::{NoiseSource, estimate_noise};
pub use repeatability::{RepeatedPose, repeatability};
pub use robust::{Loss, Robust, Robustness, RowJudgement, row_influence};
pub use split::split_rows;
pub(crate) use trust::inside;
pub use trust::{Expected, JointCorrection, RangePart, Trust};
pub use verdict::{Level, Verdict};

pub use crate::estimate::{RowError, delivered, radian_m, row_errors};

use crate::analysis::{Identifiability, Setup, identifiability, residual_variance};
use crate::error::{Error, ErrorKind, Result};
use crate::estimate::{Estimate, Packed};
use crate::forensics::{self, Diagnosis, DiagnosisKind};
use crate::gauge;
use crate::lie::Pose;
use crate::measurement::{Dataset, Noise, PoseResidual};
use crate::parameters::Formulation;
use crate::robot::{JointKind, Robot};
use crate::solve;
use crate::start::{Registration, register, register_again};
use crate::uncertainty::View;

/// What is known of the measuring device's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum DeviceFrameKnowledge {
    /// The device stands anywhere: its frame is found (and is exactly redundant with the screws, docs/theory.md §8).
    #[default]
    Unknown,
    /// Measurements are in the robot's base frame, as in lou2009.
    Base,
}

/// How to calibrate.
///
/// ```
/// use poecal::calibration::CalibrationOptions;
/// let options = CalibrationOptions { held_out: 0.2, ..Default::default() };
/// assert_eq!(options.seed, 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationOptions {
    /// What is known of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Standard deviation of each measured position component, metres; estimated from the data if absent.
    pub sigma_position_m: Option<f64>,
    /// Standard deviation of each measured rotation component, radians; estimated from the data if absent.
    pub sigma_rotation_rad: Option<f64>,
    /// Share of the configurations held out where the data do not say (0 to below 1).
    pub held_out: f64,
    /// Seed of that choice and of restarts.
    pub seed: u64,
    /// How the errors of the joints are written as unknowns. All but the default are for comparison (lou2009).
    pub formulation: Formulation,
    /// How the errors of measured frames are written. The paper's is for comparison.
    pub pose_residual: PoseResidual,
    /// What to do about grossly wrong rows.
    pub robust: Robust,
    /// Options of the solver.
    pub solver: solve::Options,
    /// Whether mistakes in the input are looked for where the fit leaves room for them; that can take some tenths of a second.
    pub diagnose: bool,
    /// Further starts tried when the fit looks as if it ended beside the optimum.
    pub restarts: usize,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        CalibrationOptions {
            frame: DeviceFrameKnowledge::Unknown,
            sigma_position_m: None,
            sigma_rotation_rad: None,
            held_out: 0.3,
            seed: 1,
            formulation: Formulation::default(),
            pose_residual: PoseResidual::default(),
            robust: Robust::default(),
            solver: solve::Options::default(),
            diagnose: true,
            restarts: 24,
        }
    }
}

impl CalibrationOptions {
    /// The same options for a formulation, with the method that belongs to it: plain Gauss-Newton where screws are free numbers, since
    /// steps that are judged by the cost after normalisation are cut short again and again (docs/theory.md §3).
    ///
    /// ```
    /// use poecal::{calibration::CalibrationOptions, parameters::Formulation, solve::Method};
    /// let options = CalibrationOptions::default().with_formulation(Formulation::Screw);
    /// assert_eq!(options.solver.method, Method::GaussNewton);
    /// ```
    #[must_use]
    pub fn with_formulation(mut self, formulation: Formulation) -> Self {
        self.formulation = formulation;
        self.solver.method = if formulation.has_free_screws() {
            solve::Method::GaussNewton
        } else {
            solve::Method::LevenbergMarquardt
        };
        self
    }
}

/// A target as calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedTarget {
    /// Its name; `None` is the tip itself.
    pub name: Option<String>,
    /// Whether its orientation was measured; if not, only the position means something.
    pub is_frame: bool,
    /// `tip_from_target` in the calibrated robot.
    pub tip_from_target: Pose,
}

/// How the minimisation went.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverReport {
    /// Iterations of the full fit, re-weighted rounds included.
    pub iterations: usize,
    /// Why it ended.
    pub termination: solve::Termination,
    /// Further starts that were tried.
    pub restarts: usize,
    /// Mean square whitened residual by iteration.
    pub trace: Vec<f64>,
    /// What each joint's value is more than its reading says (radians or metres), where the formulation has offsets. They are not
    /// identifiable beside the screws (lou2009 Proposition 1); the calibrated robot has them in its screws.
    pub joint_offsets: Option<Vec<f64>>,
}

/// The three models that every result is stated for, as estimates.
#[derive(Clone, Debug, PartialEq)]
pub struct Models {
    /// As delivered: only an unknown device frame is fitted.
    pub nominal: Estimate,
    /// Device frame and targets fitted, screws nominal.
    pub registered: Estimate,
    /// Screws, targets and device frame fitted.
    pub calibrated: Estimate,
}

/// A finished calibration.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, calibrate};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let simulation = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
/// let made = simulation.run(&elbow(), Kind::Pose)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let held_out = calibration.accuracy.held_out.expect("30 % are held out");
/// assert!(held_out.calibrated.position_mm.max < 1e-6);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The robot as delivered.
    pub nominal: Robot,
    /// The calibrated robot. The single unnamed target is its tip.
    pub robot: Robot,
    /// The targets.
    pub targets: Vec<CalibratedTarget>,
    /// What was known of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// How the errors of the joints were written.
    pub formulation: Formulation,
    /// How the errors of measured frames were written.
    pub pose_residual: PoseResidual,
    /// By which steps the fit went.
    pub method: solve::Method,
    /// `base_from_device`.
    pub base_from_device: Pose,
    /// The three models.
    pub models: Models,
    /// Errors of the three models on training and held-out rows.
    pub accuracy: Accuracy,
    /// The minimisation.
    pub solver: SolverReport,
    /// What the measurements can tell.
    pub identifiability: Identifiability,
    /// How far the result can be trusted.
    pub trust: Trust,
    /// Whether it is good to use, and where.
    pub verdict: Verdict,
    /// Noise by which residuals were whitened where a row stated none.
    pub noise: Noise,
    /// Where that noise came from.
    pub noise_source: NoiseSource,
    /// What was done about outliers, and what the fit says of each row.
    pub robustness: Robustness,
    /// What makes the result doubtful, a sentence each.
    pub warnings: Vec<String>,
    /// Mistakes that the measurements show, fitted and held out: named, not corrected.
    pub diagnosis: Vec<Diagnosis>,
    /// Rows fitted.
    pub fit_rows: Vec<u32>,
    /// Rows held out.
    pub held_out_rows: Vec<u32>,
}

/// Calibrates a robot from measurements.
///
/// # Errors
/// [`ErrorKind::Problem`] if there are too few measurements, [`ErrorKind::Option`] for options out of range, [`ErrorKind::Solver`]
/// if no finite result could be reached.
pub fn calibrate(robot: &Robot, data: &Dataset, options: &CalibrationOptions) -> Result<Calibration> {
    calibrate_with_progress(robot, data, options, &mut |_| {})
}

/// What a calibration is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Finding the device's frame and the targets.
    Registration,
    /// Fitting the screws.
    Fit,
    /// Judging the three models.
    Analysis,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 3] = [Stage::Registration, Stage::Fit, Stage::Analysis];

    /// What to tell a user.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Stage::Registration => "finding the device frame and the targets",
            Stage::Fit => "fitting the screws",
            Stage::Analysis => "judging the result",
        }
    }
}

/// [`calibrate`], telling each stage as it begins.
///
/// # Errors
/// As [`calibrate`].
pub fn calibrate_with_progress(
    robot: &Robot,
    data: &Dataset,
    options: &CalibrationOptions,
    progress: &mut dyn FnMut(Stage),
) -> Result<Calibration> {
    let (fit_rows, held_out_rows) = split_rows(data, options)?;
    let converted =
        (options.pose_residual != PoseResidual::Tool).then(|| data.with_residual(options.pose_residual));
    let data = converted.as_ref().unwrap_or(data);
    check_count(robot, data, &fit_rows)?;
    let packed = Packed::new(robot, data.all_readings(), data.reading_names().len());
    let delivered = delivered(robot, data);
    let length_m = radian_m(robot, &packed);
    let (mut noise, source) = noise::first_guess(data, options);
    let registration = |rows, noise: Noise, targets_free: bool| Registration {
        data,
        packed: &packed,
        rows,
        noise,
        length_m,
        device_free: options.frame == DeviceFrameKnowledge::Unknown,
        targets_free,
    };
    progress(Stage::Registration);
    let (mut registered, _) = register(&registration(&fit_rows, noise, true), &delivered);
    if source == NoiseSource::Estimated
        && let Some(found) = estimate_noise(data, &packed, &fit_rows, &registered, 6, noise)
    {
        noise = noise::stated(options, found);
        registered = register_again(&registration(&fit_rows, noise, true), &registered);
    }
    progress(Stage::Fit);
    let task = fit::Task { robot, data, packed: &packed, rows: &fit_rows, weights: None, length_m, options };
    let robust::RobustFit { fitted, loss, judged } =
        robust::fit(&task, &registration(&fit_rows, noise, true), &registered, source)?;
    progress(Stage::Analysis);
    let mut kept = fit_rows.clone();
    if loss.is_some() {
        kept = robust::registrable(&judged.rows, &fit_rows);
        registered = register(&registration(&kept, fitted.noise, true), &delivered).0;
    }
    let nominal = register(&registration(&kept, fitted.noise, false), &delivered).0;
    let found = fitted.estimate.without_offsets();
    let calibrated = match options.frame {
        DeviceFrameKnowledge::Unknown => {
            let motion = gauge::base_motion(&found, robot, &delivered.base_from_target, length_m);
            found.rebased(&motion)
        }
        DeviceFrameKnowledge::Base => found,
    };
    let setup = Setup {
        robot,
        data,
        packed: &packed,
        rows: &fit_rows,
        estimate: &fitted.estimate,
        layout: &fitted.layout,
        noise: fitted.noise,
        length_m,
        device_free: options.frame == DeviceFrameKnowledge::Unknown,
    };
    let identifiability = identifiability(&setup, &fitted.normal.gram, residual_variance(&fitted.normal));
    let models = Models { nominal, registered, calibrated };
    let accuracy = Accuracy {
        training: set_accuracy(data, &packed, &fit_rows, &models),
        held_out: (!held_out_rows.is_empty()).then(|| set_accuracy(data, &packed, &held_out_rows, &models)),
    };
    // Whatever the unknowns and the loss of the fit were: what is delivered is judged in the minimal basis, by the rows that it believes.
    let (layout, normal) = if options.formulation == Formulation::Adjoint && loss.is_none() {
        (fitted.layout.clone(), fitted.normal.clone())
    } else {
        fit::minimal(data, &packed, &kept, &models.calibrated, fitted.noise, length_m)
    };
    let trust = trust::trust(&trust::Finished {
        view: View {
            robot,
            data,
            packed: &packed,
            rows: &kept,
            free: &layout.parameters().map(|(parameter, _)| *parameter).collect::<Vec<_>>(),
            noise: fitted.noise,
            noise_is_stated: matches!(fitted.noise_source, NoiseSource::Given | NoiseSource::Rows),
            length_m,
            estimate: &models.calibrated,
        },
        layout: &layout,
        normal: &normal,
        models: &models,
        base_free: options.frame == DeviceFrameKnowledge::Unknown,
        seed: options.seed,
    });
    let diagnosis = if options.diagnose {
        let believed = loss.is_some().then_some(&kept[..]);
        diagnosis(robot, data, believed, options.frame, &models.calibrated)
    } else {
        Vec::new()
    };
    let grave = diagnosis.iter().filter(|it| it.kind != DiagnosisKind::DuplicateRows);
    let verdict = verdict::verdict(&verdict::Grounds {
        accuracy: &accuracy,
        solver: &fitted.report,
        identifiability: &identifiability,
        trust: &trust,
        kinds: &models.calibrated.kinds,
        residuals: fitted.normal.residuals,
        reach_m: 3.0 * length_m,
        mistakes: &grave.map(|it| it.statement.clone()).collect::<Vec<_>>(),
    });
    let mut warnings = doubts::doubts(data, &fit_rows, &accuracy.training.registered, options.frame);
    let robustness = Robustness::new(loss, judged, [&fit_rows, &held_out_rows], |rows| {
        set_accuracy(data, &packed, rows, &models)
    });
    warnings.extend(robustness.warning(&fit_rows, &held_out_rows));
    let (calibrated_robot, targets) = place_tip(robot, data, &data.frames(&fit_rows), &models.calibrated);
    Ok(Calibration {
        nominal: robot.clone(),
        robot: calibrated_robot,
        targets,
        frame: options.frame,
        formulation: options.formulation,
        pose_residual: options.pose_residual,
        method: options.solver.method,
        base_from_device: models.calibrated.device_from_base.inverse(),
        models,
        accuracy,
        solver: fitted.report,
        identifiability,
        trust,
        verdict,
        noise: fitted.noise,
        noise_source: fitted.noise_source,
        robustness,
        warnings,
        diagnosis,
        fit_rows,
        held_out_rows,
    })
}

/// Mistakes in all rows, those held out too: what is shifted shows best where no row is missing. After a robust fit in the rows that it
/// believes: what is wrong with single ones is told by that.
fn diagnosis(
    robot: &Robot,
    data: &Dataset,
    believed: Option<&[u32]>,
    frame: DeviceFrameKnowledge,
    calibrated: &Estimate,
) -> Vec<Diagnosis> {
    let rows = believed.map_or_else(|| data.all_rows(), <[u32]>::to_vec);
    let device_free = frame == DeviceFrameKnowledge::Unknown;
    forensics::diagnose(robot, data, &rows, &forensics::Options { device_free, calibrated: Some(calibrated) })
}

/// The calibrated robot with its tip, and the targets in that tip. A single unnamed target becomes the tip (with points alone its
/// orientation keeps the nominal relation to the last joint); otherwise the tip keeps its whole nominal relation to the last joint.
fn place_tip(
    robot: &Robot,
    data: &Dataset,
    frames: &[bool],
    estimate: &Estimate,
) -> (Robot, Vec<CalibratedTarget>) {
    let mut calibrated = robot.with_screws(&estimate.screws());
    let last_joint = calibrated.joints.last().map_or_else(Pose::identity, |joint| joint.frame);
    calibrated.home = last_joint * robot.last_joint_from_tip();
    for (target, name) in data.targets.iter().enumerate() {
        if name.is_none() {
            let seen = estimate.base_from_target[target];
            let rotation = if frames[target] { seen.rotation } else { calibrated.home.rotation };
            calibrated.home = Pose::new(rotation, seen.translation);
        }
    }
    let tip_from_base = calibrated.home.inverse();
    let targets = data
        .targets
        .iter()
        .enumerate()
        .map(|(target, name)| {
            let is_frame = frames[target];
            let tip_from_target = tip_from_base * estimate.base_from_target[target];
            let rotation = if is_frame { tip_from_target.rotation } else { nalgebra::Matrix3::identity() };
            CalibratedTarget {
                name: name.clone(),
                is_frame,
                tip_from_target: Pose::new(rotation, tip_from_target.translation),
            }
        })
        .collect();
    (calibrated, targets)
}

/// Refuses problems with fewer measured numbers than unknowns that data of this kind could determine.
fn check_count(robot: &Robot, data: &Dataset, fit_rows: &[u32]) -> Result<()> {
    let screws: usize =
        robot.joints.iter().map(|joint| if joint.kind == JointKind::Revolute { 4 } else { 2 }).sum();
    for (target, name) in data.targets.iter().enumerate() {
        if !fit_rows.iter().any(|&row| data.observations[row as usize].target == target) {
            let name = name.as_deref().unwrap_or("the tip");
            return Err(Error::new(
                ErrorKind::Problem,
                format!(
                    "found no measurement of target `{name}` to fit, expected at least one of every target: fit some of its rows, or leave its rows out"
                ),
            ));
        }
    }
    let targets: usize = data.frames(fit_rows).iter().map(|&is_frame| if is_frame { 6 } else { 3 }).sum();
    let needed = screws + targets;
    let given: usize =
        fit_rows.iter().map(|&row| data.observations[row as usize].measurement.residual_model().dim()).sum();
    if given < needed {
        return Err(Error::new(
            ErrorKind::Problem,
            format!(
                "found {} to fit with {given} measured numbers, expected at least {needed} numbers \
                 ({screws} of the screws, {targets} of the targets): measure more configurations, or hold out fewer",
                measurements_words(fit_rows.len())
            ),
        ));
    }
    Ok(())
}

/// A number of measurements in words.
fn measurements_words(count: usize) -> String {
    if count == 1 { "1 measurement".to_owned() } else { format!("{count} measurements") }
}
