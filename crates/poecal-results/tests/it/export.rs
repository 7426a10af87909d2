//! Exports: every form of random calibrated robots states the fitted robot, read back by readers of this file alone.

use nalgebra::{Matrix3, Matrix4, Vector3};
use poecal_arm::lie::{Pose, Screw};
use poecal_calibrate::calibrate;
use poecal_formats::urdf::ChainSelection;
use poecal_model::robot::{Joint, JointKind, Reading, Robot};
use poecal_model::simulate::random::uniform_number;
use poecal_model::simulate::{SessionKind, Simulation, elbow, gantry, random_chain, scara, seven_axis};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::export::{ExportFormat, ExportOptions, export};
use poecal_results::model::{Model, ModelSource};
use poecal_testing::sessions::geometry;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use serde_json::Value;

/// Errors of axes of a calibrated robot: up to a degree and two millimetres.
const TILT_RAD: f64 = 0.017;
const SHIFT_M: f64 = 2e-3;

/// Three parallel axes, as Universal Robots' arms have.
fn ur_like() -> Robot {
    let axis = |direction: [f64; 3], point: [f64; 3]| Screw::revolute(&direction.into(), &point.into());
    let screws = [
        axis([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
        axis([0.0, -1.0, 0.0], [0.0, 0.0, 0.1807]),
        axis([0.0, -1.0, 0.0], [-0.6127, 0.0, 0.1807]),
        axis([0.0, -1.0, 0.0], [-1.18425, -0.17415, 0.1807]),
        axis([0.0, 0.0, -1.0], [-1.18425, -0.17415, 0.0]),
        axis([0.0, -1.0, 0.0], [-1.18425, -0.17415, 0.06085]),
    ];
    let joints = screws.iter().enumerate();
    let joints = joints.map(|(at, screw)| Joint::revolute(&format!("joint{}", at + 1), *screw)).collect();
    let home = Pose::new(
        Matrix3::new(-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, -1.0, 0.0),
        Vector3::new(-1.18425, -0.2907, 0.06085),
    );
    Robot::new("ur_like", joints, home).unwrap()
}

/// A robot whose axes deviate from nominal.
fn perturb_robot(robot: &Robot, seed: u64) -> Robot {
    let g = &mut ChaCha8Rng::seed_from_u64(seed);
    let mut any = |size: f64| Vector3::from_fn(|_, _| (2.0 * uniform_number(g) - 1.0) * size);
    let mut found = robot.clone();
    for joint in &mut found.joints {
        let motion = Pose::new(poecal_arm::lie::rotation::exp(&any(TILT_RAD)), any(SHIFT_M));
        joint.screw = joint.screw.transform(&motion);
        joint.frame = motion * joint.frame;
    }
    found.home = found.home * Pose::new(poecal_arm::lie::rotation::exp(&any(0.3)), any(0.1));
    found
}

fn robots() -> Vec<Robot> {
    let kinds: [fn(u64) -> Robot; 6] =
        [|_| ur_like(), |_| elbow(), |_| scara(), |_| gantry(), |_| seven_axis(), |seed| random_chain(6, seed)];
    (0..50).map(|seed| perturb_robot(&kinds[seed as usize % kinds.len()](seed), seed)).collect()
}

fn model(robot: &Robot) -> Model {
    Model { robot: robot.clone(), source: ModelSource::Toml, path: "robot.toml".into() }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|it| it.as_f64().unwrap()).collect()
}

/// A homogeneous matrix: everything below is written with these alone.
type M = Matrix4<f64>;

fn translation(x: f64, y: f64, z: f64) -> M {
    M::new_translation(&Vector3::new(x, y, z))
}

fn about(axis: usize, angle: f64) -> M {
    let (s, c) = angle.sin_cos();
    let mut m = M::identity();
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    (m[(i, i)], m[(j, j)], m[(j, i)], m[(i, j)]) = (c, c, s, -s);
    m
}

fn entry_pose(entry: &Value) -> M {
    let [x, y, z] = numbers(&entry["position_m"]).try_into().unwrap();
    let [a, b, c, w] = numbers(&entry["quaternion_xyzw"]).try_into().unwrap();
    let q = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, a, b, c));
    translation(x, y, z) * q.to_homogeneous()
}

