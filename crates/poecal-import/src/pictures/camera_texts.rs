//! Cameras as OpenCV, ROS, Kalibr and industrial_calibration write them (YAML).

use std::path::Path;

use super::intrinsics::of_intrinsics;
use super::region::{KEYS, Region};
use crate::pictures::lens_checks::{EXPECTED, distortion, size_of_pictures};
use poecal_model::camera::{Camera, Lens};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::other_keys::{KeysOf, other_keys};
use poecal_storage::yaml::{Leaf, leaves};

/// Keys of Kalibr's cameras that are read, or say nothing of a lens.
const OF_KALIBR: [&str; 9] = [
    "camera_model",
    "intrinsics",
    "distortion_model",
    "distortion_coeffs",
    "resolution",
    "t_cn_cnm1",
    "t_cam_imu",
    "cam_overlaps",
    "timeshift_cam_imu",
];
/// Keys of OpenCV and ROS that are read, or say nothing of the lens: how it was calibrated, and how pictures would be rectified.
const OF_OPENCV_AND_ROS: [&str; 51] = [
    "distortion_model",
    "distortion",
    "header",
    "width",
    "height",
    "image_width",
    "image_height",
    "image_size",
    "k",
    "d",
    "r",
    "p",
    "m1",
    "d1",
    "camera_matrix",
    "cameramatrix",
    "distortion_coefficients",
    "distortion_coeffs",
    "dist_coeffs",
    "distcoeffs",
    "fisheye",
    "fisheye_model",
    "rectification_matrix",
    "projection_matrix",
    "binning_x",
    "binning_y",
    "roi",
    "board_width",
    "board_height",
    "board_size",
    "boardsize_width",
    "boardsize_height",
    "square_size",
    "marker_size",
    "pattern",
    "calibrate_pattern",
    "aspectratio",
    "fix_aspect_ratio",
    "fixaspectratio",
    "nframes",
    "nr_of_frames",
    "extrinsic_parameters",
    "image_points",
    "grid_points",
    "per_view_errors",
    "std_deviations",
    "rvecs",
    "tvecs",
    "rms",
    "seq",
    "frame_id",
];

/// The cameras of a text of OpenCV, ROS, Kalibr or industrial_calibration, with what was understood, a sentence each.
pub(crate) fn read_yaml(text: &str, path: &Path) -> Result<(Vec<Camera>, Vec<String>)> {
    let leaves = leaves(text, path, EXPECTED)?;
    let cameras = read_chain(&leaves, path)?;
    if !cameras.is_empty() {
        let of_cameras: Vec<Leaf> = leaves
            .into_iter()
            .filter(|leaf| leaf.path.first().is_some_and(|key| cameras.iter().any(|it| it.name == *key)))
            .collect();
        let said = other_keys(&of_cameras, 1, |key| OF_KALIBR.contains(&key), (KeysOf::Pictures, path))?
            .map(|it| format!("{}: {it}", path.display()));
        return Ok((cameras, said.into_iter().collect()));
    }
    let none: [String; 0] = [];
    if let Some(lens) = of_intrinsics(&leaves, path)? {
        let of_lens: Vec<Leaf> = leaves
            .into_iter()
            .filter(|leaf| leaf.path.first().is_some_and(|key| key == "intrinsics"))
            .collect();
        let said =
            other_keys(&of_lens, 1, |key| ["fx", "fy", "cx", "cy"].contains(&key), (KeysOf::Pictures, path))?
                .map(|it| format!("{}: {it}", path.display()));
        let name = word_at(&of_lens, &none, &["camera_name"]).unwrap_or_default();
        return Ok((vec![Camera::new(name, lens)], said.into_iter().collect()));
    }
    let (camera, seen) = read_single(&leaves, path)?;
    let others = other_keys(&leaves, 0, |key| OF_OPENCV_AND_ROS.contains(&key), (KeysOf::Pictures, path))?
        .map(|it| format!("{}: {it}", path.display()));
    Ok((vec![camera], seen.into_iter().chain(others).collect()))
}

/// The cameras of Kalibr; none of another form.
fn read_chain(leaves: &[Leaf], path: &Path) -> Result<Vec<Camera>> {
    // Kalibr names its cameras by keys.
    let mut chains: Vec<String> = leaves
        .iter()
        .filter(|leaf| leaf.path.get(1).is_some_and(|key| key == "intrinsics"))
        .filter_map(|leaf| leaf.path.first().cloned())
        .collect();
    chains.dedup();
    let mut cameras = Vec::new();
    for name in chains {
        let under = [name.clone()];
        let [fx, fy, cx, cy] = exact(list(leaves, &under, &["intrinsics"], path)?, "intrinsics", path)?;
        let model = word_at(leaves, &under, &["camera_model"]).unwrap_or_default();
        if model != "pinhole" {
            let message = format!("found the camera model `{model}` of `{name}`, expected `pinhole`");
            return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
        }
        let bent = list(leaves, &under, &["distortion_coeffs"], path)?;
        let kind = word_at(leaves, &under, &["distortion_model"]).unwrap_or_else(|| "none".to_owned());
        let distortion = distortion(&kind, &bent, path)?;
        let size = list(leaves, &under, &["resolution"], path)?;
        let size_px = <[f64; 2]>::try_from(size).ok().map(size_of_pictures).transpose();
        let size_px = size_px.map_err(|error| error.in_file(path))?;
        cameras
            .push(Camera::new(name, Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px }));
    }
    Ok(cameras)
}

