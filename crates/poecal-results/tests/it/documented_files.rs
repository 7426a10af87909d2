//! The examples of docs/file-formats.md are read as the text states, and its statements on results hold for written files.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw};
use poecal_calibrate::{CalibrationOptions, calibrate};
use poecal_formats::proof::Difference;
use poecal_formats::robot_toml;
use poecal_formats::urdf::UrdfDocument;
use poecal_import::{ColumnMap, DecimalSign, MeasurementFile, ReadOptions, read};
use poecal_model::measurement::Set;
use poecal_model::robot::{Joint, Robot};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::residuals::Residuals;
use poecal_testing::files::Folder;

const DOCUMENT: &str = include_str!("../../../../docs/file-formats.md");
const UR10_MAP: &str = include_str!("../../../../validation/ur10_raw_columns.toml");

/// A section's blocks of one language, in order.
fn blocks(section: &str, language: &str) -> Vec<&'static str> {
    let title = format!("{section}\n");
    let section = DOCUMENT.split("\n## ").find(|section| section.starts_with(&title)).unwrap();
    let fence = format!("```{language}\n");
    section.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap()).collect()
}

fn read_block(block: usize, map: Option<&str>, rail: bool) -> MeasurementFile {
    let folder = Folder::new();
    let path = folder.write("points.csv", blocks("Measurements", "text")[block]);
    let z = Screw::revolute(&Vector3::z(), &Vector3::zeros());
    let mut joints = vec![Joint::revolute("joint1", z), Joint::revolute("joint2", z)];
    if rail {
        joints.push(Joint::prismatic("rail", Screw::prismatic(&Vector3::x())));
    }
    let robot = Robot::new("documented", joints, Pose::from_translation(Vector3::x())).unwrap();
    let mapping = map.map(|text| ColumnMap::parse(text, "map.toml").unwrap());
    read(&[path], &robot, &ReadOptions { mapping, ..ReadOptions::default() }).unwrap()
}

#[test]
fn the_first_example_is_of_our_own_form() {
    let file = read_block(0, None, false);
    assert_eq!(file.data.readings(1), [-3.0_f64.to_radians(), 15.25_f64.to_radians()]);
    let sets: Vec<_> = file.data.observations.iter().filter_map(|row| row.set).collect();
    assert_eq!(sets, [Set::Fit, Set::HeldOut]);
    assert!(file.warnings.is_empty());
}

#[test]
fn the_trackers_export_gives_a_pose() {
    let file = read_block(1, Some(blocks("Measurements", "toml")[0]), false);
    assert_eq!(file.understood[0].decimal_sign, DecimalSign::Comma);
    let [x, _, _, _] = file.data.observations[0].measurement.pose().quaternion_xyzw();
    // The data set's own copy in quaternions has 0.40511895 here, up to the quaternion's sign.
    assert!((x.abs() - 0.405_118_95).abs() < 1e-8, "{x}");
}

#[test]
fn the_row_of_three_reflectors_gives_a_point_for_each_seen() {
    let file = read_block(2, Some(blocks("Measurements", "toml")[1]), true);
    let targets: Vec<usize> = file.data.observations.iter().map(|row| row.target).collect();
    assert_eq!(targets, [0, 1, 2, 0, 2]);
    assert_eq!(file.data.readings(0)[2], 1.25);
    assert!(
        (file.data.observations[0].stated.get(poecal_model::measurement::Quantity::Position).unwrap() - 3e-5).abs()
            < 1e-19
    );
    assert_eq!(file.data.ids, ["1", "1", "1", "2", "2"]);
}

#[test]
fn the_mapping_of_the_validation_is_one() {
    assert!(ColumnMap::parse(UR10_MAP, "ur10_raw_columns.toml").is_ok());
}

#[test]
fn the_documented_urdf_turns_and_slides() {
    let urdf = UrdfDocument::parse(blocks("Robot models", "xml")[0], "turning_slide.urdf", &Default::default());
    let tip = urdf.unwrap().robot().forward_kinematics(&[std::f64::consts::FRAC_PI_2, 0.25]);
    assert!((tip.translation - Vector3::new(0.0, 0.35, 0.45)).norm() < 1e-15);
    assert!((tip.rotation.column(2) + Vector3::z()).norm() < 1e-15);
}

