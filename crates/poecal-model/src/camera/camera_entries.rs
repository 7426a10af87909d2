//! Cameras and boards in files of poecal, in pixels and millimetres.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Board, Camera, Distortion, Lens};
use poecal_numerics::error::{ErrorKind, Result};

/// A body of known points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoardEntry {
    /// Name.
    pub name: String,
    /// Points.
    pub points: Vec<PointEntry>,
}

/// A point of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointEntry {
    /// Name.
    pub name: String,
    /// Position in the frame of the body, millimetres.
    pub place_mm: [f64; 3],
}

/// A camera with its lens.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CameraEntry {
    /// Name.
    pub name: String,
    /// Focal lengths along u and v, pixels.
    pub focal_px: [f64; 2],
    /// Intersection of the axis with the picture, pixels; the centre of the first pixel is (0, 0).
    pub centre_px: [f64; 2],
    /// `brown` with k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order, or `fisheye` with k1 to k4.
    pub model: String,
    /// Coefficients of the distortion.
    pub distortion: Vec<f64>,
    /// Width and height, pixels; null if they are not known.
    pub size_px: Option<[u32; 2]>,
}

impl BoardEntry {
    /// Entry of a board.
    #[must_use]
    pub fn from_board(board: &Board) -> Self {
        let point = |(name, point): (&String, &Vector3<f64>)| PointEntry {
            name: name.clone(),
            place_mm: [0, 1, 2].map(|axis| 1e3 * point[axis]),
        };
        BoardEntry { name: board.name.clone(), points: board.names.iter().zip(&board.points).map(point).collect() }
    }

    /// Board of the entry.
    #[must_use]
    pub fn board(&self) -> Board {
        let place = |point: &PointEntry| Vector3::from(point.place_mm) * 1e-3;
        Board {
            name: self.name.clone(),
            names: self.points.iter().map(|it| it.name.clone()).collect(),
            points: self.points.iter().map(place).collect(),
        }
    }
}

/// Largest side of a picture, pixels.
pub const LARGEST_SIDE: u32 = 100_000;

/// Width and height of a camera's pictures, as a file states them; `None` if it does not state both.
///
/// # Errors
/// [`ErrorKind::Measurement`] without a place, if they are not whole numbers of pixels.
pub fn size_of_pictures(stated: [Option<f64>; 2]) -> Result<Option<[u32; 2]>> {
    let [Some(width), Some(height)] = stated else { return Ok(None) };
    let is_side = |side: f64| side.fract() == 0.0 && (1.0..=f64::from(LARGEST_SIDE)).contains(&side);
    if is_side(width) && is_side(height) {
        return Ok(Some([width as u32, height as u32]));
    }
    ErrorKind::Measurement.refuse(format!(
        "found pictures of {width} × {height} pixels, expected whole numbers from 1 to {LARGEST_SIDE}, or no size"
    ))
}

impl CameraEntry {
    /// Camera of the entry.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] without a place, if the numbers are those of no camera.
    pub fn camera(&self) -> Result<Camera> {
        let own = &self.distortion;
        let distortion = match self.model.as_str() {
            "brown" => <[f64; 8]>::try_from(own.as_slice()).ok().map(Distortion::Brown),
            "fisheye" => <[f64; 4]>::try_from(own.as_slice()).ok().map(Distortion::Fisheye),
            _ => None,
        };
        let distortion = distortion.ok_or_else(|| {
            let (count, model) = (own.len(), &self.model);
            ErrorKind::Measurement.error(format!(
                "found {count} coefficients of a distortion `{model}`, expected 8 of `brown` or 4 of `fisheye`"
            ))
        })?;
        let CameraEntry { focal_px, centre_px, size_px, .. } = *self;
        size_of_pictures(size_px.map_or([None; 2], |it| it.map(|side| Some(f64::from(side)))))?;
        Ok(Camera::new(self.name.clone(), Lens { focal_px, centre_px, distortion, size_px }))
    }

    /// Entry of a camera.
    #[must_use]
    pub fn from_camera(camera: &Camera) -> Self {
        let lens = &camera.lens;
        let (model, distortion) = match lens.distortion {
            Distortion::Brown(k) => ("brown", k.to_vec()),
            Distortion::Fisheye(k) => ("fisheye", k.to_vec()),
        };
        CameraEntry {
            name: camera.name.clone(),
            focal_px: lens.focal_px,
            centre_px: lens.centre_px,
            model: model.to_owned(),
            distortion,
            size_px: lens.size_px,
        }
    }
}
