//! `poecal compensate`: tables of joint readings, and robot programs.

use std::fmt::Write as _;

use poecal_model::simulate::SessionKind;
use poecal_results::calibration_file::CalibrationFile;

use crate::folder::Folder;
use crate::session::{numbers, session};

/// A text without its digits, signs and points.
fn strip_digits(text: &str) -> String {
    text.chars().filter(|c| !c.is_ascii_digit() && !".,-e".contains(*c)).collect()
}

const PROGRAM: &str = "\u{feff}# Griff; 1;2;3\r\nname;joint1[deg];joint2[deg];joint3[deg];joint4[deg];joint5[deg];joint6[deg];io\r\n\
    A;10,5;20,25;30;40;50;60;an\r\n\r\n# nichts: 1;2\r\n\"B; c\";-1;2;-3;4;-50;6; aus\r\n C ; \"1,5\";2;3;4;50;6;";

/// A folder with a calibration and a program.
fn folder() -> Folder {
    let folder = session(SessionKind::POSE);
    folder.run_to_success("calibrate robot.urdf measurements.csv --out results");
    folder.write("program.csv", PROGRAM);
    folder
}

#[test]
fn everything_but_the_readings_stays_and_the_tip_is_where_it_was_meant() {
    let folder = folder();
    let told = folder
        .run_to_success("compensate --max-correction 20deg results/calibration.json program.csv --out out.csv --check");
    assert!(told.starts_with("largest change: `joint"), "{told}");
    assert!(told.contains("\n3 rows corrected: without correction the tip would be off by "), "{told}");
    assert!(told.contains("checked from the written numbers: at most "), "{told}");
    let written = folder.read("out.csv");
    assert_eq!(strip_digits(&written), strip_digits(PROGRAM));
    assert_ne!(written, PROGRAM);
    // By the program's own predictions, of the same readings without the words of the file.
    let plain = |text: &str| {
        let mut plain = "joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]\n".to_owned();
        for row in text.lines().filter(|it| ["A;", "\"B", " C"].iter().any(|name| it.starts_with(name))) {
            let cells: Vec<String> = row.replace("B; c", "").split(';').skip(1).take(6).map(clean_cell).collect();
            writeln!(plain, "{}", cells.join(",")).unwrap();
        }
        plain
    };
    fn clean_cell(cell: &str) -> String {
        cell.trim().trim_matches('"').replace(',', ".")
    }
    folder.write("commanded.csv", plain(&written));
    let reached = numbers(&folder.run_to_success("predict results/calibration.json commanded.csv"), 0);
    // Programmed with base and tool of the actual robot.
    let file = CalibrationFile::read(folder.path("results/calibration.json")).unwrap();
    let actual = file.corrected_file().map_or_else(|| file.robot(), |it| it.robot()).unwrap();
    let taught = file.taught_robot(&actual).unwrap().robot;
    let meant: Vec<_> = numbers(&plain(PROGRAM), 0)
        .iter()
        .map(|degrees| degrees.iter().map(|it| it.to_radians()).collect::<Vec<f64>>())
        .map(|q| taught.forward_kinematics(&q).translation)
        .collect();
    assert_eq!((meant.len(), reached.len()), (3, 3));
    let apart = meant.iter().zip(&reached).flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
    let worst = apart.fold(0.0, f64::max);
    println!("apart by {worst:.1e}");
    assert!(worst < 1e-9, "{worst}");
}

