//! Robots with branches in files: a URDF with a torso, a head and two arms, read, written and read again in every form.

use nalgebra::Vector3;
use poecal_calibrate::{CalibrationOptions, calibrate};
use poecal_fit::analysis::{Cause, PlannedSession, identify, ways};
use poecal_formats::proof::Difference;
use poecal_formats::robot_toml;
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_import::ColumnMap;
use poecal_model::offsets::{OffsetOptions, explain, into_screws};
use poecal_model::robot::{Body, Robot};
use poecal_model::simulate::{SessionKind, Simulation, random_configuration};
use poecal_results::calibration_file::{CalibrationFile, Inputs, MeasuredEntry};
use poecal_results::model::{Model, ModelFormat, ModelSource, convert};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;

const TORSO: &str = include_str!("../../../poecal-testing/data/torso.urdf");

fn pairs(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    pairs.iter().map(|(name, link)| ((*name).to_owned(), (*link).to_owned())).collect()
}

fn both_hands() -> ChainSelection {
    ChainSelection {
        instruments: pairs(&[("eyes", "head_camera"), ("chest", "torso")]),
        targets: pairs(&[("left", "left_hand"), ("right", "right_hand")]),
        ..ChainSelection::default()
    }
}

fn torso() -> UrdfDocument {
    UrdfDocument::parse(TORSO, "torso.urdf", &both_hands()).unwrap()
}

fn refuse_selection(selection: &ChainSelection) -> String {
    UrdfDocument::parse(TORSO, "torso.urdf", selection).unwrap_err().to_string()
}

/// Every named frame has the pose that its chain alone has.
#[test]
fn the_tree_of_named_links_moves_as_each_chain_does() {
    let document = torso();
    let robot = document.robot();
    robot.check_tree().unwrap();
    let names: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    let arm = |side: &str| (1..=6).map(move |k| format!("{side}{k}")).collect::<Vec<_>>();
    let expected =
        [vec!["torso1".to_owned(), "torso2".to_owned()], arm("left"), vec!["head_yaw".to_owned()], arm("right")];
    assert_eq!(names, expected.concat());
    assert_eq!((robot.body_before(8), robot.body_before(9)), (Body::Link(1), Body::Link(1)));
    assert_eq!((robot.tip_name.as_str(), robot.tip_body()), ("left_hand", Body::Link(7)));
    assert!(!robot.is_serial());

    let mut generator = ChaCha8Rng::seed_from_u64(5);
    let links = [
        (&robot.instruments[0], "head_camera"),
        (&robot.instruments[1], "torso"),
        (&robot.mounted[0], "left_hand"),
        (&robot.mounted[1], "right_hand"),
    ];
    for (mount, link) in links {
        let selection = ChainSelection { tip_link: Some(link.to_owned()), ..ChainSelection::default() };
        let chain = UrdfDocument::parse(TORSO, "torso.urdf", &selection).unwrap();
        for _ in 0..20 {
            let readings = random_configuration(robot, &mut generator);
            let of_chain: Vec<f64> = chain
                .robot()
                .reading_names()
                .iter()
                .map(|name| readings[names.iter().position(|known| known == name).unwrap()])
                .collect();
            let (a, b) =
                (robot.with_tip_at(mount).forward_kinematics(&readings), chain.robot().forward_kinematics(&of_chain));
            assert!(
                (a.translation - b.translation).norm() < 1e-14 && (a.rotation - b.rotation).norm() < 1e-14,
                "{link}"
            );
        }
    }
}

