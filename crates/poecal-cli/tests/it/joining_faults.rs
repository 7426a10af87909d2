//! Files of joints and of measurements with single wrong rows, with a poor fit, or of which one is no such file.

use std::fs;

use crate::folder::{Folder, Run};
use crate::joining::{MODEL, session, table};

/// 40 configurations in two files with names, `joints.csv` and `points.csv`, and the cells of the points: name, x, y, z.
fn folder_with_names() -> (Folder, String, Vec<Vec<String>>) {
    let folder = Folder::new();
    let (header, rows, joints) = session(&folder, "point", 40);
    let left: Vec<&[String]> = rows.iter().map(|row| &row[..joints]).collect();
    table(&folder, "joints.csv", &header[..joints], &left, Some(&|row| format!("P{}", row + 1)));
    let header = format!("id,{}", header[joints..].join(","));
    let cells = |(at, row): (usize, &Vec<String>)| [&[format!("P{}", at + 1)], &row[joints..]].concat();
    let rows: Vec<Vec<String>> = rows.iter().enumerate().map(cells).collect();
    write(&folder, "points.csv", &header, &rows);
    (folder, header, rows)
}

fn write(folder: &Folder, name: &str, header: &str, rows: &[Vec<String>]) {
    let text: String = rows.iter().map(|it| it.join(",") + "\n").collect();
    fs::write(folder.path(name), format!("{header}\n{text}")).unwrap();
}

fn import(folder: &Folder, files: &str) -> Run {
    folder.run(&format!("import {MODEL} {files} --out out.csv --force"))
}

/// A change of the cells of rows.
type Fault = dyn Fn(&mut Vec<Vec<String>>);

#[test]
fn single_wrong_pairs_are_named_by_line() {
    let (folder, header, rows) = folder_with_names();
    let run = import(&folder, "joints.csv points.csv");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(!run.err.contains("warning"), "{}", run.err);
    let faults: [(&Fault, &[&str]); 3] = [
        // Another name.
        (
            &|rows| rows[8][0] = "P8".to_owned(),
            &[
                "joints.csv: nothing was measured at line 10",
                "joints.csv: more than once was measured at line 9",
                "points.csv: line 10 fits the joint readings of line 9 far worse",
            ],
        ),
        // A coordinate with another sign.
        (
            &|rows| rows[8][3] = format!("-{}", rows[8][3]).replace("--", ""),
            &["points.csv: line 10 fits the joint readings of line 10 far worse"],
        ),
        (&|rows| rows.push(rows[8].clone()), &["joints.csv: more than once was measured at line 10"]),
    ];
    for (fault, expected) in faults {
        let mut rows = rows.clone();
        fault(&mut rows);
        write(&folder, "points.csv", &header, &rows);
        let run = import(&folder, "joints.csv points.csv");
        assert_eq!(run.code, 0, "{}", run.err);
        for words in expected {
            assert!(run.err.contains(words), "{words}: {}", run.err);
        }
    }
}

#[test]
fn what_hardly_fits_is_refused_unless_a_diagnosis_explains_it() {
    let (folder, header, rows) = folder_with_names();
    // For a robot that differs much from its model, the join is right.
    let text = folder.read("joints.csv");
    let turned = |joint: usize, by: f64, factor: f64| -> String {
        let line = |(at, line): (usize, &str)| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if at > 0 {
                cells[joint] = format!("{}", by + factor * cells[joint].parse::<f64>().unwrap());
            }
            cells.join(",") + "\n"
        };
        text.lines().enumerate().map(line).collect()
    };
    fs::write(folder.path("sign.csv"), turned(5, 0.0, -1.0)).unwrap();
    fs::write(folder.path("zero.csv"), turned(3, 8.0, 1.0)).unwrap();
    for (files, expected) in
        [("sign.csv points.csv", "counting joint5 the other way"), ("zero.csv points.csv", "joint3")]
    {
        let run = import(&folder, files);
        assert_eq!(run.code, 0, "{files}: {}", run.err);
        assert!(run.err.contains("% of its reach: ") && run.err.contains(expected), "{files}: {}", run.err);
    }
    // A column in place of another one is no known mistake.
    let mut lost = rows.clone();
    for (at, row) in lost.iter_mut().enumerate() {
        row[2] = format!("{}", 5 * (at * 7 % 40));
    }
    write(&folder, "lost.csv", &header, &lost);
    let before = folder.listing();
    let run = folder.run(&format!("import {MODEL} joints.csv lost.csv --out new.csv --quiet"));
    assert_eq!((run.code, run.err.lines().count()), (2, 1), "{}", run.err);
    assert!(run.err.contains("found measurements that do not fit the joint readings"), "{}", run.err);
    assert!(folder.listing() == before);
}

