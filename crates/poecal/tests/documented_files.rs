//! The examples of docs/file-formats.md, "Measurements", are read as the text says.

#![allow(clippy::unwrap_used)]

// Only the folder is needed here.
#[allow(dead_code)]
mod files;

use files::Folder;
use nalgebra::Vector3;
use poecal::io::measurements::{ColumnMap, DecimalSign, MeasurementFile, ReadOptions, read};
use poecal::lie::{Pose, Screw};
use poecal::measurement::Set;
use poecal::robot::{Joint, Robot};

const DOCUMENT: &str = include_str!("../../../docs/file-formats.md");
const UR10_MAP: &str = include_str!("../../../validation/ur10_raw_columns.toml");

/// The section's blocks of one language, in order.
fn blocks(language: &str) -> Vec<&'static str> {
    let section = DOCUMENT.split("\n## ").find(|section| section.starts_with("Measurements\n")).unwrap();
    let fence = format!("```{language}\n");
    section.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap()).collect()
}

fn read_block(block: usize, map: Option<&str>, rail: bool) -> MeasurementFile {
    let folder = Folder::new();
    let path = folder.write("points.csv", blocks("text")[block]);
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
    let file = read_block(1, Some(blocks("toml")[0]), false);
    assert_eq!(file.understood[0].decimal_sign, DecimalSign::Comma);
    let [x, _, _, _] = file.data.observations[0].measurement.pose().quaternion_xyzw();
    // The data set's own copy in quaternions has 0.40511895 here, up to the quaternion's sign.
    assert!((x.abs() - 0.405_118_95).abs() < 1e-8, "{x}");
}

#[test]
fn the_row_of_three_reflectors_gives_a_point_for_each_seen() {
    let file = read_block(2, Some(blocks("toml")[1]), true);
    let targets: Vec<usize> = file.data.observations.iter().map(|row| row.target).collect();
    assert_eq!(targets, [0, 1, 2, 0, 2]);
    assert_eq!(file.data.readings(0)[2], 1.25);
    assert!((file.data.observations[0].sigma_position_m.unwrap() - 3e-5).abs() < 1e-19);
    assert_eq!(file.data.ids, ["1", "1", "1", "2", "2"]);
}

#[test]
fn the_mapping_of_the_validation_is_one() {
    assert!(ColumnMap::parse(UR10_MAP, "ur10_raw_columns.toml").is_ok());
}
