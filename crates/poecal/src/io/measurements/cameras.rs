//! Files of cameras: CSV, and what OpenCV, ROS, Kalibr and ViSP write.

use std::path::Path;

use roxmltree::Document;

use super::intrinsics::of_intrinsics;
use super::mapping::ColumnMap;
use super::number::Numbers;
use super::table::{Row, Table};
use super::text::Blocks;
use super::unknown_camera::{UNKNOWN, unknown};
use crate::camera::{Camera, Distortion, LENS_NAMES, Lens};
use crate::error::{Error, ErrorKind, Result, first_few};
use crate::io::disk::is_file;
use crate::io::numbers::LARGEST_NUMBER;
use crate::io::stored_pictures::stored_cameras;
use crate::io::text_of;
use crate::io::yaml::{Leaf, leaves};

const EXPECTED: &str = "a camera: CSV with name, fx, fy, cx, cy, k1, … in OpenCV's order, or YAML of OpenCV, ROS (camera_info) or Kalibr (camchain), \
                        or XML of ViSP";

/// Reads the cameras of a file; of one that has a camera in several versions, those of the version that is named, as in `FILE#VERSION`.
///
/// # Errors
/// A file that cannot be read, or has no camera, a camera twice, or numbers that are none of a lens.
pub fn read_cameras(typed: &str) -> Result<Vec<Camera>> {
    if let Some(size) = typed.strip_prefix(UNKNOWN) {
        return Ok(vec![unknown(size, typed)?]);
    }
    let (path, version) = camera_file(typed).unwrap_or((Path::new(typed), None));
    let extension = path.extension().map(|it| it.to_ascii_lowercase());
    let is = |names: &[&str]| extension.as_ref().is_some_and(|it| names.iter().any(|name| it == name));
    let cameras = if is(&["yaml", "yml"]) {
        of_yaml(&text_of(path, "a camera (YAML)")?, path)?
    } else if is(&["json"]) {
        stored_cameras(path)?
    } else if is(&["xml"]) {
        of_visp(&text_of(path, "a camera (XML)")?, path)?
    } else {
        of_table(path, version)?
    };
    for Camera { name, lens, .. } in &cameras {
        check(name, lens).map_err(|error| error.in_file(path))?;
    }
    Ok(cameras)
}

/// The file of cameras that was typed, and the version behind `#`, if that is no part of its name; `None` of words that are no file.
#[must_use]
pub fn camera_file(typed: &str) -> Option<(&Path, Option<&str>)> {
    (!typed.starts_with(UNKNOWN)).then(|| match typed.rsplit_once('#') {
        Some((file, version)) if !is_file(Path::new(typed)) => (Path::new(file), Some(version)),
        _ => (Path::new(typed), None),
    })
}

/// Refuses numbers that are no lens's.
pub(super) fn check(name: &str, lens: &Lens) -> Result<()> {
    let of = || if name.is_empty() { String::new() } else { format!(" of camera `{name}`") };
    let [fx, fy] = lens.focal_px;
    let refuse = |found: String, expected: &str| {
        Err(Error::new(ErrorKind::Measurement, format!("found {found}{}, expected {expected}", of())))
    };
    let is_none = |number: f64| !number.is_finite() || number.abs() > LARGEST_NUMBER;
    if let Some((own, number)) = LENS_NAMES.iter().zip(lens.numbers()).find(|it| is_none(it.1)) {
        return refuse(
            format!("{number:?} for `{own}`"),
            &format!("a finite number of at most {LARGEST_NUMBER:e}"),
        );
    }
    if !(fx > 0.0 && fy > 0.0) {
        return refuse(format!("the focal lengths {fx} and {fy}"), "pixels above 0");
    }
    // In millimetres they are about 4 to 50, and cx, cy about 2 to 12.
    if fx < 60.0 && fy < 60.0 {
        return refuse(
            format!("the focal lengths {fx} and {fy}"),
            "pixels, not millimetres: focal length over the size of a pixel",
        );
    }
    if !(0.5..2.0).contains(&(fx / fy)) {
        return refuse(format!("the focal lengths {fx} and {fy}"), "two that are nearly alike");
    }
    let [cx, cy] = lens.centre_px;
    if let Some([width, height]) = lens.size_px {
        let inside = |at: f64, size: u32| (0.0..f64::from(size)).contains(&at);
        if !inside(cx, width) || !inside(cy, height) {
            let size = format!(
                "a place in the picture of {width} × {height} pixels; are width and height, or cx and cy, exchanged?"
            );
            return refuse(format!("the centre ({cx}, {cy})"), &size);
        }
    }
    Ok(())
}

