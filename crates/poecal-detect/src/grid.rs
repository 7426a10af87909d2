//! Grids of corners by the crate `calib-targets-chessboard`.

use calib_targets_chessboard::{
    ChessboardDetector, ChessboardParams, GrayImageView, default_chess_config, detect_corners,
};
use nalgebra::{Matrix2, Vector2};

use crate::gray::Gray;
use crate::growth::Node;

/// Corners of one grid, each with its column and row.
pub(crate) type Grid = Vec<(Node, Vector2<f64>)>;

/// Grids of squares in a picture, the largest first: x and y as on a board that is seen from its front.
pub(crate) fn grids(gray: &Gray) -> Vec<Grid> {
    let bytes = gray.bytes();
    let view = GrayImageView { width: gray.width(), height: gray.height(), data: &bytes };
    let corners = detect_corners(&view, &default_chess_config());
    let Ok(detector) = ChessboardDetector::new(ChessboardParams::default()) else { return Vec::new() };
    let node = |it: &calib_targets_chessboard::ChessboardCorner| {
        let place = Vector2::new(f64::from(it.position.x), f64::from(it.position.y));
        ([it.grid.u, it.grid.v], place)
    };
    let all = detector.detect_all(&corners);
    let mut grids: Vec<Grid> = all.iter().map(|it| it.corners.iter().map(node).collect()).collect();
    grids.sort_by_key(|grid| std::cmp::Reverse(grid.len()));
    for grid in &mut grids {
        if middle_slope(grid).is_some_and(|slope| slope.determinant() < 0.0) {
            grid.iter_mut().for_each(|(node, _)| node.swap(0, 1));
        }
    }
    grids
}

/// The affine map of a whole grid, pixels a square.
pub(crate) fn middle_slope(grid: &Grid) -> Option<Matrix2<f64>> {
    let count = grid.len() as f64;
    let at = |node: Node| Vector2::new(f64::from(node[0]), f64::from(node[1]));
    let plane = grid.iter().map(|it| at(it.0)).sum::<Vector2<f64>>() / count;
    let picture = grid.iter().map(|it| it.1).sum::<Vector2<f64>>() / count;
    let (mut spread, mut both) = (Matrix2::zeros(), Matrix2::zeros());
    for (node, place) in grid {
        let off = at(*node) - plane;
        spread += off * off.transpose();
        both += (place - picture) * off.transpose();
    }
    Some(both * spread.try_inverse()?)
}
