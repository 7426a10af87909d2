//! Pictures: measured corners of a board.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::Lens;
use poecal_arm::lie::Pose;

/// A camera with its lens.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Name.
    pub name: String,
    /// Lens.
    pub lens: Lens,
    /// True if the lens is a first guess from the pictures.
    #[serde(default)]
    pub is_guessed: bool,
}

impl Camera {
    /// A camera whose lens is known.
    #[must_use]
    pub fn new(name: String, lens: Lens) -> Self {
        Camera { name, lens, is_guessed: false }
    }
}

/// A measured point of a board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Corner {
    /// Index of the board's point.
    pub point: u32,
    /// Measured position, pixels.
    pub pixel: Vector2<f64>,
    /// Standard deviation of each of its coordinates, pixels, if it is stated.
    pub sigma_px: Option<f64>,
    /// Weight in the picture's pose: 1, or less down to 0 if it does not fit the others.
    pub weight: f64,
    /// Line in the file of the row.
    pub line: u32,
}

/// One picture of a board: a row of the session, whose measurement is the pose that fits its corners.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// The row.
    pub row: u32,
    /// Index of the camera.
    pub camera: usize,
    /// Index of the board.
    pub board: usize,
    /// Name of the picture, if it has one.
    pub image: Option<String>,
    /// The corners.
    pub corners: Vec<Corner>,
    /// Poses of the board in the camera's frame that fit its corners, the best first: a flat board that is far away or small has two.
    pub poses: Vec<Pose>,
    /// True if the row is the camera in the frame of the board (since the camera is on the robot), instead of the board in the camera's.
    pub of_camera: bool,
}

impl Picture {
    /// A picture without a row and without a pose.
    #[must_use]
    pub fn new(camera: usize, board: usize, image: Option<String>, corners: Vec<Corner>) -> Self {
        Picture { row: 0, camera, board, image, corners, poses: Vec::new(), of_camera: false }
    }

    /// Measurement of the row, from a pose of the board in the camera's frame, and the reverse.
    #[must_use]
    pub fn directed_measurement(&self, pose: &Pose) -> Pose {
        if self.of_camera { pose.inverse() } else { *pose }
    }
}
