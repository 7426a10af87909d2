//! Bad input, end to end: one sentence on standard error, exit code 2, and nothing written.

use crate::folder::Folder;

/// `a` turns half a turn either way, `lift` slides up to 0.5 m, `b` turns without limits; the tip is 1 m out.
const ROBOT: &str = r#"<robot name="robot">
  <link name="base"/> <link name="arm"/> <link name="carriage"/> <link name="hand"/> <link name="tool"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="arm"/>
    <axis xyz="0 0 1"/><limit lower="-3.15" upper="3.15" effort="0" velocity="0"/></joint>
  <joint name="lift" type="prismatic"><parent link="arm"/><child link="carriage"/>
    <axis xyz="0 0 1"/><limit lower="0" upper="0.5" effort="0" velocity="0"/></joint>
  <joint name="b" type="continuous"><parent link="carriage"/><child link="hand"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="mount" type="fixed"><parent link="hand"/><child link="tool"/><origin xyz="0.5 0 0.3"/></joint>
</robot>
"#;
const TWO_TIPS: &str = r#"<robot name="robot">
  <link name="base"/> <link name="left"/> <link name="right"/>
  <joint name="l" type="continuous"><parent link="base"/><child link="left"/></joint>
  <joint name="r" type="continuous"><parent link="base"/><child link="right"/></joint>
</robot>
"#;
const FLOATING: &str = r#"<robot name="robot">
  <link name="base"/> <link name="arm"/> <link name="hand"/>
  <joint name="a" type="continuous"><parent link="base"/><child link="arm"/></joint>
  <joint name="f" type="floating"><parent link="arm"/><child link="hand"/></joint>
</robot>
"#;
const HEADER: &str = "a,lift,b,x,y,z\n";
const ROW: &str = "0.1,0.2,0.3,0.7,0.1,0.5\n";

/// A folder with a robot, measurements, and other files that the cases name.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    folder.write("good.csv", format!("{HEADER}{}", ROW.repeat(3)));
    folder.write("joints.csv", "id,a,lift,b\none,0.1,0.2,0.3\n");
    std::fs::create_dir(folder.path("results")).unwrap();
    folder.write("results/notes.txt", "mine");
    folder
}

/// One bad file with its sentence. If a test of the library has the whole sentence, only its beginning is here, with `…`: the place and what was
/// found.
struct Case {
    arguments: &'static str,
    bad: String,
    sentence: &'static str,
}

fn case(arguments: &'static str, bad: impl Into<String>, sentence: &'static str) -> Case {
    Case { arguments, bad: bad.into(), sentence }
}

