//! File names of each kind of run.

/// Name of the report among the results.
pub const REPORT: &str = "report.html";
/// File names of a calibration.
const CALIBRATION: [&str; 5] = ["calibration.json", "calibrated.urdf", "calibrated.toml", "residuals.csv", REPORT];
/// File names of a check.
const VALIDATION: [&str; 3] = ["validation.json", "errors.csv", REPORT];
/// File names of a simulated session.
const SIMULATION: [&str; 9] = [
    "nominal.urdf",
    "nominal.toml",
    "actual.urdf",
    "actual.toml",
    "measurements.csv",
    "held_out.csv",
    "joints.csv",
    "cameras.csv",
    "truth.json",
];
/// File names of a hand-eye calibration.
const HAND_EYE: [&str; 8] = [
    "hand_eye.json",
    "transforms.txt",
    "easy_handeye2.calib",
    "static_transform.launch.py",
    "opencv.yml",
    "rows.csv",
    "session.csv",
    "lens.csv",
];
/// File names of a tool's tip.
const TIP: [&str; 3] = ["tcp.json", "transforms.txt", "rows.csv"];
/// File names of every project.
pub(crate) const PROJECT: [&str; 6] =
    ["measurements.csv", "joints.csv", "poecal.toml", "README.md", "poses.csv", "touches.csv"];
/// Possible file names of its model, one of which it has.
const MODELS: [&str; 3] = ["robot.urdf", "robot.toml", "robot.json"];

/// Contents of an output folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contents {
    /// The results of a calibration.
    Calibration,
    /// A check of a calibration.
    Validation,
    /// A simulated session.
    Simulation,
    /// The report of a reproduction.
    Reproduction,
    /// Pose of a camera.
    HandEye,
    /// Position of a tool's tip.
    Tip,
    /// A project to start from.
    Project,
}

impl Contents {
    /// True if any kind of run writes files of this name.
    pub(crate) fn is_of_any(name: &str) -> bool {
        let all = [
            Contents::Calibration,
            Contents::Validation,
            Contents::Simulation,
            Contents::Reproduction,
            Contents::HandEye,
            Contents::Tip,
            Contents::Project,
        ];
        all.into_iter().any(|contents| contents.is_own(name)) || MODELS.contains(&name)
    }

    /// The file that identifies a folder of other contents, whose report would be replaced.
    pub(crate) fn of_others(self) -> Option<&'static str> {
        match self {
            Contents::Calibration => Some(VALIDATION[0]),
            Contents::Validation => Some(CALIBRATION[0]),
            Contents::Simulation | Contents::Reproduction | Contents::HandEye | Contents::Tip | Contents::Project => {
                None
            }
        }
    }

    /// True if these contents may have a file of this name; one of an earlier run is removed.
    #[must_use]
    pub fn is_own(self, name: &str) -> bool {
        match self {
            Contents::Calibration => CALIBRATION.contains(&name),
            Contents::Validation => VALIDATION.contains(&name),
            Contents::Simulation => SIMULATION.contains(&name) || is_picture(name),
            Contents::Reproduction => is_of_reproduction(name),
            Contents::HandEye => HAND_EYE.contains(&name),
            Contents::Tip => TIP.contains(&name),
            Contents::Project => PROJECT.contains(&name),
        }
    }
}

/// Name of a simulated picture.
pub(crate) fn picture_name(at: usize) -> String {
    format!("picture-{:03}.png", at + 1)
}

fn is_picture(name: &str) -> bool {
    let number = name.strip_prefix("picture-").and_then(|rest| rest.strip_suffix(".png"));
    number.is_some_and(|it| it.len() >= 3 && it.bytes().all(|c| c.is_ascii_digit()))
}

/// True if a reproduction may have a file of this name.
fn is_of_reproduction(name: &str) -> bool {
    let figure = name.strip_prefix("figure-").and_then(|rest| rest.strip_suffix(".svg"));
    ["report.html", "report.md", "results.json"].contains(&name)
        || figure.is_some_and(|figure| figure.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'))
}
