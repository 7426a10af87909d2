//! Corners of tags in rendered pictures against the truth.

use poecal_detect::render::RandomScenes;
use poecal_detect::{BoardLayout, Detector, PointKind};

use crate::found::Tally;
use poecal_testing::trials::trials;

#[test]
fn corners_of_loose_tags() {
    let steep = RandomScenes { tilt_deg: [45.0, 60.0], ..RandomScenes::default() };
    for (spec, draw, limit_px) in [
        ("tags:36h11:50mm", RandomScenes { tilt_deg: [0.0, 45.0], ..RandomScenes::default() }, 0.06),
        ("tags:DICT_6X6_250:50mm", steep, 0.08),
    ] {
        let trials = trials(16).at_least(4);
        let tally = Tally::from_drawn_pictures(spec, &draw, trials.count);
        // A partly covered tag is not read, though some of its corners are visible.
        assert!(
            tally.part() >= 0.94 - trials.tolerance_factor(0.06) && tally.rms_px() <= limit_px && tally.farthest < 1.0
        );
        // 68 % of a normal error, within the scatter of 800 numbers, and the smallest sigma, which is a floor.
        assert!((0.60..0.78).contains(&tally.share_within()));
    }
}

#[test]
fn corners_of_kalibrs_grid() {
    let tally =
        Tally::from_drawn_pictures("aprilgrid:6x6:88mm:0.3", &RandomScenes::default(), trials(16).at_least(4).count);
    // As on a ChArUco board: two edges cross.
    assert!(tally.part() >= 0.97 && tally.rms_px() <= 0.06 && tally.farthest < 1.0);
    assert!((0.60..0.78).contains(&tally.share_within()));
}

#[test]
fn the_points_of_tags_are_those_of_opencv_and_kalibr() {
    let near = |place: [f64; 2], x: f64, y: f64| (place[0] - x).hypot(place[1] - y) < 1e-12;
    let loose = BoardLayout::new(&"tags:36h11:50mm".parse().unwrap()).points();
    println!("{:?}, {:?}", loose[48], loose[50]);
    // Upper left and lower right, from the middle, y upwards.
    assert!(loose[48].name == "tag12.0" && near(loose[48].place_m, -0.025, 0.025));
    assert!(loose[50].name == "tag12.2" && near(loose[50].place_m, 0.025, -0.025) && loose.len() == 4 * 587);
    let grid = BoardLayout::new(&"aprilgrid:6x5:88mm:0.3".parse().unwrap()).points();
    println!("{:?}, {:?}", grid[3], grid[29]);
    // Lower left of the first one, and upper right of the one above the second, a pitch of 1.3 sides on and up.
    assert!(grid[3].name == "tag0.3" && near(grid[3].place_m, 0.0, 0.0) && grid.len() == 120);
    assert!(grid[29].name == "tag7.1" && near(grid[29].place_m, 2.3 * 0.088, 2.3 * 0.088));
}

#[test]
fn names_of_tags_tell_the_corner() {
    let detector = Detector::new(&"tags:36h11:50mm".parse().unwrap());
    let drawn = RandomScenes { covered_each: 0, tilt_deg: [0.0, 20.0], ..RandomScenes::default() }.scene(
        detector.layout(),
        3,
        1,
    );
    let found = detector.detect(&drawn.picture).unwrap();
    let names: Vec<String> = found.corners.iter().take(5).map(poecal_detect::DetectedCorner::name).collect();
    println!("{names:?} of {} tags", found.markers);
    assert!(names == ["tag0.0", "tag0.1", "tag0.2", "tag0.3", "tag1.0"] && found.markers == 15);
    assert!(found.corners.iter().all(|it| it.kind == PointKind::Tag));
}
