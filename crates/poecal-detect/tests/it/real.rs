//! Real pictures, in the folder that POECAL_DATASETS names, compared with the corners of OpenCV.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use poecal_detect::{Detector, GrayPicture};

/// Corners by their picture: number, column, row.
type Known = BTreeMap<String, Vec<(usize, f64, f64)>>;

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("POECAL_DATASETS").map(PathBuf::from);
    if folder.is_none() {
        println!("skipped: POECAL_DATASETS is not set, expected the folder that holds handeye_images");
    }
    folder
}

/// Reads a table by the columns of the picture, the corner, u and v.
fn read_known(file: &Path, [picture, corner, u, v]: [&str; 4]) -> Known {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let [picture, corner, u, v] = [picture, corner, u, v].map(|it| names.iter().position(|name| *name == it).unwrap());
    let session = names.iter().position(|name| *name == "session");
    let mut known = Known::new();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let id = fields[corner].trim_start_matches("corner").parse().unwrap();
        let (Ok(u), Ok(v)) = (fields[u].parse(), fields[v].parse()) else { continue };
        let name = session.map_or(String::new(), |at| format!("{}/", fields[at])) + fields[picture];
        known.entry(name).or_default().push((id, u, v));
    }
    known
}

/// Number of known corners that were found, number of all, and RMS distance of those that agree within a pixel.
fn compare_corners(detector: &Detector, known: &Known, picture: impl Fn(&str) -> PathBuf) -> (usize, usize, f64) {
    let (mut both, mut all, mut squares, mut near) = (0, 0, 0.0, 0);
    for (name, own) in known {
        let gray = GrayPicture::open(&picture(name)).unwrap().gray;
        let found = match detector.detect(&gray) {
            Ok(found) => found,
            Err(reason) => {
                println!("{name}: {reason}");
                continue;
            }
        };
        all += found.corners.len();
        for corner in &found.corners {
            let Some((_, u, v)) = own.iter().find(|it| it.0 == corner.id) else { continue };
            let off = (u - corner.u_px).hypot(v - corner.v_px);
            both += 1;
            if off < 1.0 {
                squares += off * off;
                near += 1;
            } else {
                println!("{name}: corner {} is off by {off:.2} px", corner.id);
            }
        }
    }
    let total: usize = known.values().map(Vec::len).sum();
    let rms_px = (squares / f64::from(near)).sqrt();
    println!("{both} of {total} known corners, {all} in all, {near} of them near, RMS {rms_px:.3} px");
    (both, all, rms_px)
}

#[test]
#[ignore = "needs the data sets: set POECAL_DATASETS"]
fn the_charuco_board_before_a_fixed_camera() {
    let Some(folder) = folder() else { return };
    let folder = folder.join("handeye_images/charuco_static_camera");
    let known = read_known(&folder.join("corners.csv"), ["image", "corner_id", "u_px", "v_px"]);
    let detector = Detector::new(&"charuco:5x7:36.195mm:18.256mm:DICT_6X6_250".parse().unwrap());
    let (both, all, rms_px) = compare_corners(&detector, &known, |name| folder.join("images_gray_jpeg").join(name));
    // OpenCV has 294; both are off by some 0.07 px because of each other's windows.
    assert!(both >= 280 && all >= 370 && rms_px < 0.15);
}

#[test]
#[ignore = "needs the data sets: set POECAL_DATASETS"]
fn the_dots_before_a_camera_on_an_arm() {
    let Some(folder) = folder() else { return };
    let folder = folder.join("handeye_images/circlegrid_eye_in_hand");
    let known = read_known(&folder.join("corners.csv"), ["image", "corner_id", "u_px", "v_px"]);
    let detector = Detector::new(&"circles:10x10:25.4mm".parse().unwrap());
    let (mut both, mut squares, mut near) = (0, 0.0, 0);
    for (name, own) in &known {
        let gray = GrayPicture::open(&folder.join("images").join(name)).unwrap().gray;
        let Ok(found) = detector.detect(&gray) else { continue };
        // A square grid looks the same at each quarter turn; the known rows count upwards.
        let turned = |id: usize, turns: usize| {
            let (x, y) = (0..turns).fold((9 - id % 10, id / 10), |(x, y), _| (y, 9 - x));
            own.iter().find(|it| it.0 == y * 10 + x)
        };
        let offs = |turns: usize| -> Vec<f64> {
            let off = |it: &poecal_detect::DetectedCorner| {
                let (_, u, v) = turned(it.id, turns)?;
                Some((u - it.u_px).hypot(v - it.v_px))
            };
            found.corners.iter().filter_map(off).collect()
        };
        let sum = |turns: &usize| offs(*turns).iter().sum::<f64>();
        let best = (0..4).min_by(|a, b| sum(a).total_cmp(&sum(b))).unwrap();
        let offs = offs(best);
        both += offs.len();
        squares += offs.iter().filter(|it| **it < 1.0).map(|it| it * it).sum::<f64>();
        near += offs.iter().filter(|it| **it < 1.0).count();
    }
    let rms_px = (squares / near as f64).sqrt();
    println!("{both} of 1300 known dots, {near} of them near, RMS {rms_px:.3} px");
    // The first dot is twice as large as the others, and left out. The known ones are middles of ellipses: 0.08 px was observed, up to 0.15 px in
    // pictures with glossy dots.
    assert!(both >= 1235 && near + 5 >= both && rms_px < 0.15);
}

#[test]
#[ignore = "needs the data sets: set POECAL_DATASETS"]
fn the_chessboards_before_two_arms() {
    let Some(folder) = folder() else { return };
    let detector = Detector::new(&"chessboard:10x7:27mm".parse().unwrap());
    for (set, least) in [("ur10e_eye_in_hand", 1240), ("ur3e_eye_in_hand", 1500)] {
        let folder = folder.join(set);
        let known = read_known(&folder.join("pixels.csv"), ["image", "target", "u_subpix[px]", "v_subpix[px]"]);
        let (both, _, rms_px) = compare_corners(&detector, &known, |name| {
            folder.join("images").join(name.replace("ur10e/", "measurements-2023-02-07/"))
        });
        // Observed: 0.09 and 0.11 px. OpenCV's corners scatter by 0.10 and 0.07 px about a smooth map, ours by 0.09 and 0.04.
        assert!(both >= least && rms_px < 0.15);
    }
}
