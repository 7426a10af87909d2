//! Simulated sessions of a camera and a board.

use nalgebra::{Vector2, Vector3, Vector6};
use poecal_arm::Arm;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::{Configurations, Simulation, random};
use crate::camera::{Board, Camera, CommonError, Corner, Lens, Picture, middle, move_pose};
use crate::measurement::{Dataset, RowLocation};
use crate::robot::Robot;
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// A simulated session in which a camera takes pictures of a board, one of them on the robot's tip.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::simulate;
/// #     pub use poecal_model::simulate::Simulation;
/// # }
/// use poecal::simulate::{PictureSimulation, elbow};
/// use poecal::Simulation;
/// let session = Simulation { count: 12, error_rotation_rad: 1e-3, error_position_m: 1e-3, ..Simulation::default() };
/// let made = PictureSimulation::with_usual_camera(session, true).run(&elbow())?;
/// assert_eq!((made.data.len(), made.data.pictures.all[0].corners.len()), (12, 24));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSimulation {
    /// Errors of the robot, seed, and number of pictures; its noise is not used.
    pub session: Simulation,
    /// The lens, with the size of its picture.
    pub lens: Lens,
    /// The board.
    pub board: Board,
    /// True if the camera is on the tip, and the board is static.
    pub in_hand: bool,
    /// Nearest and farthest distance of the board from the camera, metres.
    pub distance_m: [f64; 2],
    /// Least and largest angle between the board's normal and the optical axis, rad.
    pub tilt_rad: [f64; 2],
    /// True if the board is tilted in all directions and turned at will; otherwise it is only tilted to and fro about one line.
    pub turns: bool,
    /// Position of the middle of the board in the picture: from and to, shares of width and of height.
    pub part: [[f64; 2]; 2],
    /// Standard deviation of each coordinate of a corner, pixels.
    pub noise_px: f64,
    /// Shared error of a picture's corners: the error of the arm in each configuration, about the object on its tip.
    pub common: CommonError,
}

/// A simulated session of pictures with its truth.
///
/// ```
/// # use poecal_model::simulate::{PictureSimulation, Simulation, elbow};
/// # let session = Simulation { count: 12, error_rotation_rad: 1e-3, error_position_m: 1e-3, ..Simulation::default() };
/// let made = PictureSimulation::with_usual_camera(session, true).run(&elbow())?;
/// let camera = made.actual.forward_kinematics(made.data.readings(0)) * made.tip_from_held;
/// // The camera looks along its z at the board, 0.6 to 1 m away.
/// assert!((0.4..1.2).contains(&(camera.inverse() * made.base_from_other).translation.z));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedPictures {
    /// The nominal robot.
    pub nominal: Robot,
    /// The actual robot.
    pub actual: Robot,
    /// Pose of the object on the tip, camera or board, in the frame of the actual tip.
    pub tip_from_held: Pose,
    /// Pose of the static object, board or camera, in the base.
    pub base_from_other: Pose,
    /// Pose of the board in the camera's frame in each picture, with the error of the arm there.
    pub camera_from_board: Vec<Pose>,
    /// The pictures.
    pub data: Dataset,
}

/// Largest number of configurations that are tried for each picture.
const TRIES: usize = 2000;
/// Remainder below which an arm has reached a pose.
const REACHED: f64 = 1e-9;
/// Joints of an arm that reaches any pose. A shorter arm comes as near as it can.
const JOINTS_OF_A_POSE: usize = 6;
/// Least cosine between the board's normal and the line of sight, in a view of an arm that only comes near.
const FACING: f64 = 0.5;

/// A robot in front of the static object, in a simulation of pictures.
struct PictureScene<'a> {
    arm: Arm,
    /// Readings of the arm among all.
    readings: Vec<usize>,
    configurations: Configurations,
    actual: &'a Robot,
    tip_from_held: Pose,
    base_from_other: Pose,
}

