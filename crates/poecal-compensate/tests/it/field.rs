//! Models, tables and programs as used in practice: a base beside the chain, names in cells, two tables side by side, an arm on a track.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_compensate::{Language, ProgramOptions, compensate_program};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_import::{Join, ReadOptions, parse, read};
use poecal_model::robot::{Joint, Robot};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_testing::files::Folder;
use poecal_testing::sessions::lifting_robot;

/// As in Universal Robots' description: the controller's base beside the chain, turned by half a turn, here shifted too.
const BESIDE: &str = r#"<robot name="arm"><link name="base_link"/><link name="base"/><link name="plate"/><link name="upper"/><link name="fore"/><link name="tool0"/>
<joint name="to_plate" type="fixed"><parent link="base_link"/><child link="plate"/><origin xyz="0 0 0.02" rpy="0 0 0.3"/></joint>
<joint name="to_base" type="fixed"><parent link="plate"/><child link="base"/><origin xyz="0.1 0 -0.05" rpy="0 0 3.141592653589793"/></joint>
<joint name="one" type="revolute"><parent link="base_link"/><child link="upper"/><origin xyz="0 0 0.4" rpy="0 0 0.1"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
<joint name="two" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.2 0 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="3"/></joint>
<joint name="end" type="fixed"><parent link="fore"/><child link="tool0"/><origin xyz="0.5 0 0"/></joint></robot>"#;

fn parse_urdf(text: &str, base: &str, tip: Option<&str>) -> UrdfDocument {
    let tip_link = tip.map(str::to_owned);
    let selection = ChainSelection { base_link: Some(base.to_owned()), tip_link, ..ChainSelection::default() };
    UrdfDocument::parse(text, "arm.urdf", &selection).unwrap()
}

#[test]
fn a_base_that_fixed_joints_join_to_the_chain_is_its_base() {
    let base_link = parse_urdf(BESIDE, "base_link", Some("tool0"));
    let plate_from_base = Pose::from_xyz_rpy([0.1, 0.0, -0.05], [0.0, 0.0, std::f64::consts::PI]);
    let base_link_from_base = Pose::from_xyz_rpy([0.0, 0.0, 0.02], [0.0, 0.0, 0.3]) * plate_from_base;
    let q = [0.4, -0.7];
    let in_base_link = base_link.robot().forward_kinematics(&q);
    for tip in [Some("tool0"), None] {
        let base = parse_urdf(BESIDE, "base", tip);
        assert_eq!(base.robot().base_name, "base");
        let (metres, radians) =
            (base_link_from_base * base.robot().forward_kinematics(&q)).distance_and_angle(&in_base_link);
        println!("apart by {metres:.1e} m, {radians:.1e} rad");
        assert!(metres < 1e-15 && radians < 1e-15);
        // A calibration in this base is written into the joints below the other one, and read again.
        let shift = Pose::from_xyz_rpy([1e-3, -2e-3, 5e-4], [1e-3, 2e-3, -1e-3]);
        let screws: Vec<Screw> = base.robot().joints.iter().map(|joint| joint.screw.transform(&shift)).collect();
        let calibrated = base.robot().with_screws(&screws);
        let patched = base.patch(&calibrated).unwrap();
        let again = UrdfDocument::parse(&patched.text, "arm.urdf", &patched.selection).unwrap();
        let (metres, radians) =
            again.robot().forward_kinematics(&q).distance_and_angle(&calibrated.forward_kinematics(&q));
        println!("written and read: {metres:.1e} m, {radians:.1e} rad");
        assert!(metres < 1e-14 && radians < 1e-14 && patched.text.contains("xyz=\"0.1 0 -0.05\""));
    }
    // A base behind a moving joint is rejected, and a base above the tip is as before.
    let moved = BESIDE.replace("name=\"to_base\" type=\"fixed\"", "name=\"to_base\" type=\"continuous\"");
    let selection = ChainSelection {
        base_link: Some("base".to_owned()),
        tip_link: Some("tool0".to_owned()),
        ..ChainSelection::default()
    };
    let error = UrdfDocument::parse(&moved, "arm.urdf", &selection).unwrap_err().to_string();
    assert!(
        error.contains(
            "expected a base link above the tip (`fore`, `upper`, `base_link`), or one that fixed joints join to these"
        ),
        "{error}"
    );
}

