//! Corners of one board in pictures.

use crate::detection::{DetectedBoard, RejectionReason};
use crate::gray::Gray;
use crate::layout::BoardLayout;
use crate::light::{PictureLight, noise};
use crate::markers::MarkerReader;
use crate::spec::{AprilGrid, BoardSpec, Charuco, Tags};
use crate::suggest::{self, Suggestion};
use crate::{aprilgrid, charuco, chessboard, circles, tags};

/// Finds the corners of one board.
pub struct Detector {
    spec: BoardSpec,
    layout: BoardLayout,
    reader: Option<MarkerReader>,
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
    pub fn new(spec: &BoardSpec) -> Self {
        let layout = BoardLayout::new(spec);
        let reader = match spec {
            BoardSpec::Charuco(Charuco { dictionary, .. }) | BoardSpec::Tags(Tags { dictionary, .. }) => {
                Some(MarkerReader::new(dictionary))
            }
            BoardSpec::AprilGrid(AprilGrid { dictionary, .. }) => Some(MarkerReader::with_border(dictionary, 2)),
            BoardSpec::Chessboard(_) | BoardSpec::Circles(_) => None,
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
    pub fn spec(&self) -> &BoardSpec {
        &self.spec
    }

    /// Its geometry.
    #[must_use]
    pub fn layout(&self) -> &BoardLayout {
        &self.layout
    }

    /// The corners of the board in a picture.
    ///
    /// # Errors
    /// The reason for the rejection of a picture without corners.
    pub fn detect(&self, gray: &Gray) -> Result<DetectedBoard, RejectionReason> {
        let noise = noise(gray);
        let found = match (&self.spec, &self.reader) {
            (BoardSpec::Charuco(_), Some(reader)) => charuco::detect(gray, &self.layout, reader, noise),
            (BoardSpec::Tags(Tags { dictionary, .. }), Some(reader)) => tags::detect(gray, dictionary, reader, noise),
            (BoardSpec::AprilGrid(_), Some(reader)) => aprilgrid::detect(gray, &self.layout, reader, noise),
            (BoardSpec::Chessboard(_), _) => chessboard::detect(gray, &self.layout, noise),
            (BoardSpec::Charuco(_) | BoardSpec::Tags(_) | BoardSpec::AprilGrid(_), None) => {
                Err(RejectionReason::NoBoard)
            }
            (BoardSpec::Circles(_), _) => circles::detect(gray, &self.layout, noise, self.most_dots),
        };
        found.map_err(|reason| match reason {
            RejectionReason::NoBoard => because_of_light(gray),
            RejectionReason::Few(_)
            | RejectionReason::Many(_)
            | RejectionReason::Other
            | RejectionReason::Blurred(_)
            | RejectionReason::Dark(_)
            | RejectionReason::Overexposed(_) => reason,
        })
    }

    /// Another board in pictures in which this one was not found: with columns and rows exchanged, of the other pattern, or with other markers.
    #[must_use]
    pub fn suggest(&self, pictures: &[&Gray]) -> Option<Suggestion> {
        suggest::suggest(&self.spec, pictures, self.most_dots)
    }
}

fn because_of_light(gray: &Gray) -> RejectionReason {
    let light = PictureLight::new(gray);
    if light.lightest < DARK {
        RejectionReason::Dark(light.lightest)
    } else if light.white > WHITE {
        RejectionReason::Overexposed(light.white)
    } else if light.edge_px > WIDE_PX {
        RejectionReason::Blurred(light.edge_px)
    } else {
        RejectionReason::NoBoard
    }
}