#[test]
fn the_file_that_is_neither_is_named() {
    let (folder, _, _) = folder_with_names();
    fs::write(folder.path("empty.csv"), "").unwrap();
    fs::write(folder.path("unit.csv"), "id,x[foo],y,z\nP1,1,2,3\n").unwrap();
    fs::write(folder.path("head.csv"), "id,y[mm],z[mm]\nP1,2,3\n").unwrap();
    fs::create_dir(folder.path("bag")).unwrap();
    fs::write(folder.path("bag/metadata.yaml"), "rosbag2_bagfile_information:\n").unwrap();
    fs::write(folder.path("bag/bag_0.db3"), b"SQLite format 3\0rest").unwrap();
    let before = folder.listing();
    for (files, expected) in [
        ("joints.csv missing.csv", "missing.csv: found no such file"),
        ("missing.csv joints.csv", "missing.csv: found no such file"),
        ("joints.csv empty.csv", "empty.csv: found no line with text"),
        ("points.csv empty.csv", "empty.csv: found no line with text"),
        ("joints.csv unit.csv", "unit.csv:1:4: found the unit `foo` for the position x"),
        ("joints.csv head.csv", "head.csv:1: found no column `x`"),
        ("points.csv head.csv", "head.csv:1: found no column `joint1`"),
        ("joints.csv bag", "bag: found a ROS 2 bag in SQLite (.db3)"),
        ("bag", "bag: found a ROS 2 bag in SQLite (.db3)"),
    ] {
        let run = folder.run(&format!("calibrate {MODEL} {files} --out out --quiet"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{files}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{files}: {}", run.err);
    }
    assert!(folder.listing() == before);
}

#[test]
fn names_that_contradict_the_order_are_said_and_not_dropped() {
    let (folder, header, rows) = folder_with_names();
    let mut shifted = rows.clone();
    for (at, row) in shifted.iter_mut().enumerate() {
        row[0] = format!("P{}", (at + 1) % 40 + 1);
    }
    write(&folder, "shifted.csv", &header, &shifted);
    let run = import(&folder, "joints.csv shifted.csv");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(
        run.err.contains("the order of the rows was taken, and not the names, which are in both: found")
            && run.err.contains("were joined row by row"),
        "{}",
        run.err
    );
    let mut mirrored = rows.clone();
    mirrored.iter_mut().for_each(|row| row[1] = format!("-{}", row[1]).replace("--", ""));
    write(&folder, "mirrored.csv", &header, &mirrored);
    let run = import(&folder, "joints.csv mirrored.csv");
    assert_eq!(run.code, 2, "{}", run.err);
    assert!(run.err.contains("joined by name") && run.err.contains("mirroring the positions"), "{}", run.err);
    assert!(!run.err.contains("a column `id`"), "{}", run.err);
}

#[test]
fn what_no_file_has_measured_is_warned_of_once() {
    let (folder, header, rows) = folder_with_names();
    write(&folder, "first.csv", &header, &rows[..20]);
    write(&folder, "second.csv", &header, &rows[20..39]);
    let run = import(&folder, "joints.csv first.csv second.csv");
    assert_eq!(run.code, 0, "{}", run.err);
    let said: Vec<&str> = run.err.lines().filter(|it| it.contains("nothing was measured")).collect();
    assert_eq!(said, ["warning: joints.csv: nothing was measured at line 41"]);
}

#[test]
fn files_that_have_changed_since_they_were_imported_are_named() {
    let (folder, header, mut rows) = folder_with_names();
    assert_eq!(import(&folder, "joints.csv points.csv").code, 0);
    let again = "import --settings out.map.toml --out again.csv --force";
    let run = folder.run(again);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(!run.err.contains("checksum") && folder.read("again.csv") == folder.read("out.csv"));
    rows.pop();
    write(&folder, "points.csv", &header, &rows);
    let run = folder.run(again);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(
        run.err.contains("points.csv: it is not the file that the settings were made of")
            && !run.err.contains("joints.csv: it is not"),
        "{}",
        run.err
    );
}
