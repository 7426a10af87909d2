//! Names and cells that would act on a terminal, forge lines or run in a spreadsheet.

use std::fmt::Write as _;

use poecal_model::simulate::{SessionKind, Simulation};
use poecal_numerics::text::visible_lines;
use poecal_results::model::Model;

use crate::folder::{Folder, Run};
use crate::session::ROBOT;

/// Joints of the elbow with their hostile names; one forges a verdict.
const NAMES: [&str; 6] = [
    "\u{9b}2J\u{9d}0;PWNED\u{9c}",
    "=cmd|'/C calc'!A0",
    "'quoted",
    "\u{202e}J4\u{2066}rtl",
    "\u{9b}31mC1",
    "J6\nverdict       good: as a name has it",
];
/// Ids and names of targets.
const CELLS: [&str; 6] = ["=1+1", "@SUM(A1)", "\u{1b}[31mid", "'=x", "-2+3\u{200b}", "=HYPERLINK(\"\"http://x\"\",a)"];

/// `robot.urdf` with hostile names of joints, `points.csv` with hostile ids and targets, and `map.toml` that brings them together.
fn folder() -> Folder {
    folder_of(NAMES)
}

fn folder_of(names: [&str; 6]) -> Folder {
    let folder = Folder::new();
    folder.write("plain.urdf", ROBOT);
    let mut urdf = ROBOT.to_owned();
    let mut map = "[joints]\n".to_owned();
    for (number, name) in (1..).zip(names) {
        let joint = format!("joint{number}");
        let in_xml: String = name.chars().map(|c| format!("&#{};", u32::from(c))).collect();
        urdf = urdf.replace(&format!("\"{joint}\""), &format!("\"{in_xml}\""));
        writeln!(map, "{} = \"{joint}\"", toml_string(name)).unwrap();
    }
    folder.write("robot.urdf", urdf);
    folder.write("map.toml", map);
    let model = Model::read(folder.path("plain.urdf"), &Default::default()).unwrap();
    let data = Simulation { count: 60, ..Simulation::default() }.run(&model.robot, SessionKind::POINT).unwrap().data;
    let mut text = format!("id,target,\u{1b}[5mextra\u{202d},{},x,y,z\n", data.reading_names().join(","));
    for (row, observation) in data.observations.iter().enumerate() {
        let [x, y, z]: [f64; 3] = observation.measurement.pose().translation.into();
        let readings: Vec<String> = data.readings(row).iter().map(|value| format!("{value:?}")).collect();
        let cell = CELLS[row % CELLS.len()];
        writeln!(text, "\"{cell}\",\"{}\",1,{},{x:?},{y:?},{z:?}", CELLS[row % 2 * 2], readings.join(",")).unwrap();
    }
    folder.write("points.csv", text);
    folder
}

fn toml_string(text: &str) -> String {
    let mut out = "\"".to_owned();
    for c in text.chars() {
        match c {
            '"' | '\\' => write!(out, "\\{c}").unwrap(),
            ' '..='~' => out.push(c),
            c => write!(out, "\\U{:08x}", u32::from(c)).unwrap(),
        }
    }
    out + "\""
}

fn assert_shown(words: &str, run: &Run) {
    for text in [&run.out, &run.err] {
        assert_eq!(*text, visible_lines(text), "poecal {words}");
        assert!(!text.contains("\nverdict       good: as"), "poecal {words}\n{text}");
    }
}

#[test]
fn names_and_cells_reach_people_as_they_can_see_them() {
    let folder = folder();
    let with = "--columns map.toml";
    for words in [
        format!("check robot.urdf points.csv {with}"),
        format!("calibrate robot.urdf points.csv {with} --out out"),
        format!("plan robot.urdf --rows points.csv --kind pose {with}"),
        format!("validate out/calibration.json points.csv {with}"),
        "offsets robot.urdf out/calibration.json".to_owned(),
        "report out/calibration.json".to_owned(),
        "check out/calibration.json".to_owned(),
    ] {
        let run = folder.run(&words);
        assert_eq!(run.code, 0, "poecal {words}\n{}{}", run.out, run.err);
        assert_shown(&words, &run);
    }
    let check = folder.run_to_success(&format!("check robot.urdf points.csv {with}"));
    assert!(check.contains("\\u{9b}2J\\u{9d}0;PWNED\\u{9c}: revolute"), "{check}");
    assert!(check.contains("J6\\u{a}verdict") && check.contains("\\u{202e}J4\\u{2066}rtl"), "{check}");
    assert!(check.contains("\\u{1b}[5mextra\\u{202d}"), "{check}");
    // A cell that a spreadsheet would run is marked, and read back unchanged.
    let residuals = folder.read("out/residuals.csv");
    assert!(residuals.lines().any(|line| line.contains(",'=1+1,fit,'=1+1,")), "{residuals}");
    let predicted = folder.run_to_success(&format!("predict robot.urdf points.csv {with}"));
    assert!(predicted.contains("\n'@SUM(A1),") && predicted.contains("\n'=x,"), "{predicted}");
    let calibration = crate::session::calibration(&folder, "out");
    assert!(calibration.targets.contains_key("=1+1"), "{:?}", calibration.targets);
    // The report is shown by a browser, which reorders lines as a terminal does.
    let report = folder.read("out/report.html");
    for c in ['\u{9b}', '\u{9d}', '\u{202e}', '\u{2066}', '\u{200b}', '\u{1b}'] {
        assert!(!report.contains(c), "the report has {}", c.escape_unicode());
    }
    assert!(report.contains("\\u{202e}J4\\u{2066}rtl"));
}

