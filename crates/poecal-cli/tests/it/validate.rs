//! Statements of `poecal validate` about predicted errors that hold, fail, or are not tested.

use std::fmt::Write as _;

use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation};
use poecal_results::model::Model;

use crate::folder::Folder;
use crate::session::ROBOT;

/// A simulated robot calibrated with joint2 and joint3 near the middle of their ranges, and files of rows inside and outside these, and of another
/// robot.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    let model = Model::read(folder.path("robot.urdf"), &Default::default()).unwrap();
    let simulation = Simulation { count: 1500, ..Simulation::default() };
    let made = simulation.run(&model.robot, SessionKind::POINT).unwrap();
    let other = Simulation { seed: 2, count: 1, ..simulation }.run(&model.robot, SessionKind::POINT).unwrap().actual;
    let is_inside = |row: usize| [1, 2].iter().all(|&joint| (made.data.readings(row)[joint] - 0.5).abs() < 0.8);
    let is_outside = |row: usize| [1, 2].iter().all(|&joint| (made.data.readings(row)[joint] - 0.5).abs() > 1.0);
    let inside: Vec<usize> = (0..made.data.len()).filter(|&row| is_inside(row)).collect();
    let outside: Vec<usize> = (0..made.data.len()).filter(|&row| is_outside(row)).take(30).collect();
    assert!(inside.len() >= 90 && outside.len() == 30, "{} and {}", inside.len(), outside.len());
    let write = |name: &str, rows: &[usize], is_other: bool| {
        let mut text = format!("{},x,y,z\n", made.data.reading_names().join(","));
        for &row in rows {
            let readings = made.data.readings(row);
            let seen = if is_other {
                (made.device_from_base * other.forward_kinematics(readings)).translation
            } else {
                made.data.observations[row].measurement.pose().translation
            };
            let cells: Vec<String> = readings.iter().map(|reading| format!("{reading:?}")).collect();
            writeln!(text, "{},{:?},{:?},{:?}", cells.join(","), seen.x, seen.y, seen.z).unwrap();
        }
        folder.write(name, text);
    };
    let (fit, rest) = inside.split_at(inside.len() - 20);
    write("fit.csv", fit, false);
    write("inside.csv", rest, false);
    write("outside.csv", &outside, false);
    write("other.csv", rest, true);
    write("other_outside.csv", &outside, true);
    write_nominal(&folder, &model.robot, rest.iter().map(|&row| made.data.readings(row)));
    folder.run_to_success("calibrate robot.urdf fit.csv --sigma-position 0.05mm");
    folder
}

/// Rows of a robot that equals its model, 1 m from the device.
fn write_nominal<'a>(folder: &Folder, robot: &Robot, readings: impl Iterator<Item = &'a [f64]>) {
    let mut text = format!("{},x,y,z\n", robot.reading_names().join(","));
    for readings in readings {
        let seen = robot.forward_kinematics(readings).translation;
        let cells: Vec<String> = readings.iter().map(|reading| format!("{reading:?}")).collect();
        writeln!(text, "{},{:?},{:?},{:?}", cells.join(","), seen.x + 1.0, seen.y, seen.z).unwrap();
    }
    folder.write("nominal.csv", text);
}

