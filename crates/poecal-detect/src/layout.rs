//! Positions of the corners, squares and markers of a board.

use nalgebra::Vector2;

use crate::detection::PointKind;
use crate::dictionary::Dictionary;
use crate::spec::{AprilGrid, BoardSpec, Charuco, Circles, Tags};

/// Pattern of a board.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BoardPattern {
    /// Squares, dark and light in turn.
    Squares,
    /// Dots at the inner corners of virtual squares.
    Dots {
        /// True if only every second corner has one, from the first on.
        asymmetric: bool,
        /// Drawn diameter as a part of a square. In pictures it is measured.
        diameter: f64,
    },
    /// Tags in columns and rows.
    Tags(TagGrid),
}

/// Tags in columns and rows, as drawn. The first one is a side of a tag from both borders of the board.
#[derive(Clone, Debug, PartialEq)]
pub struct TagGrid {
    /// Tags along x.
    pub columns: usize,
    /// Tags along y.
    pub rows: usize,
    /// Gap between tags, in sides of a tag.
    pub gap: f64,
    /// Cells of the dark border.
    pub border: usize,
    /// True for Kalibr's grid: tags count from the lower left one, with dark squares at their corners, and are turned by 180° relative to OpenCV's.
    pub kalibr: bool,
    /// The tags.
    pub dictionary: Dictionary,
}

impl TagGrid {
    /// The upper left corner of a tag, in sides of a tag from the corner of the board.
    #[must_use]
    pub fn first_corner(&self, tag: usize) -> Vector2<f64> {
        let (column, row) = (tag % self.columns.max(1), tag / self.columns.max(1));
        let row = if self.kalibr { (self.rows as f64 - 1.0) - row as f64 } else { row as f64 };
        Vector2::new(column as f64, row) * (1.0 + self.gap) + Vector2::new(1.0, 1.0)
    }

    /// Cells along a side of a tag with its border.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.dictionary.bits() + 2 * self.border
    }

    /// True if a cell of a tag is black, as the board stands. Cells count from the upper left one, with the border; outside cells are black.
    #[must_use]
    pub fn is_black(&self, tag: usize, column: usize, row: usize) -> bool {
        let last = self.cells() - 1;
        let turned = |at: usize| if self.kalibr { last.wrapping_sub(at) } else { at };
        let inner = |at: usize| turned(at).wrapping_sub(self.border);
        self.dictionary.is_black(tag, inner(column), inner(row))
    }
}

/// Corners of a tag from its first one, in its sides.
const AROUND: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// A point of a board.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardPoint {
    /// Name, as of a [`DetectedCorner`](crate::DetectedCorner) in a picture.
    pub name: String,
    /// Position on the board, metres.
    pub place_m: [f64; 2],
}

/// The geometry of a board, in squares: x to the right, y downwards, from the outer corner of the first square. For a grid of dots a square has the
/// side of its pitch, with dots at inner corners.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardLayout {
    /// Squares along x and y.
    pub squares: [usize; 2],
    /// Side of a square, metres.
    pub square_m: f64,
    /// The markers: their dictionary, and their side as a part of a square's.
    pub markers: Option<(Dictionary, f64)>,
    /// True if the first square is dark.
    pub first_dark: bool,
    /// Pattern of the board.
    pub pattern: BoardPattern,
}

impl BoardLayout {
    /// The geometry of a board.
    #[must_use]
    pub fn new(spec: &BoardSpec) -> Self {
        let (squares, square_m, pattern) = (spec.squares(), spec.square_m(), BoardPattern::Squares);
        match spec {
            BoardSpec::Chessboard(_) => BoardLayout { squares, square_m, markers: None, first_dark: true, pattern },
            BoardSpec::Circles(Circles { asymmetric, .. }) => {
                let diameter = if *asymmetric { 0.8 } else { 0.5 };
                let pattern = BoardPattern::Dots { asymmetric: *asymmetric, diameter };
                BoardLayout { squares, square_m, markers: None, first_dark: true, pattern }
            }
            BoardSpec::Tags(Tags { dictionary, .. }) => {
                let (columns, rows, gap, border) = (5, 3, 0.75, 1);
                let pattern = TagGrid { columns, rows, gap, border, kalibr: false, dictionary: dictionary.clone() };
                BoardLayout { squares, square_m, markers: None, first_dark: true, pattern: BoardPattern::Tags(pattern) }
            }
            BoardSpec::AprilGrid(AprilGrid { columns, rows, spacing, dictionary, .. }) => {
                let (columns, rows, gap, border) = (*columns, *rows, *spacing, 2);
                let pattern = TagGrid { columns, rows, gap, border, kalibr: true, dictionary: dictionary.clone() };
                BoardLayout { squares, square_m, markers: None, first_dark: true, pattern: BoardPattern::Tags(pattern) }
            }
            BoardSpec::Charuco(Charuco { marker_m, dictionary, legacy, rows, .. }) => BoardLayout {
                squares,
                square_m,
                markers: Some((dictionary.clone(), marker_m / square_m)),
                // The old pattern counts its squares from the last row.
                first_dark: !(*legacy && rows % 2 == 0),
                pattern,
            },
        }
    }

    /// True if a square is dark.
    #[must_use]
    pub fn is_dark(&self, column: usize, row: usize) -> bool {
        (column + row).is_multiple_of(2) == self.first_dark
    }

