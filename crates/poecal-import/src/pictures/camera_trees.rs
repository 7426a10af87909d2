//! Cameras in files of OpenCV, ROS, Kalibr, mrcal, makers of cameras and scripts: numbers below keys (YAML, JSON, XML).

use std::path::Path;

use super::keyed_values::{KeyedValues, are_places, exact_numbers, listed_size, refuse};
use super::mrcal::{OF_MRCAL, of_mrcal};
use crate::pictures::lens_checks::{EXPECTED, OTHERWISE, distortion};
use poecal_model::camera::{Camera, Distortion, Lens, REGION_KEYS, Region, size_of_pictures};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::other_keys::KeyOwner;
use poecal_storage::yaml::YamlLeaf;

/// Keys of Kalibr's cameras that are read, or do not describe a lens.
const OF_KALIBR: &str = "camera_model intrinsics distortion_model distortion_coeffs resolution t_cn_cnm1 t_cam_imu cam_overlaps timeshift_cam_imu";
/// Keys of the matrix, row by row or, in Open3D's form, column by column.
const MATRIX: &str = "camera_matrix.data cameraMatrix.data Camera_Matrix.data K.data M1.data K k camera_matrix cameraMatrix intrinsicMatrix \
                      intrinsic_matrix intrinsics mtx camera_intrinsics";
/// Focal lengths and centre by their names.
const FOCAL: [&str; 4] = ["fx", "fy", "cx ppx", "cy ppy"];
/// Keys of the coefficients of the distortion.
const COEFFICIENTS: &str = "distortion_coefficients.data dist_coeffs.data distCoeffs.data Distortion_Coefficients.data distortion_coeffs.data D.data D1.data D \
                            d distortion_coefficients dist_coeffs dist_coeff distCoeffs distortionCoeff distortion_coeffs distortion dist coeffs";
/// Keys of the coefficients by name, in OpenCV's order, in all their variants.
const NAMED: [&str; 8] = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];
const BENT: [&str; 2] = ["distortion", "Distortion"];
const MODEL: &str = "distortion_model distortionModel";
/// Keys of the model of the distortion, or of the device.
const MODEL_OF_ANY: &str = "model";
/// Keys that mark a fisheye; OAK's type of a camera is then 1.
const IS_FISHEYE: &str = "fisheye_model fisheye cameraType";
/// Width and height of pictures.
const SIZE: [&str; 2] = ["image_width image_Width width", "image_height image_Height height"];
/// Other keys, in small letters, which do not describe the lens: its calibration, the rectification of pictures, the pose of the camera.
const BESIDE: &str = "distortion header image_size r p rectification_matrix projection_matrix binning_x binning_y roi board_width board_height \
                      board_size boardsize_width boardsize_height square_size marker_size pattern calibrate_pattern aspectratio fix_aspect_ratio \
                      fixaspectratio nframes nr_of_frames extrinsic_parameters image_points grid_points per_view_errors std_deviations rvecs tvecs \
                      rms seq frame_id extrinsics lensposition spechfovdeg";

/// Cameras with sentences on their interpretation.
type ReadCameras = (Vec<Camera>, Vec<String>);

/// The cameras of the documents of a text, which must be the same in all of them.
pub(crate) fn read_trees(mut documents: Vec<Vec<YamlLeaf>>, path: &Path) -> Result<ReadCameras> {
    documents.retain(|it| it.iter().any(|leaf| !leaf.path.is_empty()));
    let count = documents.len();
    let mut all = documents.into_iter().map(|leaves| read_tree(&KeyedValues { leaves, path }));
    let (cameras, mut said) =
        all.next().unwrap_or_else(|| refuse(path, format!("found nothing, expected {EXPECTED}")))?;
    for (at, other) in (2..).zip(all) {
        if other?.0 != cameras {
            return refuse(
                path,
                format!("found another camera in document {at} than in the first, expected one: take the others out"),
            );
        }
    }
    if count > 1 {
        said.push(format!("took the first of {count} documents with the same camera"));
    }
    Ok((cameras, said))
}

/// The cameras of a document.
fn read_tree(stated: &KeyedValues<'_>) -> Result<ReadCameras> {
    let others = |at: usize, own: &dyn Fn(&YamlLeaf) -> bool, known: &[&str]| {
        stated.describe_other_keys(KeyOwner::Pictures, (at, own), known)
    };
    let cameras = read_chain(stated)?;
    if !cameras.is_empty() {
        let is_own = |leaf: &YamlLeaf| cameras.iter().any(|it| leaf.path.first() == Some(&it.name));
        let said = others(1, &is_own, &[OF_KALIBR])?;
        return Ok((cameras, said.into_iter().collect()));
    }
    if let Some(camera) = of_mrcal(stated)? {
        return Ok((vec![camera], others(0, &|_| true, &[OF_MRCAL])?.into_iter().collect()));
    }
    let places = places(stated);
    let (mut cameras, mut said) = (Vec::with_capacity(places.len()), Vec::new());
    for place in &places {
        let (camera, seen) = read_single(stated, place, &places)?;
        let name = if places.len() > 1 { place.join("_") } else { camera.name };
        if cameras.iter().any(|it: &Camera| it.name == name) {
            return refuse(stated.path, format!("found the camera `{name}` a second time, expected it once"));
        }
        cameras.push(Camera { name, ..camera });
        let known = [MATRIX, COEFFICIENTS, MODEL, MODEL_OF_ANY, IS_FISHEYE, SIZE[0], SIZE[1], BESIDE];
        let known: Vec<&str> = known.into_iter().chain(FOCAL).chain(NAMED).collect();
        refuse_changes_above(stated, place)?;
        said.extend(seen.into_iter().chain(others(place.len(), &|leaf| leaf.path.starts_with(place), &known)?));
    }
    Ok((cameras, said))
}

