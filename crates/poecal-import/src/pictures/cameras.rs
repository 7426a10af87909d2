//! Files of cameras: CSV, and the forms of OpenCV, ROS, Kalibr, ViSP, HALCON and makers of cameras.

use std::path::Path;

use roxmltree::Node;

use super::camera_tables::read_table;
use super::camera_trees::read_trees;
use super::halcon::read_halcon;
use super::keyed_values::of_xml;
use super::mrcal::without_inputs;
use super::stored_pictures::stored_cameras;
use crate::pictures::lens_checks::{EXPECTED, check};
use poecal_model::camera::{Camera, Distortion, LARGEST_SIDE, Lens, size_of_pictures};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::disk::is_file;
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source_text::read_up_to;
use poecal_storage::text_of;
use poecal_storage::xml::{parsed, root_name};
use poecal_storage::yaml::trees;

/// Cameras of a file, and sentences on its interpretation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraFile {
    /// The cameras.
    pub cameras: Vec<Camera>,
    /// Regions of the sensor that were applied, and unread keys.
    pub said: Vec<String>,
}

/// A key of calibration.json, and of no other file of a camera.
const OF_CALIBRATION: [&str; 2] = ["\"pictures\"", "\"poecal-calibration-"];
/// Beginning of the words of a camera whose lens is unknown.
const UNKNOWN: &str = "unknown:";

/// A camera with an unknown lens and known size of pictures; its lens is to be found from its pictures.
fn unknown(size: &str, typed: &str) -> Result<Camera> {
    let number = |text: &str| text.trim().parse::<u32>().ok().filter(|it| (1..=LARGEST_SIDE).contains(it));
    let found = size.split_once(['x', 'X']).and_then(|(x, y)| Some([number(x)?, number(y)?]));
    let Some(size_px) = found else {
        return ErrorKind::Option
            .refuse(format!("found the camera `{typed}`, expected the size of its pictures, as unknown:1920x1080"));
    };
    // Any lens will do until the pictures determine it.
    let [width, height] = size_px.map(f64::from);
    let lens = Lens { size_px: Some(size_px), ..Lens::pinhole([width; 2], [0.5 * width, 0.5 * height]) };
    Ok(Camera { is_guessed: true, ..Camera::new("camera".to_owned(), lens) })
}

/// Reads the cameras of a file. If it has a camera in several versions, the version named as in `FILE#VERSION` is read.
///
/// # Errors
/// A file cannot be read, or has no camera, a camera twice, or numbers that belong to no lens.
pub fn read_cameras(typed: &str) -> Result<CameraFile> {
    if let Some(size) = typed.strip_prefix(UNKNOWN) {
        return Ok(CameraFile { cameras: vec![unknown(size, typed)?], said: Vec::new() });
    }
    let (path, version) = camera_file(typed).unwrap_or((Path::new(typed), None));
    let ending = path.extension().map(|it| it.to_string_lossy().to_ascii_lowercase());
    let text = |what: &str| read_up_to(path, what, ResourceLimit::Settings);
    let (cameras, said) = match ending.as_deref() {
        Some("yaml" | "yml" | "cameramodel") => {
            let text = text("a camera (YAML)")?;
            read_trees(trees(&without_inputs(&text), path, EXPECTED)?, path)?
        }
        Some("json") => {
            let text = text_of(path, "a camera (JSON)")?;
            match OF_CALIBRATION.iter().any(|key| text.contains(key)) {
                true => (stored_cameras(path)?, Vec::new()),
                false => read_trees(trees(&text, path, EXPECTED)?, path)?,
            }
        }
        Some("xml") => {
            let text = text("a camera (XML)")?;
            match root_name(&text) {
                Some("opencv_storage") => read_trees(vec![of_xml(&text, path, EXPECTED)?], path)?,
                _ => (read_visp(&text, path)?, Vec::new()),
            }
        }
        Some("dat" | "cal") => match read_halcon(&text("a camera (HALCON)")?, path)? {
            Some(found) => found,
            None => read_table(path, version)?,
        },
        _ => read_table(path, version)?,
    };
    for Camera { name, lens, .. } in &cameras {
        check(name, lens).map_err(|error| error.in_file(path))?;
    }
    let said = said.into_iter().map(|it| format!("{}: {it}", path.display())).collect();
    Ok(CameraFile { cameras, said })
}

