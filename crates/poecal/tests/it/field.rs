//! Models and tables as people of the trade have them: a base beside the chain, names in cells, two tables side by side.

use crate::common::lifting_robot;
use crate::files::Folder;
use nalgebra::Vector3;
use poecal::io::measurements::{ReadOptions, parse, read};
use poecal::io::urdf::{ChainSelection, UrdfDocument};
use poecal::lie::{Pose, Screw};

/// As Universal Robots' description has it: the controller's base beside the chain, turned by half a turn, here shifted too.
const BESIDE: &str = r#"<robot name="arm"><link name="base_link"/><link name="base"/><link name="plate"/><link name="upper"/><link name="fore"/><link name="tool0"/>
<joint name="to_plate" type="fixed"><parent link="base_link"/><child link="plate"/><origin xyz="0 0 0.02" rpy="0 0 0.3"/></joint>
<joint name="to_base" type="fixed"><parent link="plate"/><child link="base"/><origin xyz="0.1 0 -0.05" rpy="0 0 3.141592653589793"/></joint>
<joint name="one" type="revolute"><parent link="base_link"/><child link="upper"/><origin xyz="0 0 0.4" rpy="0 0 0.1"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
<joint name="two" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.2 0 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="3"/></joint>
<joint name="end" type="fixed"><parent link="fore"/><child link="tool0"/><origin xyz="0.5 0 0"/></joint></robot>"#;

fn of(text: &str, base: &str, tip: Option<&str>) -> UrdfDocument {
    let tip_link = tip.map(str::to_owned);
    let selection =
        ChainSelection { base_link: Some(base.to_owned()), tip_link, ..ChainSelection::default() };
    UrdfDocument::parse(text, "arm.urdf", &selection).unwrap()
}

#[test]
fn a_base_that_fixed_joints_join_to_the_chain_is_its_base() {
    let base_link = of(BESIDE, "base_link", Some("tool0"));
    let plate_from_base = Pose::from_xyz_rpy([0.1, 0.0, -0.05], [0.0, 0.0, std::f64::consts::PI]);
    let base_link_from_base = Pose::from_xyz_rpy([0.0, 0.0, 0.02], [0.0, 0.0, 0.3]) * plate_from_base;
    let q = [0.4, -0.7];
    let in_base_link = base_link.robot().forward_kinematics(&q);
    for tip in [Some("tool0"), None] {
        let base = of(BESIDE, "base", tip);
        assert_eq!(base.robot().base_name, "base");
        let (metres, radians) =
            (base_link_from_base * base.robot().forward_kinematics(&q)).apart(&in_base_link);
        println!("apart by {metres:.1e} m, {radians:.1e} rad");
        assert!(metres < 1e-15 && radians < 1e-15);
        // What is calibrated in this base is written into the joints below the other one, and read again.
        let shift = Pose::from_xyz_rpy([1e-3, -2e-3, 5e-4], [1e-3, 2e-3, -1e-3]);
        let screws: Vec<Screw> =
            base.robot().joints.iter().map(|joint| joint.screw.transformed(&shift)).collect();
        let calibrated = base.robot().with_screws(&screws);
        let patched = base.patched(&calibrated).unwrap();
        let again = UrdfDocument::parse(&patched.text, "arm.urdf", &patched.selection).unwrap();
        let (metres, radians) =
            again.robot().forward_kinematics(&q).apart(&calibrated.forward_kinematics(&q));
        println!("written and read: {metres:.1e} m, {radians:.1e} rad");
        assert!(metres < 1e-14 && radians < 1e-14 && patched.text.contains("xyz=\"0.1 0 -0.05\""));
    }
    // By a joint that moves it is none, and a base that is above the tip is as before.
    let moved = BESIDE.replace("name=\"to_base\" type=\"fixed\"", "name=\"to_base\" type=\"continuous\"");
    let selection = ChainSelection {
        base_link: Some("base".to_owned()),
        tip_link: Some("tool0".to_owned()),
        ..ChainSelection::default()
    };
    let error = UrdfDocument::parse(&moved, "arm.urdf", &selection).unwrap_err().to_string();
    assert!(error.contains("expected a base link above the tip (`fore`, `upper`, `base_link`), or one that fixed joints join to these"), "{error}");
}

