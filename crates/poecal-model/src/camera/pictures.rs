//! The pictures of a session.

use serde::{Deserialize, Serialize};

use super::{Board, Camera, CommonError, Picture, PictureNumber, SightingInput};

/// Initial standard deviation of corners that state none, pixels.
const USUAL_PX: f64 = 0.3;

/// The pictures of a session with their cameras and boards. A picture is one row: the pose that fits its corners, with noise of the shape of
/// its corners and of their shared error (theory.md §4, *Pictures*).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pictures {
    /// The cameras.
    pub cameras: Vec<Camera>,
    /// The boards.
    pub boards: Vec<Board>,
    /// The pictures, in the order of their rows.
    pub all: Vec<Picture>,
    /// Standard deviation of corners that state none, pixels.
    pub sigma_px: f64,
    /// Shared error of a picture's corners.
    pub common: CommonError,
    /// Numbers of cameras and boards that were estimated with the robot.
    #[serde(default)]
    pub found: Vec<PictureNumber>,
}

impl Default for Pictures {
    fn default() -> Self {
        Pictures {
            cameras: Vec::new(),
            boards: Vec::new(),
            all: Vec::new(),
            sigma_px: USUAL_PX,
            common: CommonError::default(),
            found: Vec::new(),
        }
    }
}

impl Pictures {
    /// True if there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// A picture with its lens and board; `None` if its camera or board is not among these.
    #[must_use]
    pub fn view<'a>(&'a self, picture: &'a Picture) -> Option<SightingInput<'a>> {
        let (camera, board) = (self.cameras.get(picture.camera)?, self.boards.get(picture.board)?);
        Some(SightingInput::new(picture, &camera.lens, board, self.sigma_px))
    }

    /// Index of the picture of a row.
    #[must_use]
    pub fn index_of_row(&self, row: u32) -> Option<usize> {
        self.all.binary_search_by_key(&row, |picture| picture.row).ok()
    }

    /// Pictures of some rows, which have new numbers in this order.
    pub(crate) fn select_rows(&self, rows: &[u32]) -> Self {
        let of = |(new, &row): (u32, &u32)| {
            let picture = self.all.get(self.index_of_row(row)?)?;
            Some(Picture { row: new, ..picture.clone() })
        };
        Pictures { all: (0..).zip(rows).filter_map(of).collect(), ..self.clone() }
    }

    /// Adds other pictures, whose first row has this number here.
    pub(crate) fn extend(&mut self, other: &Pictures, first: u32) {
        if self.is_empty() {
            (self.sigma_px, self.common) = (other.sigma_px, other.common);
        }
        let cameras: Vec<usize> = other.cameras.iter().map(|it| index(&mut self.cameras, it)).collect();
        let boards: Vec<usize> = other.boards.iter().map(|it| index(&mut self.boards, it)).collect();
        self.all.extend(other.all.iter().map(|picture| Picture {
            row: picture.row + first,
            camera: cameras.get(picture.camera).copied().unwrap_or(picture.camera),
            board: boards.get(picture.board).copied().unwrap_or(picture.board),
            ..picture.clone()
        }));
    }
}

/// Index of a value in a list, to which it is added if it is new.
fn index<T: PartialEq + Clone>(list: &mut Vec<T>, value: &T) -> usize {
    list.iter().position(|own| own == value).unwrap_or_else(|| {
        list.push(value.clone());
        list.len() - 1
    })
}
