//! Measurement files that are correct although unusual, and the effects of the options.

use poecal_import::{ColumnMap, FitWhere, ReadOptions, read};
use poecal_testing::files::Folder;
use poecal_testing::sessions::lifting_robot;

/// Few moving joints, small motions and targets far from the tip are no sign of another unit.
#[test]
fn a_spread_that_units_do_not_explain_is_left_alone() {
    let cases: &[&str] = &[
        "a,lift,b,x[mm],y[mm],z[mm]\n0,0,0,1,0,0.3\n1,0,0,0.54,0.84,0.3\n2,0,0,-0.42,0.91,0.3\n",
        "a,lift,b,x,y,z\n0.2,0,0,1,0,0.3\n0.2,0.001,0,1,0,0.3\n0.2,0.002,0,1,0,0.302\n0.2,0.003,0,1,0,0.303\n",
        "a[deg],lift,b[deg],x,y,z\n0,0,0,5,0,0\n1,0,0,5,0.087,0\n2,0,0,5,0.17,0\n3,0,0,5,0.26,0\n",
        "a,lift,b,x,y,z\n0,0,0,9,0,0\n1,0,0,4.8,7.5,0\n2,0,0,-3.7,8.1,0\n3,0,0,-8.9,1.2,0\n",
    ];
    let folder = Folder::new();
    for text in cases {
        let result = read(&[folder.write("points.csv", text)], &lifting_robot(), &ReadOptions::default());
        assert!(result.is_ok(), "{text}: {result:?}");
    }
}

#[test]
fn sets_that_are_ignored_are_not_required() {
    let folder = Folder::new();
    let mapping = ColumnMap::parse("set = { column = \"stage\", fit = [\"one\"] }", "map.toml").unwrap();
    let train_where: FitWhere = "run=1".parse().unwrap();
    let texts = [
        "a,lift,b,x,y,z\n0,0,0,0.1,0.2,0.3\n",
        "a,lift,b,x,y,z,stage\n0,0,0,0.1,0.2,0.3,two\n",
        "a,lift,b,x,y,z,set\n0,0,0,0.1,0.2,0.3,other\n",
    ];
    for text in texts {
        let path = folder.write("points.csv", text);
        for (mapping, train_where) in
            [(None, None), (Some(mapping.clone()), None), (Some(mapping.clone()), Some(train_where.clone()))]
        {
            let options = ReadOptions { mapping, train_where, ignore_sets: true, ..ReadOptions::default() };
            let file = read(&[&path], &lifting_robot(), &options).unwrap();
            assert_eq!(file.data.observations[0].set, None, "{text}");
        }
    }
}

#[test]
fn a_joint_may_have_the_name_of_a_position_column() {
    let folder = Folder::new();
    let mut robot = lifting_robot();
    let joint = &mut robot.joints[0];
    for name in [&mut joint.name, &mut joint.reading.name] {
        "x".clone_into(name);
    }
    let message = |text: &str, options: &ReadOptions| match read(&[folder.write("points.csv", text)], &robot, options) {
        Ok(_) => "no error".to_owned(),
        Err(error) => folder.without_path(&error.to_string()),
    };
    let advice = "expected different names for the model's joint `x` and the measured `x`: call the joint's column \
                  `joint_x`, and say so with `joints = { x = \"joint_x\" }` in a mapping file (--columns)";
    let default = ReadOptions::default();
    assert_eq!(
        message("x,lift,b,x[mm],y,z\n0,0,0,0.1,0.2,0.3\n", &default),
        format!("points.csv:1:10: found a second column `x`, {advice}")
    );
    assert_eq!(
        message("x,lift,b,y,z\n0,0,0,0.2,0.3\n", &default),
        format!("points.csv:1:1: found one column `x`, {advice}")
    );
    let mapping = ColumnMap::parse("joints = { x = \"joint_x\" }", "map.toml").unwrap();
    let mapped = ReadOptions { mapping: Some(mapping), ..default };
    assert_eq!(message("joint_x,lift,b,x,y,z\n0,0,0,0.1,0.2,0.3\n", &mapped), "no error");
}
