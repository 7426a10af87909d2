//! Loose tags: each read marker, with its four corners.

pub(crate) mod dictionary;
pub(crate) mod markers;
pub(crate) mod patch;
pub(crate) mod quads;
pub(crate) mod tagfit;
pub(crate) mod tagmodel;

use nalgebra::Vector2;

use crate::detection::{DetectedBoard, DetectedCorner, PointKind, RejectionReason};
use crate::dictionary::Dictionary;
use crate::gray::Gray;
use crate::markers::{DetectedMarker, MarkerReader};
use crate::median::median;
use crate::patch::TagCells;
use crate::quads::{Quad, quads};
use crate::tagfit::{FittedTag, fit};

/// Bits below which a code with a wrong bit is rejected: too many quadrangles resemble one.
const FEW_BITS: usize = 6;
/// Bits up to which clutter has codes without a wrong bit.
const FEWEST_BITS: usize = 4;

/// Finds all tags of a dictionary.
pub(crate) fn detect(
    gray: &Gray,
    dictionary: &Dictionary,
    reader: &MarkerReader,
    noise: f64,
) -> Result<DetectedBoard, RejectionReason> {
    of_quads(gray, (dictionary, reader), noise, &quads(gray, noise))
}

/// Finds the tags in detected quadrangles.
pub(crate) fn of_quads(
    gray: &Gray,
    (dictionary, reader): (&Dictionary, &MarkerReader),
    noise: f64,
    quads: &[Quad],
) -> Result<DetectedBoard, RejectionReason> {
    let mut tags: Vec<(usize, FittedTag)> = Vec::new();
    for quad in quads {
        let Some(marker) = reader.read(gray, quad) else { continue };
        let near = |it: &FittedTag| (middle(&it.corners) - middle(&marker.corners)).norm() < 4.0;
        if tags.iter().any(|it| near(&it.1)) || (dictionary.bits() < FEW_BITS && !marker.exact) {
            continue;
        }
        let fitted = fit(gray, &cells(dictionary, &marker), &marker.corners, noise);
        let is_tag = |it: &FittedTag| dictionary.bits() > FEWEST_BITS || it.is_evident();
        tags.extend(fitted.filter(is_tag).map(|it| (marker.id, it)));
    }
    // A tag that appears twice is rejected as ambiguous.
    let once = |id: usize| tags.iter().filter(|it| it.0 == id).count() == 1;
    let kept = tags.iter().filter(|it| once(it.0));
    let corner = |(id, tag): &(usize, FittedTag), k: usize| DetectedCorner {
        id: 4 * id + k,
        kind: PointKind::Tag,
        u_px: tag.corners[k].x,
        v_px: tag.corners[k].y,
        sigma_px: tag.sigma_px[k],
    };
    let mut corners: Vec<DetectedCorner> = kept.flat_map(|tag| (0..4).map(|k| corner(tag, k))).collect();
    if corners.is_empty() {
        return Err(RejectionReason::NoBoard);
    }
    corners.sort_by_key(|it| it.id);
    let blur_px = median(tags.iter().map(|it| it.1.blur_px)).unwrap_or(0.0);
    Ok(DetectedBoard { markers: corners.len() / 4, corners, turnable: false, blur_px, noise })
}

fn middle(quad: &[Vector2<f64>; 4]) -> Vector2<f64> {
    quad.iter().sum::<Vector2<f64>>() * 0.25
}

fn cells(dictionary: &Dictionary, marker: &DetectedMarker) -> TagCells {
    let side = dictionary.bits() + 2;
    // `is_black` is true for cells outside.
    let cell = |at: usize| dictionary.is_black(marker.id, (at % side).wrapping_sub(1), (at / side).wrapping_sub(1));
    TagCells { side, dark: (0..side * side).map(cell).collect() }
}