#[test]
fn an_instrument_on_a_base_beside_the_chain_is_where_it_is() {
    let selection = ChainSelection {
        base_link: Some("base".to_owned()),
        tip_link: Some("tool0".to_owned()),
        instruments: vec![("camera".to_owned(), "base".to_owned()), ("scanner".to_owned(), "base_link".to_owned())],
        ..ChainSelection::default()
    };
    let error = UrdfDocument::parse(BESIDE, "arm.urdf", &selection);
    let document = match error {
        Ok(document) => document,
        // An instrument is below the base or on it; one beside it is reported.
        Err(error) => {
            println!("{error}");
            assert!(error.to_string().contains("instrument"), "{error}");
            return;
        }
    };
    let robot = document.robot();
    let camera = robot.base_from(&robot.instruments[0]);
    assert!(camera.distance_and_angle(&Pose::identity()).0 < 1e-15);
    let patched = document.patch(robot).unwrap();
    assert_eq!(patched.text, BESIDE);
}

#[test]
fn joints_are_named_in_cells() {
    let text = "%time,field.name0,field.name1,field.name2,field.position0,field.position1,field.position2,x[mm],y[mm],z[mm]\n\
                1,b,a,lift,0.5,1.5,0.25,100,200,300\n2,b,a,lift,0.6,1.4,0.2,110,200,300\n";
    let file = parse(text, "states.csv", &lifting_robot(), &ReadOptions::default()).unwrap();
    assert_eq!(file.data.readings(0), [1.5, 0.25, 0.5]);
    let brackets =
        text.replace("field.name", "/joint_states/name[").replace("field.position", "/joint_states/position[");
    let brackets = brackets.replacen("0,", "0],", 2).replacen("1,", "1],", 2).replacen("2,", "2],", 2);
    let file = parse(&brackets, "states.csv", &lifting_robot(), &ReadOptions::default());
    assert_eq!(file.unwrap().data.readings(1), [1.4, 0.2, 0.6]);
    // Another publisher's order is not read as this one.
    let mixed = text.replace("2,b,a,lift", "2,a,b,lift");
    let error = parse(&mixed, "states.csv", &lifting_robot(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(
        error.starts_with(
            "states.csv:3:3: found the joint `a` in column `field.name0`, expected `b` as in the first row"
        ),
        "{error}"
    );
}

#[test]
fn two_tables_side_by_side_are_one_if_it_is_said_of_few_rows() {
    let folder = Folder::new();
    let joints = folder.write("joints.csv", "a,lift,b\n0.1,0.2,0.3\n");
    let points = folder.write("points.csv", "x,y,z\n1,2,3\n");
    for files in [[&joints, &points], [&points, &joints]] {
        let error = read(&files, &lifting_robot(), &ReadOptions::default()).unwrap_err();
        let error = folder.without_path(&error.to_string());
        println!("{error}");
        assert!(error.starts_with("points.csv: found one configuration, with which nothing shows"), "{error}");
        // The advice is followed.
        let rows = ReadOptions { join: Some(Join::Rows), ..ReadOptions::default() };
        let both = read(&files, &lifting_robot(), &rows).unwrap();
        assert_eq!(
            (both.data.readings(0), both.data.observations[0].measurement.pose().translation),
            (&[0.1, 0.2, 0.3][..], Vector3::new(1.0, 2.0, 3.0))
        );
    }
}

/// An arm of six axes on a track, which is the first joint of the model.
fn on_a_track() -> Robot {
    let arm = elbow();
    let mut joints = vec![Joint::prismatic("track", Screw::prismatic(&Vector3::x()))];
    joints.extend(arm.joints.iter().cloned());
    Robot::new("track", joints, arm.home).unwrap()
}

#[test]
fn external_axes_that_are_slides_of_the_model_hold_and_the_arm_is_corrected_for_them() {
    let nominal = on_a_track();
    let simulation = Simulation {
        count: 1,
        error_rotation_rad: 0.02_f64.to_radians(),
        error_position_m: 0.2e-3,
        ..Simulation::default()
    };
    let actual = simulation.run(&nominal, SessionKind::POSE).unwrap().actual;
    let degrees = [10.0, 20.0, -15.0, 40.0, 50.0, 60.0];
    let at = |track_m: f64, by: f64| {
        let mut q = vec![track_m];
        q.extend(degrees.iter().map(|it: &f64| (it + by).to_radians()));
        nominal.forward_kinematics(&q)
    };
    let (one, other) = (at(1.054_423, 3.0), at(0.8, 5.0));
    let millimetres =
        |pose: &Pose| pose.translation.iter().map(|it| format!("{:.9}", 1e3 * it)).collect::<Vec<_>>().join(",");
    let quaternion = |pose: &Pose| {
        let [x, y, z, w] = pose.quaternion_xyzw();
        format!("{w:.12},{x:.12},{y:.12},{z:.12}")
    };
    let none = "9E9,9E9,9E9,9E9,9E9";
    let target = |pose: &Pose, track: &str| {
        format!("[[{}],[{}],[0,0,0,0],[{track},{none}]]", millimetres(pose), quaternion(pose))
    };
    let rapid = format!(
        "MODULE M\nPROC main()\nConfL\\Off;\nConfJ\\Off;\nMoveAbsJ [[10,20,-15,40,50,60],[1054.423,{none}]]\\NoEOffs,v100,fine,tool0;\n\
         MoveL {},v100,fine,tool0;\nMoveJ {},v100,fine,tool0;\nENDPROC\nENDMODULE\n",
        target(&one, "1054.423"),
        target(&other, "800")
    );
    let abc = |pose: &Pose| {
        let [c, b, a] = rotation::to_rpy(&pose.rotation).map(f64::to_degrees);
        let [x, y, z]: [f64; 3] = pose.translation.into();
        format!("X {:.9},Y {:.9},Z {:.9},A {a:.9},B {b:.9},C {c:.9}", 1e3 * x, 1e3 * y, 1e3 * z)
    };
    let krl = format!(
        "DEF job()\nPTP {{A1 10,A2 20,A3 -15,A4 40,A5 50,A6 60,E1 1054.423}}\nLIN {{{},E1 1054.423}}\nEND\n",
        abc(&one)
    );
    let joints = "J1= 10 deg,J2= 20 deg,J3= -15 deg,J4= 40 deg,J5= 50 deg,J6= 60 deg";
    let fanuc = format!(
        "/PROG P\n/MN\n1:J P[1] 100% FINE ;\n/POS\nP[1]{{\n GP1:\n UF : 0, UT : 1, {joints}, E1= 1054.423 mm\n}};\n/END\n"
    );
    for (language, text, count) in [(Language::Rapid, rapid, 3), (Language::Krl, krl, 2), (Language::Fanuc, fanuc, 1)] {
        let mut options = ProgramOptions { check: true, ..ProgramOptions::new(language) };
        if language == Language::Krl {
            options.given.add_tool("0,0,0,0,0,0", language).unwrap();
            options.given.add_frame("0,0,0,0,0,0", language).unwrap();
        }
        let (made, summary) = compensate_program(text.as_bytes(), (&nominal, &actual), &[], &options).unwrap();
        let checked = summary.changes.checked.unwrap();
        println!("{language:?}: {} corrected, {:?}", summary.corrected, checked);
        assert!(summary.is_whole() && summary.corrected == count, "{:#?}", summary.changes.listed);
        assert!(checked.left_m.value < 2e-9 && summary.changes.moved_m.value > 1e-4);
        // The track stays as in the program.
        let made = String::from_utf8(made).unwrap();
        let tracks = |text: &str| text.matches("1054.423").count() + text.matches("[800,").count();
        assert!(tracks(&made) == tracks(&text) && made != text);
    }
    // Without a value there is no position.
    let lacking = "MODULE M\nPROC main()\nMoveAbsJ [[10,20,-15,40,50,60],[9E9,9E9,9E9,9E9,9E9,9E9]]\\NoEOffs,v100,fine,tool0;\nENDPROC\nENDMODULE\n";
    let options = ProgramOptions::new(Language::Rapid);
    let (_, summary) = compensate_program(lacking.as_bytes(), (&nominal, &actual), &[], &options).unwrap();
    assert!(summary.changes.listed[0].reason.contains("it states no value of an external axis that the model has"));
}
