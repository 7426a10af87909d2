//! Controllers whose counts differ from the model's readings: the statement of a mapping holds in every later command.

use std::fmt::Write as _;

use poecal_model::simulate::SessionKind;
use poecal_results::model::Model;

use crate::folder::Folder;
use crate::session::{numbers, session};

const MAP: &str = "[units]\nangle = \"deg\"\n[joints]\njoint1 = { columns = { A1 = -1 }, offset = 5 }\njoint2 = \"A2\"\n\
    joint3 = { columns = { A2 = 1, A3 = 1 } }\njoint4 = \"A4\"\njoint5 = { columns = { A5 = 0.5 } }\njoint6 = \"A6\"\n";
const LEVEL: &str = "third_axis = \"level\"\n[units]\nangle = \"deg\"\n";

/// Counts of the controller of [`MAP`] at joint values, degrees.
fn count_values(q: &[f64]) -> Vec<f64> {
    vec![5.0 - q[0], q[1], q[2] - q[1], q[3], 2.0 * q[4], q[5]]
}

/// The joint values at these counts.
fn uncount_values(c: &[f64]) -> Vec<f64> {
    vec![5.0 - c[0], c[1], c[1] + c[2], c[3], 0.5 * c[4], c[5]]
}

/// Counts of a controller whose third axis counts from the level: axes 2 and 3 of this robot turn in the opposite sense.
fn from_level(q: &[f64]) -> Vec<f64> {
    let mut c = q.to_vec();
    c[2] -= q[1];
    c
}

fn line(numbers: &[f64]) -> String {
    numbers.iter().map(|it| format!("{it:.12}")).collect::<Vec<_>>().join(",")
}

/// A folder with one session twice, as the model reads it and as the controller counts, and both calibrated.
fn folder_with_both(map: &str, count: impl Fn(&[f64]) -> Vec<f64>) -> Folder {
    let folder = session(SessionKind::POSE);
    let plain = folder.read("measurements.csv");
    let mut rows = plain.lines();
    let mut text = rows.next().unwrap().replace("joint", "A");
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let q: Vec<f64> = cells[3..9].iter().map(|it| it.parse::<f64>().unwrap().to_degrees()).collect();
        write!(text, "\n{},{},{}", cells[..3].join(","), line(&count(&q)), cells[9..].join(",")).unwrap();
    }
    folder.write("controller.csv", text);
    folder.write("map.toml", map);
    folder.run_to_success("calibrate robot.urdf measurements.csv --out plain");
    folder.run_to_success("calibrate robot.urdf controller.csv --columns map.toml --out results");
    folder
}

/// Joint values of programs, degrees: none is near a singularity.
fn targets() -> Vec<Vec<f64>> {
    let at = |k: usize, j: usize| ((k * 7 + j * 13) % 17) as f64 * 3.0 - 24.0;
    (0..10).map(|k| (0..6).map(|j| at(k, j) + if j == 4 { 50.0 } else { 0.0 }).collect()).collect()
}

fn largest_difference(found: &[Vec<f64>], wanted: &[Vec<f64>]) -> f64 {
    assert_eq!(found.len(), wanted.len());
    let apart = found.iter().zip(wanted).flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
    apart.fold(0.0, f64::max)
}

/// Degrees by which commands of two calibrations of one session may differ, since the readings are rounded differently.
const ROUNDING_DEG: f64 = 1e-6;

