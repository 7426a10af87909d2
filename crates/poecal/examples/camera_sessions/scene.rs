//! Random robots with a camera in the hand, beside the robot or in a head on another branch.

use nalgebra::{Vector2, Vector3};
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_model::camera::{Board, Camera, Corner, Lens, Picture, middle};
use poecal_model::measurement::{Dataset, RowLocation};
use poecal_model::robot::{Body, Joint, JointLimits, Mount, Robot};
use poecal_model::simulate::Simulation;
use poecal_model::simulate::{Configurations, random, random_chain};
use poecal_numerics::error::{Error, ErrorKind};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

/// Position of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CameraMount {
    Hand,
    Beside,
    Head,
}

/// A simulated session of pictures of a random robot.
pub(crate) struct CameraScene {
    pub(crate) place: CameraMount,
    pub(crate) nominal: Robot,
    pub(crate) data: Dataset,
}

/// Standard deviation of each coordinate of a corner, pixels.
pub(crate) const NOISE_PX: f64 = 0.3;
/// Most configurations that are tried for each picture.
const TRIES: usize = 600;
/// Nearest and farthest distance of the board, metres, and its largest tilt, rad.
const DISTANCE_M: [f64; 2] = [0.4, 1.3];
const TILT_RAD: f64 = 1.1;

/// Random parts of a scene.
struct SceneDraw {
    place: CameraMount,
    generator: ChaCha8Rng,
    lens: Lens,
    board: Board,
    /// The arm alone, without a head.
    arm: Robot,
    nominal: Robot,
    actual: Robot,
    /// Pose of the held object in the frame of the actual tip.
    tip_from_held: Pose,
    /// Pose of the fixed object in the base: board or camera; for a camera in a head at zero of its joints.
    base_from_other: Pose,
}

impl CameraScene {
    /// The scene of a seed: 5, 6 or 7 joints, one of three positions of the camera, 12 to 40 pictures.
    pub(crate) fn random(seed: u64) -> Result<Self, Error> {
        let place = [CameraMount::Hand, CameraMount::Beside, CameraMount::Head][(seed % 3) as usize];
        let joints = 5 + ((seed / 3) % 3) as usize;
        let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x00ca_3e2a);
        let count = 12 + (29.0 * random::uniform_number(&mut generator)) as usize;
        // A robot that cannot be moved so that the camera sees the board is replaced by another one.
        (0..20)
            .find_map(|attempt| {
                let arm = random_chain(joints, seed + 1_000_000 * attempt);
                let mut drawn = SceneDraw::new(place, arm, seed + 1_000_000 * attempt)?;
                let data = drawn.pictures(count)?;
                Some(CameraScene { place, nominal: drawn.nominal, data })
            })
            .ok_or_else(|| Error::new(ErrorKind::Problem, "found no robot whose camera sees the board"))
    }
}

