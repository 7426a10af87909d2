//! Typical mistakes in files: markers with exchanged names, two sets of coordinates, units of one file, mirrored points, shifted headers.

use std::fmt::Write as _;
use std::fs;

use crate::folder::Folder;
use crate::recorded::{MODEL, Row, held_out, interpolate_rows, interpolate_turn, join_numbers, session, stream};

/// The positions of four markers on the tool, metres in the tool's frame.
const MARKERS: [[f64; 3]; 4] = [[0.06, 0.0, 0.01], [-0.04, 0.05, 0.0], [-0.02, -0.07, 0.03], [0.01, 0.02, 0.09]];

/// A point of a frame with a quaternion x, y, z, w, mm.
fn place_point(place: &[f64], [x, y, z, w]: [f64; 4], [a, b, c]: [f64; 3]) -> [f64; 3] {
    let m = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    std::array::from_fn(|k| place[k] + 1e3 * (m[k][0] * a + m[k][1] * b + m[k][2] * c))
}

/// A log of the robot, and takes of Motive with four markers and one without a label: unchanged, and with names exchanged in some frames and lost in
/// others.
fn takes(rows: &[Row]) -> (String, String, String) {
    let next = |row: usize| (row + 1).min(rows.len() - 1);
    let mut log = "timestamp,actual_q_0,actual_q_1,actual_q_2,actual_q_3,actual_q_4,actual_q_5\n".to_owned();
    for (time, row, share) in stream(rows.len(), 50) {
        let radians: Vec<f64> =
            interpolate_rows(&rows[row].0, &rows[next(row)].0, share).iter().map(|it| it.to_radians()).collect();
        writeln!(log, "{:.6},{}", 100.0 + time, join_numbers(&radians, 9, ",")).unwrap();
    }
    let mut take =
        "Format Version,1.24,Take Name,A,Export Frame Rate,50.0,Rotation Type,Quaternion,Length Units,Millimeters\n\n"
            .to_owned();
    let mut head = |label: &str, of: &dyn Fn(usize) -> String| {
        take += &format!("{label}{}\n", (0..15).map(of).collect::<Vec<_>>().join(","));
    };
    head(",Type,", &|_| "Marker".to_owned());
    head(",Name,", &|k| ["A", "B", "C", "D", "Unlabeled 1201"][k / 3].to_owned());
    head(",ID,", &|k| format!("\"{}\"", k / 3));
    head(",,", &|_| "Position".to_owned());
    head("Frame,Time (Seconds),", &|k| ["X", "Y", "Z"][k % 3].to_owned());
    let mut damaged = take.clone();
    for (frame, (time, row, share)) in stream(rows.len(), 50).into_iter().enumerate() {
        let place = interpolate_rows(&rows[row].1, &rows[next(row)].1, share);
        let turn = interpolate_turn(rows[row].2, rows[next(row)].2, share);
        let mut cells: Vec<String> =
            MARKERS.iter().map(|it| join_numbers(&place_point(&place, turn, *it), 4, ",")).collect();
        cells.push(",,".to_owned());
        writeln!(take, "{frame},{time:.6},{}", cells.join(",")).unwrap();
        if (400..700).contains(&frame) {
            cells.swap(0, 1);
        }
        if (900..1000).contains(&frame) {
            cells.swap(3, 4);
        }
        writeln!(damaged, "{frame},{time:.6},{}", cells.join(",")).unwrap();
    }
    (log, take, damaged)
}

#[test]
fn exchanged_markers_are_put_back_and_lost_names_found() {
    let folder = Folder::new();
    let rows = session(&folder, 26);
    let (log, take, damaged) = takes(&rows);
    for (name, text) in [("robot_data.csv", &log), ("take.csv", &take), ("damaged.csv", &damaged)] {
        fs::write(folder.path(name), text).unwrap();
    }
    let (expected, said) = held_out(&folder, "robot_data.csv take.csv");
    assert!(!said.contains("exchanged the names"), "{said}");
    let (found, said) = held_out(&folder, "robot_data.csv damaged.csv");
    println!("{found:.6} mm with exchanged names, {expected:.6} mm without");
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}\n{said}");
    // The first frame is in line 8.
    assert!(said.contains("damaged.csv: exchanged the names of `A`, `B` in 300 frames (lines 408, 409,"), "{said}");
    assert!(said.contains("found 100 places of its markers among those without a name"), "{said}");
    // Without any names: the markers that are present from the beginning on form the body.
    let nameless = ["A", "B", "C", "D"].iter().enumerate().fold(damaged, |text, (at, name)| {
        text.replacen(&format!("{name},{name},{name}"), &[format!("Unlabeled {}", 1100 + at).as_str(); 3].join(","), 1)
    });
    fs::write(folder.path("nameless.csv"), nameless).unwrap();
    let (found, said) = held_out(&folder, "robot_data.csv nameless.csv");
    println!("{found:.6} mm without names");
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}\n{said}");
}

