//! Measurement files in the usual forms.

use std::f64::consts::PI;

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_import::{DecimalSign, FitWhere, MeasurementFile, ReadOptions, Separator, parse, read, read_joints};
use poecal_model::measurement::{Dataset, Quantity, Set};
use poecal_model::robot::{Joint, JointLimits, Reading, Robot};
use poecal_numerics::named_unit::UnitSource;
use poecal_testing::files::Folder;
use poecal_testing::sessions::lifting_robot;

/// Conversions round once or twice.
const ROUNDING: f64 = 1e-12;

fn read_text(text: impl AsRef<[u8]>, options: &ReadOptions) -> MeasurementFile {
    let folder = Folder::new();
    let path = folder.write("points.csv", text);
    read(&[path], &lifting_robot(), options)
        .unwrap_or_else(|error| panic!("{}", folder.without_path(&error.to_string())))
}

fn read_plain(text: &str) -> MeasurementFile {
    read_text(text, &ReadOptions::default())
}

fn pose(data: &Dataset, row: usize) -> Pose {
    data.observations[row].measurement.pose()
}

#[test]
fn units_stand_in_the_header_or_are_si() {
    let file = read_plain(
        "a[deg],lift[mm],b,x[mm],y [cm],z[µm],sigma_position[um],sigma_rotation[mrad]\n90,250,0.5,100,20,3e5,50,2\n",
    );
    assert_eq!(file.data.readings(0), [PI / 2.0, 0.25, 0.5]);
    assert!((pose(&file.data, 0).translation - Vector3::new(0.1, 0.2, 0.3)).norm() < ROUNDING);
    let row = file.data.observations[0];
    assert_eq!((row.stated.get(Quantity::Position), row.stated.get(Quantity::Rotation)), (Some(5e-5), Some(2e-3)));
    let units: Vec<_> = file.understood[0].columns.iter().map(|column| column.unit.unwrap()).collect();
    assert_eq!(units, ["deg", "mm", "rad", "mm", "cm", "um", "um", "mrad"]);
    assert_eq!(file.understood[0].columns[2].unit_from, Some(UnitSource::Si));
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
}

#[test]
fn units_stand_in_round_brackets_or_as_words() {
    let file =
        read_plain("a (deg),lift (Millimetres),b [radians],x(in),y [inch],z (meters),set\n90,250,0.5,10,20,0.3,fit\n");
    assert_eq!(file.data.readings(0), [PI / 2.0, 0.25, 0.5]);
    assert_eq!(pose(&file.data, 0).translation, Vector3::new(0.254, 0.508, 0.3));
    let units: Vec<_> = file.understood[0].columns.iter().filter_map(|column| column.unit).collect();
    assert_eq!(units, ["deg", "mm", "rad", "in", "in", "m"]);
    assert_eq!(file.understood[0].columns[0].column.as_deref(), Some("a (deg)"));
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
}

#[test]
fn a_joint_whose_name_ends_like_a_unit_keeps_its_name() {
    let slide = |name: &str| Joint::prismatic(name, Screw::prismatic(&Vector3::x()));
    let robot = Robot::new("two", vec![slide("axis_m"), slide("axis(1)")], Pose::identity()).unwrap();
    let text = "axis_m,axis(1)[mm],x,y,z\n0.5,20,1,2,3\n";
    let file = parse(text, "points.csv", &robot, &ReadOptions::default()).unwrap();
    assert_eq!(file.data.readings(0), [0.5, 0.02]);
    let near = read_plain("a,lift,b,x,y,z,sigma_position_mm\n0,0,0,1,2,3,0.1\n").warnings;
    assert!(near[0].ends_with("`sigma_position_mm` (did you mean `sigma_position[mm]`?)"), "{near:?}");
}

