//! Several stations of the measuring device: `--device-frames per-file`, the column `instrument`, and refused options.

use poecal_model::simulate::SessionKind;
use poecal_results::residuals::Residuals;

use crate::folder::Folder;
use crate::session::{calibration, session};

/// The simulated session of points, its later rows seen from another station: a column `instrument` in `both.csv`, and files of their own,
/// `monday.csv` and `tuesday.csv`.
fn folder_with_moved_rows() -> Folder {
    let folder = session(SessionKind::POINT);
    let text = folder.read("measurements.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    let names: Vec<&str> = header.split(',').collect();
    let x = names.iter().position(|name| *name == "x").unwrap();
    let mut both = format!("{header},instrument\n");
    let (mut monday, mut tuesday) = (format!("{header}\n"), format!("{header}\n"));
    for (row, line) in rows.lines().enumerate() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if row >= 35 {
            let [px, py, pz]: [f64; 3] = [0, 1, 2].map(|k| cells[x + k].parse().unwrap());
            for (k, value) in [1.2 - py, px, pz + 0.1].into_iter().enumerate() {
                cells[x + k] = format!("{value:?}");
            }
        }
        let line = cells.join(",");
        both += &format!("{line},{}\n", if row < 35 { "left" } else { "right" });
        let file = if row < 35 { &mut monday } else { &mut tuesday };
        *file += &format!("{line}\n");
    }
    folder.write("both.csv", both);
    folder.write("monday.csv", monday);
    folder.write("tuesday.csv", tuesday);
    folder
}

#[test]
fn each_file_or_instrument_has_a_frame_of_its_own() {
    let folder = folder_with_moved_rows();
    folder.run_to_success("calibrate robot.urdf measurements.csv --out one");
    folder.run_to_success("calibrate robot.urdf both.csv --out named");
    folder.run_to_success("calibrate robot.urdf monday.csv tuesday.csv --device-frames per-file --out files");
    let rms = |name: &str| calibration(&folder, name).accuracy.held_out.unwrap().calibrated.position_mm().rms;
    assert!(rms("named") < 1.5 * rms("one"), "{} {}", rms("named"), rms("one"));
    assert!((rms("named") - rms("files")).abs() < 1e-6, "{} {}", rms("named"), rms("files"));
    assert!(calibration(&folder, "one").stations.is_empty());
    for (out, names) in [("named", ["left", "right"]), ("files", ["monday.csv", "tuesday.csv"])] {
        let file = calibration(&folder, out);
        let found: Vec<_> = file.stations.iter().map(|it| it.instrument.as_deref().unwrap()).collect();
        assert_eq!(found, names);
        assert_eq!(file.stations[0].base_from_device, file.measurement_frame.base_from_device);
        // 90 degrees about the vertical, by its motion.
        let [a, b] = [0, 1].map(|k| file.stations[k].base_from_device.pose().unwrap());
        let apart = b.inverse() * a;
        let expected = [1.2, 0.0, 0.1];
        (0..3).for_each(|k| assert!((apart.translation[k] - expected[k]).abs() < 1e-3, "{apart:?}"));
        let text = folder.read(&format!("{out}/residuals.csv"));
        assert!(text.lines().next().unwrap().ends_with(",instrument"), "{text}");
        assert!(text.lines().nth(1).unwrap().ends_with(&format!(",{}", names[0])));
        assert_eq!(Residuals::parse(&text, "residuals.csv").unwrap().text(), text);
        assert!(folder.read(&format!("{out}/report.html")).contains("stations.1.instrument"));
    }
    folder.write(
        "poecal.toml",
        "poecal_settings = 1\nmodel = 'robot.urdf'\nmeasurements = ['monday.csv', 'tuesday.csv']\ndevice_frames = 'per-file'\nout = 'settings'\n",
    );
    folder.run_to_success("calibrate");
    assert_eq!(calibration(&folder, "settings").stations.len(), 2);
    folder.write("map.toml", "instrument = 'stage'\n");
    folder.run_to_success("calibrate robot.urdf measurements.csv --columns map.toml --out mapped");
    assert_eq!(calibration(&folder, "mapped").stations.len(), 2);
}

