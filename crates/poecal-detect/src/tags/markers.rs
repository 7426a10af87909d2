//! Markers: the code of a quadrangle.

use nalgebra::Vector2;

use crate::dictionary::Dictionary;
use crate::gray::Gray;
use crate::homography::Homography;
use crate::quads::Quad;

/// A marker in a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DetectedMarker {
    pub(crate) id: usize,
    /// Its corners, clockwise from the upper left one of the printed marker.
    pub(crate) corners: Quad,
    /// True if all its bits are right.
    pub(crate) exact: bool,
}

/// Reads markers of a dictionary.
pub(crate) struct MarkerReader {
    dictionary: Dictionary,
    /// Cells of the dark border.
    border: usize,
}

/// Least difference of light and dark, gray levels.
const LEAST_CONTRAST: f64 = 6.0;
/// Share of the cells of the border that must be dark.
const DARK_BORDER: f64 = 0.9;

impl MarkerReader {
    pub(crate) fn new(dictionary: &Dictionary) -> Self {
        MarkerReader { dictionary: dictionary.clone(), border: 1 }
    }

    /// A reader of markers with a border of this number of cells.
    pub(crate) fn with_border(dictionary: &Dictionary, border: usize) -> Self {
        MarkerReader { dictionary: dictionary.clone(), border }
    }

    /// The marker of a quadrangle, in any orientation.
    pub(crate) fn read(&self, gray: &Gray, quad: &Quad) -> Option<DetectedMarker> {
        let code = code(gray, quad, self.dictionary.bits(), self.border)?;
        let (id, turns, wrong) = self.dictionary.find(code)?;
        let corners = [0, 1, 2, 3].map(|k| quad[(k + turns) % 4]);
        Some(DetectedMarker { id, corners, exact: wrong == 0 })
    }
}

/// The bits inside a quadrangle with a dark border, black as 1, row by row.
fn code(gray: &Gray, quad: &Quad, bits: usize, border: usize) -> Option<u64> {
    let cells = bits + 2 * border;
    let unit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vector2::from);
    let to_picture = Homography::of_corners(&unit, quad)?;
    let mut levels = Vec::with_capacity(cells * cells);
    for row in 0..cells {
        for column in 0..cells {
            levels.push(cell(gray, &to_picture, [column, row], cells)?);
        }
    }
    let limit = split(&levels)?;
    let is_border = |at: usize| {
        let (column, row) = (at % cells, at / cells);
        column.min(row) < border || column.max(row) + border >= cells
    };
    let border = (0..levels.len()).filter(|at| is_border(*at));
    let dark = border.clone().filter(|at| levels[*at] < limit).count();
    if (dark as f64) < DARK_BORDER * border.count() as f64 {
        return None;
    }
    let inner = (0..levels.len()).filter(|at| !is_border(*at));
    Some(inner.enumerate().fold(0, |code, (bit, at)| code | u64::from(levels[at] < limit) << bit))
}

/// Mean level of the middle of a cell.
fn cell(gray: &Gray, to_picture: &Homography, [column, row]: [usize; 2], cells: usize) -> Option<f64> {
    const AT: [f64; 3] = [0.3, 0.5, 0.7];
    let mut sum = 0.0;
    for y in AT {
        for x in AT {
            let place = Vector2::new(column as f64 + x, row as f64 + y) / cells as f64;
            sum += gray.level_at(to_picture.map(place)?);
        }
    }
    Some(sum / 9.0)
}

/// Threshold between dark and light that separates levels best (Otsu's method), if they are far enough apart.
fn split(levels: &[f64]) -> Option<f64> {
    let mut sorted = levels.to_vec();
    sorted.sort_by(f64::total_cmp);
    let total: f64 = sorted.iter().sum();
    let count = sorted.len() as f64;
    let (mut sum, mut best) = (0.0, (0.0, 0.0, 0.0));
    for k in 1..sorted.len() {
        sum += sorted[k - 1];
        let (below, above) = (sum / k as f64, (total - sum) / (count - k as f64));
        let between = k as f64 * (count - k as f64) * (above - below).powi(2);
        if between > best.0 {
            best = (between, 0.5 * (below + above), above - below);
        }
    }
    (best.2 >= LEAST_CONTRAST).then_some(best.1)
}
