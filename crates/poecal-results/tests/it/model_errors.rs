//! Bad robot models: each results in one sentence with its place, what was found and what was expected.

use poecal_formats::robot_toml;
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_results::model::Model;

/// A URDF of links a, b, c, with joint `j` from a to b; `{joint}` goes into joint `j`, `{more}` after it.
fn urdf(joint: &str, more: &str) -> String {
    format!(
        "<robot name='r'>\n<link name='a'/><link name='b'/><link name='c'/>\n\
         <joint name='j' type='revolute'><parent link='a'/><child link='b'/>\n{joint}</joint>\n{more}</robot>\n"
    )
}

/// A fixed or other joint from one link to another.
fn joint(name: &str, kind: &str, parent: &str, child: &str) -> String {
    format!("<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/></joint>\n")
}

fn urdf_error(text: &str, base: Option<&str>, tip: Option<&str>) -> String {
    let selection = ChainSelection {
        base_link: base.map(str::to_owned),
        tip_link: tip.map(str::to_owned),
        ..ChainSelection::default()
    };
    match UrdfDocument::parse(text, "r.urdf", &selection) {
        Ok(urdf) => format!("no error: {:?}", urdf.robot()),
        Err(error) => error.to_string(),
    }
}

#[test]
fn what_is_said_twice_alike_counts_once() {
    let limit = "<limit lower='-1' upper='1' effort='0'/>";
    let twice = urdf(&format!("{limit}<limit effort='0' upper='1' lower='-1'/><child link='b'/>"), "");
    let read = |text: &str| UrdfDocument::parse(text, "r.urdf", &ChainSelection::default()).unwrap();
    assert_eq!(read(&twice).robot(), read(&urdf(limit, "")).robot());
}

#[test]
fn what_is_not_read_is_not_judged() {
    let plain = urdf("<limit lower='-1' upper='1' effort='0'/>", "");
    let read = |text: &str| UrdfDocument::parse(text, "r.urdf", &ChainSelection::default());
    let expected = read(&plain).unwrap();
    for more in [
        "<gazebo reference='b'><sensor:camera s:size='1'/><xacro:sensor/></gazebo>",
        "<transmission><xacro:motor joint='j'/></transmission>",
        "<ros2_control><xacro:include filename='x'/></ros2_control>",
        "<!-- <xacro:if value='1'> --><gazebo><![CDATA[<a:b>]]></gazebo>",
    ] {
        let text = urdf("<limit lower='-1' upper='1' effort='0'/>", more);
        let found = read(&text).unwrap_or_else(|error| panic!("{more}: {error}"));
        assert_eq!(found.robot(), expected.robot());
        // The written text keeps every byte of it.
        assert_eq!(found.text(), text);
    }
    let visual = plain.replace(
        "<link name='b'/>",
        "<link name='b'><visual><xacro:grey/></visual><collision><a:b/></collision></link>",
    );
    assert_eq!(read(&visual).unwrap().robot(), expected.robot());
    let error = urdf_error(&urdf("", "<xacro:arm/>"), None, None);
    println!("{error}");
    assert!(error.contains("if it is expanded and this element adds no joints, delete it"), "{error}");
}

