//! Growth from some known points of a board to all its visible corners.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::gray::Gray;
use crate::homography::{Homography, PointPair, map_near};
use crate::median::median;
use crate::saddle::{Saddle, SaddlePrior, refine};

/// A corner of squares: columns and rows before it.
pub(crate) type GridCorner = [i32; 2];

/// Detected corners of a board, and the points from which they were found.
pub(crate) struct BoardGrowth<'a> {
    gray: &'a Gray,
    pub(crate) noise: f64,
    /// Distance from a corner within which its squares are plain, squares.
    plain: f64,
    /// True if the square (0, 0) is dark.
    first_dark: bool,
    /// Less accurate points of the board: corners of markers.
    pub(crate) anchors: Vec<PointPair>,
    pub(crate) nodes: BTreeMap<GridCorner, Saddle>,
    /// Positions at which corners were searched for without success.
    tried: BTreeMap<GridCorner, Vector2<f64>>,
}

/// Standard deviation of the weights of points by their distance, and the largest distance of a map, squares.
const REACH: [f64; 2] = [1.2, 3.2];
/// Distance beyond known points at which a corner is searched for, squares.
const STEP: f64 = 1.6;
/// Largest distance of a corner from its prediction by neighbours, pixels and squares.
const OFF: (f64, f64) = (0.8, 0.035);

/// Ratio of a corner's standard deviation to the usual one from which it is rejected.
const VAGUE: f64 = 6.0;

pub(crate) fn place_of(node: GridCorner) -> Vector2<f64> {
    Vector2::new(f64::from(node[0]), f64::from(node[1]))
}

impl<'a> BoardGrowth<'a> {
    pub(crate) fn new(gray: &'a Gray, noise: f64, plain: f64, first_dark: bool) -> Self {
        let (anchors, nodes, tried) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
        BoardGrowth { gray, noise, plain, first_dark, anchors, nodes, tried }
    }

    /// True if the square before a corner is dark.
    pub(crate) fn dark_before(&self, node: GridCorner) -> bool {
        ((node[0] + node[1]) % 2 == 0) == self.first_dark
    }

    /// The map near a point of the board, from the surrounding points without that point, and the distance of the nearest of them, squares.
    pub(crate) fn map_near(&self, point: Vector2<f64>) -> Option<(Homography, f64)> {
        let nodes = self.nodes.iter().map(|(node, saddle)| (place_of(*node), saddle.place, 1.0));
        map_near(nodes.chain(self.anchors.iter().copied()), point, REACH)
    }

    /// Searches for missing corners among some, from the nearest outwards, until none is added.
    pub(crate) fn grow(&mut self, candidates: &[GridCorner]) {
        const ROUNDS: usize = 40;
        for _ in 0..ROUNDS {
            let mut added = false;
            for node in candidates {
                if self.nodes.contains_key(node) {
                    continue;
                }
                let Some(expected) = self.predict_node(*node) else { continue };
                let known = self.tried.get(node);
                if known.is_some_and(|it| (it - expected.place).norm() < 0.5) {
                    continue;
                }
                match refine(self.gray, &expected, self.noise) {
                    Some(saddle) => {
                        self.nodes.insert(*node, saddle);
                        added = true;
                    }
                    None => {
                        self.tried.insert(*node, expected.place);
                    }
                }
            }
            if !added {
                break;
            }
        }
    }

    fn predict_node(&self, node: GridCorner) -> Option<SaddlePrior> {
        let point = place_of(node);
        let (map, nearest) = self.map_near(point)?;
        if nearest > STEP {
            return None;
        }
        let (place, slope) = (map.map(point)?, map.slope(point)?);
        if !self.gray.holds(place, 1.0) {
            return None;
        }
        let square_px = slope.determinant().abs().sqrt();
        let search_px = (1.0 + 0.06 * square_px * nearest.max(0.5)).min(0.2 * square_px).max(1.0);
        Some(SaddlePrior { place, slope, plain: self.plain, dark_before: self.dark_before(node), search_px })
    }

    /// Adds a corner near a position, with a slope of the board there.
    pub(crate) fn seed(&mut self, node: GridCorner, place: Vector2<f64>, slope: nalgebra::Matrix2<f64>) -> bool {
        let dark_before = self.dark_before(node);
        let expected = SaddlePrior { place, slope, plain: self.plain, dark_before, search_px: 2.0 };
        let found = refine(self.gray, &expected, self.noise);
        if let Some(saddle) = found {
            self.nodes.insert(node, saddle);
        }
        found.is_some()
    }

    /// Removes corners that contradict the prediction by their neighbours, the worst first; those without neighbours too.
    pub(crate) fn prune(&mut self) {
        while let Some(worst) = self.worst_node() {
            self.nodes.remove(&worst);
        }
    }

    fn worst_node(&self) -> Option<GridCorner> {
        let usual_px = median(self.nodes.values().map(|it| it.sigma_px))?.max(0.02);
        let off = |(node, saddle): (&GridCorner, &Saddle)| {
            let point = place_of(*node);
            let predicted = self.map_near(point).and_then(|(map, nearest)| {
                let square_px = map.slope(point)?.determinant().abs().sqrt();
                Some((map.map(point)?, (OFF.0 + OFF.1 * square_px) * nearest.max(1.0)))
            });
            let part = predicted.map_or(f64::INFINITY, |(place, limit)| (place - saddle.place).norm() / limit);
            (*node, part.max(saddle.sigma_px / (VAGUE * usual_px)))
        };
        let worst = self.nodes.iter().map(off).max_by(|a, b| a.1.total_cmp(&b.1))?;
        (worst.1 > 1.0).then_some(worst.0)
    }
}
