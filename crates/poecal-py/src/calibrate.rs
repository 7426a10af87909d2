//! `calibrate`.

use std::borrow::Cow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use poecal_calibrate::{
    AcceptanceLimits, AcceptedModel, BlockChoice, CalibrationOptions, CalibrationStage, Corrections, RepairLimits,
    RepairedSession, calibrate_repairing, settle_sets,
};
use poecal_cli::words;
use poecal_formats::abb::AbbCalibration;
use poecal_import::MeasurementFile;
use poecal_lou2009::{PaperResidual, to_formulation};
use poecal_model::measurement::{ByQuantity, Dataset, Quantity};
use poecal_model::robot::{GravityDirection, Tolerance};
use poecal_numerics::error::ErrorKind;
use poecal_results::calibration_file::Inputs;
use poecal_results::model::Model;
use poecal_results::record::Record;
use poecal_storage::named_files::refuse_fitted;
use pyo3::prelude::*;

use crate::arguments::{self as arg, CallableArgument, PriorTolerance};
use crate::calibration::Calibration;
use crate::errors::{argument, raise};
use crate::measurements::Measurements;
use crate::paths;
use crate::robot::Robot;
use crate::words::{frame as frame_word, from_mm, one_of, sigma, sigmas};

/// Calibrates a robot from measurements.
///
/// Parameters
/// ----------
/// robot
///     The nominal robot, or the path of its model.
/// measurements
///     Its measurements, or the path of their file, or several paths.
/// device_frame
///     The measuring device's frame: "unknown" or "base".
/// sigma_position_mm, sigma_rotation_deg
///     Standard deviation of each measured component, default estimated from the data.
/// tolerance_deg_mm
///     Prior: deviation of each axis from nominal, standard deviations of angle and position (default 0.5 deg and 5 mm), or None. It decides for
///     unknowns that the measurements do not determine. "auto" takes the best of (0.05, 0.5), (0.2, 2), (0.5, 5), (1, 10) and (3, 10) by
///     cross-validation. The path of a MOC.cfg of a controller of ABB uses the maker's calibration.
/// corrections
///     Joint effects beyond geometry. "auto" fits the terms with the best prediction of rows that were not fitted, "all" searches more of them, "off"
///     fits none. Or groups of terms, some of "sag,tilt,ratio,harmonics,wobble,backlash,factors,payload,shift,runout", or a dict of their sizes in
///     radians or metres, or as texts with a unit.
/// harmonics
///     Highest order of the harmonics of a turn among these terms, 1 to 8 (default 2).
/// gravity
///     Direction of gravity in the robot's base frame, default (0, 0, -1), or "find": the direction for which the terms leave the least noise.
/// fix
///     Blocks to hold as in the model: "joints", "targets", "frames", or names like "joint2.axis", in which * matches any letters.
/// free
///     Blocks to fit, also those that are held by default, like "joint2.offset", and after `fix`.
/// move_tip
///     True to put the tip at the measured point, for a model that ends in its reflector. Otherwise the links beyond the last joint stay as in the
///     model, and the point is the target "measured".
/// held_out
///     Share of the configurations held out, if nothing else determines the rows; 0 fits every row (default 0.3; 0 if fewer than 12 would be held
///     out, except for pictures, rows in motion and `accept`).
/// seed
///     Seed of that choice (default 1).
/// robust
///     Treatment of outliers: "auto", "off", "huber", "cauchy" or "tukey".
/// repair
///     "auto" repairs a session in which a device, a target, a nest or a joint's zero evidently moved, or configurations are wrong as a whole, if
///     that improves the prediction of other rows; "off" only reports it. `Calibration.to_dict()` has `repairs` and `suspicions`.
/// repair_limit
///     Largest repair of a device (default 50 mm), a tool (20 mm) or a zero (5 deg), like "device=100mm" or "tool=30mm,zero=10deg"; turns count as
///     arcs at a third of the robot's reach. A larger motion is named, not repaired.
/// formulation
///     Parameterisation of joint errors: "adjoint", "screw", "screw-offsets" or "adjoint-offsets".
/// residual
///     Residual of measured frames: "tool" or "spatial".
/// method
///     "levenberg-marquardt" or "gauss-newton" (default for formulations with free screws).
/// validate
///     Measurements for validation: all other rows are fitted.
/// accept
///     Limits that the errors of rows that were not fitted must meet, like "0.2mm" or "0.2mm,max:0.5mm,0.05deg": rms (the default), p95 or max of all
///     errors in a unit. `Calibration.acceptance` reports whether each is shown to be kept.
/// accept_model
///     Model that must meet them: "corrected", if there is one, or "calibrated".
/// record
///     Statements of the report about the session: a dict of texts with keys among "certificate", "laboratory", "customer", "robot", "serial",
///     "instrument", "operator", "date", "place", "temperature" and "note".
/// progress
///     Called with the next stage, in words; True for a bar on standard error.
///
/// Returns
/// -------
/// Calibration
///     The calibrated robot, its errors, and the verdict on its trustworthiness.
///
/// Raises
/// ------
/// ProblemError
///     There are too few measurements.
/// OptionError
///     An argument is out of range.
/// SolverError
///     No finite result is reached.
#[pyfunction]
#[pyo3(signature = (robot, measurements, *, device_frame="unknown", sigma_position_mm=None, sigma_rotation_deg=None, tolerance_deg_mm=PriorTolerance::Given((0.5, 5.0)),
                    corrections=None, harmonics=2, gravity=None, fix=None, free=None, move_tip=false, held_out=None, seed=None, robust="auto", repair="auto", repair_limit=None, formulation="adjoint", residual="tool", method=None, validate=None, accept=None, accept_model="corrected", record=None, progress=None),
        text_signature = "(robot, measurements, *, device_frame='unknown', sigma_position_mm=None, sigma_rotation_deg=None, tolerance_deg_mm=(0.5, 5.0), corrections='auto', harmonics=2, gravity=(0, 0, -1), fix=None, free=None, move_tip=False, held_out=None, seed=None, robust='auto', repair='auto', repair_limit=None, formulation='adjoint', residual='tool', method=None, validate=None, accept=None, accept_model='corrected', record=None, progress=None)")]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn calibrate(
    py: Python<'_>,
    robot: &Bound<'_, PyAny>,
    measurements: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
    #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
    #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
    #[pyo3(from_py_with = arg::tolerance_deg_mm)] tolerance_deg_mm: PriorTolerance,
    #[pyo3(from_py_with = arg::corrections)] corrections: Option<Corrections>,
    #[pyo3(from_py_with = arg::harmonics)] harmonics: u32,
    #[pyo3(from_py_with = arg::gravity)] gravity: Option<GravityDirection>,
    #[pyo3(from_py_with = arg::fix)] fix: Option<Vec<String>>,
    #[pyo3(from_py_with = arg::free)] free: Option<Vec<String>>,
    #[pyo3(from_py_with = arg::move_tip)] move_tip: bool,
    #[pyo3(from_py_with = arg::held_out)] held_out: Option<f64>,
    #[pyo3(from_py_with = arg::seed)] seed: Option<u64>,
    #[pyo3(from_py_with = arg::robust)] robust: &str,
    #[pyo3(from_py_with = arg::repair)] repair: &str,
    #[pyo3(from_py_with = arg::repair_limit)] repair_limit: Option<RepairLimits>,
    #[pyo3(from_py_with = arg::formulation)] formulation: &str,
    #[pyo3(from_py_with = arg::residual)] residual: &str,
    #[pyo3(from_py_with = arg::method)] method: Option<&str>,
    validate: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = arg::accept)] accept: Option<AcceptanceLimits>,
    #[pyo3(from_py_with = arg::accept_model)] accept_model: &str,
    #[pyo3(from_py_with = arg::record)] record: Option<Record>,
    #[pyo3(from_py_with = arg::progress)] progress: Option<CallableArgument>,
) -> PyResult<Calibration> {
    let robot = paths::robot(robot)?;
    let measurements = paths::measurements(measurements, "measurements", &robot)?;
    let validate = paths::optional_measurements(validate, "validate", &robot)?;
    let (robot, measurements, validate) = (robot.get(), measurements.get(), validate.as_ref().map(Bound::get));
    let usual = CalibrationOptions::default();
    let (formulation, residual) = formulation_from_words(formulation, residual, method)?;
    let options = CalibrationOptions {
        frame: frame_word(device_frame)?,
        blocks: BlockChoice { free: free.unwrap_or_default(), fix: fix.unwrap_or_default() },
        sigma: noise_by_quantity(sigmas(sigma_position_mm, sigma_rotation_deg)?),
        tolerance: tolerance(&tolerance_deg_mm)?,
        chooses_tolerance: tolerance_deg_mm == PriorTolerance::Auto,
        corrections: corrections.unwrap_or_default(),
        harmonics: orders(harmonics)?,
        gravity: gravity.unwrap_or(usual.gravity),
        held_out,
        seed: seed.unwrap_or(usual.seed),
        robust: one_of("robust", robust, words::ROBUST)?,
        repair: one_of("repair", repair, words::REPAIR)?,
        repair_limits: repair_limit.unwrap_or_default(),
        move_tip,
        accept: accept_limits(accept, accept_model)?,
        formulation,
        ..usual
    };
    let data = rows(py, robot, measurements, validate, held_out, seed)?;
    warn_of_residual(py, &data, residual)?;
    let inputs = (inputs(robot, measurements, validate), record.unwrap_or_default());
    let (found, repaired, took) = fit(py, &robot.model, &data, &options, progress)?;
    Ok(Calibration::of_fit(robot.clone(), found, kept_rows(measurements, repaired, data), inputs, took))
}

