//! A lens from pictures of a flat board alone: a start for its fit (theory.md §4, *Pictures*).

use nalgebra::{DVector, Matrix3, Vector2, Vector3};

use super::Lens;
use poecal_numerics::linalg;

/// Fewest corners of a picture that counts.
const FEWEST: usize = 6;
/// Least share of the tilt of a homography that is no noise: below, all boards are parallel to the image.
const TILTED: f64 = 1e-3;

/// Mean distance of corners from those of a pinhole, as a share of the picture, beyond which they are of another board: no lens bends so much.
const BENT: f64 = 0.02;

/// Corners of a flat board in one picture: positions on the board (m), and pixels.
pub type FlatView = (Vec<Vector2<f64>>, Vec<Vector2<f64>>);

/// A pinhole of one focal length whose axis meets the middle of the picture, from pictures of flat boards (zhang2000, with the centre known). The
/// columns h1, h2 of each homography are pixels of two perpendicular directions of equal length, so `h1ᵀωh2 = 0` and `h1ᵀωh1 = h2ᵀωh2` with `ω =
/// diag(1/f², 1/f², 1)`.
///
/// # Errors
/// A message, if no picture has enough corners, or no board is tilted.
pub fn guessed_lens([width, height]: [u32; 2], views: &[FlatView]) -> Result<Lens, String> {
    let centre = Vector2::new(0.5 * f64::from(width) - 0.5, 0.5 * f64::from(height) - 0.5);
    let size = f64::from(width.max(height));
    let homographies: Vec<Matrix3<f64>> =
        views.iter().filter_map(|(board, pixels)| homography(board, pixels, (centre, size))).collect();
    if homographies.is_empty() {
        return Err(format!(
            "found no picture whose corners are {FEWEST} or more of a flat board like the stated one, from which an unknown lens could be found: check \
             --markers"
        ));
    }
    let (mut squares, mut products, mut depth) = (0.0, 0.0, 0.0);
    for h in &homographies {
        let (a, b) = (h.column(0), h.column(1));
        let scale = 1.0 / (a.norm() * b.norm());
        let flat = a.xy().dot(&b.xy()) * scale;
        let difference = (a.xy().norm_squared() - b.xy().norm_squared()) * scale;
        let (deep, deeper) = (a.z * b.z * scale, (a.z * a.z - b.z * b.z) * scale);
        // The second equation is of twice the size.
        for (flat, deep) in [(flat, deep), (0.5 * difference, 0.5 * deeper)] {
            squares += deep * deep;
            products -= flat * deep;
            depth += flat * flat;
        }
    }
    // `flat + f² deep = 0` in units of the picture's size.
    let square = products / squares.max(f64::MIN_POSITIVE);
    let is_tilted = depth > TILTED * TILTED * homographies.len() as f64;
    if !(is_tilted && square > 0.0 && square.is_finite()) {
        return Err(
            "found boards that are parallel to the image in all pictures, from which no focal length follows: tilt the board by 20 to 45 degrees"
                .to_owned(),
        );
    }
    let focal = square.sqrt() * size;
    Ok(Lens { size_px: Some([width, height]), ..Lens::pinhole([focal, focal], [centre.x, centre.y]) })
}

/// Homography from positions on a board to pixels from the centre of the picture in units of its size, by the direct linear transformation.
fn homography(
    board: &[Vector2<f64>],
    pixels: &[Vector2<f64>],
    (centre, size): (Vector2<f64>, f64),
) -> Option<Matrix3<f64>> {
    if board.len() < FEWEST || board.len() != pixels.len() {
        return None;
    }
    // The units are about 1; without them rounding decides.
    let middle = board.iter().sum::<Vector2<f64>>() / board.len() as f64;
    let radius = board.iter().map(|it| (it - middle).norm()).fold(0.0, f64::max);
    let mut gram = vec![0.0; 81];
    for (place, pixel) in board.iter().zip(pixels) {
        let (at, seen) = ((place - middle) / radius, (pixel - centre) / size);
        let rows = [
            [at.x, at.y, 1.0, 0.0, 0.0, 0.0, -seen.x * at.x, -seen.x * at.y, -seen.x],
            [0.0, 0.0, 0.0, at.x, at.y, 1.0, -seen.y * at.x, -seen.y * at.y, -seen.y],
        ];
        for row in rows {
            for (i, a) in row.iter().enumerate() {
                row.iter().enumerate().for_each(|(j, b)| gram[9 * i + j] += a * b);
            }
        }
    }
    let (_, vectors) = linalg::symmetric_eigen(&gram, 9);
    let least = DVector::from_iterator(9, (0..9).map(|k| vectors[(k, 0)]));
    let found = Matrix3::from_row_slice(least.as_slice());
    let miss = |(place, pixel): (&Vector2<f64>, &Vector2<f64>)| {
        let at = (place - middle) / radius;
        let seen = found * Vector3::new(at.x, at.y, 1.0);
        (seen.xy() / seen.z - (pixel - centre) / size).norm()
    };
    let missed = board.iter().zip(pixels).map(miss).sum::<f64>() / board.len() as f64;
    (missed < BENT).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Board, Distortion};
    use poecal_arm::lie::Pose;

    #[test]
    fn a_lens_is_found_from_tilted_boards_and_refused_of_parallel_ones() {
        let board = Board::chessboard("board", [7, 5], 0.036).unwrap();
        let lens = Lens {
            distortion: Distortion::Brown([-0.1, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            ..Lens::pinhole([1510.0, 1490.0], [975.0, 590.0])
        };
        let view = |turn: [f64; 3]| {
            let pose = Pose::from_xyz_rpy([-0.1, -0.05, 0.7], turn);
            let pixels = board.points.iter().map(|it| lens.pixel(&pose.act(it)).unwrap()).collect();
            (board.points.iter().map(|it| it.xy()).collect(), pixels)
        };
        let tilted: Vec<FlatView> =
            [[0.6, 0.1, 0.0], [-0.5, 0.4, 0.7], [0.2, -0.6, 1.5], [0.4, 0.5, -0.4]].map(view).into();
        let found = guessed_lens([1920, 1200], &tilted).unwrap();
        println!("focal length {:.0} px of 1500, with a distortion of -0.1 and a centre 15 px off", found.focal());
        // The guess is a start: the assumptions on distortion and centre cost some percent of the focal length.
        assert!((found.focal() / 1500.0 - 1.0).abs() < 0.1);
        let parallel: Vec<FlatView> = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(view).into();
        let pinhole = Lens::pinhole([1500.0; 2], [959.5, 599.5]);
        let exact = parallel.iter().map(|(places, _)| {
            let pose = Pose::from_xyz_rpy([-0.1, -0.05, 0.7], [0.0; 3]);
            let pixels = board.points.iter().map(|it| pinhole.pixel(&pose.act(it)).unwrap()).collect();
            (places.clone(), pixels)
        });
        let exact: Vec<FlatView> = exact.collect();
        assert!(guessed_lens([1920, 1200], &exact).unwrap_err().contains("parallel"));
    }
}
