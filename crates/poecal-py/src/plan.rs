//! `plan` and `Watch`: which configurations to measure, and rows judged as they arrive.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use poecal::analysis::PlannedSession;
use poecal::calibration::{Corrections, DeviceFrameKnowledge};
use poecal::io::measurements::planned_table;
use poecal::io::model::Model;
use poecal::io::output::Existing;
use poecal::io::plan_program::plan_program;
use poecal::io::shapes::capsules_of;
use poecal::measurement::{Dataset, Noise, Quantity};
use poecal::plan::{
    Conditions, PlanCriterion, PlanOptions, PlannedFit, PlannedRow, RobotError, RowPart, Sight,
    Watch as Watched, WatchOptions, plan as planned, workspace_in,
};
use poecal::report;
use poecal::robot::{GravityDirection, Tolerance};
use poecal::simulate::Kind;
use pyo3::prelude::*;

use crate::arguments::{self as arg, Believed};
use crate::arrays::{Joints, Numbers};
use crate::calibrate::tolerance;
use crate::errors::{argument, raise};
use crate::findings::Findings;
use crate::from_arrays::{ArrayColumns, dataset};
use crate::measurements::Measurements;
use crate::places::reserved_file;
use crate::robot::Robot;
use crate::words::{chosen, frame as frame_word, from_mm, kind as kind_word, sigma, sigmas, size};

/// Most configurations of a plan, and most rows to judge by, as by the program.
const MOST: usize = 1000;
/// Most targets of a nest, as by the program.
const MOST_TARGETS: usize = 8;

/// What is believed of a session before it is measured.
struct Believe<'a> {
    sigma_position_mm: Option<f64>,
    sigma_rotation_deg: Option<f64>,
    robot_error_mm: Option<RobotError>,
    frame: &'a str,
    tolerance_deg_mm: &'a Believed,
    corrections: Option<Corrections>,
    gravity: Option<GravityDirection>,
}

impl Believe<'_> {
    /// The fit that will be made of so many configurations of a kind.
    fn fit(self, model: &Model, kind: Kind, count: usize) -> PyResult<PlannedFit> {
        let [position_m, rotation_rad] = sigmas(self.sigma_position_mm, self.sigma_rotation_deg)?;
        let usual = PlannedSession::default();
        let gravity = match self.gravity {
            None => -Vector3::z(),
            Some(GravityDirection::Known(gravity)) => gravity,
            Some(_) => {
                return Err(argument("gravity", "found no direction, expected one, like (0, 0, -1)"));
            }
        };
        let tolerance = match self.tolerance_deg_mm {
            Believed::Auto => {
                let message =
                    "found `auto`, which measurements decide, expected two numbers, like (0.5, 5), or None";
                return Err(argument("tolerance_deg_mm", message));
            }
            Believed::None | Believed::Given(_) | Believed::Of(_) => {
                tolerance(self.tolerance_deg_mm)?.or(Some(Tolerance::WIDE))
            }
        };
        Ok(PlannedFit {
            session: PlannedSession {
                kind,
                noise: Noise::new(
                    position_m.unwrap_or(usual.noise[Quantity::Position]),
                    rotation_rad.unwrap_or(usual.noise[Quantity::Rotation]),
                ),
                device_free: frame_word(self.frame)? == DeviceFrameKnowledge::Unknown,
            },
            count,
            tolerance,
            corrections: self.corrections.unwrap_or_default(),
            gravity,
            robot_error: self.robot_error_mm.or_else(|| model.left_error()),
            ..PlannedFit::default()
        })
    }
}

/// A place in metres.
fn place(of_mm: Option<[f64; 3]>) -> Option<Vector3<f64>> {
    of_mm.map(|it| Vector3::from(it.map(from_mm)))
}

/// Configurations of an argument.
fn configurations(value: Option<&Bound<'_, PyAny>>, robot: &Robot) -> PyResult<Option<Vec<f64>>> {
    value.map(|value| Ok(Joints::of(value, &robot.model.robot)?.readings)).transpose()
}

