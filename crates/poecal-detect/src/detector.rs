//! Corners of one board in pictures.

use crate::found::{Found, Rejected};
use crate::gray::Gray;
use crate::layout::Layout;
use crate::light::{Light, noise};
use crate::markers::Reader;
use crate::spec::{AprilGrid, Charuco, Spec, Tags};
use crate::suggest::{self, Suggestion};
use crate::{aprilgrid, charuco, chessboard, circles, tags};

/// Finds the corners of one board.
pub struct Detector {
    spec: Spec,
    layout: Layout,
    reader: Option<Reader>,
    most_dots: usize,
}

/// Default limit of the candidate dots in a picture.
pub const MOST_DOTS: usize = 6_000;

/// Levels below which a picture is dark, edges beyond which it is blurred, and white parts beyond which it is overexposed.
const DARK: f64 = 45.0;
const WIDE_PX: f64 = 14.0;
const WHITE: f64 = 0.35;

impl Detector {
    /// A detector of a board.
    #[must_use]
    pub fn new(spec: &Spec) -> Self {
        let layout = Layout::new(spec);
        let reader = match spec {
            Spec::Charuco(Charuco { dictionary, .. }) | Spec::Tags(Tags { dictionary, .. }) => {
                Some(Reader::new(dictionary))
            }
            Spec::AprilGrid(AprilGrid { dictionary, .. }) => Some(Reader::with_border(dictionary, 2)),
            Spec::Chessboard(_) | Spec::Circles(_) => None,
        };
        Detector { spec: spec.clone(), layout, reader, most_dots: MOST_DOTS }
    }

    /// The detector with this limit of candidate dots: time grows with its square.
    #[must_use]
    pub fn with_most_dots(self, most_dots: usize) -> Self {
        Detector { most_dots, ..self }
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
    /// The reason for the rejection of a picture without corners.
    pub fn detect(&self, gray: &Gray) -> Result<Found, Rejected> {
        let noise = noise(gray);
        let found = match (&self.spec, &self.reader) {
            (Spec::Charuco(_), Some(reader)) => charuco::detect(gray, &self.layout, reader, noise),
            (Spec::Tags(Tags { dictionary, .. }), Some(reader)) => {
                tags::detect(gray, dictionary, reader, noise)
            }
            (Spec::AprilGrid(_), Some(reader)) => aprilgrid::detect(gray, &self.layout, reader, noise),
            (Spec::Chessboard(_), _) => chessboard::detect(gray, &self.layout, noise),
            (Spec::Charuco(_) | Spec::Tags(_) | Spec::AprilGrid(_), None) => Err(Rejected::NoBoard),
            (Spec::Circles(_), _) => circles::detect(gray, &self.layout, noise, self.most_dots),
        };
        found.map_err(|reason| match reason {
            Rejected::NoBoard => because_of_light(gray),
            Rejected::Few(_)
            | Rejected::Many(_)
            | Rejected::Other
            | Rejected::Blurred(_)
            | Rejected::Dark(_)
            | Rejected::Overexposed(_) => reason,
        })
    }

    /// Another board in pictures in which this one was not found: with columns and rows exchanged, of the other pattern, or with other markers.
    #[must_use]
    pub fn suggest(&self, pictures: &[&Gray]) -> Option<Suggestion> {
        suggest::suggest(&self.spec, pictures, self.most_dots)
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