impl PictureSimulation {
    /// A camera of 1,500 px at 0.6 to 1 m from a board of 7 × 5 squares of 36 mm, with corners to 0.3 px.
    #[must_use]
    pub fn with_usual_camera(session: Simulation, in_hand: bool) -> Self {
        let lens = Lens { size_px: Some([1920, 1200]), ..Lens::pinhole([1500.0, 1500.0], [959.5, 599.5]) };
        PictureSimulation {
            session,
            lens,
            board: Board::chessboard("board", [7, 5], 0.036).unwrap_or_default(),
            in_hand,
            distance_m: [0.6, 1.0],
            tilt_rad: [0.0, 0.7],
            turns: true,
            part: [[0.2, 0.8]; 2],
            noise_px: 0.3,
            common: CommonError { shift_m: 0.0, turn_rad: 0.0, ..CommonError::default() },
        }
    }

    /// The same simulation with another board and lens, with the board from a third to a half of the height of the picture.
    #[must_use]
    pub fn with_board_and_lens(self, board: Board, lens: Lens) -> Self {
        let height_px = lens.size_px.map_or(1000.0, |[_, height]| f64::from(height));
        let distance_m = [0.54, 0.33].map(|part| lens.focal_px[0] * 2.0 * board.radius_m() / (part * height_px));
        PictureSimulation { board, lens, distance_m, ..self }
    }

    /// Simulates a robot that deviates from a nominal one, and pictures in configurations from which all of the board is seen.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`] if the robot cannot be moved so that the camera sees the board.
    pub fn run(&self, nominal: &Robot) -> Result<SimulatedPictures> {
        let mut generator = ChaCha8Rng::seed_from_u64(self.session.seed);
        let actual = self.session.perturb(nominal, &mut generator);
        let turn = random::direction(&mut generator) * 0.3;
        let held_turn =
            rotation::exp(&turn) * rotation::about(0, if self.in_hand { 0.0 } else { std::f64::consts::PI });
        let tip_from_held = Pose::new(held_turn, random::normal_vector(&mut generator) * 0.03);
        let refuse = || {
            Error::new(ErrorKind::Problem, "found no configurations in which the camera sees the board, expected some")
        };
        let (arm, readings) = nominal.arm(&[])?;
        let configurations = Configurations::new(nominal);
        // The static object is where one configuration sees it well.
        let first = configurations.random(&mut generator);
        let base_from_held = nominal.forward_kinematics(&first) * tip_from_held;
        let base_from_other = base_from_held * self.relative_pose(&self.sight(&mut generator));
        let scene = PictureScene { arm, readings, configurations, actual: &actual, tip_from_held, base_from_other };
        let mut data = Dataset::new(nominal.reading_names());
        data.pictures.cameras = vec![Camera::new("camera".to_owned(), self.lens)];
        data.pictures.boards = vec![self.board.clone()];
        data.pictures.sigma_px = self.noise_px;
        let mut camera_from_boards = Vec::with_capacity(self.session.count);
        let mut near = first;
        for _ in 0..self.session.count {
            let found = self.find_view(&scene, &mut near, &mut generator);
            let (all, camera_from_board, corners) = found.ok_or_else(refuse)?;
            let image = Some(format!("{:03}.png", data.len()));
            let picture = Picture::new(0, 0, image, corners);
            data.push_picture(&all, picture, (None, RowLocation::default()))?.map_err(|_| refuse())?;
            camera_from_boards.push(camera_from_board);
            near = all;
        }
        data.settle_pixels();
        let (nominal, camera_from_board) = (nominal.clone(), camera_from_boards);
        Ok(SimulatedPictures { nominal, actual, tip_from_held, base_from_other, camera_from_board, data })
    }

