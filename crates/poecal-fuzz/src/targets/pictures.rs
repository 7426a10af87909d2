//! Files that accompany pictures: of cameras and of boards, and messages of robot_calibration.

use std::collections::BTreeSet;

use nalgebra::{Vector2, Vector3};
use poecal_import::{MeasurementFile, ReadOptions, board_of_file, parse, read_boards, read_cameras};
use poecal_model::camera::{Board, Camera, Lens};
use poecal_model::simulate::elbow;

use crate::one_file::with_file;
use crate::properties::{PATH, certain, check_result, one_line, text};

/// The path of an input whose first line is the ending of its name, and its text.
fn file<'a>(text: &'a str, endings: &[&str]) -> Option<(String, &'a str)> {
    let (ending, rest) = text.split_once('\n')?;
    endings.contains(&ending).then(|| (format!("{PATH}.{ending}"), rest))
}

/// A line with the ending of the name (`yaml`, `json`, `xml`, `dat`, `csv`), and the file: its cameras have lenses that map points.
pub fn cameras(data: &[u8]) -> bool {
    let Some(whole) = text(data) else { return false };
    let Some((path, text)) = file(&whole, &["yaml", "json", "xml", "dat", "csv"]) else { return false };
    let read = || with_file(&path, text, || read_cameras(&path).map(|it| it.cameras));
    let Some(cameras) = check_result(read(), text) else { return false };
    let again = certain(read(), "a second time");
    assert_eq!(format!("{cameras:?}"), format!("{again:?}"));
    let names: BTreeSet<&str> = cameras.iter().map(|it| it.name.as_str()).collect();
    assert!(!cameras.is_empty() && names.len() == cameras.len(), "{names:?}");
    cameras.iter().for_each(|it| maps(&it.lens));
    true
}

/// Asserts that the numbers of a lens are finite, and its pixels and rays valid.
fn maps(lens: &Lens) {
    assert!(lens.numbers().iter().all(|it| it.is_finite()), "{lens:?}");
    assert!(lens.focal_px.iter().all(|it| *it > 0.0), "{lens:?}");
    for [x, y] in [[0.0, 0.0], [0.1, -0.2], [-0.7, 0.4], [3.0, 1.0]] {
        let pixel = lens.pixel(&Vector3::new(x, y, 1.0));
        assert!(pixel.is_none_or(|it| !it.x.is_nan() && !it.y.is_nan()), "{lens:?}: {pixel:?}");
        let [cx, cy] = lens.centre_px;
        let ray = lens.ray(&Vector2::new(cx + x * lens.focal(), cy + y * lens.focal()));
        assert!(ray.is_none_or(|it| (it.norm() - 1.0).abs() < 1e-9), "{lens:?}: {ray:?}");
    }
}

/// A line with the ending of the name, and a file of boards: each has points with names, and an equivalent description.
pub fn boards(data: &[u8]) -> bool {
    let Some(whole) = text(data) else { return false };
    let Some((path, text)) = file(&whole, &["yaml", "xml", "csv"]) else { return false };
    let Some(boards) = check_result(with_file(&path, text, || read_boards(&path)), text) else {
        return false;
    };
    assert!(!boards.is_empty());
    boards.iter().for_each(are_points);
    if let Some(stated) = certain(with_file(&path, text, || board_of_file(&path)), "its words") {
        one_line(&stated.said);
        assert_eq!(certain(read_boards(&stated.words), &stated.words), boards);
    }
    true
}

fn are_points(board: &Board) {
    let names: BTreeSet<&String> = board.names.iter().collect();
    assert!(names.len() == board.points.len() && board.names.len() == board.points.len(), "{board:?}");
    assert!(!board.points.is_empty() && board.points.iter().all(|it| it.iter().all(|it| it.is_finite())));
}

/// Messages of robot_calibration, with a stated lens and board for those that state no lens.
pub fn messages(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let mut options = ReadOptions::default();
    if !text.contains("camera_info") {
        let lens = Lens::pinhole([1400.0, 1400.0], [960.0, 600.0]);
        options.cameras = vec![Camera::new(String::new(), lens)];
        options.boards = certain(read_boards("chessboard:6x5:40mm"), "the stated board");
    }
    // Other YAML is refused, and text without an ending may be a table.
    let path = format!("{PATH}.yaml");
    let robot = elbow();
    let read = || parse(&text, &path, &robot, &options);
    let Some(file) = check_result(read(), &text) else { return false };
    assert_sound(&file, &text);
    assert_eq!(file.data.all_readings(), certain(read(), "a second time").data.all_readings());
    file.data.pictures.cameras.iter().for_each(|it| maps(&it.lens));
    file.data.pictures.boards.iter().for_each(are_points);
    true
}

/// Asserts that the data are consistent and belong to the text: each row is a picture.
fn assert_sound(file: &MeasurementFile, text: &str) {
    certain(file.data.check(), "data");
    file.warnings.iter().for_each(|warning| one_line(warning));
    assert!(!file.data.is_empty() && file.data.pictures.all.len() == file.data.len());
    let lines = text.split(['\n', '\r']).count();
    assert!(file.data.observations.iter().all(|row| (1..=lines).contains(&(row.source.line as usize))));
    assert!(file.data.all_readings().iter().all(|reading| reading.abs() <= 1e6));
    let pictures = &file.data.pictures;
    let has_points =
        |board: usize, point: u32| pictures.boards.get(board).is_some_and(|it| (point as usize) < it.points.len());
    for picture in &pictures.all {
        assert!(picture.camera < pictures.cameras.len() && !picture.corners.is_empty());
        assert!(picture.corners.iter().all(|it| has_points(picture.board, it.point)));
    }
}
