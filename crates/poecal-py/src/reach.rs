//! Kinematics and compensation of many configurations.

use std::borrow::Cow;
use std::path::Path;

use numpy::{PyArray1, PyArrayMethods as _};
use poecal_arm::lie::Pose;
use poecal_compensate::{
    ChangeOptions, Compensation, Inverse, Kinematics, Language, MaxCorrection, ProgramOptions, compensate_file,
};
use poecal_model::robot::Robot;
use poecal_model::robot::{ControllerMap, JointKind};
use poecal_results::calibration_file::CalibrationFile;
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};

use crate::arrays::{NumberArray, pose_of, table};
use crate::errors::{argument, raise};
use crate::findings::Findings;
use crate::robot::{Robot as Described, poses};
use crate::words::{choose_word, from_mm};

/// Values of a robot's factors: those of a mapping from their names, else their references.
pub(crate) fn factors(robot: &Robot, given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<f64>> {
    let mut values: Vec<f64> = robot.factors.iter().map(|it| it.reference).collect();
    let Some(given) = given.filter(|it| !it.is_none()) else { return Ok(values) };
    let expected = || {
        let names: Vec<&str> = robot.factors.iter().map(|it| it.name.as_str()).collect();
        let names = if names.is_empty() { "this model has none".to_owned() } else { names.join(", ") };
        format!("expected a mapping from names of factors to numbers: {names}")
    };
    let Ok(given) = given.cast::<PyDict>() else {
        return Err(argument("factors", format!("found something else, {}", expected())));
    };
    for (name, value) in given {
        let index = robot.factors.iter().position(|it| name.extract::<String>().is_ok_and(|name| name == it.name));
        match (index, value.extract::<f64>()) {
            (Some(index), Ok(value)) if value.is_finite() => values[index] = value,
            _ => return Err(argument("factors", format!("found {name}: {value}, {}", expected()))),
        }
    }
    Ok(values)
}

/// Configurations of the joints alone, and true if it is a single one.
fn configurations(value: &Bound<'_, PyAny>, name: &str, robot: &Robot) -> PyResult<(NumberArray, bool)> {
    let names = robot.joint_reading_names();
    let n = names.len();
    let expected = format!(
        "shape (m, {n}) or ({n},): in each configuration {} (radians; metres of sliding joints)",
        names.join(", ")
    );
    let numbers = NumberArray::require_finite(value, name, &expected)?;
    let is_single = numbers.shape.len() == 1;
    let wanted: &[Option<usize>] = if is_single { &[Some(n)] } else { &[None, Some(n)] };
    Ok((numbers.require_shape(wanted, name, &expected)?, is_single))
}

/// Mapping from the counts of a calibration's controller to the model's readings, if arrays contain counts; `None` if they contain the model's
/// readings, or if both are equal.
pub(crate) fn find_controller_map(file: &CalibrationFile, readings: Option<&str>) -> PyResult<Option<ControllerMap>> {
    let is_counted = match readings {
        None => None,
        Some(word) => Some(choose_word("readings", word, &[("controller", true), ("model", false)])?),
    };
    let Some(sums) = file.controller.as_ref().filter(|it| !it.is_plain()) else { return Ok(None) };
    match is_counted {
        Some(true) => sums.controller_map().map(Some).map_err(raise),
        Some(false) => Ok(None),
        None => Err(argument(
            "readings",
            format!(
                "found none, and a calibration whose mapping made readings of others ({}), expected \"controller\" for arrays of what the \
                 controller counts, or \"model\"",
                sums.words()
            ),
        )),
    }
}

/// The model's readings for rows of counted ones; numbers beyond those of the joints stay.
pub(crate) fn to_model<'r>(counting: Option<&ControllerMap>, rows: &'r [f64], width: usize) -> Cow<'r, [f64]> {
    let Some(counting) = counting else { return Cow::Borrowed(rows) };
    let row = |row: &[f64]| {
        let mut made = counting.readings(row);
        made.extend(row.iter().skip(made.len()));
        made
    };
    rows.chunks_exact(width.max(1)).flat_map(row).collect()
}