fn of_table(path: &Path, version: Option<&str>) -> Result<Vec<Camera>> {
    let map = ColumnMap::default();
    let mut table = Table::open(path, Blocks::open(path, "a camera (CSV)")?, &map)?;
    let header = &table.header;
    let place = |name: &str| header.require(name, "for the camera", |_| false, "");
    let name = match header.find("name")? {
        Some(at) => Some(at),
        None => header.find("camera")?,
    };
    let first = [place("fx")?, place("fy")?, place("cx")?, place("cy")?];
    let mut numbers: Vec<Option<usize>> = first.map(Some).to_vec();
    for own in &LENS_NAMES[4..] {
        numbers.push(header.find(own)?);
    }
    let size = [header.find("width")?, header.find("height")?];
    let (model, versions) = (header.find("model")?, header.find("version")?);
    let mut cameras: Vec<(Camera, String, usize)> = Vec::new();
    let mut reader = Numbers::new(None);
    while let Some(mut rows) = table.next_block()? {
        while let Some(row) = rows.next()? {
            let mut lens = [0.0; LENS_NAMES.len()];
            for ((number, column), own) in lens.iter_mut().zip(&numbers).zip(LENS_NAMES) {
                if let Some(value) = column.map(|at| cell(&mut reader, &row, at, own)).transpose()?.flatten()
                {
                    *number = value;
                }
            }
            let size = size.map(|column| column.map(|at| cell(&mut reader, &row, at, "size")).transpose());
            let [width, height] = size;
            let size_px = match (width?.flatten(), height?.flatten()) {
                (Some(width), Some(height)) if width >= 1.0 && height >= 1.0 => {
                    Some([width as u32, height as u32])
                }
                _ => None,
            };
            let word = |column: Option<usize>| {
                column.and_then(|at| row.cells.get(at)).map(|it| it.text().trim().to_owned())
            };
            let is_fisheye =
                ["fisheye", "equidistant"].contains(&word(model).unwrap_or_default().to_lowercase().as_str());
            let lens = lens_of(&lens, is_fisheye, size_px);
            let own = word(versions).unwrap_or_default();
            // The only one needs no name.
            let name = name.map_or_else(|| "camera".to_owned(), |at| word(Some(at)).unwrap_or_default());
            cameras.push((Camera::new(name, lens), own, row.line));
        }
    }
    if let Some(version) = version {
        let known: Vec<String> = cameras.iter().map(|it| it.1.clone()).collect();
        cameras.retain(|(_, own, _)| own == version);
        if cameras.is_empty() {
            let message = format!("found the version `{version}`, expected one of {}", first_few(&known));
            return Err(Error::new(ErrorKind::Option, message).in_file(path));
        }
    }
    for (at, (camera, own, line)) in cameras.iter().enumerate() {
        if let Some((_, other, first)) = cameras.iter().take(at).find(|it| it.0.name == camera.name) {
            if name.is_none() && own == other {
                return Err(header_without_names(&table));
            }
            let file = path.display();
            let advice = if own == other {
                String::new()
            } else {
                format!(": choose one with --camera {file}#{other} or --camera {file}#{own}")
            };
            let message = format!(
                "found the camera `{}` a second time (line {first} is the first), expected it once{advice}",
                camera.name
            );
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, *line));
        }
    }
    if cameras.is_empty() {
        let message = format!("found a header and no rows, expected {EXPECTED}");
        return Err(Error::new(ErrorKind::Measurement, message).at_line(path, table.header.line));
    }
    Ok(cameras.into_iter().map(|(camera, ..)| camera).collect())
}