/// The camera of OpenCV or ROS, and what its region changed in words.
fn read_single(leaves: &[Leaf], path: &Path) -> Result<(Camera, Option<String>)> {
    let none: [String; 0] = [];
    let first = |ways: &[&[&str]]| -> Result<Vec<f64>> {
        for keys in ways {
            let found = list(leaves, &none, keys, path)?;
            if !found.is_empty() {
                return Ok(found);
            }
        }
        Ok(Vec::new())
    };
    let matrix = first(&[
        &["camera_matrix", "data"],
        &["cameraMatrix", "data"],
        &["Camera_Matrix", "data"],
        &["K", "data"],
        &["M1", "data"],
        &["K"],
        &["k"],
        &["camera_matrix"],
    ])?;
    let bent = first(&[
        &["distortion_coefficients", "data"],
        &["dist_coeffs", "data"],
        &["distCoeffs", "data"],
        &["Distortion_Coefficients", "data"],
        &["distortion_coeffs", "data"],
        &["D", "data"],
        &["D1", "data"],
        &["D"],
        &["d"],
        &["distortion_coefficients"],
    ])?;
    let [fx, skew, cx, _, fy, cy, ..] = exact::<9>(matrix, "camera_matrix", path)?;
    if skew != 0.0 {
        let message = format!("found a skew of {skew} in `camera_matrix`, expected 0");
        return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
    }
    let is_fisheye =
        word_at(leaves, &none, &["fisheye_model", "fisheye"]).is_some_and(|it| it == "1" || it == "true");
    let kind = word_at(leaves, &none, &["distortion_model"]);
    let kind = kind.unwrap_or_else(|| if is_fisheye { "fisheye".to_owned() } else { String::new() });
    let number = |names: &[&str]| word_at(leaves, &none, names).and_then(|it| it.parse::<f64>().ok());
    let (width, height) = (
        number(&["image_width", "image_Width", "width"]),
        number(&["image_height", "image_Height", "height"]),
    );
    let size_px = width.zip(height).map(|(width, height)| size_of_pictures([width, height])).transpose();
    let lens = Lens {
        focal_px: [fx, fy],
        centre_px: [cx, cy],
        distortion: distortion(&kind, &bent, path)?,
        size_px: size_px.map_err(|error| error.in_file(path))?,
    };
    let (lens, said) = region(leaves, path)?
        .applied(&lens)
        .map_err(|found| Error::new(ErrorKind::Measurement, found).in_file(path))?;
    let said = said.map(|said| format!("{}: {said}", path.display()));
    Ok((Camera::new(word_at(leaves, &none, &["camera_name"]).unwrap_or_default(), lens), said))
}

/// The region of the sensor that the pictures show.
fn region(leaves: &[Leaf], path: &Path) -> Result<Region> {
    let mut numbers = [0.0; KEYS.len()];
    for (number, keys) in numbers.iter_mut().zip(KEYS) {
        let Some(leaf) = leaves.iter().find(|leaf| leaf.path.iter().eq(keys.iter())) else { continue };
        *number = leaf.text.parse::<f64>().ok().filter(|it| it.is_finite()).ok_or_else(|| {
            let message = format!("found `{}` in `{}`, expected a number", leaf.text, keys.join("."));
            Error::new(ErrorKind::Syntax, message).at_line(path, leaf.line)
        })?;
    }
    Region::new(numbers).map_err(|found| Error::new(ErrorKind::Measurement, found).in_file(path))
}

/// The word that one of some keys leads to, behind others.
fn word_at(leaves: &[Leaf], under: &[String], names: &[&str]) -> Option<String> {
    let own = |leaf: &&Leaf| {
        leaf.path.len() == under.len() + 1
            && leaf.path.get(..under.len()) == Some(under)
            && leaf.path.last().is_some_and(|it| names.contains(&it.as_str()))
    };
    leaves.iter().find(own).map(|leaf| leaf.text.clone())
}

/// The numbers of a list that these keys lead to, behind others.
fn list(leaves: &[Leaf], under: &[String], keys: &[&str], path: &Path) -> Result<Vec<f64>> {
    let own = |leaf: &&Leaf| {
        leaf.path.get(..under.len()) == Some(under)
            && leaf.path.len() == under.len() + keys.len() + 1
            && leaf
                .path
                .get(under.len()..under.len() + keys.len())
                .is_some_and(|it| it.iter().eq(keys.iter()))
            && leaf.path.last().is_some_and(|it| it.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let number = |leaf: &Leaf| {
        let found = leaf.text.parse::<f64>().ok().filter(|value| value.is_finite());
        found.ok_or_else(|| {
            let message = format!("found `{}` in `{}`, expected a number", leaf.text, keys.join("."));
            Error::new(ErrorKind::Syntax, message).at_line(path, leaf.line)
        })
    };
    leaves.iter().filter(own).map(number).collect()
}

/// As many numbers as a key must have.
fn exact<const N: usize>(numbers: Vec<f64>, key: &str, path: &Path) -> Result<[f64; N]> {
    numbers.try_into().map_err(|numbers: Vec<f64>| {
        let message = format!("found {} numbers of `{key}`, expected {N}: {EXPECTED}", numbers.len());
        Error::new(ErrorKind::Measurement, message).in_file(path)
    })
}