/// Rows of numbers as an array of the argument's number of dimensions.
fn rows<'py>(py: Python<'py>, numbers: Vec<f64>, columns: usize, is_single: bool) -> PyResult<Bound<'py, PyAny>> {
    if is_single {
        PyArray1::from_vec(py, numbers).into_bound_py_any(py)
    } else {
        table(py, numbers, columns)?.into_bound_py_any(py)
    }
}

/// Largest motion of a joint: in degrees and millimetres, or as before in radians and metres.
#[derive(Clone, Copy)]
pub(crate) struct MaxCorrectionArgument {
    pub(crate) turn_deg: Option<f64>,
    pub(crate) slide_mm: Option<f64>,
    pub(crate) turn_rad: Option<f64>,
    pub(crate) slide_m: Option<f64>,
}

/// Largest permitted changes of readings.
pub(crate) fn change(nearest: bool, most: MaxCorrectionArgument) -> PyResult<ChangeOptions> {
    let usual = MaxCorrection::default();
    let one_of = |names: [&str; 2], values: [Option<f64>; 2], to_si: fn(f64) -> f64, usual: f64| {
        let (name, value, si) = match values {
            [Some(_), Some(_)] => {
                let message = format!("found {} too, expected one of the two", names[1]);
                return Err(argument(names[0], message));
            }
            [Some(value), None] => (names[0], value, to_si(value)),
            [None, Some(value)] => (names[1], value, value),
            [None, None] => return Ok(usual),
        };
        if value.is_nan() || value <= 0.0 || value.is_infinite() {
            return Err(argument(name, format!("found {value}, expected a number above 0")));
        }
        Ok(si)
    };
    let turn = [most.turn_deg, most.turn_rad];
    let slide = [most.slide_mm, most.slide_m];
    let most_change = MaxCorrection {
        turning_rad: one_of(["max_turn_deg", "max_turn_rad"], turn, f64::to_radians, usual.turning_rad)?,
        sliding_m: one_of(["max_slide_mm", "max_slide_m"], slide, from_mm, usual.sliding_m)?,
    };
    Ok(ChangeOptions { most_change, nearest })
}

/// Readings to command for those of a nominal program; with their summary, if that is requested.
pub(crate) fn compensate<'py>(
    py: Python<'py>,
    (nominal, actual): (&Robot, &Robot),
    (joints, counting): (&Bound<'py, PyAny>, Option<&ControllerMap>),
    factors: &[f64],
    options: &ChangeOptions,
    summary: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let (numbers, is_single) = configurations(joints, "joints", actual)?;
    let n = actual.joint_reading_names().len();
    let compensation = Compensation::new(nominal, actual, factors, options).map_err(raise)?;
    let (made, found) = py.detach(|| {
        let meant = to_model(counting, &numbers.values, n);
        let (mut made, found) = compensation.of_many(&meant, summary);
        if let Some(counting) = counting {
            let rows = meant.chunks_exact(n).zip(numbers.values.chunks_exact(n));
            for (to, (from, counted)) in made.chunks_exact_mut(n).zip(rows) {
                let moved = counting.moved_readings(counted, from, to);
                to.copy_from_slice(&moved);
            }
        }
        (made, found)
    });
    crate::warn(py, &found.warnings())?;
    let made = rows(py, made, n, is_single)?;
    if !summary {
        return Ok(made);
    }
    let what = if found.rows == 1 { "row corrected" } else { "rows corrected" };
    let text = found.text(&slides(actual), what);
    let found = Findings::new("Compensation", text, found.answer(), &found)?.with_warnings(&found.warnings());
    (made, found.into_pyobject(py)?).into_bound_py_any(py)
}

/// The language of a robot program, by its name or the end of the file's.
pub(crate) fn language(path: &Path, named: Option<&str>) -> PyResult<Language> {
    let words = [
        ("urscript", Language::UrScript),
        ("rapid", Language::Rapid),
        ("krl", Language::Krl),
        ("fanuc", Language::Fanuc),
    ];
    match named {
        Some(word) => choose_word("language", word, &words),
        None => Language::of_name(path).map_err(raise)?.ok_or_else(|| {
            let message = format!(
                "found no language for {}, expected one of urscript, rapid, krl, fanuc if the end of the file's name does not state it",
                path.display()
            );
            argument("language", message)
        }),
    }
}

