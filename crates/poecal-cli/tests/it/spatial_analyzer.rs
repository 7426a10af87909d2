//! Exports of SpatialAnalyzer that are damaged, or hold more than one table.

use std::fs;

use crate::folder::Folder;
use crate::recorded::{MODEL, join_numbers, session};

const HEAD: &str = "// SpatialAnalyzer SA 2024.2\n// Points Relative to Coordinate Frame 'A::WORLD'\n// AXES = CARTESIAN: X,  Y,  Z (mm)\n";

/// 40 configurations with names in `joints.csv`, and the lines of their points.
fn points() -> (Folder, Vec<String>) {
    let folder = Folder::new();
    let rows = session(&folder, 40);
    let mut text = "id,joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]\n".to_owned();
    let mut lines = Vec::new();
    for (k, (joints, place, _)) in rows.iter().enumerate() {
        text += &format!("P{},{}\n", k + 1, join_numbers(joints, 6, ","));
        lines.push(format!("Robot,  P{},  0,  {},  02/12/25 16:{k:02}:00", k + 1, join_numbers(place, 6, ",  ")));
    }
    fs::write(folder.path("joints.csv"), text).unwrap();
    (folder, lines)
}

#[test]
fn a_point_that_was_measured_twice_keeps_the_names_of_rows() {
    let (folder, mut lines) = points();
    lines.push(lines[7].clone());
    fs::write(folder.path("points.txt"), format!("{HEAD}{}\n", lines.join("\n"))).unwrap();
    // The same without names of columns.
    let plain: Vec<String> = lines
        .iter()
        .map(|it| it.split(",  ").enumerate().filter(|it| matches!(it.0, 1 | 3..=5)).map(|it| it.1).collect())
        .map(|it: Vec<&str>| it.join(","))
        .collect();
    fs::write(folder.path("plain.txt"), plain.join("\n")).unwrap();
    for (file, first) in [("points.txt", 11), ("plain.txt", 8)] {
        let run = folder.run(&format!("import {MODEL} joints.csv {file} --units mm --out out.csv --force"));
        assert_eq!(run.code, 0, "{file}: {}", run.err);
        for words in [
            "were joined by name: 41 configurations".to_owned(),
            format!("names come again: `P8` in lines {first}, {}", first + 33),
            "joints.csv: more than once was measured at line 9".to_owned(),
        ] {
            assert!(run.err.contains(&words), "{file}: {words}: {}", run.err);
        }
    }
}

#[test]
fn what_is_not_as_the_head_says_is_refused() {
    let (folder, lines) = points();
    let two = |head: &str| format!("{HEAD}{}\n{head}{}\n", lines[..20].join("\n"), lines[20..].join("\n"));
    let whole = format!("{HEAD}{}\n", lines.join("\n"));
    let changed = |of: &dyn Fn(&str) -> String| {
        format!("{HEAD}{}\n", lines.iter().map(|it| of(it)).collect::<Vec<_>>().join("\n"))
    };
    let without = |column: usize| {
        changed(&move |line| {
            let mut cells: Vec<&str> = line.split(",  ").collect();
            cells.remove(column);
            cells.join(",  ")
        })
    };
    let end = whole.trim_end().len() - "4321,  02/12/25 16:39:00".len();
    let cases = [
        (
            "unit.txt",
            two(&HEAD.replace("(mm)", "(inches)")),
            "unit.txt:26: found `CARTESIAN: X,  Y,  Z (inches)` as axes and unit",
        ),
        (
            "frame.txt",
            two(&HEAD.replace("A::", "B::")),
            "frame.txt:25: found `B::WORLD` as the frame of the points below",
        ),
        ("cut.txt", whole[..end].to_owned(), "cut.txt:43: found no time behind the numbers of a point"),
        ("lost.txt", without(4), "lost.txt:4: found whole numbers alone as the first of three coordinates"),
        (
            "nan.txt",
            whole.replacen(lines[4].split(",  ").nth(3).unwrap(), "NaN", 1),
            "nan.txt:8: found `NaN` in place of a number",
        ),
        (
            "semicolons.txt",
            changed(&|line| line.replace(",  ", ";  ")),
            "semicolons.txt:4: found `;` between the cells",
        ),
        (
            "commas.txt",
            changed(&|line| line.replace('.', ",")),
            "commas.txt:4: found 6 whole numbers of a point and no decimal point",
        ),
    ];
    for (name, text, _) in &cases {
        fs::write(folder.path(name), text).unwrap();
    }
    let before = folder.listing();
    for (name, _, expected) in &cases {
        let run = folder.run(&format!("import {MODEL} joints.csv {name} --out out.csv --quiet"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{name}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{name}: {}", run.err);
    }
    assert!(folder.listing() == before);
    // The same head again, as in files that were concatenated.
    fs::write(folder.path("again.txt"), two(HEAD)).unwrap();
    let run = folder.run(&format!("import {MODEL} joints.csv again.txt --out out.csv"));
    assert_eq!(run.code, 0, "{}", run.err);
}