/// Stated noise of positions and rotations.
fn noise_by_quantity([position, rotation]: [Option<f64>; 2]) -> ByQuantity<Option<f64>> {
    ByQuantity::default().with_value(Quantity::Position, position).with_value(Quantity::Rotation, rotation)
}

/// The rows of a calibration: its measurements, or those that remained.
fn kept_rows(measurements: &Measurements, repaired: Option<Dataset>, data: Cow<'_, Dataset>) -> Arc<MeasurementFile> {
    match (repaired, data) {
        (None, Cow::Borrowed(_)) => Arc::clone(&measurements.file),
        (Some(data), _) | (None, Cow::Owned(data)) => Arc::new(MeasurementFile { data, ..Default::default() }),
    }
}

/// The formulation that these words name, and its residual.
fn formulation_from_words(
    formulation: &str,
    residual: &str,
    method: Option<&str>,
) -> PyResult<(poecal_calibrate::Formulation, PaperResidual)> {
    let formulation = one_of("formulation", formulation, words::FORMULATION)?;
    let residual = one_of("residual", residual, words::RESIDUAL)?;
    let method = method.map(|word| one_of("method", word, words::METHOD)).transpose()?;
    let method = method.unwrap_or_else(|| formulation.usual_method());
    Ok((to_formulation(formulation, residual, method), residual))
}