#[test]
fn the_tip_is_the_first_target_that_moves_and_mistakes_get_one_sentence() {
    let eye_in_hand = ChainSelection {
        instruments: pairs(&[("camera", "right_hand")]),
        targets: pairs(&[("board", "base_link")]),
        ..ChainSelection::default()
    };
    let document = UrdfDocument::parse(TORSO, "torso.urdf", &eye_in_hand).unwrap();
    assert_eq!(document.robot().tip_name, "right_hand");
    assert_eq!(document.robot().mounted[0].body, Body::Base);
    let tip = ChainSelection { tip_link: Some("head".to_owned()), ..both_hands() };
    assert_eq!(UrdfDocument::parse(TORSO, "torso.urdf", &tip).unwrap().robot().tip_name, "head");

    let unknown = ChainSelection { targets: pairs(&[("left", "left_hnad")]), ..ChainSelection::default() };
    let error = refuse_selection(&unknown);
    assert!(
        error.starts_with("torso.urdf: target `left` names link `left_hnad`, expected a link of this file, "),
        "{error}"
    );
    assert!(error.contains("`left_hand`"), "{error}");
    let above = ChainSelection {
        base_link: Some("torso".to_owned()),
        instruments: pairs(&[("plate", "torso_lift")]),
        targets: pairs(&[("left", "left_hand")]),
        ..ChainSelection::default()
    };
    assert_eq!(
        refuse_selection(&above),
        "torso.urdf: instrument `plate`: its link `torso_lift` is not below base link `torso`, expected a base link above it (`base_link`), or one that fixed joints join to these"
    );
    let still = ChainSelection { targets: pairs(&[("plate", "base_link")]), ..ChainSelection::default() };
    assert!(
        refuse_selection(&still)
            .contains("found no moving joint between base link `base_link` and the links of the named")
    );
    let alone = ChainSelection { instruments: pairs(&[("eyes", "head_camera")]), ..ChainSelection::default() };
    assert!(refuse_selection(&alone).contains("found 5 end links"), "{}", refuse_selection(&alone));
}

#[test]
fn a_mapping_names_links_too_and_contradictions_are_refused() {
    let text = "[mount.instruments]\neyes = \"head_camera\"\n[mount.targets]\nleft = \"left_hand\"\n";
    let map = ColumnMap::parse(text, "map.toml").unwrap();
    let merged =
        map.mounts(ChainSelection { targets: pairs(&[("right", "right_hand")]), ..ChainSelection::default() }).unwrap();
    assert_eq!(merged.instruments, pairs(&[("eyes", "head_camera")]));
    assert_eq!(merged.targets, pairs(&[("right", "right_hand"), ("left", "left_hand")]));
    let error = map
        .mounts(ChainSelection { targets: pairs(&[("left", "right_hand")]), ..ChainSelection::default() })
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "map.toml: found target `left` on link `right_hand` and on link `left_hand`, expected one link"
    );
    let toml = robot_toml::write(&poecal_model::simulate::elbow());
    let error = Model::parse(&toml, "elbow.toml", &merged).unwrap_err().to_string();
    assert!(error.starts_with("elbow.toml: found instrument `eyes` on link `head_camera`, expected instruments that the model names itself"), "{error}");
}

/// All joints, instruments and targets moved, the tip with its target.
fn perturb_robot(robot: &Robot, seed: u64) -> Robot {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut actual = Simulation::default().perturb(robot, &mut generator);
    actual.name.clone_from(&robot.name);
    actual
}

fn assert_alike(robot: &Robot, other: &Robot, what: &str) {
    let difference = Difference::from_robots(robot, other, 200);
    println!("{what}: {:.1e} m, {:.1e} rad", difference.position_m, difference.rotation_rad);
    assert!(difference.is_within(1e-12, 1e-12), "{what}: {difference:?}");
}

