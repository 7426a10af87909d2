//! `plan`: choice of configurations to measure.

pub(crate) mod plan_options;
pub(crate) mod plan_result;
pub(crate) mod test_plan;
pub(crate) mod visit_plan;

mod session;

use poecal_calibrate::Corrections;
use poecal_model::robot::GravityDirection;
use poecal_plan::plan::RobotError;
use pyo3::prelude::*;

use self::session::{PlanSession, PlanView, PlanningGoal, PlanningRows, RobotEnvironment};
use crate::arguments::{self as arg, PriorTolerance};
use crate::measurements::Measurements;
use crate::plan_options::PriorBeliefs;
use crate::visit_plan::VisitOptions;

/// Plans a session: configurations that determine the most, rows for validation, the worthwhile number, and the expected error.
///
/// With `purpose="drift"` it plans visits to a calibrated robot: the measured configurations whose repeats detect the smallest shift of the worst
/// joint. `candidates`, `count`, `earlier`, `device`, `tool` and `repeatability_mm` state the knowledge of the visits, `target` the target that will
/// be measured.
///
/// Parameters
/// ----------
/// robot
///     The robot, or the path of its model; a calibration, or a robot that was read from a calibration.json, plans the next session of it.
/// purpose
///     "calibration", "drift" for visits to a calibration, or "iso9283" for a test of ISO 9283: P1 to P5 of the largest cube, with `count` cycles (default
///     30), `floor_height_mm`, and `workspace_box_mm` for a stated cube, or a plane, of which one side is zero.
/// kind
///     Kind of the measurements of the tip: "point", "pose", "mixed" or "distance".
/// count
///     Number of different configurations to fit, from 1 to 1000 (default 30); with "drift" to measure at each visit (default 8).
/// held_out_count
///     Number of further rows for validation, at random over the workspace (default a third of `count`).
/// candidates
///     Configurations to choose from alone, shape (m, n).
/// workspace
///     Configurations in which the robot will work, shape (m, n), where predictions shall be good (default anywhere within the limits).
/// workspace_box_mm
///     Two corners of a box of the base frame in which the tip will work, shape (2, 3), instead of `workspace`.
/// keep_rows
///     Existing rows, which new ones complete: a `Plan`, or configurations to fit of shape (m, n). `count` counts both.
/// replace_rows
///     Rows of `keep_rows`, from 0, that could not be measured: they are replaced, and all other rows stay.
/// criterion
///     "expected" (expected error of the calibrated and the corrected model), or a measure of the design: "D", "A", "E", "G".
/// targets
///     Number of targets of a nest at the tip, from 1 to 8, all measured in each configuration.
/// target_offset_mm
///     Position of the target in the tip's frame; for several the first, the others turned about z.
/// sigma_position_mm, sigma_rotation_deg
///     Standard deviation of each measured component (default 0.05 mm, 0.01 deg).
/// robot_error_mm
///     Remaining error of the tip (RMS) after a calibration with any number of rows, or that and the one with corrections. By default those of a
///     calibration of this robot, else 0.3 mm for each metre of reach is assumed.
/// device_frame
///     The measuring device's frame: "unknown" or "base".
/// tolerance_deg_mm
///     Prior of the fit: deviation of each axis from nominal, as standard deviations, or None.
/// corrections
///     Expected joint effects beyond geometry: "auto" and "all" terms of the common sizes, "off" nothing, or groups with their sizes.
/// gravity
///     Direction of gravity in the robot's base frame, default (0, 0, -1).
/// margin_deg_mm
///     Distance of every joint from its limits; None for 2 degrees and 5 mm, and for none of a list of candidates.
/// keep_out_mm
///     Boxes into which no part of the robot may reach, each two corners in the base frame.
/// floor_height_mm
///     Height above which all links that move stay.
/// separation_deg
///     Least change of some joint between any two configurations.
/// device_mm
///     Position of the measuring device in the base frame; targets that links hide from it are left out.
/// device_half_angle_deg, device_aim_mm
///     Half the angle of the device's cone, and the point at which it is aimed (default the base).
/// distance_mm
///     Least and largest distance of the target from the device.
/// target_half_angle_deg, target_normal
///     Largest angle between the normal of the target, in its own frame (default (0, 0, 1)), and the line to the device.
/// self_collision
///     "avoid" overlaps of links by their shapes in the URDF, or "ignore" shapes.
/// stop_s
///     Duration of the robot's stop at each row, for the total duration.
/// seed
///     Seed of everything random.
/// earlier
///     For "drift": rows of the calibration or of an earlier visit whose configurations may be repeated (default those of the calibration).
/// device
///     For "drift": "known" if the device will stand where it stood, "refit" if not (default "known" of a calibration with device_frame="base").
/// tool
///     For "drift": "same" if the tool will be on the flange as it was, "refit" if not (default "same").
/// target
///     For "drift": the target that will be measured, of several (default all targets of the rows).
/// repeatability_mm
///     For "drift": standard deviation of one visit and coordinate, as repeats show it (default the noise of the calibration).
///
/// Returns
/// -------
/// Plan, VisitPlan or TestPlan
///     The rows in the order of their measurement, with the expected errors; with "drift" the detectable shift of each joint. Only configurations are
///     checked, never the path between them.
#[pyfunction]
#[pyo3(signature = (robot, *, purpose="calibration", kind="point", count=None, held_out_count=None, candidates=None, workspace=None, workspace_box_mm=None, keep_rows=None, replace_rows=None,
                    criterion="expected", targets=1, target_offset_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None,
                    device_frame="unknown", tolerance_deg_mm=PriorTolerance::Given((0.5, 5.0)), corrections=None, gravity=None, margin_deg_mm=None,
                    keep_out_mm=None, floor_height_mm=None, separation_deg=None, device_mm=None, device_half_angle_deg=None, device_aim_mm=None,
                    distance_mm=None, target_half_angle_deg=None, target_normal=None, self_collision="avoid", stop_s=30.0, seed=1,
                    earlier=None, device=None, tool=None, repeatability_mm=None, target=None),
        text_signature = "(robot, *, purpose='calibration', kind='point', count=None, held_out_count=None, candidates=None, workspace=None, workspace_box_mm=None, keep_rows=None, replace_rows=None, criterion='expected', targets=1, target_offset_mm=None, sigma_position_mm=None, sigma_rotation_deg=None, robot_error_mm=None, device_frame='unknown', tolerance_deg_mm=(0.5, 5.0), corrections='auto', gravity=(0, 0, -1), margin_deg_mm=None, keep_out_mm=None, floor_height_mm=None, separation_deg=None, device_mm=None, device_half_angle_deg=None, device_aim_mm=None, distance_mm=None, target_half_angle_deg=None, target_normal=None, self_collision='avoid', stop_s=30.0, seed=1, earlier=None, device=None, tool=None, repeatability_mm=None, target=None)")]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn plan<'py>(
    py: Python<'py>,
    robot: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = arg::purpose)] purpose: &str,
    #[pyo3(from_py_with = arg::kind)] kind: &str,
    #[pyo3(from_py_with = arg::count)] count: Option<usize>,
    #[pyo3(from_py_with = arg::held_out_count)] held_out_count: Option<usize>,
    candidates: Option<&Bound<'py, PyAny>>,
    workspace: Option<&Bound<'py, PyAny>>,
    workspace_box_mm: Option<&Bound<'py, PyAny>>,
    keep_rows: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = arg::replace_rows)] replace_rows: Option<Vec<usize>>,
    #[pyo3(from_py_with = arg::criterion)] criterion: &str,
    #[pyo3(from_py_with = arg::targets)] targets: usize,
    #[pyo3(from_py_with = arg::target_offset_mm)] target_offset_mm: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::sigma_position_mm)] sigma_position_mm: Option<f64>,
    #[pyo3(from_py_with = arg::sigma_rotation_deg)] sigma_rotation_deg: Option<f64>,
    #[pyo3(from_py_with = arg::robot_error_mm)] robot_error_mm: Option<RobotError>,
    #[pyo3(from_py_with = arg::device_frame)] device_frame: &str,
    #[pyo3(from_py_with = arg::tolerance_deg_mm)] tolerance_deg_mm: PriorTolerance,
    #[pyo3(from_py_with = arg::corrections)] corrections: Option<Corrections>,
    #[pyo3(from_py_with = arg::gravity)] gravity: Option<GravityDirection>,
    #[pyo3(from_py_with = arg::margin_deg_mm)] margin_deg_mm: Option<(f64, f64)>,
    keep_out_mm: Option<Vec<Bound<'py, PyAny>>>,
    #[pyo3(from_py_with = arg::floor_height_mm)] floor_height_mm: Option<f64>,
    #[pyo3(from_py_with = arg::separation_deg)] separation_deg: Option<f64>,
    #[pyo3(from_py_with = arg::device_mm)] device_mm: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::device_half_angle_deg)] device_half_angle_deg: Option<f64>,
    #[pyo3(from_py_with = arg::device_aim_mm)] device_aim_mm: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::distance_mm)] distance_mm: Option<(f64, f64)>,
    #[pyo3(from_py_with = arg::target_half_angle_deg)] target_half_angle_deg: Option<f64>,
    #[pyo3(from_py_with = arg::target_normal)] target_normal: Option<[f64; 3]>,
    #[pyo3(from_py_with = arg::self_collision)] self_collision: &str,
    #[pyo3(from_py_with = arg::stop_s)] stop_s: f64,
    #[pyo3(from_py_with = arg::seed)] seed: u64,
    #[pyo3(from_py_with = arg::earlier)] earlier: Option<&Measurements>,
    #[pyo3(from_py_with = arg::device)] device: Option<&str>,
    #[pyo3(from_py_with = arg::tool)] tool: Option<&str>,
    #[pyo3(from_py_with = arg::repeatability_mm)] repeatability_mm: Option<f64>,
    #[pyo3(from_py_with = arg::target)] target: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    let visits = VisitOptions { earlier, device, tool, repeatability_mm, target };
    let believe = PriorBeliefs {
        sigma_position_mm,
        sigma_rotation_deg,
        robot_error_mm,
        device_frame,
        tolerance_deg_mm: &tolerance_deg_mm,
        corrections,
        gravity,
    };
    let rows = PlanningRows { count, held_out_count, candidates, keep_rows, replace_rows };
    let aim = PlanningGoal { kind, criterion, workspace, workspace_box_mm, targets, target_offset_mm };
    let room = RobotEnvironment { margin_deg_mm, keep_out_mm, floor_height_mm, separation_deg, self_collision };
    let of_target = (target_half_angle_deg, target_normal);
    let view = PlanView { device_mm, device_half_angle_deg, device_aim_mm, distance_mm, of_target };
    let session = PlanSession { rows, aim, believe, room, view, stop_s, seed };
    session.plan_for(purpose, py, robot, &visits)
}
