//! Lines of sight: instruments and targets of a robot, and the joints between them.

use serde::Serialize;

use poecal_fit::analysis::{KinematicPath, ways};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::first_few;

/// The kinematic chains from instruments to targets, and joints on none of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct SightCheck {
    ways: Vec<KinematicPath>,
    /// Joints on no such chain: measurements cannot determine their axes.
    unseen: Vec<String>,
}

impl SightCheck {
    /// Chains of the measurements, else of everything that the model names. `None` for a chain from base to tip alone.
    pub(crate) fn from_robot(robot: &Robot, data: Option<&Dataset>) -> Option<Self> {
        if robot.is_serial() && robot.instruments.is_empty() && robot.mounted.is_empty() {
            return None;
        }
        let ways = ways(robot, data);
        let is_unseen = |name: &&String| !ways.iter().any(|way| way.joints.contains(name));
        let unseen = robot.joints.iter().map(|joint| &joint.name).filter(is_unseen).cloned().collect();
        Some(SightCheck { ways, unseen })
    }

    pub(crate) fn words(&self) -> impl Iterator<Item = String> {
        self.ways.iter().map(words)
    }

    pub(crate) fn unseen_words(&self) -> Option<String> {
        let words =
            || format!("{}: no way passes them, so that nothing determines their axes", first_few(&self.unseen));
        (!self.unseen.is_empty()).then(words)
    }
}

fn words(way: &KinematicPath) -> String {
    let instrument = way.instrument.as_deref().unwrap_or("the device beside the robot");
    let target = way.target.as_deref().unwrap_or("the tip");
    let joints = if way.joints.is_empty() { "no joint".to_owned() } else { way.joints.join(", ") };
    let rows = match way.rows {
        Some(1) => " (1 row)".to_owned(),
        Some(rows) => format!(" ({rows} rows)"),
        None => String::new(),
    };
    format!("{instrument} to {target}: {joints}{rows}")
}
