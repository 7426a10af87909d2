//! Sessions with their truth, and predictions of a calibration for configurations that were not measured.

use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};
use poecal_arm::lie::{Pose, hat};
use poecal_calibrate::CalibrationOptions;
use poecal_calibrate::{Calibration, calibrate_repairing};
use poecal_fit::start::settle_pictures;
use poecal_fit::uncertainty::PredictedError;
use poecal_model::camera::{Board, Camera, Centre, CommonError, Picture};
use poecal_model::measurement::{Dataset, RowLocation, Set, deviation, picture_whitening};
use poecal_model::robot::Robot;
use poecal_model::simulate::Simulation;
use poecal_model::simulate::{PictureSimulation, SimulatedPictures, elbow};
use poecal_numerics::error::{Error, ErrorKind};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::model::{Model, ModelSource};
use poecal_results::predictions::{PredictionFrame, predict_readings};

/// Pictures of a session.
pub(crate) const COUNT: usize = 60;
/// Further configurations that judge it.
pub(crate) const FURTHER: usize = 200;
/// Errors of a usual robot: turn (rad) and shift (m) of each axis.
const ERRORS: (f64, f64) = (3e-3, 1e-3);

/// A session of [`COUNT`] pictures, and [`FURTHER`] of the same robot.
pub(crate) struct PictureSession {
    pub(crate) simulation: PictureSimulation,
    pub(crate) made: SimulatedPictures,
    /// The pictures that are fitted.
    pub(crate) data: Dataset,
    /// Further pictures.
    pub(crate) others: Dataset,
}

/// An error of each configuration, of the object on the tip and about it.
pub(crate) fn common_error(millis: f64, in_hand: bool) -> CommonError {
    let about = if in_hand { Centre::Camera } else { Centre::Board };
    CommonError { shift_m: 1e-3 * millis, turn_rad: 1e-3 * millis, about, corners: 1.0 }
}

/// A usual session of the elbow.
pub(crate) fn session(in_hand: bool, millis: f64, seed: u64) -> Result<PictureSession, Error> {
    let simulation = simulation(in_hand, millis, seed);
    simulate_session(simulation)
}

/// A usual simulation of the elbow.
pub(crate) fn simulation(in_hand: bool, millis: f64, seed: u64) -> PictureSimulation {
    let session = Simulation {
        count: COUNT + FURTHER,
        seed,
        error_rotation_rad: ERRORS.0,
        error_position_m: ERRORS.1,
        ..Simulation::default()
    };
    PictureSimulation {
        common: common_error(millis, in_hand),
        ..PictureSimulation::with_usual_camera(session, in_hand)
    }
}

/// The session of a simulation; of another seed if the robot cannot be moved so that the camera sees the board.
pub(crate) fn simulate_session(simulation: PictureSimulation) -> Result<PictureSession, Error> {
    let other = Simulation { seed: simulation.session.seed + 1_000_000, ..simulation.session };
    let again = PictureSimulation { session: other, ..simulation.clone() };
    let mut made = simulation.run(&elbow()).or_else(|_| again.run(&elbow()))?;
    let (cameras, boards) = (made.data.pictures.cameras.clone(), made.data.pictures.boards.clone());
    let part = |rows| rebuild_pictures(&made.data, rows, (&cameras, &boards));
    let mut data = part(0..COUNT)?;
    let mut others = part(COUNT..COUNT + FURTHER)?;
    settle_pictures(&mut data, &made.nominal);
    settle_pictures(&mut others, &made.nominal);
    made.data = Dataset::new(made.data.reading_names().to_vec());
    Ok(PictureSession { simulation, made, data, others })
}

/// Some pictures as read by a user with these cameras and boards.
pub(crate) fn rebuild_pictures(
    data: &Dataset,
    rows: std::ops::Range<usize>,
    (cameras, boards): (&[Camera], &[Board]),
) -> Result<Dataset, Error> {
    let mut found = Dataset::new(data.reading_names().to_vec());
    (found.pictures.cameras, found.pictures.boards) = (cameras.to_vec(), boards.to_vec());
    found.pictures.sigma_px = data.pictures.sigma_px;
    for row in rows {
        let Picture { camera, board, image, corners, .. } = data.pictures.all[row].clone();
        let picture = Picture::new(camera, board, image, corners);
        let added =
            found.push_picture(data.readings(row), picture, (data.observations[row].set, RowLocation::default()))?;
        added.map_err(|reason| Error::new(ErrorKind::Problem, reason))?;
    }
    found.settle_pixels();
    Ok(found)
}

/// Every third picture is held out.
pub(crate) fn hold_out_thirds(data: &mut Dataset) {
    for (row, observation) in data.observations.iter_mut().enumerate() {
        observation.set = Some(if row % 3 == 2 { Set::HeldOut } else { Set::Fit });
    }
}

/// The pose of the held object in the frame of the fixed one.
pub(crate) fn true_pose(made: &SimulatedPictures, robot: &Robot, readings: &[f64]) -> Pose {
    made.base_from_other.inverse() * robot.forward_kinematics(readings) * made.tip_from_held
}

/// Predictions of a calibration for configurations: poses of the device's object in the device's frame, with their uncertainty.
pub(crate) fn delivered_poses(
    calibration: &Calibration,
    data: &Dataset,
    readings: &[f64],
) -> Result<(Vec<Pose>, Vec<PredictedError>), Error> {
    let file = CalibrationFile::new(calibration, data, Inputs::default());
    let file = file.corrected_file().unwrap_or(file);
    let robot = file.robot()?;
    let path = "calibration.json".into();
    let model = Model { robot, source: ModelSource::Calibration(Box::new(file)), path };
    let found = predict_readings(&model, readings, PredictionFrame::Device, None, true)?;
    Ok((found.poses, found.doubts.unwrap_or_default().into_iter().map(|(error, _)| error).collect()))
}