/// Limits for the model of this name.
pub(crate) fn accept_limits(accept: Option<AcceptanceLimits>, model: &str) -> PyResult<Option<AcceptanceLimits>> {
    let model = one_of("accept_model", model, words::MODEL)?;
    let limits = accept.map(|it| it.limits).unwrap_or_default();
    // The default may have been written out, which requests nothing.
    let named = (model != AcceptedModel::default()).then_some(model);
    AcceptanceLimits::from_choice(limits, named).map_err(|error| argument("accept_model", error.message()))
}

/// The fit, without the interpreter's lock, and the time of the library. Warns as the program does.
fn fit(
    py: Python<'_>,
    model: &Model,
    data: &Dataset,
    options: &CalibrationOptions,
    progress: Option<CallableArgument>,
) -> PyResult<(poecal_calibrate::Calibration, Option<Dataset>, Duration)> {
    let options = &CalibrationOptions { devices: model.devices_of(data), ..options.clone() };
    let mut raised = None;
    let mut tell = |stage: CalibrationStage| {
        if let (Some(CallableArgument(progress)), None) = (&progress, &raised) {
            raised = Python::attach(|py| progress.call1(py, (stage.words(),)).err());
        }
    };
    let (found, took) = py.detach(|| {
        let start = Instant::now();
        (calibrate_repairing(&model.robot, data, options, &mut tell), start.elapsed())
    });
    if let Some(raised) = raised {
        return Err(raised);
    }
    let RepairedSession { calibration: found, data } = found.map_err(raise)?;
    let repaired = match data {
        Cow::Borrowed(_) => None,
        Cow::Owned(data) => Some(data),
    };
    let events = found.repairs.iter().chain(&found.suspicions).map(|event| &event.statement);
    let statements = found.diagnosis.iter().map(|diagnosis| &diagnosis.statement);
    let warnings: Vec<String> = found.warnings.iter().chain(statements).chain(events).cloned().collect();
    crate::warn(py, &warnings)?;
    Ok((found, repaired, took))
}