/// The error of several cameras without names.
fn header_without_names(table: &Table<'_>) -> Error {
    let missing = table.header.require("name", "for the name of each camera", |_| false, "");
    missing.err().unwrap_or_else(|| Error::new(ErrorKind::Measurement, "found cameras without names"))
}

/// The number of a cell; `None` of an empty one.
fn cell(numbers: &mut Numbers, row: &Row<'_>, at: usize, name: &str) -> Result<Option<f64>> {
    let raw = row.cells.get(at).map_or("", |cell| cell.raw);
    if raw.is_empty() {
        return Ok(None);
    }
    let found = numbers.parse(raw, row.line);
    let found = found
        .map_err(|expected| row.error(at, format!("found `{raw}` for `{name}`, expected {expected}")))?;
    Ok(Some(found))
}

fn lens_of(numbers: &[f64; LENS_NAMES.len()], is_fisheye: bool, size_px: Option<[u32; 2]>) -> Lens {
    let [fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6] = *numbers;
    let distortion = if is_fisheye {
        // A table names them k1 to k4, a list has them in this order.
        Distortion::Fisheye(if p1 == 0.0 && p2 == 0.0 { [k1, k2, k3, k4] } else { [k1, k2, p1, p2] })
    } else {
        Distortion::Brown([k1, k2, p1, p2, k3, k4, k5, k6])
    };
    Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px }
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

