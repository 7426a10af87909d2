//! Robot models: URDF, TOML, and forms of simulators and makers.

use poecal_arm::lie::{Pose, Screw};
use poecal_formats::robot_toml;
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::robot::Robot;
use poecal_numerics::error::ErrorKind;
use poecal_results::model::{Model, ModelFormat, ModelSource, convert};

use crate::properties::{PATH, VAST_M, assert_alike, certain, check_result, one_line, size_m, text};

/// Rounding of writing and reading again, for a robot of 1 m.
const ROUNDING: f64 = 1e-10;

/// A URDF: read, written into its own text as it is and with other screws, and in the other form.
pub fn urdf(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let Some(document) = check_result(UrdfDocument::parse(&text, PATH, &ChainSelection::default()), &text) else {
        return false;
    };
    assert_eq!(document.text(), text);
    let robot = document.robot();
    if size_m(robot) > VAST_M {
        return true;
    }
    assert_patched(&document, robot);
    assert_patched(&document, &move_axes(robot));
    let source = ModelSource::Urdf(Box::new(document.clone()));
    convert_both_forms(&Model { robot: robot.clone(), source, path: PATH.into() });
    true
}

/// A model in a form of a simulator or maker, and the equivalent URDF.
pub fn foreign(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let form = if text.trim_start().starts_with('<') {
        "xml"
    } else if text.contains("kinemat") {
        "yaml"
    } else {
        "conf"
    };
    let path = format!("{PATH}.{form}");
    let read = Model::parse(&text, &path, &ChainSelection::default());
    let Some(model) = check_result(read, &text) else { return false };
    let ModelSource::Urdf(document) = &model.source else { return true };
    let again = UrdfDocument::parse(document.text(), PATH, &ChainSelection::default());
    assert_eq!(certain(again, document.text()).robot(), document.robot());
    if size_m(document.robot()) <= VAST_M {
        assert_patched(document, document.robot());
        convert_both_forms(&model);
    }
    true
}

/// Writes a robot into the text that another was read from, and reads it back.
pub(crate) fn assert_patched(document: &UrdfDocument, robot: &Robot) {
    let patched = certain(document.patch(robot), "patched");
    patched.notes.iter().for_each(|note| one_line(note));
    let selection = patched.selection;
    let again = certain(UrdfDocument::parse(&patched.text, PATH, &selection), &patched.text);
    assert_alike(robot, again.robot(), ROUNDING, "patched");
    let limits = |robot: &Robot| robot.joints.iter().map(|joint| joint.limits).collect::<Vec<_>>();
    assert_eq!(limits(robot), limits(again.robot()));
    // Once written, a robot's text does not change.
    let twice = certain(again.patch(again.robot()), "patched twice");
    assert_alike(
        again.robot(),
        certain(UrdfDocument::parse(&twice.text, PATH, &selection), "twice").robot(),
        ROUNDING,
        "twice",
    );
}

/// The robot with every axis and its tip displaced, as by a calibration.
pub(crate) fn move_axes(robot: &Robot) -> Robot {
    let little = Pose::from_xyz_rpy([2e-3, -1e-3, 3e-3], [0.01, -0.02, 0.005]);
    let screws: Vec<Screw> = robot.joints.iter().map(|joint| joint.screw.transform(&little)).collect();
    let mut moved = robot.with_screws(&screws);
    moved.home = little * robot.home;
    moved
}

/// Writes a model in both forms, if possible.
pub(crate) fn convert_both_forms(model: &Model) {
    let is_vast = size_m(&model.robot) > VAST_M;
    for form in [ModelFormat::Urdf, ModelFormat::Toml] {
        match convert(model, form) {
            Ok(converted) => converted.notes.iter().for_each(|note| one_line(note)),
            Err(error) => {
                one_line(&error.to_string());
                assert_eq!(error.kind(), ErrorKind::Export, "{error}");
                assert!(is_vast || !error.message().contains("cannot be read back"), "{error}");
            }
        }
    }
}

/// A TOML model: read, written, read again.
pub fn robot_toml(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let Some(robot) = check_result(robot_toml::parse(&text, PATH), &text) else { return false };
    if size_m(&robot) > VAST_M {
        return true;
    }
    let written = robot_toml::write(&robot);
    let again = certain(robot_toml::parse(&written, PATH), &written);
    same_robot(&robot, &again);
    // A robot of that form is the same to the last digit, except for its directions, which are normalised again.
    let once_more = certain(robot_toml::parse(&robot_toml::write(&again), PATH), "written twice");
    same_robot(&again, &once_more);
    convert_both_forms(&Model { robot, source: ModelSource::Toml, path: PATH.into() });
    true
}

fn same_robot(robot: &Robot, again: &Robot) {
    assert_alike(robot, again, ROUNDING, "written and read");
    let frames = |robot: &Robot| (robot.name.clone(), robot.base_name.clone(), robot.tip_name.clone());
    assert_eq!(frames(robot), frames(again));
    for (joint, other) in robot.joints.iter().zip(&again.joints) {
        assert_eq!((joint.limits, &joint.reading), (other.limits, &other.reading), "{}", joint.name);
    }
    let names = |robot: &Robot| robot.targets.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(robot), names(again));
    for ((name, pose), (_, other)) in robot.targets.iter().zip(&again.targets) {
        let off = (pose.translation - other.translation).norm() / pose.translation.norm().max(1.0);
        let turned = (pose.rotation - other.rotation).norm();
        assert!(off <= ROUNDING && turned <= ROUNDING, "target {name}: {off:e}, {turned:e}");
    }
}