#[test]
fn files_that_were_measured_from_two_places_are_named_without_the_option() {
    let folder = folder_with_moved_rows();
    let run = folder.run("calibrate robot.urdf monday.csv tuesday.csv --out repaired --verbose");
    let said = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    println!("{said}");
    assert!(
        run.code == 0 && said.contains("repaired the files monday.csv and tuesday.csv do not share one device frame"),
        "{said}"
    );
    assert!(said.contains("--device-frames per-file"), "{said}");
    let run = folder.run("calibrate robot.urdf monday.csv tuesday.csv --repair off --out out");
    // Statements of the table are not repeated on standard error.
    let said = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("the files monday.csv and tuesday.csv do not share one device frame"), "{said}");
    assert!(said.contains("--device-frames per-file") && said.contains("do not use"), "{said}");
}

#[test]
fn validation_takes_the_frame_of_each_instrument() {
    let folder = folder_with_moved_rows();
    folder.run_to_success("calibrate robot.urdf both.csv --out out");
    let rms = |arguments: &str| -> f64 {
        let text = folder.run_to_success(&format!("validate out/calibration.json {arguments} --json"));
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        value["calibrated"]["position_mm"]["rms"].as_f64().unwrap()
    };
    assert!(rms("both.csv") < 0.12);
    assert!(rms("both.csv --refit device") < 0.12);
    assert!(rms("monday.csv tuesday.csv --device-frames per-file --refit device") < 0.12);
    let refused = |arguments: &str, sentence: &str| {
        let run = folder.run(&format!("validate out/calibration.json {arguments}"));
        assert!(run.code == 2 && run.err.ends_with(&format!("error: {sentence}\n")), "{}", run.err);
    };
    refused(
        "monday.csv",
        "found measurements without an instrument's name, expected one of left, right as in the calibration: add a column \
         `instrument`, or refit the frames with --refit device",
    );
    refused(
        "monday.csv --device-frames per-file",
        "found measurements of instrument `monday.csv`, whose frame is not in the calibration, expected one of left, right: rename \
         it, or refit the frames with --refit device",
    );
    folder.run_to_success("calibrate robot.urdf monday.csv --out one");
    let run = folder.run("validate one/calibration.json both.csv");
    let sentence = "found measurements of 2 instruments, expected those of one, since the calibration has one device frame: judge each \
                    by itself, or refit the frames with --refit device";
    assert!(run.code == 2 && run.err.ends_with(&format!("error: {sentence}\n")), "{}", run.err);
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = folder_with_moved_rows();
    let refused = |arguments: &str, sentence: &str| {
        let run = folder.run(&format!("calibrate robot.urdf {arguments} --out out"));
        assert!(run.code == 2 && run.err.ends_with(&format!("error: {sentence}\n")), "{arguments}: {}", run.err);
    };
    refused(
        "monday.csv tuesday.csv --device-frames per-file --device-frame base",
        "found measurements of 2 instruments that are to be in the base frame (--device-frame base), expected one of the two: leave the \
         instruments' names out if all measure in the base frame, or --device-frame base if each has a frame of its own",
    );
    // The frame of held-out rows is estimated from these.
    folder
        .run_to_success("calibrate robot.urdf monday.csv --validate tuesday.csv --device-frames per-file --out judged");
    let columns = folder.read("both.csv").lines().next().unwrap().rfind("instrument").unwrap() + 1;
    refused(
        "both.csv --device-frames per-file",
        &format!(
            "both.csv:1:{columns}: found a column of instruments and --device-frames per-file, expected one of the two: leave the \
             option out, or the column"
        ),
    );
    let run = folder.run("calibrate robot.urdf both.csv tuesday.csv --out out");
    assert_eq!(run.code, 2);
    assert!(
        run.err.contains(
            "found no instrument name, expected one as in both.csv:2; all rows name their instrument or none does"
        ),
        "{}",
        run.err
    );
}
