//! A session that is to be planned: the request, in the words and units of Python.

use std::sync::Arc;

use nalgebra::Vector3;
use poecal_calibrate::STANDARD_CYCLES;
use poecal_cli::words;
use poecal_plan::plan::{Conditions, DeviceView, PlanOptions, PlannedRow, RowPurpose, plan as planned};
use poecal_report as report;
use poecal_results::model::Model;
use poecal_results::shapes::capsules_of;
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;

use crate::arguments::PriorTolerance;
use crate::calibration::Calibration;
use crate::errors::{argument, raise};
use crate::paths;
use crate::plan_options::{PriorBeliefs, configurations, corners, place, workspace};
use crate::plan_result::Plan;
use crate::robot::Robot;
use crate::test_plan::TestPlan;
use crate::visit_plan::VisitOptions;
use crate::words::{choose_word, from_mm, kind as kind_word, one_of, sigma, size};

/// Most configurations of a plan, and most rows for validation, as in the program.
const MOST: usize = 1000;
/// Most targets of a nest, as in the program.
const MOST_TARGETS: usize = 8;

/// Rows that are planned, and existing ones.
pub(super) struct PlanningRows<'a, 'py> {
    pub(super) count: Option<usize>,
    pub(super) held_out_count: Option<usize>,
    pub(super) candidates: Option<&'a Bound<'py, PyAny>>,
    pub(super) keep_rows: Option<&'a Bound<'py, PyAny>>,
    pub(super) replace_rows: Option<Vec<usize>>,
}

/// Measured quantities, and the workspace in which predictions shall be good.
pub(super) struct PlanningGoal<'a, 'py> {
    pub(super) kind: &'a str,
    pub(super) criterion: &'a str,
    pub(super) workspace: Option<&'a Bound<'py, PyAny>>,
    pub(super) workspace_box_mm: Option<&'a Bound<'py, PyAny>>,
    pub(super) targets: usize,
    pub(super) target_offset_mm: Option<[f64; 3]>,
}

/// Permitted space of the robot.
pub(super) struct RobotEnvironment<'a, 'py> {
    pub(super) margin_deg_mm: Option<(f64, f64)>,
    pub(super) keep_out_mm: Option<Vec<Bound<'py, PyAny>>>,
    pub(super) floor_height_mm: Option<f64>,
    pub(super) separation_deg: Option<f64>,
    pub(super) self_collision: &'a str,
}

/// Field of view of the measuring device.
pub(super) struct PlanView {
    pub(super) device_mm: Option<[f64; 3]>,
    pub(super) device_half_angle_deg: Option<f64>,
    pub(super) device_aim_mm: Option<[f64; 3]>,
    pub(super) distance_mm: Option<(f64, f64)>,
    /// Half the angle about its normal, degrees, and the normal.
    pub(super) of_target: (Option<f64>, Option<[f64; 3]>),
}

/// Purpose of a plan.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PlanPurpose {
    Calibration,
    Drift,
    Iso9283,
}

/// A session that is to be planned.
pub(super) struct PlanSession<'a, 'py> {
    pub(super) rows: PlanningRows<'a, 'py>,
    pub(super) aim: PlanningGoal<'a, 'py>,
    pub(super) believe: PriorBeliefs<'a>,
    pub(super) room: RobotEnvironment<'a, 'py>,
    pub(super) view: PlanView,
    pub(super) stop_s: f64,
    pub(super) seed: u64,
}

