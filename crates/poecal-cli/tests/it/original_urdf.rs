//! URDF in, the same text with other numbers out: by every path from a result back to a URDF, from any folder.

use crate::folder::Folder;

/// A chain of three joints with all elements that a calibration must not change.
const PLAIN: &str = r#"<robot name="arm">
  <link name="base"><visual><geometry><mesh filename="package://arm/base.stl" scale="0.001 0.001 0.001"/></geometry></visual></link>
  <link name="upper"><visual><origin xyz="0 0 0.1" rpy="0 0 0"/><geometry><mesh filename="upper.dae"/></geometry></visual>
    <inertial><origin xyz="0.1 0 0"/><mass value="3.2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="lower"/>
  <link name="wrist"/>
  <link name="tool"/>
  <joint name="j1" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="10" velocity="1"/></joint>
  <joint name="j2" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.1 0 0.2" rpy="0 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="10" velocity="1"/></joint>
  <joint name="j3" type="revolute"><parent link="lower"/><child link="wrist"/><origin xyz="0.4 0 0" rpy="0 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="10" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="wrist"/><child link="tool"/><origin xyz="0.2 0.05 0.03" rpy="0 0.1 0"/></joint>
</robot>
"#;

/// Ten texts of the same arm, each with a name and the options of its reading.
fn texts() -> Vec<(&'static str, String, &'static str)> {
    let last = "</robot>\n";
    let with = |more: &str| PLAIN.replace(last, &format!("{more}{last}"));
    let camera = r#"  <link name="camera"><visual><geometry><mesh filename="camera.stl"/></geometry></visual></link>
  <joint name="camera_mount" type="fixed"><parent link="upper"/><child link="camera"/><origin xyz="0 0.1 0" rpy="1.57 0 0"/></joint>
"#;
    let fingers = r#"  <link name="left"/> <link name="right"/>
  <joint name="left" type="prismatic"><parent link="tool"/><child link="left"/><axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="1" velocity="1"/></joint>
  <joint name="right" type="prismatic"><parent link="tool"/><child link="right"/><axis xyz="0 -1 0"/><mimic joint="left"/><limit lower="0" upper="0.04" effort="1" velocity="1"/></joint>
"#;
    let transmission = r#"  <transmission name="t1"><type>transmission_interface/SimpleTransmission</type>
    <joint name="j1"><hardwareInterface>hardware_interface/PositionJointInterface</hardwareInterface></joint>
    <actuator name="m1"><mechanicalReduction>100</mechanicalReduction></actuator></transmission>
  <gazebo reference="upper"><material>Gazebo/Orange</material></gazebo>
"#;
    let control = "  <ros2_control name=\"arm\" type=\"system\"><hardware><plugin>mock/System</plugin></hardware><joint name=\"j1\"/></ros2_control>\n";
    vec![
        ("plain", PLAIN.to_owned(), ""),
        ("comments", PLAIN.replace("  <joint", "  <!-- <origin xyz=\"9 9 9\"/> -->\n  <joint"), ""),
        ("windows", format!("<?xml version=\"1.0\"?>\r\n{}", PLAIN.replace('\n', "\r\n")), ""),
        ("tabs", PLAIN.replace("  ", "\t").replace("xyz=\"0.1 0 0.2\"", "xyz=\"  0.1\t0  0.2 \""), ""),
        ("apostrophes", PLAIN.replace('"', "'"), ""),
        ("turned round", PLAIN.replace("xyz=\"0 0 0.3\" rpy=\"0 0 0\"", "rpy = \"0 0 0\"   xyz= \"0 0 0.3\""), ""),
        ("transmissions", with(&format!("{transmission}{control}")), ""),
        ("camera", with(camera), " --tip-link tool"),
        ("fingers", with(fingers), " --tip-link tool"),
        (
            "no origin",
            PLAIN
                .replace("<origin xyz=\"0.4 0 0\" rpy=\"0 0 0\"/>\n", "<!-- none -->\n")
                .replace("0.2 0.05 0.03", "0.6 0.05 0.03"),
            "",
        ),
    ]
}

/// A text without the numbers of origins and axes of joints, and without origins that were added.
fn without_numbers(text: &str) -> String {
    let mut found = String::new();
    for (at, part) in text.split("<joint").enumerate() {
        let (joint, rest) = match part.split_once("</joint>") {
            Some((joint, rest)) if at > 0 => (joint, Some(rest)),
            _ => ("", None),
        };
        found.push_str(if at > 0 { "<joint" } else { "" });
        let Some(rest) = rest else {
            found.push_str(part);
            continue;
        };
        let mut blank = String::new();
        for (k, piece) in joint.split('<').enumerate() {
            let is_ours = piece.starts_with("origin") || piece.starts_with("axis");
            blank.push_str(if k > 0 { "<" } else { "" });
            blank.extend(piece.chars().filter(|c| !is_ours || !(c.is_ascii_digit() || " .-e\t".contains(*c))));
        }
        // An added origin.
        found.push_str(&blank.replace("<originxyz=\"\"rpy=\"\"/>", ""));
        found.push_str("</joint>");
        found.push_str(rest);
    }
    found.replace("<originxyz=\"\"rpy=\"\"/>", "")
}