fn by_table(text: &str, q: &[f64]) -> M {
    let file: Value = serde_json::from_str(text).unwrap();
    let mut found = entry_pose(&file["base_from_first"]);
    for (row, &q) in file["rows"].as_array().unwrap().iter().zip(q) {
        let of = |key: &str| row[key].as_f64().unwrap();
        let (mut theta, mut d) = (of("theta_rad"), of("d_m"));
        if row["kind"] == "revolute" {
            theta += q
        } else {
            d += q
        }
        let (joint, link) =
            (about(2, theta) * translation(0.0, 0.0, d), translation(of("a_m"), 0.0, 0.0) * about(0, of("alpha_rad")));
        found *= match (file["convention"].as_str().unwrap(), row["row"].as_str().unwrap()) {
            ("modified", _) => about(0, of("alpha_rad")) * translation(of("a_m"), 0.0, 0.0) * joint,
            (_, "hayati") => {
                assert_eq!(d, 0.0);
                joint * link * about(1, of("beta_rad"))
            }
            _ => joint * link,
        };
    }
    found * entry_pose(&file["last_from_tip"])
}

fn by_screws(text: &str, q: &[f64]) -> M {
    let file: Value = serde_json::from_str(text).unwrap();
    let mut found = M::identity();
    for (joint, &q) in file["joints"].as_array().unwrap().iter().zip(q) {
        let [v, w] = ["v", "w"].map(|key| Vector3::from_iterator(numbers(&joint[key])));
        let mut twist = M::zeros();
        twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&w.cross_matrix());
        twist.fixed_view_mut::<3, 1>(0, 3).copy_from(&v);
        found *= (twist * q).exp();
    }
    found * entry_pose(&file["home"])
}

/// Origins in lines `key: number`, six of each joint, or in cells.
fn by_origins(numbers: &[f64], robot: &Robot, q: &[f64]) -> M {
    let mut found = M::identity();
    for (at, of) in numbers.chunks(6).enumerate() {
        found *= translation(of[0], of[1], of[2]) * about(2, of[5]) * about(1, of[4]) * about(0, of[3]);
        if let (Some(joint), Some(&q)) = (robot.joints.get(at), q.get(at)) {
            found *= if joint.kind == JointKind::Revolute { about(2, q) } else { translation(0.0, 0.0, q) };
        }
    }
    found
}

fn of_yaml(text: &str) -> Vec<f64> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let mut found: Vec<f64> = lines.filter_map(|line| line.rsplit_once(": ")?.1.parse().ok()).collect();
    if let Some((_, tool)) = text.split_once("no place for: ") {
        let parts = tool.lines().next().unwrap().split(", ");
        found.extend(parts.map(|part| part.split_once(": ").unwrap().1.parse::<f64>().unwrap()));
    }
    found
}

fn of_csv(text: &str) -> Vec<f64> {
    let cells = text.lines().skip(1).flat_map(|line| line.split(',').skip(2));
    cells.map(|cell| cell.parse().unwrap()).collect()
}

/// Largest difference of the tip from a robot's, metres and parts of rotation matrices.
fn largest_difference(robot: &Robot, place: impl Fn(&[f64]) -> M) -> f64 {
    let g = &mut ChaCha8Rng::seed_from_u64(9);
    let mut worst = 0.0f64;
    for _ in 0..100 {
        let q: Vec<f64> = robot.joints.iter().map(|_| 4.0 * uniform_number(g) - 2.0).collect();
        let found = place(&q);
        let pose = robot.forward_kinematics(&q);
        let off = (found.fixed_view::<3, 1>(0, 3) - pose.translation).amax();
        let turned = (found.fixed_view::<3, 3>(0, 0) - pose.rotation).amax();
        worst = worst.max(off).max(turned);
    }
    worst
}

