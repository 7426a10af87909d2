//! A board in words.

use super::decimal;
use crate::spec::{Charuco, Chessboard, Spec};

/// What a board is, in words: `ChArUco board, 5 columns by 7 rows of 36 mm squares, …`.
#[must_use]
pub fn described(spec: &Spec) -> String {
    let mm = |length_m: f64| decimal(length_m * 1e3, 3);
    match spec {
        Spec::Chessboard(Chessboard { columns, rows, square_m }) => {
            format!("Chessboard, {columns} columns by {rows} rows of {} mm squares", mm(*square_m))
        }
        Spec::Charuco(Charuco { columns, rows, square_m, marker_m, dictionary, legacy }) => {
            let (square, marker, name) = (mm(*square_m), mm(*marker_m), dictionary.name());
            let pattern = if *legacy { ", pattern of OpenCV before 4.6" } else { "" };
            format!(
                "ChArUco board, {columns} columns by {rows} rows of {square} mm squares, {marker} mm markers of {name}{pattern}"
            )
        }
    }
}

/// How OpenCV names the board: in functions that number its corners as here.
pub(super) fn opencv(spec: &Spec) -> String {
    let mm = |length_m: f64| decimal(length_m * 1e3, 3);
    match spec {
        Spec::Chessboard(Chessboard { columns, rows, .. }) => {
            format!("OpenCV: findChessboardCorners(picture, ({}, {}))", columns - 1, rows - 1)
        }
        Spec::Charuco(Charuco { columns, rows, square_m, marker_m, dictionary, legacy }) => {
            let (square, marker, name) = (mm(*square_m), mm(*marker_m), dictionary.name());
            let then = if *legacy { ", then setLegacyPattern(True)" } else { "" };
            format!(
                "OpenCV: CharucoBoard(({columns}, {rows}), {square}, {marker}, getPredefinedDictionary({name})){then}"
            )
        }
    }
}
