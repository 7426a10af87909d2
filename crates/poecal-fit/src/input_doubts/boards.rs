//! Corners that no pose of their board explains.

use poecal_model::camera::Pictures;
use poecal_model::measurement::Dataset;
use poecal_numerics::distributions::median;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Share of the focal length that the corners of a correct board never deviate by.
const OFF: f64 = 5e-3;
/// Factor by which another order of the corners must be better, to be named.
const BETTER: f64 = 5.0;
/// Largest number of pictures that are evaluated.
const SOME: usize = 8;

/// Refuses pictures whose corners are far from their predicted positions for any pose of the board, and names exchanged columns and rows of
/// the board.
pub fn refuse_wrong_boards(data: &Dataset) -> Result<()> {
    let pictures = &data.pictures;
    for (at, board) in pictures.boards.iter().enumerate() {
        let Some((off, focal)) = off_px(pictures, at).filter(|(off, focal)| *off > OFF * focal) else {
            continue;
        };
        let other = board.transposed().and_then(|board| {
            let mut other = pictures.clone();
            *other.boards.get_mut(at)? = board;
            let (found, _) = off_px(&other, at)?;
            (BETTER * found < off).then_some(found)
        });
        let advice = match other {
            Some(found) => format!(
                "with its columns and rows exchanged they are off by {found:.2} px: exchange the two numbers of its squares"
            ),
            None => {
                "check the names or the order of the corners, the points of the board, and the focal length".to_owned()
            }
        };
        let message = format!(
            "found corners of board `{}` that are off by {off:.1} px in its best poses, expected less than {:.1} px: {advice}",
            board.name,
            OFF * focal
        );
        return Err(Error::new(ErrorKind::Measurement, message));
    }
    Ok(())
}

/// Median over some pictures of a board of the root mean square residual of its corners in the best pose, with the focal length, pixels.
fn off_px(pictures: &Pictures, board: usize) -> Option<(f64, f64)> {
    let own: Vec<_> = pictures.all.iter().filter(|picture| picture.board == board).collect();
    let some = own.iter().step_by(own.len().div_ceil(SOME).max(1));
    let found: Vec<(f64, f64)> = some
        .filter_map(|picture| {
            let view = pictures.view(picture)?;
            let of = |pose| view.sighting(&pose, false);
            let sightings = view.poses().ok()?.into_iter().filter_map(of);
            let best = sightings.map(|it| it.cost_px2).min_by(f64::total_cmp)?;
            Some(((best / picture.corners.len() as f64).sqrt(), view.lens.focal()))
        })
        .collect();
    let off = median(found.iter().map(|(off, _)| *off))?;
    Some((off, median(found.iter().map(|(_, focal)| *focal))?))
}
