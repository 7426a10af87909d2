//! Project folders, to begin a calibration with.

use std::ops::RangeInclusive;

use super::output_folder::taken_error;
use super::{NewFile, ReservedFolder, WrittenFiles, write_files};
use crate::model::{Model, ModelSource};
use crate::shapes::capsules_of;
use poecal_fit::analysis::PlannedSession;
use poecal_formats::urdf::ChainSelection;
use poecal_import::{plan as random_list, planned_table, template};
use poecal_model::measurement::{Device, SessionKind};
use poecal_numerics::error::Result;
use poecal_numerics::text::escape_invisible;
use poecal_plan::plan::{Conditions, PlanOptions, PlannedFit, plan, returns_of};
use poecal_storage::{disk, source_text};

const SETTINGS: &str = include_str!("project/poecal.toml");
const README: &str = include_str!("project/README.md");

/// Numbers of rows that are planned: fewer leave no choice, and with more all lists are similar.
const PLANNED_ROWS: RangeInclusive<usize> = 8..=200;
/// Number of candidates of a list: few, since it is a first list. Beyond eight joints it falls with the square of their number, by which the time for
/// each grows.
fn candidates(joints: usize) -> usize {
    (400 * 8 * 8 / joints.max(8).pow(2)).max(100)
}

/// Contents of a project folder.
#[derive(Clone, Copy, Debug)]
pub struct Project<'a> {
    /// The robot's model.
    pub model: &'a Model,
    /// Selected chain of the model.
    pub chain: &'a ChainSelection,
    /// Kind of the measurements.
    pub kind: SessionKind,
    /// Number of suggested configurations.
    pub count: usize,
    /// Seed of their choice.
    pub seed: u64,
}

impl Project<'_> {
    fn model_name(&self) -> &'static str {
        match self.model.source {
            ModelSource::Urdf(_) => "robot.urdf",
            ModelSource::Toml => "robot.toml",
            ModelSource::Calibration(_) => "robot.json",
        }
    }

    fn files(&self) -> Result<Vec<NewFile<'static>>> {
        let robot = &self.model.robot;
        // Copied with its comments, not written from the parsed model.
        let model = match &self.model.source {
            ModelSource::Urdf(document) => document.text().to_owned(),
            ModelSource::Toml | ModelSource::Calibration(_) => source_text::read(&self.model.path, "a robot model")?,
        };
        Ok(vec![
            NewFile::new(self.model_name(), model),
            NewFile::new("measurements.csv", template(robot, self.kind)?),
            NewFile::new("joints.csv", self.list()?),
            NewFile::new("poecal.toml", self.fill_names(SETTINGS)),
            NewFile::new("README.md", self.fill_names(README)),
        ])
    }

    /// Configurations to measure: planned ones, some random ones for validation, and returns to the first. If none can be planned, random ones.
    fn list(&self) -> Result<String> {
        let robot = &self.model.robot;
        let rows = self.count - returns_of(self.count);
        let judge = rows / 4;
        if !self.kind.is_chosen_freely() || !PLANNED_ROWS.contains(&rows) {
            return random_list(robot, self.count, self.seed);
        }
        let usual = PlannedFit::default();
        let session = PlannedSession { kind: self.kind, ..usual.session };
        let options = PlanOptions {
            fit: PlannedFit { session, count: rows - judge, robot_error: self.model.left_error(), ..usual },
            judge: Some(judge),
            candidates: candidates(robot.joints.len()),
            conditions: Conditions { capsules: capsules_of(self.model).0, ..Conditions::default() },
            with_curve: false,
            seed: self.seed,
            ..PlanOptions::default()
        };
        // A robot without a possible plan gets a list too.
        let Ok(found) = plan(robot, &options) else { return random_list(robot, self.count, self.seed) };
        planned_table(robot, &found)
    }

    /// A text with the project's names filled in.
    fn fill_names(&self, text: &str) -> String {
        let links = [("base_link", &self.chain.base_link), ("tip_link", &self.chain.tip_link)];
        let links = || links.into_iter().filter_map(|(key, link)| Some((key, link.as_ref()?)));
        let line = |(key, link): (&str, &String)| format!("{key} = {}\n", toml::Value::String(link.clone()));
        let option =
            |key: &str, value: &str| format!(" --{} '{}'", key.replace('_', "-"), value.replace('\'', "'\\''"));
        let words = |(key, link): (&str, &String)| option(key, link);
        let named = [("instrument", &self.chain.instruments), ("target", &self.chain.targets)];
        let pairs = |mounts: &[(String, String)]| -> Vec<String> {
            mounts.iter().map(|(name, link)| format!("{name}={link}")).collect()
        };
        let lists = named.iter().filter(|(_, mounts)| !mounts.is_empty()).map(|(key, mounts)| {
            let values = pairs(mounts).into_iter().map(toml::Value::String).collect();
            format!("{key} = {}\n", toml::Value::Array(values))
        });
        let typed =
            named.iter().flat_map(|(key, mounts)| pairs(mounts).into_iter().map(move |pair| option(key, &pair)));
        let orientation = if self.kind.sees_orientation() { ROTATION_NOISE } else { "" };
        let session = self.kind.session();
        let touching = match session.function.device {
            Device::Socket => KNOWN_DISTANCE,
            Device::Plane if session.columns.contains(&"contact") => CONTACT,
            Device::Instrument | Device::Anchor | Device::Plane | Device::Sphere | Device::Direction | Device::Pair => {
                ""
            }
        };
        let name = escape_invisible(&self.model.robot.name).into_owned();
        let replaced = [
            ("{before measuring}", (if self.kind.is_touched() { TOUCHED } else { PLANNED }).to_owned()),
            ("{model}", self.model_name().to_owned()),
            ("{chain}\n", links().map(line).chain(lists).collect()),
            ("{chain options}", links().map(words).chain(typed).collect()),
            ("{rotation noise}\n", orientation.to_owned()),
            ("{touching}\n", touching.to_owned()),
            ("{kind}", self.kind.word().to_owned()),
            ("{count}", self.count.to_string()),
            ("{robot}", name),
        ];
        replaced.iter().fold(text.to_owned(), |text, (place, words)| text.replace(place, words))
    }
}