#[test]
fn forms_of_fifty_robots_say_what_the_robot_does() {
    let options = ExportOptions::default();
    let (mut written, mut largest) = (0, 0.0f64);
    for robot in robots() {
        let model = model(&robot);
        let text = |format| export(&model, format, &options).map(|it| it.text);
        let mut check = |name: &str, found: f64| {
            assert!(found < 1e-9, "{} {name}: {found:e}", robot.name);
            written += 1;
            largest = largest.max(found);
        };
        check("hayati", largest_difference(&robot, |q| by_table(&text(ExportFormat::Hayati).unwrap(), q)));
        check("poe", largest_difference(&robot, |q| by_screws(&text(ExportFormat::Poe).unwrap(), q)));
        let csv = of_csv(&text(ExportFormat::Csv).unwrap());
        check("csv", largest_difference(&robot, |q| by_origins(&csv, &robot, q)));
        let origins = of_yaml(&text(ExportFormat::Origins).unwrap());
        check("origins", largest_difference(&robot, |q| by_origins(&origins, &robot, q)));
        for format in [ExportFormat::Dh, ExportFormat::Mdh] {
            match text(format) {
                Ok(text) => check("dh", largest_difference(&robot, |q| by_table(&text, q))),
                Err(error) => assert!(error.to_string().contains("nearly parallel"), "{error}"),
            }
        }
        for format in [ExportFormat::Mjcf, ExportFormat::Sdf, ExportFormat::Toml, ExportFormat::Urdf] {
            let remains = export(&model, format, &options).unwrap().remains;
            check("model", remains.position_m.max(remains.rotation_rad));
        }
        let usd = export(&model, ExportFormat::Usd, &options).unwrap();
        assert!(usd.remains.position_m < 1e-6 && usd.notes[0].contains("single precision"));
    }
    println!("{written} texts, largest difference {largest:e}");
    // Nearly parallel axes leave out some tables.
    assert!(written > 450);
}

/// A joint that follows another one of the chain is written as a follower, in the forms that have such joints; others refuse it.
#[test]
fn followers_stay_followers() {
    let mut robot = perturb_robot(&ur_like(), 5);
    let leader = robot.joints[1].name.clone();
    robot.joints[2].reading = Reading { name: leader, multiplier: -0.5, offset: 0.3 };
    let model = model(&robot);
    for format in [ExportFormat::Mjcf, ExportFormat::Sdf] {
        let found = export(&model, format, &ExportOptions::default()).unwrap();
        let again = Model::parse(&found.text, "m.xml", &ChainSelection::default()).unwrap().robot;
        assert_eq!(again.joints[2].reading, robot.joints[2].reading);
        assert_eq!(again.reading_names().len(), 5);
        println!("{format:?}: {:e} m, {:e} rad", found.remains.position_m, found.remains.rotation_rad);
        assert!(found.remains.position_m.max(found.remains.rotation_rad) < 1e-12);
    }
    let error = export(&model, ExportFormat::Usd, &ExportOptions::default()).unwrap_err();
    assert!(error.message().starts_with("found joint `joint3`, which follows `joint2`, expected"), "{error}");
}

/// A nominal arm with parallel axes has tables of every kind, with no long offset.
#[test]
fn parallel_axes_have_tables() {
    for robot in [ur_like(), scara(), gantry()] {
        for format in [ExportFormat::Dh, ExportFormat::Mdh, ExportFormat::Hayati] {
            let text = export(&model(&robot), format, &ExportOptions::default()).unwrap().text;
            let found = largest_difference(&robot, |q| by_table(&text, q));
            println!("{} {format:?}: {found:e}", robot.name);
            assert!(found < 1e-12);
        }
    }
}