/// Writes joints and points of rows with one more column at the beginning or at the end of each.
fn table(folder: &Folder, name: &str, header: &str, rows: &[Row], of: &dyn Fn(usize, &Row) -> String) {
    let text: String = rows.iter().enumerate().map(|(k, row)| of(k, row) + "\n").collect();
    fs::write(folder.path(name), format!("{header}\n{text}")).unwrap();
}

#[test]
fn shifted_headers_other_units_and_mirrors_are_named() {
    let folder = Folder::new();
    let rows = session(&folder, 36);
    let names = "joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]";
    let axes = "x[mm],y[mm],z[mm]";
    let (joints, place) = (|row: &Row| join_numbers(&row.0, 6, ","), |row: &Row| join_numbers(&row.1, 4, ","));
    let write = |name: &str, header: &str, of: &dyn Fn(usize, &Row) -> String| table(&folder, name, header, &rows, of);
    write("joints.csv", names, &|_, row| joints(row));
    write("points.csv", axes, &|_, row| place(row));
    // One name too few and one too many, which the numbers of cells show.
    write("few.csv", names, &|k, row| format!("{},{}", k + 1, joints(row)));
    write("many.csv", &format!("number,{names}"), &|_, row| joints(row));
    // As many names as cells, each beside its values.
    write("right.csv", &format!("{names},note"), &|k, row| format!("{k},{}", joints(row)));
    write("left.csv", &format!("# made by hand\nn,{names}"), &|_, row| format!("{},0", joints(row)));
    write("shifted_points.csv", &format!("{axes},note"), &|k, row| format!("{k},{}", place(row)));
    write("whole.csv", &format!("{names},{axes},note"), &|k, row| format!("{k},{},{}", joints(row), place(row)));
    write("mirrored.csv", axes, &|_, row| join_numbers(&[row.1[0], -row.1[1], row.1[2]], 4, ","));
    let first = |of: &dyn Fn(usize, &Row) -> String, name: &str, some: &[Row]| {
        table(&folder, name, &format!("{names},{axes}"), some, of);
    };
    first(&|_, row| format!("{},{}", joints(row), place(row)), "first.csv", &rows[..18]);
    for (name, factor) in [("cm.csv", 0.1), ("inches.csv", 1.0 / 25.4), ("metres.csv", 1e-3)] {
        let of =
            |_: usize, row: &Row| format!("{},{}", joints(row), join_numbers(&row.1.map(|it| it * factor), 7, ","));
        first(&of, name, &rows[18..]);
    }
    let before = folder.listing();
    for (files, expected) in [
        (
            "few.csv points.csv",
            "found 7 cells, expected 6 as in the header (line 1); all rows have one more: the header has one name too few",
        ),
        ("many.csv points.csv", "many.csv:2:"),
        (
            "many.csv points.csv",
            "the header has one name too many, take out that of the column that the rows do not have",
        ),
        ("right.csv points.csv", "right.csv:1: found the values of each name one column further to the right"),
        ("right.csv points.csv", "the header has one name too few at its beginning"),
        ("left.csv points.csv", "left.csv:2: found the values of each name one column further to the left"),
        ("whole.csv", "whole.csv:1: found the values of each name one column further to the right"),
        // Two of three coordinates may fit evidently; the nominal robot's errors exceed every single error.
        (
            "joints.csv shifted_points.csv",
            "shifted_points.csv:1: found the values of each name one column further to the right",
        ),
        ("joints.csv mirrored.csv", "mirroring the positions"),
        ("first.csv metres.csv", "most likely they are in m, not mm"),
        ("first.csv cm.csv", "most likely they are in cm, not mm"),
        ("first.csv inches.csv", "most likely they are in inches, not mm"),
    ] {
        let run = folder.run(&format!("calibrate {MODEL} {files} --out out --quiet"));
        println!("{files}: {}", run.err.trim());
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{files}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{files}: {}", run.err);
    }
    assert!(folder.listing() == before);
    // Correct files are read as before.
    write("right_whole.csv", &format!("note,{names},{axes},rest"), &|k, row| {
        format!("{}.5,{},{},1.25", k, joints(row), place(row))
    });
    let run = folder.run(&format!("calibrate {MODEL} right_whole.csv --out right"));
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
}