/// Runs every case and prints all that differ.
fn check(cases: &[Case]) {
    let mut differences = Vec::new();
    for Case { arguments, bad, sentence } in cases {
        let folder = folder();
        // The extension determines the form, and the sentence begins with the name if a file is at fault.
        let name = arguments.split(' ').find(|word| word.starts_with("bad.")).unwrap_or("bad.csv");
        folder.write(name, bad);
        let before = folder.listing();
        let run = folder.run(arguments);
        let is_expected = match sentence.strip_suffix('…') {
            Some(beginning) => {
                run.err.starts_with(&format!("error: {beginning}")) && run.err.find('\n') == Some(run.err.len() - 1)
            }
            None => run.err == format!("error: {sentence}\n"),
        };
        if run.code != 2 || !is_expected || !run.out.is_empty() {
            differences.push(format!(
                "poecal {arguments}\n  expected error: {sentence}\n  found ({}) {}{}",
                run.code, run.err, run.out
            ));
        }
        assert_eq!(folder.listing(), before, "poecal {arguments} changed a file");
    }
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

const CALIBRATE: &str = "calibrate robot.urdf bad.csv";

#[test]
#[rustfmt::skip]
fn bad_headers_get_one_sentence_each() {
    check(&[
        case(CALIBRATE, "a,lft,b,x,y,z\n1,0,1,1,1,1\n",
             "bad.csv:1: found no column `lift`, expected one for joint `lift`; the nearest name found is `lft`: rename or add a column, or name the right one in a mapping file (--columns)"),
        case(CALIBRATE, "a,lift,x,y,z\n1,0,1,1,1\n",
             "bad.csv:1: found no column `b`, expected one for joint `b`; the columns are a, lift, x, y, z: rename or add a column, or name the right one in a mapping file (--columns)"),
        case(CALIBRATE, "a,lift,b,x,y\n1,0,1,1,1\n",
             "bad.csv:1: found no column `z`, expected…"),
        case(CALIBRATE, "a,lift,b,a,x,y,z\n1,0,1,1,1,1,1\n",
             "bad.csv:1:10: found a second column `a`, expected…"),
        case(CALIBRATE, "a,lift,b,x[ft],y,z\n1,0,1,1,1,1\n",
             "bad.csv:1:10: found the unit `ft` for the position x, expected…"),
        case(CALIBRATE, "a[mm],lift,b,x,y,z\n1,0,1,1,1,1\n",
             "bad.csv:1:1: found the unit `mm` for joint `a`, expected…"),
        case(CALIBRATE, "a,lift[deg],b,x,y,z\n1,0,1,1,1,1\n",
             "bad.csv:1:3: found the unit `deg` for joint `lift`, expected…"),
        case(CALIBRATE, "a,lift,b,x,y,z[MM]\n1,0,1,1,1,1\n",
             "bad.csv:1:14: found the unit `MM` for the position z, expected a length (m, cm, mm, um, nm, in); did you mean `mm`?"),
        case(CALIBRATE, "a,lift,b,x,y,z,qx,qy,qz\n1,0,1,1,1,1,0,0,0\n",
             "bad.csv:1: found no column `qw`, expected…"),
        case(CALIBRATE, "a,lift,b,x,y,z,qx,qy,qz,qw,rx\n1,0,1,1,1,1,0,0,0,1,0\n",
             "bad.csv:1:28: found the orientation columns `qx` and `rx`, expected one form only"),
        case(CALIBRATE, "1,0,1,1,1,1\n1,0,1,1,1,1\n",
             "bad.csv:1: found a table without names of columns, with 6 numbers in a row, expected 3 joint readings…"),
        case(CALIBRATE, "", "bad.csv: found no line with text, expected…"),
        case(CALIBRATE, HEADER, "bad.csv:1: found a header and no rows, expected…"),
        case("predict robot.urdf bad.csv", "a,lift,c\n1,0,1\n",
             "bad.csv:1: found no column `b`, expected one for joint `b`; the nearest name found is `c`: rename or add a column, or name the right one in a mapping file (--columns)"),
    ]);
}

#[test]
#[rustfmt::skip]
fn bad_cells_get_one_sentence_each() {
    let table = |row: &str| format!("{HEADER}{ROW}{row}\n");
    let poses = |row: &str| format!("a,lift,b,x,y,z,qx,qy,qz,qw\n{row}\n");
    check(&[
        case(CALIBRATE, table("0.1,0.2,0.3,NaN,0.1,0.5"),
             "bad.csv:3:13: found `NaN` in column `x`, expected a finite number: leave the cell empty where nothing was measured"),
        case(CALIBRATE, table("inf,0.2,0.3,0.7,0.1,0.5"),
             "bad.csv:3:1: found `inf` in column `a`, expected a finite number: leave out a row without a reading"),
        case(CALIBRATE, table("0.1,0.2,0.3,0.7,abc,0.5"),
             "bad.csv:3:17: found `abc` in column `y`, expected a finite number; put `#` in front of a line that is no row"),
        case(CALIBRATE, table("0.1,0.2,0.3,0.7,1e999,0.5"),
             "bad.csv:3:17: found `1e999` in column `y`, expected a finite number"),
        case(CALIBRATE, table("0.1,0.2,,0.7,0.1,0.5"),
             "bad.csv:3:9: found an empty cell in column `b`, expected a joint reading: add it, or leave out the row"),
        case("calibrate robot.urdf bad.csv --strict --out out", table("0.1,0.2,0.3,0.7,,0.5"),
             "bad.csv:3:17: found an empty cell in column `y`, expected…"),
        case(CALIBRATE, table("0.1,0.2,0.3,0.7,0.1"),
             "bad.csv:3:20: found 5 cells, expected…"),
        case(CALIBRATE, table("0.1,0.2,0.3,0.7,0.1,0.5,9"),
             "bad.csv:3:25: found 7 cells, expected…"),
        case(CALIBRATE, table("0.1,0.2,0.3,0.7,0.1,\"0.5"),
             r#"bad.csv:3:21: found a quote that is not closed on its line, expected a closing `"`"#),
        case(CALIBRATE, poses("0.1,0.2,0.3,0.7,0.1,0.5,0,0,0,0.9"),
             "bad.csv:2:25: found a quaternion of norm 0.9000, expected 1 to within 0.01"),
        case(CALIBRATE, poses("0.1,0.2,0.3,0.7,0.1,0.5,0,0,,1"),
             "bad.csv:2:29: found an empty cell in column `qz`, expected…"),
        case(CALIBRATE, "a,lift,b,x,y,z,set\n0.1,0.2,0.3,0.7,0.1,0.5,test\n",
             "bad.csv:2:25: found `test` in column `set`, expected `fit` or `held_out`"),
        case(CALIBRATE, "a,lift,b,x,y,z,sigma_position[mm]\n0.1,0.2,0.3,0.7,0.1,0.5,0\n",
             "bad.csv:2:25: found `0` in column `sigma_position`, expected…"),
        case(CALIBRATE, "a,lift,b,x,y,z,target\n0.1,0.2,0.3,0.7,0.1,0.5,one\n0.1,0.2,0.3,0.7,0.1,0.5,\n",
             "bad.csv:3:25: found no target name, expected one as in bad.csv:2; all rows name their target or none does"),
    ]);
}

#[test]
#[rustfmt::skip]
fn values_of_another_scale_name_the_likely_unit() {
    check(&[
        case(CALIBRATE, format!("{HEADER}45,0.2,0.3,0.7,0.1,0.5\n-120,0.3,0.3,0.7,0.1,0.5\n"),
             "bad.csv:3:1: found readings of up to 120 rad, far outside the limits -3.15 to 3.15 rad of joint `a`, expected another unit, most likely deg; write `a[deg]` in the header, or state --units deg"),
        case(CALIBRATE, format!("{HEADER}0.5,200,0.3,0.7,0.1,0.5\n0.1,300,0.3,0.7,0.1,0.5\n"),
             "bad.csv:3:5: found readings of up to 300 m, far outside the limits 0 to 0.5 m of joint `lift`, expected…"),
        case(CALIBRATE, format!("{HEADER}0.5,0.2,0.3,700,100,500\n0.1,0.3,0.3,-700,0,300\n"),
             "bad.csv:3: found positions up to 1418 m from their middle, where the robot reaches 1.583 m, expected another unit, most likely mm; write `x[mm],y[mm],z[mm]` in the header, or state --units mm"),
        case(CALIBRATE, format!("{HEADER}0.5,0.2,0.3,0.7,0.1,500\n0.1,0.3,0.3,-0.7,0,-300\n"),
             "bad.csv:3: found values of `z` up to 800 m from their middle, where the robot reaches 1.583 m, beside `x` and `y`, which it can reach, expected another unit, most likely mm; write `z[mm]` in the header, or state --units mm"),
    ]);
}

#[test]
#[rustfmt::skip]
fn bad_models_get_one_sentence_each() {
    let on = "calibrate bad.urdf good.csv";
    check(&[
        case(on, "<robot name='r'><link name='a'></robot>",
             "bad.urdf:1:32: found broken XML (expected 'link' tag, not 'robot'), expected…"),
        case(on, "<html><body/></html>",
             "bad.urdf:1:1: found root element <html>, expected <robot>, as in every URDF file"),
        case(on, "<robot name='r'/>",
             "bad.urdf: found no end link with a moving joint above it, expected…"),
        case(on, TWO_TIPS,
             "bad.urdf: found 2 end links with a moving joint above them (`left`, `right`), expected one: choose it with --tip-link, and the base, if it is not the root, with --base-link"),
        case(on, FLOATING,
             "bad.urdf:4:3: joint `f` between `base` and `hand` is floating, expected revolute, continuous, prismatic or fixed: choose a chain without it with --base-link and --tip-link"),
        case("calibrate bad.urdf good.csv --tip-link tol", ROBOT,
             "bad.urdf: --tip-link names link `tol`, expected a link of this file, the nearest is `tool`"),
        case(on, "", "bad.urdf: the file is empty, expected…"),
        case("calibrate bad.toml good.csv", "poecal_robot = 1\nname = 3\n",
             "bad.toml:2:8: invalid type: integer `3`, expected a string"),
        case("calibrate missing.urdf good.csv", "",
             "missing.urdf: found no such file, expected…"),
        case("calibrate results good.csv", "",
             "results: found a directory, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json)"),
        case("predict bad.json joints.csv", "{\"schema\": \"poecal-calibration-3\",\n",
             "bad.json:2:1: found broken JSON (EOF while parsing an object), expected a calibration as written by `poecal calibrate`: name a calibration.json"),
        case("predict bad.json joints.csv", "{\"schema\": \"poecal-calibration-9\"}",
             "bad.json: found schema `poecal-calibration-9`, expected `poecal-calibration-3`, that of this version: calibrate again"),
        case("predict bad.json joints.csv", "{\"schema\": \"poecal-calibration-3\"}",
             "bad.json:1:34: found something that does not fit the schema (missing field `poecal_version`), expected a calibration as written by `poecal calibrate`: name a calibration.json"),
        case("predict bad.json joints.csv", "{}",
             "bad.json: found JSON without the key `schema`, expected a calibration of schema `poecal-calibration-3`"),
        case("validate robot.urdf good.csv", "",
             "robot.urdf: found a URDF, expected a calibration as written by `poecal calibrate`: calibrate it, and name the calibration.json"),
    ]);
}

#[test]
#[rustfmt::skip]
fn bad_use_gets_one_sentence_each() {
    check(&[
        case("calibrate robot.urdf good.csv", "",
             "found 3 measurements to fit with 9 measured numbers, expected at least 13 numbers (10 of the screws, 3 of the targets): measure more configurations, or hold out fewer"),
        case("calibrate robot.urdf missing.csv", "",
             "missing.csv: found no such file, expected…"),
        case("calibrate robot.urdf results", "",
             "results: found a directory without text files whose names end in a number, expected a table (CSV), or…"),
        case("calibrate robot.urdf good.csv --out results", "",
             "results: the output folder exists, expected a new one: choose another with --out, or overwrite its results with --force"),
        case("calibrate robot.urdf good.csv --out good.csv", "",
             "good.csv: found a file, expected a folder for the results: choose another with --out"),
        case("calibrate robot.urdf good.csv --out nowhere/results", "",
             "nowhere/results: the folder above does not exist, expected one to write into: create it first"),
        case("calibrate robot.urdf good.csv ./good.csv", "",
             "./good.csv: found this measurement file named twice, expected every file once, since the same rows twice are not more data: leave one out"),
        case("calibrate robot.urdf good.csv --validate results/../good.csv", "",
             "results/../good.csv: found this file to be fitted and in --validate, expected one of the two, since a fit is judged by rows that it did not see: leave one out"),
        case("validate calibration.json good.csv good.csv", "",
             "good.csv: found this measurement file named twice, expected every file once, since the same rows twice are not more data: leave one out"),
        case("calibrate robot.urdf good.csv --train-where a=0.1 --held-out 0.2", "",
             "found --held-out 0.2, but --train-where already says which rows are held out, expected one of the two: leave --held-out out, or fit every row with --held-out 0"),
        case("calibrate robot.urdf bad.csv --held-out 0.3", "a,lift,b,x,y,z,set\n0.1,0.2,0.3,0.7,0.1,0.5,fit\n",
             "found --held-out 0.3, but a column of the files already says which rows are held out, expected one of the two: leave --held-out out, or fit every row with --held-out 0"),
        case("calibrate robot.urdf good.csv --validate bad.csv --held-out 0.5", format!("{HEADER}{ROW}"),
             "found --held-out 0.5, but --validate already says which rows are held out, expected one of the two: leave --held-out out, or fit every row with --held-out 0"),
        case("calibrate robot.urdf good.csv --held-out 1.0", "",
             "--held-out: found `1.0`, expected a number from 0 to below 1"),
        case("calibrate robot.urdf good.csv --held-out 0.99", "",
             "found 3 measurements to fit with 9 measured numbers, expected at least 13 numbers (10 of the screws, 3 of the targets): measure more configurations, or hold out fewer"),
        case("calibrate robot.urdf good.csv --held-out some", "",
             "--held-out: found `some`, expected a number from 0 to below 1"),
        case("calibrate robot.urdf good.csv --sigma-position 0.05", "",
             "--sigma-position: found `0.05` without a unit, expected a number with a unit, like 0.05mm"),
        case("calibrate robot.urdf good.csv --sigma-position 0.05deg", "",
             "--sigma-position: found the unit `deg`, expected a length (m, cm, mm, um, nm, in)"),
        case("calibrate robot.urdf good.csv --sigma-position 0mm", "",
             "--sigma-position: found `0mm`, expected a standard deviation above 0"),
        case("calibrate robot.urdf good.csv --held-out -0.1", "",
             "--held-out: found `-0.1`, expected a number from 0 to below 1"),
        case("calibrate robot.urdf good.csv --sigma-position -1mm", "",
             "--sigma-position: found `-1mm`, expected a number not below 0, with a unit, like 0.05mm"),
        case("simulate robot.urdf --out made --errors -1deg,2mm", "",
             "--errors: found `-1deg`, expected a number not below 0, with a unit, like 2mm or 1deg"),
        case("simulate robot.urdf --out made --noise 1grad", "",
             "--noise: found the unit `grad`, expected one of m, cm, mm, um, nm, in, rad, mrad, deg, arcmin, arcsec, ticks"),
        case("calibrate robot.urdf good.csv --sigma-rotation tiny", "",
             "--sigma-rotation: found `tiny`, expected a number with a unit, like 0.01deg"),
        case("calibrate robot.urdf good.csv --seed 1.5", "", "--seed: found `1.5`, expected a whole number"),
        case("calibrate robot.urdf good.csv --threads two", "",
             "--threads: found `two`, expected a whole number"),
        case("calibrate robot.urdf good.csv --threads 100000", "",
             "--threads: found `100000`, expected a whole number from 1 to 256"),
        case("calibrate robot.urdf good.csv --threads 0", "",
             "--threads: found `0`, expected a whole number from 1 to 256"),
        case("calibrate robot.urdf good.csv --train-where stage", "",
             "found `stage` as the rows to fit, expected COLUMN=VALUE[,VALUE]"),
        case("calibrate robot.urdf good.csv --train-where stage=1", "",
             "good.csv:1: found no column `stage`, expected one that states which rows are fitted; the columns are a, lift, b, x, y, z"),
        case("calibrate robot.urdf good.csv --train-where x=9", "",
             "good.csv: found no row with `9` in column `x`, expected at least one to fit"),
        case("calibrate robot.urdf good.csv --columns bad.toml", "sepparator = ';'\n",
             "bad.toml:1:1: unknown field `sepparator`, expected one of `separator`, `decimal`, `skip_lines`, `pose`, `ignore`, `id`, `target`, `target_name`, `instrument`, `set`, `third_axis`, `units`, `joints`, `position`, `orientation`, `sigma_position`, `sigma_rotation`, `targets`, `mount`"),
        case("predict robot.urdf joints.csv --target tool", "",
             "robot.urdf: found no target `tool`, expected none: the model has no targets, leave out --target to predict the tip"),
        case("predict robot.urdf joints.csv --output-frame device", "",
             "robot.urdf: found a robot model without a measuring device, expected a calibration.json for --output-frame device: use --output-frame base"),
        case("predict robot.urdf joints.csv --out nowhere/poses.csv", "",
             "nowhere/poses.csv: the folder above does not exist, expected one to write into: create it first"),
        case("predict robot.urdf joints.csv --out results", "",
             "results: found a directory, expected a file to write: name the file"),
        case("export robot.urdf", "",
             "found no --format, expected --out NAME.urdf or NAME.toml, or --format with one of…"),
        case("export robot.urdf --out robot.txt", "",
             "found no form in the name `robot.txt`, expected --out NAME.urdf or NAME.toml, or --format with one of…"),
        case("check robot.urdf good.csv missing.csv", "",
             "missing.csv: found no such file, expected…"),
    ]);
}

#[test]
fn what_is_odd_but_usable_gets_a_warning() {
    let folder = folder();
    folder.write("odd.csv", "a,lift,b,colour,sigma_positon\n0.1,0.2,0.3,red,1\n0.1,0.6,0.3,blue,1\n");
    let run = folder.run("predict robot.urdf odd.csv");
    assert_eq!((run.code, run.out.lines().count()), (0, 3));
    assert_eq!(run.err, "warning: odd.csv: joint `lift` lies beyond its limits 0 to 0.5 m in 1 row (line 3)\n");
    assert_eq!(folder.run("predict robot.urdf odd.csv --quiet").err, "");
    folder.write("extra.csv", format!("a,lift,b,x,y,z,colour,sigma_positon\n{}", ROW.replace('\n', ",red,1\n")));
    let run = folder.run("calibrate robot.urdf extra.csv --held-out 0");
    assert_eq!(run.code, 2);
    assert_eq!(
        run.err.lines().next(),
        Some("warning: extra.csv: ignored the columns `colour`, `sigma_positon` (did you mean `sigma_position`?)")
    );
}
