//! `Watch`: rows judged as they arrive.

use std::sync::{Mutex, PoisonError};

use poecal_calibrate::Corrections;
use poecal_model::measurement::Dataset;
use poecal_model::robot::GravityDirection;
use poecal_model::simulate::SessionKind;
use poecal_plan::plan::{PlannedFit, RobotError, Watch as Watched, WatchOptions};
use poecal_report as report;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{self as arg, PriorTolerance, refuse_unknown};
use crate::errors::{argument, raise};
use crate::findings::Findings;
use crate::from_arrays::{ArrayColumns, dataset};
use crate::measurements::Measurements;
use crate::plan_options::{PriorBeliefs, configurations, workspace as workspace_of};
use crate::robot::Robot;

/// Rows that were added, and the session that judges them.
struct WatchSession {
    data: Dataset,
    watched: Option<Watched>,
}

/// A session that is watched: each row is judged before it is fitted, while the target is still in place.
///
/// Parameters
/// ----------
/// robot
///     The nominal robot, or a calibrated one.
/// candidates
///     Configurations to choose the next from, shape (m, n) (default random ones within the limits).
/// workspace
///     Configurations in which the robot will work, shape (m, n) (default anywhere within the limits).
/// workspace_box_mm
///     Two corners of a box of the base frame in which the tip will work, shape (2, 3), instead of `workspace`.
/// sigma_position_mm, sigma_rotation_deg
///     Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
/// robot_error_mm
///     Remaining error of the tip (RMS) after a calibration with any number of rows, as of `plan`.
/// device_frame
///     The measuring device's frame: "unknown" or "base".
/// tolerance_deg_mm
///     Prior of the fit: deviation of each axis from nominal, as standard deviations, or None.
/// corrections
///     Expected joint effects beyond geometry, as of `plan`.
/// gravity
///     Direction of gravity in the robot's base frame, default (0, 0, -1).
/// seed
///     Seed of everything random.
#[pyclass(frozen, module = "poecal", name = "Watch")]
pub(crate) struct Watch {
    robot: Robot,
    options: WatchOptions,
    session: Mutex<WatchSession>,
}

#[pymethods]
impl Watch {
    #[new]
    #[pyo3(signature = (robot, *, candidates=None, workspace=None, workspace_box_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None,
                        device_frame="unknown", tolerance_deg_mm=PriorTolerance::Given((0.5, 5.0)), corrections=None, gravity=None, seed=1, **unknown),
            text_signature = "(robot, *, candidates=None, workspace=None, workspace_box_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None, device_frame='unknown', tolerance_deg_mm=(0.5, 5.0), corrections='auto', gravity=(0, 0, -1), seed=1)")]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python class")]
    fn new(
        py: Python<'_>,
        #[pyo3(from_py_with = arg::robot)] robot: &Robot,
        candidates: Option<&Bound<'_, PyAny>>,
        workspace: Option<&Bound<'_, PyAny>>,
        workspace_box_mm: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
        #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
        #[pyo3(from_py_with = arg::robot_error_mm)] robot_error_mm: Option<RobotError>,
        #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
        #[pyo3(from_py_with = arg::tolerance_deg_mm)] tolerance_deg_mm: PriorTolerance,
        #[pyo3(from_py_with = arg::corrections)] corrections: Option<Corrections>,
        #[pyo3(from_py_with = arg::gravity)] gravity: Option<GravityDirection>,
        #[pyo3(from_py_with = arg::seed)] seed: u64,
        unknown: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        refuse_unknown::<Watch>(py, unknown)?;
        let believe = PriorBeliefs {
            sigma_position_mm,
            sigma_rotation_deg,
            robot_error_mm,
            device_frame,
            tolerance_deg_mm: &tolerance_deg_mm,
            corrections,
            gravity,
        };
        let data = Dataset::new(robot.model.robot.reading_names());
        let options = WatchOptions {
            fit: believe.fit(&robot.model, SessionKind::POINT, PlannedFit::default().count)?,
            candidates: configurations(candidates, robot)?,
            workspace: workspace_of(robot, workspace, workspace_box_mm, seed)?,
            seed,
        };
        Ok(Watch { robot: robot.clone(), options, session: Mutex::new(WatchSession { data, watched: None }) })
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
    /// WatchedRow
    ///     Comparison of the row with the expectation (`ok`, None while there are too few rows), or else its `mistake`; the detectable error
    ///     (`noticed_mm`); the expected errors now and after ten more rows; the configuration that gains most (`next`).
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
        let mut found = self.judge_rows(py, &one)?;
        found.pop().ok_or_else(|| argument("joints", "found no row, expected one"))
    }

    /// Judges the rows of measurements in sequence.
    ///
    /// Parameters
    /// ----------
    /// measurements
    ///     The rows.
    ///
    /// Returns
    /// -------
    /// list of WatchedRow
    ///     Results as of `add`, one for each row.
    fn add_all(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arg::measurements)] measurements: &Measurements,
    ) -> PyResult<Vec<Findings>> {
        measurements.check_robot(&self.robot)?;
        self.judge_rows(py, measurements.data())
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
    fn judge_rows(&self, py: Python<'_>, more: &Dataset) -> PyResult<Vec<Findings>> {
        let robot = &self.robot.model.robot;
        let work = || {
            let mut session = self.session.lock().unwrap_or_else(PoisonError::into_inner);
            let WatchSession { data, watched } = &mut *session;
            let first = data.len();
            data.extend(more)?;
            let session = match watched {
                Some(session) => session,
                None => watched.insert(Watched::new(robot, self.options.clone().for_rows(data))?),
            };
            let judge = |row: usize| {
                let found = session.add(data, row)?;
                let line = report::RowReport::new(robot, data, &found);
                Ok(Findings::of_json("WatchedRow", line.text(), line.answer(), line.json()?))
            };
            (first..data.len()).map(judge).collect::<poecal_numerics::error::Result<Vec<_>>>()
        };
        py.detach(work).map_err(raise)
    }
}
