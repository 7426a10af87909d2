//! Files of cameras: CSV, and what OpenCV, ROS, Kalibr and ViSP write.

use std::path::Path;

use roxmltree::Document;

use super::camera_tables::read_table;
use super::camera_texts::read_yaml;
use super::unknown_camera::{UNKNOWN, unknown};
use crate::pictures::lens_checks::{EXPECTED, check};
use crate::stored_pictures::stored_cameras;
use poecal_model::camera::{Camera, Distortion, Lens};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::disk::is_file;
use poecal_storage::text_of;

/// Cameras of a file, and what was understood of it, a sentence each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraFile {
    /// The cameras.
    pub cameras: Vec<Camera>,
    /// Regions of the sensor that were taken into account, and keys that were not read.
    pub said: Vec<String>,
}

/// Reads the cameras of a file; of one that has a camera in several versions, those of the version that is named, as in `FILE#VERSION`.
///
/// # Errors
/// A file that cannot be read, or has no camera, a camera twice, or numbers that are none of a lens.
pub fn read_cameras(typed: &str) -> Result<CameraFile> {
    if let Some(size) = typed.strip_prefix(UNKNOWN) {
        return Ok(CameraFile { cameras: vec![unknown(size, typed)?], said: Vec::new() });
    }
    let (path, version) = camera_file(typed).unwrap_or((Path::new(typed), None));
    let extension = path.extension().map(|it| it.to_ascii_lowercase());
    let is = |names: &[&str]| extension.as_ref().is_some_and(|it| names.iter().any(|name| it == name));
    let (cameras, said) = if is(&["yaml", "yml"]) {
        read_yaml(&text_of(path, "a camera (YAML)")?, path)?
    } else if is(&["json"]) {
        (stored_cameras(path)?, Vec::new())
    } else if is(&["xml"]) {
        (read_visp(&text_of(path, "a camera (XML)")?, path)?, Vec::new())
    } else {
        read_table(path, version)?
    };
    for Camera { name, lens, .. } in &cameras {
        check(name, lens).map_err(|error| error.in_file(path))?;
    }
    Ok(CameraFile { cameras, said })
}

/// The file of cameras that was typed, and the version behind `#`, if that is no part of its name; `None` of words that are no file.
#[must_use]
pub fn camera_file(typed: &str) -> Option<(&Path, Option<&str>)> {
    (!typed.starts_with(UNKNOWN)).then(|| match typed.rsplit_once('#') {
        Some((file, version)) if !is_file(Path::new(typed)) => (Path::new(file), Some(version)),
        _ => (Path::new(typed), None),
    })
}

/// Models of ViSP that are read: without distortion, and with one coefficient.
const VISP_MODELS: [&str; 2] = ["perspectiveProjWithoutDistortion", "perspectiveProjWithDistortion"];

/// ViSP: `u = u0 + px x (1 + kud r²)`.
fn read_visp(text: &str, path: &Path) -> Result<Vec<Camera>> {
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
        let model: Vec<_> = model.collect();
        let kinds = model.iter().map(|model| text(*model, "type").unwrap_or_default());
        let is_bent_otherwise = |kind: &String| !kind.is_empty() && !VISP_MODELS.contains(&kind.as_str());
        if let Some(kind) = kinds.filter(is_bent_otherwise).next()
            && !model.iter().any(|model| text(*model, "type").is_some_and(|it| it == VISP_MODELS[1]))
        {
            let message = format!("found the model `{kind}`, expected {}", VISP_MODELS.join(" or "));
            let place = document.text_pos_at(node.range().start);
            return Err(Error::new(ErrorKind::Measurement, message).at(
                path,
                place.row as usize,
                place.col as usize,
            ));
        }
        let model = model.into_iter();
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