/// A compensated program, and its summary.
pub(crate) fn program<'py>(
    py: Python<'py>,
    robots: (&Robot, &Robot),
    path: &Path,
    factors: &[f64],
    options: &ProgramOptions,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
    let (text, summary) = py.detach(|| compensate_file(path, robots, factors, options)).map_err(raise)?;
    crate::warn(py, &summary.changes.warnings())?;
    let (changes, table) = (&summary.changes, summary.text(&slides(robots.1)));
    let found = Findings::new("Compensation", table, changes.answer(), &summary)?.with_warnings(&changes.warnings());
    Ok((PyBytes::new(py, &text), found.into_pyobject(py)?))
}

/// Function that returns true if the joint of a name slides.
fn slides(robot: &Robot) -> impl Fn(&str) -> bool + '_ {
    |name| robot.joints.iter().any(|joint| joint.name == name && joint.kind == JointKind::Prismatic)
}

/// Poses of an array of shape (m, 4, 4) or (4, 4), and true if it is a single one.
fn targets(value: &Bound<'_, PyAny>) -> PyResult<(Vec<Pose>, bool)> {
    let expected = "poses of the tip in the base, shape (m, 4, 4) or (4, 4)";
    let numbers = NumberArray::require_finite(value, "poses", expected)?;
    let is_single = numbers.shape.len() == 2;
    let wanted: &[Option<usize>] = if is_single { &[Some(4), Some(4)] } else { &[None, Some(4), Some(4)] };
    let numbers = numbers.require_shape(wanted, "poses", expected)?;
    let pose = |(row, it): (usize, &[f64])| {
        pose_of(it)
            .map_err(|message| argument("poses", if is_single { message } else { format!("row {row}: {message}") }))
    };
    let poses = numbers.values.chunks_exact(16).enumerate().map(pose).collect::<PyResult<Vec<Pose>>>()?;
    Ok((poses, is_single))
}

/// Configurations that have the tip at poses: the nearest to `near`, NaN if there is none; without `near` all branches.
pub(crate) fn inverse<'py>(
    py: Python<'py>,
    robot: &Described,
    poses: &Bound<'py, PyAny>,
    (near, held): (Option<&Bound<'py, PyAny>>, Option<&Bound<'py, PyAny>>),
    factors: &[f64],
    limits: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let (targets, is_single) = targets(poses)?;
    let inverse = robot.inverse(factors).map_err(raise)?;
    let robot = &robot.model.robot;
    let n = robot.joint_reading_names().len();
    let held =
        held.filter(|it| !it.is_none()).map(|it| held_reading(it, robot, &inverse, targets.len())).transpose()?;
    let near = near.filter(|it| !it.is_none());
    if near.is_some() && held.is_some() {
        let message = "found a reading that is held, and near, expected one of them: near has the nearest configuration with all joints free";
        return Err(argument("held", message.to_owned()));
    }
    let Some(near) = near else {
        if held.is_none() && !inverse.has_branches() {
            return Err(without_branches(robot, &inverse));
        }
        let start = vec![0.0; n];
        let find = |inverse: &Inverse, row: usize, target: &Pose| match &held {
            Some((reading, values)) => {
                let value = values.get(row).or(values.first()).copied().unwrap_or(0.0);
                inverse.branches_held(target, (*reading, value), &start, limits)
            }
            None => inverse.branches(target, &start, limits),
        };
        let found: Vec<Vec<Vec<f64>>> = py.detach(|| inverse.of_many(&targets, find));
        let arrays = found.into_iter().map(|branches| table(py, branches.concat(), n)).collect::<PyResult<Vec<_>>>()?;
        return match (is_single, arrays.first()) {
            (true, Some(first)) => first.into_bound_py_any(py),
            _ => PyList::new(py, arrays)?.into_bound_py_any(py),
        };
    };
    let (near, one) = configurations(near, "near", robot)?;
    if !one && near.rows() != targets.len() {
        let (found, poses) = (near.rows(), targets.len());
        let message = format!("found {found} configurations for {poses} poses, expected one for each, or one for all");
        return Err(argument("near", message));
    }
    let found = py.detach(|| {
        inverse.of_many(&targets, |inverse, row, target| {
            let start = if one { 0 } else { row * n };
            let start = near.values.get(start..start + n).unwrap_or_default();
            inverse.solve_nearest(target, start, limits).unwrap_or_else(|| vec![f64::NAN; n])
        })
    });
    rows(py, found.concat(), n, is_single)
}