/// First step of the instructions.
const PLANNED: &str = "1. **Before measuring**: which unknowns would these configurations determine, and with which expected error? `poecal plan` chooses \
others: with your reflector's place, the device, and what is in the way.\n\n   ```sh\n   poecal plan {model} --rows joints.csv --kind {kind}{chain options}\n   ```";
/// The same step if something is touched: random configurations do not touch it.
const TOUCHED: &str = "1. **Before measuring**: `joints.csv` has random configurations, to start from; in each, the robot must then be led to what it \
touches. When a dozen rows are in `measurements.csv`, ask which unknowns they determine, and what is missing.\n\n   ```sh\n   \
poecal plan {model} --rows measurements.csv --kind {kind}{chain options}\n   ```";

const KNOWN_DISTANCE: &str = "# The known distance of the two sockets of each place; without it the size of the robot is not determined.\n#socket_distance = \"50mm\"\n\n";
const CONTACT: &str =
    "# Kind of contact for rows whose `contact` cell is empty: \"point\" or \"flush\".\n#contact = \"flush\"\n\n";

const ROTATION_NOISE: &str = "# And of the measured rotation about each axis.\n#sigma_rotation = \"0.01deg\"\n\n";

/// Writes a project folder: the model, an empty measurement file with this robot's columns, configurations to measure, settings for `poecal
/// calibrate`, and instructions. The folder may exist; files in it are never replaced.
///
/// # Errors
/// [`ErrorKind::File`](poecal_numerics::error::ErrorKind::File) if one of the files exists or cannot be written;
/// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) if a joint has the name of a measured column. Nothing is left behind then.
pub fn write_project(place: ReservedFolder, project: &Project) -> Result<WrittenFiles> {
    let model = place.named.join(project.model_name());
    if disk::current_disk().look(&model).is_ok() {
        return Err(taken_error(&model));
    }
    write_files(place, &project.files()?, None, Vec::new())
}
