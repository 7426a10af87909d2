//! Joint readings in a folder, a file for each picture.

use std::fs;
use std::path::Path;

use crate::folder::Folder;

/// The pictures of the guide: names and readings, degrees.
fn pictures() -> Vec<(String, Vec<f64>)> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let text = fs::read_to_string(examples.join("howto/pictures.csv")).unwrap();
    let row = |line: &str| {
        let (name, rest) = line.split_once(',').unwrap();
        (name.to_owned(), rest.split(',').map(|it| it.parse().unwrap()).collect())
    };
    text.lines().skip(1).map(row).collect()
}

/// A command on the files of the guide, with other readings.
fn words(command: &str, readings: &str, more: &str) -> String {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let (model, howto) = (examples.join("elbow/robot.urdf"), examples.join("howto"));
    let [corners, lens] = ["corners.csv", "lens.csv"].map(|name| howto.join(name).display().to_string());
    format!("{command} {} {readings} {corners} --camera {lens} --markers chessboard:6x5:40mm {more}", model.display())
}

/// Readings in radians in all forms, beside the pictures.
fn write_all(folder: &Folder) {
    fs::create_dir(folder.path("session")).unwrap();
    let mut table = "image,joint1,joint2,joint3,joint4,joint5,joint6\n".to_owned();
    for (at, (name, readings)) in pictures().iter().enumerate() {
        let readings: Vec<String> = readings.iter().map(|it| it.to_radians().to_string()).collect();
        table.push_str(&format!("{name},{}\n", readings.join(",")));
        let number = at + 1;
        let (file, text) = match at % 4 {
            0 => (format!("configuration_{number}"), readings.join(" ")),
            1 => (format!("configuration_{number}.txt"), readings.join("\n")),
            2 => (format!("configuration_{number}.yaml"), format!("joints: [{}]\n", readings.join(", "))),
            _ => (format!("configuration-{number}.yml"), format!("- {}\n", readings.join("\n- "))),
        };
        fs::write(folder.path(&format!("session/{file}")), text).unwrap();
        fs::write(folder.path(&format!("session/image-{number}.png")), "no text").unwrap();
    }
    fs::write(folder.path("session/notes.txt"), "in the morning").unwrap();
    fs::write(folder.path("table.csv"), table).unwrap();
}

#[test]
fn a_file_for_each_picture_is_the_same_as_a_table() {
    let folder = Folder::new();
    write_all(&folder);
    let calibrated = |readings: &str, out: &str| -> serde_json::Value {
        let run = folder.run(&words("calibrate", readings, &format!("--out {out}")));
        println!("{}", run.err);
        assert_eq!(run.code, 0, "{}", run.err);
        assert!(run.err.contains("note: the camera is on the last link") && !run.err.contains("warning: the camera"));
        serde_json::from_str(&folder.read(&format!("{out}/calibration.json"))).unwrap()
    };
    let (of_folder, of_table) = (calibrated("session", "one"), calibrated("table.csv", "other"));
    let said = folder.run(&words("check", "session", "--json")).out;
    assert!(said.contains("session: no column has the name of a joint; took `q1` to `q6`"), "{said}");
    assert_eq!(of_folder["joints"], of_table["joints"]);
    assert_eq!(of_folder["verdict"], of_table["verdict"]);
    assert!(of_folder["inputs"]["sha256"]["session"].is_string(), "{}", of_folder["inputs"]);
}

#[test]
fn joints_go_by_name_and_unit_where_files_have_them() {
    let folder = Folder::new();
    fs::create_dir(folder.path("named")).unwrap();
    fs::create_dir(folder.path("plain")).unwrap();
    for (at, (_, readings)) in pictures().iter().enumerate() {
        let line = |joint: usize| format!("joint{}[deg]: {}\n", joint + 1, readings[joint]);
        // In another order in each file.
        let text: String = (0..6).map(|joint| line((joint + at) % 6)).collect();
        fs::write(folder.path(&format!("named/configuration_{}.yaml", at + 1)), text).unwrap();
        let text = readings.iter().map(|it| it.to_radians().to_string()).collect::<Vec<_>>().join(", ");
        fs::write(folder.path(&format!("plain/{}", at + 1)), text).unwrap();
    }
    let [named, plain] =
        ["named", "plain"].map(|it| folder.run_to_success(&words("plan", &format!("--rows {it} --rows"), "--json")));
    let of = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap()["expected_error"].clone();
    let mean = |text: &str| of(text)["position_mean_mm"].as_f64().unwrap();
    println!("{} and {}", mean(&named), mean(&plain));
    assert!((mean(&named) / mean(&plain) - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_wrong_in_a_folder_is_said_in_one_sentence() {
    let six = "0.1 0.2 0.3 0.4 0.5 0.6";
    for (files, part) in [
        (&[][..], "folder: found a directory without text files"),
        (&[("notes.txt", six)][..], "folder: found a directory without text files"),
        (&[("a_1", six), ("b_01.yaml", six)][..], "found two files with the number 1, `a_1` and `b_01.yaml`"),
        (&[("a_1", six), ("a_2", "0.1 0.2")][..], "a_2: found 2 joint readings, expected 6 as in"),
        (&[("a_1", six), ("a_2", "0.1\nhome")][..], "a_2:2: found `home`, expected the joint readings"),
        (&[("a_1", six), ("a_2", "")][..], "a_2: the file is empty"),
        (&[("a_1", "a: 1\nb: 2"), ("a_2", "1 2")][..], "a_2: found readings without names"),
        (&[("a_1", "a: 1\nb: 2"), ("a_2", "a: 1\nc: 2")][..], "a_2: found no reading of `b`"),
        (&[("a_1", "0.1 0.2"), ("a_2", "0.1 0.2")][..], "folder: found no column"),
        (&[("a_1", "10 20 30 40 50 60"), ("a_2", "20 -70 80 90 100 110")][..], "folder/a_"),
    ] {
        let folder = Folder::new();
        fs::create_dir(folder.path("folder")).unwrap();
        for (name, text) in files {
            fs::write(folder.path(&format!("folder/{name}")), text).unwrap();
        }
        let run = folder.run(&words("calibrate", "folder", ""));
        println!("{}", run.err);
        assert_eq!(run.code, 2, "{}", run.err);
        assert!(run.err.contains(part) && run.err.lines().count() == 1, "{part}: {}", run.err);
    }
}
