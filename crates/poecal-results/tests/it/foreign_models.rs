//! Models in forms of simulators and makers: mistakes get one sentence each, with their place.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw};
use poecal_formats::urdf::ChainSelection;
use poecal_results::model::{Model, ModelSource};

fn read(text: &str, name: &str, tip: Option<&str>) -> Result<Model, String> {
    let selection = ChainSelection { tip_link: tip.map(str::to_owned), ..ChainSelection::default() };
    Model::parse(text, name, &selection).map_err(|error| error.to_string())
}

fn check(name: &str, cases: &[(String, &str)]) {
    let mut wrong = 0;
    for (text, expected) in cases {
        let found = match read(text, name, None) {
            Ok(model) => format!("no error: {} joints", model.robot.joints.len()),
            Err(error) => error,
        };
        if found != *expected {
            println!("\nfound:    {found}\nexpected: {expected}");
            wrong += 1;
        }
    }
    assert_eq!(wrong, 0, "of {} sentences are others", cases.len());
}

/// A body with a joint; `joint` goes into the joint's element, `more` behind it, `top` before the bodies.
fn mjcf(top: &str, joint: &str, more: &str) -> String {
    format!(
        "<mujoco model='m'>\n{top}\n<worldbody>\n<body name='a'>\n<joint name='j' {joint}/>\n{more}</body>\n</worldbody></mujoco>"
    )
}

#[test]
fn bad_mjcf_gets_one_sentence_each() {
    #[rustfmt::skip]
    let cases = vec![
        ("<mujoco><worldbody></mujoco>".into(),
         "m.xml:1:20: found broken XML (expected 'worldbody' tag, not 'mujoco'), expected a model of MuJoCo"),
        (mjcf("<include file='arm.xml'/>", "", ""),
         "m.xml:2:1: found <include>, expected bodies alone: save the whole model with MuJoCo, mujoco.mj_saveLastXML(\"whole.xml\", model)"),
        (mjcf("<compiler angle='grad'/>", "", ""),
         "m.xml:2:1: found angle=\"grad\" in <compiler>, expected degree or radian"),
        (mjcf("<compiler eulerseq='xy'/>", "", ""),
         "m.xml:2:1: found eulerseq=\"xy\" in <compiler>, expected three of x, y, z, X, Y, Z"),
        (mjcf("<compiler coordinate='global'/>", "", ""),
         "m.xml:2:1: found coordinate=\"global\" in <compiler>, expected local, as MuJoCo itself since 2.3.4"),
        (mjcf("", "axis='0 0 0'", ""), "m.xml:5:1: found an axis of no length in <joint> `j`"),
        (mjcf("", "axis='0 0'", ""),
         "m.xml:5:23: found 2 numbers in `axis` of <joint> `j` (`0 0`), expected 3 numbers separated by spaces"),
        (mjcf("", "type='screw'", ""),
         "m.xml:5:1: found type=\"screw\" in <joint> `j`, expected hinge, slide, ball or free"),
        (mjcf("", "pos='0 0 x'", ""), "m.xml:5:26: found `x` in `pos` of <joint> `j`, expected a number"),
        (mjcf("", "", "<body quat='0 0 0 0'/>"), "m.xml:6:1: found a quaternion of no length in a <body> without name"),
        (mjcf("", "", "<body euler='nan 0 0'/>"),
         "m.xml:6:14: found `nan` in `euler` of a <body> without name, expected a finite number"),
        (mjcf("<default><joint pos='1 2'/></default>", "", ""),
         "m.xml:2:22: found 2 numbers in `pos` of <joint> `j` (`1 2`), expected 3 numbers separated by spaces"),
        (mjcf("", "type='ball'", ""),
         "m.xml: found no end link with a moving joint above it, expected a serial chain: choose one with --base-link and --tip-link"),
        (mjcf("", "", "<body name='b'><joint/></body><body name='c'><joint/></body>"),
         "m.xml: found 2 end links with a moving joint above them (`b`, `c`), expected one: choose it, or a link before they part (`a`), with --tip-link, and the base, if it is not the root, with \
          --base-link"),
    ];
    check("m.xml", &cases);
}