fn of_yaml(text: &str, path: &Path) -> Result<Vec<Camera>> {
    let leaves = leaves(text, path, EXPECTED)?;
    let word = |under: &[String], names: &[&str]| {
        let own = |leaf: &&Leaf| {
            leaf.path.len() == under.len() + 1
                && leaf.path.get(..under.len()) == Some(under)
                && leaf.path.last().is_some_and(|it| names.contains(&it.as_str()))
        };
        leaves.iter().find(own).map(|leaf| leaf.text.clone())
    };
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
        let [fx, fy, cx, cy] = exact(list(&leaves, &under, &["intrinsics"], path)?, "intrinsics", path)?;
        let model = word(&under, &["camera_model"]).unwrap_or_default();
        if model != "pinhole" {
            let message = format!("found the camera model `{model}` of `{name}`, expected `pinhole`");
            return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
        }
        let bent = list(&leaves, &under, &["distortion_coeffs"], path)?;
        let kind = word(&under, &["distortion_model"]).unwrap_or_else(|| "none".to_owned());
        let distortion = distortion(&kind, &bent, path)?;
        let size = list(&leaves, &under, &["resolution"], path)?;
        let size_px = if let [width, height] = size[..] { Some([width as u32, height as u32]) } else { None };
        cameras
            .push(Camera::new(name, Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px }));
    }
    if !cameras.is_empty() {
        return Ok(cameras);
    }
    let none: [String; 0] = [];
    if let Some(lens) = of_intrinsics(&leaves, path)? {
        return Ok(vec![Camera::new(word(&none, &["camera_name"]).unwrap_or_default(), lens)]);
    }
    let first = |ways: &[&[&str]]| -> Result<Vec<f64>> {
        for keys in ways {
            let found = list(&leaves, &none, keys, path)?;
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
    let is_fisheye = word(&none, &["fisheye_model", "fisheye"]).is_some_and(|it| it == "1" || it == "true");
    let kind = word(&none, &["distortion_model"]);
    let kind = kind.unwrap_or_else(|| if is_fisheye { "fisheye".to_owned() } else { String::new() });
    let number = |names: &[&str]| word(&none, names).and_then(|it| it.parse::<u32>().ok());
    let (width, height) = (
        number(&["image_width", "image_Width", "width"]),
        number(&["image_height", "image_Height", "height"]),
    );
    let lens = Lens {
        focal_px: [fx, fy],
        centre_px: [cx, cy],
        distortion: distortion(&kind, &bent, path)?,
        size_px: width.zip(height).map(|(width, height)| [width, height]),
    };
    Ok(vec![Camera::new(word(&none, &["camera_name"]).unwrap_or_default(), lens)])
}

/// As many numbers as a key must have.
fn exact<const N: usize>(numbers: Vec<f64>, key: &str, path: &Path) -> Result<[f64; N]> {
    numbers.try_into().map_err(|numbers: Vec<f64>| {
        let message = format!("found {} numbers of `{key}`, expected {N}: {EXPECTED}", numbers.len());
        Error::new(ErrorKind::Measurement, message).in_file(path)
    })
}

/// A distortion by the name of its model and its coefficients.
pub(super) fn distortion(kind: &str, numbers: &[f64], path: &Path) -> Result<Distortion> {
    let refuse = |expected: &str| {
        let message =
            format!("found the distortion `{kind}` with {} coefficients, expected {expected}", numbers.len());
        Err(Error::new(ErrorKind::Measurement, message).in_file(path))
    };
    match kind {
        "" | "none" | "plumb_bob" | "radtan" | "rational_polynomial" => {
            // OpenCV writes up to 14, of which those of thin prisms and tilts are mostly 0.
            if numbers.iter().skip(8).any(|it| *it != 0.0) {
                return refuse("none of a thin prism or a tilted sensor");
            }
            let mut k = [0.0; 8];
            k.iter_mut().zip(numbers).for_each(|(k, number)| *k = *number);
            Ok(Distortion::Brown(k))
        }
        "equidistant" | "fisheye" => match *numbers {
            [k1, k2, k3, k4] => Ok(Distortion::Fisheye([k1, k2, k3, k4])),
            [] => Ok(Distortion::Fisheye([0.0; 4])),
            _ => refuse("4"),
        },
        _ => refuse("plumb_bob, radtan, rational_polynomial, equidistant, fisheye or none"),
    }
}

/// ViSP: `u = u0 + px x (1 + kud r²)`.
fn of_visp(text: &str, path: &Path) -> Result<Vec<Camera>> {
    let document = Document::parse(text).map_err(|error| {
        let place = error.pos();
        Error::new(ErrorKind::Syntax, format!("found broken XML ({error}), expected {EXPECTED}")).at(
            path,
            place.row as usize,
            place.col as usize,
        )
    })?;
    let mut cameras: Vec<Camera> = Vec::new();
    for node in document.descendants().filter(|node| node.has_tag_name("camera")) {
        let text = |of: roxmltree::Node<'_, '_>, name: &str| {
            let child = of.children().find(|child| child.has_tag_name(name));
            child.and_then(|child| child.text()).map(|text| text.trim().to_owned())
        };
        let number = |of: roxmltree::Node<'_, '_>, name: &str| {
            text(of, name).and_then(|it| it.parse::<f64>().ok()).filter(|it| it.is_finite())
        };
        let model = node.children().filter(|child| child.has_tag_name("model"));
        // The model with distortion, where both are there.
        let Some(model) = model.max_by_key(|model| number(*model, "kud").is_some()) else { continue };
        let parts = ["px", "py", "u0", "v0"].map(|name| number(model, name));
        let [Some(px), Some(py), Some(u0), Some(v0)] = parts else {
            let message = format!("found a `<model>` without px, py, u0 and v0, expected {EXPECTED}");
            let place = document.text_pos_at(model.range().start);
            return Err(Error::new(ErrorKind::Measurement, message).at(
                path,
                place.row as usize,
                place.col as usize,
            ));
        };
        let mut k = [0.0; 8];
        k[0] = number(model, "kud").unwrap_or(0.0);
        let size = ["image_width", "image_height"].map(|name| number(node, name));
        let size_px =
            if let [Some(width), Some(height)] = size { Some([width as u32, height as u32]) } else { None };
        let lens =
            Lens { focal_px: [px, py], centre_px: [u0, v0], distortion: Distortion::Brown(k), size_px };
        let name = text(node, "name").unwrap_or_default();
        if !cameras.iter().any(|it| it.name == name) {
            cameras.push(Camera::new(name, lens));
        }
    }
    if cameras.is_empty() {
        return Err(Error::new(ErrorKind::Measurement, format!("found no `<camera>`, expected {EXPECTED}"))
            .in_file(path));
    }
    Ok(cameras)
}