#[test]
fn of_two_sets_of_coordinates_the_measured_one_is_taken() {
    let folder = Folder::new();
    let rows = session(&folder, 30);
    let names = "joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]";
    table(&folder, "joints.csv", &format!("id,{names}"), &rows, &|k, row| {
        format!("P{},{}", k + 1, join_numbers(&row.0, 9, ","))
    });
    table(&folder, "points.csv", "id,x[mm],y[mm],z[mm]", &rows, &|k, row| {
        format!("P{},{}", k + 1, join_numbers(&row.1, 4, ","))
    });
    folder.run_to_success(&format!("predict {MODEL} joints.csv --out nominal.csv"));
    let text = folder.read("nominal.csv");
    let mut lines = text.lines().filter(|it| !it.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let nominal: Vec<[f64; 3]> = lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            ["x", "y", "z"].map(|axis| {
                let at = header.iter().position(|it| it.split('[').next() == Some(axis)).unwrap();
                let factor = if header[at].contains("[mm]") { 1.0 } else { 1e3 };
                cells[at].parse::<f64>().unwrap() * factor
            })
        })
        .collect();
    let (expected, _) = held_out(&folder, "joints.csv points.csv");
    let angles = "0.1,0.2,0.3";
    let set = |of: &[f64; 3]| format!("{},{angles}", join_numbers(of, 4, ","));
    let columns = |before: &str| {
        let name = |it: &str| {
            if "xyz".contains(it) { format!("{before}{it}[mm]") } else { format!("{before}{it}[deg]") }
        };
        ["x", "y", "z", "a", "b", "c"].map(name).join(",")
    };
    let (named, bare) =
        (format!("id,{},{}", columns("Nominal "), columns("Measured ")), format!("id,{},{}", columns(""), columns("")));
    for (file, header, is_first, words) in [
        ("named.csv", &named, false, "took the measured of two sets of coordinates"),
        ("second.csv", &bare, false, "took the second of two sets of coordinates"),
        ("first.csv", &bare, true, "took the first of two sets of coordinates"),
    ] {
        table(&folder, file, header, &rows, &|k, row| {
            let (one, other) = (set(&nominal[k]), set(&row.1));
            format!("P{},{}", k + 1, if is_first { format!("{other},{one}") } else { format!("{one},{other}") })
        });
        let (found, said) = held_out(&folder, &format!("joints.csv {file}"));
        println!("{file}: {found:.6} mm, {expected:.6} mm of the measured points alone");
        assert!((found / expected - 1.0).abs() < 1e-9, "{file}: {said}");
        assert!(said.contains(words) && said.contains("by 0.000 mm (median)"), "{file}: {said}");
    }
    // In one file with the joints.
    table(&folder, "whole.csv", &format!("{named},{names}"), &rows, &|k, row| {
        format!("P{},{},{},{}", k + 1, set(&nominal[k]), set(&row.1), join_numbers(&row.0, 9, ","))
    });
    let (found, said) = held_out(&folder, "whole.csv");
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}: {said}");
    // Two measured sets, and none that fits.
    table(&folder, "both.csv", &bare, &rows, &|k, row| {
        format!("P{},{},{}", k + 1, set(&row.1), set(&row.1.map(|it| it + 0.2)))
    });
    table(&folder, "none.csv", &named, &rows, &|k, row| {
        format!("P{},{},{}", k + 1, set(&nominal[k]), set(&rows[(7 * k + 3) % 30].1.map(|it| it + 0.01 * row.1[0])))
    });
    for (file, words) in [
        (
            "both.csv",
            [
                "found two sets of coordinates in a row, of which the nominal robot misses the first by",
                "and the second by",
            ],
        ),
        ("none.csv", ["misses the nominal by 0.000 mm (median)", "the measured by no less than by chance"]),
    ] {
        let run = folder.run(&format!("calibrate {MODEL} joints.csv {file} --out out --quiet --force"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{file}: {}", run.err);
        assert!(words.iter().all(|it| run.err.contains(it)), "{file}: {}", run.err);
    }
}

/// Statements of a model about its joints that are not read are named by each command that reads it, once; a scale or a shift is refused.
#[test]
fn what_a_model_states_beyond_what_is_read_is_named() {
    let folder = Folder::new();
    let model = include_str!("../../../../examples/elbow/robot.urdf");
    folder.write("robot.urdf", model.replace("<joint name=", "<joint colour=\"red\" name="));
    for words in ["check robot.urdf", "export robot.urdf --out robot.toml", "simulate robot.urdf --out sim"] {
        let run = folder.run(words);
        let said = format!("{}{}", run.out, run.err);
        assert_eq!((run.code, said.matches("did not read `colour`").count()), (0, 1), "{words}: {said}");
    }
    folder.write("robot.urdf", model.replacen("<origin ", "<origin scale=\"0.001\" ", 1));
    let run = folder.run("check robot.urdf");
    assert!(run.code == 2 && run.err.contains("robot.urdf:15: found `0.001` for `origin.scale`"), "{}", run.err);
}