/// A joint between two links.
fn sdf(joint: &str, more: &str) -> String {
    let joint = if joint.is_empty() { "<axis><xyz>0 0 1</xyz></axis>" } else { joint };
    format!(
        "<sdf version='1.9'><model name='m'>\n<link name='a'/><link name='b'/>\n<joint name='j' type='revolute'><parent>a</parent><child>b</child>\n\
         {joint}</joint>\n{more}</model></sdf>"
    )
}

/// Position of the tip at zero.
fn tip(text: &str, name: &str) -> Vector3<f64> {
    let model = read(text, name, Some("b")).unwrap();
    let q = vec![0.0; model.robot.reading_names().len()];
    model.robot.forward_kinematics(&q).translation
}

#[test]
fn sdf_is_read_around_comments_and_through_frames() {
    let of = |pose: &str, child: &str, more: &str| {
        format!(
            "<sdf version='1.9'><model name='m'><link name='a'/><link name='b'>{pose}</link>{more}\
             <joint name='j' type='revolute'><parent><!-- x -->a</parent><child>{child}</child>\
             <axis><xyz><!-- was 0 0 1 -->0 1 0</xyz></axis></joint></model></sdf>"
        )
    };
    let frame = "<frame name='g' attached_to='b'><pose>1 2 3 .4 .5 .6</pose></frame>";
    let there = Vector3::new(1.0, 2.0, 3.0);
    let commented = of("<pose><!-- x -->1 2 3 .1 .2 .3</pose>", "b", "");
    assert!((tip(&commented, "m.sdf") - there).norm() < 1e-12);
    for word in ["true", "1", "True", " TRUE"] {
        let degrees = of(&format!("<pose degrees='{word}'>1 2 3 90 0 0</pose>"), "b", "");
        let radians = of("<pose>1 2 3 1.5707963267948966 0 0</pose>", "b", "");
        let rotation = |text: &str| read(text, "m.sdf", Some("b")).unwrap().robot.forward_kinematics(&[0.3]).rotation;
        assert!((rotation(&degrees) - rotation(&radians)).norm() < 1e-12, "{word}");
    }
    // The joint turns about the frame's axis, and the link is not at the frame.
    let through = of("<pose>.1 .2 .3 0 0 0</pose>", "g", frame);
    assert!((tip(&through, "m.sdf") - Vector3::new(0.1, 0.2, 0.3)).norm() < 1e-12);
    let robot = read(&through, "m.sdf", Some("b")).unwrap().robot;
    let place = Pose::from_xyz_rpy([1.1, 2.2, 3.3], [0.4, 0.5, 0.6]);
    let axis = Screw::revolute(&(place.rotation * Vector3::y()), &place.translation);
    let known = axis.exp(0.7).act(&Vector3::new(0.1, 0.2, 0.3));
    assert!((robot.forward_kinematics(&[0.7]).translation - known).norm() < 1e-12);
}

