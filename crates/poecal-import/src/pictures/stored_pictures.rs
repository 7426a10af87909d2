//! Calibrated cameras and boards of a `calibration.json`.

use std::path::Path;

use serde::Deserialize;

use poecal_model::camera::{Board, BoardEntry, Camera, CameraEntry};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::text_of;

/// Pictures of a `calibration.json`.
#[derive(Deserialize)]
struct StoredPictureFile {
    pictures: Option<StoredPictures>,
}

#[derive(Deserialize)]
struct StoredPictures {
    cameras: Vec<CameraEntry>,
    #[serde(default)]
    boards: Vec<BoardEntry>,
}

fn refuse(path: &Path, message: String) -> Error {
    Error::new(ErrorKind::Measurement, message).in_file(path)
}

/// The pictures of a `calibration.json`.
fn read_stored_pictures(path: &Path) -> Result<StoredPictures> {
    let text = text_of(path, "a calibration.json with pictures")?;
    let stored: StoredPictureFile = serde_json::from_str(&text)
        .map_err(|error| refuse(path, format!("found no calibration.json ({error}), expected one with pictures")))?;
    let expected = "found a calibration without pictures, expected one of a session with a camera";
    stored.pictures.ok_or_else(|| refuse(path, expected.to_owned()))
}

/// Its cameras.
///
/// # Errors
/// The file is none, or has no cameras.
pub(crate) fn stored_cameras(path: &Path) -> Result<Vec<Camera>> {
    let cameras: Result<_> = read_stored_pictures(path)?.cameras.iter().map(CameraEntry::camera).collect();
    cameras.map_err(|error| error.in_file(path))
}

/// Its boards.
///
/// # Errors
/// The file is none, or has no boards.
pub(crate) fn stored_boards(path: &Path) -> Result<Vec<Board>> {
    let boards: Vec<Board> = read_stored_pictures(path)?.boards.iter().map(BoardEntry::board).collect();
    if boards.is_empty() {
        let message = "found a calibration.json without boards, expected one that this version wrote";
        return Err(refuse(path, message.to_owned()));
    }
    Ok(boards)
}