/// The file of cameras that was typed, and the version behind `#`, unless this is part of the file's name; `None` if the words are no file.
#[must_use]
pub fn camera_file(typed: &str) -> Option<(&Path, Option<&str>)> {
    (!typed.starts_with(UNKNOWN)).then(|| match typed.rsplit_once('#') {
        Some((file, version)) if !is_file(Path::new(typed)) => (Path::new(file), Some(version)),
        _ => (Path::new(typed), None),
    })
}

/// Models of ViSP that are read: without distortion, and with one coefficient.
const VISP_MODELS: [&str; 2] = ["perspectiveProjWithoutDistortion", "perspectiveProjWithDistortion"];

/// Reads ViSP's form: `u = u0 + px x (1 + kud r²)`.
fn read_visp(text: &str, path: &Path) -> Result<Vec<Camera>> {
    let document = parsed(text, path, EXPECTED)?;
    let mut cameras: Vec<Camera> = Vec::new();
    for node in document.descendants().filter(|node| node.has_tag_name("camera")) {
        let camera = visp_camera(node).map_err(|(at, message)| {
            let place = document.text_pos_at(at);
            ErrorKind::Measurement.error(message).at_position(path, place.row as usize, place.col as usize)
        })?;
        cameras.extend(camera.filter(|camera| !cameras.iter().any(|it| it.name == camera.name)));
    }
    if cameras.is_empty() {
        let message = format!("found no `<camera>`, expected {EXPECTED}");
        return Err(ErrorKind::Measurement.error(message).in_file(path));
    }
    Ok(cameras)
}

/// The camera of an element; `None` without a model. An error has its position in the text.
fn visp_camera(node: Node<'_, '_>) -> std::result::Result<Option<Camera>, (usize, String)> {
    let text = |of: Node<'_, '_>, name: &str| {
        let child = of.children().find(|child| child.has_tag_name(name));
        child.and_then(|child| child.text()).map_or_else(String::new, |text| text.trim().to_owned())
    };
    let number = |of: Node<'_, '_>, name: &str| text(of, name).parse().ok().filter(|it: &f64| it.is_finite());
    let models = || node.children().filter(|child| child.has_tag_name("model"));
    let is_read = |model: &Node<'_, '_>| {
        let kind = text(*model, "type");
        kind.is_empty() || VISP_MODELS.contains(&kind.as_str())
    };
    // The model with distortion, if there are both.
    let chosen = models().filter(is_read).max_by_key(|model| number(*model, "kud").is_some());
    let Some(model) = chosen else {
        let Some(other) = models().next() else { return Ok(None) };
        let (found, expected) = (text(other, "type"), VISP_MODELS.join(" or "));
        return Err((other.range().start, format!("found the model `{found}`, expected {expected}")));
    };
    let [Some(px), Some(py), Some(u0), Some(v0)] = ["px", "py", "u0", "v0"].map(|name| number(model, name)) else {
        let message = format!("found a `<model>` without px, py, u0 and v0, expected {EXPECTED}");
        return Err((model.range().start, message));
    };
    let mut k = [0.0; 8];
    k[0] = number(model, "kud").unwrap_or(0.0);
    let size_px = size_of_pictures(["image_width", "image_height"].map(|name| number(node, name)))
        .map_err(|error| (node.range().start, error.to_string()))?;
    let lens = Lens { focal_px: [px, py], centre_px: [u0, v0], distortion: Distortion::Brown(k), size_px };
    Ok(Some(Camera::new(text(node, "name"), lens)))
}
