//! Errors of corners in pictures.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use nalgebra::Vector2;

use poecal_arm::lie::Pose;
use poecal_fit::start::predicted_pose;
use poecal_fit::state::RowError;
use poecal_model::camera::{Corner, Picture};
use poecal_model::measurement::Dataset;
use poecal_numerics::distributions::median;

/// Distances of corners from their prediction by a model: in the picture, and at the board, perpendicular to the ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PixelAccuracy {
    /// Number of pictures.
    pub pictures: usize,
    /// Number of corners.
    pub corners: usize,
    /// Corners behind the camera or beyond its lens by the model; no statistic includes them.
    #[serde(default, skip_serializing_if = "is_none")]
    pub unseen: usize,
    /// Mean over the corners, pixels.
    pub mean_px: f64,
    /// Median over the corners, pixels.
    pub median_px: f64,
    /// Root mean square over the corners, pixels.
    pub rms_px: f64,
    /// Largest, pixels.
    pub max_px: f64,
    /// Median over the pictures of the root mean square of each, pixels.
    pub median_picture_px: f64,
    /// Root mean square over the corners at the board, perpendicular to the ray, millimetres.
    pub rms_mm: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_none(count: &usize) -> bool {
    *count == 0
}

/// Errors of the pictures among some rows by the errors of these rows; `None` without a visible corner.
pub(crate) fn pixel_accuracy(data: &Dataset, rows: &[u32], errors: &[RowError]) -> Option<PixelAccuracy> {
    if data.pictures.is_empty() {
        return None;
    }
    let (mut lengths, mut across, mut of_pictures) = (Vec::new(), 0.0, Vec::new());
    let mut unseen = 0;
    for (row, error) in rows.iter().zip(errors) {
        let Some((all, own)) = seen_corners(data, *row, error) else { continue };
        unseen += all - own.len();
        let Some(picture) = CornerError::from_corners(&own) else { continue };
        of_pictures.push(picture.rms_px);
        across += own.iter().map(|(_, m)| m * m).sum::<f64>();
        lengths.extend(own.iter().map(|(px, _)| *px));
    }
    let count = lengths.len() as f64;
    Some(PixelAccuracy {
        pictures: of_pictures.len(),
        corners: lengths.len(),
        unseen,
        mean_px: lengths.iter().sum::<f64>() / count,
        median_px: median(lengths.iter().copied())?,
        rms_px: (lengths.iter().map(|px| px * px).sum::<f64>() / count).sqrt(),
        max_px: lengths.iter().copied().fold(0.0, f64::max),
        median_picture_px: median(of_pictures.iter().copied())?,
        rms_mm: 1e3 * (across / count).sqrt(),
    })
}

/// Root mean square distance of the corners of one picture from their prediction by a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerError {
    /// In the picture, pixels.
    pub rms_px: f64,
    /// At the board, perpendicular to the ray, millimetres.
    pub rms_mm: f64,
}

impl CornerError {
    fn from_corners(corners: &[(f64, f64)]) -> Option<Self> {
        let mean = |of: fn(&(f64, f64)) -> f64| corners.iter().map(of).sum::<f64>() / corners.len() as f64;
        let [px, m] = [mean(|it| it.0 * it.0), mean(|it| it.1 * it.1)].map(f64::sqrt);
        (!corners.is_empty()).then_some(CornerError { rms_px: px, rms_mm: 1e3 * m })
    }
}

/// Error of the corners of a row by the error of the row; `None` if the row is not a picture, or the model sees none of its corners.
pub fn corner_error(data: &Dataset, row: u32, error: &RowError) -> Option<CornerError> {
    CornerError::from_corners(&seen_corners(data, row, error)?.1)
}

/// Picture of a row with the pose of its board in the camera's frame as the model predicts it, by the error of the row; `None` if the row is not a
/// picture.
pub(crate) fn predicted_picture<'a>(data: &'a Dataset, row: u32, error: &RowError) -> Option<(&'a Picture, Pose)> {
    let picture = data.pictures.all.get(data.pictures.index_of_row(row)?)?;
    let measured = data.observations.get(row as usize)?.measurement.pose();
    Some((picture, picture.directed_measurement(&predicted_pose(&measured, error))))
}

/// Number of the corners of a row, and the errors of those that the model sees; `None` if the row is not a picture.
fn seen_corners(data: &Dataset, row: u32, error: &RowError) -> Option<(usize, Vec<(f64, f64)>)> {
    let (picture, pose) = predicted_picture(data, row, error)?;
    Some((picture.corners.len(), corners(data, picture, &pose)))
}

/// Pixel of a corner, and its deviation from the model's prediction; `None` if the model does not see it.
pub(crate) type PixelError = (Vector2<f64>, Option<Vector2<f64>>);

/// Pixel of each corner of a row that has weight, and its deviation by the error of the row, if it is visible; `None` if the row is not a picture.
pub(crate) fn seen_pixels(data: &Dataset, row: u32, error: &RowError) -> Option<Vec<PixelError>> {
    let (picture, pose) = predicted_picture(data, row, error)?;
    let errors = data.pictures.view(picture)?.errors(&pose);
    let own = picture.corners.iter().zip(errors).filter(|(corner, _)| corner.weight > 0.0);
    Some(own.map(|(corner, error)| (corner.pixel, error)).collect())
}

/// Deviation of each corner that the camera sees with a pose of the board: pixels, and metres at its depth.
fn corners(data: &Dataset, picture: &Picture, pose: &Pose) -> Vec<(f64, f64)> {
    let Some(view) = data.pictures.view(picture) else { return Vec::new() };
    let of = |(corner, error): (&Corner, Option<Vector2<f64>>)| {
        let depth = pose.act(view.board.points.get(corner.point as usize)?).z;
        let [fx, fy] = view.lens.focal_px;
        let error = error?;
        let across = (error.x / fx).hypot(error.y / fy) * depth;
        Some((error.norm(), across))
    };
    picture.corners.iter().zip(view.errors(pose)).filter_map(of).collect()
}