#[test]
fn the_documented_screws_make_a_scara() {
    let robot = robot_toml::parse(blocks("Robot models", "toml")[0], "scara.toml").unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    let tip = robot.forward_kinematics(&[quarter, -quarter, 0.1, 0.0]);
    assert!((tip.translation - Vector3::new(0.25, 0.35, 0.05)).norm() < 1e-15);
    let names: Vec<_> = robot.targets.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!((names, robot.base_name.as_str()), (vec!["reflector", "camera"], "floor"));
}

#[test]
fn both_documented_dh_tables_are_the_same_arm() {
    let robot = |block: usize| robot_toml::parse(blocks("Robot models", "toml")[block], "dh.toml").unwrap();
    let (standard, modified) = (robot(1), robot(2));
    assert_eq!(standard.reading_names(), modified.reading_names());
    let difference = Difference::from_robots(&standard, &modified, 100);
    assert!(difference.is_within(1e-14, 1e-14), "{difference:?}");
    assert!((standard.home.translation - Vector3::new(0.445, 0.0, 0.99)).norm() < 1e-14, "{:?}", standard.home);
}

#[test]
fn a_documented_dh_table_has_a_fixed_pose_between_its_rows() {
    let robot = robot_toml::parse(blocks("Robot models", "toml")[3], "cranked.toml").unwrap();
    let (q1, q2) = (0.7, -0.4);
    let turned = |axis: usize, angle: f64| Pose::new(poecal_arm::lie::rotation::about(axis, angle), Vector3::zeros());
    let moved = |x, y, z| Pose::from_translation(Vector3::new(x, y, z));
    let expected = turned(2, q1)
        * moved(0.0, 0.0, 0.4)
        * (moved(0.0, 0.03, 0.015) * turned(1, 5f64.to_radians()))
        * turned(0, -std::f64::consts::FRAC_PI_2)
        * moved(0.025, 0.0, 0.0)
        * turned(2, q2)
        * moved(0.455, 0.0, 0.0);
    let found = robot.forward_kinematics(&[q1, q2]);
    assert!((found.translation - expected.translation).norm() < 1e-15, "{found:?}");
    assert!((found.rotation - expected.rotation).norm() < 1e-15, "{found:?}");
}

#[test]
fn results_have_the_documented_columns_and_keys() {
    let made = Simulation { count: 30, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let documented = blocks("Results", "text")[0].lines().next().unwrap();
    assert_eq!(Residuals::from_calibration(&made.data, &calibration).text().lines().next().unwrap(), documented);
    assert!(blocks("Results", "text")[0].lines().all(|line| line.matches(',').count() == 28));

    let inputs = Inputs::default();
    let text = CalibrationFile::new(&calibration, &made.data, inputs).to_text().unwrap();
    let file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let table = DOCUMENT.split("### calibration.json").nth(1).unwrap().split("\n### ").next().unwrap();
    let mut known: Vec<&str> = vec!["poecal_version"];
    for row in table.lines().filter(|line| line.starts_with("| `")) {
        for key in row.split('|').nth(1).unwrap().split(',') {
            let path = key.trim().trim_matches('`');
            let pointer = format!("/{}", path.replace('.', "/"));
            let may_be_missing = row.contains("missing if there are none");
            assert!(may_be_missing || file.pointer(&pointer).is_some(), "{path}");
            known.push(path.split('.').next().unwrap());
        }
    }
    let keys = file.as_object().unwrap().keys();
    assert!(keys.clone().all(|key| known.contains(&key.as_str())), "{keys:?} has a key that is not documented");
}

#[test]
fn the_documented_prediction_is_the_elbows() {
    let text = include_str!("../../../../examples/elbow/robot.toml");
    let tip = robot_toml::parse(text, "robot.toml").unwrap().forward_kinematics(&[0.0; 6]);
    let (header, row) = blocks("Results", "text")[1].trim().split_once('\n').unwrap();
    assert_eq!(header, "x[m],y[m],z[m],qx,qy,qz,qw");
    let predicted: Vec<f64> = row.split(',').map(|number| number.parse().unwrap()).collect();
    assert_eq!(predicted[..3], tip.translation.as_slice()[..]);
    assert_eq!(predicted[3..], tip.quaternion_xyzw()[..]);
}