#[test]
fn very_large_models_end_soon() {
    let nested = |depth: usize, open: &str, close: &str| open.repeat(depth) + &close.repeat(depth);
    let too_deep = "found more than 200 levels in each other";
    let models = format!(
        "<sdf version='1.9'><model name='m'><link name='a'/>{}<joint name='j' type='fixed'><parent>world</parent><child>a</child></joint></model></sdf>",
        nested(100, "<model name='n'><link name='a'/>", "</model>")
    );
    assert!(read(&models, "m.sdf", None).unwrap_err().contains("more than 64 models in each other"));
    let chain: String = (1..20_000)
        .map(|k| format!("<link name='l{k}'><pose relative_to='l{}'>0 0 1e-4 0 0 0</pose></link>", k - 1))
        .collect();
    let chain = format!(
        "<sdf version='1.9'><model name='m'><link name='l0'/>{chain}<joint name='j' type='revolute'><parent>l0</parent><child>l19999</child></joint></model></sdf>"
    );
    let _ = read(&chain, "m.sdf", None);
    let bodies = format!("<mujoco><worldbody>{}</worldbody></mujoco>", nested(20_000, "<body><joint/>", "</body>"));
    assert!(read(&bodies, "m.xml", None).unwrap_err().contains(too_deep));
    let classes: String = (0..20_000).map(|k| format!("<default class='c{k}'>")).collect();
    let classes = mjcf(&(classes + &"</default>".repeat(20_000)), "", "");
    assert!(read(&classes, "m.xml", None).unwrap_err().contains(too_deep));
    let origin = "{x: 0, y: 0, z: 0.1, roll: 0, pitch: 0, yaw: 0}";
    let joints: String = (1..=20_000).map(|k| format!("  joint{k}: {origin}\n")).collect();
    assert!(read(&format!("kinematics:\n{joints}"), "arm.yaml", None).unwrap_err().contains("at most 1000"));
}

#[test]
fn bad_sdf_gets_one_sentence_each() {
    #[rustfmt::skip]
    let cases = vec![
        (sdf("<!-- none -->", ""), "m.sdf:3:1: <joint> `j` has no <axis>, expected its direction"),
        ("<sdf version='1.9'><model name='m'><link name='a'/></model></sdf>".into(),
         "m.sdf:1:1: found no <model> with a <joint>, expected one"),
        (format!("{}{}</sdf>", sdf("", "").trim_end_matches("</sdf>"), "<model name='n'><joint name='k'/></model>"),
         "m.sdf:5:9: found 2 models with joints, expected one: keep the arm's alone in a file"),
        (sdf("", "<include><uri>model://arm</uri></include>"),
         "m.sdf:5:1: found <include>, expected a model in one file: `gz sdf --print FILE` writes it whole"),
        (sdf("<pose relative_to='nowhere'>0 0 0 0 0 0</pose>", ""),
         "m.sdf:3:1: found the frame `nowhere`, which is not in the model, expected a link, joint or frame"),
        (sdf("", "<frame name='f'><pose relative_to='g'/></frame><frame name='g'><pose relative_to='f'/></frame><link name='c'><pose relative_to='f'/></link>\
          <joint name='k' type='fixed'><parent>b</parent><child>c</child></joint>"),
         "m.sdf:5:48: the pose of `k` leads back to itself, expected frames that end at the model"),
        (sdf("", "<link name='a'/>"), "m.sdf:5:1: found <link> `a` twice, expected names that are there once"),
        (sdf("<pose>0 0 0 1</pose>", ""),
         "m.sdf:4:1: found 4 numbers in <pose> of <joint> `j`, expected x y z roll pitch yaw, or x y z and a quaternion with rotation_format=\"quat_xyzw\""),
        (sdf("<pose>0 0 zero 0 0 0</pose>", ""), "m.sdf:4:1: found `zero` in <pose> of <joint> `j`, expected a number"),
        (sdf("<pose>0 0 1e9 0 0 0</pose>", ""),
         "m.sdf:4:1: found 1000000000 in <pose> of <joint> `j`, expected a number of metres or radians below 1e6"),
        (sdf("<axis><xyz>0 0 0</xyz></axis>", ""),
         "m.sdf:4:7: found no direction in <xyz> of <joint> `j`, expected three numbers, not all zero"),
        (sdf("<axis><xyz expressed_in='w'>0 0 1</xyz></axis>", ""),
         "m.sdf:1:1: found the frame `w`, which is not in the model, expected a link, joint or frame"),
        (sdf("", "<joint name='k' type='fixed'><parent>b</parent></joint>"), "m.sdf:5:1: <joint> `k` has no <child>, expected the name of a link"),
        (sdf("", "<joint type='fixed'/>"), "m.sdf:5:1: a <joint> has no attribute `name`, expected name=\"...\""),
        (sdf("", "<link name='c'/><joint name='k' type='hinge'><parent>b</parent><child>c</child></joint>"),
         "m.sdf:5:17: found type=\"hinge\" in <joint> `k`, expected revolute, continuous, prismatic or fixed"),
        (sdf("", "<link name='c'/><joint name='k' type='ball'><parent>b</parent><child>c</child></joint>"), "m.sdf: joint `k` between `a` and `c` is floating, expected revolute, continuous, prismatic or fixed: choose a chain without it with --base-link and --tip-link"),
        (sdf("", "<model name='n' placement_frame='q'><link name='c'/></model>"),
         "m.sdf:5:1: found placement_frame=\"q\" in <model> `n`, expected none: place the model by its <pose>"),
    ];
    check("m.sdf", &cases);
}