/// The error of an arm whose branches are not all found.
fn without_branches(robot: &Robot, inverse: &Inverse) -> PyErr {
    let message = match inverse.redundant_joint() {
        Some(reading) => format!(
            "found None, expected a configuration from which to start, or held={{\"{}\": value}}: an arm of seven joints has \
             branches where one of them is held",
            robot.joint_reading_names()[reading]
        ),
        None => "found None, expected a configuration from which to start: all branches are found of arms with six turning joints"
            .to_owned(),
    };
    argument("near", message)
}

/// The reading that is held, and its value for all poses or for each.
fn held_reading(
    given: &Bound<'_, PyAny>,
    robot: &Robot,
    inverse: &Inverse,
    poses: usize,
) -> PyResult<(usize, Vec<f64>)> {
    let names = robot.joint_reading_names();
    if inverse.redundant_joint().is_none() {
        let message = "found a reading that is held, expected none: only an arm of seven turning joints has one more than it needs";
        return Err(argument("held", message.to_owned()));
    }
    let expected =
        format!("expected a mapping from one of {} to its value (rad), or to one for each pose", names.join(", "));
    let wrong = || argument("held", format!("found something else, {expected}"));
    let given = given.cast::<PyDict>().map_err(|_| wrong())?;
    let (name, value) = given.iter().next().filter(|_| given.len() == 1).ok_or_else(wrong)?;
    let reading = names
        .iter()
        .position(|it| name.extract::<String>().is_ok_and(|name| name == *it))
        .ok_or_else(|| argument("held", format!("found {name}, {expected}")))?;
    let values = match value.extract::<f64>() {
        Ok(value) if value.is_finite() => vec![value],
        Ok(value) => return Err(argument("held", format!("found {value}, {expected}"))),
        Err(_) => {
            NumberArray::require_finite(&value, "held", &expected)?
                .require_shape(&[Some(poses)], "held", &expected)?
                .values
        }
    };
    Ok((reading, values))
}

/// Poses of the tip.
pub(crate) fn forward_kinematics<'py>(
    py: Python<'py>,
    robot: &Robot,
    (joints, counting): (&Bound<'py, PyAny>, Option<&ControllerMap>),
    factors: &[f64],
) -> PyResult<Bound<'py, PyAny>> {
    let (numbers, is_single) = configurations(joints, "joints", robot)?;
    let kinematics = Kinematics::new(robot, factors).map_err(raise)?;
    let n = robot.joint_reading_names().len();
    let found = py.detach(|| kinematics.forward_kinematics(&to_model(counting, &numbers.values, n)));
    poses(py, &found, is_single)
}

/// Derivatives of the tip's pose by each reading.
pub(crate) fn jacobian<'py>(
    py: Python<'py>,
    robot: &Robot,
    joints: &Bound<'py, PyAny>,
    factors: &[f64],
) -> PyResult<Bound<'py, PyAny>> {
    let (numbers, is_single) = configurations(joints, "joints", robot)?;
    let kinematics = Kinematics::new(robot, factors).map_err(raise)?;
    let n = robot.joint_reading_names().len();
    let found = PyArray1::from_vec(py, py.detach(|| kinematics.jacobians(&numbers.values)));
    if is_single {
        return found.reshape([6, n])?.into_bound_py_any(py);
    }
    found.reshape([numbers.rows(), 6, n])?.into_bound_py_any(py)
}

/// Deflection of the tip under weights.
pub(crate) fn sag<'py>(
    py: Python<'py>,
    robot: &Robot,
    joints: &Bound<'py, PyAny>,
    factors: &[f64],
) -> PyResult<Bound<'py, PyAny>> {
    let (numbers, is_single) = configurations(joints, "joints", robot)?;
    let kinematics = Kinematics::new(robot, factors).map_err(raise)?;
    let found = py.detach(|| kinematics.sag(&numbers.values).as_flattened().to_vec());
    rows(py, found, 6, is_single)
}