#[test]
fn tables_are_read_and_written_as_the_controller_counts() {
    let folder = folder_with_both(MAP, count_values);
    let q = targets();
    let table = |names: &str, rows: &[Vec<f64>]| {
        format!("{names}\n{}\n", rows.iter().map(|it| line(it)).collect::<Vec<_>>().join("\n"))
    };
    folder.write("plain.csv", table("joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]", &q));
    folder.write("counted.csv", table("A1,A2,A3,A4,A5,A6", &q.iter().map(|it| count_values(it)).collect::<Vec<_>>()));
    let meant = numbers(&folder.run_to_success("predict plain/calibration.json plain.csv"), 0);
    let found = numbers(&folder.run_to_success("predict results/calibration.json counted.csv"), 0);
    println!("predictions differ by up to {:.1e}", largest_difference(&found, &meant));
    assert!(largest_difference(&found, &meant) < 1e-9);
    let plain =
        numbers(&folder.run_to_success("compensate --max-correction 20deg plain/calibration.json plain.csv"), 0);
    let made = folder.run_to_success("compensate --max-correction 20deg results/calibration.json counted.csv");
    assert!(made.starts_with("A1,A2,A3,A4,A5,A6\n"), "{made}");
    let back: Vec<Vec<f64>> = numbers(&made, 0).iter().map(|it| uncount_values(it)).collect();
    println!("commands differ by up to {:.1e} deg", largest_difference(&back, &plain));
    assert!(largest_difference(&back, &plain) < ROUNDING_DEG && largest_difference(&back, &q) > 1e-3);
    // Judged by the same rows without a statement about their columns.
    let judged = folder.run_to_success("validate results/calibration.json controller.csv --json");
    let wanted = folder.run_to_success("validate plain/calibration.json measurements.csv --json");
    let rms = |text: &str| {
        let found: serde_json::Value = serde_json::from_str(text).unwrap();
        found["calibrated"]["position_mm"]["rms"].as_f64().unwrap_or_else(|| panic!("{found:#}"))
    };
    assert!((rms(&judged) - rms(&wanted)).abs() < 1e-6, "{judged}\n{wanted}");
    // A table of the model's own readings is recognised as such, and a note states that.
    let run = folder.run("predict results/calibration.json plain.csv");
    assert!(
        largest_difference(&numbers(&run.out, 0), &meant) < 1e-9 && run.err.contains("joint3 = A2 + A3"),
        "{}",
        run.err
    );
}

#[test]
fn joint_targets_are_as_the_controller_counts_and_poses_as_they_were() {
    for (map, count, back, languages) in [
        (
            MAP,
            count_values as fn(&[f64]) -> Vec<f64>,
            uncount_values as fn(&[f64]) -> Vec<f64>,
            &["src", "script", "ls"][..],
        ),
        (LEVEL, from_level, |c: &[f64]| vec![c[0], c[1], c[2] + c[1], c[3], c[4], c[5]], &["ls"]),
    ] {
        let folder = folder_with_both(map, count);
        for language in languages {
            let written = |name: &str, rows: &[Vec<f64>]| folder.write(name, program(language, rows));
            let q = targets();
            written(&format!("plain.{language}"), &q);
            written(&format!("counted.{language}"), &q.iter().map(|it| count(it)).collect::<Vec<_>>());
            let run = |from: &str, name: &str| {
                folder.run_to_success(&format!(
                    "compensate --max-correction 20deg {from}/calibration.json {name}.{language} --check --out {name}.out.{language}"
                ));
                joints(language, &folder.read(&format!("{name}.out.{language}")))
            };
            let (plain, found) = (run("plain", "plain"), run("results", "counted"));
            let found: Vec<Vec<f64>> = found.iter().map(|it| back(it)).collect();
            let apart = largest_difference(&found, &plain);
            println!("{language}: commands differ by up to {apart:.1e} deg");
            // Nine decimals of a radian, six of a degree.
            assert!(plain.len() == 10 && apart < 3e-6 && largest_difference(&found, &q) > 1e-3, "{language}: {apart}");
        }
    }
}

#[test]
fn poses_are_corrected_in_the_configuration_to_which_the_joints_before_lead() {
    let folder = folder_with_both(MAP, count_values);
    let robot = Model::read(folder.path("robot.urdf"), &Default::default()).unwrap().robot;
    let radians = |q: &[f64]| q.iter().map(|it| it.to_radians()).collect::<Vec<f64>>();
    let from = targets().remove(1);
    let to = robot.forward_kinematics(&radians(&from.iter().map(|it| it + 2.0).collect::<Vec<f64>>()));
    let turn = poecal_arm::lie::rotation::log(&to.rotation);
    let pose = line(&[to.translation.x, to.translation.y, to.translation.z, turn.x, turn.y, turn.z]);
    let job = |q: &[f64]| format!("movej([{}])\nmovel(p[{pose}])\n", line(&radians(q)));
    folder.write("plain.script", job(&from));
    folder.write("counted.script", job(&count_values(&from)));
    let made = |from: &str, name: &str| -> Vec<f64> {
        let text = folder.run_to_success(&format!(
            "compensate --max-correction 20deg {from}/calibration.json {name}.script --tool-data 0,0,0,0,0,0"
        ));
        let cells = text.lines().nth(1).unwrap().trim_start_matches("movel(p[").trim_end_matches("])");
        cells.split(',').map(|it| it.trim().parse().unwrap()).collect()
    };
    let (plain, found) = ([made("plain", "plain")], [made("results", "counted")]);
    let meant = [pose.split(',').map(|it| it.parse().unwrap()).collect::<Vec<f64>>()];
    println!("poses differ by up to {:.1e} m or rad", largest_difference(&found, &plain));
    assert!(largest_difference(&found, &plain) < 2e-9 && largest_difference(&plain, &meant) > 1e-4);
}