/// Origins of six joints of an arm of Universal Robots.
fn driver(change: impl Fn(&str) -> Option<String>) -> String {
    let links = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];
    let numbers = ["x", "y", "z", "roll", "pitch", "yaw"];
    let mut text = "kinematics:\n".to_owned();
    for link in links {
        text.push_str(&format!("  {link}:\n"));
        for number in numbers {
            let line = format!("    {number}: 0.1");
            text.push_str(&change(&format!("{link}.{number}")).unwrap_or(line));
            text.push('\n');
        }
    }
    text + "  hash: calib_1\n"
}

#[test]
fn bad_yaml_gets_one_sentence_each() {
    let of = |at: &'static str, with: &'static str| driver(move |it| (it == at).then(|| with.to_owned()));
    #[rustfmt::skip]
    let cases = vec![
        (driver(|_| None), "no error: 6 joints"),
        (of("forearm.y", "    y: long"),
         "arm.yaml:18:8: found `long` for `kinematics.forearm.y`, expected a number"),
        (of("forearm.y", "    y: .inf"),
         "arm.yaml:18:8: found `.inf` for `kinematics.forearm.y`, expected a number"),
        (of("forearm.y", "    y: 1e7"),
         "arm.yaml:18:8: found `1e7` for `kinematics.forearm.y`, expected a number of metres or radians below 1e6"),
        (of("forearm.y", ""), "arm.yaml: found no `y` of `forearm`, expected x, y, z, roll, pitch, yaw"),
        (of("forearm.y", "    x: 1"),
         "arm.yaml:18:5: found the key `x` twice, expected the origins of an arm's joints in YAML: `kinematics` with `shoulder` … `wrist_3` (Universal \
          Robots) or `joint1` … (uFactory), or `joint1` … `joint8` with `kinematic` (Franka)"),
        (driver(|_| None).replace("forearm", "elbow"),
         "arm.yaml:17:8: found `kinematics.elbow.x`, expected origins of shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3 alone, each of x, y, z, roll, pitch, yaw: is a joint missing?"),
        ("kinematics:\n  joint1: {x: 0, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}\n  joint3: {x: 0, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}\n".into(),
         "arm.yaml:3:15: found `kinematics.joint3.x`, expected origins of joint1 alone, each of x, y, z, roll, pitch, yaw: is a joint missing?"),
        ("kinematics: [1, 2\n".into(),
         "arm.yaml:1:13: found broken YAML (unclosed bracket '['), expected the origins of an arm's joints in YAML: `kinematics` \
          with `shoulder` … `wrist_3` (Universal Robots) or `joint1` … (uFactory), or `joint1` … `joint8` with `kinematic` (Franka)"),
        ("offsets:\n  joint1: 0.1\n".into(),
         "arm.yaml: found `offsets.joint1`, expected the origins of an arm's joints in YAML: `kinematics` with `shoulder` … `wrist_3` (Universal Robots) or \
          `joint1` … (uFactory), or `joint1` … `joint8` with `kinematic` (Franka)"),
    ];
    check("arm.yaml", &cases);
}