/// Two corners of a box, metres.
fn corners(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[[f64; 3]; 2]> {
    let expected = "shape (2, 3): two corners of a box in the base frame, millimetres";
    let numbers = Numbers::finite_of(value, name, &[Some(2), Some(3)], expected)?.values;
    let at = |k: usize| numbers.get(k).copied().map_or(0.0, from_mm);
    let (a, b) = ([at(0), at(1), at(2)], [at(3), at(4), at(5)]);
    Ok([[0, 1, 2].map(|k: usize| a[k].min(b[k])), [0, 1, 2].map(|k: usize| a[k].max(b[k]))])
}

/// The workspace where predictions shall be good: configurations, or those with the tip in a box.
fn workspace(
    robot: &Robot,
    over: Option<&Bound<'_, PyAny>>,
    over_box_mm: Option<&Bound<'_, PyAny>>,
    seed: u64,
) -> PyResult<Option<Vec<f64>>> {
    match (over, over_box_mm) {
        (Some(_), Some(_)) => {
            Err(argument("over_box_mm", "found both over and over_box_mm, expected one of the two"))
        }
        (over, None) => configurations(over, robot),
        (None, Some(corners_mm)) => {
            let corners = corners(corners_mm, "over_box_mm")?;
            workspace_in(&robot.model.robot, &corners, seed).map(Some).map_err(raise)
        }
    }
}

/// A planned list of configurations. `str` is the program's table, `to_dict` what the program prints with `--json`.
#[pyclass(frozen, module = "poecal", name = "Plan")]
pub(crate) struct Plan {
    model: Arc<Model>,
    options: PlanOptions,
    found: poecal::plan::Plan,
    told: report::Plan,
}

#[pymethods]
impl Plan {
    /// The configurations in the order in which to measure them, shape (m, n), radians and metres, in the order of `robot.reading_names`.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.model.robot.reading_names().len();
        let all: Vec<f64> = self.found.rows.iter().flat_map(|row| row.readings.clone()).collect();
        PyArray1::from_vec(py, all).reshape([self.found.rows.len(), width])
    }

    /// What each row is for: "fit" or "held_out".
    #[getter]
    fn sets(&self) -> Vec<&'static str> {
        self.found.rows.iter().map(|row| row.part.set()).collect()
    }

    /// Whether each row is the first configuration again.
    #[getter]
    fn returns(&self) -> Vec<bool> {
        self.found.rows.iter().map(|row| row.returns).collect()
    }

    /// Index of each row among the candidates, where these were given.
    #[getter]
    fn candidates(&self) -> Vec<Option<usize>> {
        self.found.rows.iter().map(|row| row.candidate).collect()
    }

    /// Expected error of the calibrated model (RMS over the workspace), millimetres.
    #[getter]
    fn expected_calibrated_mm(&self) -> f64 {
        1e3 * self.found.expected.calibrated_m()
    }

    /// Expected error of the corrected model (RMS over the workspace), millimetres.
    #[getter]
    fn expected_corrected_mm(&self) -> f64 {
        1e3 * self.found.expected.corrected_m()
    }

    /// Number of configurations from which ten more gain less than 5 %; None if that is more than 100.
    #[getter]
    fn enough(&self) -> Option<usize> {
        self.found.enough
    }

    /// The plan as dicts and lists: what the program prints with `--json`.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The plan, with "curve" and "rows".
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = report::json(&self.told).map_err(raise)?;
        py.import("json")?.call_method1("loads", (text,))
    }

    /// Writes the list as a table that `poecal.Measurements` reads once it has what was measured.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file (CSV).
    /// force
    ///     Whether to write over a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let text = planned_table(&self.model.robot, &self.found).map_err(raise)?;
        self.put(py, &path, force, vec![text.into()])
    }

    /// Writes the list as a program of slow joint motions with a stop at each row.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file: its name ends in .script (Universal Robots), .mod (ABB), .src (KUKA) or .ls (FANUC).
    /// force
    ///     Whether to write over a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write_program(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let text = plan_program(&path, &self.model.robot, &self.found.rows).map_err(raise)?;
        self.put(py, &path, force, vec![text.into()])
    }

    /// Writes a page of the plan: the robot in every configuration, the device, errors by number, how each joint is sampled.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     The file (HTML).
    /// force
    ///     Whether to write over a file that exists.
    #[pyo3(signature = (path, *, force=false))]
    fn write_report(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::path)] path: PathBuf,
        #[pyo3(from_py_with = arg::force)] force: bool,
    ) -> PyResult<()> {
        let page = report::plan_page(&self.model, &self.options, &self.found, &self.told);
        self.put(py, &path, force, page)
    }

    fn __len__(&self) -> usize {
        self.found.rows.len()
    }

    fn __str__(&self) -> String {
        self.told.text()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Plan of {}: {}>", self.model.robot.name, self.told.answer().trim_end_matches('.'))
    }
}