impl PlanSession<'_, '_> {
    /// Plans a calibration, or visits to a calibrated robot.
    pub(super) fn plan_for<'py>(
        self,
        purpose: &str,
        py: Python<'py>,
        robot: &Bound<'py, PyAny>,
        visits: &VisitOptions<'_>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let known = [
            ("calibration", PlanPurpose::Calibration),
            ("drift", PlanPurpose::Drift),
            ("iso9283", PlanPurpose::Iso9283),
        ];
        let purpose = choose_word("purpose", purpose, &known)?;
        match purpose {
            PlanPurpose::Drift => {
                self.refuse_others(purpose)?;
                visits.plan(py, robot, self.rows.count, self.rows.candidates)?.into_pyobject(py)
            }
            PlanPurpose::Iso9283 => {
                visits.refuse()?;
                self.refuse_others(purpose)?;
                self.plan_test(py, planned_robot(robot)?.get())?.into_bound_py_any(py)
            }
            PlanPurpose::Calibration => {
                visits.refuse()?;
                self.plan(py, planned_robot(robot)?.get())?.into_bound_py_any(py)
            }
        }
    }

    /// Plans a test of ISO 9283.
    fn plan_test(self, py: Python<'_>, robot: &Robot) -> PyResult<TestPlan> {
        let cycles = self.rows.count.unwrap_or(STANDARD_CYCLES);
        refuse_numbers(cycles, 0, 1)?;
        let stated = self.aim.workspace_box_mm.map(|it| corners(it, "workspace_box_mm")).transpose()?;
        let floor_m = self.room.floor_height_mm.map(from_mm);
        py.detach(|| TestPlan::new(&robot.model, stated, floor_m, cycles))
    }

    /// Refuses what is stated of a calibration where visits or a test are planned. What a default says is no statement.
    fn refuse_others(&self, purpose: PlanPurpose) -> PyResult<()> {
        let PlanSession { rows, aim, believe, room, view, stop_s, seed } = self;
        let usual = *believe.tolerance_deg_mm == PriorTolerance::Given((0.5, 5.0));
        let stated = [
            ("kind", aim.kind != "point"),
            ("held_out_count", rows.held_out_count.is_some()),
            ("workspace", aim.workspace.is_some()),
            ("workspace_box_mm", aim.workspace_box_mm.is_some() && purpose == PlanPurpose::Drift),
            ("candidates", rows.candidates.is_some() && purpose == PlanPurpose::Iso9283),
            ("keep_rows", rows.keep_rows.is_some()),
            ("replace_rows", rows.replace_rows.is_some()),
            ("criterion", aim.criterion != "expected"),
            ("targets", aim.targets != 1),
            ("target_offset_mm", aim.target_offset_mm.is_some()),
            ("sigma_position_mm", believe.sigma_position_mm.is_some()),
            ("sigma_rotation_deg", believe.sigma_rotation_deg.is_some()),
            ("robot_error_mm", believe.robot_error_mm.is_some()),
            ("device_frame", believe.device_frame != "unknown"),
            ("tolerance_deg_mm", !usual),
            ("corrections", believe.corrections.is_some()),
            ("gravity", believe.gravity.is_some()),
            ("margin_deg_mm", room.margin_deg_mm.is_some()),
            ("keep_out_mm", room.keep_out_mm.is_some()),
            ("floor_height_mm", room.floor_height_mm.is_some() && purpose == PlanPurpose::Drift),
            ("separation_deg", room.separation_deg.is_some()),
            ("device_mm", view.device_mm.is_some()),
            ("device_half_angle_deg", view.device_half_angle_deg.is_some()),
            ("device_aim_mm", view.device_aim_mm.is_some()),
            ("distance_mm", view.distance_mm.is_some()),
            ("target_half_angle_deg", view.of_target.0.is_some()),
            ("target_normal", view.of_target.1.is_some()),
            ("self_collision", room.self_collision != "avoid"),
            ("stop_s", *stop_s != 30.0),
            ("seed", *seed != 1),
        ];
        if let Some((name, _)) = stated.into_iter().find(|it| it.1) {
            let message = if purpose == PlanPurpose::Iso9283 {
                "found it with purpose=\"iso9283\", expected only count, workspace_box_mm and floor_height_mm beside it"
            } else {
                "found it with purpose=\"drift\", expected only candidates, count, earlier, device, tool and repeatability_mm beside it"
            };
            return Err(argument(name, message));
        }
        Ok(())
    }

    /// Plans the session.
    fn plan(self, py: Python<'_>, robot: &Robot) -> PyResult<Plan> {
        let PlanSession { rows, aim, believe, room, view, stop_s, seed } = self;
        let count = rows.count.unwrap_or(30);
        refuse_numbers(count, rows.held_out_count.unwrap_or(0), aim.targets)?;
        let model = &robot.model;
        let conditions = conditions(py, model, &room, &view)?;
        let kept = kept_rows(rows.keep_rows, robot)?;
        let replaced = rows.replace_rows.unwrap_or_default();
        if let Some(row) = replaced.iter().find(|&&row| row >= kept.len()) {
            let expected = format!("found {row}, expected a row of keep_rows, from 0 to below {}", kept.len());
            return Err(argument("replace_rows", expected));
        }
        let options = PlanOptions {
            fit: believe
                .fit(model, kind_word(aim.kind)?, count)?
                .with_targets(aim.targets, aim.target_offset_mm.map(|it| it.map(from_mm))),
            criterion: one_of("criterion", aim.criterion, words::CRITERION)?,
            list: configurations(rows.candidates, robot)?,
            workspace: workspace(robot, aim.workspace, aim.workspace_box_mm, seed)?,
            judge: rows.held_out_count,
            conditions,
            kept,
            replaced,
            seed,
            ..PlanOptions::default()
        };
        let stop_s = sigma("stop_s", stop_s, std::convert::identity)?;
        let found = py.detach(|| planned(&model.robot, &options)).map_err(raise)?;
        let told = report::PlanReport::new(model, &options, &found, stop_s);
        Ok(Plan { model: Arc::clone(model), options, found, told })
    }
}

