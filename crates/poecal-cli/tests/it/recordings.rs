//! Recordings with clocks of their own that do not belong together, or are damaged.

use std::fmt::Write as _;
use std::fs;

use crate::folder::Folder;
use crate::recorded::{MODEL, Row, interpolate_rows, interpolate_turn, join_numbers, session, stream};

/// A robot that stops at each row, by its controller and by two systems of motion capture.
pub(crate) struct Recordings {
    /// A log of the controller, radians.
    pub(crate) log: String,
    /// A take of Motive: the body, a static one, and a marker without a label; frames are lost.
    pub(crate) take: String,
    /// The take in the form of Qualisys.
    pub(crate) qualisys: String,
}

pub(crate) fn recordings(rows: &[Row]) -> Recordings {
    let next = |row: usize| (row + 1).min(rows.len() - 1);
    let mut log = "timestamp,actual_q_0,actual_q_1,actual_q_2,actual_q_3,actual_q_4,actual_q_5\n".to_owned();
    for (time, row, share) in stream(rows.len(), 125) {
        let joints = interpolate_rows(&rows[row].0, &rows[next(row)].0, share);
        let radians: Vec<f64> = joints.iter().map(|it| it.to_radians()).collect();
        writeln!(log, "{:.6},{}", 12_621.061 + time, join_numbers(&radians, 9, ",")).unwrap();
    }
    let mut take =
        "Format Version,1.24,Take Name,A,Export Frame Rate,100.0,Rotation Type,Quaternion,Length Units,Millimeters\n\n"
            .to_owned();
    let head = |label: &str, of: &dyn Fn(usize) -> String| {
        format!("{label}{}\n", (0..17).map(of).collect::<Vec<_>>().join(","))
    };
    let name = |k: usize| ["Table", "Tool"][usize::from(k >= 7)].to_owned();
    take += &head(",Type,", &|k| if k < 14 { "Rigid Body".to_owned() } else { "Marker".to_owned() });
    take += &head(",Name,", &|k| if k < 14 { name(k) } else { "Unlabeled 1189".to_owned() });
    take += &head(",ID,", &|k| format!("\"{k}\""));
    take += &head(",,", &|k| if k < 14 && k % 7 < 4 { "Rotation".to_owned() } else { "Position".to_owned() });
    take += &head("Frame,Time (Seconds),", &|k| {
        if k < 14 { ["X", "Y", "Z", "W", "X", "Y", "Z"][k % 7].to_owned() } else { ["X", "Y", "Z"][k - 14].to_owned() }
    });
    let mut qualisys = "NO_OF_FRAMES\t1\nNO_OF_BODIES\t1\nFREQUENCY\t100\nDATA_INCLUDED\t6D\nBODY_NAMES\tTool\nFrame\tTime\tTool X\tY\tZ\tRoll\tPitch\tYaw\tResidual\t".to_owned();
    qualisys += &(0..9).map(|k| format!("Rot[{k}]")).collect::<Vec<_>>().join("\t");
    qualisys += "\t\n";
    for (frame, (time, row, share)) in stream(rows.len(), 100).into_iter().enumerate() {
        let place = interpolate_rows(&rows[row].1, &rows[next(row)].1, share);
        let [x, y, z, w] = interpolate_turn(rows[row].2, rows[next(row)].2, share);
        let is_lost = frame % 50 == 7;
        let (time, drifted) = (time, time * (1.0 + 35e-6));
        let body = if is_lost {
            ",,,,,,".to_owned()
        } else {
            format!("{},{}", join_numbers(&[x, y, z, w], 6, ","), join_numbers(&place, 6, ","))
        };
        writeln!(take, "{frame},{drifted:.6},0,0.2588,0,0.9659,500,100,-700,{body},1,2,3").unwrap();
        let m = [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y + z * w),
            2.0 * (x * z - y * w),
            2.0 * (x * y - z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z + x * w),
            2.0 * (x * z + y * w),
            2.0 * (y * z - x * w),
            1.0 - 2.0 * (x * x + y * y),
        ];
        let angles = [(-m[7]).atan2(m[8]), m[6].clamp(-1.0, 1.0).asin(), (-m[3]).atan2(m[0])].map(f64::to_degrees);
        let zeros = [0.0; 16];
        let cells = [&place[..], &angles, &[0.3], &m].concat();
        let cells = if is_lost { &zeros[..] } else { &cells };
        writeln!(qualisys, "{}\t{time:.5}\t{}\t", frame + 1, join_numbers(cells, 7, "\t")).unwrap();
    }
    Recordings { log, take, qualisys }
}