    /// Inner corners along x and y.
    #[must_use]
    pub fn inner_corners(&self) -> [usize; 2] {
        self.squares.map(|it| it.saturating_sub(1))
    }

    /// Number of inner corners, of dots, or of corners of tags.
    #[must_use]
    pub fn corners(&self) -> usize {
        if let BoardPattern::Tags(tags) = &self.pattern {
            return 4 * tags.columns * tags.rows;
        }
        let [columns, rows] = self.inner_corners();
        if self.is_asymmetric() { columns / 2 * rows } else { columns * rows }
    }

    /// Position of an inner corner, of a dot, or of the corner of a tag, squares.
    #[must_use]
    pub fn corner(&self, id: usize) -> Vector2<f64> {
        if let BoardPattern::Tags(tags) = &self.pattern {
            let [x, y] = AROUND[id % 4];
            return tags.first_corner(id / 4) + Vector2::new(x, y);
        }
        let columns = self.inner_corners()[0].max(1);
        if self.is_asymmetric() {
            let columns = (columns / 2).max(1);
            let (column, row) = (id % columns, id / columns);
            return Vector2::new((2 * column + row % 2 + 1) as f64, (row + 1) as f64);
        }
        Vector2::new((id % columns + 1) as f64, (id / columns + 1) as f64)
    }

    /// All points with their names, metres. For chessboards and dots x is to the right and y downwards from the first one, as the axes of `poecal`'s
    /// boards and OpenCV's. For Kalibr's grid of tags x is to the right and y upwards from the lower left corner of tag 0. Loose tags have no common
    /// frame: the corners of each are relative to its own middle, with y upwards.
    #[must_use]
    pub fn points(&self) -> Vec<BoardPoint> {
        let point = |kind: PointKind, id: usize, place: Vector2<f64>| BoardPoint {
            name: kind.name(id),
            place_m: (place * self.square_m).into(),
        };
        let first = Vector2::new(1.0, 1.0);
        let all = 0..self.corners();
        match &self.pattern {
            BoardPattern::Squares => all.map(|id| point(PointKind::Corner, id, self.corner(id) - first)).collect(),
            BoardPattern::Dots { .. } => all.map(|id| point(PointKind::Dot, id, self.corner(id) - first)).collect(),
            BoardPattern::Tags(tags) if tags.kalibr => {
                let origin = self.corner(3);
                let off = |id: usize| self.corner(id) - origin;
                all.map(|id| point(PointKind::Tag, id, Vector2::new(off(id).x, -off(id).y))).collect()
            }
            BoardPattern::Tags(tags) => {
                let off = |id: usize| Vector2::new(AROUND[id % 4][0] - 0.5, 0.5 - AROUND[id % 4][1]);
                (0..4 * tags.dictionary.len()).map(|id| point(PointKind::Tag, id, off(id))).collect()
            }
        }
    }

    /// True if it has dots on every second corner.
    pub(crate) fn is_asymmetric(&self) -> bool {
        matches!(self.pattern, BoardPattern::Dots { asymmetric: true, .. })
    }

    /// The number of the dot at a column and row.
    pub(crate) fn dot_at(&self, [column, row]: [usize; 2]) -> Option<usize> {
        let [columns, _] = self.inner_corners();
        if !self.is_asymmetric() {
            return Some(row * columns + column);
        }
        (column % 2 == row % 2).then(|| row * (columns / 2) + column / 2)
    }

    /// Radius of dots, squares; 0 without dots.
    pub(crate) fn dot_radius(&self) -> f64 {
        match self.pattern {
            BoardPattern::Squares | BoardPattern::Tags(_) => 0.0,
            BoardPattern::Dots { diameter, .. } => 0.5 * diameter,
        }
    }

    /// True if the square between a corner and the origin's side in both directions is dark.
    #[must_use]
    pub fn dark_before(&self, id: usize) -> bool {
        let columns = self.inner_corners()[0].max(1);
        self.is_dark(id % columns, id / columns)
    }

    /// The square of a marker, its column and row: light squares count row by row.
    #[must_use]
    pub fn square_of(&self, marker: usize) -> Option<[usize; 2]> {
        let [columns, rows] = self.squares;
        let light = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        light.filter(|[column, row]| !self.is_dark(*column, *row)).nth(marker)
    }

    /// Number of markers.
    #[must_use]
    pub fn marker_count(&self) -> usize {
        if let BoardPattern::Tags(tags) = &self.pattern {
            return tags.columns * tags.rows;
        }
        let [columns, rows] = self.squares;
        match self.markers {
            Some(_) => (columns * rows + usize::from(!self.first_dark)) / 2,
            None => 0,
        }
    }

    /// The corners of a marker, squares: clockwise in the picture of the board from its upper left one.
    #[must_use]
    pub fn marker_corners(&self, marker: usize) -> Option<[Vector2<f64>; 4]> {
        if matches!(self.pattern, BoardPattern::Tags(_)) {
            return Some([0, 1, 2, 3].map(|k| self.corner(4 * marker + k)));
        }
        let (_, side) = self.markers.as_ref()?;
        let [column, row] = self.square_of(marker)?;
        let middle = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
        let signs = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        Some(signs.map(|[x, y]| middle + Vector2::new(x * side, y * side)))
    }

    /// Distance from a corner within which its squares are plain, squares.
    pub(crate) fn plain_reach(&self) -> f64 {
        self.markers.as_ref().map_or(1.0, |(_, side)| (1.0 - side) / 2.0)
    }
}