#[test]
fn lines_of_separator_and_units_are_read() {
    for (text, separator_line, units_line) in [
        ("sep=;\nid;a;lift;b;x;y;z\n;deg;mm;deg;mm;mm;mm\nr;90;250;0,5;100;200;300\n", Some(1), Some(3)),
        (
            "\"SEP=,\"\nid,a[deg],lift,b,x,y,z\n,,(mm),(deg),[mm],[mm],[mm]\nr,90,250,0.5,100,200,300\n",
            Some(1),
            Some(3),
        ),
        (
            "id\ta\tlift\tb\tx\ty\tz\tT\nname\t°\tmm\tDegrees\tmm\tmm\tmm\t°C\n\nr\t90\t250\t0.5\t100\t200\t300\t21\n",
            None,
            Some(2),
        ),
    ] {
        let file = read_plain(text);
        let understood = &file.understood[0];
        assert_eq!((understood.separator_line, understood.units_line), (separator_line, units_line));
        assert_eq!(file.data.readings(0), [PI / 2.0, 0.25, 0.5f64.to_radians()]);
        assert!((pose(&file.data, 0).translation - Vector3::new(0.1, 0.2, 0.3)).norm() < ROUNDING);
        assert_eq!((file.data.len(), file.data.ids[0].as_str()), (1, "r"));
        assert_eq!(understood.columns[1].unit_from, Some(UnitSource::UnitsLine));
    }
    // The tests of `table` vary the number of bytes per read; here it is a joint table.
    let folder = Folder::new();
    let path = folder.write("joints.csv", "sep=;\na;lift;b\ndeg;mm;deg\n180;100;0\n");
    assert_eq!(read_joints(path, &lifting_robot(), &ReadOptions::default()).unwrap().readings, [PI, 0.1, 0.0]);
}

#[test]
fn lost_beams_are_left_out_and_counted() {
    let text = "a,lift,b,x,y,z,qx,qy,qz,qw,set\n\
                0,0,0,1,2,3,0,0,0,1,fit\n\
                900,0,0,,,,,,,,fit\n\
                0.2,0,0,0,0.0,-0,0,0,0,0,fit\n\
                0.3,0,0,0,0,0,0,0,0,1,fit\n\
                0.4,0,0,0,0,0,,,,,fit\n\
                0.5,0,0,0,0,0,0,0,1,0,fit\n\
                0.6,0,0,0,0,1,,,,,fit\n";
    let file = read_plain(text);
    let first: Vec<f64> = (0..file.data.len()).map(|row| file.data.readings(row)[0]).collect();
    assert_eq!(first, [0.0, 0.5, 0.6]);
    let understood = &file.understood[0];
    assert_eq!((understood.rows, understood.points, understood.poses), (7, 1, 2));
    assert_eq!((understood.lost.count, &understood.lost.first_lines[..]), (4, &[3, 4, 5, 6][..]));
    // Omitted rows do not affect the range of the joint either.
    assert_eq!(understood.columns[0].max, Some(0.6));
    assert_eq!(
        file.warnings.iter().map(|warning| warning.split(": ").nth(1).unwrap()).collect::<Vec<_>>(),
        [
            "skipped 4 measurements with an empty or zero position, as of a lost beam (lines 3, 4, 5, 6); --strict refuses them"
        ]
    );
    let strict = ReadOptions { strict: true, ..ReadOptions::default() };
    let message = |text: &str| parse(text, "p.csv", &lifting_robot(), &strict).unwrap_err().to_string();
    assert_eq!(
        message(text),
        "p.csv:3:9: found an empty position, as of a lost beam, expected what was measured; leave out the row"
    );
    assert_eq!(
        message("a,lift,b,x,y,z\n0,0,0,0,0,0\n"),
        "p.csv:2:7: found the position 0, 0, 0, as of a lost beam, expected what was measured; leave out the row"
    );
}

#[test]
fn one_lost_beam_is_no_other_unit() {
    let text = "a[deg],lift[mm],b[deg],x[mm],y[mm],z[mm]\n\
                0,0,0,91000,0,300\n30,0,0,90866,500,300\n60,0,0,90500,866,300\n0,0,0,0,0,0\n";
    assert_eq!(read_plain(text).data.len(), 3);
}