/// Makers' files have the joints of their arms, and state the tool that they have no place for.
#[test]
fn files_of_makers() {
    let of = |robot: &Robot, format, hash: Option<&str>| {
        let options = ExportOptions { hash: hash.map(str::to_owned), ..ExportOptions::default() };
        export(&model(robot), format, &options)
    };
    let six = perturb_robot(&ur_like(), 3);
    let ur = of(&six, ExportFormat::Ur, Some("calib_123")).unwrap();
    assert!(ur.text.contains("kinematics:\n  shoulder:\n    x: ") && ur.text.contains("  hash: calib_123\n"));
    let found = largest_difference(&six, |q| by_origins(&of_yaml(&ur.text), &six, q));
    assert!(found < 1e-9, "{found:e}");
    assert!(of(&six, ExportFormat::Ur, None).unwrap().notes[0].contains("--hash"));
    assert!(
        of(&seven_axis(), ExportFormat::Ur, None).unwrap_err().to_string().contains("found 7 joints, expected the 6")
    );
    let seven = perturb_robot(&seven_axis(), 4);
    let franka = of(&seven, ExportFormat::Franka, None).unwrap();
    assert!(franka.text.contains("joint8:\n  kinematic:\n"));
    let found = largest_difference(&seven, |q| by_origins(&of_yaml(&franka.text), &seven, q));
    assert!(found < 1e-9, "{found:e}");
    assert!(of(&scara(), ExportFormat::Xarm, None).unwrap_err().to_string().contains("slides"));
}

/// The losses of a form of geometry are stated, and the stated errors are right.
#[test]
fn offsets_state_what_remains() {
    let simulation = Simulation { count: 150, noise_position_m: 1e-5, ..Simulation::default() };
    let made = simulation.run(&elbow(), SessionKind::POSE).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &geometry()).unwrap();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    let robot = file.robot().unwrap();
    let model = Model {
        robot: robot.clone(),
        source: ModelSource::Calibration(Box::new(file)),
        path: "calibration.json".into(),
    };
    let exported = export(&model, ExportFormat::Offsets, &ExportOptions::default()).unwrap();
    let text: Value = serde_json::from_str(&exported.text).unwrap();
    let (stated, before) = (&text["remains"]["max_mm"], &text["without_offsets"]["rms_mm"]);
    println!("{}", exported.notes[0]);
    assert!((stated.as_f64().unwrap() / (exported.remains.position_m * 1e3) - 1.0).abs() < 0.01);
    assert!(text["remains"]["rms_mm"].as_f64() <= before.as_f64());
    let motors = export(&model, ExportFormat::Lerobot, &ExportOptions::default()).unwrap();
    let motors: Value = serde_json::from_str(&motors.text).unwrap();
    let ticks = motors["joint2"]["homing_offset"].as_i64().unwrap() as f64;
    let degrees = text["joints"][1]["offset_deg"].as_f64().unwrap();
    assert!((ticks + degrees / 360.0 * 4096.0).abs() <= 0.5, "{ticks} {degrees}");
    // Offsets from the arm's own calibration.
    let with = |homing: i64, mode: i64| {
        let motor = format!(
            r#"{{"id": 2, "drive_mode": {mode}, "homing_offset": {homing}, "range_min": 0, "range_max": 4095}}"#
        );
        let all = (1..=6).map(|k| format!("\"joint{k}\": {motor}")).collect::<Vec<_>>().join(",");
        let options = ExportOptions { motors: Some(format!("{{{all}}}")), ..ExportOptions::default() };
        export(&model, ExportFormat::Lerobot, &options)
    };
    let own: Value = serde_json::from_str(&with(100, 0).unwrap().text).unwrap();
    assert_eq!(own["joint2"]["homing_offset"].as_i64().unwrap(), 100 + ticks as i64);
    let refused =
        |found: poecal_numerics::error::Result<poecal_results::export::ExportedRobot>| found.unwrap_err().to_string();
    assert!(refused(with(0, 1)).contains("found drive_mode 1 of motor `joint1`, expected 0"));
    for homing in [2048, i64::MIN, i64::MAX] {
        assert!(refused(with(homing, 0)).contains("expected at most 2047"));
    }
    let bad = ExportOptions { motors: Some("{\"joint1\": 3}".to_owned()), ..ExportOptions::default() };
    assert!(refused(export(&model, ExportFormat::Lerobot, &bad)).contains("expected LeRobot's JSON"));
}

