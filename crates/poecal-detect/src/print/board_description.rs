//! A board in words.

use super::decimal;
use crate::spec::{AprilGrid, BoardSpec, Charuco, Chessboard, Circles, Tags};

/// Description of a board: `ChArUco board, 5 columns by 7 rows of 36 mm squares, …`.
#[must_use]
pub fn describe_board(spec: &BoardSpec) -> String {
    let mm = |length_m: f64| decimal(length_m * 1e3, 3);
    match spec {
        BoardSpec::Chessboard(Chessboard { columns, rows, square_m }) => {
            format!("Chessboard, {columns} columns by {rows} rows of {} mm squares", mm(*square_m))
        }
        BoardSpec::Charuco(Charuco { columns, rows, square_m, marker_m, dictionary, legacy }) => {
            let (square, marker, name) = (mm(*square_m), mm(*marker_m), dictionary.name());
            let pattern = if *legacy { ", pattern of OpenCV before 4.6" } else { "" };
            format!(
                "ChArUco board, {columns} columns by {rows} rows of {square} mm squares, {marker} mm markers of {name}{pattern}"
            )
        }
        BoardSpec::Circles(Circles { columns, rows, pitch_m, asymmetric }) => {
            let (pitch, kind) = (mm(*pitch_m), if *asymmetric { "Asymmetric circle grid" } else { "Circle grid" });
            format!("{kind}, {columns} columns by {rows} rows of dots, {pitch} mm from row to row")
        }
        BoardSpec::Tags(Tags { dictionary, size_m }) => {
            format!("Tags of {}, {} mm from edge to edge of the black border", dictionary.name(), mm(*size_m))
        }
        BoardSpec::AprilGrid(AprilGrid { columns, rows, size_m, spacing, dictionary }) => {
            let (size, gap, name) = (mm(*size_m), mm(size_m * spacing), dictionary.name());
            format!("AprilGrid, {columns} columns by {rows} rows of {size} mm tags of {name}, {gap} mm apart")
        }
    }
}

/// Names of the board in other programs: OpenCV in functions that number its points as here, Kalibr in its target file.
pub(super) fn other_programs_names(spec: &BoardSpec) -> String {
    let mm = |length_m: f64| decimal(length_m * 1e3, 3);
    match spec {
        BoardSpec::Chessboard(Chessboard { columns, rows, .. }) => {
            format!("OpenCV: findChessboardCorners(picture, ({}, {}))", columns - 1, rows - 1)
        }
        BoardSpec::Charuco(Charuco { columns, rows, square_m, marker_m, dictionary, legacy }) => {
            let (square, marker, name) = (mm(*square_m), mm(*marker_m), dictionary.name());
            let then = if *legacy { ", then setLegacyPattern(True)" } else { "" };
            format!(
                "OpenCV: CharucoBoard(({columns}, {rows}), {square}, {marker}, getPredefinedDictionary({name})){then}"
            )
        }
        BoardSpec::Circles(Circles { columns, rows, asymmetric, .. }) => {
            let kind = if *asymmetric { "ASYMMETRIC" } else { "SYMMETRIC" };
            format!("OpenCV: findCirclesGrid(picture, ({columns}, {rows}), flags=CALIB_CB_{kind}_GRID)")
        }
        BoardSpec::Tags(Tags { dictionary, .. }) => {
            format!("OpenCV: ArucoDetector(getPredefinedDictionary({})).detectMarkers(picture)", dictionary.name())
        }
        BoardSpec::AprilGrid(AprilGrid { columns, rows, size_m, spacing, .. }) => {
            let size = decimal(*size_m, 6);
            format!(
                "Kalibr: target_type: aprilgrid, tagCols: {columns}, tagRows: {rows}, tagSize: {size}, tagSpacing: {spacing}"
            )
        }
    }
}

/// Lengths that a ruler must show on the print, and their end points, along x and along y.
pub(super) fn spans(spec: &BoardSpec) -> String {
    let [across, along] = spec.ruled_m().map(|it| decimal(it * 1e3, 2));
    match spec {
        BoardSpec::Chessboard(_) | BoardSpec::Charuco(_) => {
            format!("All squares together measure {across} mm by {along} mm")
        }
        BoardSpec::Circles(_) => format!("From the first to the last dot it is {across} mm by {along} mm"),
        BoardSpec::Tags(_) => format!("Each tag measures {across} mm by {along} mm"),
        BoardSpec::AprilGrid(_) => format!("All tags together measure {across} mm by {along} mm"),
    }
}

/// The same end points, as named by a refusal.
pub(super) fn ends(spec: &BoardSpec) -> &'static str {
    match spec {
        BoardSpec::Chessboard(_) | BoardSpec::Charuco(_) => {
            "from the outer edge of the first square to that of the last one"
        }
        BoardSpec::Circles(_) => {
            "from the left edge of the leftmost dot to that of the rightmost one, and likewise downwards"
        }
        BoardSpec::Tags(_) => "from edge to edge of the black border of one tag",
        BoardSpec::AprilGrid(_) => {
            "from the outer edge of the first tag to that of the last one, without the small squares"
        }
    }
}

/// Items whose side or distance is the length in the specification.
pub(super) fn unit(spec: &BoardSpec) -> &'static str {
    match spec {
        BoardSpec::Chessboard(_) | BoardSpec::Charuco(_) => "squares",
        BoardSpec::Circles(_) => "a pitch",
        BoardSpec::Tags(_) | BoardSpec::AprilGrid(_) => "tags",
    }
}