/// A program of joint targets, numbers in degrees.
fn program(language: &str, rows: &[Vec<f64>]) -> String {
    let cells = |row: &[f64], scale: f64| row.iter().map(|it| format!("{:.9}", it * scale)).collect::<Vec<_>>();
    match language {
        "script" => {
            let line = |row: &Vec<f64>| format!("movej([{}])\n", cells(row, 1_f64.to_radians()).join(", "));
            rows.iter().map(line).collect()
        }
        "src" => {
            let line = |row: &Vec<f64>| {
                let axes = cells(row, 1.0).iter().zip(1..).map(|(it, k)| format!("A{k} {it}")).collect::<Vec<_>>();
                format!("PTP {{{}}}\n", axes.join(", "))
            };
            format!("DEF job()\n{}END\n", rows.iter().map(line).collect::<String>())
        }
        _ => {
            let place = |(row, k): (&Vec<f64>, usize)| {
                let axes = cells(row, 1.0).iter().zip(1..).map(|(it, k)| format!("J{k}= {it} deg")).collect::<Vec<_>>();
                format!("P[{k}]{{\n GP1:\n UF : 0, UT : 1,\n {}\n}};\n", axes.join(",\n "))
            };
            let lines = (1..=rows.len()).map(|k| format!("{k}:J P[{k}] 100% FINE ;\n")).collect::<String>();
            let places = rows.iter().zip(1..).map(place).collect::<String>();
            format!("/PROG JOB\n/MN\n{lines}/POS\n{places}/END\n")
        }
    }
}

/// The joint targets of such a program, degrees.
fn joints(language: &str, text: &str) -> Vec<Vec<f64>> {
    let rows: Vec<String> = match language {
        "script" | "src" => text.lines().filter(|it| it.contains('[') || it.contains('{')).map(str::to_owned).collect(),
        _ => {
            text.split("/POS").nth(1).unwrap().split("};").filter(|it| it.contains("J1=")).map(str::to_owned).collect()
        }
    };
    let numbers = |row: &String| -> Vec<f64> {
        let row = if language == "ls" { row.split("UT : 1,").nth(1).unwrap().to_owned() } else { row.clone() };
        let words = row.split(|c: char| c.is_whitespace() || ",[]{}()=".contains(c));
        let all: Vec<f64> = words.filter_map(|it| it.parse().ok()).collect();
        let scale = if language == "script" { 1_f64.to_degrees() } else { 1.0 };
        all.iter().map(|it| it * scale).collect()
    };
    rows.iter().map(numbers).collect()
}

#[test]
fn a_third_axis_is_stated_where_rows_do_not_show_it() {
    let folder = folder_with_both(LEVEL, from_level);
    let kept: serde_json::Value = serde_json::from_str(&folder.read("results/calibration.json")).unwrap();
    assert_eq!(kept["controller"]["third_axis"], "level");
    folder.write("job.ls", program("ls", &targets().iter().map(|it| from_level(it)).collect::<Vec<_>>()));
    // The calibration whose readings are the model's, by a driver: here J3 is stated to count from the level.
    let stated =
        folder.run_to_success("compensate --max-correction 20deg plain/calibration.json job.ls --third-axis level");
    let by_map = folder.run_to_success("compensate --max-correction 20deg results/calibration.json job.ls");
    let apart = largest_difference(&joints("ls", &stated), &joints("ls", &by_map));
    assert!(apart < 3e-6, "{apart}");
    // The same mapping again has the same result.
    let again = folder.run_to_success("validate results/calibration.json controller.csv --columns map.toml --json");
    let without = folder.run_to_success("validate results/calibration.json controller.csv --json");
    assert_eq!(again.replace(" --columns map.toml", ""), without);
    // Rows in which joint 2 hardly moves do not determine it.
    let file = folder.read("plain/calibration.json");
    let mut found: serde_json::Value = serde_json::from_str(&file).unwrap();
    for joint in found["coverage"].as_array_mut().unwrap() {
        if joint["joint"] == "joint2" {
            (joint["sampled_min"], joint["sampled_max"]) = (0.1.into(), 0.2.into());
        }
    }
    folder.write("narrow.json", found.to_string());
    folder.write("job.src", program("src", &targets()));
    let before = folder.listing();
    for (command, sentence) in [
        (
            "compensate narrow.json job.ls --out out.ls",
            "found a joint target, and a calibration whose rows do not show from where the third axis counts",
        ),
        (
            "compensate results/calibration.json controller.csv --third-axis arm --out out.csv",
            "found --third-axis arm for a table",
        ),
        (
            "compensate results/calibration.json job.src --third-axis arm --out out.src",
            "found --third-axis for a program in KRL",
        ),
        ("compensate results/calibration.json job.ls --third-axis floor --out out.ls", "level"),
    ] {
        let run = folder.run(command);
        println!("{}", run.err.trim_end());
        assert!(run.code == 2 && run.err.contains(sentence), "{command}: {}", run.err);
    }
    assert_eq!(folder.listing(), before);
    assert!(
        joints("ls", &folder.run_to_success("compensate --max-correction 20deg narrow.json job.ls --third-axis arm"))
            .len()
            == 10
    );
}

