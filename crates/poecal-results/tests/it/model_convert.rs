//! Every model in every other form: the same forward kinematics, and notes on the losses.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw};
use poecal_formats::robot_toml;
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::robot::{Joint, Reading, Robot};
use poecal_model::simulate::scara;
use poecal_numerics::error::ErrorKind;
use poecal_results::model::{Model, ModelFormat, ModelSource, convert};

fn toml_model(robot: Robot) -> Model {
    Model { robot, source: ModelSource::Toml, path: "robot.toml".into() }
}

#[test]
fn every_reference_urdf_converts_both_ways() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../poecal-testing/data/urdf");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let model = Model::read(&path, &ChainSelection::default()).unwrap();
        for to in [ModelFormat::Urdf, ModelFormat::Toml] {
            // Forward kinematics is verified inside.
            let converted = convert(&model, to).unwrap();
            let again = match to {
                // The chain of the new file is unique again, even if a leader stands beside it.
                ModelFormat::Urdf => {
                    UrdfDocument::parse(&converted.text, &path, &ChainSelection::default()).unwrap().robot().clone()
                }
                ModelFormat::Toml => robot_toml::parse(&converted.text, &path).unwrap(),
            };
            assert_eq!((&again.base_name, &again.tip_name), (&model.robot.base_name, &model.robot.tip_name));
            for (a, b) in again.joints.iter().zip(&model.robot.joints) {
                assert_eq!((&a.name, a.kind, &a.reading, a.limits), (&b.name, b.kind, &b.reading, b.limits));
            }
        }
        count += 1;
    }
    assert_eq!(count, 10);
}

#[test]
fn dh_tables_in_both_conventions_agree_with_the_product_of_their_matrices() {
    let rows = "joint = [
      { name = 'j1', a = 25, alpha = -90, d = 400, theta = 10, fixed = { position = [3, -5, 7], rpy = [10, 20, 30] } },
      { name = 'j2', type = 'prismatic', a = 0, alpha = 45, d = 560, theta = -90, limits = [-10, 20] },
      { name = 'j3', a = 0.5, alpha = 0, d = 0, theta = 0, limits = [-90, 90] },
    ]
    base = { position = [1000, 0, 0], rpy = [0, 0, 90] }
    tool = { position = [0, 0, 80] }";
    for standard in [true, false] {
        let convention = if standard { "standard_dh" } else { "modified_dh" };
        let head = format!(
            "poecal_robot = 1\nname = 'r'\nlength_unit = 'mm'\nangle_unit = 'deg'\nconvention = '{convention}'\n"
        );
        let robot = robot_toml::parse(&(head + rows), "r.toml").unwrap();
        let (q1, q2, q3) = (0.3, 0.05, -0.8);
        let z = |theta: f64, d: f64| Pose::from_xyz_rpy([0.0, 0.0, d], [0.0, 0.0, theta]);
        let x = |alpha: f64, a: f64| Pose::from_xyz_rpy([a, 0.0, 0.0], [alpha.to_radians(), 0.0, 0.0]);
        let pairs = [
            (z(10f64.to_radians() + q1, 0.4), x(-90.0, 0.025)),
            (z(-90f64.to_radians(), 0.56 + q2), x(45.0, 0.0)),
            (z(q3, 0.0), x(0.0, 0.0005)),
        ];
        let base = Pose::from_xyz_rpy([1.0, 0.0, 0.0], [0.0, 0.0, 90f64.to_radians()]);
        let fixed = Pose::from_xyz_rpy([0.003, -0.005, 0.007], [10f64, 20.0, 30.0].map(f64::to_radians));
        let product = pairs.into_iter().enumerate().fold(base, |pose, (row, (along_z, along_x))| {
            let after = if row == 0 { fixed } else { Pose::identity() };
            let row = if standard { along_z * along_x } else { along_x * along_z };
            pose * row * after
        }) * Pose::from_translation(Vector3::new(0.0, 0.0, 0.08));
        let tip = robot.forward_kinematics(&[q1, q2, q3]);
        assert!((tip.translation - product.translation).norm() < 1e-14);
        assert!((tip.rotation - product.rotation).norm() < 1e-14);
        let limits: Vec<_> = robot.joints.iter().map(|joint| joint.limits.map(|l| (l.lower, l.upper))).collect();
        let right_angle = std::f64::consts::FRAC_PI_2;
        assert_eq!(limits, [None, Some((-0.01, 0.02)), Some((-right_angle, right_angle))]);
        convert(&toml_model(robot), ModelFormat::Urdf).unwrap();
    }
}

