//! Dots of rendered pictures against the truth.

use poecal_detect::render::RandomScenes;
use poecal_detect::{BoardLayout, Detector, PointKind};

use crate::found::Tally;
use poecal_testing::trials::trials;

/// Scatter of the share of the detected dots of a picture: a grid with too much covered is not found.
const MISSED: f64 = 0.15;

#[test]
fn middles_of_dots_at_all_tilts() {
    let draw = |low: f64, high: f64| RandomScenes { tilt_deg: [low, high], ..RandomScenes::default() };
    for (low, high) in [(0.0, 30.0), (45.0, 60.0)] {
        let trials = trials(12).at_least(3);
        let tally = Tally::from_drawn_pictures("circles:9x6:30mm", &draw(low, high), trials.count);
        // OpenCV finds 71 % of such pictures, with 0.035 px below 30° and 0.114 px above 45°, since the middle of an ellipse is biased.
        assert!(
            tally.part() >= 0.97 - trials.tolerance_factor(MISSED) && tally.rms_px() <= 0.05 && tally.farthest < 1.0
        );
    }
}

#[test]
fn dots_of_an_asymmetric_grid() {
    let draw = RandomScenes { square_px: [28.0, 78.0], ..RandomScenes::default() };
    let trials = trials(16).at_least(4);
    let tally = Tally::from_drawn_pictures("circles:4x11:20mm:asymmetric", &draw, trials.count);
    assert!(tally.part() >= 0.96 - trials.tolerance_factor(MISSED) && tally.rms_px() <= 0.05 && tally.farthest < 1.0);
    // 68 % of a normal error, within the scatter of 1000 numbers, and the smallest sigma, which is a floor.
    assert!((0.60..0.78).contains(&tally.share_within()));
}

#[test]
fn the_points_of_grids_are_those_of_opencv() {
    let points = |spec: &str| BoardLayout::new(&spec.parse().unwrap()).points();
    let symmetric = points("circles:5x4:10mm");
    let asymmetric = points("circles:4x11:20mm:asymmetric");
    println!("{:?}, {:?}", symmetric[6], asymmetric[5]);
    let near = |place: [f64; 2], x: f64, y: f64| (place[0] - x).hypot(place[1] - y) < 1e-12;
    assert!(symmetric.len() == 20 && symmetric[6].name == "dot6" && near(symmetric[6].place_m, 0.01, 0.01));
    // The second of the second row: (2 · 1 + 1, 1) pitches.
    assert!(asymmetric.len() == 44 && near(asymmetric[5].place_m, 0.06, 0.02));
    let detector = Detector::new(&"circles:5x4:10mm".parse().unwrap());
    let drawn = RandomScenes { covered_each: 0, ..RandomScenes::default() }.scene(detector.layout(), 3, 1);
    let found = detector.detect(&drawn.picture).unwrap();
    assert!(found.corners.iter().all(|it| it.kind == PointKind::Dot) && found.corners[1].name() == "dot1");
}