/// Refuses numbers of rows and targets that a plan cannot have.
fn refuse_numbers(count: usize, judge: usize, targets: usize) -> PyResult<()> {
    for (name, number, least, most) in
        [("count", count, 1, MOST), ("held_out_count", judge, 0, MOST), ("targets", targets, 1, MOST_TARGETS)]
    {
        if !(least..=most).contains(&number) {
            return Err(argument(name, format!("found {number}, expected {least} to {most}")));
        }
    }
    Ok(())
}

/// Conditions on a configuration.
fn conditions(py: Python<'_>, model: &Model, room: &RobotEnvironment<'_, '_>, view: &PlanView) -> PyResult<Conditions> {
    let sight = [
        ("device_half_angle_deg", view.device_half_angle_deg.is_some()),
        ("device_aim_mm", view.device_aim_mm.is_some()),
        ("distance_mm", view.distance_mm.is_some()),
        ("target_half_angle_deg", view.of_target.0.is_some()),
        ("target_normal", view.of_target.1.is_some()),
    ];
    if let Some((name, _)) = sight.into_iter().find(|it| it.1 && view.device_mm.is_none()) {
        return Err(argument(name, "found it without device_mm, expected the device's place beside it"));
    }
    let angle = |name, value: Option<f64>| value.map(|it| sigma(name, it, f64::to_radians)).transpose();
    let cone = angle("device_half_angle_deg", view.device_half_angle_deg)?;
    let acceptance_rad = angle("target_half_angle_deg", view.of_target.0)?;
    let boxes = room.keep_out_mm.iter().flatten();
    let named = |(at, value): (usize, &Bound<'_, PyAny>)| corners(value, &format!("keep_out_mm[{at}]"));
    let is_avoiding = one_of("self_collision", room.self_collision, words::SELF_COLLISION)?;
    let (capsules, notes) = if is_avoiding { capsules_of(model) } else { Default::default() };
    crate::warn(py, &notes)?;
    Ok(Conditions {
        margin: match room.margin_deg_mm {
            Some((angle, length)) => {
                let name = "margin_deg_mm";
                Some([size(name, angle, f64::to_radians)?, size(name, length, from_mm)?])
            }
            None => None,
        },
        keep_out: boxes.enumerate().map(named).collect::<PyResult<_>>()?,
        floor_m: room.floor_height_mm.map(from_mm),
        separation_rad: angle("separation_deg", room.separation_deg)?.unwrap_or(0.0),
        sight: place(view.device_mm).map(|at| DeviceView {
            place: at,
            cone: cone.map(|half| (place(view.device_aim_mm).unwrap_or_default(), half)),
            distance_m: view.distance_mm.map_or([0.0, f64::INFINITY], |(low, high)| [low, high].map(from_mm)),
            acceptance_rad,
            facing: view.of_target.1.map_or_else(Vector3::z, Vector3::from),
        }),
        capsules,
    })
}

/// Existing rows: those of a plan, or configurations to fit.
fn kept_rows(keep_rows: Option<&Bound<'_, PyAny>>, robot: &Robot) -> PyResult<Vec<PlannedRow>> {
    let Some(value) = keep_rows else { return Ok(Vec::new()) };
    if let Ok(plan) = value.cast::<Plan>() {
        return Ok(plan.get().found.rows.clone());
    }
    let readings = configurations(Some(value), robot)?.unwrap_or_default();
    let width = robot.model.robot.reading_names().len();
    let parts = vec![RowPurpose::Fit; readings.len() / width.max(1)];
    Ok(PlannedRow::of_list(&readings, width, &parts))
}

/// The robot whose session is planned: the stated one, that of a path, or the calibrated one of a calibration.
fn planned_robot<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Robot>> {
    match value.cast::<Calibration>() {
        Ok(calibration) => Bound::new(value.py(), calibration.get().calibrated_robot()?.clone()),
        Err(_) => paths::robot(value),
    }
}
