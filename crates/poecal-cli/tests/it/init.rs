//! `poecal init` and the settings it writes: a project calibrates once its measurements are filled in.

use std::fs;

use poecal_model::robot::Robot;
use poecal_model::simulate::{gantry, scara, seven_axis};
use poecal_results::model::{Model, ModelFormat, ModelSource, convert};

use crate::folder::Folder;
use crate::session::{ROBOT, calibration};

/// Two chains from one base; the left one has a slide.
const TWO_ARMS: &str = r#"<robot name="two arms">
  <link name="base"/> <link name="lift"/> <link name="left arm"/> <link name="left tool"/> <link name="right"/>
  <joint name="turn, left" type="revolute"><parent link="base"/><child link="lift"/>
    <origin xyz="0 0.2 0.5"/><axis xyz="0 0 1"/><limit lower="-2.8" upper="2.8" effort="0" velocity="0"/></joint>
  <joint name="slide" type="prismatic"><parent link="lift"/><child link="left arm"/>
    <origin rpy="0 0.1 0"/><axis xyz="0 0 1"/><limit lower="0" upper="0.4" effort="0" velocity="0"/></joint>
  <joint name="hand" type="continuous"><parent link="left arm"/><child link="left tool"/>
    <origin xyz="0.5 0 0"/><axis xyz="1 0 0.2"/></joint>
  <joint name="reach" type="revolute"><parent link="base"/><child link="right"/><axis xyz="0 1 0"/></joint>
</robot>"#;

const DH: &str = r#"
poecal_robot = 1
name = "arm"
length_unit = "mm"
angle_unit = "deg"
convention = "standard_dh"
joint = [
  { name = "joint1", a = 25, alpha = -90, d = 400, limits = [-170, 170] },
  { name = "joint2", a = 455, theta = -90, limits = [-190, 45] },
  { name = "joint3", a = 35, alpha = -90, limits = [-120, 156] },
  { name = "joint4", d = 420, alpha = 90, limits = [-185, 185] },
  { name = "joint5", alpha = -90, limits = [-120, 120] },
  { name = "joint6", d = 80, limits = [-350, 350] },
]
[tool]
position = [30, 0, 60]
"#;

fn convert_robot(robot: Robot, form: ModelFormat) -> String {
    convert(&Model { robot, source: ModelSource::Toml, path: "robot".into() }, form).unwrap().text
}

/// The `poecal` commands of a project's README, without the program's name.
fn commands(readme: &str) -> Vec<&str> {
    readme.lines().filter_map(|line| line.trim_start().strip_prefix("poecal ")).collect()
}

