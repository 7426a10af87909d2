//! Cameras as OpenCV, ROS, Kalibr and industrial_calibration write them (YAML).

use std::path::Path;

use super::stated::Stated;
use crate::pictures::lens_checks::{EXPECTED, distortion};
use poecal_model::camera::{Camera, Lens, REGION_KEYS, Region, size_of_pictures};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::other_keys::KeysOf;
use poecal_storage::yaml::leaves;

/// Keys of Kalibr's cameras that are read, or say nothing of a lens.
const OF_KALIBR: &str = "camera_model intrinsics distortion_model distortion_coeffs resolution t_cn_cnm1 t_cam_imu cam_overlaps timeshift_cam_imu";
/// The numbers of industrial_calibration's lens, which has no distortion.
const OF_INTRINSICS: &str = "fx fy cx cy";
/// What leads to the matrix in OpenCV's and ROS's files.
const MATRIX: &str =
    "camera_matrix.data cameraMatrix.data Camera_Matrix.data K.data M1.data K k camera_matrix";
/// What leads to the coefficients of the distortion.
const COEFFICIENTS: &str = "distortion_coefficients.data dist_coeffs.data distCoeffs.data Distortion_Coefficients.data distortion_coeffs.data D.data D1.data D \
                            d distortion_coefficients";
const MODEL: &str = "distortion_model";
const IS_FISHEYE: &str = "fisheye_model fisheye";
/// Width and height of pictures.
const SIZE: [&str; 2] = ["image_width image_Width width", "image_height image_Height height"];
/// Other keys of OpenCV and ROS, in small letters, which say nothing of the lens: how it was calibrated, and how pictures would be rectified.
const BESIDE: &str = "distortion header image_size r p rectification_matrix projection_matrix binning_x binning_y roi board_width board_height \
                      board_size boardsize_width boardsize_height square_size marker_size pattern calibrate_pattern aspectratio fix_aspect_ratio \
                      fixaspectratio nframes nr_of_frames extrinsic_parameters image_points grid_points per_view_errors std_deviations rvecs tvecs \
                      rms seq frame_id";

/// The cameras of a text of OpenCV, ROS, Kalibr or industrial_calibration, with what was understood, a sentence each.
pub(crate) fn read_yaml(text: &str, path: &Path) -> Result<(Vec<Camera>, Vec<String>)> {
    let stated = Stated { leaves: leaves(text, path, EXPECTED)?, path };
    let others = |at: usize, own: &dyn Fn(&String) -> bool, known: &[&str]| {
        stated.others(KeysOf::Pictures, (at, |leaf| leaf.path.first().is_some_and(own)), known)
    };
    let cameras = read_chain(&stated)?;
    if !cameras.is_empty() {
        let said = others(1, &|key| cameras.iter().any(|it| it.name == *key), &[OF_KALIBR])?;
        return Ok((cameras, said.into_iter().collect()));
    }
    if let Some(lens) = of_intrinsics(&stated)? {
        let said = others(1, &|key| key == "intrinsics", &[OF_INTRINSICS])?;
        return Ok((vec![Camera::new(String::new(), lens)], said.into_iter().collect()));
    }
    let (camera, seen) = read_single(&stated)?;
    let said = others(0, &|_| true, &[MATRIX, COEFFICIENTS, MODEL, IS_FISHEYE, SIZE[0], SIZE[1], BESIDE])?;
    Ok((vec![camera], seen.into_iter().chain(said).collect()))
}

/// The cameras of Kalibr, which names them by keys; none of another form.
fn read_chain(stated: &Stated<'_>) -> Result<Vec<Camera>> {
    let path = stated.path;
    let is_lens = |key: &String| key == "intrinsics";
    let own = stated.leaves.iter().filter(|leaf| leaf.path.get(1).is_some_and(is_lens));
    let mut names: Vec<&String> = own.filter_map(|leaf| leaf.path.first()).collect();
    names.dedup();
    let camera = |name: &String| {
        let own = stated.below(name);
        let [fx, fy, cx, cy] = exact(own.list("intrinsics")?, "intrinsics", path)?;
        let model = own.word("camera_model").unwrap_or_default();
        if model != "pinhole" {
            let message = format!("found the camera model `{model}` of `{name}`, expected `pinhole`");
            return Err(ErrorKind::Measurement.error(message).in_file(path));
        }
        let kind = own.word("distortion_model").unwrap_or("none");
        let distortion = distortion(kind, &own.list("distortion_coeffs")?, path)?;
        let size = <[f64; 2]>::try_from(own.list("resolution")?).ok();
        let size_px = size_of_pictures(size.map_or([None; 2], |it| it.map(Some)));
        let size_px = size_px.map_err(|error| error.in_file(path))?;
        let lens = Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px };
        Ok(Camera::new(name.clone(), lens))
    };
    names.into_iter().map(camera).collect()
}

/// The lens of industrial_calibration: `intrinsics` with fx, fy, cx and cy, without distortion.
fn of_intrinsics(stated: &Stated<'_>) -> Result<Option<Lens>> {
    let all = ["fx", "fy", "cx", "cy"].map(|key| stated.number(&format!("intrinsics.{key}")).transpose());
    if all.iter().all(Option::is_none) {
        return Ok(None);
    }
    let [Some(fx), Some(fy), Some(cx), Some(cy)] = all else {
        let message = "found `intrinsics` without all of fx, fy, cx and cy, expected these";
        return Err(ErrorKind::Measurement.error(message).in_file(stated.path));
    };
    Ok(Some(Lens::pinhole([fx?, fy?], [cx?, cy?])))
}

/// The camera of OpenCV or ROS, and what its region changed in words.
fn read_single(stated: &Stated<'_>) -> Result<(Camera, Option<String>)> {
    let path = stated.path;
    let in_file = |error: Error| error.in_file(path);
    let refused = |found: String| ErrorKind::Measurement.error(found).in_file(path);
    let (matrix, bent) = (stated.list(MATRIX)?, stated.list(COEFFICIENTS)?);
    let [fx, skew, cx, _, fy, cy, ..] = exact::<9>(matrix, "camera_matrix", path)?;
    if skew != 0.0 {
        return Err(refused(format!("found a skew of {skew} in `camera_matrix`, expected 0")));
    }
    let is_fisheye = stated.word(IS_FISHEYE).is_some_and(|it| it == "1" || it == "true");
    let kind = stated.word(MODEL).unwrap_or(if is_fisheye { "fisheye" } else { "" });
    let size_px = size_of_pictures(SIZE.map(|keys| stated.word(keys)?.parse().ok()));
    let lens = Lens {
        focal_px: [fx, fy],
        centre_px: [cx, cy],
        distortion: distortion(kind, &bent, path)?,
        size_px: size_px.map_err(in_file)?,
    };
    let mut region = [0.0; REGION_KEYS.len()];
    for (number, keys) in region.iter_mut().zip(REGION_KEYS) {
        *number = stated.number(keys)?.unwrap_or(0.0);
    }
    let (lens, said) = Region::new(region).and_then(|region| region.applied(&lens)).map_err(refused)?;
    Ok((Camera::new(stated.word("camera_name").unwrap_or_default().to_owned(), lens), said))
}

/// As many numbers as a key must have.
fn exact<const N: usize>(numbers: Vec<f64>, key: &str, path: &Path) -> Result<[f64; N]> {
    numbers.try_into().map_err(|numbers: Vec<f64>| {
        let message = format!("found {} numbers of `{key}`, expected {N}: {EXPECTED}", numbers.len());
        ErrorKind::Measurement.error(message).in_file(path)
    })
}
