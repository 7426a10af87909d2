//! Where corners, squares and markers of a board are.

use nalgebra::Vector2;

use crate::dictionary::Dictionary;
use crate::spec::{Charuco, Spec};

/// The geometry of a board, in squares: x to the right, y downwards, from the outer corner of the first square.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Squares along x and y.
    pub squares: [usize; 2],
    /// Side of a square, metres.
    pub square_m: f64,
    /// The markers: their dictionary, and their side as a part of a square's.
    pub markers: Option<(Dictionary, f64)>,
    /// Whether the first square is dark.
    pub first_dark: bool,
}

impl Layout {
    /// The geometry of a board.
    #[must_use]
    pub fn new(spec: &Spec) -> Self {
        let (squares, square_m) = (spec.squares(), spec.square_m());
        match spec {
            Spec::Chessboard(_) => Layout { squares, square_m, markers: None, first_dark: true },
            Spec::Charuco(Charuco { marker_m, dictionary, legacy, rows, .. }) => Layout {
                squares,
                square_m,
                markers: Some((dictionary.clone(), marker_m / square_m)),
                // The old pattern counts its squares from the last row.
                first_dark: !(*legacy && rows % 2 == 0),
            },
        }
    }

    /// Whether a square is dark.
    #[must_use]
    pub fn is_dark(&self, column: usize, row: usize) -> bool {
        (column + row).is_multiple_of(2) == self.first_dark
    }

    /// Inner corners along x and y.
    #[must_use]
    pub fn inner(&self) -> [usize; 2] {
        self.squares.map(|it| it.saturating_sub(1))
    }

    /// Number of inner corners.
    #[must_use]
    pub fn corners(&self) -> usize {
        let [columns, rows] = self.inner();
        columns * rows
    }

    /// Place of an inner corner, squares.
    #[must_use]
    pub fn corner(&self, id: usize) -> Vector2<f64> {
        let columns = self.inner()[0].max(1);
        Vector2::new((id % columns + 1) as f64, (id / columns + 1) as f64)
    }

    /// Whether the square between a corner and the origin's side in both directions is dark.
    #[must_use]
    pub fn dark_before(&self, id: usize) -> bool {
        let columns = self.inner()[0].max(1);
        self.is_dark(id % columns, id / columns)
    }

    /// The square of a marker, its column and row: light squares count row by row.
    #[must_use]
    pub fn square_of(&self, marker: usize) -> Option<[usize; 2]> {
        let [columns, rows] = self.squares;
        let light = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        light.filter(|[column, row]| !self.is_dark(*column, *row)).nth(marker)
    }

    /// How many markers it has.
    #[must_use]
    pub fn marker_count(&self) -> usize {
        let [columns, rows] = self.squares;
        match self.markers {
            Some(_) => (columns * rows + usize::from(!self.first_dark)) / 2,
            None => 0,
        }
    }

    /// The corners of a marker, squares: clockwise in the picture of the board from its upper left one.
    #[must_use]
    pub fn marker_corners(&self, marker: usize) -> Option<[Vector2<f64>; 4]> {
        let (_, side) = self.markers.as_ref()?;
        let [column, row] = self.square_of(marker)?;
        let middle = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
        let signs = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        Some(signs.map(|[x, y]| middle + Vector2::new(x * side, y * side)))
    }

    /// How far from a corner its squares are plain, squares.
    pub(crate) fn plain(&self) -> f64 {
        self.markers.as_ref().map_or(1.0, |(_, side)| (1.0 - side) / 2.0)
    }
}