/// The cells of a table, by the rules of CSV.
fn cells(text: &str) -> Vec<String> {
    let (mut found, mut cell, mut is_quoted) = (Vec::new(), String::new(), false);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if is_quoted && letters.peek() == Some(&'"') => cell.extend(letters.next()),
            '"' => is_quoted = !is_quoted,
            ',' | '\n' if !is_quoted => found.push(std::mem::take(&mut cell)),
            letter => cell.push(letter),
        }
    }
    found
}

/// No cell of a table that any command writes is one that a spreadsheet would run.
#[test]
fn no_table_has_a_cell_that_a_spreadsheet_would_run() {
    let [one, two, three, four, five, _] = NAMES;
    let folder = folder_of([one, two, three, four, five, "+J6"]);
    std::fs::create_dir(folder.path("inbox")).unwrap();
    let (rows, with) = (folder.read("points.csv"), "--columns map.toml");
    folder.write("inbox/+1.csv", &rows);
    folder.write("inbox/-1+2.csv", rows);
    folder.write("settings.toml", "poecal_settings = 1\ncolumns = \"map.toml\"\n");
    folder.write(
        "station.toml",
        "poecal_station = 1\ninbox = \"inbox/{serial}.csv\"\nresults = \"results/{serial}\"\nmodel = \"robot.urdf\"\nsettings = \"settings.toml\"\n",
    );
    let mut tables = Vec::new();
    for words in [
        format!("calibrate robot.urdf points.csv {with} --out out"),
        format!("validate out/calibration.json points.csv {with} --out judged"),
        format!("predict robot.urdf points.csv {with} --out predicted.csv"),
        format!("import robot.urdf points.csv {with} --out imported.csv"),
        format!("compensate out/calibration.json points.csv {with} --out corrected.csv --max-correction 90deg"),
        "simulate robot.urdf --kind point --count 8 --out simulated".to_owned(),
        format!("plan robot.urdf --candidates points.csv {with} --count 8 --out planned.csv"),
        "track out/calibration.json --plan 4 --out visit.csv".to_owned(),
        "fleet station.toml".to_owned(),
        "fleet report station.toml".to_owned(),
    ] {
        let run = folder.run(&words);
        println!("{words}: {}, {}", run.code, run.err.lines().last().unwrap_or_default());
        assert!(
            run.code <= 1 || words.starts_with("plan") || words.starts_with("track") || words.starts_with("compensate"),
            "{words}: {}",
            run.err
        );
    }
    let mut count = 0;
    for (path, content) in folder.listing() {
        let is_own = path.extension().is_some_and(|it| it == "csv")
            && !path.ends_with("points.csv")
            && !path.to_string_lossy().contains("inbox");
        // A table that is corrected in place keeps the cells of its input.
        let Some(content) = content.filter(|_| is_own && !path.ends_with("corrected.csv")) else { continue };
        tables.push(path.file_name().unwrap().to_string_lossy().into_owned());
        let text = String::from_utf8(content).unwrap();
        let body: String = text.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect();
        for cell in cells(&body) {
            count += 1;
            let is_run = cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err();
            assert!(!is_run, "{}: {cell:?}", path.display());
        }
    }
    println!("{count} cells of {tables:?}");
    for name in ["residuals.csv", "errors.csv", "predicted.csv", "imported.csv", "fleet.csv", "measurements.csv"] {
        assert!(tables.iter().any(|it| it == name), "{name}: {tables:?}");
    }
}

#[test]
fn mistakes_are_told_as_people_can_see_them() {
    let folder = folder();
    folder.write("a\u{1b}[2J.urdf", "<robot/>");
    folder.write("bad.csv", "joint1,\u{1b}[2J\u{1b}]52;c;cm0gLXJm\u{7}x\n1,2\n");
    folder.write("bad.toml", "poecal_robot = 1\nname = \"\u{9b}31m\"\nlength_unit = \"\\u001b[2J\"\n");
    let acts = "\u{1b}[31m\u{202e}\nverdict       good: as typed";
    for words in [
        vec!["check", "a\u{1b}[2J.urdf"],
        vec!["check", "plain.urdf", "bad.csv"],
        vec!["check", "bad.toml"],
        vec!["check", "robot.urdf", acts],
        vec!["calibrate", "robot.urdf", "points.csv", "--robust", acts],
        vec!["calibrate", "robot.urdf", "points.csv", "--sigma-position", acts],
        vec![acts],
        vec!["check", "--", acts, acts],
        vec!["export", "robot.urdf", "--format", "toml", "--offset", acts],
        vec!["check", "robot.urdf", "--columns", acts],
        vec!["check", "robot.urdf", "--tip-link", acts],
    ] {
        let words: Vec<String> = words.into_iter().map(str::to_owned).collect();
        let run = folder.run_words(&words);
        assert_eq!(run.code, 2, "{words:?}\n{}{}", run.out, run.err);
        assert!(run.err.contains("\\u{1b}"), "{words:?}\n{}", run.err);
        assert_shown(&format!("{words:?}"), &run);
    }
}
