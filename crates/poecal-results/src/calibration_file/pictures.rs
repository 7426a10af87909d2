//! The pictures of a session in `calibration.json`, and its cameras and boards as input of another session.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_calibrate::ImageMap;
use poecal_import::ReadOptions;
use poecal_model::camera::{BoardEntry, CameraEntry, Centre, CommonError, PictureNumber};
use poecal_model::measurement::Dataset;
use poecal_numerics::error::Result;

/// The pictures of the session: their noise, and the lenses by which they were read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PicturesEntry {
    /// Number of pictures.
    pub count: usize,
    /// Number of corners in them.
    pub corners: usize,
    /// Corners that lost their weight, since they do not fit the others of their picture.
    pub without_weight: usize,
    /// Standard deviation of each coordinate of a corner that states none, pixels.
    pub sigma_px: f64,
    /// Error that all corners of a picture share: the error of the configuration.
    pub common: CommonEntry,
    /// The cameras.
    pub cameras: Vec<CameraEntry>,
    /// The boards.
    #[serde(default)]
    pub boards: Vec<BoardEntry>,
    /// Numbers of cameras and boards that were fitted together with the robot (`--free lens`, `board`, `markers`) and replace those above; absent if
    /// all were held.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub found: Vec<PictureNumber>,
    /// Errors of corners over the image of each camera whose picture has a known size.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub images: Vec<ImageMap>,
}

/// The error that the corners of a picture share: standard deviations of each component.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommonEntry {
    /// Shift, millimetres.
    pub shift_mm: f64,
    /// Turn, degrees.
    pub turn_deg: f64,
    /// Point about which it turns.
    pub about: Centre,
    /// Ratio by which the corners move the pose of the board more than their own noise does, for a picture of another lens or board; 1 if absent.
    #[serde(default = "default_factor", skip_serializing_if = "is_once")]
    pub corners: f64,
}

fn default_factor() -> f64 {
    1.0
}

// On a target with pointers of 32 bits this lint does not fire.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_once(times: &f64) -> bool {
    *times <= 1.0
}

impl PicturesEntry {
    /// Entry of a session; `None` without pictures.
    pub fn from_dataset(data: &Dataset, images: &[ImageMap]) -> Option<Self> {
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
                corners: pictures.common.corners,
            },
            cameras: pictures.cameras.iter().map(CameraEntry::from_camera).collect(),
            boards: pictures.boards.iter().map(BoardEntry::from_board).collect(),
            found: pictures.found.clone(),
            images: images.to_vec(),
        })
    }
}

impl PicturesEntry {
    /// Adds the calibration's cameras and boards to options that have none.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`](poecal_numerics::error::ErrorKind::Measurement) if a camera is invalid.
    pub fn complete_options(&self, options: &mut ReadOptions) -> Result<()> {
        if options.cameras.is_empty() {
            options.cameras = self.cameras.iter().map(CameraEntry::camera).collect::<Result<_>>()?;
        }
        if options.boards.is_empty() {
            options.boards = self.boards.iter().map(BoardEntry::board).collect();
        }
        Ok(())
    }

    /// Error that all corners of a picture share.
    #[must_use]
    pub fn common_error(&self) -> CommonError {
        let CommonEntry { shift_mm, turn_deg, about, corners } = self.common;
        CommonError { shift_m: 1e-3 * shift_mm, turn_rad: turn_deg.to_radians(), about, corners }
    }

    /// Sentence for pictures that were read with another lens or board than those that the calibration fitted.
    #[must_use]
    pub fn read_otherwise(&self, data: &Dataset) -> Option<String> {
        let has = |kind: &str| self.found.iter().any(|it| it.name.starts_with(kind));
        let (lens, board) = (has("lens."), has("board.") || has("markers."));
        let differs = |a: &f64, b: &f64| (a - b).abs() > 1e-9 * (1.0 + a.abs());
        let other_lens = data.pictures.cameras.iter().map(CameraEntry::from_camera).any(|own| {
            let same = self.cameras.iter().find(|it| it.name == own.name);
            same.is_some_and(|it| {
                let numbers = |it: &CameraEntry| [&it.focal_px[..], &it.centre_px, &it.distortion].concat();
                numbers(it).iter().zip(&numbers(&own)).any(|(a, b)| differs(a, b))
            })
        });
        let other_board = data.pictures.boards.iter().map(BoardEntry::from_board).any(|own| {
            let same = self.boards.iter().find(|it| it.name == own.name);
            same.is_some_and(|it| {
                let places = it.points.iter().flat_map(|it| it.place_mm);
                places.zip(own.points.iter().flat_map(|it| it.place_mm)).any(|(a, b)| differs(&a, &b))
            })
        });
        let mut options = Vec::new();
        if lens && other_lens {
            options.push("--camera");
        }
        if board && other_board {
            options.push("--markers");
        }
        (!options.is_empty()).then(|| {
            format!(
                "these pictures were read with another {} than the calibration found: name its calibration.json by {}",
                if options.len() == 2 {
                    "lens and board"
                } else if lens && other_lens {
                    "lens"
                } else {
                    "board"
                },
                options.join(" and ")
            )
        })
    }
}