#[test]
fn standard_output_and_pipes_give_the_same_bytes_and_json_the_same_figures() {
    let folder = folder();
    let json = folder
        .run_to_success("compensate --max-correction 20deg results/calibration.json program.csv --out out.csv --json");
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&found["rows"], &found["joints"][5]), (&3.into(), &"joint6".into()));
    assert!(found["left_m"]["value"].as_f64().unwrap() < 1e-9);
    let written = folder.read("out.csv");
    assert_eq!(
        folder.run_to_success("compensate --max-correction 20deg results/calibration.json program.csv"),
        written
    );
    let piped = folder.run_with_input("compensate --max-correction 20deg results/calibration.json -", PROGRAM);
    assert_eq!((piped.code, piped.out), (0, written));
    // Without a calibration's findings there is nothing to correct.
    folder.write("same.csv", "joint1,joint2,joint3,joint4,joint5,joint6\n0.1,0.2,0.3,0.4,0.5,0.6\n");
    let other =
        folder.run_to_success("compensate --max-correction 20deg results/calibration.json same.csv --model calibrated");
    assert_eq!(other.lines().count(), 2);
}

#[test]
fn what_cannot_be_corrected_is_told_and_nothing_is_written() {
    let folder = folder();
    folder.write("short.csv", "joint1,joint2\n0,0\n");
    folder.write("word.csv", "joint1,joint2,joint3,joint4,joint5,joint6\n0,0,0,0,0.5,0\n0,0,x,0,0,0\n");
    folder.write("sum.toml", "[joints]\njoint3 = { value = 0.1 }\n");
    let before = folder.listing();
    for (arguments, sentence) in [
        ("robot.urdf program.csv", "error: robot.urdf: found a robot model, expected a calibration.json"),
        ("results/calibration.json short.csv", "error: short.csv:1: found no column `joint3`"),
        (
            "results/calibration.json word.csv",
            "error: word.csv:3:5: found `x` in column `joint3`, expected a finite number",
        ),
        (
            "results/calibration.json program.csv --factors heat=3",
            "error: found --factors heat=3, expected NAME=VALUE with a factor of the model: ",
        ),
        ("results/calibration.json nowhere.csv", "error: nowhere.csv: found no such file"),
    ] {
        let run = folder.run(&format!("compensate {arguments} --out out.csv"));
        println!("{}", run.err.trim_end());
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{arguments}");
        assert!(run.err.contains(sentence), "{arguments}: {}", run.err);
    }
    let run =
        folder.run("compensate --max-correction 20deg results/calibration.json program.csv --out program.csv --force");
    assert!(run.code == 2 && run.err.contains("input"), "{}", run.err);
    let run = folder
        .run("compensate --max-correction 20deg results/calibration.json word.csv --columns sum.toml --out out.csv");
    assert!(run.code == 2 && run.err.contains("`joint3` is a constant by the mapping"), "{}", run.err);
    assert_eq!(folder.listing(), before);
}

/// The nominal arm reaches farther than the actual one, in some direction.
#[test]
fn poses_out_of_reach_are_listed_or_come_near() {
    let folder = folder();
    let mut text = "joint1,joint2,joint3,joint4,joint5,joint6\n".to_owned();
    for step in 0..60 {
        writeln!(text, "0.3,0.4,{},0.1,0.5,0.2", -1.5 - 0.002 * f64::from(step)).unwrap();
        writeln!(text, "0.3,0.4,{},0.1,0.5,0.2", 0.1 * f64::from(step) - 3.0).unwrap();
    }
    folder.write("edge.csv", &text);
    let refused = folder.run("compensate --max-correction 20deg results/calibration.json edge.csv --out out.csv");
    let kept = folder.read("out.csv");
    if refused.code != 0 {
        assert_eq!(refused.code, 1);
        assert!(refused.out.contains(": the actual robot does not reach it: "), "{}", refused.out);
        let line = refused.out.split("  line ").nth(1).and_then(|it| it.split(':').next()).unwrap();
        let at = line.parse::<usize>().unwrap() - 1;
        assert_eq!(kept.lines().nth(at), text.lines().nth(at));
    }
    let near = folder
        .run("compensate --max-correction 20deg results/calibration.json edge.csv --out out.csv --nearest --force");
    assert_eq!(near.code, 0, "{}{}", near.out, near.err);
    assert_eq!(refused.code != 0, near.err.contains("cannot be reached by the actual robot"), "{}", near.err);
    assert_eq!(folder.read("out.csv").lines().count(), text.lines().count());
}

