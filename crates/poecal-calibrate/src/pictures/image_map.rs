//! Prediction and remaining error over the image of each camera (theory.md §4, *Pictures*).

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::projection::PixelPrediction;
use crate::Correction;
use crate::run::pixels::seen_pixels;
use crate::steps::calibrated_fit::CalibratedFit;
use crate::steps::figures::Figures;
use poecal_fit::state::RowError;
use poecal_model::camera::Camera;

/// Cells along the longer side of an image, and the unit of the length of a cell's side, pixels.
const ALONG: f64 = 12.0;
const ROUND_PX: f64 = 10.0;

/// Errors of corners over the image of a camera, and the uncertainty of predicted pixels there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "ImageEntry")]
pub struct ImageMap {
    /// The camera.
    pub camera: String,
    /// Side of the square cells, pixels; the first begins at the corner of the first pixel.
    pub cell_px: f64,
    /// Depth of the points whose prediction is judged, millimetres: the median of the boards'.
    pub distance_mm: f64,
    /// The cells, row by row.
    pub cells: Vec<ImageCell>,
}

/// A cell of an image: corners in pictures that are not suspected, fitted or held out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "ImageCellEntry")]
pub struct ImageCell {
    /// Column and row, from 0.
    pub at: [usize; 2],
    /// Number of corners.
    pub corners: usize,
    /// Their root mean square distance from their pixels by the registered model; null without corners.
    pub before_px: Option<f64>,
    /// The same by the delivered model.
    pub after_px: Option<f64>,
    /// Mean of measured minus predicted pixel by that model, along u and v.
    pub mean_px: Option<[f64; 2]>,
    /// Root mean square uncertainty of the predicted pixel of a point before the middle of the cell, by the covariance of robot, camera and board;
    /// null beyond the lens.
    pub predicted_px: Option<f64>,
}

/// Sums of the corners of a cell: number, squares before and after, and errors after.
type CellSums = (usize, [f64; 2], Vector2<f64>);

/// The maps of all cameras whose picture has a known size.
pub(crate) fn image_maps(fit: &CalibratedFit<'_>, figures: &Figures) -> Vec<ImageMap> {
    let cameras = &fit.run.data.pictures.cameras;
    if fit.run.data.pictures.is_empty() {
        return Vec::new();
    }
    let Some(projection) = PixelPrediction::from_fit(fit) else { return Vec::new() };
    let of = |(at, camera): (usize, &Camera)| {
        let map = ImageGrid::from_camera(camera)?;
        map.of_camera((at, camera), fit, (&projection, figures))
    };
    cameras.iter().enumerate().filter_map(of).collect()
}

/// The cells of an image.
struct ImageGrid {
    cell_px: f64,
    size: [usize; 2],
}

impl ImageGrid {
    fn from_camera(camera: &Camera) -> Option<Self> {
        let [width, height] = camera.lens.size_px.filter(|size| !size.contains(&0))?.map(f64::from);
        let cell_px = (width.max(height) / ALONG / ROUND_PX).ceil() * ROUND_PX;
        Some(ImageGrid { cell_px, size: [width, height].map(|it| (it / cell_px).ceil() as usize) })
    }

    fn of_camera(
        &self,
        (at, camera): (usize, &Camera),
        fit: &CalibratedFit<'_>,
        (projection, figures): (&PixelPrediction, &Figures),
    ) -> Option<ImageMap> {
        let distance_m = projection.distance_m(at)?;
        let sums = self.sums(at, fit, figures);
        let [columns, _] = self.size;
        let cell = |(k, (corners, squares, sum)): (usize, CellSums)| {
            let at_cell = [k % columns, k / columns];
            let middle = Vector2::from(at_cell.map(|it| (it as f64 + 0.5) * self.cell_px - 0.5));
            let size = camera.lens.size_px.unwrap_or_default().map(|it| f64::from(it) - 1.0);
            let inside = middle.zip_map(&Vector2::from(size), f64::min);
            let predicted =
                camera.lens.ray(&inside).and_then(|ray| projection.off_px((at, camera), &(ray * (distance_m / ray.z))));
            let count = corners as f64;
            let [before_px, after_px] = squares.map(|it| (corners > 0).then(|| (it / count).sqrt()));
            let mean_px = (corners > 0).then(|| (sum / count).into());
            ImageCell { at: at_cell, corners, before_px, after_px, mean_px, predicted_px: predicted }
        };
        Some(ImageMap {
            camera: camera.name.clone(),
            cell_px: self.cell_px,
            distance_mm: 1e3 * distance_m,
            cells: sums.into_iter().enumerate().map(cell).collect(),
        })
    }

    fn sums(&self, camera: usize, fit: &CalibratedFit<'_>, figures: &Figures) -> Vec<CellSums> {
        let data = &fit.run.data;
        let [columns, rows] = self.size;
        let mut sums = vec![(0, [0.0; 2], Vector2::zeros()); columns * rows];
        let counts = |row: u32| !fit.robust.robustness.suspects_row(row);
        let own = data.pictures.all.iter().filter(|it| it.camera == camera && counts(it.row));
        let own: Vec<u32> = own.map(|it| it.row).collect();
        let session = fit.session();
        let before = session.errors(&own, &figures.models.registered);
        let delivered = figures.correction.as_ref().filter(|it: &&Correction| it.has_terms());
        let after: Vec<RowError> = match delivered {
            Some(found) => found.errors(data, &own),
            None => session.errors(&own, &figures.models.calibrated),
        };
        for (row, (before, after)) in own.iter().zip(before.iter().zip(&after)) {
            let (Some(before), Some(after)) = (seen_pixels(data, *row, before), seen_pixels(data, *row, after)) else {
                continue;
            };
            for ((pixel, was), (_, is)) in before.into_iter().zip(after) {
                let (Some(was), Some(is)) = (was, is) else { continue };
                let [column, line] = [pixel.x, pixel.y].map(|it| ((it + 0.5) / self.cell_px).floor().max(0.0) as usize);
                let Some(sum) = sums.get_mut(line.min(rows - 1) * columns + column.min(columns - 1)) else {
                    continue;
                };
                sum.0 += 1;
                sum.1[0] += was.norm_squared();
                sum.1[1] += is.norm_squared();
                sum.2 += is;
            }
        }
        sums
    }
}
