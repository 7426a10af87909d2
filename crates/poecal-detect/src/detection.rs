//! Results of a detector for a picture.

use std::fmt;

use crate::growth::{BoardGrowth, GridCorner};
use crate::median::median;

/// Kind of a point of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PointKind {
    /// A corner of squares.
    Corner,
    /// The middle of a dot.
    Dot,
    /// A corner of a tag. Its number is four times that of the tag, and 0 to 3 for the upper left, upper right, lower right and lower left corner of
    /// the printed tag, which is the order of OpenCV.
    Tag,
}

impl PointKind {
    /// Name of the point with a number: `corner0`, `dot0`, `tag0.0`, …
    #[must_use]
    pub fn name(self, id: usize) -> String {
        match self {
            PointKind::Corner => format!("corner{id}"),
            PointKind::Dot => format!("dot{id}"),
            PointKind::Tag => format!("tag{}.{}", id / 4, id % 4),
        }
    }
}

/// A corner in a picture, or the middle of a dot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectedCorner {
    /// Number among the inner corners or dots, along x first; that of OpenCV on a ChArUco board and a grid of dots. For tags see [`PointKind::Tag`].
    pub id: usize,
    /// Kind of the point.
    pub kind: PointKind,
    /// Column, pixels from the centre of the first one.
    pub u_px: f64,
    /// Row, pixels from the centre of the first one.
    pub v_px: f64,
    /// Standard deviation of each coordinate, pixels.
    pub sigma_px: f64,
}

impl DetectedCorner {
    /// Name on the board: `corner0`, `corner1`, …, `dot0`, …, or `tag0.0`, …
    #[must_use]
    pub fn name(&self) -> String {
        self.kind.name(self.id)
    }
}

/// A detected board.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectedBoard {
    /// Its visible corners, by their numbers.
    pub corners: Vec<DetectedCorner>,
    /// Markers that agree with it.
    pub markers: usize,
    /// True if it looks the same turned by 180°, so that its first corner may be its last: chessboards whose sides are both even or both odd, and
    /// grids of dots except asymmetric ones with an odd number of rows. A square grid of dots looks the same at each quarter turn.
    pub turnable: bool,
    /// Blur of the edges, pixels: median of the corners.
    pub blur_px: f64,
    /// Noise of a pixel, gray levels.
    pub noise: f64,
}

/// Reason for a picture without corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RejectionReason {
    /// Nothing looks like the board.
    NoBoard,
    /// This number of its corners were visible, too few to identify them.
    Few(usize),
    /// More parts than this look like dots: a mesh or a perforated sheet.
    Many(usize),
    /// A board of other squares or other markers.
    Other,
    /// No board, and edges as wide as this, pixels.
    Blurred(f64),
    /// No board, and no pixel is lighter than this level of 255.
    Dark(f64),
    /// No board, and this share of the picture is white.
    Overexposed(f64),
}

impl fmt::Display for RejectionReason {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RejectionReason::NoBoard => formatter.write_str("no board"),
            RejectionReason::Few(1) => formatter.write_str("only 1 corner"),
            RejectionReason::Few(count) => write!(formatter, "only {count} corners"),
            RejectionReason::Many(most) => {
                write!(formatter, "too many dots: more than {most} parts look like one")
            }
            RejectionReason::Other => formatter.write_str("another board"),
            RejectionReason::Blurred(edge_px) => {
                write!(formatter, "blurred: its sharpest edges are {edge_px:.0} pixels wide")
            }
            RejectionReason::Dark(level) => {
                write!(formatter, "too dark: nothing is lighter than {level:.0} of 255")
            }
            RejectionReason::Overexposed(part) => {
                write!(formatter, "overexposed: {:.0} % of it are white", part * 100.0)
            }
        }
    }
}

/// Result of a grown board, with the number of each of its nodes.
pub(crate) fn board_from_growth(
    growth: &BoardGrowth<'_>,
    noise: f64,
    id: impl Fn(GridCorner) -> Option<usize>,
) -> DetectedBoard {
    let mut corners: Vec<DetectedCorner> = growth
        .nodes
        .iter()
        .filter_map(|(node, saddle)| {
            let (u_px, v_px) = (saddle.place.x, saddle.place.y);
            Some(DetectedCorner { id: id(*node)?, kind: PointKind::Corner, u_px, v_px, sigma_px: saddle.sigma_px })
        })
        .collect();
    corners.sort_by_key(|it| it.id);
    let blur_px = median(growth.nodes.values().map(|it| it.blur_px)).unwrap_or(0.0);
    DetectedBoard { corners, markers: 0, turnable: false, blur_px, noise }
}