const SCRIPT: &[u8] = b"# Gr\xfc\xdfe\r\ndef p():\r\n  movej([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], a=1.4)\r\n  wp = p[0.55, 0.1, 0.75, 0.1, 1.2, 0.2]\r\n  \
    movel(wp)\r\nend\r\n";

#[test]
fn a_robot_program_keeps_its_bytes_and_what_is_left_is_listed() {
    let folder = folder();
    std::fs::write(folder.path("p.script"), SCRIPT).unwrap();
    let run =
        folder.run("compensate --max-correction 20deg results/calibration.json p.script --out out.script --check");
    println!("{}{}", run.out, run.err);
    assert_eq!(run.code, 1);
    assert!(run.out.contains("\n1 target corrected: without correction the tip would be off by "), "{}", run.out);
    assert!(run.out.contains("checked from the written numbers: at most "), "{}", run.out);
    let row = "  line 4: wp: the tool is not known: state it by --tool-data (motion on line 5)\n";
    assert!(run.out.contains(&format!("1 target is left as it is:\n{row}")), "{}", run.out);
    assert!(run.err.contains("1 target is left as the program has it, where the robot will miss as before; the first on line 4: the tool is not known"), "{}", run.err);
    let written = std::fs::read(folder.path("out.script")).unwrap();
    let bare = |text: &[u8]| -> Vec<u8> {
        text.iter().copied().filter(|it| !it.is_ascii_digit() && !b".-".contains(it)).collect()
    };
    assert_eq!(bare(&written), bare(SCRIPT));
    assert_ne!(written, SCRIPT);
    let end = |text: &[u8]| text[text.len() - 60..].to_vec();
    assert_eq!(end(&written), end(SCRIPT));
    let json = folder
        .run("compensate --max-correction 20deg results/calibration.json p.script --out out.script --json --force");
    let found: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!((json.code, &found["corrected"], &found["rows"]), (1, &1.into(), &1.into()));
    assert_eq!((&found["listed"][0]["line"], &found["language"]), (&4.into(), &"urscript".into()));
}

#[test]
fn mistakes_about_robot_programs_are_told_and_nothing_is_written() {
    let folder = folder();
    std::fs::write(folder.path("p.script"), SCRIPT).unwrap();
    folder.write("empty.src", " \n");
    std::fs::write(folder.path("wide.src"), b"D\0E\0F\0").unwrap();
    folder.write("deep.script", "if True:\n".repeat(300));
    folder.write("map.toml", "[joints]\n");
    let before = folder.listing();
    for (arguments, sentence) in [
        (
            "p.script --tool-data 0,0,0.1",
            "error: found --tool-data 0,0,0.1, expected x,y,z,rx,ry,rz as URScript writes poses (metres",
        ),
        ("p.script --tool-data a=0,0,0,0,0,x", "error: found --tool-data 0,0,0,0,0,x, expected x,y,z,rx,ry,rz"),
        (
            "p.script --tool-data 1=0,0,0,0,0,0 --tool-data 1=0,0,1,0,0,0",
            "error: found --tool-data 1=0,0,1,0,0,0 for one that is stated already",
        ),
        ("p.script --work-object inf,0,0,0,0,0", "error: found --work-object inf,0,0,0,0,0, expected"),
        ("p.script --controller-base 1", "error: found --controller-base 1, expected"),
        (
            "p.script --columns map.toml",
            "error: found --columns for a program in URScript, expected it for tables (CSV) alone",
        ),
        ("p.script --language logo", "error: invalid value 'logo' for '--language <LANGUAGE>'"),
        ("empty.src", "error: empty.src: the file is empty, expected a robot program"),
        ("wide.src", "error: wide.src: found zero bytes, expected a robot program as text"),
        ("deep.script", "error: deep.script:201: found more than 200 levels in blocks in each other, expected"),
        ("nowhere.src", "error: nowhere.src: found no such file, expected a robot program"),
        ("results --language krl", "error: results: found a directory, expected a robot program"),
    ] {
        let run = folder
            .run(&format!("compensate --max-correction 20deg results/calibration.json {arguments} --out out.txt"));
        println!("{}", run.err.trim_end());
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{arguments}");
        assert!(run.err.contains(sentence), "{arguments}: {}", run.err);
    }
    assert_eq!(folder.listing(), before);
}