/// Deviations of predicted poses from the true ones.
pub(crate) fn deviations(session: &PictureSession, poses: &[Pose]) -> Vec<Vector6<f64>> {
    let PictureSession { made, others, .. } = session;
    let truth = (0..others.len()).map(|row| true_pose(made, &made.actual, others.readings(row)));
    truth.zip(poses).map(|(truth, pose)| deviation(pose, &truth)).collect()
}

/// Deviations with the device's frame registered for the smallest shifts: the remaining errors of the arm. Linear, since they are small.
pub(crate) fn register_deviations<const N: usize>(
    places: &[Vector3<f64>],
    deviations: &[SMatrix<f64, 6, N>],
) -> Vec<SMatrix<f64, 6, N>> {
    let by_frame = |place: &Vector3<f64>| {
        let mut by = Matrix6::<f64>::identity();
        by.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(place));
        by
    };
    let (mut gram, mut pull) = (Matrix6::<f64>::zeros(), SMatrix::<f64, 6, N>::zeros());
    for (place, deviation) in places.iter().zip(deviations) {
        let by = by_frame(place).fixed_rows::<3>(0).into_owned();
        gram += by.transpose() * by;
        pull += by.transpose() * deviation.fixed_rows::<3>(0);
    }
    let motion = gram.try_inverse().unwrap_or_else(Matrix6::zeros) * pull;
    places.iter().zip(deviations).map(|(place, deviation)| deviation - by_frame(place) * motion).collect()
}

/// Remaining shifts with the device's frame, the tool and the common size fitted. The size of a free board is determined no better than that of the
/// robot, and its frame is that of its points as a whole.
pub(crate) fn shape(session: &PictureSession, deviations: &[Vector6<f64>]) -> Vec<Vector6<f64>> {
    let PictureSession { made, others, .. } = session;
    let columns = |row: usize| {
        let pose = true_pose(made, &made.actual, others.readings(row));
        let mut by = SMatrix::<f64, 3, 10>::zeros();
        by.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
        by.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(&pose.translation));
        by.fixed_view_mut::<3, 3>(0, 6).copy_from(&pose.rotation);
        by.set_column(9, &pose.translation);
        by
    };
    let (mut gram, mut pull) = (SMatrix::<f64, 10, 10>::zeros(), SMatrix::<f64, 10, 1>::zeros());
    for (row, deviation) in deviations.iter().enumerate() {
        let by = columns(row);
        gram += by.transpose() * by;
        pull += by.transpose() * deviation.fixed_rows::<3>(0);
    }
    let fitted = gram.try_inverse().unwrap_or_else(SMatrix::zeros) * pull;
    let of = |(row, deviation): (usize, &Vector6<f64>)| {
        let mut left = *deviation;
        let own = columns(row) * fitted;
        (0..3).for_each(|k| left[k] -= own[k]);
        left
    };
    deviations.iter().enumerate().map(of).collect()
}

/// Positions of the further true poses.
pub(crate) fn places(session: &PictureSession) -> Vec<Vector3<f64>> {
    let PictureSession { made, others, .. } = session;
    let place = |row| true_pose(made, &made.actual, others.readings(row)).translation;
    (0..others.len()).map(place).collect()
}

/// Root mean squares of shift and turn.
pub(crate) fn rms(deviations: &[Vector6<f64>]) -> [f64; 2] {
    let mean = |first: usize| {
        let squares = deviations.iter().map(|it| it.fixed_rows::<3>(first).norm_squared());
        (squares.sum::<f64>() / deviations.len().max(1) as f64).sqrt()
    };
    [mean(0), mean(3)]
}

/// Options with all rows fitted.
pub(crate) fn all_rows() -> CalibrationOptions {
    CalibrationOptions { held_out: Some(0.0), ..CalibrationOptions::default() }
}

/// A calibration, by the procedure of the program, with the data as they were fitted.
pub(crate) fn calibrate_session(
    robot: &Robot,
    data: &Dataset,
    options: &CalibrationOptions,
) -> Result<(Calibration, Dataset), Error> {
    let found = calibrate_repairing(robot, data, options, &mut |_| {})?;
    Ok((found.calibration, found.data.into_owned()))
}

/// A calibration with its data, and its deviations in the further configurations.
pub(crate) fn judge_session(
    session: &PictureSession,
    data: &Dataset,
    options: &CalibrationOptions,
) -> Result<(Calibration, Dataset, Vec<Vector6<f64>>), Error> {
    let (calibration, data) = calibrate_session(&session.made.nominal, data, options)?;
    let (poses, _) = delivered_poses(&calibration, &data, session.others.all_readings())?;
    Ok((calibration, data, deviations(session, &poses)))
}

/// Whitening matrices of the rows of a session by the known noise of corners at the true poses, with a common error.
pub(crate) fn whitenings(session: &PictureSession, common: CommonError) -> Vec<Matrix6<f64>> {
    let PictureSession { simulation, made, data, .. } = session;
    let of = |picture: &Picture| {
        let mut exact = picture.clone();
        exact.corners.iter_mut().for_each(|corner| corner.weight = 1.0);
        let pose = true_pose(made, &made.actual, data.readings(picture.row as usize));
        let seen = exact.directed_measurement(&pose);
        let pictures = poecal_model::camera::Pictures { sigma_px: simulation.noise_px, ..data.pictures.clone() };
        let information = pictures.view(&exact).map(|view| view.information(&seen)).unwrap_or_default();
        picture_whitening(common, (&seen, information), exact.of_camera)
    };
    data.pictures.all.iter().map(of).collect()
}
