//! The report page: its figures are those of the calibration file, names in it are no markup, and it stays small.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw};
use poecal_calibrate::{Calibration, CalibrationOptions, Corrections, Sizes, calibrate};
use poecal_formats::urdf::{ChainSelection, UrdfDocument};
use poecal_model::measurement::{Dataset, Measurement, Quantity, Set};
use poecal_model::robot::{Joint, Robot};
use poecal_model::simulate::{GrossErrors, SessionKind, Simulation, elbow, gantry, scara, seven_axis};
use poecal_report::calibration_page;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::residuals::Residuals;
use serde_json::Value;

/// A calibration with its data, and its file as read back.
pub(crate) struct Session {
    data: Dataset,
    calibration: Calibration,
    pub(crate) file: CalibrationFile,
}

impl Session {
    pub(crate) fn new(robot: &Robot, kind: SessionKind, count: usize) -> Self {
        let made = Simulation { count, ..Simulation::default() }.run(robot, kind).unwrap();
        Session::from_dataset(robot, made.data)
    }

    pub(crate) fn from_dataset(robot: &Robot, data: Dataset) -> Self {
        Session::with_options(robot, data, &CalibrationOptions::default())
    }

    fn with_options(robot: &Robot, data: Dataset, options: &CalibrationOptions) -> Self {
        let calibration = calibrate(robot, &data, options).unwrap();
        let inputs = Inputs { model: "robot.urdf".into(), ..Inputs::default() };
        let text = CalibrationFile::new(&calibration, &data, inputs).to_text().unwrap();
        let file = CalibrationFile::parse(&text, "calibration.json").unwrap();
        Session { data, calibration, file }
    }

    fn residuals(&self) -> Residuals {
        Residuals::from_calibration(&self.data, &self.calibration)
    }

    pub(crate) fn page(&self) -> String {
        calibration_page(&self.file, &self.residuals()).unwrap().concat()
    }
}

/// Rows with several configurations that were repeated.
fn repeated_rows() -> Dataset {
    let mut made = Simulation { count: 50, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap();
    for row in (0..5).cycle().take(20) {
        let readings = made.data.readings(row).to_vec();
        let mut observation = made.data.observations[row];
        // Some micrometres apart, in turn along the axes.
        observation.measurement.values_mut()[made.data.len() % 3] += 1e-6 * (made.data.len() % 7) as f64;
        made.data.push_observation(&readings, observation).unwrap();
    }
    made.data
}

/// Every figure that names its key, with the factor that it is shown by.
fn figures(page: &str) -> Vec<(String, f64, String)> {
    let found = page.split("<span data-key=\"").skip(1).map(|rest| {
        let (key, rest) = rest.split_once('"').unwrap();
        let (attributes, rest) = rest.split_once('>').unwrap();
        let factor = attributes.split('"').nth(1).map_or(1.0, |text| text.parse().unwrap());
        (key.to_owned(), factor, rest.split_once("</span>").unwrap().0.to_owned())
    });
    found.collect()
}

/// Input of the page's script.
pub(crate) fn data_of(page: &str) -> Value {
    let data = page.split_once("id=\"report-data\">").unwrap().1.split_once("</script>").unwrap().0;
    serde_json::from_str(data).unwrap()
}

/// The numbers of a column of the page's data: three bytes each, in base64.
pub(crate) fn numbers_of(column: &Value) -> Vec<Option<f64>> {
    const LETTERS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let [low, step] = ["low", "step"].map(|key| column[key].as_f64().unwrap());
    let letters: Vec<usize> = column["bytes"].as_str().unwrap().chars().map(|it| LETTERS.find(it).unwrap()).collect();
    let whole = |four: &[usize]| four.iter().fold(0, |sum, letter| 64 * sum + letter);
    let numbers = letters.chunks(4).map(whole);
    numbers.map(|it| (it != 0xff_ffff).then_some(low + step * it as f64)).collect()
}

fn value_of<'a>(file: &'a Value, key: &str) -> &'a Value {
    key.split('.').fold(file, |value, part| match part.parse::<usize>() {
        Ok(index) if value.is_array() => &value[index],
        _ => &value[part],
    })
}

/// True if a text shows this value to its digits.
fn shows(text: &str, value: f64) -> bool {
    let Ok(shown) = text.replace('−', "-").parse::<f64>() else { return false };
    let mantissa = text.split('e').next().unwrap();
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let power = text.split_once('e').map_or(0, |(_, power)| power.parse::<i32>().unwrap());
    // Half a unit of the last digit, and rounding.
    (shown - value).abs() <= 0.5001 * 10f64.powi(power - decimals as i32)
}

