//! Files as instruments, controllers, recorders and spreadsheets write them.

use std::fmt::Write as _;
use std::fs;

use poecal_formats::urdf::ChainSelection;
use poecal_import as measurements;
use poecal_import::ReadOptions;
use poecal_results::model::Model;

use crate::folder::Folder;
use crate::recordings::{Recordings, recordings};
use crate::workbook::workbook;

pub(crate) const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/robot.urdf");

/// A configuration: joints in degrees, position in mm, quaternion x, y, z, w.
pub(crate) type Row = ([f64; 6], [f64; 3], [f64; 4]);

/// A simulated session of an elbow with errors.
pub(crate) fn session(folder: &Folder, count: usize) -> Vec<Row> {
    folder.run_to_success(&format!("simulate {MODEL} --kind pose --count {count} --seed 5 --out made"));
    let text = folder.read("made/measurements.csv");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|it| it.split('[').next() == Some(name)).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |name: &str| {
            let value: f64 = cells[at(name)].parse().unwrap();
            match header[at(name)].split('[').nth(1) {
                Some("rad]") => value.to_degrees(),
                Some("m]") => 1e3 * value,
                _ => value,
            }
        };
        (
            std::array::from_fn(|k| number(&format!("joint{}", k + 1))),
            ["x", "y", "z"].map(number),
            ["qx", "qy", "qz", "qw"].map(number),
        )
    };
    lines.map(row).collect()
}

/// Texts of numbers, separated.
pub(crate) fn join_numbers(values: &[f64], digits: usize, separator: &str) -> String {
    values.iter().map(|it| format!("{it:.digits$}")).collect::<Vec<_>>().join(separator)
}

/// poecal's own form, with points or poses.
fn own_form(rows: &[Row], is_posed: bool) -> String {
    let mut text =
        "id,joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg],x[mm],y[mm],z[mm]".to_owned();
    text += if is_posed { ",qx,qy,qz,qw\n" } else { "\n" };
    for (k, (joints, place, turn)) in rows.iter().enumerate() {
        write!(text, "P{},{},{}", k + 1, join_numbers(joints, 9, ","), join_numbers(place, 6, ",")).unwrap();
        text += &if is_posed { format!(",{}\n", join_numbers(turn, 10, ",")) } else { "\n".to_owned() };
    }
    text
}

/// Error of a calibration on held-out rows, mm, and its messages.
pub(crate) fn held_out(folder: &Folder, files: &str) -> (f64, String) {
    let run = folder.run(&format!("calibrate {MODEL} {files} --held-out 0.3 --out out --force"));
    assert!(run.code <= 1, "{files}: {}", run.err);
    let found: serde_json::Value = serde_json::from_str(&folder.read("out/calibration.json")).unwrap();
    let rms = &found["accuracy"]["held_out"]["calibrated"]["position_mm"]["rms"];
    (rms.as_f64().unwrap(), run.err)
}