#[test]
fn an_instrument_on_a_base_beside_the_chain_is_where_it_is() {
    let selection = ChainSelection {
        base_link: Some("base".to_owned()),
        tip_link: Some("tool0".to_owned()),
        instruments: vec![
            ("camera".to_owned(), "base".to_owned()),
            ("scanner".to_owned(), "base_link".to_owned()),
        ],
        ..ChainSelection::default()
    };
    let error = UrdfDocument::parse(BESIDE, "arm.urdf", &selection);
    let document = match error {
        Ok(document) => document,
        // An instrument is below the base or on it; beside it is said.
        Err(error) => {
            println!("{error}");
            assert!(error.to_string().contains("instrument"), "{error}");
            return;
        }
    };
    let robot = document.robot();
    let camera = robot.base_from(&robot.instruments[0]);
    assert!(camera.apart(&Pose::identity()).0 < 1e-15);
    let patched = document.patched(robot).unwrap();
    assert_eq!(patched.text, BESIDE);
}

#[test]
fn joints_are_named_in_cells() {
    let text = "%time,field.name0,field.name1,field.name2,field.position0,field.position1,field.position2,x[mm],y[mm],z[mm]\n\
                1,b,a,lift,0.5,1.5,0.25,100,200,300\n2,b,a,lift,0.6,1.4,0.2,110,200,300\n";
    let file = parse(text, "states.csv", &lifting_robot(), &ReadOptions::default()).unwrap();
    assert_eq!(file.data.readings(0), [1.5, 0.25, 0.5]);
    let brackets = text
        .replace("field.name", "/joint_states/name[")
        .replace("field.position", "/joint_states/position[");
    let brackets = brackets.replacen("0,", "0],", 2).replacen("1,", "1],", 2).replacen("2,", "2],", 2);
    let file = parse(&brackets, "states.csv", &lifting_robot(), &ReadOptions::default());
    assert_eq!(file.unwrap().data.readings(1), [1.4, 0.2, 0.6]);
    // Another publisher's order is not read as this one.
    let mixed = text.replace("2,b,a,lift", "2,a,b,lift");
    let error =
        parse(&mixed, "states.csv", &lifting_robot(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(
        error.starts_with(
            "states.csv:3:3: found the joint `a` in column `field.name0`, expected `b` as in the first row"
        ),
        "{error}"
    );
}

#[test]
fn of_two_tables_side_by_side_the_other_is_named() {
    let folder = Folder::new();
    let joints = folder.write("joints.csv", "a,lift,b\n0.1,0.2,0.3\n");
    let points = folder.write("points.csv", "x,y,z\n1,2,3\n");
    for (files, words) in [
        (
            [&joints, &points],
            "joints.csv:1: found no column `x`, expected it beside the others: points.csv has it, so the two are parts of one table",
        ),
        (
            [&points, &joints],
            "points.csv:1: found no column `a`, expected it beside the others: joints.csv has it",
        ),
    ] {
        let error = read(&files, &lifting_robot(), &ReadOptions::default()).unwrap_err();
        let error = folder.without_path(&error.to_string());
        println!("{error}");
        assert!(error.starts_with(words), "{error}");
    }
    // The advice, followed.
    folder.write("both.csv", "a,lift,b,x,y,z\n0.1,0.2,0.3,1,2,3\n");
    let both = read(&[folder.path("both.csv")], &lifting_robot(), &ReadOptions::default()).unwrap();
    assert_eq!(
        (both.data.len(), both.data.observations[0].measurement.pose().translation),
        (1, Vector3::new(1.0, 2.0, 3.0))
    );
}
