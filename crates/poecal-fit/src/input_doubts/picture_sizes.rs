//! Sizes of pictures that lenses state, compared with the measured corners.

use super::{DoubtLocation, InputDoubt};
use poecal_model::camera::{Camera, Corner};
use poecal_numerics::error::shorten_name;

/// Pixels beyond the edge of a picture at which a corner may be found: detectors refine corners that they find at the edge.
const BEYOND: f64 = 2.0;
/// Fewest corners for which the filled part of the picture is evaluated.
const FEWEST: usize = 100;
/// Corners of pictures of a smaller size begin within this share of it, and reach this share.
const BEGIN: f64 = 0.1;
const REACH: f64 = 0.9;

/// A sentence for each camera whose corners fill one part of its pictures, as those of smaller pictures do. Pictures are corners with the number of
/// their camera.
///
/// # Errors
/// Doubt about corners outside the pictures that the lenses state.
pub fn check_sizes(cameras: &[Camera], pictures: &[(usize, &[Corner])]) -> Result<Vec<String>, InputDoubt> {
    let mut said = Vec::new();
    for (at, camera) in cameras.iter().enumerate() {
        let Some(size) = camera.lens.size_px.map(|size| size.map(f64::from)) else { continue };
        let corners: Vec<&Corner> = pictures.iter().filter(|it| it.0 == at).flat_map(|it| it.1).collect();
        let is_outside = |corner: &&&Corner| {
            (0..2).any(|k| corner.pixel[k] < -0.5 - BEYOND || corner.pixel[k] > size[k] - 0.5 + BEYOND)
        };
        if let Some(first) = corners.iter().find(is_outside) {
            let count = corners.iter().filter(is_outside).count();
            let message = outside_error(camera, size, &corners, (first, count));
            return Err(InputDoubt::new(DoubtLocation::Line(first.line as usize), message));
        }
        if let Some(part) = (2..=4).find(|part| fill(size.map(|it| it / f64::from(*part)), &corners)) {
            let ([width, height], [x, y]) = (size, size.map(|it| it / f64::from(part)));
            let (share, of) = (["half", "third", "quarter"][part as usize - 2], camera_phrase(camera));
            said.push(format!(
                "all corners{of} are in the upper left {x} × {y} pixels of the {width} × {height} that its lens states, as those of pictures of \
                 a {share} of the size: if the pictures are so small, divide fx, fy, cx, cy and the size by {part}"
            ));
        }
    }
    Ok(said)
}

/// Owner of corners or a lens, for a camera that has a name.
fn camera_phrase(camera: &Camera) -> String {
    if camera.name.is_empty() { String::new() } else { format!(" of the camera `{}`", shorten_name(&camera.name)) }
}

/// Least and largest pixel of corners along an axis.
fn extent(corners: &[&Corner], axis: usize) -> (f64, f64) {
    let pixels = corners.iter().map(|it| it.pixel[axis]);
    pixels.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), it| (least.min(it), most.max(it)))
}

/// True if corners fill pictures of a size.
fn fill(size: [f64; 2], corners: &[&Corner]) -> bool {
    corners.len() >= FEWEST
        && (0..2).all(|axis| {
            let (least, most) = extent(corners, axis);
            least < BEGIN * size[axis] && (REACH * size[axis]..=size[axis]).contains(&most)
        })
}

/// Error of a corner that is outside, with the ratio of the sizes.
fn outside_error(camera: &Camera, size: [f64; 2], corners: &[&Corner], (first, count): (&Corner, usize)) -> String {
    let most = [0, 1].map(|axis| extent(corners, axis).1);
    let times = [0, 1].map(|axis| most[axis] / size[axis]);
    let is_like = times[0] > 1.2 && (times[0] / times[1] - 1.0).abs() < 0.2;
    let is_exchanged = most[0] <= size[1] + BEYOND && most[1] <= size[0] + BEYOND;
    let advice = if is_like {
        let most = times[0].max(times[1]);
        let times = if times[0] > 1.7 { format!("{most:.0} times as large") } else { "larger".to_owned() };
        format!(
            "the pictures are about {times} in both directions, so the lens is that of another resolution: state it at that of the pictures (fx, fy, \
             cx, cy and the size grow alike)"
        )
    } else if is_exchanged {
        "width and height are exchanged, or the pictures were turned by 90 deg: state the lens of the pictures as they are".to_owned()
    } else {
        "the lens is that of cropped pictures, or of another mode of the camera: state the lens of the pictures as they are".to_owned()
    };
    let (all, of, [width, height], [far_x, far_y]) = (corners.len(), camera_phrase(camera), size, most);
    let (x, y) = (first.pixel.x, first.pixel.y);
    format!(
        "found the corner ({x:.1}, {y:.1}), and {count} of {all} corners, outside the {width} × {height} pixels of the pictures that the lens{of} states; \
         they reach to ({far_x:.1}, {far_y:.1}), expected corners in the picture: {advice}"
    )
}