const TABLE: &str =
    "[DH]\na = [0, -0.6, -0.5, 0, 0, 0]\nd = [0.2, 0, 0, 0.2, 0.1, 0.1]\nalpha = [1.57, 0, 0, 1.57, -1.57, 0]\n";

#[test]
fn bad_controller_files_get_one_sentence_each() {
    let expected =
        "expected a = [...], d = [...] and alpha = [...] of six numbers in [DH], as in the controller's urcontrol.conf";
    let missing = format!("arm.conf: found no `a` in [DH], {expected}");
    let status = format!("{TABLE}[mounting]\ndelta_a = [0,0,0,0,0,0]\ncalibration_status = 0 # none\n");
    #[rustfmt::skip]
    let cases = vec![
        (TABLE.to_owned(), "no error: 6 joints"),
        ("[mounting]\ndelta_a = [0,0,0,0,0,0]\n".into(), missing.as_str()),
        (TABLE.replace("-0.5, ", ""), "arm.conf:2: found 5 numbers for `a`, expected six numbers in brackets"),
        (TABLE.replace("-0.5, ", "about, "), "arm.conf:2: found `about` for `a`, expected six numbers in brackets"),
        (TABLE.replace("-0.5, ", "inf, "), "arm.conf:2: found `inf` for `a`, expected six numbers in brackets"),
        (TABLE.replace("[0.2, 0, 0, 0.2, 0.1, 0.1]", "0.2"), "arm.conf:3: found `0.2` for `d`, expected six numbers in brackets"),
        (status, "arm.conf:7: found calibration_status = 0, which says that the controller has no calibration, expected 1 or 2: leave the file out and read \
                  urcontrol.conf, the nominal arm"),
    ];
    check("arm.conf", &cases);
}

#[test]
fn a_calibration_without_its_table_says_which_file_is_missing() {
    let folder = std::env::temp_dir().join(format!("poecal_foreign_models_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("calibration.conf");
    std::fs::write(&path, "[mounting]\ndelta_a = [0,0,0,0,0,0]\n").unwrap();
    let error = Model::read(&path, &ChainSelection::default()).unwrap_err().to_string();
    assert!(
        error.ends_with(
            "urcontrol.conf: found no such file, expected the controller's nominal table, without which calibration.conf states differences alone: check the path"
        ),
        "{error}"
    );
    std::fs::write(folder.join("urcontrol.conf"), TABLE.replace("-0.6", "six")).unwrap();
    let error = Model::read(&path, &ChainSelection::default()).unwrap_err().to_string();
    assert!(error.contains("urcontrol.conf:2: found `six` for `a`"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_urdf_that_says_the_same_is_the_document() {
    let model = read(&mjcf("", "range='-90 45'", "<site name='tool' pos='0 0 1'/>"), "m.xml", None).unwrap();
    let ModelSource::Urdf(document) = &model.source else { panic!("{:?}", model.source) };
    assert_eq!((document.form(), model.robot.tip_name.as_str()), ("MJCF", "tool"));
    assert!(document.text().starts_with("<?xml version=\"1.0\"?>\n<robot name=\"m\">"));
    let limits = model.robot.joints[0].limits.unwrap();
    assert!(
        (limits.lower + std::f64::consts::FRAC_PI_2).abs() < 1e-15
            && (limits.upper - std::f64::consts::FRAC_PI_4).abs() < 1e-15
    );
    // An option may name a site, or a frame.
    let two = "<site name='left'/><site name='right' pos='1 0 0'/>";
    assert!(read(&mjcf("", "", two), "m.xml", None).unwrap().robot.tip_name == "a");
    assert_eq!(read(&mjcf("", "", two), "m.xml", Some("right")).unwrap().robot.home.translation.x, 1.0);
    let frame = "<frame name='f' attached_to='j'><pose>0 2 0 0 0 0</pose></frame>";
    assert_eq!(read(&sdf("", frame), "m.sdf", Some("f")).unwrap().robot.home.translation.y, 2.0);
}