/// A folder with the log and the take of a session.
fn folder_with_recordings() -> (Folder, Recordings) {
    let folder = Folder::new();
    let rows = session(&folder, 24);
    let all = recordings(&rows);
    fs::write(folder.path("log.csv"), &all.log).unwrap();
    fs::write(folder.path("take.csv"), &all.take).unwrap();
    (folder, all)
}

/// A text with the cells of each line of data changed.
fn change_cells(text: &str, head: usize, of: impl Fn(usize, &mut Vec<String>)) -> String {
    let line = |(at, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if at >= head {
            of(at, &mut cells);
        }
        cells.join(",") + "\n"
    };
    text.lines().enumerate().map(line).collect()
}

/// Refuses these files, each with its words, and writes nothing.
fn assert_refused(folder: &Folder, cases: &[(&str, &str)]) {
    let before = folder.listing();
    for (files, expected) in cases {
        let run = folder.run(&format!("import {MODEL} {files} --out out.csv --quiet"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{files}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{files}: {}", run.err);
        assert!(!run.err.contains("like --lag"), "{files}: {}", run.err);
    }
    assert!(folder.listing() == before);
}

#[test]
fn recordings_that_do_not_belong_together_are_refused_without_a_lag() {
    let (folder, Recordings { log, take, .. }) = folder_with_recordings();
    let exchanged = change_cells(&log, 1, |_, cells| cells.swap(2, 3));
    fs::write(folder.path("exchanged.csv"), exchanged).unwrap();
    let mirrored = change_cells(&take, 7, |_, cells| cells.swap(13, 14));
    fs::write(folder.path("mirrored.csv"), mirrored).unwrap();
    // Another session.
    let other = Folder::new();
    let rows: Vec<Row> = session(&other, 48).split_off(24);
    fs::write(folder.path("other.csv"), recordings(&rows).take).unwrap();
    let cases = [
        ("exchanged.csv take.csv", "exchanging the readings of joint2 and joint3"),
        ("log.csv mirrored.csv", "mirroring the positions"),
        ("log.csv other.csv", "at no lag of the clocks"),
        ("log.csv other.csv --lag -12621s+-0.5s", "the nominal robot misses"),
    ];
    assert_refused(&folder, &cases);
    for files in ["exchanged.csv take.csv", "log.csv other.csv"] {
        let run = folder.run(&format!("calibrate {MODEL} {files} --join motion --out out --quiet"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{files}: {}", run.err);
        assert!(run.err.contains("at no lag of the clocks") && !run.err.contains("like --lag"), "{}", run.err);
    }
}

#[test]
fn a_log_without_usable_times_is_refused_at_once_and_says_why() {
    let (folder, Recordings { log, take, .. }) = folder_with_recordings();
    // In milliseconds, without times, and a recording that was concatenated in the wrong order.
    let milliseconds = change_cells(&log, 1, |_, cells| {
        let time: f64 = cells[0].parse().unwrap();
        cells[0] = format!("{:.0}", 1e3 * time);
    });
    fs::write(folder.path("ms.csv"), &milliseconds).unwrap();
    fs::write(folder.path("ms_stated.csv"), milliseconds.replacen("timestamp", "time[ms]", 1)).unwrap();
    let without: String = log.lines().map(|it| it.split_once(',').unwrap().1.to_owned() + "\n").collect();
    fs::write(folder.path("no_time.csv"), without).unwrap();
    let mut lines: Vec<&str> = take.lines().collect();
    lines[7..].reverse();
    fs::write(folder.path("reversed.csv"), lines.join("\n")).unwrap();
    let cases = [
        ("ms.csv take.csv", "times 8 s apart (if they are ms, write `time[ms]` in the header)"),
        ("no_time.csv take.csv", "with no column of times, expected the time of each row in seconds"),
        ("log.csv reversed.csv", "reversed.csv:9: found a time that goes back, from "),
    ];
    let begun = std::time::Instant::now();
    assert_refused(&folder, &cases);
    assert!(begun.elapsed().as_secs() < 10, "{:?}", begun.elapsed());
    // The column that the sentence advises.
    let run = folder.run(&format!("import {MODEL} ms_stated.csv take.csv --out out.csv"));
    assert_eq!(run.code, 0, "{}", run.err);
}

#[test]
fn a_frame_that_strayed_is_named_and_changes_no_stand() {
    let (folder, Recordings { take, .. }) = folder_with_recordings();
    let table = |name: &str, files: &str| {
        let run = folder.run(&format!("import {MODEL} {files} --out {name}"));
        assert_eq!(run.code, 0, "{files}: {}", run.err);
        (folder.read(name), run.err)
    };
    let (expected, said) = table("whole.csv", "log.csv take.csv");
    assert!(!said.contains("of the same stand"), "{said}");
    let strayed = change_cells(&take, 7, |at, cells| {
        if at == 40 {
            cells.swap(13, 14);
        }
    });
    fs::write(folder.path("strayed.csv"), strayed).unwrap();
    let (found, said) = table("found.csv", "log.csv strayed.csv");
    assert!(said.contains("strayed.csv: left out 1 row up to"), "{said}");
    let numbers = |text: &str| -> Vec<f64> { text.split([',', '\n']).filter_map(|it| it.parse().ok()).collect() };
    let (one, other) = (numbers(&expected), numbers(&found));
    let apart = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("{apart:.6} mm");
    assert!(one.len() == other.len() && apart < 0.02, "{apart}");
}

#[test]
fn words_and_cut_rows_are_no_lost_frames() {
    let (folder, Recordings { take, qualisys, .. }) = folder_with_recordings();
    let write = |name: &str, text: String| fs::write(folder.path(name), text).unwrap();
    let word = |word: &'static str| {
        move |at: usize, cells: &mut Vec<String>| {
            if at == 60 {
                cells[13] = word.to_owned();
            }
        }
    };
    write("word.csv", change_cells(&take, 7, word("abc")));
    write("nan.csv", change_cells(&take, 7, word("NaN")));
    let short = |at: usize, cells: &mut Vec<String>| {
        if at == 60 {
            cells.remove(10);
        }
    };
    write("short.csv", change_cells(&take, 7, short));
    write("trailing.csv", change_cells(&take, 7, |_, cells| cells.truncate(16)));
    write("empty.csv", take.lines().take(7).map(|it| it.to_owned() + "\n").collect());
    write("semicolons.csv", take.replace(',', ";"));
    write("metres.csv", take.replacen("Millimeters", "Meters", 1));
    let six = qualisys.lines().enumerate().map(|(at, line)| {
        let mut cells: Vec<&str> = line.split('\t').collect();
        if at == 60 {
            cells[3] = "abc";
        }
        cells.join("\t") + "\n"
    });
    write("six.tsv", six.collect());
    let cases = [
        ("log.csv word.csv", "word.csv:61: found `abc` in a column of `Tool`, expected a number"),
        ("log.csv nan.csv", "nan.csv:61: found `NaN` in a column of `Tool`, expected a number"),
        ("log.csv short.csv", "short.csv:61: found 18 cells, expected 19 as in the head"),
        ("log.csv empty.csv", "empty.csv:7: found the names of columns and no frame"),
        ("log.csv semicolons.csv", "semicolons.csv:1: found `;` between the cells of a take of Motive"),
        ("log.csv metres.csv", "expected another unit, most likely mm"),
        ("log.csv six.tsv", "six.tsv:61: found `abc` in a column of `Tool`, expected a number"),
    ];
    assert_refused(&folder, &cases);
    let run = folder.run(&format!("import {MODEL} log.csv trailing.csv --out out.csv"));
    assert_eq!(run.code, 0, "{}", run.err);
}

#[test]
fn a_table_of_rows_at_rest_is_refused_before_files_are_joined_in_motion() {
    let (folder, _) = folder_with_recordings();
    assert_refused(&folder, &[("log.csv take.csv --join motion", "found --join motion, expected rows at rest")]);
    let text = "time[ms],joint1\n";
    fs::write(folder.path("broken.csv"), text).unwrap();
    assert_refused(&folder, &[("broken.csv take.csv --join motion", "found --join motion, expected rows at rest")]);
}

#[test]
fn a_recording_in_motion_is_of_one_instrument() {
    let (folder, Recordings { take, .. }) = folder_with_recordings();
    let mut text = "time,x[mm],y[mm],z[mm],instrument\n".to_owned();
    for (at, line) in take.lines().skip(7).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        if !cells[13].is_empty() {
            let name = if at < 1000 { "north" } else { "south" };
            writeln!(text, "{},{},{name}", cells[1], cells[13..16].join(",")).unwrap();
        }
    }
    fs::write(folder.path("two.csv"), &text).unwrap();
    let run = folder.run(&format!("calibrate {MODEL} log.csv two.csv --join motion --out out --quiet"));
    assert_eq!((run.code, run.err.lines().count()), (2, 1), "{}", run.err);
    assert!(run.err.contains("found the instruments north, south in one recording"), "{}", run.err);
}