/// The gain over the nominal model is required by itself: rows of the calibrated robot show it, those of a nominal one or too few rows do not.
#[test]
fn a_gain_is_required_of_rows_that_judge() {
    let folder = folder();
    let judge = |words: &str| folder.run(&format!("validate poecal-out/calibration.json {words} --history none"));
    let clear = judge("inside.csv --require-gain");
    assert_eq!((clear.code, clear.err.as_str()), (0, ""), "{}", clear.out);
    assert!(clear.out.contains("\ngain          the error of the nominal model is "), "{}", clear.out);
    let json: serde_json::Value = serde_json::from_str(&judge("inside.csv --json").out).unwrap();
    assert_eq!(json["verdict"]["gain"], "clear");
    let [factor, from, to] = ["factor", "from", "to"].map(|key| json["improvement"][key].as_f64().unwrap());
    // Simulated errors of 1 deg and 2 mm for each axis are hundreds of times the noise; the noise of the improvement is the scatter of few rows.
    assert!(1.0 < from && from <= factor && factor <= to && factor > 20.0, "{json}");
    // A robot that equals its model is described worse by the calibrated one.
    let lost = judge("nominal.csv --require-gain");
    assert!(lost.code == 1 && lost.out.contains("gain          a loss: "), "{}", lost.out);
    assert!(
        lost.err.contains("not what --require-gain asks for: on these rows the error of the nominal model is"),
        "{}",
        lost.err
    );
    // Two rows of three numbers are fewer than the frame's and the target's unknowns.
    let rows = folder.read("inside.csv");
    folder.write("few.csv", rows.lines().take(3).collect::<Vec<_>>().join("\n") + "\n");
    let few = judge("few.csv --require-gain");
    assert_eq!(few.code, 1);
    assert!(few.err.contains("too few to compare it with the nominal model"), "{}", few.err);
    assert_eq!(judge("few.csv").code, 0);
}

#[test]
fn a_promise_is_required_of_all_rows_or_of_those_inside() {
    let folder = folder();
    let judge = |words: &str| folder.run(&format!("validate poecal-out/calibration.json {words}"));
    for required in ["good", "inside_sampled_range"] {
        let run = judge(&format!("inside.csv --require {required}"));
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{}", run.out);
        let run = judge(&format!("other.csv --require {required}"));
        assert_eq!(run.code, 1, "{}{}", run.out, run.err);
        assert!(run.err.contains("position errors") && run.err.contains("80 % are required"), "{}", run.err);
        let json = judge(&format!("other.csv --require {required} --json"));
        assert_eq!(json.code, 1);
        let found: serde_json::Value = serde_json::from_str(&json.out).unwrap();
        assert!(found["calibrated"]["position_mm"]["mean"].as_f64().unwrap() > 1.0);
        assert!(found["promised"]["position_mm"]["inside_bound95"].as_f64().unwrap() < 0.5);
        assert!(found["in_sampled_range"]["promised"]["position_mm"]["inside_bound95"].as_f64().unwrap() < 0.5);
    }
    // A range without rows cannot be judged.
    let run = judge("outside.csv --require inside_sampled_range");
    assert!(run.code == 1 && run.err.contains("no row lies inside the sampled range"), "{}", run.err);
    assert_eq!(judge("other.csv").code, 1, "the calibration does not hold");
    let run = judge("fit.csv");
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.err.contains("warning: fit.csv: the calibration was made of this file"), "{}", run.err);
}

#[test]
fn what_lies_outside_the_sampled_range_is_not_blamed_on_the_robot() {
    let folder = folder();
    let judge = |words: &str| folder.run(&format!("validate poecal-out/calibration.json {words}"));
    let run = judge("other_outside.csv");
    println!("{}{}", run.out, run.err);
    assert!(run.err.contains("no row lies inside the range that was sampled for the calibration"), "{}", run.err);
    assert!(!run.err.contains("is not as it was calibrated"), "{}", run.err);
    let words = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("none of the rows lies inside it"), "{}", run.out);

    // Rows inside are as predicted, those outside are of another robot.
    let both = folder.read("inside.csv") + folder.read("other_outside.csv").split_once('\n').unwrap().1;
    folder.write("both.csv", both);
    let run = judge("both.csv");
    println!("{}{}", run.out, run.err);
    assert!(run.err.contains("rows inside the sampled range are as expected; outside it"), "{}", run.err);
    assert_eq!(judge("both.csv --require inside_sampled_range").code, 0);
    assert_eq!(judge("both.csv --require good").code, 1);
    assert!(judge("other.csv").err.contains("if the measuring device was moved, refit its frame"));
}