/// A folder with a calibration in `out` of a URDF `robot.urdf`.
fn folder_with_calibration(text: &str, chain: &str) -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", text);
    let run = folder.run(&format!("simulate robot.urdf{chain} --kind pose --count 40 --out session --quiet"));
    assert_eq!(run.code, 0, "{}", run.err);
    let run = folder.run(&format!("calibrate robot.urdf session/measurements.csv{chain} --out out --quiet"));
    assert_eq!(run.code, 0, "{}", run.err);
    folder
}

#[test]
fn every_way_back_keeps_the_text() {
    for (name, text, chain) in texts() {
        let folder = folder_with_calibration(&text, chain);
        let first = std::fs::read_to_string(folder.path("out/calibrated.urdf")).unwrap();
        assert_eq!(without_numbers(&first), without_numbers(&text), "{name}");
        assert_ne!(first, text, "{name}");
        // From another folder, in which the URDF is missing.
        std::fs::rename(folder.path("robot.urdf"), folder.path("away.urdf")).unwrap();
        for command in [
            "export out/calibration.json --format urdf",
            "export out/calibration.json --format urdf",
            "export out/calibration.json --format urdf --onto away.urdf",
            "export out/calibration.json --onto away.urdf",
        ] {
            let run = folder.run(command);
            assert_eq!((run.code, run.err.as_str()), (0, ""), "{name}: {command}");
            assert_eq!(run.out, first, "{name}: {command}");
        }
        println!("{name}: {} bytes, the same by every way", first.len());
    }
}

/// A URDF with the same kinematics is accepted, with a note; another robot is refused, and nothing written.
#[test]
fn another_robot_is_told() {
    let folder = folder_with_calibration(PLAIN, "");
    folder.write("painted.urdf", PLAIN.replace("upper.dae", "painted.dae"));
    let run = folder.run("export out/calibration.json --onto painted.urdf --out done.urdf");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.err.contains("is not the text that was calibrated"), "{}", run.err);
    assert!(std::fs::read_to_string(folder.path("done.urdf")).unwrap().contains("painted.dae"));
    let cases = [
        (
            "renamed",
            PLAIN.replace("name=\"j2\"", "name=\"shoulder\""),
            "found the joint `shoulder`, expected those of the robot that was calibrated: j1, j2, j3",
        ),
        (
            "moved",
            PLAIN.replace("0.1 0 0.2", "0.1 0 0.205"),
            "first at joint `j2`, which is 5.000 mm and 0.0000 deg from there",
        ),
        ("other", PLAIN.replace("\"tool\"", "\"gripper\""), "tool"),
    ];
    for (name, text, expected) in cases {
        folder.write("wrong.urdf", text);
        let before = folder.listing();
        let run = folder.run("export out/calibration.json --onto wrong.urdf --out wrong_out.urdf");
        assert_eq!(run.code, 2, "{name}: {}", run.err);
        assert!(run.err.contains(expected) && run.err.lines().count() == 1, "{name}: {}", run.err);
        assert_eq!(folder.listing(), before, "{name}");
    }
    for (command, expected) in [
        ("export robot.urdf --onto robot.urdf", "found a model, expected the calibration.json"),
        ("export out/calibration.json --format kuka", "KUKA's absolute accuracy"),
        ("export out/calibration.json --format mjcf --hash 3", "found --hash beside another form"),
        ("export out/calibration.json --format ur", "found 3 joints, expected the 6 of an arm of Universal Robots"),
        ("export robot.urdf --format offsets", "expected the calibration.json"),
        ("export robot.urdf --format pal", "found no URDF in the calibration"),
    ] {
        let run = folder.run(command);
        assert_eq!(run.code, 2, "{command}: {}", run.err);
        assert!(run.err.contains(expected), "{command}: {}", run.err);
    }
}

/// Differences that are added to the origins of the URDF result in the fitted robot.
#[test]
fn differences_of_origins() {
    let folder = folder_with_calibration(PLAIN, "");
    let run = folder.run("export out/calibration.json --format pal");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    println!("{}", run.out);
    assert!(run.out.contains("robot_state_publisher:\n  geometric_calibration:\n") && run.out.contains("    j2_dx: "));
    let number = |key: &str| -> f64 {
        let line = run.out.lines().find(|line| line.trim_start().starts_with(&format!("{key}: "))).unwrap();
        line.split(": ").nth(1).unwrap().parse().unwrap()
    };
    let urdf = std::fs::read_to_string(folder.path("out/calibrated.urdf")).unwrap();
    let origin = urdf.split("name=\"j2\"").nth(1).unwrap().split("xyz=\"").nth(1).unwrap().split('"').next().unwrap();
    let x: f64 = origin.split(' ').next().unwrap().parse().unwrap();
    assert!((0.1 + number("j2_dx") - x).abs() < 1e-15);
}