#[test]
fn the_papers_identified_screws_are_projected() {
    // Table II of lou2009, right column: rounded to four digits, so no row is a screw exactly.
    let text = "poecal_robot = 1
name = 'elbow'
length_unit = 'mm'
angle_unit = 'deg'
joint = [
  { name = 'j1', screw = { v = [0.0222, -0.0144, 0.0009], w = [0.0194, -0.0317, 0.9993] } },
  { name = 'j2', screw = { v = [0.1764, 2.8933, 151.2188], w = [0.0504, 0.9985, -0.0192] } },
  { name = 'j3', screw = { v = [583.8102, 14.9619, -154.0245], w = [0.0307, -0.9993, 0.0195] } },
  { name = 'j4', screw = { v = [60.3165, -690.8776, 1.7673], w = [-0.9958, -0.0870, -0.0290] } },
  { name = 'j5', screw = { v = [-733.2256, -29.1784, 798.2115], w = [-0.0143, 0.9996, 0.0234] } },
  { name = 'j6', screw = { v = [-17.1142, -702.2271, -0.9022], w = [-0.9984, 0.0244, -0.0517] } },
]
[home]
position = [839.01, -5.03, 724.974]
";
    let robot = robot_toml::parse(text, "elbow.toml").unwrap();
    for joint in &robot.joints {
        let (v, w) = (joint.screw.v(), joint.screw.w());
        assert!((w.norm() - 1.0).abs() < 1e-15 && v.dot(&w).abs() < 1e-15);
    }
}

#[test]
fn targets_units_and_mimic_relations_of_a_toml_model() {
    let text = "poecal_robot = 1
name = 'column'
length_unit = 'mm'
angle_unit = 'deg'
joint = [
  { name = 'lift', type = 'prismatic', screw = { v = [0, 0, 1] } },
  { name = 'stage', type = 'prismatic', direction = [0, 0, 2], mimic = { joint = 'lift', multiplier = 0.5, offset = 20 } },
  { name = 'screw', point = [100, 0, 0], direction = [0, 0, 1], mimic = { joint = 'stage', multiplier = 36 } },
]
home = { position = [0, 0, 0], rotation = [[0, -1, 0], [1, 0, 0], [0, 0, 1]] }
target = [
  { name = 'ball', position = [10, 20, 30] },
  { name = 'plate', position = [0, 0, 0], quaternion_xyzw = [0, 0, 0.7071, 0.7071] },
]";
    let robot = robot_toml::parse(text, "column.toml").unwrap();
    assert_eq!(robot.reading_names(), ["lift"]);
    assert_eq!(robot.joints[1].reading, Reading { name: "lift".into(), multiplier: 0.5, offset: 0.02 });
    // 36° a millimetre of `stage`, which is half of `lift` and 20 mm.
    let screw = &robot.joints[2].reading;
    assert!((screw.value(0.1) - (36.0f64 * 70.0).to_radians()).abs() < 1e-12, "{screw:?}");
    assert_eq!(robot.joints[2].frame.translation, Vector3::new(0.1, 0.0, 0.0));
    assert_eq!(robot.targets[0], ("ball".into(), Pose::from_translation(Vector3::new(0.01, 0.02, 0.03))));
    assert!((robot.targets[1].1.rotation - robot.home.rotation).norm() < 1e-15);

    let model = toml_model(robot);
    let urdf = convert(&model, ModelFormat::Urdf).unwrap();
    assert!(urdf.notes.contains(&"targets are not part of a URDF and were left out".to_owned()));
    assert!(urdf.text.contains("<limit lower=\"-1000\" upper=\"1000\" effort=\"0\" velocity=\"0\"/>"));
    let toml = convert(&model, ModelFormat::Toml).unwrap();
    let again = robot_toml::parse(&toml.text, "robot.toml").unwrap();
    assert_eq!(again.targets[0], model.robot.targets[0]);
    assert!((again.targets[1].1.rotation - model.robot.targets[1].1.rotation).norm() < 1e-15);
    assert!(toml.notes.is_empty());
}

#[test]
fn names_are_escaped() {
    let axis = Screw::revolute(&Vector3::x(), &Vector3::new(0.0, 0.1, 0.2));
    let joint = Joint::revolute("a \"quoted\" <joint> & 'more'", axis);
    let mut robot = Robot::new("r & d", vec![joint], Pose::identity()).unwrap();
    robot.tip_name = "tip\n2".into();
    for to in [ModelFormat::Urdf, ModelFormat::Toml] {
        convert(&toml_model(robot.clone()), to).unwrap();
    }
    robot.tip_name = "bell \u{7}".into();
    let error = convert(&toml_model(robot), ModelFormat::Urdf).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Export);
}

#[test]
fn what_a_form_cannot_hold_is_an_error() {
    let axis = Screw::revolute(&Vector3::x(), &Vector3::zeros());
    let mut robot = Robot::new("r", vec![Joint::revolute("j", axis)], Pose::identity()).unwrap();
    robot.joints[0].reading.offset = 0.5;
    let error = convert(&toml_model(robot.clone()), ModelFormat::Urdf).unwrap_err();
    assert_eq!(
        error.to_string(),
        "joint `j` has a factor or an offset on its own reading, expected factor 1 and offset 0: URDF has them for mimic joints only"
    );
    let error = convert(&toml_model(robot), ModelFormat::Toml).unwrap_err();
    assert_eq!(
        error.to_string(),
        "robot.toml: the converted model differs by 0.0e0 m and 5.0e-1 rad, expected at most 1.0e-12 m and 1e-12 rad"
    );
}

#[test]
fn without_an_extension_the_text_shows_its_form() {
    let read = |text: &str| Model::parse(text, "a model", &ChainSelection::default()).unwrap();
    let model = read(&robot_toml::write(&scara()));
    assert_eq!(model.source, ModelSource::Toml);
    let urdf = convert(&model, ModelFormat::Urdf).unwrap().text;
    assert!(matches!(read(&urdf).source, ModelSource::Urdf(_)));
}