#[test]
fn branches_are_written_into_the_urdf_and_into_new_models() {
    let document = torso();
    let unchanged = document.patch(document.robot()).unwrap();
    assert_eq!((unchanged.text.as_str(), unchanged.notes.len()), (TORSO, 0));
    for seed in 0..10 {
        let robot = perturb_robot(document.robot(), seed);
        let patched = document.patch(&robot).unwrap();
        let again = UrdfDocument::parse(&patched.text, "torso.urdf", &patched.selection).unwrap();
        assert_alike(&robot, again.robot(), "patched");
        // The hands have fixed joints of their own; other joints stand on the torso.
        assert_eq!(patched.tip_link, "left_hand");
        assert_eq!(patched.selection.instruments, pairs(&[("eyes", "head_camera"), ("chest", "torso_calibrated")]));
        assert_eq!(patched.notes.len(), 1, "{:?}", patched.notes);

        let toml = robot_toml::write(&robot);
        let read = robot_toml::parse(&toml, "torso.toml").unwrap();
        assert_alike(&robot, &read, "TOML");
        let model = Model { robot: read, source: ModelSource::Toml, path: "torso.toml".into() };
        for form in [ModelFormat::Urdf, ModelFormat::Toml] {
            convert(&model, form).unwrap();
        }
    }
    // A frame that differs is noticed, whichever it is.
    let robot = document.robot();
    for index in 0..2 {
        let mut other = robot.clone();
        other.mounted[index].pose.translation += Vector3::new(0.0, 1e-3, 0.0);
        assert!((Difference::from_robots(robot, &other, 20).position_m - 1e-3).abs() < 1e-12);
        let mut other = robot.clone();
        other.instruments[index].pose.translation.x += 1e-3;
        assert!((Difference::from_robots(robot, &other, 20).position_m - 1e-3).abs() < 1e-12);
        other.instruments.remove(index);
        assert!(Difference::from_robots(robot, &other, 20).position_m.is_nan());
    }
}

#[test]
fn a_toml_model_says_on_which_link_everything_stands() {
    let text = |parent: &str, on: &str| {
        format!(
            "poecal_robot = 1\nname = \"y\"\nlength_unit = \"mm\"\nangle_unit = \"deg\"\ntip_on = \"a\"\njoint = [\n\
             {{ name = \"a\", point = [0, 0, 0], direction = [0, 0, 1] }},\n\
             {{ name = \"b\", point = [0, 100, 0], direction = [0, 0, 1], parent = \"{parent}\" }},\n]\n\
             [home]\nposition = [100, 0, 0]\n[[target]]\nname = \"ball\"\non = \"{on}\"\nposition = [0, 300, 0]\n\
             [[instrument]]\nname = \"eye\"\non = \"a\"\nposition = [50, 0, 0]\n"
        )
    };
    let robot = robot_toml::parse(&text("base", "b"), "y.toml").unwrap();
    assert_eq!((robot.joints[1].stands_on, robot.tip), (Some(Body::Base), Some(Body::Link(0))));
    let turned = [0.0, std::f64::consts::FRAC_PI_2];
    let ball = robot.with_tip_at(&robot.mounted[0]).forward_kinematics(&turned);
    assert!((ball.translation - Vector3::new(-0.2, 0.1, 0.0)).norm() < 1e-15, "{}", ball.translation);
    let error = |parent: &str, on: &str| robot_toml::parse(&text(parent, on), "y.toml").unwrap_err().to_string();
    assert_eq!(
        error("b", "b"),
        "y.toml:8:68: `parent` of joint `b` is joint `b`, which comes after it, expected one of the joints before: put it after its parent"
    );
    let unknown = error("base", "arm");
    assert!(
        unknown.starts_with("y.toml:14:6: `on` of target `ball` is `arm`, expected a joint of this model or `base`, "),
        "{unknown}"
    );
    let dh = "poecal_robot = 1\nname = \"d\"\nlength_unit = \"m\"\nangle_unit = \"rad\"\nconvention = \"standard_dh\"\n\
              joint = [{ name = \"a\", a = 1 }, { name = \"b\", a = 1, parent = \"base\" }]\n";
    let error = robot_toml::parse(dh, "d.toml").unwrap_err().to_string();
    assert!(error.starts_with("d.toml:6:") && error.contains("found `parent` in a DH model"), "{error}");
}