#[test]
fn a_third_axis_from_the_level_may_have_a_sign_and_an_offset() {
    let folder = folder_with_both("[units]\nangle = \"deg\"\n", <[f64]>::to_vec);
    let numbered = "joint1 = \"A1\"\njoint4 = \"A4\"\njoint5 = \"A5\"\njoint6 = \"A6\"\n";
    let axes = "joint2 = { column = \"A2\", offset = 7 }\njoint3 = { columns = { A3 = -1 }, offset = 5 }\n";
    folder.write("level.toml", format!("{LEVEL}[joints]\n{numbered}{axes}"));
    let sums = "joint2 = { column = \"A2\", offset = 7 }\njoint3 = { columns = { A2 = 1, A3 = -1 }, offset = 12 }\n";
    folder.write("sums.toml", format!("[units]\nangle = \"deg\"\n[joints]\n{numbered}{sums}"));
    let plain = folder.read("controller.csv");
    let turned = plain.lines().enumerate().map(|(at, row)| {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        if at > 0 {
            let (q2, q3): (f64, f64) = (cells[4].parse().unwrap(), cells[5].parse().unwrap());
            (cells[4], cells[5]) = (format!("{:.12}", q2 - 7.0), format!("{:.12}", 5.0 - (q3 - q2)));
        }
        cells.join(",")
    });
    folder.write("turned.csv", turned.collect::<Vec<_>>().join("\n"));
    let kept = |map: &str| -> serde_json::Value {
        folder.run_to_success(&format!("calibrate robot.urdf turned.csv --columns {map}.toml --out {map}"));
        serde_json::from_str(&folder.read(&format!("{map}/calibration.json"))).unwrap()
    };
    let (level, sums) = (kept("level"), kept("sums"));
    assert_eq!(level["controller"]["readings"], sums["controller"]["readings"]);
    let rms = |it: &serde_json::Value| it["accuracy"]["training"]["calibrated"]["position_mm"]["rms"].as_f64();
    println!("{:?} {:?} mm", rms(&level), rms(&sums));
    // The columns are summed in another order, which rounds otherwise.
    assert!((rms(&level).unwrap() - rms(&sums).unwrap()).abs() < 1e-9);
    let by_model: serde_json::Value = serde_json::from_str(&folder.read("results/calibration.json")).unwrap();
    assert!((rms(&level).unwrap() - rms(&by_model).unwrap()).abs() < 1e-6);
}

#[test]
fn a_third_axis_that_counts_from_the_level_is_named_with_the_line_that_reads_it() {
    let folder = folder_with_both(LEVEL, from_level);
    folder.write("without.toml", "[units]\nangle = \"deg\"\n");
    let told = folder.run("check robot.urdf controller.csv --columns without.toml").out;
    println!("{told}");
    assert!(told.contains("counting joint3 from the level"), "{told}");
    let advice = "third_axis = \"level\"";
    assert!(told.split_whitespace().collect::<Vec<_>>().join(" ").contains(advice), "{told}");
    // Followed literally.
    folder.write("with.toml", format!("{advice}\n{}", folder.read("without.toml")));
    let told = folder.run("check robot.urdf controller.csv --columns with.toml").out;
    assert!(!told.contains("from the level"), "{told}");
}

