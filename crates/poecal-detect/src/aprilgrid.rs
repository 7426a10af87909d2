//! Kalibr's grid of tags: at the common corners of tags and of the dark squares between them, two edges cross as on a chessboard.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::charuco::consensus;
use crate::detection::{DetectedBoard, DetectedCorner, PointKind, RejectionReason};
use crate::gray::Gray;
use crate::homography::PointPair;
use crate::lattice::{map_near, prune};
use crate::layout::{BoardLayout, BoardPattern, TagGrid};
use crate::markers::{DetectedMarker, MarkerReader};
use crate::median::median;
use crate::quads::{Quad, quads_apart};
use crate::saddle::{Saddle, SaddlePrior, refine};

/// Fewest tags that form a board.
const LEAST: usize = 2;
/// Weight of a corner read from a tag, relative to a corner of crossing edges.
const ANCHOR: f64 = 0.04;
/// Largest distance of a corner from its prediction by others, pixels and sides of a tag.
const OFF: (f64, f64) = (0.8, 0.02);
/// Quarter turns of Kalibr's tags against OpenCV's.
const TURNS: usize = 2;

/// Finds the corners of a grid of tags.
pub(crate) fn detect(
    gray: &Gray,
    layout: &BoardLayout,
    reader: &MarkerReader,
    noise: f64,
) -> Result<DetectedBoard, RejectionReason> {
    of_quads(gray, layout, (reader, noise), &quads_apart(gray, noise))
}

/// Finds the corners in quadrangles that were separated from the squares at their corners.
pub(crate) fn of_quads(
    gray: &Gray,
    layout: &BoardLayout,
    (reader, noise): (&MarkerReader, f64),
    quads: &[Quad],
) -> Result<DetectedBoard, RejectionReason> {
    let BoardPattern::Tags(tags) = &layout.pattern else { return Err(RejectionReason::NoBoard) };
    let read = quads.iter().filter_map(|quad| reader.read(gray, quad));
    let turned =
        |it: DetectedMarker| DetectedMarker { corners: [0, 1, 2, 3].map(|k| it.corners[(k + TURNS) % 4]), ..it };
    let markers: Vec<DetectedMarker> = read.map(turned).collect();
    let (_, agreeing) = consensus(layout, &markers).ok_or(RejectionReason::NoBoard)?;
    if agreeing.len() < LEAST || agreeing.len() * 2 < markers.len() {
        return Err(if markers.len() > 2 { RejectionReason::Other } else { RejectionReason::Few(4 * agreeing.len()) });
    }
    let corner = |id: usize, place: Vector2<f64>, weight: f64| (layout.corner(id), place, weight);
    let anchors: Vec<PointPair> = agreeing
        .iter()
        .filter_map(|at| markers.get(*at))
        .flat_map(|it| [0, 1, 2, 3].map(|k| corner(4 * it.id + k, it.corners[k], ANCHOR)))
        .collect();
    let mut found: BTreeMap<usize, Saddle> = BTreeMap::new();
    for _ in 0..3 {
        let before = found.len();
        let mut pairs = anchors.clone();
        pairs.extend(found.iter().map(|(id, it)| corner(*id, it.place, 1.0)));
        for id in 0..layout.corners() {
            if found.contains_key(&id) {
                continue;
            }
            let saddle = predict_corner(gray, layout, tags, &pairs, id).and_then(|it| refine(gray, &it, noise));
            found.extend(saddle.map(|it| (id, it)));
        }
        prune(layout, &mut found, |it| it.place, OFF);
        if found.len() == before {
            break;
        }
    }
    if found.len() < 4 {
        return Err(RejectionReason::Few(found.len()));
    }
    let blur_px = median(found.values().map(|it| it.blur_px)).unwrap_or(0.0);
    let named = |(id, it): (&usize, &Saddle)| DetectedCorner {
        id: *id,
        kind: PointKind::Tag,
        u_px: it.place.x,
        v_px: it.place.y,
        sigma_px: it.sigma_px,
    };
    let corners = found.iter().map(named).collect();
    Ok(DetectedBoard { corners, markers: agreeing.len(), turnable: false, blur_px, noise })
}

/// Prediction of a corner by the others.
fn predict_corner(
    gray: &Gray,
    layout: &BoardLayout,
    tags: &TagGrid,
    pairs: &[PointPair],
    id: usize,
) -> Option<SaddlePrior> {
    let point = layout.corner(id);
    // The corner's own detection from its tag counts too, since the map is taken beside it.
    let (map, nearest) = map_near(pairs, point + Vector2::new(0.01, 0.01))?;
    let (place, slope) = (map.map(point)?, map.slope(point)?);
    if nearest > 1.8 || !gray.holds(place, 1.0) {
        return None;
    }
    let side_px = slope.determinant().abs().sqrt();
    let border = tags.border as f64 / (tags.dictionary.bits() + 2 * tags.border) as f64;
    // Before the upper left corner is a dark square, before the lower right one the tag.
    let dark_before = id.is_multiple_of(2);
    let search_px = (1.0 + 0.03 * side_px * nearest.max(0.3)).min(0.12 * side_px).max(1.0);
    Some(SaddlePrior { place, slope, plain: border.min(tags.gap), dark_before, search_px })
}
