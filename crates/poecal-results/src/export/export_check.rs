//! Result of an export: its text, read back and compared.

use crate::model::Model;
use poecal_formats::proof::Difference;
use poecal_formats::urdf::ChainSelection;
use poecal_model::robot::{MEASURED, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// A robot in a form.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedRobot {
    /// The whole text.
    pub text: String,
    /// Losses of the form, and additions, a sentence each.
    pub notes: Vec<String>,
    /// Largest difference of the tip on 1,000 configurations between the text read back and the robot without terms of its joints.
    pub remains: Difference,
    /// Properties of the joints that the form cannot hold, as a separate text: terms of their values, with formulas. `None` if there are none.
    pub beside: Option<String>,
}

/// Configurations of the comparison.
pub(crate) const CONFIGURATIONS: usize = 1000;

/// Largest difference (metres for a robot of a metre, radians) of a form that can carry the geometry.
pub(crate) const SAME: f64 = 1e-9;

/// A text, and the robot that is read from it; the properties that its form cannot hold are in notes.
pub(crate) struct ExportedText {
    pub(crate) text: String,
    pub(crate) notes: Vec<String>,
    pub(crate) proof: Proof,
}

/// Comparison of a text with the robot.
pub(crate) enum Proof {
    /// It carries the geometry: the robot that was read back, which must be the same.
    Again(Box<Robot>),
    /// It cannot carry every geometry, and states what remains.
    Remains(Difference),
}

/// Deviation of a robot that was read back.
pub(crate) fn remaining_difference(robot: &Robot, again: &Robot) -> Difference {
    Difference::from_robots(robot, again, CONFIGURATIONS)
}

/// The robot that the reader of models finds in a text, as a file of this name, between two links.
pub(crate) fn read_back(text: &str, name: &str, ends: Option<(&str, &str)>) -> Result<Robot> {
    let selection = match ends {
        Some((base, tip)) => ChainSelection {
            base_link: Some(base.to_owned()),
            tip_link: Some(tip.to_owned()),
            ..ChainSelection::default()
        },
        None => ChainSelection::default(),
    };
    let read = Model::parse(text, name, &selection);
    read.map(|model| model.robot).map_err(|error| unreadable_error(&format!("a fault ({})", error.message())))
}

/// True if a difference from a robot is rounding.
pub(crate) fn is_same(robot: &Robot, remains: &Difference) -> bool {
    remains.is_within(SAME * robot.reach_m().max(1.0), SAME)
}

/// A note on targets that the form does not name; the position of a target without a name is in every table of a calibration.
pub(crate) fn left_out(robot: &Robot) -> Option<String> {
    let names = robot.targets.iter().map(|(name, _)| name.as_str());
    let names: Vec<&str> = names.filter(|name| *name != MEASURED).collect();
    (!names.is_empty()).then(|| {
        format!("the targets {} are not in this form; calibration.json has them in the tip's frame", names.join(", "))
    })
}

/// An error of a form that cannot hold a robot.
pub(crate) fn export_error(message: String) -> Error {
    ErrorKind::Export.error(message)
}

/// An error of a text that was just written and cannot be read.
pub(crate) fn unreadable_error(what: &str) -> Error {
    export_error(format!("the text that was written has {what}: nothing was written"))
}