#[test]
fn a_calibration_of_two_hands_keeps_its_branches() {
    let nominal = torso().robot().clone();
    let simulation = Simulation { count: 300, ..Simulation::default() };
    let made = simulation.run(&nominal, SessionKind::POSE).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let held_out = calibration.accuracy.held_out.unwrap().calibrated.position_mm().rms;
    // Noise of 0.05 mm of each component.
    println!("held out: {held_out:.4} mm");
    assert!(held_out < 1.3 * 0.05 * 3f64.sqrt(), "{held_out}");
    // The observations of a pair are as in the actual robot.
    let exact = simulation.held_out(&made, SessionKind::POSE, 40).unwrap();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    let judgement = file.judge(&exact, false, false).unwrap();
    println!("exact rows: {:.4} mm", judgement.calibrated.position_mm().rms);
    assert!(judgement.calibrated.position_mm().rms < 0.05);
    let promised = judgement.promised.unwrap().position_mm();
    assert!(promised.expected_rms < 0.2 && promised.inside_bound95 > 0.9, "{promised:?}");

    let robot = calibration.robot_with_targets();
    assert!(robot.targets.is_empty() && robot.mounted.len() == 2 && robot.instruments.len() == 2);
    assert!((robot.home.translation - robot.base_from(&robot.mounted[0]).translation).norm() < 1e-15);
    let text = file.to_text().unwrap();
    let again = CalibrationFile::parse(&text, "c.json").unwrap();
    assert_alike(&robot, &again.robot().unwrap(), "calibration.json");
    assert_eq!(again.targets["right"].measured_entry(), MeasuredEntry::Pose);
    again.nominal_robot().unwrap().check_tree().unwrap();

    let found = &calibration.identifiability.unidentifiable;
    let [unseen] = &found[..] else { panic!("{found:?}") };
    assert_eq!((unseen.cause, unseen.directions), (Cause::Unseen, 6));
    assert_eq!(
        unseen.description,
        "no measurement sees joints torso1 and torso2 move: no way from an instrument to its target passes them"
    );
}

#[test]
fn plans_and_ways_are_of_all_pairs() {
    let robot = torso().robot().clone();
    let found = ways(&robot, None);
    assert_eq!(found.len(), 4);
    assert_eq!(found[0].joints.join(" "), "head_yaw left1 left2 left3 left4 left5 left6");
    let readings: Vec<f64> = {
        let mut generator = ChaCha8Rng::seed_from_u64(3);
        (0..60).flat_map(|_| random_configuration(&robot, &mut generator)).collect()
    };
    let foresight = identify(&robot, &readings, &PlannedSession::default()).unwrap();
    // 13 revolute joints that are seen, two hands, and the second instrument.
    assert_eq!((foresight.count, foresight.identifiability.rank), (60, 13 * 4 + 12 + 6));
    assert_eq!(foresight.identifiability.unidentifiable[0].cause, Cause::Unseen);
}

#[test]
fn offsets_follow_the_branches() {
    let robot = torso().robot().clone();
    let mut generator = ChaCha8Rng::seed_from_u64(8);
    let offsets: Vec<f64> = robot.joints.iter().enumerate().map(|(k, _)| 0.01 * (k as f64 + 1.0)).collect();
    let equivalent = into_screws(&robot, &offsets).unwrap();
    for mount in robot.instruments.iter().chain(&robot.mounted) {
        let readings = random_configuration(&robot, &mut generator);
        let shifted: Vec<f64> = readings.iter().zip(&offsets).map(|(a, b)| a + b).collect();
        let same = equivalent.instruments.iter().chain(&equivalent.mounted).find(|it| it.name == mount.name).unwrap();
        let (a, b) = (
            equivalent.with_tip_at(same).forward_kinematics(&readings),
            robot.with_tip_at(mount).forward_kinematics(&shifted),
        );
        assert!((a.translation - b.translation).norm() < 1e-14, "{}", mount.name);
    }
    let error = explain(&robot, &equivalent, &OffsetOptions::default()).unwrap_err().to_string();
    assert!(error.starts_with("found branches or joints beyond the tip in the nominal robot"), "{error}");
}
