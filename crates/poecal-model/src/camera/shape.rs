//! Shape of a flat board: its scales along x and y, and its bend.

use nalgebra::{Matrix3x4, Vector3};

use super::board::{Board, dimensions, middle};

/// Middle and half sides of a board in its plane.
pub(crate) struct BoardExtent {
    middle: Vector3<f64>,
    pub(crate) half_m: [f64; 2],
}

impl BoardExtent {
    pub(crate) fn from_board(board: &Board) -> Self {
        let middle = middle(&board.points);
        let half = |axis: usize| {
            board.points.iter().map(|it| (it[axis] - middle[axis]).abs()).fold(f64::MIN_POSITIVE, f64::max)
        };
        BoardExtent { middle, half_m: [half(0), half(1)] }
    }

    /// Height of a parabola of sagitta 1 through the ends of the board at a point, along x and y.
    fn heights(&self, point: &Vector3<f64>) -> [f64; 2] {
        [0, 1].map(|axis| 1.0 - ((point[axis] - self.middle[axis]) / self.half_m[axis]).powi(2))
    }

    /// A point with changes of scale (shares) and sagittas of the bend (m) along x and y.
    pub(crate) fn bend_point(&self, point: &Vector3<f64>, [x, y, bend_x, bend_y]: [f64; 4]) -> Vector3<f64> {
        let off = point - self.middle;
        let [along_x, along_y] = self.heights(point);
        let rise = bend_x * along_x + bend_y * along_y;
        self.middle + Vector3::new(off.x * (1.0 + x), off.y * (1.0 + y), off.z + rise)
    }

    pub(crate) fn by_numbers(&self, point: &Vector3<f64>) -> Matrix3x4<f64> {
        let off = point - self.middle;
        let [along_x, along_y] = self.heights(point);
        let mut by = Matrix3x4::zeros();
        (by[(0, 0)], by[(1, 1)], by[(2, 2)], by[(2, 3)]) = (off.x, off.y, along_x, along_y);
        by
    }
}

/// True if a board is flat in the plane of its x and y: its scales and its bend are along these.
#[must_use]
pub fn is_flat_sheet(board: &Board) -> bool {
    let z = board.points.first().map_or(0.0, |it| it.z);
    dimensions(&board.points) == 2 && board.points.iter().all(|it| (it.z - z).abs() < 1e-6)
}