pub(crate) fn check_figures(name: &str, session: &Session) {
    let file: Value = serde_json::from_str(&session.file.to_text().unwrap()).unwrap();
    let figures = figures(&session.page());
    for (key, factor, text) in &figures {
        match value_of(&file, key) {
            Value::Number(value) => {
                let value = value.as_f64().unwrap() * factor;
                assert!(shows(text, value), "{name}: {key} is shown as {text}, expected {value}");
            }
            Value::String(value) => {
                assert!(text.contains(&value[..value.len().min(3)]), "{name}: {key}: {text}")
            }
            other @ (Value::Null | Value::Bool(_) | Value::Array(_) | Value::Object(_)) => {
                panic!("{name}: the file has {other} at {key}, which is shown as {text}")
            }
        }
    }
    println!("{name}: {} figures are those of the file", figures.len());
    assert!(figures.len() > 80, "{name}");
}

#[test]
fn every_figure_is_that_of_the_calibration_file() {
    for (name, robot, kind) in [
        ("elbow, points", elbow(), SessionKind::POINT),
        ("seven axes, poses", seven_axis(), SessionKind::POSE),
        ("SCARA, mixed", scara(), SessionKind::MIXED),
        ("gantry, poses", gantry(), SessionKind::POSE),
    ] {
        check_figures(name, &Session::new(&robot, kind, 60));
    }
    let mut made = Simulation { count: 80, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let gross = GrossErrors { share: 0.05, ..GrossErrors::default() }.spoil(&mut made.data);
    let session = Session::from_dataset(&elbow(), made.data);
    check_figures("elbow, wrong rows", &session);
    assert!(session.page().contains("Suspected outliers, the worst first") && !gross.is_empty());
    let mut data = Simulation::default().run(&elbow(), SessionKind::POINT).unwrap().data;
    data.observations.iter_mut().for_each(|row| row.set = Some(Set::Fit));
    let session = Session::from_dataset(&elbow(), data);
    check_figures("elbow, nothing held out", &session);
    assert!(session.page().contains("since none was held out"));
}

/// Charts and tables are of one model: the delivered one.
#[test]
fn the_page_shows_the_delivered_model() {
    let data = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap().data;
    let corrections = Corrections::Sizes(Sizes::COMMON);
    let options = CalibrationOptions { corrections, ..CalibrationOptions::default() };
    let corrected = Session::with_options(&elbow(), data.clone(), &options);
    let geometry = CalibrationOptions { corrections: Corrections::Off, ..options };
    let calibrated = Session::with_options(&elbow(), data, &geometry);
    for (session, name, other) in [(&corrected, "corrected", "calibrated"), (&calibrated, "calibrated", "corrected")] {
        let page = session.page();
        for words in [
            "measured minus predicted by the {} model",
            "by the {} model to its measured place",
            "error of the {} model, mm",
        ] {
            let (own, not) = (words.replace("{}", name), words.replace("{}", other));
            assert!(page.contains(&own) && !page.contains(&not), "{name}: {own}");
        }
        let (_, data) = page.split_once("id=\"report-data\">").unwrap();
        let data: Value = serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap();
        let drawn = numbers_of(&data["rows"]["error_mm"]);
        for (row, drawn) in session.residuals().rows().iter().zip(drawn) {
            let error = row.errors.get(Quantity::Position).unwrap().delivered_error();
            assert!((drawn.unwrap() - error).abs() <= 1e-5 * error, "{name}");
        }
    }
    assert!(corrected.page().contains("Cross-validation of the calibrated model, geometry alone"));
}

/// The script draws all arms, and every instrument and target on its body.
#[test]
fn robots_with_branches_are_drawn_with_their_instruments() {
    let pairs = |pairs: [(&str, &str); 2]| pairs.map(|(name, link)| (name.to_owned(), link.to_owned()));
    let selection = ChainSelection {
        instruments: pairs([("eyes", "head_camera"), ("chest", "torso")]).into(),
        targets: pairs([("left", "left_hand"), ("right", "right_hand")]).into(),
        ..ChainSelection::default()
    };
    let document =
        UrdfDocument::parse(include_str!("../../../poecal-testing/data/torso.urdf"), "torso.urdf", &selection).unwrap();
    let session = Session::new(document.robot(), SessionKind::POSE, 200);
    check_figures("torso", &session);
    let page = session.page();
    assert!(page.contains("<td class=\"word\">link of torso2</td>"));
    let data = data_of(&page);
    let on = |list: &str| -> Vec<Value> { data[list].as_array().unwrap().iter().map(|it| it["on"].clone()).collect() };
    let expected = [Value::Null, 0.into(), 1.into(), 2.into(), 3.into(), 4.into(), 5.into(), 6.into()];
    assert_eq!(on("joints")[..8], expected);
    assert_eq!((&on("joints")[8], &on("joints")[9]), (&Value::from(1), &Value::from(1)));
    assert_eq!(on("instruments"), [8, 1].map(Value::from));
    assert_eq!(on("targets"), [7, 14].map(Value::from));
    let stations = session.file.stations.iter().map(|it| &it.base_from_device.position_m);
    for (place, drawn) in stations.zip(data["instruments"].as_array().unwrap()) {
        for k in 0..3 {
            assert!((place[k] - drawn["pose"]["position_m"][k].as_f64().unwrap()).abs() < 1e-12);
        }
    }
    assert_eq!(data["rows"]["instrument"].as_array().unwrap().len(), 200);
    // A single instrument beside a robot without branches is not drawn.
    let data = data_of(&Session::new(&elbow(), SessionKind::POSE, 60).page());
    assert_eq!((&data["draws_instruments"], &data["rows"]["instrument"]), (&false.into(), &Value::Null));
}

#[test]
fn repeated_configurations_are_stated_with_accuracy_and_repeatability() {
    let session = Session::from_dataset(&elbow(), repeated_rows());
    let found = session.file.repeatability.as_ref().unwrap();
    println!("{found:?}");
    assert_eq!((found.poses, found.rows), (5, 25));
    check_figures("elbow, repeated", &session);
    assert!(session.page().contains("ISO 9283"));
}

/// Three targets in each of 60 configurations. In two of them joint 2 was not at its stated value; in a third one target alone deviates.
#[test]
fn configurations_whose_targets_are_all_off_alike_are_named() {
    let robot = elbow();
    let made = Simulation { count: 60, ..Simulation::default() }.run(&robot, SessionKind::POINT).unwrap();
    let device_from_base = Pose::from_xyz_rpy([2.0, -1.0, 0.5], [0.1, -0.2, 2.0]);
    let places = [[0.05, 0.0, 0.02], [-0.03, 0.06, 0.0], [0.0, -0.05, 0.04]].map(Vector3::from);
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    for name in ["a", "b", "c"] {
        data.target_index(Some(name));
    }
    for row in 0..made.data.len() {
        let readings = made.data.readings(row).to_vec();
        let mut stood = readings.clone();
        stood[1] += if [7, 30].contains(&row) { 0.01 } else { 0.0 };
        let tip = robot.forward_kinematics(&stood);
        for (target, place) in places.iter().enumerate() {
            let mut observation = made.data.observations[row];
            observation.target = target;
            observation.source.line = (3 * row + target + 2) as u32;
            let noise = 2e-5 * Vector3::from_fn(|k, _| ((7 * row + 3 * target + k) as f64).sin());
            let wrong = if row == 50 && target == 1 { 0.01 } else { 0.0 };
            let position = device_from_base.act(&tip.act(place)) + noise + Vector3::x() * wrong;
            observation.measurement = Measurement::point(position);
            data.push_observation(&readings, observation).unwrap();
        }
    }
    let session = Session::from_dataset(&robot, data);
    let found = &session.file.suspected_configurations;
    println!("{found:?}");
    let rows: Vec<u32> = found.iter().map(|it| it.row).collect();
    assert!(rows.len() == 2 && rows.contains(&23) && rows.contains(&92), "{rows:?}");
    assert!(found.iter().all(|it| it.rows == 3 && it.targets == 3 && it.least_mm > 1.0));
    check_figures("elbow, configurations off", &session);
    assert!(session.page().contains("<b>2 configurations</b> all targets are off alike"));
}

#[test]
fn the_page_made_again_from_files_is_the_same() {
    let session = Session::new(&scara(), SessionKind::MIXED, 60);
    let inputs = Inputs { model: "robot.urdf".into(), ..Inputs::default() };
    let direct = CalibrationFile::new(&session.calibration, &session.data, inputs);
    let read = Residuals::parse(&session.residuals().text(), "residuals.csv").unwrap();
    let [first, again] =
        [calibration_page(&direct, &session.residuals()).unwrap(), calibration_page(&session.file, &read).unwrap()];
    assert!(first == again);
}

#[test]
fn names_are_no_markup() {
    let name = r#"</script><script>alert("1")</script><!--<b>'&"#;
    let plain = "plain";
    let page = |name: &str| {
        let z = Screw::revolute(&Vector3::z(), &Vector3::zeros());
        let y = Screw::revolute(&Vector3::y(), &Vector3::new(0.2, 0.0, 0.3));
        let joints = vec![Joint::revolute(name, z), Joint::revolute("elbow", y)];
        let mut robot = Robot::new(name, joints, Pose::from_translation(Vector3::new(0.5, 0.0, 0.3))).unwrap();
        robot.base_name = name.to_owned();
        robot.tip_name = name.to_owned();
        let mut made = Simulation { count: 40, ..Simulation::default() }.run(&robot, SessionKind::POSE).unwrap();
        made.data.files.push(name.into());
        made.data.targets[0] = Some(name.to_owned());
        made.data.ids = vec![name.to_owned(); made.data.len()];
        let mut session = Session::from_dataset(&robot, made.data);
        session.file.inputs.command = Some(format!("poecal calibrate {name}"));
        session.file.inputs.measurements = vec![name.to_owned()];
        session.page()
    };
    let (odd, usual) = (page(name), page(plain));
    for markup in ["<script", "</script", "<!--", "<b>"] {
        assert_eq!(odd.matches(markup).count(), usual.matches(markup).count(), "{markup}");
    }
    assert!(!odd.contains("alert(\"1\")"));
    let data = data_of(&odd);
    assert_eq!((&data["joints"][0]["name"], &data["targets"][0]["name"]), (&Value::from(name), &Value::from(name)));
}

#[test]
fn pages_are_small_and_long_sessions_are_thinned_and_said_so() {
    let mut sizes = Vec::new();
    for count in [500, 50_000] {
        let session = Session::new(&elbow(), SessionKind::POSE, count);
        let page = session.page();
        sizes.push(page.len());
        let data = data_of(&page);
        let drawn = numbers_of(&data["rows"]["line"]).len();
        println!("{count} rows: {} bytes, {drawn} rows drawn", page.len());
        assert_eq!((data["count"].as_u64(), drawn <= 4000), (Some(count as u64), true));
        assert_eq!(page.contains(&format!("Charts draw {drawn} of {count} rows")), count > 4000);
    }
    assert!(sizes[0] <= 2_500_000 && sizes[1] <= 5_000_000, "{sizes:?}");
}

#[test]
fn residuals_of_another_calibration_are_refused() {
    let session = Session::new(&elbow(), SessionKind::POINT, 60);
    let other = Session::new(&elbow(), SessionKind::POINT, 61);
    let error = calibration_page(&session.file, &other.residuals()).unwrap_err().to_string();
    assert!(error.contains("expected 42 and 18 as in the calibration"), "{error}");
    let other = Session::new(&scara(), SessionKind::POINT, 60);
    let error = calibration_page(&session.file, &other.residuals()).unwrap_err().to_string();
    assert!(error.contains("found residuals without the reading of `joint5`"), "{error}");
}

#[test]
fn residuals_that_were_changed_are_told_with_their_place() {
    let session = Session::new(&elbow(), SessionKind::POINT, 60);
    let text = session.residuals().text();
    // A message, and the character at its position: columns count characters.
    let refused = |text: &str| {
        let error = Residuals::parse(text, "residuals.csv").unwrap_err();
        let place = error.place().unwrap();
        let line = text.lines().nth(place.line.unwrap() - 1).unwrap();
        (error.to_string(), line.chars().skip(place.column.unwrap() - 1).collect::<String>())
    };
    for (old, new, expected) in [
        (",held_out,", ",maybe,", "found `maybe`, expected fit or held_out"),
        ("leverage", "pull", "found the column `pull`, expected `leverage`"),
        ("joint1[deg]", "joint1", "found the column `joint1`, expected a joint's name with [deg] or [mm]"),
    ] {
        let (error, rest) = refused(&text.replacen(old, new, 1));
        println!("{error}");
        assert!(rest.starts_with(new.trim_start_matches(',')), "{error}: {rest}");
        assert!(error.starts_with("residuals.csv:") && error.contains(expected), "{error}");
    }
    let cut = text.trim_end().rsplit_once(',').unwrap().0;
    let (error, rest) = refused(cut);
    assert!(error.contains("residuals.csv:61:") && error.contains(": found the end of the row"), "{error}");
    assert_eq!(rest, "");
    let (error, rest) = refused(&format!("{},7", text.trim_end()));
    assert!(error.contains("found `7`, expected no further cell") && rest == "7", "{error}: {rest}");
}
