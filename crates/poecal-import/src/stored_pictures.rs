//! The pictures of a session in `calibration.json`, and its cameras and boards as input of another session.

use std::path::Path;

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ReadOptions;
use crate::pictures::lens_checks::size_of_pictures;
use poecal_calibrate::ImageMap;
use poecal_model::camera::{Board, Camera, Centre, CommonError, Distortion, Lens, PictureNumber};
use poecal_model::measurement::Dataset;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::text_of;

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
    /// The boards.
    #[serde(default)]
    pub boards: Vec<BoardEntry>,
    /// Numbers of cameras and boards that were found with the robot (`--free lens`, `board`, `markers`), with what is above; absent if all were
    /// given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub found: Vec<PictureNumber>,
    /// Errors of corners over the image of each camera whose picture has a known size.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub images: Vec<ImageMap>,
}

/// A body of known points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoardEntry {
    /// Its name.
    pub name: String,
    /// Its points.
    pub points: Vec<PointEntry>,
}

/// A point of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointEntry {
    /// Its name.
    pub name: String,
    /// Its place in the frame of the body, millimetres.
    pub place_mm: [f64; 3],
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
    /// By how many times more than by their own noise the corners move the pose of the board, as in the picture of another lens or board; 1 where it
    /// is absent.
    #[serde(default = "once", skip_serializing_if = "is_once")]
    pub corners: f64,
}

fn once() -> f64 {
    1.0
}

// Where a pointer has 32 bits, the lint has nothing to say.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_once(times: &f64) -> bool {
    *times <= 1.0
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
    pub fn of(data: &Dataset, images: &[ImageMap]) -> Option<Self> {
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
            cameras: pictures.cameras.iter().map(CameraEntry::of).collect(),
            boards: pictures.boards.iter().map(BoardEntry::of).collect(),
            found: pictures.found.clone(),
            images: images.to_vec(),
        })
    }
}

impl PicturesEntry {
    /// Cameras and boards of the calibration for pictures that are read with none.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if a camera is none.
    pub fn complete(&self, options: &mut ReadOptions) -> Result<()> {
        if options.cameras.is_empty() {
            options.cameras =
                self.known_cameras().map_err(|found| Error::new(ErrorKind::Measurement, found))?;
        }
        if options.boards.is_empty() {
            options.boards = self.boards.iter().map(BoardEntry::board).collect();
        }
        Ok(())
    }

    fn known_cameras(&self) -> std::result::Result<Vec<Camera>, String> {
        self.cameras.iter().map(CameraEntry::camera).collect()
    }

    /// What the corners of a picture share.
    #[must_use]
    pub fn common_error(&self) -> CommonError {
        let CommonEntry { shift_mm, turn_deg, about, corners } = self.common;
        CommonError { shift_m: 1e-3 * shift_mm, turn_rad: turn_deg.to_radians(), about, corners }
    }

    /// What to say where pictures were read with another lens or board than those that the calibration found.
    #[must_use]
    pub fn read_otherwise(&self, data: &Dataset) -> Option<String> {
        let has = |kind: &str| self.found.iter().any(|it| it.name.starts_with(kind));
        let (lens, board) = (has("lens."), has("board.") || has("markers."));
        let differs = |a: &f64, b: &f64| (a - b).abs() > 1e-9 * (1.0 + a.abs());
        let other_lens = data.pictures.cameras.iter().map(CameraEntry::of).any(|own| {
            let same = self.cameras.iter().find(|it| it.name == own.name);
            same.is_some_and(|it| {
                let numbers = |it: &CameraEntry| [&it.focal_px[..], &it.centre_px, &it.distortion].concat();
                numbers(it).iter().zip(&numbers(&own)).any(|(a, b)| differs(a, b))
            })
        });
        let other_board = data.pictures.boards.iter().map(BoardEntry::of).any(|own| {
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
                if options.len() == 2 { "lens and board" } else if lens && other_lens { "lens" } else { "board" },
                options.join(" and ")
            )
        })
    }
}

impl BoardEntry {
    fn of(board: &Board) -> Self {
        let point = |(name, point): (&String, &Vector3<f64>)| PointEntry {
            name: name.clone(),
            place_mm: [0, 1, 2].map(|axis| 1e3 * point[axis]),
        };
        BoardEntry {
            name: board.name.clone(),
            points: board.names.iter().zip(&board.points).map(point).collect(),
        }
    }

    fn board(&self) -> Board {
        let place = |point: &PointEntry| Vector3::from(point.place_mm) * 1e-3;
        Board {
            name: self.name.clone(),
            names: self.points.iter().map(|it| it.name.clone()).collect(),
            points: self.points.iter().map(place).collect(),
        }
    }
}

/// What a `calibration.json` holds of its pictures.
#[derive(Deserialize)]
struct Stored {
    pictures: Option<PicturesEntry>,
}

/// The pictures of a `calibration.json`.
fn stored(path: &Path) -> Result<PicturesEntry> {
    let refuse = |message: String| Error::new(ErrorKind::Measurement, message).in_file(path);
    let text = text_of(path, "a calibration.json with pictures")?;
    let stored: Stored = serde_json::from_str(&text).map_err(|error| {
        refuse(format!("found no calibration.json ({error}), expected one with pictures"))
    })?;
    let expected = "found a calibration without pictures, expected one of a session with a camera";
    stored.pictures.ok_or_else(|| refuse(expected.to_owned()))
}

/// The cameras of a `calibration.json`, with their lenses as they were found.
///
/// # Errors
/// A file that is none, or has no cameras.
pub(crate) fn stored_cameras(path: &Path) -> Result<Vec<Camera>> {
    let refuse = |message: String| Error::new(ErrorKind::Measurement, message).in_file(path);
    stored(path)?.known_cameras().map_err(refuse)
}

/// The boards of a `calibration.json`, as they were found.
///
/// # Errors
/// A file that is none, or has no boards.
pub(crate) fn stored_boards(path: &Path) -> Result<Vec<Board>> {
    let boards: Vec<Board> = stored(path)?.boards.iter().map(BoardEntry::board).collect();
    if boards.is_empty() {
        let message = "found a calibration.json without boards, expected one that this version wrote";
        return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
    }
    Ok(boards)
}

impl CameraEntry {
    fn camera(&self) -> std::result::Result<Camera, String> {
        let own = &self.distortion;
        let distortion = match self.model.as_str() {
            "brown" => <[f64; 8]>::try_from(own.as_slice()).ok().map(Distortion::Brown),
            "fisheye" => <[f64; 4]>::try_from(own.as_slice()).ok().map(Distortion::Fisheye),
            _ => None,
        };
        let distortion = distortion.ok_or_else(|| {
            let (count, model) = (own.len(), &self.model);
            format!("found {count} coefficients of a distortion `{model}`, expected 8 of `brown` or 4 of `fisheye`")
        })?;
        let CameraEntry { focal_px, centre_px, size_px, .. } = *self;
        let size = size_of_pictures(size_px.map_or([None; 2], |it| it.map(|side| Some(f64::from(side)))));
        size.map_err(|error| error.message().to_owned())?;
        Ok(Camera::new(self.name.clone(), Lens { focal_px, centre_px, distortion, size_px }))
    }

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