#[test]
fn numbers_that_are_no_limits_are_none() {
    let read = |limit: &str| {
        let text = urdf(&format!("<limit {limit} effort='0'/>"), "");
        let urdf = UrdfDocument::parse(&text, "r.urdf", &ChainSelection::default());
        urdf.unwrap_or_else(|error| panic!("{limit}: {error}")).robot().joints[0].limits
    };
    for limit in [
        "lower='-1e16' upper='1e16'",
        "lower='-inf' upper='inf'",
        "lower='-Infinity' upper='+inf'",
        "lower='-1e300' upper='1'",
    ] {
        assert_eq!(read(limit), None, "{limit}");
    }
    assert_eq!(read("lower='-1' upper='2'").map(|it| (it.lower, it.upper)), Some((-1.0, 2.0)));
    let error = urdf_error(&urdf("<limit lower='nan' upper='1' effort='0'/>", ""), None, None);
    assert!(error.contains("found `nan` in `lower`"), "{error}");
    let mjcf = |range: &str| {
        let text = format!(
            "<mujoco><compiler angle='radian'/><worldbody><body name='a'><joint name='j' axis='0 0 1' range='{range}'/><geom size='1'/></body></worldbody></mujoco>"
        );
        let path = std::env::temp_dir().join(format!("poecal-limits-{}.xml", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let model = Model::read(&path, &ChainSelection::default());
        std::fs::remove_file(&path).unwrap();
        model.unwrap_or_else(|error| panic!("{range}: {error}")).robot.joints[0].limits
    };
    assert_eq!(mjcf("-1e16 1e16"), None);
    assert_eq!(mjcf("-inf inf"), None);
    assert_eq!(mjcf("-1 2").map(|it| (it.lower, it.upper)), Some((-1.0, 2.0)));
}

#[test]
fn bad_urdfs_get_one_sentence_each() {
    let two = urdf("", &joint("k", "revolute", "a", "c"));
    #[rustfmt::skip]
    let cases: Vec<(String, &str)> = vec![
        ("<robot><link name='a'></robot>".into(),
         "r.urdf:1:23: found broken XML (expected 'link' tag, not 'robot'), expected a URDF robot description"),
        ("<robot name='r'".into(),
         "r.urdf:1:1: found broken XML (the document does not have a root node), expected a URDF robot description"),
        ("just text".into(),
         "r.urdf:1:1: found broken XML (unknown token), expected a URDF robot description"),
        ("<robot name='r' name='s'/>".into(),
         "r.urdf:1:17: found broken XML (attribute 'name' is already defined), expected a URDF robot description"),
        ("<!DOCTYPE robot [<!ENTITY x 'y'>]>\n<robot/>".into(),
         "r.urdf:1:1: found a document type definition, expected a URDF robot description without one"),
        ("<?xml version='1.0'?>\n  <sdf version='1.7'/>".into(),
         "r.urdf:2:3: found root element <sdf>, expected <robot>, as in every URDF file: `poecal export CALIBRATION --format sdf` \
          writes this form"),
        ("<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n <xacro:arm/></robot>".into(),
         "r.urdf:2:2: found a xacro element, expected plain URDF: expand the file first with `xacro robot.xacro > robot.urdf`"),
        ("<robot>\n <xacro:arm/></robot>".into(),
         "r.urdf:2:2: found a xacro element, expected plain URDF: expand the file first with `xacro robot.xacro > robot.urdf`"),
        (urdf("<origin xyz='0 0 ${h}'/>", ""),
         "r.urdf:4:18: found `${h}` in `xyz` of <origin> of joint `j`, expected a number: this is a xacro file, expand it first with `xacro robot.xacro > robot.urdf`"),
        (urdf("<origin xyz='0 0'/>", ""),
         "r.urdf:4:14: found 2 numbers in `xyz` of <origin> of joint `j` (`0 0`), expected 3 numbers separated by spaces"),
        (urdf("<origin xyz='0 0 1 2'/>", ""),
         "r.urdf:4:14: found 4 numbers in `xyz` of <origin> of joint `j` (`0 0 1 2`), expected 3 numbers separated by spaces"),
        (urdf("<origin xyz='0 0,1 0'/>", ""),
         "r.urdf:4:16: found `0,1` in `xyz` of <origin> of joint `j`, expected a number"),
        (urdf("<origin xyz='0 µ 1'/>", ""),
         "r.urdf:4:16: found `µ` in `xyz` of <origin> of joint `j`, expected a number"),
        (urdf("<origin rpy='0 0  nan'/>", ""),
         "r.urdf:4:19: found `nan` in `rpy` of <origin> of joint `j`, expected a finite number"),
        (urdf("<origin xyz='1e300 0 0'/>", ""),
         "r.urdf:4:14: found `1e300` in `xyz` of <origin> of joint `j`, expected a number of metres or radians below 1e6"),
        (urdf("<origin xyz='0 0 1'/>\n <origin xyz='0 0 2'/>", ""),
         "r.urdf:5:2: found a second <origin> in joint `j`, expected one: the first is in line 4, leave one out"),
        (urdf("<axis xyz='0 0 1'/><axis xyz='0 0 1'/>", ""),
         "r.urdf:4:20: found a second <axis> in joint `j`, expected one: the first is in line 4, leave one out"),
        (urdf("<limit lower='-1' upper='1'/>\n<limit lower='-1' upper='2'/>", ""),
         "r.urdf:5:1: found a second <limit> in joint `j`, expected one: the first is in line 4, leave one out"),
        (urdf("<child link='c'/>", ""),
         "r.urdf:4:1: found a second <child> in joint `j`, expected one: the first is in line 3, leave one out"),
        (urdf("<parent link='c'/>", ""),
         "r.urdf:4:1: found a second <parent> in joint `j`, expected one: the first is in line 3, leave one out"),
        (urdf("<mimic joint='k'/><mimic joint='k' offset='1'/>", &joint("k", "revolute", "b", "c")),
         "r.urdf:4:19: found a second <mimic> in joint `j`, expected one: the first is in line 4, leave one out"),
        (urdf("<axis xyz='0 0 0'/>", ""),
         "r.urdf:4:1: <axis> of joint `j` is 0 0 0, expected a direction, such as 0 0 1"),
        (urdf("<limit lower='1' upper='-1'/>", ""),
         "r.urdf:4:1: <limit> of joint `j` has lower 1 above upper -1, expected lower < upper"),
        (urdf("<limit lower='' upper='1'/>", ""),
         "r.urdf:4:15: found 0 numbers in `lower` of <limit> of joint `j` (``), expected 1 number"),
        (urdf("<mimic joint='jj'/>", ""),
         "r.urdf:4:15: <mimic> of joint `j` names joint `jj`, expected a joint of this file, the nearest is `j`"),
        (urdf("<mimic joint='k'/>", &joint("k", "fixed", "b", "c")),
         "r.urdf:4:15: <mimic> of joint `j` names joint `k`, which is fixed, expected a revolute, continuous or prismatic joint"),
        (urdf("<mimic joint='j'/>", ""),
         "r.urdf:3:1: joint `j` mimics itself through its leaders, expected a leader that is measured"),
        (urdf("", &joint("k", "ball", "b", "c")),
         "r.urdf:5:23: joint `k` has type `ball`, expected revolute, continuous, prismatic, fixed, floating or planar"),
        (urdf("", &joint("j", "fixed", "b", "c")),
         "r.urdf:5:1: found a second joint named `j`, expected unique joint names"),
        (urdf("", &joint("k", "fixed", "b", "C1")),
         "r.urdf:5:61: joint `k` names link `C1`, expected a link of this file, the nearest is `c`"),
        (urdf("", "<joint name='k' type='fixed'><parent link='b'/></joint>"),
         "r.urdf:5:1: joint `k` has no <child>, expected <child link=\"...\"/>"),
        (urdf("", "<joint type='fixed'/>"),
         "r.urdf:5:1: the joint has no attribute `name`, expected name=\"...\""),
        (urdf("", "<link name='b'/>"),
         "r.urdf:5:1: found a second link named `b`, expected unique link names"),
        (urdf("", "<link name=''/>"), "r.urdf:5:7: the link has an empty attribute `name`, expected a value"),
        (urdf("", &(joint("k", "revolute", "a", "c") + &joint("l", "fixed", "b", "c"))),
         "r.urdf:6:1: link `c` is the child of joint `k` and again of joint `l`, expected one parent: a closed chain cannot be read"),
        (urdf("", &joint("k", "fixed", "b", "a")),
         "r.urdf:3:1: joint `j` closes a loop of links, expected a tree with one root link"),
        (two,
         "r.urdf: found 2 end links with a moving joint above them (`b`, `c`), expected one: choose it with --tip-link, and the base, if it is not the root, with --base-link"),
        (urdf("", &joint("k", "floating", "b", "c")),
         "r.urdf:5:1: joint `k` between `a` and `c` is floating, expected revolute, continuous, prismatic or fixed: choose a chain without it with --base-link and --tip-link"),
        ("<robot><link name='a'/></robot>".into(),
         "r.urdf: found no end link with a moving joint above it, expected a serial chain: choose one with --base-link and --tip-link"),
    ];
    check(cases.iter().map(|(text, expected)| (urdf_error(text, None, None), *expected)));
}

#[test]
fn a_selection_that_does_not_fit_gets_one_sentence() {
    let text = urdf("", &joint("k", "fixed", "b", "c"));
    #[rustfmt::skip]
    let cases = [
        (Some("A1"), None,
         "r.urdf: --base-link names link `A1`, expected a link of this file, the nearest is `a`"),
        (None, Some("cc"),
         "r.urdf: --tip-link names link `cc`, expected a link of this file, the nearest is `c`"),
        (None, Some("flange"),
         "r.urdf: --tip-link names link `flange`, expected a link of this file, there are a, b, c"),
        (Some("c"), Some("a"),
         "r.urdf: tip link `a` is not below base link `c`, expected a base link above the tip (there is none)"),
        (Some("c"), Some("b"),
         "r.urdf: found no moving joint between base link `c` and tip link `b`, expected at least one: choose others with --base-link and --tip-link"),
        (Some("b"), Some("c"),
         "r.urdf: found no moving joint between base link `b` and tip link `c`, expected at least one: choose others with --base-link and --tip-link"),
        (Some("b"), None,
         "r.urdf: found no end link with a moving joint above it below base link `b`, expected a serial chain: choose one with --base-link and --tip-link"),
    ];
    check(cases.map(|(base, tip, expected)| (urdf_error(&text, base, tip), expected)));
}

/// A TOML model of one joint with these keys, and more after it.
fn toml(joint: &str, more: &str) -> String {
    format!(
        "poecal_robot = 1\nname = 'r'\nlength_unit = 'mm'\nangle_unit = 'deg'\njoint = [\n  {{ name = 'j', {joint} }},\n]\n{more}"
    )
}

#[test]
fn bad_toml_models_get_one_sentence_each() {
    let home = "home = { position = [0, 0, 500] }\n";
    let axis = "screw = { v = [0, 0, 0], w = [0, 0, 1] }";
    let dh = |joint: &str| toml(joint, "convention = 'modified_dh'\n");
    #[rustfmt::skip]
    let cases: Vec<(String, &str)> = vec![
        ("poecal_robot = 1\nname = ".into(),
         "r.toml:2:8: string values must be quoted, expected literal string"),
        ("a = 1\na = 2".into(), "r.toml:2:1: duplicate key"),
        ("name = 'r'".into(),
         "r.toml:1:1: found no `poecal_robot`, expected a robot model with poecal_robot = 1, the version of its format"),
        (toml(axis, home).replace("robot = 1", "robot = 2"),
         "r.toml:1:16: found version 2 of the robot format, expected poecal_robot = 1"),
        (toml(axis, home).replace("length_unit = 'mm'\n", ""),
         "r.toml:1:1: found no `length_unit`, expected one of m, cm, mm, um: units are stated, not guessed"),
        (toml(axis, home).replace("angle_unit = 'deg'\n", ""),
         "r.toml:1:1: found no `angle_unit`, expected one of rad, deg: units are stated, not guessed"),
        (toml(axis, home).replace("'mm'", "'inch'"),
         "r.toml:3:15: unknown variant `inch`, expected one of `m`, `cm`, `mm`, `um`"),
        (toml(axis, home).replace("angle_unit", "angel_unit"),
         "r.toml:4:1: unknown field `angel_unit`, expected one of `poecal_robot`, `name`, `length_unit`, `angle_unit`, `convention`, `base_link`, `tip_link`, `tip_on`, `joint`, `home`, `base`, `tool`, `target`, `instrument`, `mass`"),
        (toml(axis, ""),
         "r.toml:1:1: found no [home], expected it: the tip's pose in the base at zero joint values"),
        (toml(axis, "home = { rpy = [0, 0, 0] }"),
         "r.toml:8:8: found no `position` in this table, expected it to be stated"),
        (toml(axis, "home = { position = [0, 0, 0], rpy = [0, 0, 0], quaternion_xyzw = [0, 0, 0, 1] }"),
         "r.toml:8:38: [home] has more than one orientation, expected one of quaternion_xyzw, rpy and rotation"),
        (toml(axis, "home = { position = [0, 0, 0], quaternion_xyzw = [0, 0, 0, 2] }"),
         "r.toml:8:50: the quaternion of [home] has length 2.0000, expected a unit quaternion (x, y, z, w)"),
        (toml(axis, "home = { position = [0, 0, 0], rotation = [[1, 0, 0], [0, 1, 0], [0, 0, -1]] }"),
         "r.toml:8:43: the rotation of [home] is a reflection, expected a rotation matrix (determinant +1)"),
        (toml(axis, "home = { position = [0, 0, 0], rotation = [[1, 0, 0.1], [0, 1, 0], [0, 0, 1]] }"),
         "r.toml:8:43: the rows of the rotation of [home] are off perpendicular unit vectors by 0.1000, expected a rotation matrix"),
        (toml(axis, "home = { position = [0, 0, nan] }"),
         "r.toml:8:21: found NaN in [home], expected finite numbers"),
        (toml(axis, "home = { position = [0, 1e300, 0] }"),
         "r.toml:8:21: found 1e297 m or rad in [home], expected numbers below 1e6 m or rad"),
        (toml(axis, "home = { position = [0, 1] }"),
         "r.toml:8:21: invalid length 2, expected an array of length 3"),
        (toml(axis, "home = { position = [0, 1, 'x'] }"),
         "r.toml:8:28: invalid type: string \"x\", expected f64"),
        (toml(axis, &format!("{home}base = {{ position = [0, 0, 0] }}")),
         "r.toml:9:8: found [base] in a model of screws, expected [home] only: it holds the tip's pose"),
        (toml("screw = { v = [0, 0, 0], w = [0, 0, 1.01] }", home),
         "r.toml:6:25: the screw of joint `j` has |w| = 1.0100, expected a unit vector to within 0.002 (revolute joint)"),
        (toml("screw = { v = [0, 0, 1], w = [0, 0, 1] }", home),
         "r.toml:6:25: the screw of joint `j` has v·w = 1.000 mm, expected v perpendicular to w to within 0.500 mm (v = -w × a point of the axis)"),
        (toml("type = 'prismatic', screw = { v = [0, 0, 2] }", home),
         "r.toml:6:45: the screw of joint `j` has |v| = 2.0000, expected a unit vector to within 0.002 (prismatic joint)"),
        (toml("type = 'prismatic', screw = { v = [0, 0, 1], w = [0, 0, 1] }", home),
         "r.toml:6:45: the screw of joint `j` has an angular part w, expected w = [0, 0, 0] since the joint is prismatic"),
        (toml("type = 'ball'", home),
         "r.toml:6:24: unknown variant `ball`, expected `revolute` or `prismatic`"),
        (toml("limits = [0, 1]", home),
         "r.toml:6:12: joint `j` has no axis, expected screw = { v = [...], w = [...] }, or point and direction (a prismatic joint: direction)"),
        (toml("direction = [0, 0, 1]", home),
         "r.toml:6:12: joint `j` has no axis, expected screw = { v = [...], w = [...] }, or point and direction (a prismatic joint: direction)"),
        (toml("point = [0, 0, 0], direction = [0, 0, 0]", home),
         "r.toml:6:48: the direction of joint `j` is zero, expected a direction, such as [0, 0, 1]"),
        (toml(&format!("{axis}, point = [0, 0, 0]"), home),
         "r.toml:6:12: joint `j` has a screw and a point or direction, expected one or the other"),
        (toml(&format!("{axis}, limits = [10, -10]"), home),
         "r.toml:6:68: found limits of joint `j` from 10 to -10, expected [lower, upper] with lower < upper"),
        (toml(&format!("{axis}, mimic = {{ joint = 'j' }}"), home),
         "r.toml:6:12: joint `j` mimics itself through its leaders, expected a leader that is measured"),
        (toml(&format!("{axis} }}, {{ name = 'j', {axis}"), home),
         "r.toml:6:70: found a second joint named `j`, expected unique joint names"),
        (toml("a = 0, alpha = 90, d = 10, theta = 0", home),
         "r.toml:6:21: joint `j` has the DH parameter `a`, expected `screw`, or `point` and `direction`: for a DH table state convention = \"standard_dh\" or \"modified_dh\""),
        (toml(&format!("{axis}, fixed = {{ position = [0, 0, 1] }}"), home),
         "r.toml:6:67: joint `j` has `fixed`, expected it in a DH table only: a screw says where its axis stands in the base, whatever lies between"),
        (dh("fixed = { position = [0, 0, 1], rpy = [0, 0, 0], quaternion_xyzw = [0, 0, 0, 1] }"),
         "r.toml:6:55: `fixed` of joint `j` has more than one orientation, expected one of quaternion_xyzw, rpy and rotation"),
        (dh(axis),
         "r.toml:6:25: joint `j` has `screw`, expected a, alpha, d and theta: the model is a DH table"),
        (dh("a = 0") + home,
         "r.toml:9:8: found [home] in a DH model, expected [base] and [tool]: the home pose follows from the table"),
        (toml(axis, home).replace("'j'", "\"j\\u001b\""),
         "r.toml:6:12: found the control character \\u{1b} in the name of the joint, expected characters that can be seen"),
        (toml(axis, home).replace("'j'", "' '"),
         "r.toml:6:12: the name of the joint is empty, expected a name"),
        (
            "poecal_robot = 1\nname = 'r'\nlength_unit = 'm'\nangle_unit = 'rad'\njoint = []\n".to_owned()
                + home,
            "r.toml: robot `r` has no moving joint, expected at least one revolute, continuous or prismatic joint",
        ),
        (toml(axis, &format!("{home}base_link = 'x'\ntip_link = 'x'")),
         "r.toml:10:12: base and tip are both named `x`, expected two names"),
        (
            toml(
                axis,
                &format!(
                    "{home}target = [{{ name = 't', position = [0, 0, 0] }}, {{ name = 't', position = [0, 0, 0] }}]"
                ),
            ),
            "r.toml:9:58: found a second target named `t`, expected unique target names",
        ),
    ];
    check(cases.iter().map(|(text, expected)| {
        let found = robot_toml::parse(text, "r.toml")
            .map_or_else(|error| error.to_string(), |robot| format!("no error: {robot:?}"));
        (found, *expected)
    }));
}

#[test]
fn files_that_cannot_be_read_get_one_sentence_each() {
    let folder = std::env::temp_dir().join(format!("poecal_model_errors_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    write("empty.urdf", b" \r\n");
    write("latin1.urdf", b"<robot>\n<!-- \xe4 -->\n</robot>");
    write("dh.csv", b"a,alpha,d,theta\n0,90,400,0\n");
    write("points.csv", b"# session\njoint1,x[mm],y[mm]\n0,1,2\n");
    write("one.toml", toml("a = 0", "convention = 'standard_dh'").as_bytes());
    #[rustfmt::skip]
    let cases = [
        (".", ".: found a directory, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json)"),
        ("none.urdf", "none.urdf: found no such file, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json): check the path"),
        ("empty.urdf", "empty.urdf: the file is empty, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json)"),
        ("latin1.urdf",
         "latin1.urdf:2:6: found bytes that are not UTF-8, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json) as UTF-8 text"),
        ("dh.csv",
         "dh.csv:1: found a table of DH parameters (a, alpha, d, theta), expected a robot model: URDF, MJCF, SDF, a calibration.json, or TOML that begins with poecal_robot = 1: write it with convention = \"standard_dh\" or \"modified_dh\" and an entry of `joint` for each row (docs/file-formats.md, TOML)"),
        ("points.csv",
         "points.csv:2: found a table with the columns joint1, x, y, expected a robot model: URDF, MJCF, SDF, a calibration.json, or TOML that begins with poecal_robot = 1: did you swap the arguments? The model comes first"),
        ("one.toml",
         "one.toml: found --base-link or --tip-link, expected neither: this model has one chain only"),
    ];
    let prefix = format!("{}/", folder.display());
    let selection = ChainSelection { tip_link: Some("x".into()), ..Default::default() };
    let found = cases.map(|(name, expected)| {
        let error = Model::read(folder.join(name), &selection).unwrap_err().to_string();
        (error.replace(&prefix, ""), expected)
    });
    std::fs::remove_dir_all(&folder).unwrap();
    check(found);
}

/// Compares all, and shows every difference at once.
fn check(cases: impl IntoIterator<Item = (String, &'static str)>) {
    let mut differences = String::new();
    for (found, expected) in cases {
        if found != expected {
            differences += &format!("found:    {found}\nexpected: {expected}\n");
        }
    }
    assert!(differences.is_empty(), "\n{differences}");
}
