//! `poecal detect`: pictures in, corners out, and an arm calibrated from them.

use std::fs;
use std::path::{Path, PathBuf};

use poecal_detect::render::{RandomGenerator, RandomScenes, RenderCamera, RenderScene};
use poecal_detect::{BoardLayout, Gray, preview};
use poecal_formats::urdf::ChainSelection;
use poecal_import::read_boards;
use poecal_model::camera::Board;
use poecal_model::simulate::{PictureSimulation, Simulation};
use poecal_results::model::Model;

use crate::folder::Folder;

const SPEC: &str = "charuco:7x5:36mm:26mm:DICT_4X4_50";

fn elbow() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/elbow/robot.urdf")
}

/// Pictures of a camera in the hand of an arm, rendered, with the readings of its joints; those from `moved` on with the board 20 mm elsewhere.
fn session(folder: &Folder, count: usize, moved: usize) {
    session_of(folder, (SPEC, Board::chessboard("board", [7, 5], 0.036).unwrap()), count, moved);
}

/// The same session with another board, drawn by its words; the arm points at its points.
fn session_of(folder: &Folder, (spec, board): (&str, Board), count: usize, moved: usize) {
    let model = Model::read(elbow(), &ChainSelection::default()).unwrap();
    let lens = poecal_model::camera::Lens {
        size_px: Some([960, 600]),
        ..poecal_model::camera::Lens::pinhole([800.0; 2], [479.5, 299.5])
    };
    let session =
        Simulation { count, seed: 7, error_rotation_rad: 3e-3, error_position_m: 1e-3, ..Simulation::default() };
    let simulated = PictureSimulation {
        lens,
        board,
        distance_m: [0.35, 0.5],
        ..PictureSimulation::with_usual_camera(session, true)
    };
    let made = simulated.run(&model.robot).unwrap();
    let layout = BoardLayout::new(&spec.parse().unwrap());
    let camera =
        RenderCamera { size: [960, 600], focal_px: lens.focal_px, centre_px: lens.centre_px, distortion: [0.0; 2] };
    let names = made.data.reading_names().join("[rad],");
    let mut table = format!("image,{names}[rad]\n");
    fs::create_dir(folder.path("pictures")).unwrap();
    let mut random = RandomGenerator::new(5);
    for at in 0..made.data.len() {
        let readings = made.data.readings(at);
        let along = if at >= moved { 0.02 } else { 0.0 };
        let shift = poecal_arm::lie::Pose::from_xyz_rpy([along, 0.0, 0.0], [0.0; 3]);
        let held = made.actual.forward_kinematics(readings) * made.tip_from_held;
        let pose = held.inverse() * made.base_from_other * shift;
        let scene = RenderScene {
            camera,
            rotation: pose.rotation,
            translation_m: pose.translation,
            levels: [40.0, 205.0],
            gradient: [0.1, -0.05],
            blur_px: 0.8,
            noise: 2.0,
            patch: None,
        };
        let gray = scene.render(&layout, &Gray::new(960, 600, vec![120.0; 960 * 600]).unwrap(), &mut random);
        let name = format!("{at}.png");
        fs::write(folder.path("pictures").join(&name), preview(&gray, &[]).unwrap()).unwrap();
        let values: Vec<String> = readings.iter().map(|it| format!("{it:.9}")).collect();
        table.push_str(&format!("{name},{}\n", values.join(",")));
    }
    folder.write("joints.csv", table);
    folder.write("lens.csv", "name,fx,fy,cx,cy,width,height\ncamera,800,800,479.5,299.5,960,600\n");
    fs::copy(elbow(), folder.path("robot.urdf")).unwrap();
}