#[test]
fn the_language_is_that_of_the_name_or_the_one_that_is_stated() {
    let folder = folder();
    folder.write("rows.dat", "joint1,joint2,joint3,joint4,joint5,joint6\n0.1,0.2,0.3,0.4,0.5,0.6\n");
    let table =
        folder.run_to_success("compensate --max-correction 20deg results/calibration.json rows.dat --language csv");
    assert_eq!(table.lines().count(), 2);
    let program = "DEF p()\nPTP {A1 10,A2 20,A3 30,A4 40,A5 50,A6 60} ; {A1 1}\nEND\n";
    folder.write("p.txt", program);
    let written =
        folder.run_to_success("compensate --max-correction 20deg results/calibration.json p.txt --language krl");
    println!("{written}");
    assert!(written.starts_with("DEF p()\nPTP {A1 ") && written.ends_with("} ; {A1 1}\nEND\n") && written != program);
    let piped =
        folder.run_with_input("compensate --max-correction 20deg results/calibration.json - --language krl", program);
    assert_eq!((piped.code, piped.out), (0, written));
    folder.write("p.src", program);
    folder.run_to_success("compensate --max-correction 20deg results/calibration.json p.src --out q.src --quiet");
}

#[test]
fn a_straight_wrist_is_corrected_in_place_and_what_takes_more_is_listed() {
    let folder = folder();
    folder.write("home.csv", "joint1,joint2,joint3,joint4,joint5,joint6\n0,0,0,0,0,0\n0.3,0.4,-0.5,0.1,0.9,0.2\n");
    let before = folder.listing();
    let dry = folder.run("compensate results/calibration.json home.csv --max-correction 4deg --dry-run --json");
    assert_eq!(folder.listing(), before);
    let found: serde_json::Value = serde_json::from_str(&dry.out).unwrap();
    let (rows, listed) = (found["targets"].as_array().unwrap(), found["listed"].as_array().unwrap());
    println!("{rows:?}\n{listed:?}");
    assert_eq!(rows.len() + listed.len(), 2);
    for row in rows {
        assert!(row["change"].as_f64().unwrap() < 0.1 && row["left_m"].as_f64().unwrap() < 1e-9);
    }
    // Nothing as small as this can be corrected.
    let none =
        folder.run("compensate results/calibration.json home.csv --max-correction 0.001deg --out out.csv --check");
    println!("{}{}", none.out, none.err);
    assert_eq!(none.code, 1);
    assert!(
        none.out.starts_with("0 rows corrected\n2 targets are left as they are:\n  line 2: row: joint `joint"),
        "{}",
        none.out
    );
    assert_eq!(folder.read("out.csv"), folder.read("home.csv"));
    for (words, sentence) in
        [("0deg", "expected an angle and a length above 0"), ("2", "without a unit"), ("x", "expected a number")]
    {
        let run = folder.run(&format!("compensate results/calibration.json home.csv --max-correction {words}"));
        assert!(run.code == 2 && run.err.contains(sentence), "{}", run.err);
    }
    let other = folder.run("compensate results/calibration.json weld.jbi");
    assert!(
        other.code == 2 && other.err.contains("weld.jbi: found a program of Yaskawa (JBI) by the end of its name"),
        "{}",
        other.err
    );
}
