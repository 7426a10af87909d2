//! Joint readings in one file, measurements in another.

use std::fs;

use crate::folder::Folder;

pub(crate) const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/elbow/robot.urdf");

/// Header and rows of a simulated session of an elbow with errors, cells by columns: joints first, then the measured quantities.
pub(crate) fn session(folder: &Folder, kind: &str, count: usize) -> (Vec<String>, Vec<Vec<String>>, usize) {
    folder.run_to_success(&format!("simulate {MODEL} --kind {kind} --count {count} --seed 3 --out made"));
    let text = folder.read("made/measurements.csv");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let header = cells(lines.next().unwrap());
    let joints = header.iter().filter(|name| name.starts_with("joint")).count();
    (header, lines.map(cells).collect(), joints)
}

/// Writes some columns of rows, with a name in front of each if there are names.
pub(crate) fn table(
    folder: &Folder,
    name: &str,
    header: &[String],
    rows: &[&[String]],
    ids: Option<&dyn Fn(usize) -> String>,
) {
    let id = |row: usize| ids.map_or(String::new(), |of| of(row) + ",");
    let mut text = format!("{}{}\n", if ids.is_some() { "id," } else { "" }, header.join(","));
    for (row, cells) in rows.iter().enumerate() {
        text += &format!("{}{}\n", id(row), cells.join(","));
    }
    fs::write(folder.path(name), text).unwrap();
}

/// Lines of a table without those that name files.
fn figures(said: &str) -> String {
    let own = |line: &&str| !line.starts_with("written") && !line.starts_with("note");
    said.lines().filter(own).collect::<Vec<_>>().join("\n")
}

#[test]
fn two_files_in_either_order_are_one_session() {
    for kind in ["point", "pose"] {
        let folder = Folder::new();
        let (header, rows, joints) = session(&folder, kind, 40);
        let left: Vec<&[String]> = rows.iter().map(|row| &row[..joints]).collect();
        let right: Vec<&[String]> = rows.iter().map(|row| &row[joints..]).collect();
        table(&folder, "joints.csv", &header[..joints], &left, None);
        table(&folder, "seen.csv", &header[joints..], &right, None);
        // By name, in another order.
        table(&folder, "named.csv", &header[..joints], &left, Some(&|row| format!("j{}", row + 1)));
        let turned: Vec<&[String]> = right.iter().rev().copied().collect();
        table(&folder, "points.csv", &header[joints..], &turned, Some(&|row| format!("P{}", 40 - row)));
        let whole = folder.run_to_success(&format!("calibrate {MODEL} made/measurements.csv --out whole"));
        for (at, files) in
            ["joints.csv seen.csv", "seen.csv joints.csv", "named.csv points.csv"].into_iter().enumerate()
        {
            let run = folder.run(&format!("calibrate {MODEL} {files} --out o{at}"));
            assert_eq!(run.code, 0, "{files}: {}", run.err);
            let split = |text: &str| figures(text).lines().take(6).collect::<Vec<_>>().join("\n");
            // Rows in another order make another random split.
            if at < 2 {
                assert_eq!(split(&run.out), split(&whole), "{files}");
            }
            assert!(run.err.contains("were joined"), "{}", run.err);
        }
    }
}

#[test]
fn lost_and_double_rows_are_named_and_all_others_paired() {
    let folder = Folder::new();
    let (header, rows, joints) = session(&folder, "point", 40);
    let left: Vec<&[String]> = rows.iter().map(|row| &row[..joints]).collect();
    let kept = |row: &usize| *row != 6 && *row != 22;
    let mut right: Vec<&[String]> = (0..40).filter(kept).map(|row| &rows[row][joints..]).collect();
    right.insert(29, &rows[30][joints..]);
    table(&folder, "joints.csv", &header[..joints], &left, None);
    table(&folder, "points.csv", &header[joints..], &right, None);
    let run = folder.run(&format!("calibrate {MODEL} joints.csv points.csv --out out --verbose"));
    assert_eq!(run.code, 0, "{}", run.err);
    // With the header line 8 and 24; the 31st row is in line 32.
    assert!(run.err.contains("joints.csv: nothing was measured at lines 8, 24"), "{}", run.err);
    assert!(run.err.contains("joints.csv: more than once was measured at line 32"), "{}", run.err);
    assert!(run.out.contains("39 rows") || run.out.contains("of 39"), "{}", run.out);
    // Equal entries in the file and in the report.
    let file: serde_json::Value = serde_json::from_str(&folder.read("out/calibration.json")).unwrap();
    let join = &file["inputs"]["joins"][0];
    assert_eq!((&join["join"], &join["joint_rows"], &join["measured_rows"]), (&"rows".into(), &40.into(), &39.into()));
    assert_eq!(join["unmeasured"], serde_json::json!([{"number": 7, "line": 8}, {"number": 23, "line": 24}]));
    assert_eq!(join["repeated"], serde_json::json!([{"number": 31, "line": 32}]));
    assert_eq!(join["pairs"][6], serde_json::json!([8, 7]));
    assert_eq!(file["inputs"]["files"][0]["taken"], serde_json::json!({"joint readings": 40}));
    assert_eq!(file["inputs"]["files"][1]["taken"], serde_json::json!({"points": 39}));
    let page = folder.read("out/report.html");
    for words in [
        "How the files were joined",
        "row by row, in their order",
        "lines 8, 24",
        "line 32",
        "without partner",
        "8 to 22",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let hash = file["inputs"]["sha256"]["points.csv"].as_str().unwrap();
    assert!(page.contains(hash) && page.contains("39 points"));
    folder.run_to_success("report out/calibration.json -o again.html");
    assert!(folder.read("again.html") == page);
}

#[test]
fn wrong_orders_are_refused_with_what_fits() {
    let folder = Folder::new();
    let (header, rows, joints) = session(&folder, "point", 30);
    let left: Vec<&[String]> = rows.iter().map(|row| &row[..joints]).collect();
    let right: Vec<&[String]> = rows.iter().map(|row| &row[joints..]).collect();
    table(&folder, "joints.csv", &header[..joints], &left, None);
    let mut later = right.clone();
    later.rotate_left(1);
    table(&folder, "later.csv", &header[joints..], &later, None);
    let turned: Vec<&[String]> = right.iter().rev().copied().collect();
    table(&folder, "turned.csv", &header[joints..], &turned, None);
    let mixed: Vec<&[String]> = (0..30).map(|row| right[row * 7 % 30]).collect();
    table(&folder, "mixed.csv", &header[joints..], &mixed, None);
    table(&folder, "few.csv", &header[joints..], &right[..4], None);
    table(&folder, "four.csv", &header[..joints], &left[..4], None);
    let before = folder.listing();
    for (files, expected) in [
        (
            "joints.csv later.csv",
            "with the measurements one row later, expected no other order to fit better: remove the first row",
        ),
        ("joints.csv turned.csv", "in reverse order, expected no other order to fit better"),
        ("joints.csv mixed.csv", "no less than by chance"),
        ("four.csv few.csv", "found 4 configurations, with which nothing shows whether the rows belong together"),
        ("joints.csv later.csv --join name", "found no name that is in both"),
    ] {
        let run = folder.run(&format!("calibrate {MODEL} {files} --out out --quiet"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{files}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{files}: {}", run.err);
    }
    assert!(folder.listing() == before);
}