/// Refuses keys beside those that lead to a lens if they scale or shift pictures; other keys there do not concern it.
fn refuse_changes_above(stated: &KeyedValues<'_>, place: &[String]) -> Result<()> {
    for depth in 0..place.len() {
        let beside = |leaf: &YamlLeaf| {
            let path = leaf.path.get(..=depth)?;
            let is_beside =
                path.iter().zip(place).take(depth).all(|(key, own)| key == own) && path.last() != place.get(depth);
            is_beside.then(|| YamlLeaf { path: path.to_vec(), ..leaf.clone() })
        };
        let above = KeyedValues { leaves: stated.leaves.iter().filter_map(beside).collect(), path: stated.path };
        above.describe_other_keys(KeyOwner::Pictures, (depth, |_: &YamlLeaf| true), &["depth*", BESIDE])?;
    }
    Ok(())
}

/// The keys below which a matrix or focal lengths are stated, in the order of the file; empty keys if they are at the top level.
fn places<'a>(stated: &'a KeyedValues<'_>) -> Vec<&'a [String]> {
    let is_matrix = |keys: &[String], list: &str| {
        let count = list.split('.').count();
        let (own, at) = keys.split_at(count.min(keys.len()));
        !at.is_empty() && are_places(at) && own.iter().eq(list.split('.'))
    };
    let begins = |keys: &[String]| match keys {
        [key] => key.eq_ignore_ascii_case(FOCAL[0]),
        _ => MATRIX.split(' ').any(|list| is_matrix(keys, list)),
    };
    let mut found: Vec<&'a [String]> = Vec::new();
    for leaf in &stated.leaves {
        let at = (0..leaf.path.len()).find(|at| leaf.path.get(*at..).is_some_and(begins));
        if let Some(place) = at.and_then(|at| leaf.path.get(..at)).filter(|it| !found.contains(it)) {
            found.push(place);
        }
    }
    // Without a lens, the missing keys are reported for the top level.
    if found.is_empty() || found.iter().any(|it| it.is_empty()) { vec![&[]] } else { found }
}

/// The cameras of Kalibr, which names them by keys; empty for another form.
fn read_chain(stated: &KeyedValues<'_>) -> Result<Vec<Camera>> {
    let path = stated.path;
    let is_lens = |leaf: &&YamlLeaf| {
        matches!(leaf.path.as_slice(), [_, key, _] if key == "intrinsics") && are_places(&leaf.path[2..])
    };
    let has_model = |name: &&String| stated.keys_below(std::slice::from_ref(*name)).word("camera_model").is_some();
    let mut names: Vec<&String> = stated.leaves.iter().filter(is_lens).filter_map(|leaf| leaf.path.first()).collect();
    names.dedup();
    names.retain(has_model);
    let camera = |name: &String| {
        let own = stated.keys_below(std::slice::from_ref(name));
        let model = own.word("camera_model").unwrap_or_default();
        if model != "pinhole" {
            let expected = format!("`pinhole`: calibrate it so, {OTHERWISE}");
            return refuse(path, format!("found the camera model `{model}` of `{name}`, expected {expected}"));
        }
        let [fx, fy, cx, cy] = exact_numbers(own.list("intrinsics")?, "intrinsics", path)?;
        let kind = own.word("distortion_model").unwrap_or("none");
        let distortion = distortion(kind, &own.list("distortion_coeffs")?, path)?;
        let size_px = listed_size(&own, "resolution")?;
        let lens = Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px };
        Ok(Camera::new(name.clone(), lens))
    };
    names.into_iter().map(camera).collect()
}

/// Words of lenses that are not OpenCV's usual one.
const OTHER_LENSES: [&str; 6] = ["fisheye", "kannala", "equidistant", "mei", "omni", "division"];

/// The word of another lens, anywhere in a document with one camera.
fn other_lens<'s>(all: &'s KeyedValues<'_>) -> Option<&'s str> {
    let is_one = |text: &str| {
        let mut words = text.split(|it: char| !it.is_alphanumeric());
        words.any(|word| OTHER_LENSES.iter().any(|it| word.eq_ignore_ascii_case(it)))
    };
    all.leaves.iter().map(|leaf| leaf.text.as_str()).find(|text| is_one(text))
}