/// Words as a shell splits them, without escapes: at blanks, except those between quotes.
fn words(command: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for (part, quoted) in command.split('\'').zip([false, true].into_iter().cycle()) {
        for (index, piece) in part.split(|c| c == ' ' && !quoted).enumerate() {
            if index > 0 {
                words.push(String::new());
            }
            words.last_mut().unwrap().push_str(piece);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Starts a project, fills its template with simulated rows, and types the commands of its README.
fn filled_project_calibrates(model: &str, text: &str, chain: &str, measure: &str) {
    let folder = Folder::new();
    folder.write(model, text);
    let run = |command: &str| {
        let run = folder.run_words(&words(command));
        assert_eq!(run.code, 0, "{model} {measure}: poecal {command}\n{}{}", run.out, run.err);
        run.out
    };
    run(&format!("init {model} --kind {measure} --out . {chain}"));
    let readme = folder.read("README.md");
    let typed = commands(&readme);
    let simulate = typed.iter().find(|command| command.starts_with("simulate ")).unwrap();
    run(&format!("{simulate} --held-out-count 30"));
    let rows = |name: &str| {
        let text = folder.read(name);
        let (_, table) = text.split_once('\n').unwrap();
        table.split_once('\n').map(|(header, rows)| (header.to_owned(), rows.to_owned())).unwrap()
    };
    let (header, measured) = rows("simulated/measurements.csv");
    let template = folder.read("measurements.csv");
    assert_eq!(template.lines().last(), Some(header.as_str()));
    folder.write("measurements.csv", template.clone() + &measured);
    folder.write("second-session.csv", template + &rows("simulated/held_out.csv").1);
    let steps: Vec<&str> = typed.iter().map(|command| command.split(' ').next().unwrap()).collect();
    assert_eq!(steps, ["plan", "check", "calibrate", "validate", "simulate"]);
    typed.iter().take(4).for_each(|command| {
        run(command);
    });
    let file = calibration(&folder, "poecal-out");
    let held_out = file.accuracy.held_out.unwrap();
    let (before, after) = (held_out.registered.position_mm().rms, held_out.calibrated.position_mm().rms);
    println!(
        "{model} {measure}: {before:.2} mm registered, {after:.4} mm calibrated, verdict {:?}",
        file.verdict.unwrap().level
    );
    // Noise of 0.05 mm in three coordinates is 0.087 mm; the rest is the uncertainty of few rows.
    assert!(after < 0.15 && before > 1.0, "{before} {after}");
    assert_eq!(file.inputs.measurements, ["measurements.csv"]);
}

#[test]
fn a_filled_project_calibrates_without_editing_anything_else() {
    let gantry = convert_robot(gantry(), ModelFormat::Urdf);
    let scara = convert_robot(scara(), ModelFormat::Toml);
    let seven = convert_robot(seven_axis(), ModelFormat::Urdf);
    for measure in ["points", "poses"] {
        filled_project_calibrates("elbow.urdf", ROBOT, "", measure);
        filled_project_calibrates("gantry.urdf", &gantry, "", measure);
        filled_project_calibrates("seven.urdf", &seven, "", measure);
        filled_project_calibrates("scara.toml", &scara, "", measure);
        filled_project_calibrates("dh.toml", DH, "", measure);
        filled_project_calibrates("arms.urdf", TWO_ARMS, "--tip-link 'left tool'", measure);
    }
}

#[test]
fn the_model_is_copied_as_it_is() {
    let folder = Folder::new();
    let text = format!("<?xml version=\"1.0\"?>\r\n<!-- mine -->\r\n{TWO_ARMS}");
    folder.write("arms.urdf", &text);
    let said = folder.run_words(&words("init arms.urdf --tip-link 'left tool' -o cell"));
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(
        said.out,
        "written       cell\n              robot.urdf, measurements.csv, joints.csv, poecal.toml, README.md\n\
         next          read cell/README.md: measure, fill in measurements.csv, and run\n              \
         `poecal calibrate` in that folder\n"
    );
    assert_eq!(folder.read("cell/robot.urdf"), text);
    assert!(folder.read("cell/poecal.toml").contains("\ntip_link = \"left tool\"\n"));
    let table = folder.read("cell/joints.csv");
    let rows: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!((rows[0], rows.len()), ("id,set,returns,\"turn, left[deg]\",slide[mm],hand[deg]", 61));
}

#[test]
fn a_project_overwrites_nothing() {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    folder.run_to_success("init robot.urdf --out cell");
    folder.write("cell/measurements.csv", "filled in");
    fs::remove_file(folder.path("cell/robot.urdf")).unwrap();
    let before = folder.listing();
    let refusals = [
        (
            "init robot.urdf --out cell",
            "error: cell/measurements.csv: found this file, expected none: a project never overwrites what may have been filled in, choose \
             another folder with --out\n",
        ),
        (
            "init robot.urdf --out robot.urdf",
            "error: robot.urdf: found a file, expected a folder for the project: choose another with --out\n",
        ),
        (
            "init robot.urdf --out new/cell",
            "error: new/cell: the folder above does not exist, expected one to write into: create it first\n",
        ),
        (
            "init nobody.urdf",
            "error: nobody.urdf: found no such file, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json): check the path\n",
        ),
    ];
    for (command, sentence) in refusals {
        let run = folder.run(command);
        assert_eq!((run.code, run.err.as_str()), (2, sentence), "{command}");
    }
    assert_eq!(folder.run("init robot.urdf --kind smells").code, 2);
    assert_eq!(folder.listing(), before);
}

/// A filled project in `cell`, below the folder.
fn project() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    folder.run_to_success("init robot.urdf --out cell");
    folder.run_to_success("simulate robot.urdf --kind point --out simulated");
    fs::copy(folder.path("simulated/measurements.csv"), folder.path("cell/measurements.csv")).unwrap();
    folder
}

#[test]
fn settings_are_seen_from_their_folder_and_give_way_to_what_is_typed() {
    let folder = project();
    folder.write(
        "cell/poecal.toml",
        "poecal_settings = 1\nmodel = 'robot.urdf'\nmeasurements = ['measurements.csv']\nout = 'there'\nseed = 4\nsigma_position = '0.05mm'\n",
    );
    folder.run_to_success("calibrate --settings cell/poecal.toml");
    let inputs = calibration(&folder, "cell/there").inputs;
    let command = "poecal calibrate --sigma-position=0.05mm --seed=4 cell/robot.urdf cell/measurements.csv";
    assert_eq!(inputs.command.as_deref(), Some(command));
    // The recorded command makes the same calibration, and a typed option replaces the one in the file.
    folder.run_to_success(&format!("{} --out again", command.strip_prefix("poecal ").unwrap()));
    assert_eq!(folder.read("again/residuals.csv"), folder.read("cell/there/residuals.csv"));
    folder.run_to_success("calibrate --settings cell/poecal.toml --seed 5 --out here robot.urdf");
    let inputs = calibration(&folder, "here").inputs;
    let command = "poecal calibrate --sigma-position=0.05mm --seed 5 robot.urdf cell/measurements.csv";
    assert_eq!(inputs.command.as_deref(), Some(command));
}

#[test]
fn files_are_checked_as_the_settings_say() {
    let folder = Folder::new();
    folder.write("arms.urdf", TWO_ARMS);
    let said = folder.run_words(&words("init arms.urdf --tip-link 'left tool' -o cell"));
    assert_eq!(said.code, 0, "{}", said.err);
    // The chain, the model and its measurements are those of the settings, of which the seed is none that `check` has.
    let settings = format!("{}\nseed = 3\n", folder.read("cell/poecal.toml"));
    folder.write("cell/poecal.toml", &settings);
    folder.write("cell/measurements.csv", "\"turn, left[deg]\",slide[mm],hand[deg],x[mm],y[mm],z[mm]\n1,2,3,4,5,6\n");
    let by_settings = folder.run_to_success("check --settings cell/poecal.toml");
    let typed = words("check cell/robot.urdf cell/measurements.csv --tip-link 'left tool'");
    assert_eq!(by_settings, folder.run_words(&typed).out);
    assert!(by_settings.contains("from base to left tool") && by_settings.contains("1: 1 point"), "{by_settings}");
    // Typed options take precedence.
    let run = folder.run("check --settings cell/poecal.toml --tip-link nowhere");
    assert!(run.code == 2 && run.err.contains("nowhere"), "{}", run.err);
    folder.write("cell/poecal.toml", settings.replace("left tool", "lost tool"));
    let run = folder.run("check --settings cell/poecal.toml");
    assert!(run.code == 2 && run.err.contains("lost tool"), "{}", run.err);
    folder.write("empty.toml", "poecal_settings = 1\n");
    let run = folder.run("check --settings empty.toml");
    assert_eq!(
        (run.code, run.err.as_str()),
        (2, "error: found no model, expected `poecal check MODEL FILES…`, or settings that name it\n")
    );
    let run = folder.run("check");
    assert!(run.code == 2 && run.err.contains("expected `poecal check MODEL FILES…`, or settings"), "{}", run.err);
}

#[test]
fn an_option_that_is_typed_replaces_settings_that_it_excludes() {
    let folder = project();
    folder.run_to_success("simulate robot.urdf --kind point --count 20 --noise 0.06mm --out other");
    let settings =
        "poecal_settings = 1\nmodel = 'robot.urdf'\nmeasurements = ['measurements.csv']\ntrain_where = 'stage=1'\n";
    folder.write("cell/poecal.toml", settings);
    assert_eq!(folder.run("calibrate --settings cell/poecal.toml").code, 2);
    folder.run_to_success("calibrate --settings cell/poecal.toml --validate other/measurements.csv");
}

#[test]
fn mistakes_in_settings_are_told_with_line_and_column() {
    let folder = project();
    let usual = "poecal_settings = 1\nmodel = 'robot.urdf'\nmeasurements = ['measurements.csv']\n";
    let cases = [
        (
            "sigma-position = '0.05mm'",
            "4:1: found the key `sigma-position`, expected a setting: the nearest is `sigma_position`",
        ),
        ("verbatim = true", "4:1: found the key `verbatim`, expected a setting: there are "),
        (
            "sigma_position = 0.05",
            "4:18: sigma_position: found `0.05` without a unit, expected a number with a unit, like 0.05mm",
        ),
        ("robust = 'sturdy'", "4:10: robust: found `sturdy`, expected one of auto, off, huber, cauchy, tukey"),
        ("force = 'yes'", "4:9: found a value for `force`, expected true or false"),
        ("seed = [1, 2]", "4:8: found a list for `seed`, expected one value"),
        ("seed = true", "4:8: found true or false for `seed`, expected a value"),
        ("seed = 1\nseed = 2", "5:1: duplicate key"),
    ];
    for (line, sentence) in cases {
        folder.write("cell/poecal.toml", format!("{usual}{line}\n"));
        let run = folder.run("calibrate --settings cell/poecal.toml");
        let start = format!("error: cell/poecal.toml:{sentence}");
        assert!(run.code == 2 && run.err.starts_with(&start), "{line}: {} {}", run.code, run.err);
    }
    folder.write("cell/poecal.toml", "model = 'robot.urdf'\n");
    let run = folder.run("calibrate --settings cell/poecal.toml");
    assert!(run.err.contains("found no `poecal_settings = 1`"), "{}", run.err);
    let run = folder.run("calibrate");
    assert!(
        run.code == 2 && run.err.contains("found neither a model among the arguments nor this file"),
        "{}",
        run.err
    );
    let run = folder.run("calibrate robot.urdf");
    assert!(run.code == 2 && run.err.starts_with("error: found no measurement file, expected"), "{}", run.err);
}
