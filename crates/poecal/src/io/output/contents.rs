//! Which files are whose: the names that each kind of run may write.

/// The report's name among the results.
pub const REPORT: &str = "report.html";
/// Every name that a calibration may write.
const CALIBRATION: [&str; 5] =
    ["calibration.json", "calibrated.urdf", "calibrated.toml", "residuals.csv", REPORT];
/// Every name that a simulated session may write.
const SIMULATION: [&str; 7] = [
    "nominal.urdf",
    "nominal.toml",
    "actual.urdf",
    "actual.toml",
    "measurements.csv",
    "held_out.csv",
    "truth.json",
];
/// Names that every project has.
pub(super) const PROJECT: [&str; 4] = ["measurements.csv", "joints.csv", "poecal.toml", "README.md"];
/// Names of its model, of which it has one.
const MODELS: [&str; 3] = ["robot.urdf", "robot.toml", "robot.json"];

/// What a folder is to hold.
///
/// ```
/// use poecal::io::output::Contents;
/// assert!(Contents::Calibration.is_own("report.html") && !Contents::Calibration.is_own("notes.txt"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contents {
    /// The results of a calibration.
    Calibration,
    /// A simulated session.
    Simulation,
    /// The report of a reproduction.
    Reproduction,
    /// A project to start from.
    Project,
}

impl Contents {
    /// Whether a run of any kind may have written a file of this name.
    pub(super) fn is_of_any(name: &str) -> bool {
        let all = [Contents::Calibration, Contents::Simulation, Contents::Reproduction, Contents::Project];
        all.into_iter().any(|contents| contents.is_own(name)) || MODELS.contains(&name)
    }

    /// Whether a file of this name is one that may be written, so that one of an earlier run goes.
    #[must_use]
    pub fn is_own(self, name: &str) -> bool {
        match self {
            Contents::Calibration => CALIBRATION.contains(&name),
            Contents::Simulation => SIMULATION.contains(&name),
            Contents::Reproduction => is_of_reproduction(name),
            Contents::Project => PROJECT.contains(&name),
        }
    }
}

/// Whether a reproduction may write a file of this name.
fn is_of_reproduction(name: &str) -> bool {
    let figure = name.strip_prefix("figure-").and_then(|rest| rest.strip_suffix(".svg"));
    ["report.html", "report.md", "results.json"].contains(&name)
        || figure.is_some_and(|figure| figure.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'))
}