/// Refuses a distortion that belongs to no lens of the document.
fn refuse_far_distortion(all: &KeyedValues<'_>, places: &[&[String]]) -> Result<()> {
    let is_far = |leaf: &&YamlLeaf| {
        leaf.path.iter().any(|key| key.to_lowercase().contains("dist"))
            && (places.len() == 1 || !places.iter().any(|it| leaf.path.starts_with(it)))
            && leaf.text.parse::<f64>().is_ok_and(|number| number != 0.0)
    };
    let Some(leaf) = all.leaves.iter().find(is_far) else { return Ok(()) };
    let message = format!(
        "found the distortion `{}` away from its lens, expected it beside fx or the matrix: put it there, as `distortion_coefficients`",
        leaf.path.join(".")
    );
    Err(ErrorKind::Measurement.error(message).at_line(all.path, leaf.line))
}

/// The camera below these keys, and the effect of its region in words.
fn read_single(all: &KeyedValues<'_>, place: &[String], places: &[&[String]]) -> Result<(Camera, Option<String>)> {
    let path = all.path;
    let in_file = |error: Error| error.in_file(path);
    let refused = |found: String| ErrorKind::Measurement.error(found).in_file(path);
    let own = all.keys_below(place);
    // Coefficients and sizes may be beside the numbers of the lens.
    let beside = all.keys_below(place.split_last().map_or(place, |it| it.1));
    let near = || [&own, &beside].into_iter();
    let word = |keys: &str| near().find_map(|it| it.word(keys));
    let (focal_px, centre_px) = focal(&own)?;
    let is_fisheye = word(IS_FISHEYE).is_some_and(|it| it == "1" || it == "true");
    if let Some(other) = word("cameraType").filter(|it| !matches!(*it, "0" | "1")) {
        return Err(refused(format!("found cameraType {other}, expected 0 (perspective) or 1 (fisheye)")));
    }
    let usual = if is_fisheye { "fisheye" } else { "" };
    let kind = word(MODEL)
        .or_else(|| word(MODEL_OF_ANY))
        .or_else(|| other_lens(all).filter(|_| places.len() == 1))
        .unwrap_or(usual);
    let distortion = match near().find_map(|it| read_distortion(it, kind).transpose()) {
        Some(found) => found?,
        None => {
            refuse_far_distortion(all, places)?;
            distortion(kind, &[], path)?
        }
    };
    let size_px = size_of_pictures(SIZE.map(|keys| word(keys)?.parse().ok())).map_err(in_file)?;
    let lens = Lens { focal_px, centre_px, distortion, size_px };
    let mut region = [0.0; REGION_KEYS.len()];
    for (number, keys) in region.iter_mut().zip(REGION_KEYS) {
        *number = own.number(keys)?.unwrap_or(0.0);
    }
    let (lens, said) = Region::new(region).and_then(|region| region.apply_region(&lens)).map_err(refused)?;
    Ok((Camera::new(word("camera_name").unwrap_or_default().to_owned(), lens), said))
}

/// Focal lengths and centre, by their names or from a matrix.
fn focal(own: &KeyedValues<'_>) -> Result<([f64; 2], [f64; 2])> {
    let [fx, fy, cx, cy] = FOCAL.map(|keys| own.number_called(keys));
    if let [Some(fx), Some(fy), Some(cx), Some(cy)] = [fx?, fy?, cx?, cy?] {
        return Ok(([fx, fy], [cx, cy]));
    }
    match exact_numbers::<9>(own.list(MATRIX)?, "camera_matrix", own.path)? {
        [fx, 0.0, cx, _, fy, cy, ..] if cx != 0.0 || cy != 0.0 => Ok(([fx, fy], [cx, cy])),
        // The matrix is column by column.
        [fx, 0.0, 0.0, 0.0, fy, 0.0, cx, cy, _] => Ok(([fx, fy], [cx, cy])),
        [_, skew, ..] => refuse(own.path, format!("found a skew of {skew} in `camera_matrix`, expected 0")),
    }
}

/// The distortion that is stated here, if any.
fn read_distortion(own: &KeyedValues<'_>, kind: &str) -> Result<Option<Distortion>> {
    let numbers = own.list(COEFFICIENTS)?;
    if !numbers.is_empty() {
        return distortion(kind, &numbers, own.path).map(Some);
    }
    for own in [own.keys_below(&[])].into_iter().chain(BENT.map(|key| own.keys_below(&[key.to_owned()]))) {
        let named = NAMED.map(|key| own.number_called(key));
        let mut numbers = [0.0; NAMED.len()];
        let mut is_stated = false;
        for (number, named) in numbers.iter_mut().zip(named) {
            let named = named?;
            is_stated |= named.is_some();
            *number = named.unwrap_or(0.0);
        }
        let [k1, k2, p1, p2, k3, k4, ..] = numbers;
        if is_stated {
            // All coefficients of a fisheye belong to the angle.
            let is_fisheye =
                matches!(distortion(kind, &[], own.path)?, Distortion::Fisheye(_)) && p1 == 0.0 && p2 == 0.0;
            let numbers = if is_fisheye { vec![k1, k2, k3, k4] } else { numbers.to_vec() };
            return distortion(kind, &numbers, own.path).map(Some);
        }
    }
    Ok(None)
}