#[test]
fn orientations_are_quaternions_rotation_vectors_or_angles() {
    let r = rotation::from_rpy(0.4, -0.3, 2.0);
    let [qx, qy, qz, qw] = Pose::new(r, Vector3::zeros()).quaternion_xyzw();
    let w = rotation::log(&r).map(f64::to_degrees);
    let start = "a,lift,b,x,y,z";
    let files = [
        format!("{start},qx,qy,qz,qw\n0,0,0,1,2,3,{qx},{qy},{qz},{qw}\n"),
        format!("{start},qw,qx,qy,qz\n0,0,0,1,2,3,{},{},{},{}\n", -1.001 * qw, -1.001 * qx, -1.001 * qy, -1.001 * qz),
        format!("{start},rx[deg],ry[deg],rz[deg]\n0,0,0,1,2,3,{},{},{}\n", w.x, w.y, w.z),
        format!("{start},roll,pitch,yaw\n0,0,0,1,2,3,0.4,-0.3,2.0\n"),
    ];
    for text in files {
        let seen = pose(&read_plain(&text).data, 0);
        assert!((seen.rotation - r).norm() < ROUNDING, "{text}");
        assert_eq!(seen.translation, Vector3::new(1.0, 2.0, 3.0));
    }
}

#[test]
fn one_file_mixes_points_and_poses() {
    let file = read_plain("a,lift,b,x,y,z,qx,qy,qz,qw,sigma_rotation\n0,0,0,1,2,3,,,,,\n0,0,0,1,2,3,0,0,0,1,0.01\n");
    let kinds: Vec<bool> = file.data.observations.iter().map(|row| row.measurement.sees_orientation()).collect();
    assert_eq!(kinds, [false, true]);
    assert_eq!((file.understood[0].points, file.understood[0].poses), (1, 1));
    assert_eq!(file.data.targets, [None]);
    assert_eq!(file.data.observations[0].stated.get(Quantity::Rotation), None);
}

