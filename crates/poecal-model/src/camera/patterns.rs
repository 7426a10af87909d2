//! Points of printed patterns, with the names that `poecal detect` uses.

use nalgebra::Vector3;

use super::Board;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Largest number of squares, dots or tags along a side: 250 of 4 mm make a metre.
const MOST: usize = 250;
/// Corners of a tag from its middle, in halves of its side, y upwards: upper left, upper right, lower right, lower left.
const AROUND: [[f64; 2]; 4] = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];

fn check_counts(what: &str, [columns, rows]: [usize; 2], least: usize) -> Result<()> {
    if [columns, rows].iter().all(|it| (least..=MOST).contains(it)) {
        return Ok(());
    }
    let message = format!("found a board of {columns} × {rows} {what}, expected {least} to {MOST} along each side");
    Err(Error::new(ErrorKind::Option, message))
}

fn check_length(what: &str, length_m: f64) -> Result<()> {
    if length_m > 0.0 && length_m.is_finite() {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Option, format!("found {what} of {length_m:?} m, expected a length above 0")))
}

impl Board {
    /// A chessboard with these numbers of squares along x and y: its inner corners `corner0`, `corner1`, … along x first, in metres from
    /// the first one.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if it has fewer than two corners along a side, or its squares have no size.
    pub fn chessboard(name: &str, [columns, rows]: [usize; 2], square_m: f64) -> Result<Self> {
        check_counts("squares", [columns, rows], 3)?;
        check_length("squares", square_m)?;
        let places = (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| [column, row]));
        Ok(grid(name, "corner", places, square_m))
    }

    /// A grid of dots in rows, with the numbers of columns and rows as OpenCV counts them. Its centres are `dot0`, `dot1`, … row by row, in metres
    /// from the first one, with `pitch_m` from row to row. Dot `j` of row `i` is at `(j, i)` pitches, in an asymmetric grid at `(2 j + i mod 2, i)`.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if it has fewer than three dots along a side (two of an asymmetric one), or no size.
    pub fn circles(name: &str, [columns, rows]: [usize; 2], pitch_m: f64, is_asymmetric: bool) -> Result<Self> {
        check_counts("dots", [columns, rows], if is_asymmetric { 2 } else { 3 })?;
        check_length("a pitch", pitch_m)?;
        let along = move |column: usize, row: usize| if is_asymmetric { 2 * column + row % 2 } else { column };
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| [along(column, row), row]));
        Ok(grid(name, "dot", places, pitch_m))
    }

    /// Kalibr's grid of tags in rows, with the numbers of columns and rows. Tag 0 is at the lower left, and its lower left corner is the origin,
    /// with x to the right and y upwards, metres. Tags have a side of `size_m` and a gap of `spacing` times it. The corners of tag 7 are `tag7.0`,
    /// `tag7.1`, `tag7.2` and `tag7.3` on the upright board: upper left, upper right, lower right, lower left.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if it has no tags, or no size.
    pub fn april_grid(name: &str, [columns, rows]: [usize; 2], size_m: f64, spacing: f64) -> Result<Self> {
        check_counts("tags", [columns, rows], 1)?;
        check_length("tags", size_m)?;
        if !(spacing > 0.0 && spacing <= 1.0) {
            let message = format!(
                "found {spacing:?} for the spacing of tags, expected a part of their side, above 0 and at most 1"
            );
            return Err(Error::new(ErrorKind::Option, message));
        }
        let all = (0..columns * rows).flat_map(|tag| (0..4).map(move |corner| (tag, corner)));
        let point = |(tag, corner): (usize, usize)| {
            let first = [tag % columns, tag / columns].map(|it| it as f64 * (1.0 + spacing));
            let [x, y] = [0, 1].map(|axis| first[axis] + 0.5 * (AROUND[corner][axis] + 1.0));
            (format!("tag{tag}.{corner}"), Vector3::new(x * size_m, y * size_m, 0.0))
        };
        let (names, points) = all.map(point).unzip();
        Ok(Board { name: name.to_owned(), names, points })
    }

    /// A single tag: its corners `0` to `3` (upper left, upper right, lower right and lower left of the printed tag), metres from its middle, with x
    /// to the right and y upwards.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if it has no size.
    pub fn tag(name: &str, size_m: f64) -> Result<Self> {
        check_length("a tag", size_m)?;
        let points = AROUND.map(|[x, y]| Vector3::new(0.5 * x * size_m, 0.5 * y * size_m, 0.0)).to_vec();
        let names = (0..points.len()).map(|at| at.to_string()).collect();
        Ok(Board { name: name.to_owned(), names, points })
    }
}

/// Numbered points at columns and rows.
fn grid(name: &str, kind: &str, places: impl Iterator<Item = [usize; 2]>, pitch_m: f64) -> Board {
    let points: Vec<Vector3<f64>> =
        places.map(|[x, y]| Vector3::new(x as f64 * pitch_m, y as f64 * pitch_m, 0.0)).collect();
    let names = (0..points.len()).map(|at| format!("{kind}{at}")).collect();
    Board { name: name.to_owned(), names, points }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point_at(board: &Board, name: &str) -> [f64; 2] {
        let point = board.points[board.find(name).unwrap()];
        [point.x, point.y].map(|it| (it * 1e6).round() / 1e6)
    }

    #[test]
    fn points_are_where_opencv_and_kalibr_have_them() {
        let circles = Board::circles("board", [4, 11], 0.02, true).unwrap();
        assert_eq!(
            (circles.names.len(), point_at(&circles, "dot5"), point_at(&circles, "dot8")),
            (44, [0.06, 0.02], [0.0, 0.04])
        );
        assert_eq!(point_at(&Board::circles("board", [5, 4], 0.01, false).unwrap(), "dot6"), [0.01, 0.01]);
        let grid = Board::april_grid("board", [6, 5], 0.088, 0.3).unwrap();
        assert_eq!((grid.names.len(), point_at(&grid, "tag0.3")), (120, [0.0, 0.0]));
        // One pitch of 1.3 tags, and a tag: to rounding.
        assert!(point_at(&grid, "tag7.1").iter().all(|it| (it - 2.3 * 0.088).abs() < 1e-15));
        assert_eq!(point_at(&Board::tag("tag3", 0.05).unwrap(), "0"), [-0.025, 0.025]);
    }

    #[test]
    fn boards_of_no_size_are_refused() {
        for refused in [
            Board::circles("board", [2, 4], 0.02, false),
            Board::circles("board", [4, 4], 0.0, false),
            Board::april_grid("board", [0, 4], 0.02, 0.3),
            Board::april_grid("board", [3, 4], 0.02, f64::NAN),
            Board::tag("board", f64::INFINITY),
        ] {
            assert!(refused.unwrap_err().to_string().contains("expected"));
        }
    }
}
