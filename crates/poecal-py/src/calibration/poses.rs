//! Poses of the calibrated robot's tip, and configurations for poses.

use poecal_cli::words;
use poecal_results::predictions::predict_readings;
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;

use super::content::Calibration;
use crate::arguments as arg;
use crate::arrays::JointArray;
use crate::errors::raise;
use crate::prediction::Prediction;
use crate::reach;
use crate::robot::poses;
use crate::words::one_of;

#[pymethods]
impl Calibration {
    /// Poses of the tip, or of a target.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`; or one, shape (n,).
    /// with_uncertainty
    ///     True to return the expected error of each pose too.
    /// output_frame
    ///     Frame of the poses: "base" or "device".
    /// target
    ///     Name of a target, or "tip"; default the tip, with `with_uncertainty` the first target that was measured.
    /// model
    ///     Model that predicts: "corrected", if there is one, or "calibrated", geometry alone.
    /// readings
    ///     Meaning of the arrays: "model", readings of the model, or "controller", the controller's counts, by the calibration's mapping; required if
    ///     these differ.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray or Prediction
    ///     Poses of shape (m, 4, 4), or (4, 4) for one configuration; with `with_uncertainty` a `Prediction`, always of m poses.
    #[pyo3(signature = (joints, *, with_uncertainty=false, output_frame="base", target=None, model="corrected", readings=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = arg::with_uncertainty)] with_uncertainty: bool,
        #[pyo3(from_py_with = arg::output_frame)] output_frame: &str,
        #[pyo3(from_py_with = arg::target)] target: Option<&str>,
        #[pyo3(from_py_with = arg::model)] model: &str,
        #[pyo3(from_py_with = arg::readings)] readings: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let counting = reach::find_controller_map(self.file(), readings)?;
        let frame = one_of("output_frame", output_frame, words::PREDICT_IN)?;
        let model = &self.actual_robot(model)?.model;
        let joints = JointArray::from_argument(joints, &model.robot)?;
        let width = model.robot.reading_names().len();
        let found = py
            .detach(|| {
                let readings = reach::to_model(counting.as_ref(), &joints.readings, width);
                predict_readings(model, &readings, frame, target, with_uncertainty)
            })
            .map_err(raise)?;
        match found.doubts {
            Some(doubts) => Prediction { target: found.target, poses: found.poses, doubts }.into_bound_py_any(py),
            None => poses(py, &found.poses, joints.single),
        }
    }

    /// Poses of the tip in the base, by all threads: those of `predict`, at chosen values of factors.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
    /// readings
    ///     Meaning of the arrays: "model", readings of the model, or "controller", the controller's counts, by the calibration's mapping; required if
    ///     these differ.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Poses of shape (m, 4, 4), or (4, 4) for one configuration.
    #[pyo3(signature = (joints, *, factors=None, model="corrected", readings=None))]
    fn forward_kinematics<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
        #[pyo3(from_py_with = arg::readings)] readings: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = &self.actual_robot(model)?.model.robot;
        let counting = reach::find_controller_map(self.file(), readings)?;
        reach::forward_kinematics(py, robot, (joints, counting.as_ref()), &reach::factors(robot, factors)?)
    }

    /// Motion of the tip with each reading: of its point, then its turn, in the axes of the base, deflection under weights included.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (m, 6, n), or (6, n) for one configuration: three rows in m/rad (m/m of sliding joints), then three in rad/rad (rad/m).
    #[pyo3(signature = (joints, *, factors=None, model="corrected"))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = &self.actual_robot(model)?.model.robot;
        reach::jacobian(py, robot, joints, &reach::factors(robot, factors)?)
    }

    /// Deflection of the tip under weights: its motion from the pose without compliance of joints and links.
    ///
    /// Shift of its point and its turn, in the axes of the base. Zero if the model has no such terms.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names` without factors; or one, shape (n,).
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Shape (m, 6), or (6,) for one configuration: the shift in metres, then the turn as a rotation vector in radians.
    #[pyo3(signature = (joints, *, factors=None, model="corrected"))]
    fn sag<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = &self.actual_robot(model)?.model.robot;
        reach::sag(py, robot, joints, &reach::factors(robot, factors)?)
    }

    /// Configurations that have the tip at poses.
    ///
    /// Parameters
    /// ----------
    /// poses
    ///     Poses of the tip in the base, shape (m, 4, 4), or one, (4, 4).
    /// near
    ///     Configurations to which the found ones are nearest, shape (m, n), or one for all, (n,); default all branches, for a robot with six turning
    ///     joints.
    /// held
    ///     For a robot with seven turning joints: a mapping from the reading that is held to its value (rad), or to one for each pose, shape (m,).
    ///     All branches of the other joints are then found.
    /// limits
    ///     True to keep the joints' limits.
    /// factors
    ///     Values of the corrected model's factors by their names, default their references.
    /// model
    ///     Model of the actual robot: "corrected", if there is one, or "calibrated", geometry alone.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray or list of numpy.ndarray
    ///     With `near` the nearest configuration of each pose, shape (m, n), or (n,) for one pose, NaN if there is none. Without, the branches of
    ///     each pose, a list of arrays of shape (k, n), or one array for one pose.
    #[pyo3(signature = (poses, *, near=None, held=None, limits=true, factors=None, model="corrected"))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn ik<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        near: Option<&Bound<'py, PyAny>>,
        held: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::limits)] limits: bool,
        factors: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arg::model)] model: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let actual = self.actual_robot(model)?;
        let factors = reach::factors(&actual.model.robot, factors)?;
        reach::inverse(py, actual, poses, (near, held), &factors, limits)
    }
}
