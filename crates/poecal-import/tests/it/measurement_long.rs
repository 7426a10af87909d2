//! A measurement file of many rows.

use poecal_import::{ColumnMap, ReadOptions, parse};
use poecal_model::simulate::elbow;

/// Enough rows for several pieces of a file.
const LINES: usize = 20_000;

/// A file in which targets, sets and readings beyond the limits come late, and the expected row of each line.
fn lines() -> Vec<String> {
    let row = |line: usize| {
        let target = if line < LINES / 2 { "a" } else { ["b", "c", "a"][line % 3] };
        let set = if line.is_multiple_of(10) { "held_out" } else { "fit" };
        let angle =
            |joint: usize| ((line * (joint + 3)) % 5000) as f64 / 1000.0 - if line > 15_000 { 4.0 } else { 2.5 };
        let joints: Vec<String> = (0..6).map(|joint| angle(joint).to_string()).collect();
        format!("row {line},{set},{target},{},0.3,{},0.5", joints.join(","), line as f64 / 7.0 / LINES as f64)
    };
    let header = "id,set,target,joint1,joint2,joint3,joint4,joint5,joint6,x,y,z".to_owned();
    std::iter::once(header).chain((2..LINES).map(row)).collect()
}

#[test]
fn a_long_file_is_read_row_by_row_and_its_first_mistake_named() {
    let robot = elbow();
    let read = |lines: &[String]| parse(&lines.join("\n"), "rows.csv", &robot, &ReadOptions::default());
    let mut lines = lines();
    let one = read(&lines).unwrap();
    println!("{} rows, {:?}", one.data.len(), one.warnings);
    assert_eq!(one.data.targets, ["a", "c", "b"].map(|name| Some(name.to_owned())));
    for (row, line) in lines.iter().skip(1).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let seen = one.data.observations[row];
        assert_eq!((one.data.ids[row].as_str(), seen.source.line as usize), (cells[0], row + 2));
        assert_eq!(one.data.targets[seen.target].as_deref(), Some(cells[2]));
        let position = seen.measurement.pose().translation;
        let written: Vec<f64> = cells[3..].iter().map(|cell| cell.parse().unwrap()).collect();
        assert!(position.iter().eq(&written[6..]));
        for (reading, written) in one.data.readings(row).iter().zip(&written) {
            // Some have a whole turn more than their joint's limits.
            let turns = (reading - written) / std::f64::consts::TAU;
            assert!((turns - turns.round()).abs() < 1e-15);
        }
    }
    // Among several mistakes, the first one in the file is reported.
    for (line, bad, message) in [
        (
            19_000,
            "row,fit,a,0,0,0,0,0,0,1,2",
            "rows.csv:19000:26: found 11 cells, expected 12 as in the header (line 1); add the missing cells (they may be empty), or put `#` in front of a line that is no row",
        ),
        (
            18_990,
            "row,fit,a,0,0,0,0,0,0,1,nan,3",
            "rows.csv:18990:25: found `nan` in column `y`, expected a finite number: leave the cell empty where nothing was measured",
        ),
        (
            18_000,
            "row,fit,,0,0,0,0,0,0,1,2,3",
            "rows.csv:18000:9: found no target name, expected one as in rows.csv:2; all rows \
          name their target or none does",
        ),
        (
            9_000,
            "row,judge,a,0,0,0,0,0,0,1,2,3",
            "rows.csv:9000:5: found `judge` in column `set`, expected `fit` or `held_out`",
        ),
    ] {
        lines[line - 1] = bad.to_owned();
        assert_eq!(read(&lines).unwrap_err().to_string(), message);
    }
}

/// Nearly the largest number of columns of a file: code that looks at all of them for each takes seconds.
const COLUMNS: usize = 16_000;

fn with_columns(own: &str) -> String {
    let names: Vec<String> = (0..COLUMNS).map(|column| format!("c{column}")).collect();
    let numbers = vec!["1"; COLUMNS + own.split(',').count()];
    format!("{},{own}\n{}\n", names.join(","), numbers.join(","))
}

#[test]
fn very_many_columns_take_no_longer_each() {
    let joints = "joint1,joint2,joint3,joint4,joint5,joint6";
    let read = |text: &str| parse(text, "wide.csv", &elbow(), &ReadOptions::default());
    let wide = read(&with_columns(&format!("{joints},x,y,z"))).unwrap();
    assert_eq!((wide.data.len(), wide.understood[0].ignored.len()), (1, COLUMNS));
    assert_eq!(wide.warnings.len(), 1);
    assert!(wide.warnings[0].ends_with("`c28`, `c29` and 15970 more"), "{}", wide.warnings[0]);
    let error = read(&with_columns("x,y,z")).unwrap_err().to_string();
    assert!(error.starts_with("wide.csv:1: found no column `joint1`, expected one for joint `joint1`;"), "{error}");
    assert!(error.len() < 300, "{error}");
    let error = read(&with_columns(&format!("{joints},x,y,z,z"))).unwrap_err().to_string();
    assert_eq!(error, "wide.csv:1:100939: found a second column `z`, expected one; rename or remove one of them");
}

#[test]
fn very_many_targets_in_a_row_take_no_longer_each() {
    const TARGETS: usize = 5_000;
    let (mut map, mut names) = (String::new(), Vec::new());
    for target in 0..TARGETS {
        let columns: Vec<String> = ["x", "y", "z"].iter().map(|axis| format!("{axis}{target}")).collect();
        map += &format!(
            "[[targets]]\nname = \"T{target}\"\nposition = {{ columns = [\"{}\"] }}\n",
            columns.join("\", \"")
        );
        names.extend(columns);
    }
    let mapping = Some(ColumnMap::parse(&map, "map.toml").unwrap());
    let text = format!(
        "joint1,joint2,joint3,joint4,joint5,joint6,{}\n{}\n",
        names.join(","),
        vec!["0.5"; 6 + 3 * TARGETS].join(",")
    );
    let options = ReadOptions { mapping, ..ReadOptions::default() };
    let read = parse(&text, "wide.csv", &elbow(), &options).unwrap();
    assert_eq!((read.data.len(), read.data.targets.len()), (TARGETS, TARGETS));
}
