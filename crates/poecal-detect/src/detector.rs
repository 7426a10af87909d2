//! Corners of one board in pictures.

use std::fmt;

use crate::charuco;
use crate::chessboard;
use crate::gray::Gray;
use crate::growth::Growth;
use crate::layout::Layout;
use crate::light::{Light, noise};
use crate::markers::Reader;
use crate::spec::Spec;
use crate::suggest::{self, Suggestion};

/// Finds the corners of one board.
pub struct Detector {
    pub(crate) spec: Spec,
    pub(crate) layout: Layout,
    pub(crate) reader: Option<Reader>,
}

/// A corner in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Its number among the inner corners, along x first; that of OpenCV on a ChArUco board.
    pub id: usize,
    /// Column, pixels from the centre of the first one.
    pub u_px: f64,
    /// Row, pixels from the centre of the first one.
    pub v_px: f64,
    /// Standard deviation of each of both, pixels.
    pub sigma_px: f64,
}

impl Corner {
    /// Its name on the board: `corner0`, `corner1`, …
    #[must_use]
    pub fn name(&self) -> String {
        format!("corner{}", self.id)
    }
}

/// A board that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its corners that are seen, by their numbers.
    pub corners: Vec<Corner>,
    /// Markers that agree with it.
    pub markers: usize,
    /// Whether it looks the same turned by 180°, so that its first corner may be its last: chessboards whose sides are both even or both odd.
    pub turnable: bool,
    /// Blur of the edges, pixels: median of the corners.
    pub blur_px: f64,
    /// Noise of a pixel, gray levels.
    pub noise: f64,
}

/// Why a picture has no corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rejected {
    /// Nothing looks like the board.
    NoBoard,
    /// So many of its corners were seen, too few to know which.
    Few(usize),
    /// A board of other squares or other markers.
    Other,
    /// No board, and edges as wide as this, pixels.
    Blurred(f64),
    /// No board, and nothing is lighter than this level of 255.
    Dark(f64),
    /// No board, and so large a part of the picture is white.
    Overexposed(f64),
}

impl fmt::Display for Rejected {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Rejected::NoBoard => formatter.write_str("no board"),
            Rejected::Few(1) => formatter.write_str("only 1 corner"),
            Rejected::Few(count) => write!(formatter, "only {count} corners"),
            Rejected::Other => formatter.write_str("another board"),
            Rejected::Blurred(edge_px) => {
                write!(formatter, "blurred: its sharpest edges are {edge_px:.0} pixels wide")
            }
            Rejected::Dark(level) => {
                write!(formatter, "too dark: nothing is lighter than {level:.0} of 255")
            }
            Rejected::Overexposed(part) => {
                write!(formatter, "overexposed: {:.0} % of it are white", part * 100.0)
            }
        }
    }
}

/// Levels below which a picture is dark, edges beyond which it is blurred, and white parts beyond which it is overexposed.
const DARK: f64 = 45.0;
const WIDE_PX: f64 = 14.0;
const WHITE: f64 = 0.35;

impl Detector {
    /// What finds a board.
    #[must_use]
    pub fn new(spec: &Spec) -> Self {
        let layout = Layout::new(spec);
        let reader = layout.markers.as_ref().map(|(dictionary, _)| Reader::new(dictionary));
        Detector { spec: spec.clone(), layout, reader }
    }

    /// The board.
    #[must_use]
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// Its geometry.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The corners of the board in a picture.
    ///
    /// # Errors
    /// Why there are none.
    pub fn detect(&self, gray: &Gray) -> Result<Found, Rejected> {
        let noise = noise(gray);
        let found = match &self.reader {
            Some(reader) => charuco::detect(gray, &self.layout, reader, noise),
            None => chessboard::detect(gray, &self.layout, noise),
        };
        found.map_err(|reason| match reason {
            Rejected::NoBoard => because_of_light(gray),
            Rejected::Few(_)
            | Rejected::Other
            | Rejected::Blurred(_)
            | Rejected::Dark(_)
            | Rejected::Overexposed(_) => reason,
        })
    }

    /// Another board that pictures show in which this one was not found: with columns and rows exchanged, of the other pattern, with other markers.
    #[must_use]
    pub fn suggest(&self, pictures: &[&Gray]) -> Option<Suggestion> {
        suggest::suggest(self, pictures)
    }
}

fn because_of_light(gray: &Gray) -> Rejected {
    let light = Light::new(gray);
    if light.lightest < DARK {
        Rejected::Dark(light.lightest)
    } else if light.white > WHITE {
        Rejected::Overexposed(light.white)
    } else if light.edge_px > WIDE_PX {
        Rejected::Blurred(light.edge_px)
    } else {
        Rejected::NoBoard
    }
}

/// What a grown board is to the caller: with the number of each of its nodes.
pub(crate) fn found(growth: &Growth<'_>, noise: f64, id: impl Fn([i32; 2]) -> Option<usize>) -> Found {
    let mut corners: Vec<Corner> = growth
        .nodes
        .iter()
        .filter_map(|(node, saddle)| {
            let (u_px, v_px) = (saddle.place.x, saddle.place.y);
            Some(Corner { id: id(*node)?, u_px, v_px, sigma_px: saddle.sigma_px })
        })
        .collect();
    corners.sort_by_key(|it| it.id);
    let mut blurs: Vec<f64> = growth.nodes.values().map(|it| it.blur_px).collect();
    blurs.sort_by(f64::total_cmp);
    let blur_px = blurs.get(blurs.len() / 2).copied().unwrap_or(0.0);
    Found { corners, markers: 0, turnable: false, blur_px, noise }
}