impl Plan {
    fn put(&self, py: Python<'_>, path: &Path, force: bool, page: poecal::io::output::Page) -> PyResult<()> {
        let place = reserved_file(py, path, Existing::forced(force), &[&self.model.path])?;
        py.detach(|| place.write(page)).map_err(raise)
    }
}

/// Plans a session: configurations that determine the most, rows to judge by, how many are worth it, and the error to expect.
///
/// Parameters
/// ----------
/// robot
///     The robot; one that was read from a calibration.json plans the next session of it.
/// kind
///     Kind of the measurements of the tip: "point", "pose", "mixed" or "distance".
/// count
///     Number of different configurations to fit, from 1 to 1000.
/// judge
///     Number of further rows to judge by, at random over the workspace (default a third of `count`).
/// candidates
///     Configurations to choose from alone, shape (m, n).
/// over
///     Configurations in which the robot will work, shape (m, n), where predictions shall be good (default anywhere within the limits).
/// over_box_mm
///     Two corners of a box of the base frame in which the tip will work, shape (2, 3), instead of `over`.
/// keep
///     Rows that are there already, which new ones complete: a `Plan`, or configurations to fit of shape (m, n). `count` counts both.
/// replace
///     Rows of `keep`, from 0, that could not be measured: others take their places, and all other rows stay.
/// criterion
///     "expected" (expected error of the calibrated and the corrected model), or a measure of the design: "D", "A", "E", "G".
/// targets
///     Number of targets of a nest at the tip, from 1 to 8, all measured in each configuration.
/// target_offset_mm
///     Where the target is in the tip's frame, of several the first, the others turned about z.
/// sigma_position_mm, sigma_rotation_deg
///     Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
/// robot_error_mm
///     Error of the tip (RMS) that a calibration leaves however much is measured, or that and the one with corrections (default what a calibration left of this robot, else 0.3 mm for
///     each metre of reach, which is a guess).
/// frame
///     The measuring device's frame: "unknown" or "base".
/// tolerance_deg_mm
///     Prior of the fit: deviation of each axis from nominal, as standard deviations, or None.
/// corrections
///     What joints are expected to do beyond geometry: "auto" and "all" terms of the common sizes, "off" nothing, or groups with their sizes.
/// gravity
///     Where gravity pulls, in the robot's base frame, default (0, 0, -1).
/// margin_deg_mm
///     How far every joint stays from its limits.
/// keep_out_mm
///     Boxes into which no part of the robot may reach, each two corners in the base frame.
/// floor_mm
///     Height above which all links that move stay.
/// separation_deg
///     Least change of some joint between any two configurations.
/// device_mm
///     Where the measuring device is, in the base frame; targets that links hide from it are left out.
/// cone_deg, device_looks_at_mm
///     Half the angle of the device's cone, and where it looks (default the base).
/// distance_mm
///     Least and largest distance of the target from the device.
/// acceptance_deg, facing
///     Largest angle between the direction in which the target looks, in its own frame (default (0, 0, 1)), and the line to the device.
/// self_collision
///     "avoid" links that overlap by their shapes in the URDF, or "ignore" shapes.
/// stop_s
///     How long the robot stands at each row, for how long all takes.
/// seed
///     Seed of everything random.
///
/// Returns
/// -------
/// Plan
///     The rows in the order in which to measure them, with the errors to expect. Only configurations are checked, never the way between them.
#[pyfunction]
#[pyo3(signature = (robot, *, kind="point", count=30, judge=None, candidates=None, over=None, over_box_mm=None, keep=None, replace=None,
                    criterion="expected", targets=1, target_offset_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None,
                    frame="unknown", tolerance_deg_mm=Believed::Given((0.5, 5.0)), corrections=None, gravity=None, margin_deg_mm=(0.0, 0.0),
                    keep_out_mm=None, floor_mm=None, separation_deg=None, device_mm=None, cone_deg=None, device_looks_at_mm=None,
                    distance_mm=None, acceptance_deg=None, facing=None, self_collision="avoid", stop_s=30.0, seed=1),
        text_signature = "(robot, *, kind='point', count=30, judge=None, candidates=None, over=None, over_box_mm=None, keep=None, replace=None, criterion='expected', targets=1, target_offset_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None, frame='unknown', tolerance_deg_mm=(0.5, 5.0), corrections='auto', gravity=(0, 0, -1), margin_deg_mm=(0.0, 0.0), keep_out_mm=None, floor_mm=None, separation_deg=None, device_mm=None, cone_deg=None, device_looks_at_mm=None, distance_mm=None, acceptance_deg=None, facing=None, self_collision='avoid', stop_s=30.0, seed=1)")]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn plan(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::robot)] robot: &Robot,
    #[pyo3(from_py_with = arg::kind)] kind: &str,
    #[pyo3(from_py_with = arg::count)] count: usize,
    #[pyo3(from_py_with = arg::judge)] judge: Option<usize>,
    candidates: Option<&Bound<'_, PyAny>>,
    over: Option<&Bound<'_, PyAny>>,
    over_box_mm: Option<&Bound<'_, PyAny>>,
    keep: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = arg::replace)] replace: Option<Vec<usize>>,
    #[pyo3(from_py_with = arg::criterion)] criterion: &str,
    #[pyo3(from_py_with = arg::targets)] targets: usize,
    #[pyo3(from_py_with = arg::target_offset_mm)] target_offset_mm: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
    #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
    #[pyo3(from_py_with = arg::robot_error_mm)] robot_error_mm: Option<RobotError>,
    #[pyo3(from_py_with = arg::frame)] frame: &str,
    #[pyo3(from_py_with = arg::tolerance_deg_mm)] tolerance_deg_mm: Believed,
    #[pyo3(from_py_with = arg::corrections)] corrections: Option<Corrections>,
    #[pyo3(from_py_with = arg::gravity)] gravity: Option<GravityDirection>,
    #[pyo3(from_py_with = arg::margin_deg_mm)] margin_deg_mm: (f64, f64),
    keep_out_mm: Option<Vec<Bound<'_, PyAny>>>,
    #[pyo3(from_py_with = arg::floor_mm)] floor_mm: Option<f64>,
    #[pyo3(from_py_with = arg::separation_deg)] separation_deg: Option<f64>,
    #[pyo3(from_py_with = arg::device_mm)] device_mm: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::cone_deg)] cone_deg: Option<f64>,
    #[pyo3(from_py_with = arg::device_looks_at_mm)] device_looks_at_mm: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::distance_mm)] distance_mm: Option<(f64, f64)>,
    #[pyo3(from_py_with = arg::acceptance_deg)] acceptance_deg: Option<f64>,
    #[pyo3(from_py_with = arg::facing)] facing: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::self_collision)] self_collision: &str,
    #[pyo3(from_py_with = arg::stop_s)] stop_s: f64,
    #[pyo3(from_py_with = arg::seed)] seed: u64,
) -> PyResult<Plan> {
    for (name, number, least, most) in [
        ("count", count, 1, MOST),
        ("judge", judge.unwrap_or(0), 0, MOST),
        ("targets", targets, 1, MOST_TARGETS),
    ] {
        if !(least..=most).contains(&number) {
            return Err(argument(name, format!("found {number}, expected {least} to {most}")));
        }
    }
    let model = &robot.model;
    let believe = Believe {
        sigma_position_mm,
        sigma_rotation_deg,
        robot_error_mm,
        frame,
        tolerance_deg_mm: &tolerance_deg_mm,
        corrections,
        gravity,
    };
    let sight = [
        ("cone_deg", cone_deg.is_some()),
        ("device_looks_at_mm", device_looks_at_mm.is_some()),
        ("distance_mm", distance_mm.is_some()),
        ("acceptance_deg", acceptance_deg.is_some()),
        ("facing", facing.is_some()),
    ];
    if let Some((name, _)) = sight.into_iter().find(|it| it.1 && device_mm.is_none()) {
        return Err(argument(name, "found it without device_mm, expected the device's place beside it"));
    }
    let angle = |name, value: Option<f64>| value.map(|it| sigma(name, it, f64::to_radians)).transpose();
    let (cone, acceptance_rad) = (angle("cone_deg", cone_deg)?, angle("acceptance_deg", acceptance_deg)?);
    let boxes = keep_out_mm.unwrap_or_default();
    let named = |(at, value): (usize, &Bound<'_, PyAny>)| corners(value, &format!("keep_out_mm[{at}]"));
    let is_avoiding = chosen("self_collision", self_collision, &[("avoid", true), ("ignore", false)])?;
    let (capsules, notes) = if is_avoiding { capsules_of(model) } else { Default::default() };
    crate::warn(py, &notes)?;
    let conditions = Conditions {
        margin: [
            size("margin_deg_mm", margin_deg_mm.0, f64::to_radians)?,
            size("margin_deg_mm", margin_deg_mm.1, from_mm)?,
        ],
        keep_out: boxes.iter().enumerate().map(named).collect::<PyResult<_>>()?,
        floor_m: floor_mm.map(from_mm),
        separation_rad: angle("separation_deg", separation_deg)?.unwrap_or(0.0),
        sight: place(device_mm).map(|at| Sight {
            place: at,
            cone: cone.map(|half| (place(device_looks_at_mm).unwrap_or_default(), half)),
            distance_m: distance_mm.map_or([0.0, f64::INFINITY], |(low, high)| [low, high].map(from_mm)),
            acceptance_rad,
            facing: facing.map_or_else(Vector3::z, Vector3::from),
        }),
        capsules,
    };
    let kept = kept(keep, robot)?;
    let replaced = replace.unwrap_or_default();
    if let Some(row) = replaced.iter().find(|&&row| row >= kept.len()) {
        let expected = format!("found {row}, expected a row of keep, from 0 to below {}", kept.len());
        return Err(argument("replace", expected));
    }
    let options = PlanOptions {
        fit: believe
            .fit(model, kind_word(kind)?, count)?
            .with_targets(targets, target_offset_mm.map(|it| it.map(from_mm))),
        criterion: chosen("criterion", criterion, &PlanCriterion::WORDS)?,
        list: configurations(candidates, robot)?,
        workspace: workspace(robot, over, over_box_mm, seed)?,
        judge,
        conditions,
        kept,
        replaced,
        seed,
        ..PlanOptions::default()
    };
    let stop_s = sigma("stop_s", stop_s, std::convert::identity)?;
    let found = py.detach(|| planned(&model.robot, &options)).map_err(raise)?;
    let told = report::Plan::new(model, &options, &found, stop_s);
    Ok(Plan { model: Arc::clone(model), options, found, told })
}

/// Rows that are there already: those of a plan, or configurations to fit.
fn kept(keep: Option<&Bound<'_, PyAny>>, robot: &Robot) -> PyResult<Vec<PlannedRow>> {
    let Some(value) = keep else { return Ok(Vec::new()) };
    if let Ok(plan) = value.cast::<Plan>() {
        return Ok(plan.get().found.rows.clone());
    }
    let readings = configurations(Some(value), robot)?.unwrap_or_default();
    let width = robot.model.robot.reading_names().len();
    let parts = vec![RowPart::Fit; readings.len() / width.max(1)];
    Ok(PlannedRow::of_list(&readings, width, &parts))
}

/// Rows that were added, and the session that judges them.
struct Session {
    data: Dataset,
    watched: Option<Watched>,
}

/// A session that is watched: each row is judged before it is fitted, while the target is still there.
///
/// Parameters
/// ----------
/// robot
///     The nominal robot, or a calibrated one.
/// candidates
///     Configurations to choose the next from, shape (m, n) (default random ones within the limits).
/// over
///     Configurations in which the robot will work, shape (m, n) (default anywhere within the limits).
/// over_box_mm
///     Two corners of a box of the base frame in which the tip will work, shape (2, 3), instead of `over`.
/// sigma_position_mm, sigma_rotation_deg
///     Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
/// robot_error_mm
///     Error of the tip (RMS) that a calibration leaves however much is measured, as of `plan`.
/// frame
///     The measuring device's frame: "unknown" or "base".
/// tolerance_deg_mm
///     Prior of the fit: deviation of each axis from nominal, as standard deviations, or None.
/// corrections
///     What joints are expected to do beyond geometry, as of `plan`.
/// gravity
///     Where gravity pulls, in the robot's base frame, default (0, 0, -1).
/// seed
///     Seed of everything random.
#[pyclass(frozen, module = "poecal", name = "Watch")]
pub(crate) struct Watch {
    robot: Robot,
    options: WatchOptions,
    session: Mutex<Session>,
}

#[pymethods]
impl Watch {
    #[new]
    #[pyo3(signature = (robot, *, candidates=None, over=None, over_box_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None,
                        frame="unknown", tolerance_deg_mm=Believed::Given((0.5, 5.0)), corrections=None, gravity=None, seed=1),
            text_signature = "(robot, *, candidates=None, over=None, over_box_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None, frame='unknown', tolerance_deg_mm=(0.5, 5.0), corrections='auto', gravity=(0, 0, -1), seed=1)")]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python class")]
    fn new(
        #[pyo3(from_py_with = arg::robot)] robot: &Robot,
        candidates: Option<&Bound<'_, PyAny>>,
        over: Option<&Bound<'_, PyAny>>,
        over_box_mm: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
        #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
        #[pyo3(from_py_with = arg::robot_error_mm)] robot_error_mm: Option<RobotError>,
        #[pyo3(from_py_with = arg::frame)] frame: &str,
        #[pyo3(from_py_with = arg::tolerance_deg_mm)] tolerance_deg_mm: Believed,
        #[pyo3(from_py_with = arg::corrections)] corrections: Option<Corrections>,
        #[pyo3(from_py_with = arg::gravity)] gravity: Option<GravityDirection>,
        #[pyo3(from_py_with = arg::seed)] seed: u64,
    ) -> PyResult<Self> {
        let believe = Believe {
            sigma_position_mm,
            sigma_rotation_deg,
            robot_error_mm,
            frame,
            tolerance_deg_mm: &tolerance_deg_mm,
            corrections,
            gravity,
        };
        let data = Dataset::new(robot.model.robot.reading_names());
        let options = WatchOptions {
            fit: believe.fit(&robot.model, Kind::POINT, PlannedFit::default().count)?,
            candidates: configurations(candidates, robot)?,
            workspace: workspace(robot, over, over_box_mm, seed)?,
            seed,
        };
        Ok(Watch { robot: robot.clone(), options, session: Mutex::new(Session { data, watched: None }) })
    }

    /// Judges one row, and fits it if it is as expected.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Readings, shape (n,), radians and metres, in the order of `robot.reading_names`.
    /// position
    ///     Position of the target in the device's frame, shape (3,), metres.
    /// pose
    ///     Pose device_from_target instead of `position`, shape (4, 4).
    /// target
    ///     Name of the target, default the tip itself.
    /// id
    ///     Name of the row.
    ///
    /// Returns
    /// -------
    /// Findings
    ///     Whether the row is as expected (`ok`, None while there are too few rows to judge by), else its `mistake`; which error would be noticed
    ///     (`noticed_mm`); the errors to expect now and after ten more rows; the configuration that gains most (`next`).
    #[pyo3(signature = (joints, *, position=None, pose=None, target=None, id=None))]
    fn add(
        &self,
        py: Python<'_>,
        joints: &Bound<'_, PyAny>,
        position: Option<&Bound<'_, PyAny>>,
        pose: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arg::target)] target: Option<String>,
        #[pyo3(from_py_with = arg::id)] id: Option<String>,
    ) -> PyResult<Findings> {
        let numpy = py.import("numpy")?;
        let rows = |value: &Bound<'_, PyAny>| numpy.call_method1("asarray", ((value,),)).map(Bound::unbind);
        let joints = rows(joints)?;
        let position = position.map(rows).transpose()?;
        let pose = pose.map(rows).transpose()?;
        let columns = ArrayColumns {
            joints: joints.bind(py),
            positions: position.as_ref().map(|it| it.bind(py)),
            quaternions_xyzw: None,
            poses: pose.as_ref().map(|it| it.bind(py)),
            targets: target.map(|it| vec![it]),
            instruments: None,
            sets: None,
            ids: id.map(|it| vec![it]),
            sigma_position_mm: None,
            sigma_rotation_deg: None,
            angle_unit: "rad",
            length_unit: "m",
        };
        let one = dataset(&self.robot.model.robot, &columns)?;
        let mut found = self.judged(py, &one)?;
        found.pop().ok_or_else(|| argument("joints", "found no row, expected one"))
    }

    /// Judges the rows of measurements, one after the other.
    ///
    /// Parameters
    /// ----------
    /// measurements
    ///     The rows.
    ///
    /// Returns
    /// -------
    /// list of Findings
    ///     As of `add`, one for each row.
    fn add_all(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::measurements)] measurements: &Measurements,
    ) -> PyResult<Vec<Findings>> {
        measurements.check_robot(&self.robot)?;
        self.judged(py, measurements.data())
    }

    fn __len__(&self) -> usize {
        self.session.lock().unwrap_or_else(PoisonError::into_inner).data.len()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Watch of {}: {} rows>", self.robot.model.robot.name, self.__len__())
    }
}

impl Watch {
    /// Adds rows and judges each.
    fn judged(&self, py: Python<'_>, more: &Dataset) -> PyResult<Vec<Findings>> {
        let robot = &self.robot.model.robot;
        let work = || {
            let mut session = self.session.lock().unwrap_or_else(PoisonError::into_inner);
            let Session { data, watched } = &mut *session;
            let first = data.len();
            data.extend(more)?;
            let session = match watched {
                Some(session) => session,
                None => watched.insert(Watched::new(robot, self.options.clone().for_rows(data))?),
            };
            let judge = |row: usize| {
                let found = session.add(data, row)?;
                let line = report::Watched::new(robot, data, &found);
                Ok((line.text(), line.json()?))
            };
            (first..data.len()).map(judge).collect::<poecal::Result<Vec<_>>>()
        };
        let found = py.detach(work).map_err(raise)?;
        found.into_iter().map(|(text, json)| Findings::of_text(text, json, Vec::new())).collect()
    }
}
