//! The pictures of a session in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::camera::{Camera, Centre, Distortion};
use crate::measurement::Dataset;

/// The pictures of the session: their noise, and the lenses that they were read with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PicturesEntry {
    /// Number of pictures.
    pub count: usize,
    /// Number of corners in them.
    pub corners: usize,
    /// Those that lost their weight, since they do not fit the others of their picture.
    pub without_weight: usize,
    /// Standard deviation of each coordinate of a corner that states none, pixels.
    pub sigma_px: f64,
    /// What the corners of a picture share: the error of the configuration.
    pub common: CommonEntry,
    /// The cameras.
    pub cameras: Vec<CameraEntry>,
}

/// The error that the corners of a picture share: standard deviations of each component.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommonEntry {
    /// Shift, millimetres.
    pub shift_mm: f64,
    /// Turn, degrees.
    pub turn_deg: f64,
    /// What it turns about.
    pub about: Centre,
}

/// A camera with its lens.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CameraEntry {
    /// Its name.
    pub name: String,
    /// Focal lengths along u and v, pixels.
    pub focal_px: [f64; 2],
    /// Where the axis meets the picture, pixels; the centre of the first pixel is (0, 0).
    pub centre_px: [f64; 2],
    /// `brown` with k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order, or `fisheye` with k1 to k4.
    pub model: String,
    /// Coefficients of the distortion.
    pub distortion: Vec<f64>,
    /// Width and height, pixels; null if they are not known.
    pub size_px: Option<[u32; 2]>,
}

impl PicturesEntry {
    /// Of a session; `None` without pictures.
    pub(super) fn of(data: &Dataset) -> Option<Self> {
        let pictures = &data.pictures;
        if pictures.is_empty() {
            return None;
        }
        let corners = || pictures.all.iter().flat_map(|picture| &picture.corners);
        Some(PicturesEntry {
            count: pictures.all.len(),
            corners: corners().count(),
            without_weight: corners().filter(|corner| corner.weight == 0.0).count(),
            sigma_px: pictures.sigma_px,
            common: CommonEntry {
                shift_mm: 1e3 * pictures.common.shift_m,
                turn_deg: pictures.common.turn_rad.to_degrees(),
                about: pictures.common.about,
            },
            cameras: pictures.cameras.iter().map(CameraEntry::of).collect(),
        })
    }
}

impl CameraEntry {
    fn of(camera: &Camera) -> Self {
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