/// Training and held-out rows, joined.
fn rows<'a>(
    py: Python<'_>,
    robot: &Robot,
    measurements: &'a Measurements,
    validate: Option<&Measurements>,
    held_out: Option<f64>,
    seed: Option<u64>,
) -> PyResult<Cow<'a, Dataset>> {
    measurements.check_robot(robot)?;
    crate::warn(py, &Vec::from_iter(robot.model.terms_left_out()))?;
    let mut data = Cow::Borrowed(measurements.data());
    if let Some(other) = validate {
        other.check_robot(robot)?;
        if other.data().observations.is_empty() {
            let message = "validate: found no rows, expected at least one that judges the fit";
            return Err(raise(ErrorKind::Option.error(message)));
        }
        refuse_fitted(&other.data().files, &measurements.data().files).map_err(raise)?;
        data.to_mut().judged_by(other.data()).map_err(raise)?;
    }
    if data.observations.iter().all(|row| row.set.is_none()) {
        return Ok(data);
    }
    let stated_by = match validate {
        Some(_) => "--validate",
        None if measurements.source.train_where => "--train-where",
        None => "what each row says of its set",
    };
    settle_sets(data.to_mut(), held_out, stated_by).map_err(raise)?;
    if seed.is_some() {
        crate::warn(py, &["seed has no effect on which rows are held out: that is stated".to_owned()])?;
    }
    Ok(data)
}

fn warn_of_residual(py: Python<'_>, data: &Dataset, residual: PaperResidual) -> PyResult<()> {
    let poses = data.observations.iter().any(|row| row.measurement.sees_orientation());
    if residual == PaperResidual::default() || poses {
        return Ok(());
    }
    let words = residual.word();
    crate::warn(py, &[format!("residual {words} has no effect: it is about measured frames, and there are none")])
}

/// Inputs, as in `calibration.json`.
fn inputs(robot: &Robot, measurements: &Measurements, validate: Option<&Measurements>) -> Inputs {
    let sources = || [Some(measurements), validate].into_iter().flatten().map(|it| &it.source);
    let mut sha256 = (*robot.sha256).clone();
    sources().for_each(|source| sha256.extend(source.sha256.clone()));
    Inputs {
        measurements: sources().flat_map(|source| source.names.clone()).collect(),
        sha256,
        files: sources().flat_map(|source| source.files.clone()).collect(),
        joins: sources().flat_map(|source| source.joins.clone()).collect(),
        ..Inputs::of_model(&robot.model)
    }
}

/// The highest order of harmonics.
fn orders(harmonics: u32) -> PyResult<u8> {
    match u8::try_from(harmonics) {
        Ok(orders @ 1..=8) => Ok(orders),
        _ => Err(argument("harmonics", format!("found {harmonics}, expected 1 to 8"))),
    }
}

/// A tolerance in SI.
pub(crate) fn tolerance(believed: &PriorTolerance) -> PyResult<Option<Tolerance>> {
    match believed {
        PriorTolerance::Given((angle_deg, length_mm)) => Ok(Some(Tolerance {
            angle_rad: sigma("tolerance_deg_mm", *angle_deg, f64::to_radians)?,
            length_m: sigma("tolerance_deg_mm", *length_mm, from_mm)?,
        })),
        PriorTolerance::Of(path) => {
            AbbCalibration::read(path).and_then(|found| found.tolerance(path)).map(Some).map_err(raise)
        }
        PriorTolerance::None => Ok(None),
        PriorTolerance::Auto => Ok(CalibrationOptions::default().tolerance),
    }
}