#[test]
fn a_file_whose_controller_is_of_another_robot_is_refused() {
    let folder = folder_with_both(MAP, count_values);
    let kept: serde_json::Value = serde_json::from_str(&folder.read("results/calibration.json")).unwrap();
    folder.write("counted.csv", format!("A1,A2,A3,A4,A5,A6\n{}\n", line(&count_values(&targets()[0]))));
    let shorter = {
        let mut file = kept.clone();
        file["controller"]["readings"].as_array_mut().unwrap().pop();
        file
    };
    let with = |key: &str, value: serde_json::Value| {
        let mut file = kept.clone();
        file["controller"]["readings"][2]["columns"]["A3"][key] = value;
        file
    };
    for (sentence, file) in [
        ("expected those of the joints", shorter),
        ("expected factors other than 0", with("factor", 0.0.into())),
        ("cubit", with("unit", "cubit".into())),
    ] {
        folder.write("changed.json", file.to_string());
        for command in [
            "predict changed.json counted.csv",
            "compensate changed.json counted.csv",
            "export changed.json --format c",
        ] {
            let run = folder.run(command);
            println!("{command}: {}", run.err.trim_end());
            // An export needs no units.
            assert!(run.err.contains(sentence) && run.code == 2 || sentence == "cubit" && run.code == 0, "{command}");
        }
    }
}

#[test]
fn exports_say_what_the_controller_counts() {
    let folder = folder_with_both(MAP, count_values);
    let c = folder.run("export results/calibration.json --format c");
    assert!(
        c.err.contains("joint3 = A2 + A3") && c.out.contains("readings[2] = counted[1] + counted[2]"),
        "{}{}",
        c.err,
        c.out
    );
    let offsets = folder.run("export results/calibration.json --format offsets");
    let found: serde_json::Value = serde_json::from_str(&offsets.out).unwrap();
    let of = |list: &str, at: usize| found[list][at]["offset_deg"].as_f64().unwrap();
    assert_eq!(found["counted"][2]["joint"], "A3");
    // Rows of joint3 = A2 + A3 and joint1 = 5 - A1.
    assert!((of("counted", 2) - (of("joints", 2) - of("joints", 1))).abs() < 1e-12);
    assert!((of("counted", 0) + of("joints", 0)).abs() < 1e-12 && of("joints", 0).abs() > 0.0);
    let lerobot = folder.run("export results/calibration.json --format lerobot");
    assert!(lerobot.code == 2 && lerobot.err.contains("expected those of one motor for each joint"), "{}", lerobot.err);
}

#[test]
fn sums_that_cannot_be_taken_apart_are_predicted_and_not_corrected() {
    let folder = folder_with_both(MAP, count_values);
    folder.write("constant.toml", MAP.replace("joint6 = \"A6\"", "joint6 = { value = 10 }"));
    let run =
        folder.run("calibrate robot.urdf controller.csv --columns constant.toml --out fixed --corrections off --quiet");
    assert!(run.code < 2, "{}", run.err);
    folder.write("counted.csv", format!("A1,A2,A3,A4,A5,A6\n{}\n", line(&count_values(&targets()[0]))));
    assert_eq!(numbers(&folder.run_to_success("predict fixed/calibration.json counted.csv"), 0).len(), 1);
    let run = folder.run("compensate fixed/calibration.json counted.csv --out out.csv");
    assert!(run.code == 2 && run.err.contains("joint `joint6` is a constant by the mapping"), "{}", run.err);
    folder.write("job.ls", program("ls", &targets()));
    let run = folder.run("compensate fixed/calibration.json job.ls --out out.ls");
    assert!(run.code == 2 && run.err.contains("cannot be taken apart again"), "{}", run.err);
    for (map, sentence) in [
        (LEVEL.replace("level", "floor"), "found the third axis `floor`, expected `arm` or `level`"),
        (format!("third_axis = \"level\"\n{MAP}"), "beside a sum of columns for joint `joint3`"),
        (
            MAP.replace("joint3 = { columns = { A2 = 1, A3 = 1 } }", "joint3 = { value = 1 }")
                .replace("[units]", "third_axis = \"level\"\n[units]"),
            "beside a constant for joint `joint3`",
        ),
        (MAP.replace("joint4 = \"A4\"", "joint4 = { value = 1, offset = 2 }"), "found `offset` beside `value`"),
    ] {
        folder.write("wrong.toml", &map);
        let run = folder.run("calibrate robot.urdf controller.csv --columns wrong.toml --out other");
        println!("{}", run.err.trim_end());
        assert!(run.code == 2 && run.err.contains(sentence), "{map}: {}", run.err);
    }
}
