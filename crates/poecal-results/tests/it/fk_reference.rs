//! Forward kinematics of ten URDFs against Pinocchio (tests/data/fk_reference.py made the reference).

use nalgebra::{Matrix3, Vector3};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_testing::largest::larger_or_nan;
use serde::Deserialize;

/// Both sides round in double precision, at lengths of a few metres.
const TOLERANCE: f64 = 1e-12;

#[derive(Deserialize)]
struct Reference {
    pinocchio: String,
    robots: Vec<ReferenceRobot>,
}

#[derive(Deserialize)]
struct ReferenceRobot {
    urdf: String,
    tip: String,
    readings: Vec<String>,
    configurations: Vec<Configuration>,
}

#[derive(Deserialize)]
struct Configuration {
    readings: Vec<f64>,
    position_m: [f64; 3],
    rotation: [[f64; 3]; 3],
}

#[test]
fn forward_kinematics_agrees_with_pinocchio() {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../poecal-testing/data");
    let text = std::fs::read_to_string(format!("{data}/fk_reference.json")).unwrap();
    let reference: Reference = serde_json::from_str(&text).unwrap();
    assert_eq!(reference.robots.len(), 10);
    let mut largest = (0.0_f64, 0.0_f64);
    for expected in &reference.robots {
        let path = format!("{data}/urdf/{}", expected.urdf);
        // No selection: the chain of each of these files is unique.
        let urdf = UrdfDocument::read(&path, &ChainSelection::default()).unwrap();
        let robot = urdf.robot();
        assert_eq!((robot.base_name.as_str(), &robot.tip_name), ("base_link", &expected.tip));
        let mut own = (0.0_f64, 0.0_f64);
        let reading = |name: &String| expected.readings.iter().position(|known| known == name).unwrap();
        let readings: Vec<Vec<f64>> = expected
            .configurations
            .iter()
            .map(|it| robot.reading_names().iter().map(|name| it.readings[reading(name)]).collect())
            .collect();
        let together = readings.concat();
        let mut together = robot.forward_kinematics_of(&together);
        for (configuration, readings) in expected.configurations.iter().zip(&readings) {
            for tip in [robot.forward_kinematics(readings), together.next().unwrap()] {
                let rotation = Matrix3::from_fn(|row, column| configuration.rotation[row][column]);
                own.0 = larger_or_nan(own.0, (tip.translation - Vector3::from(configuration.position_m)).norm());
                own.1 = larger_or_nan(own.1, (tip.rotation - rotation).norm());
            }
        }
        assert!(together.next().is_none());
        println!("{:20} {:.1e} m, {:.1e} in the rotation matrix", expected.urdf, own.0, own.1);
        largest = (larger_or_nan(largest.0, own.0), larger_or_nan(largest.1, own.1));
    }
    println!("largest difference from Pinocchio {}: {:.1e} m, {:.1e}", reference.pinocchio, largest.0, largest.1);
    assert!(largest.0 < TOLERANCE && largest.1 < TOLERANCE);
}

#[test]
fn the_two_elbow_models_are_one_robot() {
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow");
    let selection = ChainSelection::default();
    let read = |name| poecal_results::model::Model::read(format!("{examples}/{name}"), &selection).unwrap().robot;
    let (urdf, toml) = (read("robot.urdf"), read("robot.toml"));
    assert_eq!((&urdf.name, &urdf.base_name, &urdf.tip_name), (&toml.name, &toml.base_name, &toml.tip_name));
    let readings = [0.3, -0.9, 1.2, -2.0, 0.7, 4.0];
    let (a, b) = (urdf.forward_kinematics(&readings), toml.forward_kinematics(&readings));
    assert!((a.translation - b.translation).norm() < 1e-15 && (a.rotation - b.rotation).norm() < 1e-14);
    for (a, b) in urdf.joints.iter().zip(&toml.joints) {
        assert_eq!((&a.name, a.limits), (&b.name, b.limits));
    }
}