impl SceneDraw {
    fn new(place: CameraMount, arm: Robot, seed: u64) -> Option<Self> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let board = Board::chessboard("board", [7, 5], 0.036).ok()?;
        let lens = Lens { size_px: Some([1920, 1200]), ..Lens::pinhole([1500.0, 1500.0], [959.5, 599.5]) };
        let held = Pose::new(random::rotation(&mut generator), random::normal_vector(&mut generator) * 0.05);
        let mut drawn = SceneDraw {
            place,
            lens,
            board,
            nominal: arm.clone(),
            actual: arm.clone(),
            arm,
            tip_from_held: held,
            base_from_other: Pose::identity(),
            generator,
        };
        let first = Configurations::new(&drawn.arm).random(&mut drawn.generator);
        let sight = drawn.sight();
        let base_from_held = drawn.arm.forward_kinematics(&first) * held;
        let relative = if place == CameraMount::Hand { sight } else { sight.inverse() };
        drawn.base_from_other = base_from_held * relative;
        if place == CameraMount::Head {
            drawn.nominal = with_head(&drawn.arm, &drawn.base_from_other, &mut drawn.generator);
        }
        let errors = Simulation { error_rotation_rad: 3e-3, error_position_m: 1e-3, ..Simulation::default() };
        drawn.actual = errors.perturb(&drawn.nominal, &mut drawn.generator);
        Some(drawn)
    }

    /// A pose of the board in the camera's frame.
    fn sight(&mut self) -> Pose {
        let generator = &mut self.generator;
        let depth = 0.5 + 0.6 * random::uniform_number(generator);
        let pixel = Vector2::new(
            (0.25 + 0.5 * random::uniform_number(generator)) * 1920.0,
            (0.25 + 0.5 * random::uniform_number(generator)) * 1200.0,
        );
        let ray = self.lens.ray(&pixel).unwrap_or_else(Vector3::z);
        let across = std::f64::consts::TAU * random::uniform_number(generator);
        let axis = Vector3::new(across.cos(), across.sin(), 0.0);
        let tilt = rotation::exp(&(axis * 0.8 * random::uniform_number(generator)));
        let turn = tilt * rotation::about(2, std::f64::consts::TAU * random::uniform_number(generator));
        Pose::new(turn, ray * (depth / ray.z) - turn * middle(&self.board.points))
    }

    fn pictures(&mut self, count: usize) -> Option<Dataset> {
        let mut data = Dataset::new(self.nominal.reading_names());
        data.pictures.cameras = vec![Camera::new("camera".to_owned(), self.lens)];
        data.pictures.boards = vec![self.board.clone()];
        data.pictures.sigma_px = NOISE_PX;
        let ranges = Configurations::new(&self.arm);
        let mut near = ranges.random(&mut self.generator);
        for _ in 0..count {
            let (readings, corners) = (0..TRIES).find_map(|attempt| {
                if attempt % 10 == 9 {
                    near = ranges.random(&mut self.generator);
                }
                self.picture(&near, &ranges)
            })?;
            near = readings.get(..near.len())?.to_vec();
            let picture = Picture::new(0, 0, Some(format!("{:03}.png", data.len())), corners);
            data.push_picture(&readings, picture, (None, RowLocation::default())).ok()?.ok()?;
        }
        data.settle_pixels();
        Some(data)
    }

    /// A configuration from which all of the board is seen, near another one.
    fn picture(&mut self, near: &[f64], ranges: &Configurations) -> Option<(Vec<f64>, Vec<Corner>)> {
        let sight = self.sight();
        let head: Vec<f64> = match self.place {
            CameraMount::Head => (0..2).map(|_| 0.6 * random::uniform_number(&mut self.generator) - 0.3).collect(),
            CameraMount::Hand | CameraMount::Beside => Vec::new(),
        };
        let at_zero: Vec<f64> = near.iter().copied().chain(head.iter().copied()).collect();
        let other = self.held_pose(&self.nominal, &at_zero);
        let wanted = match self.place {
            CameraMount::Hand => other * sight.inverse(),
            CameraMount::Beside | CameraMount::Head => other * sight,
        } * self.tip_from_held.inverse();
        let (arm, readings) = self.arm.arm(&[]).ok()?;
        let mut q: Vec<f64> = readings.iter().map(|&at| near[at]).collect();
        // An arm of five joints comes only near the pose.
        arm.solve_nearest(&wanted, &mut q);
        let mut all = near.to_vec();
        readings.iter().zip(&q).for_each(|(&at, value)| all[at] = *value);
        if !ranges.contain(&all) {
            return None;
        }
        all.extend(&head);
        let corners = self.corners(&all)?;
        Some((all, corners))
    }

    /// Pose of the fixed object, or of the camera in its head, in the base.
    fn held_pose(&self, robot: &Robot, readings: &[f64]) -> Pose {
        match self.place {
            CameraMount::Hand | CameraMount::Beside => self.base_from_other,
            CameraMount::Head => {
                let tilt = Body::Link(robot.joints.len() - 1);
                robot.motion_of(tilt, &robot.joint_values(readings)) * self.base_from_other
            }
        }
    }

    fn corners(&mut self, readings: &[f64]) -> Option<Vec<Corner>> {
        let held = self.actual.forward_kinematics(readings) * self.tip_from_held;
        let other = self.held_pose(&self.actual, readings);
        let camera_from_board =
            if self.place == CameraMount::Hand { held.inverse() * other } else { other.inverse() * held };
        let middle = camera_from_board.act(&middle(&self.board.points));
        let [nearest, farthest] = DISTANCE_M;
        let facing = camera_from_board.rotation.column(2).dot(&middle.normalize());
        if !(nearest..farthest).contains(&middle.z) || facing < TILT_RAD.cos() {
            return None;
        }
        let mut corners = Vec::with_capacity(self.board.points.len());
        for (point, place) in (0..).zip(&self.board.points) {
            let exact = self.lens.pixel(&camera_from_board.act(place))?;
            if !((0.0..1919.0).contains(&exact.x) && (0.0..1199.0).contains(&exact.y)) {
                return None;
            }
            let noise =
                Vector2::new(random::normal(&mut self.generator), random::normal(&mut self.generator)) * NOISE_PX;
            corners.push(Corner { point, pixel: exact + noise, sigma_px: None, weight: 1.0, line: 0 });
        }
        Some(corners)
    }
}

/// The arm with a head of two joints beside it, whose camera is named by its link alone, like the board in the hand.
fn with_head(arm: &Robot, base_from_camera: &Pose, generator: &mut ChaCha8Rng) -> Robot {
    let mut robot = Robot { tip: Some(arm.tip_body()), ..arm.clone() };
    let limits = Some(JointLimits { lower: -1.0, upper: 1.0 });
    let mut point = base_from_camera.translation;
    for (name, stands_on) in [("tilt", None), ("pan", Some(Body::Base))] {
        point += random::direction(generator) * 0.1;
        let screw = Screw::revolute(&random::direction(generator), &point);
        let mut joint = Joint::revolute(name, screw);
        joint.frame.translation = point;
        (joint.limits, joint.stands_on) = (limits, stands_on);
        robot.joints.insert(arm.joints.len(), joint);
    }
    let mount =
        |name: &str, body: usize| Mount { name: name.to_owned(), body: Body::Link(body), pose: Pose::identity() };
    robot.instruments.push(mount("camera", arm.joints.len() + 1));
    robot.mounted.push(mount("board", arm.joints.len() - 1));
    robot
}