#[test]
fn columns_come_in_any_order_with_ids_sets_and_targets() {
    let file = read_plain(
        "set,id,z,y,x,target,b,lift,a\nfit,r1,3,2,1,smr2,0.3,0.2,0.1\n,,3,2,1,smr1,0,0,0\nheld_out,r3,3,2,1,smr2,0,0,0\n",
    );
    assert_eq!(file.data.readings(0), [0.1, 0.2, 0.3]);
    assert_eq!(pose(&file.data, 0).translation, Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(file.data.targets, [Some("smr2".to_owned()), Some("smr1".to_owned())]);
    let rows: Vec<_> = file.data.observations.iter().map(|row| (row.target, row.set, row.source.line)).collect();
    assert_eq!(rows, [(0, Some(Set::Fit), 2), (1, None, 3), (0, Some(Set::HeldOut), 4)]);
    assert_eq!(file.data.ids, ["r1", "", "r3"]);
}

#[test]
fn separators_and_decimal_signs_are_recognised() {
    let files = [
        ("a,lift,b,x,y,z\n0.5,0,-1.5,1,2,3.25\n", Separator::Comma, DecimalSign::Point),
        ("a;lift;b;x;y;z\r\n0,5;0;-1,5;1;2;3,25\r\n", Separator::Semicolon, DecimalSign::Comma),
        ("a;lift;b;x;y;z\n0.5;0;-1.5;1;2;3.25\n", Separator::Semicolon, DecimalSign::Point),
        ("a\tlift\tb\tx\ty\tz\n0,5\t0\t-1,5\t1\t2\t3,25\n", Separator::Tab, DecimalSign::Comma),
        ("a  lift b x y z\n 0,5\t 0 -1,5 1 2 3,25 \n", Separator::Whitespace, DecimalSign::Comma),
        ("a,lift,b,x,y,z\n\"0,5\",0,\"-1,5\",1,2,\"3,25\"\n", Separator::Comma, DecimalSign::Comma),
        (
            "\u{feff}# by the tracker\n\n\"a\" , \"lift\",b,x,y,z\n# pause\n\n+0.5,0,-15e-1,1,2,3.25\n,,,,,\n",
            Separator::Comma,
            DecimalSign::Point,
        ),
        ("a,lift,b,x,y,z\r0.5,0,-1.5,1,2,3.25\r", Separator::Comma, DecimalSign::Point),
    ];
    for (text, separator, sign) in files {
        let file = read_plain(text);
        assert_eq!((file.understood[0].separator, file.understood[0].decimal_sign), (separator, sign), "{text}");
        assert_eq!(file.data.readings(0), [0.5, 0.0, -1.5], "{text}");
        assert_eq!(pose(&file.data, 0).translation, Vector3::new(1.0, 2.0, 3.25), "{text}");
    }
}

#[test]
fn other_columns_are_listed_and_left_alone() {
    let file = read_plain("a,lift,b,x,y,z,temperature[degC],sigma_postion,Target,\n0,0,0,1,2,3,warm,0.1,A,\n");
    assert_eq!(file.warnings.len(), 1);
    assert!(
        file.warnings[0].ends_with(
            "points.csv: ignored the columns `temperature[degC]`, \
             `sigma_postion` (did you mean `sigma_position`?), `Target` (did you mean `target`?)"
        ),
        "{}",
        file.warnings[0]
    );
    assert_eq!(file.understood[0].ignored, ["temperature[degC]", "sigma_postion", "Target"]);
}

#[test]
fn joints_beyond_their_limits_are_a_warning_with_rows() {
    let rows = "0,0.6,0,1,2,3\n".repeat(2) + "0,0,0,1,2,3\n" + &"0,-0.1,0,1,2,3\n".repeat(4);
    let file = read_plain(&format!("a,lift,b,x,y,z\n{rows}"));
    assert_eq!(file.warnings.len(), 1);
    assert!(
        file.warnings[0]
            .ends_with(": joint `lift` lies beyond its limits 0 to 0.5 m in 6 rows (lines 2, 3, 5, 6, 7, …)"),
        "{}",
        file.warnings[0]
    );
}

#[test]
fn whole_turns_are_taken_off_where_that_brings_readings_inside_the_limits() {
    let text = "a[deg],lift,b[deg],x,y,z\n350,0,350,1,2,3\n190,0,0,1,2,3\n-350,0,0,1,2,3\n20,0,0,1,2,3\n";
    let file = read_plain(text);
    let degrees = |row: usize| file.data.readings(row)[0].to_degrees();
    for (row, expected) in [-10.0, -170.0, 10.0, 20.0].into_iter().enumerate() {
        assert!((degrees(row) - expected).abs() < 1e-12, "{row}: {}", degrees(row));
    }
    // Without limits, a joint may turn repeatedly.
    assert!((file.data.readings(0)[2].to_degrees() - 350.0).abs() < 1e-12);
    assert_eq!(file.warnings.len(), 1);
    assert!(
        file.warnings[0].ends_with(
            ": whole turns are taken off the readings of joint `a` in 3 rows (lines 2, 3, 4), which brings them inside its limits"
        ),
        "{}",
        file.warnings[0]
    );
    // Degrees that were stated as radians differ by more than any number of turns.
    let of = |text: &str| format!("a[rad],lift,b,x,y,z\n{text}");
    let degrees: String = (-6..=6).map(|k| format!("{},0,0,1,2,3\n", 1.9 * f64::from(k))).collect();
    let folder = Folder::new();
    let path = folder.write("points.csv", of(&degrees));
    let told = read(&[path], &lifting_robot(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(told.contains("up to 11.4 rad") && told.contains("most likely deg"), "{told}");
    let counted: String = (-3..=3).map(|k| format!("{},0,0,1,2,3\n", 1.9 * f64::from(k))).collect();
    assert_eq!(read_plain(&of(&counted)).data.len(), 7);
    // Joint readings alone, for predictions, are treated in the same manner.
    let path = folder.write("q.csv", "a[deg],lift,b\n350,0,0\n");
    let joints = read_joints(&path, &lifting_robot(), &ReadOptions::default()).unwrap();
    assert!((joints.readings[0].to_degrees() + 10.0).abs() < 1e-12);
}

#[test]
fn a_few_corrupt_rows_are_no_other_unit() {
    let good: String = (0..60).map(|i| format!("0.{},0.1,0,0.5,0.{},1\n", i % 10, i % 7)).collect();
    let file = read_plain(&format!("a,lift,b,x,y,z\n{good}90,0.1,0,900,0,0\n"));
    assert_eq!(file.data.len(), 61);
    assert_eq!(file.warnings.len(), 1);
}

#[test]
fn turns_that_are_stated_in_radians_are_believed_without_limits() {
    let file = read_plain("a,lift,b[rad],x,y,z\n0,0,120,1,2,3\n0,0,-40,1,2,3\n");
    assert_eq!(file.data.readings(0)[2], 120.0);
    assert!(file.warnings.is_empty());
}

#[test]
fn a_slide_without_limits_may_go_far() {
    let folder = Folder::new();
    let joints = vec![Joint::prismatic("rail", Screw::prismatic(&Vector3::x()))];
    let robot = Robot::new("rail", joints, Pose::identity()).unwrap();
    let path = folder.write("points.csv", "rail,x,y,z\n0,0,0,1\n20,20,0,1\n45,45,0,1\n");
    assert_eq!(read(&[path], &robot, &ReadOptions::default()).unwrap().data.len(), 3);
}

#[test]
fn a_mimic_joint_is_read_from_its_leader() {
    let folder = Folder::new();
    let mut robot = lifting_robot();
    robot.joints[1].reading = Reading { name: "column".to_owned(), multiplier: 0.5, offset: -0.1 };
    robot.joints[1].limits = Some(JointLimits { lower: -0.1, upper: 0.3 });
    let path = folder.write("points.csv", "a,column[mm],b,x,y,z\n0,800,0,1,2,3\n0,900,0,1,2,3\n");
    let file = read(&[path], &robot, &ReadOptions::default()).unwrap();
    assert_eq!(file.data.readings(0), [0.0, 0.8, 0.0]);
    assert!(file.warnings[0].ends_with("beyond its limits -0.1 to 0.3 m in 1 row (line 3)"), "{:?}", file.warnings);
}

#[test]
fn several_files_are_joined() {
    let folder = Folder::new();
    let paths = [
        folder.write("a.csv", "a,lift,b,x,y,z\n0,0,0,1,2,3\n"),
        folder.write("b.csv", "id;b[deg];a;lift;x;y;z\n7;180;0,1;0;1;2;3\n"),
        folder.write("c.csv", "a,lift,b,x,y,z\n0,0,0,1,2,3\n"),
    ];
    let file = read(&paths, &lifting_robot(), &ReadOptions::default()).unwrap();
    assert_eq!(file.data.files, paths);
    assert_eq!(file.data.readings(1), [0.1, 0.0, PI]);
    let sources: Vec<_> = file.data.observations.iter().map(|row| (row.source.file, row.source.line)).collect();
    assert_eq!(sources, [(0, 2), (1, 2), (2, 2)]);
    assert_eq!(file.data.ids, ["", "7", ""]);
    assert_eq!(file.understood.len(), 3);
}

#[test]
fn rows_to_fit_are_chosen_by_a_columns_value() {
    let train_where: FitWhere = "stage=1,b".parse().unwrap();
    let options = ReadOptions { train_where: Some(train_where), ..ReadOptions::default() };
    let file = read_text(
        "a,lift,b,x,y,z,stage,set\n0,0,0,1,2,3,1.0,what\n0,0,0,1,2,3,b,\n0,0,0,1,2,3,2,fit\n0,0,0,1,2,3,,fit\n",
        &options,
    );
    let sets: Vec<_> = file.data.observations.iter().map(|row| row.set.unwrap()).collect();
    assert_eq!(sets, [Set::Fit, Set::Fit, Set::HeldOut, Set::HeldOut]);
    assert!(file.warnings.is_empty());
}

#[test]
fn joint_tables_need_no_measurements() {
    let folder = Folder::new();
    let path = folder.write("joints.csv", "id;b;note;lift[mm];a[deg]\nr1;0,5;x;100;180\n\nr2;0;;0;0\n");
    let table = read_joints(path, &lifting_robot(), &ReadOptions::default()).unwrap();
    assert_eq!(table.readings, [PI, 0.1, 0.5, 0.0, 0.0, 0.0]);
    assert_eq!((table.rows, table.ids, table.lines), (2, vec!["r1".to_owned(), "r2".to_owned()], vec![2, 4]));
    assert!(table.warnings.is_empty());
}

#[test]
fn single_column_joint_tables_are_read() {
    let folder = Folder::new();
    let joint = Joint::revolute("a", Screw::revolute(&Vector3::z(), &Vector3::zeros()));
    let robot = Robot::new("one", vec![joint], Pose::identity()).unwrap();
    let path = folder.write("joints.csv", "a\n0,5\n-1\n");
    assert_eq!(read_joints(path, &robot, &ReadOptions::default()).unwrap().readings, [0.5, -1.0]);
}

#[test]
fn anchors_name_where_distances_are_measured_from() {
    let head = "a[deg],lift[mm],b,x[mm],y[mm],z[mm],instrument,anchor,distance[mm]\n";
    let file = read_plain(&format!(
        "{head}10,250,0.5,100,20,3,tracker,,\n20,250,0.5,,,,,wall,800\n30,250,0.5,,,,,door,900\n40,250,0.5,,,,,wall,810\n"
    ));
    let stations: Vec<_> = file.data.observations.iter().map(|it| it.station).collect();
    assert_eq!(stations, [0, 1, 2, 1]);
    let names: Vec<_> = file.data.stations.iter().map(|name| name.as_deref().unwrap()).collect();
    assert_eq!(names, ["tracker", "wall", "door"]);
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    let columns: Vec<_> = file.understood[0].columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(columns[columns.len() - 2..], ["instrument", "anchor"]);

    // There is no column of the instrument, and then both have the same name.
    let file = read_plain("a,lift,b,anchor,distance\n0,0.1,0,wall,0.8\n0.1,0.1,0,door,0.9\n");
    assert_eq!(file.data.stations.len(), 2);
    assert_eq!(read_plain(&format!("{head}20,250,0.5,,,,wall,wall,800\n")).data.stations.len(), 1);

    let refused = |rows: &str| {
        let folder = Folder::new();
        let path = folder.write("points.csv", format!("{head}{rows}"));
        folder.without_path(&read(&[path], &lifting_robot(), &ReadOptions::default()).unwrap_err().to_string())
    };
    assert_eq!(
        refused("20,250,0.5,,,,wire,wall,800\n"),
        "points.csv:2:20: found the anchor `wall` beside the instrument `wire`, expected one of the two: leave one cell empty"
    );
    assert!(refused("20,250,0.5,,,,,wall,800\n20,250,0.5,,,,,,800\n").contains("points.csv:3"));
}

#[test]
fn payloads_are_kilograms() {
    let robot = lifting_robot().with_factors(&["payload".to_owned()]).unwrap();
    let read = |unit: &str| {
        let folder = Folder::new();
        let path = folder.write("points.csv", format!("a,lift,b,payload{unit},x,y,z\n0,0.1,0,2.5,0.1,0.2,0.3\n"));
        read(&[path], &robot, &ReadOptions::default()).map_err(|error| folder.without_path(&error.to_string()))
    };
    for unit in ["", "[kg]"] {
        assert_eq!(read(unit).unwrap().data.readings(0)[3], 2.5);
    }
    let error = read("[g]").unwrap_err();
    assert!(error.contains("points.csv:1:10: found the unit `g` of `payload`, expected `kg` or none"), "{error}");
}