/// Names that a form reserves or would repeat are changed there, and odd names are read back.
#[test]
fn names_of_all_kinds() {
    let mut robot = perturb_robot(&elbow(), 5);
    (robot.base_name, robot.tip_name) = ("world".to_owned(), "joint6_link".to_owned());
    for (joint, name) in robot.joints.iter_mut().zip(["base", "a: b", "it's \"x\"", "gelenk\u{e4}", "yes", "joint6"]) {
        (joint.name, joint.reading.name) = (name.to_owned(), name.to_owned());
    }
    let of = |format| export(&model(&robot), format, &ExportOptions::default()).unwrap();
    for format in [ExportFormat::Mjcf, ExportFormat::Sdf] {
        let found = of(format);
        assert!(!found.text.contains("name=\"world\"") && found.text.contains("name=\"world_\""), "{}", found.text);
        assert!(found.notes[0].contains("`world` is `world_` there"), "{}", found.notes[0]);
    }
    let twice = of(ExportFormat::Sdf).text.matches("name=\"joint6_link\"").count();
    assert_eq!(twice, 1);
    for format in [ExportFormat::Origins, ExportFormat::Csv, ExportFormat::Poe, ExportFormat::Hayati, ExportFormat::Usd]
    {
        of(format);
    }
    // A line separator would end a comment of YAML.
    robot.tip_name = "t\u{2028}ip: x".to_owned();
    robot.name = "el\u{85}bow".to_owned();
    let text = export(&model(&robot), ExportFormat::Xarm, &ExportOptions::default()).unwrap().text;
    assert!(!text.contains(['\u{2028}', '\u{85}']));
}

/// A robot with compliant joints and terms has its geometry in every form, a note on the losses, and a file beside.
#[test]
fn corrected_robots_are_geometry_and_a_file_beside() {
    let (mut robot, _) = elbow().with_compliance(&[1, 2], poecal_model::robot::CompliantDirections::All);
    robot.terms.push(poecal_model::robot::JointTerm {
        joint: 0,
        term: poecal_model::robot::Term::RATIO,
        coefficient: 1e-3,
    });
    for format in ExportFormat::ALL {
        let of_calibrations = [ExportFormat::Pal, ExportFormat::Lerobot, ExportFormat::Offsets, ExportFormat::Tf];
        let needs_calibration = of_calibrations.contains(&format);
        if needs_calibration || format == ExportFormat::Franka {
            continue;
        }
        let found = export(&model(&robot), format, &ExportOptions::default()).unwrap();
        if format == ExportFormat::C {
            // Numbers hold terms too.
            assert!(found.beside.is_none() && found.text.contains("1.001") && found.notes.is_empty());
            continue;
        }
        assert!(found.notes[0].contains("geometry alone: without"), "{format:?} {:?}", found.notes);
        let beside: Value = serde_json::from_str(&found.beside.unwrap()).unwrap();
        let terms = beside["terms"].as_array().unwrap();
        assert!(terms.iter().any(|it| it["term"] == "ratio" && it["formula"] == "q"), "{beside}");
        assert!(!beside["gives"].as_array().unwrap().is_empty());
    }
}

/// Limits are of the coordinate that a form has: its zero is that of the reading.
#[test]
fn limits_go_with_the_zero() {
    let mut robot = elbow();
    robot.joints[1].reading.offset = 0.5;
    robot.joints[1].limits = Some(poecal_model::robot::JointLimits { lower: -1.0, upper: 1.0 });
    let text = export(&model(&robot), ExportFormat::Mjcf, &ExportOptions::default()).unwrap().text;
    assert!(text.contains("range=\"-1.5 0.5\""), "{text}");
}