#[test]
fn pictures_calibrate_an_arm_in_three_commands() {
    let folder = Folder::new();
    session(&folder, 30, usize::MAX);
    let found = folder.run(&format!("detect pictures --board {SPEC} --out corners.csv --preview seen"));
    assert_eq!(found.code, 0, "{}", found.err);
    println!("{}", found.err);
    assert!(found.err.contains(" corners in 30 of 30 pictures"), "{}", found.err);
    let corners = folder.read("corners.csv");
    assert!(corners.lines().nth(1).unwrap() == "image,target,u[px],v[px],sigma[px]");
    assert!(corners.contains("\n10.png,corner0,") && corners.find("\n9.png") < corners.find("\n10.png"));
    assert!(fs::read(folder.path("seen/0.png")).unwrap().starts_with(b"\x89PNG"));
    let words = format!(
        "calibrate robot.urdf joints.csv corners.csv --camera lens.csv --markers {SPEC} --out results --verbose"
    );
    let out = folder.run_to_success(&words);
    let line = out.lines().find(|line| line.starts_with("held out")).unwrap();
    println!("{line}");
    let px: f64 = line.split_whitespace().nth(4).unwrap().parse().unwrap();
    // Rendered corners have errors of 0.05 px by themselves, and 21 pictures determine the arm to about as much more.
    assert!(line.contains("pictures") && px < 0.3, "{line}");
    folder.run_to_success("report results/calibration.json --out again.html");
    // With an unknown lens: the same with the size of the pictures alone.
    let words = words.replace("lens.csv", "unknown:960x600").replace("results", "unknown");
    let out = folder.run_to_success(&words);
    let line = out.lines().find(|line| line.starts_with("found")).unwrap();
    println!("{line}");
    let focal: f64 = line.split("-> ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((focal - 800.0).abs() < 3.0, "{line}");
}

#[test]
fn a_board_in_a_file_is_the_one_in_words() {
    let folder = Folder::new();
    session(&folder, 2, usize::MAX);
    let board = "target_finder:\n  type: CharucoGridTargetFinder\n  cols: 7\n  rows: 5\n  chessboard_dim: 0.036\n  aruco_marker_dim: 0.026\n  \
                 dictionary: DICT_4X4_50\ndata:\n  - image: 0.png\n    pose: 0.yaml\n";
    folder.write("cal_data.yaml", board);
    let stated = folder.run(&format!("detect pictures --board {SPEC} --out stated.csv"));
    let read = folder.run("detect pictures --board cal_data.yaml --out read.csv");
    assert_eq!((stated.code, read.code), (0, 0), "{} {}", stated.err, read.err);
    println!("{}", read.err);
    assert!(read.err.contains(&format!("cal_data.yaml: read the board `{SPEC}` (industrial_calibration)")));
    assert_eq!(folder.read("read.csv"), folder.read("stated.csv"));
    let refused = folder
        .run(&format!("calibrate robot.urdf cal_data.yaml --camera lens.csv --markers {SPEC} --out results --verbose"));
    println!("{}", refused.err);
    assert!(refused.code == 2 && refused.err.contains("expected the joint readings of each picture"));
    assert!(!folder.path("results").exists());
}

/// The root mean square error of a calibration's held-out pictures, pixels.
fn held_out_px(out: &str) -> f64 {
    let line = out.lines().find(|line| line.starts_with("held out")).unwrap();
    println!("{line}");
    line.split_whitespace().nth(4).unwrap().parse().unwrap()
}

#[test]
fn grids_of_dots_and_of_tags_calibrate_an_arm() {
    for (spec, board) in [
        ("circles:4x7:26mm:asymmetric", Board::circles("board", [4, 7], 0.026, true).unwrap()),
        ("aprilgrid:3x2:60mm:0.3", Board::april_grid("board", [3, 2], 0.06, 0.3).unwrap()),
    ] {
        let folder = Folder::new();
        session_of(&folder, (spec, board), 24, usize::MAX);
        let found = folder.run(&format!("detect pictures --board {spec} --out corners.csv"));
        assert_eq!(found.code, 0, "{}", found.err);
        println!("{}", found.err);
        // A grid that the border of a picture cuts is left out.
        let pictures: usize =
            found.err.split(" of 24 pictures, to").next().unwrap().rsplit(' ').next().unwrap().parse().unwrap();
        assert!(pictures >= 20, "{}", found.err);
        let words = format!(
            "calibrate robot.urdf joints.csv corners.csv --camera lens.csv --markers {spec} --out results --verbose"
        );
        assert!(held_out_px(&folder.run_to_success(&words)) < 0.3, "{spec}");
    }
}

#[test]
fn loose_tags_calibrate_an_arm_each_at_a_place_of_its_own() {
    let folder = Folder::new();
    let spec = "tags:36h11:25mm";
    session_of(&folder, (spec, Board::chessboard("board", [10, 7], 0.025).unwrap()), 42, usize::MAX);
    folder.run_to_success(&format!("detect pictures --board {spec} --out corners.csv"));
    assert!(folder.read("corners.csv").contains("\n0.png,tag7.3,"));
    let words = format!(
        "calibrate robot.urdf joints.csv corners.csv --camera lens.csv --markers {spec} --out results --verbose"
    );
    assert!(held_out_px(&folder.run_to_success(&words)) < 0.5);
}

#[test]
fn the_table_has_the_points_where_they_are() {
    let camera =
        RenderCamera { size: [960, 600], focal_px: [800.0; 2], centre_px: [479.5, 299.5], distortion: [-0.1, 0.0] };
    let draw = RandomScenes {
        camera,
        square_px: [38.0, 42.0],
        tilt_deg: [0.0, 40.0],
        covered_each: 0,
        ..RandomScenes::default()
    };
    for spec in ["circles:9x6:30mm", "circles:4x7:20mm:asymmetric", "aprilgrid:4x3:40mm:0.3", "tags:36h11:50mm"] {
        let layout = BoardLayout::new(&spec.parse().unwrap());
        let drawn = draw.scene(&layout, 3, 2);
        let folder = Folder::new();
        fs::write(folder.path("one.png"), preview(&drawn.picture, &[]).unwrap()).unwrap();
        folder.run_to_success(&format!("detect one.png --board {spec} --out corners.csv"));
        let table = folder.read("corners.csv");
        // Grids of dots that look the same turned may begin at their other end.
        let last = drawn.truth.len() - 1;
        let names: Vec<String> = layout.points().into_iter().map(|it| it.name).collect();
        let off = |turn: bool| {
            let rows = table.lines().skip(2).map(|row| row.split(',').collect::<Vec<_>>());
            let offs = rows.map(|cells| {
                let id = names.iter().position(|it| it == cells[1]).unwrap();
                let truth = drawn.truth[if turn { last - id } else { id }].place_px;
                let at = [cells[2], cells[3]].map(|it| it.parse::<f64>().unwrap());
                (at[0] - truth.x).hypot(at[1] - truth.y)
            });
            offs.fold((0, 0.0_f64), |(count, most), it| (count + 1, most.max(it)))
        };
        let (count, most) =
            if spec == "circles:9x6:30mm" && off(true).1 < off(false).1 { off(true) } else { off(false) };
        println!("{spec}: {count} of {} points, at most {most:.3} px off", drawn.truth.len());
        assert!(count * 10 >= 9 * drawn.truth.iter().filter(|it| it.visible).count() && most < 0.5, "{spec}");
    }
}

#[test]
fn both_programs_have_the_points_of_a_board_at_the_same_places() {
    for spec in [
        "chessboard:10x7:27mm",
        "charuco:5x7:36mm:18mm:DICT_6X6_250",
        "circles:9x6:30mm",
        "circles:4x11:20mm:asymmetric",
        "aprilgrid:6x5:88mm:0.3",
    ] {
        let points = BoardLayout::new(&spec.parse().unwrap()).points();
        let board = read_boards(spec).unwrap().remove(0);
        assert_eq!(points.iter().map(|it| &it.name).collect::<Vec<_>>(), board.names.iter().collect::<Vec<_>>());
        for (one, other) in points.iter().zip(&board.points) {
            let off = (one.place_m[0] - other.x).hypot(one.place_m[1] - other.y);
            assert!(off < 1e-12, "{spec}: {} is {off} m off", one.name);
        }
    }
    // With loose tags each is a board of its own.
    let tag = read_boards("tags:36h11:50mm").unwrap().remove(0);
    let points = BoardLayout::new(&"tags:36h11:50mm".parse().unwrap()).points();
    for (one, (name, other)) in points[48..52].iter().zip(tag.names.iter().zip(&tag.points)) {
        assert_eq!(one.name, format!("tag12.{name}"));
        assert!((one.place_m[0] - other.x).hypot(one.place_m[1] - other.y) < 1e-12);
    }
}

#[test]
fn a_board_that_moved_once_is_named() {
    let folder = Folder::new();
    session(&folder, 30, 17);
    folder.run_to_success(&format!("detect pictures --board {SPEC} --out corners.csv"));
    let words = format!(
        "calibrate robot.urdf joints.csv corners.csv --camera lens.csv --markers {SPEC} --out results --verbose"
    );
    let run = folder.run(&words);
    println!("{}", run.out);
    assert!(run.out.contains("moved") && run.out.contains("20.") || run.out.contains("19."), "{}", run.out);
}

/// The board that a message names instead of a wrong one is found with the new words.
#[test]
fn the_board_that_a_message_names_is_found() {
    let folder = Folder::new();
    session(&folder, 4, usize::MAX);
    for wrong in ["charuco:5x7:36mm:26mm:DICT_4X4_50", "charuco:7x5:36mm:26mm:DICT_6X6_250", "tags:36h11:30mm"] {
        let said = folder.run(&format!("detect pictures --board {wrong} --out c.csv --force"));
        let (_, named) = said.err.split_once("take --board ").unwrap_or_else(|| panic!("{}", said.err));
        let taken = folder.run(&format!("detect pictures --board {} --out c.csv --force", named.trim_end()));
        assert!(said.code == 2 && taken.code == 0, "{}{}", said.err, taken.err);
        assert!(folder.read("c.csv").lines().count() > 40, "{}", taken.err);
    }
}

#[test]
fn what_is_wrong_with_pictures_is_said_in_one_line_and_nothing_is_written() {
    let folder = Folder::new();
    session(&folder, 12, usize::MAX);
    let copied = |from: &str, to: &str| {
        fs::create_dir_all(folder.path(to).parent().unwrap()).unwrap();
        fs::copy(folder.path(from), folder.path(to)).unwrap();
    };
    fs::create_dir(folder.path("empty")).unwrap();
    folder.write("text.png", "no picture");
    copied("pictures/0.png", "other/0.png");
    let gray = Gray::new(320, 200, vec![90.0; 320 * 200]).unwrap();
    fs::write(folder.path("small.png"), preview(&gray, &[]).unwrap()).unwrap();
    let before = folder.listing();
    for (words, said) in [
        (
            "detect empty --board BOARD --out c.csv",
            "found no picture in this folder, expected files that end in .png, .jpg or .jpeg",
        ),
        ("detect gone.png --board BOARD --out c.csv", "gone.png: cannot be read"),
        ("detect text.png --board BOARD --out c.csv", "text.png: found no picture, expected PNG or JPEG"),
        ("detect small.png --board BOARD --out c.csv", "in none of 1 picture (small.png: "),
        ("detect small.png pictures --board BOARD --out c.csv", "expected one size of all pictures of a camera"),
        ("detect pictures other/0.png --board BOARD --out c.csv", "found two pictures with the name `0.png`"),
        (
            "detect pictures --board charuco:5x7:36mm:26mm:DICT_4X4_50 --out c.csv",
            "take --board charuco:7x5:36mm:26mm:DICT_4X4_50",
        ),
        (
            "detect pictures --board charuco:7x5:36mm:26mm:DICT_6X6_250 --out c.csv",
            "take --board charuco:7x5:36mm:26mm:DICT_4X4",
        ),
        ("detect pictures --board 7x5 --out c.csv", "expected chessboard:COLSxROWS:SQUARE"),
        ("detect pictures --board charuco:7x5:36:26mm:DICT_4X4_50 --out c.csv", "unit"),
        (
            "detect pictures --board circles:9x6:30mm --out c.csv",
            "of the other kind, or with one dot more or fewer each way: check the board",
        ),
        ("detect pictures --board tags:36h11:30mm --out c.csv", "take --board tags:DICT_4X4_50:30mm"),
        ("detect pictures --board aprilgrid:6x6:88mm --out c.csv", "expected aprilgrid:COLSxROWS:SIZE:SPACING"),
    ] {
        let run = folder.run(&words.replace("BOARD", SPEC));
        println!("{}", run.err);
        assert!(run.code == 2 && run.err.contains(said), "{words}: {}", run.err);
        assert_eq!(run.err.trim_end().lines().count(), 1, "{}", run.err);
    }
    assert_eq!(folder.listing(), before);
}