    /// Tries configurations near one, and now and then elsewhere, until all of the board is seen; returns the board and its corners too.
    fn find_view(
        &self,
        scene: &PictureScene<'_>,
        near: &mut Vec<f64>,
        generator: &mut ChaCha8Rng,
    ) -> Option<(Vec<f64>, Pose, Vec<Corner>)> {
        for attempt in 0..TRIES {
            // Now and then another branch of the arm is tried.
            if attempt % 20 == 19 {
                *near = scene.configurations.random(generator);
            }
            let wanted = scene.base_from_other
                * self.relative_pose(&self.sight(generator)).inverse()
                * scene.tip_from_held.inverse();
            let mut q: Vec<f64> = scene.readings.iter().map(|&at| near[at]).collect();
            let is_short = q.len() < JOINTS_OF_A_POSE;
            if scene.arm.solve_nearest(&wanted, &mut q) > REACHED && !is_short {
                continue;
            }
            let mut all = near.clone();
            scene.readings.iter().zip(&q).for_each(|(&at, value)| all[at] = *value);
            if !scene.configurations.contain(&all) {
                continue;
            }
            let held = self.held_pose(scene.actual, &all, &scene.tip_from_held, generator);
            let camera_from_board = if self.in_hand {
                held.inverse() * scene.base_from_other
            } else {
                scene.base_from_other.inverse() * held
            };
            if is_short && self.facing(&camera_from_board) < FACING {
                continue;
            }
            if let Some(corners) = self.corners(&camera_from_board, generator) {
                return Some((all, camera_from_board, corners));
            }
        }
        None
    }

    /// Cosine between the board's normal and the line of sight to its middle.
    fn facing(&self, camera_from_board: &Pose) -> f64 {
        let center = camera_from_board.act(&middle(&self.board.points));
        camera_from_board.rotation.column(2).dot(&center) / center.norm()
    }

    /// A pose of the board in the camera's frame.
    fn sight(&self, generator: &mut ChaCha8Rng) -> Pose {
        let mut between = |[from, to]: [f64; 2]| from + (to - from) * random::uniform_number(generator);
        let depth = between(self.distance_m);
        let [width, height] = self.lens.size_px.unwrap_or([1000, 1000]).map(f64::from);
        let pixel = Vector2::new(between(self.part[0]) * width, between(self.part[1]) * height);
        let ray = self.lens.ray(&pixel).unwrap_or_else(Vector3::z);
        // It is tilted about a line across the line of sight, and turned about it.
        let across = between([0.0, std::f64::consts::TAU]);
        let (tilt, turned) = (between(self.tilt_rad), between([0.0, std::f64::consts::TAU]));
        let turn = if self.turns {
            rotation::exp(&(Vector3::new(across.cos(), across.sin(), 0.0) * tilt)) * rotation::about(2, turned)
        } else {
            rotation::about(0, tilt * across.cos().signum())
        };
        let middle = middle(&self.board.points);
        Pose::new(turn, ray * (depth / ray.z) - turn * middle)
    }

    /// Pose of the static object in the frame of the mounted one, by the pose of the board in the camera's frame.
    fn relative_pose(&self, camera_from_board: &Pose) -> Pose {
        if self.in_hand { *camera_from_board } else { camera_from_board.inverse() }
    }

    /// Mounted object in the base, with the error of this configuration.
    fn held_pose(&self, actual: &Robot, readings: &[f64], tip_from_held: &Pose, generator: &mut ChaCha8Rng) -> Pose {
        let exact = actual.forward_kinematics(readings) * *tip_from_held;
        let shift = random::normal_vector(generator) * self.common.shift_m;
        let turn = random::normal_vector(generator) * self.common.turn_rad;
        move_pose(&exact, &Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z))
    }

    /// Corners as they are seen; `None` if one is not in the picture.
    fn corners(&self, camera_from_board: &Pose, generator: &mut ChaCha8Rng) -> Option<Vec<Corner>> {
        let size = self.lens.size_px.map(|size| size.map(f64::from));
        let mut corners = Vec::with_capacity(self.board.points.len());
        for (point, place) in (0..).zip(&self.board.points) {
            let exact = self.lens.pixel(&camera_from_board.act(place))?;
            let is_inside = size.is_none_or(|[width, height]| {
                (0.0..width - 1.0).contains(&exact.x) && (0.0..height - 1.0).contains(&exact.y)
            });
            if !is_inside {
                return None;
            }
            let noise = Vector2::new(random::normal(generator), random::normal(generator)) * self.noise_px;
            corners.push(Corner { point, pixel: exact + noise, sigma_px: None, weight: 1.0, line: 0 });
        }
        Some(corners)
    }
}