/// A file's name and its text.
type Named = (&'static str, String);

/// Joint readings, and points or poses, each in a form of its own.
fn forms(rows: &[Row]) -> (Vec<Named>, Vec<Named>) {
    let each = |of: &dyn Fn(usize, &Row) -> String| -> String {
        rows.iter().enumerate().map(|(k, row)| of(k + 1, row)).collect()
    };
    let rapid = each(&|k, row| {
        format!(
            "  CONST jointtarget P{k}:=[[{}],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];\n",
            join_numbers(&row.0, 9, ",")
        )
    });
    let krl = each(&|k, row| {
        let axes: Vec<String> = row.0.iter().enumerate().map(|(at, it)| format!("A{} {it:.9}", at + 1)).collect();
        format!("DECL E6AXIS XP{k}={{{},E1 0.0,E2 0.0,E3 0.0,E4 0.0,E5 0.0,E6 0.0}}\n", axes.join(","))
    });
    let positions = each(&|k, row| {
        let axes: Vec<String> = row.0.iter().enumerate().map(|(at, it)| format!("J{}= {it:.9} deg", at + 1)).collect();
        format!("P[{k}]{{\n   GP1:\n\tUF : 0, UT : 1,\n\t{}\n}};\n", axes.join(",\n\t"))
    });
    let moves = each(&|k, _| format!("   {k}:J P[{k}] 20% FINE ;\n"));
    let script = each(&|_, row| {
        let radians: Vec<f64> = row.0.iter().map(|it| it.to_radians()).collect();
        format!("  movej([{}], a=1.0, v=0.5)\n  sleep(2.0)\n", join_numbers(&radians, 12, ","))
    });
    let log = each(&|k, row| {
        let radians: Vec<f64> = row.0.iter().map(|it| it.to_radians()).collect();
        let wanted: Vec<f64> = radians.iter().map(|it| it + 0.01).collect();
        format!("{}.5 {} {}\n", 5 * k, join_numbers(&wanted, 12, " "), join_numbers(&radians, 12, " "))
    });
    let names = |stem: &str| (0..6).map(|k| format!("{stem}_{k}")).collect::<Vec<_>>().join(" ");
    let joints = vec![
        ("rapid.mod", format!("MODULE Calib\n{rapid}ENDMODULE\n")),
        (
            "rokae.mod",
            each(&|k, row| {
                format!("LOCAL VAR jointtarget j{k} = j:{{{} ,0}}{{EJ 0,0,0,0,0,0}}\n", join_numbers(&row.0, 9, ","))
            }),
        ),
        ("krl.dat", format!("&ACCESS RVP\nDEFDAT CALIB\n{krl}ENDDAT\n")),
        ("fanuc.ls", format!("/PROG CALIB\n/ATTR\n/MN\n{moves}/POS\n{positions}/END\n")),
        ("moves.script", format!("def calib():\n{script}end\n")),
        ("log.csv", format!("timestamp {} {}\n{log}", names("target_q"), names("actual_q"))),
        ("bare.txt", each(&|_, row| join_numbers(&row.0, 9, " ") + "\n")),
        (
            "turned.csv",
            format!("A1;A2;A3;A4;A5;A6\n{}", each(&|_, row| join_numbers(&row.0, 9, ";").replace('.', ",") + ";\n")),
        ),
    ];
    let comments = "// SpatialAnalyzer SA 2024.2\n// Points Relative to Coordinate Frame 'A::WORLD'\n// AXES = ";
    let cylindrical = each(&|k, row| {
        let [x, y, z] = row.1;
        format!("Robot,  P{k},  {:.9},  {:.12},  {z:.6}\n", x.hypot(y), y.atan2(x).to_degrees())
    });
    let measured = vec![
        (
            "group.txt",
            format!(
                "{comments}CARTESIAN: X,  Y,  Z (mm)\n{}",
                each(&|k, row| format!(
                    "Robot,  P{k},  0,  {},  02/12/25 16:5{}:00\n",
                    join_numbers(&row.1, 6, ",  "),
                    k % 10
                ))
            ),
        ),
        (
            "inches.txt",
            format!(
                "{comments}CARTESIAN: X,  Y,  Z (inches)\n{}",
                each(&|k, row| {
                    let inches = row.1.map(|it| format!("{:.12e}", it / 25.4));
                    format!("Cell 4::Robot::P{k}  {}\n", inches.join("  "))
                })
            ),
        ),
        ("cylindrical.txt", format!("{comments}CYLINDRICAL: R,  Theta,  Z (mm, deg)\n{cylindrical}")),
        (
            "uncertain.txt",
            format!(
                "{comments}CARTESIAN: X,  Y,  Z (mm)\n{}",
                each(&|k, row| format!(
                    "Robot,  P{k},  {},  0.0,  6.35,  0.05,  0.05,  0.05\n",
                    join_numbers(&row.1, 6, ",  ")
                ))
            ),
        ),
        (
            "leica.csv",
            format!(
                "X  [mm],Y  [mm],Z  [mm],U(95)  [mm],Image RMS  [\u{b5}m],Temperature  [\u{b0}C],Time Stamp,Delete\n{}",
                each(&|_, row| format!("{},0.18,0.24,22.6,'11.10.2022 10:00:00.000,\n", join_numbers(&row.1, 6, ",")))
            ),
        ),
    ];
    (joints, measured)
}

#[test]
fn every_pair_of_forms_gives_the_calibration_of_our_own() {
    let folder = Folder::new();
    let rows = session(&folder, 40);
    fs::write(folder.path("own.csv"), own_form(&rows, false)).unwrap();
    let (expected, _) = held_out(&folder, "own.csv");
    let (joints, measured) = forms(&rows);
    for (name, text) in joints.iter().chain(&measured) {
        // As Windows writes it: `µ` and `°` are one byte.
        let bytes: Vec<u8> = text.chars().map(|it| u8::try_from(u32::from(it)).unwrap()).collect();
        fs::write(folder.path(name), bytes).unwrap();
    }
    let utf16 = measured[0].1.replace('\n', "\r\n");
    let wide: Vec<u8> = std::iter::once(0xfeff).chain(utf16.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    fs::write(folder.path("wide.txt"), wide).unwrap();
    let pairs = joints.iter().map(|it| (it.0, "group.txt")).chain(measured.iter().map(|it| ("rapid.mod", it.0)));
    for (one, other) in pairs.chain([("rapid.mod", "wide.txt")]) {
        let (found, said) = held_out(&folder, &format!("{one} {other}"));
        println!("{one} {other}: {found:.6} mm, {expected:.6} in our form");
        // Other weights of the rows, since they state equal uncertainties, and digits of the files.
        assert!((found / expected - 1.0).abs() < 0.01, "{one} {other}: {found} {expected}\n{said}");
        assert!(said.contains("were joined"), "{one} {other}: {said}");
    }
}

#[test]
fn files_of_several_places_of_the_tracker_have_a_frame_each() {
    let folder = Folder::new();
    let rows = session(&folder, 60);
    fs::write(folder.path("own.csv"), own_form(&rows, false)).unwrap();
    let (expected, _) = held_out(&folder, "own.csv");
    let (joints, _) = forms(&rows);
    fs::write(folder.path("rapid.mod"), &joints[0].1).unwrap();
    for (place, range) in [(1, 0..30), (2, 30..60)] {
        let mut text = format!(
            "// SpatialAnalyzer\n// Points Relative to Coordinate Frame 'Cell::Tracker {place}'\n// AXES = CARTESIAN: X,  Y,  Z (mm)\n"
        );
        for at in range {
            let [x, y, z] = rows[at].1;
            // The tracker was turned by a right angle, and carried some metres.
            let seen = if place == 1 { [x, y, z] } else { [2000.0 - y, x - 700.0, z + 300.0] };
            writeln!(text, "Robot,  P{},  {}", at + 1, join_numbers(&seen, 6, ",  ")).unwrap();
        }
        fs::write(folder.path(&format!("place{place}.txt")), text).unwrap();
    }
    let (found, said) = held_out(&folder, "rapid.mod place1.txt place2.txt");
    println!("{found:.6} mm of two places, {expected:.6} of one");
    // Another split of the rows, and a frame more.
    assert!(found < 1.3 * expected, "{found} {expected} {said}");
    let calibration = folder.read("out/calibration.json");
    assert!(calibration.contains("Cell::Tracker 1") && calibration.contains("Cell::Tracker 2"));
}

#[test]
fn files_of_other_tools_are_whole_sessions() {
    let folder = Folder::new();
    let rows = session(&folder, 40);
    fs::write(folder.path("own.csv"), own_form(&rows, true)).unwrap();
    let (expected, _) = held_out(&folder, "own.csv");
    // R = Rx Ry Rz (RoboDK), and R = Rz Ry Rx (Auto ID).
    let angles = |q: &[f64; 4], is_moving: bool| {
        let [x, y, z, w] = *q;
        let at = |sign: f64| {
            let s = (2.0 * (w * y + sign * z * x)).clamp(-1.0, 1.0);
            (
                (2.0 * (w * x - sign * y * z)).atan2(1.0 - 2.0 * (x * x + y * y)),
                s.asin(),
                (2.0 * (w * z - sign * x * y)).atan2(1.0 - 2.0 * (y * y + z * z)),
            )
        };
        let (a, b, c) = at(if is_moving { 1.0 } else { -1.0 });
        [a, b, c]
    };
    let mut robodk = "J1,J2,J3,J4,J5,J6,X,Y,Z,rX,rY,rZ,TCP X,TCP Y\n".to_owned();
    let mut auto_id = String::new();
    for (k, (joints, place, turn)) in rows.iter().enumerate() {
        let moving = angles(turn, true);
        writeln!(
            robodk,
            "{},{},{},0,0",
            join_numbers(joints, 9, ","),
            join_numbers(place, 6, ","),
            join_numbers(&moving, 12, ",")
        )
        .unwrap();
        let fixed = angles(turn, false).map(f64::to_degrees);
        let cells = [join_numbers(place, 6, "\t"), join_numbers(&fixed, 10, "\t"), join_numbers(joints, 9, "\t")];
        writeln!(auto_id, "P{}\t{}", k + 1, cells.join("\t")).unwrap();
    }
    fs::write(folder.path("robodk.csv"), robodk).unwrap();
    fs::write(folder.path("auto_id.txt"), auto_id).unwrap();
    for name in ["robodk.csv", "auto_id.txt"] {
        let (found, said) = held_out(&folder, name);
        println!("{name}: {found:.6} mm, {expected:.6} in our form");
        assert!((found / expected - 1.0).abs() < 1e-3, "{name}: {found} {expected}\n{said}");
        assert!(said.contains("took it for"), "{said}");
    }
}

#[test]
fn the_one_sheet_with_a_table_is_read_and_its_cells_are_named() {
    let folder = Folder::new();
    let rows = session(&folder, 40);
    fs::write(folder.path("own.csv"), own_form(&rows, false)).unwrap();
    let (expected, _) = held_out(&folder, "own.csv");
    let mut sheet: Vec<Vec<String>> = vec![vec!["Messprotokoll".to_owned()], Vec::new()];
    sheet.push(["Nr.", "A1", "A2", "A3", "A4", "A5", "A6", "X", "Y", "Z"].map(str::to_owned).to_vec());
    sheet.push(
        ["", "\u{b0}", "\u{b0}", "\u{b0}", "\u{b0}", "\u{b0}", "\u{b0}", "mm", "mm", "mm"].map(str::to_owned).to_vec(),
    );
    for (k, (joints, place, _)) in rows.iter().enumerate() {
        let numbers = joints.iter().chain(place).map(|it| format!("{it}"));
        sheet.push(std::iter::once((k + 1).to_string()).chain(numbers).collect());
    }
    let note = vec![vec!["do not use".to_owned()]];
    let write = |name: &str, sheets: &[(&str, &Vec<Vec<String>>)]| {
        fs::write(folder.path(name), workbook(sheets)).unwrap();
    };
    write("one.xlsx", &[("Notes", &note), ("Messung", &sheet)]);
    let (found, said) = held_out(&folder, "one.xlsx");
    println!("workbook: {found:.6} mm, {expected:.6} in our form");
    assert!((found / expected - 1.0).abs() < 1e-3, "{said}");
    assert!(said.contains("sheet `Messung`, 40 rows from row 5 on"), "{said}");
    write("two.xlsx", &[("A", &sheet), ("B", &sheet)]);
    let run = folder.run(&format!("check {MODEL} two.xlsx"));
    assert_eq!(run.code, 2);
    assert!(
        run.err.contains("two.xlsx: found tables in the sheets `A`, `B`, expected one: name it by --sheet"),
        "{}",
        run.err
    );
    assert_eq!(folder.run(&format!("check {MODEL} two.xlsx --sheet B")).code, 0);
    let run = folder.run(&format!("check {MODEL} two.xlsx --sheet C"));
    assert!(run.err.contains("found no sheet `C`, expected one of `A`, `B`"), "{}", run.err);
    // A number as text has one meaning, or it is an error, or it is no number at all.
    for (text, code, expected) in [
        ("t63,6844", 0, "numbers that are stored as text are read as numbers: B6 (`63,6844`)"),
        (
            "t63,684",
            2,
            "sheet `Messung`, cell B6: found the text `63,684`, which is 63.684 with a decimal comma and another number",
        ),
        ("tup", 2, "sheet `Messung`, cell B6: found `up` in column `A1`, expected a finite number"),
    ] {
        let mut changed = sheet.clone();
        changed[5][1] = text.to_owned();
        write("text.xlsx", &[("Messung", &changed)]);
        let run = folder.run(&format!("check {MODEL} text.xlsx"));
        assert_eq!(run.code, code, "{text}: {}", run.err);
        let said = run.out + &run.err;
        assert!(said.split_whitespace().collect::<Vec<_>>().join(" ").contains(expected), "{text}: {said}");
    }
    fs::write(folder.path("cut.xlsx"), &workbook(&[("Messung", &sheet)])[..2000]).unwrap();
    let run = folder.run(&format!("check {MODEL} cut.xlsx"));
    assert_eq!(run.code, 2);
    assert!(run.err.contains("a workbook that is damaged"), "{}", run.err);
}

#[test]
fn what_has_one_part_alone_or_none_is_named() {
    let folder = Folder::new();
    let rows = session(&folder, 12);
    let (joints, measured) = forms(&rows);
    for (name, text) in [joints, measured].concat() {
        fs::write(folder.path(name), text).unwrap();
    }
    let pulses = "/JOB\n//NAME CALIB\n//POS\n///PULSE\nC00000=85426,196440,95242,173936,5561,72128\n";
    fs::write(folder.path("calib.jbi"), pulses).unwrap();
    fs::write(folder.path("poses.script"), "def a():\n  movel(p[0.4,0.1,0.3,0,3.1,0], a=1, v=0.2)\nend\n").unwrap();
    fs::write(folder.path("bag.db3"), b"SQLite format 3\0rest").unwrap();
    fs::write(folder.path("old.bag"), b"#ROSBAG V2.0\nrest of it").unwrap();
    fs::write(folder.path("wall.mat"), b"MATLAB 5.0 MAT-file, Platform: GLNXA64").unwrap();
    let spherical = "// SpatialAnalyzer\n// AXES = SPHERICAL: R, Theta, Phi (mm, deg)\nA, P1, 1, 2, 3\n";
    fs::write(folder.path("spherical.txt"), spherical).unwrap();
    let before = folder.listing();
    for (files, expected) in [
        (
            "group.txt",
            "found measurements and no joint readings, expected both: name the file of the joint readings beside it",
        ),
        (
            "rapid.mod",
            "found joint readings and nothing that was measured, expected both: name the file of the measurements beside it",
        ),
        ("calib.jbi", "whose positions are pulses"),
        ("poses.script group.txt", "found a program of URScript with a target that is a pose"),
        ("bag.db3", "found a ROS 2 bag in SQLite (.db3)"),
        ("old.bag", "found a ROS 1 bag"),
        ("wall.mat", "found a MATLAB file (.mat)"),
        ("rapid.mod spherical.txt", "found coordinates that are neither Cartesian nor cylindrical"),
    ] {
        let run = folder.run(&format!("calibrate {MODEL} {files} --out out --quiet"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{files}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{files}: {}", run.err);
    }
    assert!(folder.listing() == before);
}

/// Interpolation of two rows of numbers.
pub(crate) fn interpolate_rows(one: &[f64], other: &[f64], share: f64) -> Vec<f64> {
    one.iter().zip(other).map(|(a, b)| a + share * (b - a)).collect()
}

/// Interpolation of two orientations, as unit quaternions.
pub(crate) fn interpolate_turn(one: [f64; 4], other: [f64; 4], share: f64) -> [f64; 4] {
    let dot = one.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>();
    let other = if dot < 0.0 { other.map(|it| -it) } else { other };
    let turn = interpolate_rows(&one, &other, share);
    let length = turn.iter().map(|it| it * it).sum::<f64>().sqrt();
    std::array::from_fn(|k| turn[k] / length)
}

/// A stream of static intervals of a second and moves of 0.8 s: for each row its time, the configuration and its share of the path to the next one.
pub(crate) fn stream(rows: usize, rate: usize) -> Vec<(f64, usize, f64)> {
    let mut found = Vec::new();
    let mut time = 0.0;
    for row in 0..rows {
        // Static intervals of different lengths.
        let stand = rate + row * 7 % 11 * rate / 20;
        let moved = 4 * rate / 5;
        for step in 0..stand + moved {
            let share = (step as f64 - stand as f64).max(0.0) / moved as f64;
            found.push((time, row, share * share * (3.0 - 2.0 * share)));
            time += 1.0 / rate as f64;
        }
    }
    found
}

#[test]
fn recordings_with_clocks_of_their_own_are_joined_at_their_stands() {
    let folder = Folder::new();
    let rows = session(&folder, 26);
    fs::write(folder.path("own.csv"), own_form(&rows, true)).unwrap();
    let (expected, _) = held_out(&folder, "own.csv");
    let Recordings { log, take, qualisys } = recordings(&rows);
    fs::write(folder.path("robot_data.csv"), log).unwrap();
    fs::write(folder.path("take.csv"), &take).unwrap();
    fs::write(folder.path("take_6D.tsv"), qualisys).unwrap();
    for other in ["take.csv", "take_6D.tsv"] {
        let (found, said) = held_out(&folder, &format!("robot_data.csv {other}"));
        println!("{other}: {found:.6} mm, {expected:.6} of the configurations themselves");
        assert!((found / expected - 1.0).abs() < 0.05, "{other}: {found} {expected}\n{said}");
        assert!(said.contains("26 stands of 26 and of 26 are the same, at a lag of -12621.0"), "{said}");
        let file: serde_json::Value = serde_json::from_str(&folder.read("out/calibration.json")).unwrap();
        let join = &file["inputs"]["joins"][0];
        assert_eq!(join["join"], "time");
        // Static intervals begin and end within some rows of each stream.
        assert!((join["lag_s"].as_f64().unwrap() + 12_621.06).abs() < 0.1, "{}", join["lag_s"]);
        for motion in ["robot_motion", "measured_motion"] {
            let motion = &join[motion];
            assert_eq!(motion["stands_s"].as_array().unwrap().len(), 26);
            let speeds: Vec<f64> =
                motion["speeds_mm_s"].as_array().unwrap().iter().filter_map(serde_json::Value::as_f64).collect();
            let still = speeds.iter().filter(|it| **it < 5.0).count();
            // Static intervals take 55 % of the time.
            assert!(
                speeds.len() > 300 && (0.4..0.7).contains(&(still as f64 / speeds.len() as f64)),
                "{still} of {}",
                speeds.len()
            );
        }
        let page = folder.read("out/report.html");
        assert!(
            page.contains("How the files were joined")
                && page.contains("speed, mm/s")
                && page.contains("at the times of their stands")
        );
    }
    // Another body that moves.
    let moving = take
        .lines()
        .enumerate()
        .map(|(k, line)| line.replace("500,100,-700", &format!("{},100,-700", 400 + k % 200)) + "\n");
    fs::write(folder.path("two.csv"), moving.collect::<String>()).unwrap();
    let run = folder.run(&format!("check {MODEL} robot_data.csv two.csv"));
    assert_eq!(run.code, 2);
    assert!(
        run.err
            .contains("found 2 bodies that move, `Table`, `Tool`, expected one: name the one on the robot by --body"),
        "{}",
        run.err
    );
    assert_eq!(folder.run(&format!("check {MODEL} robot_data.csv two.csv --body Tool")).code, 0);
}

#[test]
fn no_damage_to_a_file_of_another_form_makes_reading_panic() {
    let folder = Folder::new();
    let rows = session(&folder, 12);
    let robot = Model::read(MODEL, &ChainSelection::default()).unwrap().robot;
    let options = ReadOptions::default();
    let (joints, measured) = forms(&rows);
    let motive = "Format Version,1.24,Export Frame Rate,100.0,Rotation Type,Quaternion,Length Units,Meters\n\n,Type,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n,Name,,Tool,Tool,Tool,Tool,Tool,Tool,Tool\n,,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\nFrame,Time (Seconds),TimeCode,X,Y,Z,W,X,Y,Z\n0,0.0,0,0,0,0,1,1,2,3\n1,0.01,0,0,0,0,1,1,2,4\n";
    let qualisys = "NO_OF_FRAMES\t2\nFREQUENCY\t100\nDATA_INCLUDED\t6D\nBODY_NAMES\tTool\nFrame\tTime\tTool X\tY\tZ\tRoll\tPitch\tYaw\tResidual\tRot[0]\tRot[1]\tRot[2]\tRot[3]\tRot[4]\tRot[5]\tRot[6]\tRot[7]\tRot[8]\t\n1\t0.0\t10.0\t20.0\t30.0\t0.0\t0.0\t0.0\t0.3\t1\t0\t0\t0\t1\t0\t0\t0\t1\t\n2\t0.01\t90.0\t20.0\t30.0\t0.0\t0.0\t0.0\t0.3\t1\t0\t0\t0\t1\t0\t0\t0\t1\t\n";
    let ndi = "Test\n\nSample:,Hour,Minutes,Seconds,ms,Xa,Ya,Za,qoa,qxa,qya,qza\n1, 4 , 15 , 52, 821,0, 0, 0, 0, 0, 0, 0, \n2, 4 , 15 , 53, 1,102.84 , -60 , -158.25, 1, 0, 0, 0, \n";
    let others = [motive, qualisys, ndi].map(str::to_owned);
    let texts: Vec<String> = joints.into_iter().chain(measured).map(|it| it.1).chain(others).collect();
    let mut refused = 0;
    let mut tries = 0;
    for text in &texts {
        let bytes = text.as_bytes();
        // Some hundred positions in each.
        for at in (0..bytes.len()).step_by(1 + bytes.len() / 250) {
            for change in [b"".as_slice(), b",", b"\t", b"9", b"-", b"\n", b"[", b"}", b"\"", b"e9"] {
                let damaged = [&bytes[..at], change, &bytes[at + 1..]].concat();
                let text = String::from_utf8_lossy(&damaged);
                tries += 1;
                refused += usize::from(measurements::parse(&text, "damaged.txt", &robot, &options).is_err());
            }
            tries += 1;
            let text = String::from_utf8_lossy(&bytes[..at]);
            refused += usize::from(measurements::parse(&text, "damaged.txt", &robot, &options).is_err());
        }
    }
    let sheet: Vec<Vec<String>> =
        std::iter::once(["A1", "A2", "A3", "A4", "A5", "A6", "X", "Y", "Z"].map(str::to_owned).to_vec())
            .chain(rows.iter().map(|(joints, place, _)| joints.iter().chain(place).map(|it| format!("{it}")).collect()))
            .collect();
    let book = workbook(&[("Messung", &sheet)]);
    let path = folder.path("damaged.xlsx");
    for at in (0..book.len()).step_by(1 + book.len() / 1500) {
        for byte in [0, b'9', 0xff] {
            let mut damaged = book.clone();
            damaged[at] = byte;
            fs::write(&path, damaged).unwrap();
            tries += 1;
            refused += usize::from(measurements::read(&[&path], &robot, &options).is_err());
        }
    }
    println!("{refused} of {tries} damaged files refused");
    assert!(2 * refused > tries);
}
