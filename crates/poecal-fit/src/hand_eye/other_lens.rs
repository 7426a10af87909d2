//! Corners of single pictures that a lens other than the stated one explains much better.

use nalgebra::DMatrix;

use poecal_model::camera::{LensSearch, LensState, OTHER_LENS, Pictures, changed_numbers};
use poecal_numerics::linalg;

/// Fewest pictures, and corners in them, that determine a lens.
const FEWEST: usize = 5;
const FEWEST_CORNERS: usize = 100;
/// Number of standard deviations beyond which a number differs from the stated one.
const FAR: f64 = 5.0;

/// Doubt about the stated lens, with a remedy, if the pictures by themselves contradict it. `None` if they do not, or if they are too few.
pub(crate) fn other_lens(pictures: &Pictures) -> Option<String> {
    let corners: usize = pictures.all.iter().map(|it| it.corners.len()).sum();
    if pictures.all.len() < FEWEST || corners < FEWEST_CORNERS {
        return None;
    }
    let (search, start) = LensSearch::from_pictures(pictures)?;
    let before = off_px(pictures, &start)?;
    let found = search.lens_alone(&start)?;
    let after = off_px(&found.pictures, &found)?;
    if before <= OTHER_LENS * after {
        return None;
    }
    let count = found.step.len();
    let factor = linalg::cholesky(found.information.as_slice(), count, 0.0)?;
    let covariance = DMatrix::from_row_slice(count, count, &linalg::inverse(&factor));
    let deviations: Vec<f64> = covariance.diagonal().iter().map(|it| it.max(0.0).sqrt()).collect();
    let numbers: Vec<_> =
        search.numbers(&found, &deviations).into_iter().filter(|it| it.name.starts_with("lens.")).collect();
    let size = pictures.all.first().and_then(|it| pictures.cameras.get(it.camera)?.lens.size_px);
    let size = size.map_or("WIDTHxHEIGHT".to_owned(), |[width, height]| format!("{width}x{height}"));
    Some(format!(
        "the corners are reprojected with an RMS error of {before:.2} px by the best pose of their picture, of {after:.2} px with another lens ({}): state the lens of these pictures, or \
         find it with --lens unknown:{size}",
        changed_numbers(&numbers, FAR)
    ))
}

/// Root mean square residual of corner coordinates about the best pose of each picture, pixels.
fn off_px(pictures: &Pictures, state: &LensState) -> Option<f64> {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for (picture, pose) in pictures.all.iter().zip(&state.poses) {
        let sighting = pictures.view(picture)?.sighting(pose, true)?;
        (squares, freedom) = (squares + sighting.cost_px2, freedom + sighting.freedom);
    }
    (freedom > 0.0).then(|| (squares / freedom).sqrt())
}
