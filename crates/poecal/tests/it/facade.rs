//! Public interface of the library: the names that it re-exports from its parts, and few types, each with an example that runs.

use std::fs;
use std::path::{Path, PathBuf};

/// Most types that a reader of the documentation meets.
const MOST: usize = 70;

/// All public names at the root. An added or removed name is a change for users: a line in CHANGELOG.md.
const ROOT: &[(&str, &[&str])] = &[
    ("poecal_arm", &["AllBranches", "Arm", "Branches", "HeldBranches", "lie"]),
    (
        "poecal_calibrate",
        &[
            "Accuracy",
            "CalibratedTarget",
            "Calibration",
            "CalibrationOptions",
            "DeviceFrameKnowledge",
            "Formulation",
            "Judgement",
            "Loss",
            "ModelAccuracy",
            "RobustLoss",
            "SetAccuracy",
            "Statistic",
            "Trust",
            "Verdict",
            "calibrate",
            "judge",
        ],
    ),
    ("poecal_fit::analysis", &["Direction", "ExpectedUncertainty", "Identifiability", "PlannedSession", "identify"]),
    ("poecal_fit::forensics", &["Diagnosis"]),
    ("poecal_formats::urdf", &["ChainSelection"]),
    ("poecal_import", &["MeasurementFile", "ReadOptions", "read as read_measurements"]),
    ("poecal_model", &["simulate"]),
    (
        "poecal_model::measurement",
        &["Dataset", "SessionKind", "MeasuredQuantities", "Measurement", "Noise", "Observation", "Quantity", "Set"],
    ),
    ("poecal_model::robot", &["Joint", "JointKind", "JointLimits", "Reading", "Robot", "Tolerance"]),
    ("poecal_model::simulate", &["SimulationResult", "Simulation"]),
    ("poecal_numerics", &["solve"]),
    ("poecal_numerics::error", &["Choices", "Error", "ErrorKind", "Result"]),
    ("poecal_report", &["calibration_page", "summary"]),
    ("poecal_results::calibration_file", &["CalibrationFile", "Inputs"]),
    ("poecal_results::model", &["Model", "ModelFormat", "ModelSource"]),
    ("poecal_results::predictions", &["PredictedPoses", "PredictionFrame", "predict_readings"]),
    ("poecal_results::residuals", &["Residuals"]),
];

/// Modules among them, whose own names are shown too.
const MODULES: [&str; 3] = ["poecal_arm::lie", "poecal_model::simulate", "poecal_numerics::solve"];

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The folder or the file of a module: `poecal_fit::analysis`.
fn place(module: &str) -> PathBuf {
    let (name, within) = module.split_once("::").unwrap_or((module, ""));
    let folder = crates().join(name.replace('_', "-")).join("src").join(within.replace("::", "/"));
    if folder.is_dir() { folder } else { folder.with_extension("rs") }
}

/// The names that a file re-exports by `pub use`, except hidden ones, with the module of each.
fn handed_on(file: &Path) -> Vec<(String, String)> {
    let text = fs::read_to_string(file).unwrap();
    let mut found = Vec::new();
    for (at, _) in text.match_indices("\npub use ") {
        let before = text[..at].lines().next_back().unwrap_or_default();
        if before == "#[doc(hidden)]" {
            continue;
        }
        let tree = text[at + "\npub use ".len()..].split_once(';').unwrap().0;
        let (module, names) = tree.rsplit_once("::").filter(|_| !tree.contains('{')).unwrap_or_else(|| {
            let (module, names) = tree.split_once("::{").unwrap();
            (module, names.trim_end_matches('}'))
        });
        let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
        found.extend(names.map(|name| (module.to_owned(), name.to_owned())));
    }
    found.sort();
    found
}

/// The documentation above the declaration of a type, below a folder or in a file.
fn documentation(place: &Path, name: &str) -> Option<String> {
    if place.is_dir() {
        let mut paths: Vec<PathBuf> = fs::read_dir(place).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        return paths.iter().find_map(|path| documentation(path, name));
    }
    let text = fs::read_to_string(place).ok()?;
    let lines: Vec<&str> = text.lines().collect();
    let declares = |line: &str| {
        let rest = ["pub struct ", "pub enum ", "pub trait ", "pub type "];
        let rest = rest.iter().find_map(|word| line.strip_prefix(word));
        rest.is_some_and(|rest| rest.split(|c: char| !c.is_alphanumeric()).next() == Some(name))
    };
    let at = lines.iter().position(|line| declares(line))?;
    let last = lines[..at].iter().rposition(|line| line.starts_with("///"))?;
    let first = lines[..=last].iter().rposition(|line| !line.starts_with("///")).map_or(0, |line| line + 1);
    Some(lines[first..=last].join("\n"))
}

/// A path in a module's form, completed with its crate.
fn absolute_path(module: &str, from: &str) -> String {
    let own = module.split("::").next().unwrap_or_default();
    match from.split_once("::").unwrap_or((from, "")) {
        ("crate", rest) => format!("{own}::{rest}"),
        (first, _) if first.starts_with("poecal_") => from.to_owned(),
        _ => module.to_owned(),
    }
}

#[test]
fn the_root_hands_on_these_names_and_has_none_of_its_own() {
    let file = crates().join("poecal/src/lib.rs");
    let mut expected: Vec<(String, String)> = Vec::new();
    for (module, names) in ROOT {
        expected.extend(names.iter().map(|name| ((*module).to_owned(), (*name).to_owned())));
    }
    expected.sort();
    let found = handed_on(&file);
    println!("{} names are public", found.len());
    assert_eq!(found, expected);
    let text = fs::read_to_string(file).unwrap();
    let own = text.lines().filter(|line| line.starts_with("pub") && !line.starts_with("pub use "));
    assert_eq!(own.collect::<Vec<_>>(), Vec::<&str>::new(), "the library's code stands in its parts");
    assert!(!text.contains("doc(hidden)"), "hidden names are still public");
}

#[test]
fn few_types_are_shown_and_each_has_an_example() {
    let mut shown = handed_on(&crates().join("poecal/src/lib.rs"));
    for module in MODULES {
        let (from, name) = module.rsplit_once("::").unwrap();
        assert!(shown.contains(&(from.to_owned(), name.to_owned())), "{module}");
        let own = handed_on(&place(module).join("mod.rs"));
        shown.extend(own.into_iter().map(|(from, name)| (absolute_path(module, &from), name)));
    }
    shown.push(("poecal_numerics::solve".into(), "LeastSquares".into()));
    for (_, name) in &mut shown {
        name.truncate(name.find(" as ").unwrap_or(name.len()));
    }
    shown.retain(|(_, name)| name.starts_with(char::is_uppercase));
    shown.sort_by(|a, b| a.1.cmp(&b.1));
    shown.dedup_by(|a, b| a.1 == b.1);
    let has_example = |(module, name): &(String, String)| {
        documentation(&place(module), name).is_some_and(|text| text.contains("```"))
    };
    let without: Vec<_> = shown.iter().filter(|it| !has_example(it)).collect();
    assert!(without.is_empty(), "no example, or no documentation, of {without:?}");
    println!("{} types are shown", shown.len());
    assert!(shown.len() <= MOST, "{} types: hide what few need", shown.len());
}
