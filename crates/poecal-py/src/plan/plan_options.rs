//! Arguments that `plan` and `Watch` share: prior assumptions on a session, configurations, boxes, the workspace.

use nalgebra::Vector3;
use poecal_calibrate::{Corrections, DeviceFrameKnowledge};
use poecal_fit::analysis::PlannedSession;
use poecal_model::measurement::{Noise, Quantity};
use poecal_model::robot::{GravityDirection, Tolerance};
use poecal_model::simulate::SessionKind;
use poecal_plan::plan::{PlannedFit, RobotError, workspace_in};
use poecal_results::model::Model;
use pyo3::prelude::*;

use crate::arguments::PriorTolerance;
use crate::arrays::{JointArray, NumberArray};
use crate::calibrate::tolerance;
use crate::errors::{argument, raise};
use crate::robot::Robot;
use crate::words::{frame as frame_word, from_mm, sigmas};

/// Prior assumptions on a session before its measurement.
pub(crate) struct PriorBeliefs<'a> {
    pub(crate) sigma_position_mm: Option<f64>,
    pub(crate) sigma_rotation_deg: Option<f64>,
    pub(crate) robot_error_mm: Option<RobotError>,
    pub(crate) device_frame: &'a str,
    pub(crate) tolerance_deg_mm: &'a PriorTolerance,
    pub(crate) corrections: Option<Corrections>,
    pub(crate) gravity: Option<GravityDirection>,
}

impl PriorBeliefs<'_> {
    /// The planned fit of so many configurations of a kind.
    pub(crate) fn fit(self, model: &Model, kind: SessionKind, count: usize) -> PyResult<PlannedFit> {
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
            PriorTolerance::Auto => {
                let message = "found `auto`, which measurements decide, expected two numbers, like (0.5, 5), or None";
                return Err(argument("tolerance_deg_mm", message));
            }
            PriorTolerance::None | PriorTolerance::Given(_) | PriorTolerance::Of(_) => {
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
                device_free: frame_word(self.device_frame)? == DeviceFrameKnowledge::Unknown,
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

/// A position in metres.
pub(crate) fn place(of_mm: Option<[f64; 3]>) -> Option<Vector3<f64>> {
    of_mm.map(|it| Vector3::from(it.map(from_mm)))
}

/// Configurations of an argument.
pub(crate) fn configurations(value: Option<&Bound<'_, PyAny>>, robot: &Robot) -> PyResult<Option<Vec<f64>>> {
    value.map(|value| Ok(JointArray::from_argument(value, &robot.model.robot)?.readings)).transpose()
}

/// Two corners of a box, metres.
pub(crate) fn corners(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[[f64; 3]; 2]> {
    let expected = "shape (2, 3): two corners of a box in the base frame, millimetres";
    let numbers = NumberArray::finite_of(value, name, &[Some(2), Some(3)], expected)?.values;
    let at = |k: usize| numbers.get(k).copied().map_or(0.0, from_mm);
    let (a, b) = ([at(0), at(1), at(2)], [at(3), at(4), at(5)]);
    Ok([[0, 1, 2].map(|k: usize| a[k].min(b[k])), [0, 1, 2].map(|k: usize| a[k].max(b[k]))])
}

/// The workspace in which predictions shall be good: configurations, or those with the tip in a box.
pub(crate) fn workspace(
    robot: &Robot,
    workspace: Option<&Bound<'_, PyAny>>,
    workspace_box_mm: Option<&Bound<'_, PyAny>>,
    seed: u64,
) -> PyResult<Option<Vec<f64>>> {
    match (workspace, workspace_box_mm) {
        (Some(_), Some(_)) => {
            Err(argument("workspace_box_mm", "found both workspace and workspace_box_mm, expected one of the two"))
        }
        (over, None) => configurations(over, robot),
        (None, Some(corners_mm)) => {
            let corners = corners(corners_mm, "workspace_box_mm")?;
            workspace_in(&robot.model.robot, &corners, seed).map(Some).map_err(raise)
        }
    }
}
