//! `poecal detect`: pictures in, corners out, and an arm calibrated from them.

use std::fs;
use std::path::{Path, PathBuf};

use poecal::camera::Board;
use poecal::io::model::Model;
use poecal::io::urdf::ChainSelection;
use poecal::simulate::{PictureSimulation, Simulation};
use poecal_detect::render::{Camera, Random, Scene};
use poecal_detect::{Gray, Layout, preview};

use crate::folder::Folder;

const SPEC: &str = "charuco:7x5:36mm:26mm:DICT_4X4_50";

fn elbow() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/elbow/robot.urdf")
}

/// Pictures of a camera in the hand of an arm, rendered, with the readings of its joints; those from `moved` on with the board 20 mm elsewhere.
fn session(folder: &Folder, count: usize, moved: usize) {
    let model = Model::read(elbow(), &ChainSelection::default()).unwrap();
    let lens = poecal::camera::Lens {
        size_px: Some([960, 600]),
        ..poecal::camera::Lens::pinhole([800.0; 2], [479.5, 299.5])
    };
    let session = Simulation {
        count,
        seed: 7,
        error_rotation_rad: 3e-3,
        error_position_m: 1e-3,
        ..Simulation::default()
    };
    let board = Board::chessboard("board", [7, 5], 0.036).unwrap();
    let simulated =
        PictureSimulation { lens, board, distance_m: [0.35, 0.5], ..PictureSimulation::usual(session, true) };
    let made = simulated.run(&model.robot).unwrap();
    let layout = Layout::new(&SPEC.parse().unwrap());
    let camera =
        Camera { size: [960, 600], focal_px: lens.focal_px, centre_px: lens.centre_px, distortion: [0.0; 2] };
    let names = made.data.reading_names().join("[rad],");
    let mut table = format!("image,{names}[rad]\n");
    fs::create_dir(folder.path("pictures")).unwrap();
    let mut random = Random::new(5);
    for at in 0..made.data.len() {
        let readings = made.data.readings(at);
        let along = if at >= moved { 0.02 } else { 0.0 };
        let shift = poecal::lie::Pose::from_xyz_rpy([along, 0.0, 0.0], [0.0; 3]);
        let held = made.actual.forward_kinematics(readings) * made.tip_from_held;
        let pose = held.inverse() * made.base_from_other * shift;
        let scene = Scene {
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
        "calibrate robot.urdf joints.csv corners.csv --camera lens.csv --markers {SPEC} --out results"
    );
    let out = folder.done(&words);
    let line = out.lines().find(|line| line.starts_with("held out")).unwrap();
    println!("{line}");
    let px: f64 = line.split_whitespace().nth(4).unwrap().parse().unwrap();
    // Rendered corners are 0.05 px off by themselves, and 21 pictures determine the arm to about as much more.
    assert!(line.contains("pictures") && px < 0.3, "{line}");
    folder.done("report results/calibration.json --out again.html");
    // The lens unknown: the same with the size of the pictures alone.
    let words = words.replace("lens.csv", "unknown:960x600").replace("results", "unknown");
    let out = folder.done(&words);
    let line = out.lines().find(|line| line.starts_with("found")).unwrap();
    println!("{line}");
    let focal: f64 = line.split("-> ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((focal - 800.0).abs() < 3.0, "{line}");
}

#[test]
fn a_board_that_moved_once_is_named() {
    let folder = Folder::new();
    session(&folder, 30, 17);
    folder.done(&format!("detect pictures --board {SPEC} --out corners.csv"));
    let words = format!(
        "calibrate robot.urdf joints.csv corners.csv --camera lens.csv --markers {SPEC} --out results"
    );
    let run = folder.run(&words);
    println!("{}", run.out);
    assert!(run.out.contains("moved") && run.out.contains("20.") || run.out.contains("19."), "{}", run.out);
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
        (
            "detect small.png pictures --board BOARD --out c.csv",
            "expected one size of all pictures of a camera",
        ),
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
    ] {
        let run = folder.run(&words.replace("BOARD", SPEC));
        println!("{}", run.err);
        assert!(run.code == 2 && run.err.contains(said), "{words}: {}", run.err);
        assert_eq!(run.err.trim_end().lines().count(), 1, "{}", run.err);
    }
    assert_eq!(folder.listing(), before);
}
