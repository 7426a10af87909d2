//! Configuration at a pose, as programs state it.

use poecal_arm::Arm;

use super::fanuc::configuration::FanucConfiguration as Letters;
use super::krl::status::Status;
use super::rapid::configuration::RapidConfiguration as Quarters;

/// Configuration in which a pose is reached, as the text of a motion states it.
#[derive(Clone, Debug, PartialEq)]
pub enum StatedConfiguration {
    /// No statement: a straight path from the motion before determines it, else the nearest one applies.
    Nothing,
    /// The nearest to this configuration, in the order of the robot's readings (rad).
    Near(Vec<f64>),
    /// Status and turn of KRL.
    Krl(Status),
    /// Quarter turns and branch of RAPID.
    Rapid(Quarters),
    /// Letters and turn numbers of FANUC.
    Fanuc(Letters),
}

impl From<Status> for StatedConfiguration {
    fn from(status: Status) -> Self {
        if status == Status::default() { StatedConfiguration::Nothing } else { StatedConfiguration::Krl(status) }
    }
}

impl StatedConfiguration {
    /// True if a configuration of the nominal arm (the model's readings, and the counted ones) fits the words, borders included.
    pub fn fits(&self, nominal: &Arm, (q, counted): &(Vec<f64>, Vec<f64>)) -> bool {
        match self {
            StatedConfiguration::Nothing | StatedConfiguration::Near(_) => true,
            StatedConfiguration::Krl(status) => status.fits(nominal, q, counted),
            StatedConfiguration::Rapid(configuration) => configuration.fits(counted),
            StatedConfiguration::Fanuc(configuration) => configuration.fits(nominal, q, counted),
        }
    }

    /// True if a configuration, among several that fit, also fits the words with the lowest precedence.
    pub fn fits_best(&self, nominal: &Arm, q: &[f64]) -> bool {
        match self {
            StatedConfiguration::Rapid(configuration) => configuration.branch_fits(nominal, q),
            StatedConfiguration::Nothing
            | StatedConfiguration::Near(_)
            | StatedConfiguration::Krl(_)
            | StatedConfiguration::Fanuc(_) => true,
        }
    }

    /// The words' numbers for a configuration of the nominal arm, in the order of the target's numbers behind its pose. `None` if words other than
    /// numbers would have to change.
    pub fn words(&self, nominal: &Arm, (q, counted): &(Vec<f64>, Vec<f64>)) -> Option<Vec<f64>> {
        match self {
            StatedConfiguration::Nothing | StatedConfiguration::Near(_) => Some(Vec::new()),
            StatedConfiguration::Krl(status) => Some(status.words(nominal, q, counted)),
            StatedConfiguration::Rapid(configuration) => Some(configuration.words(counted)),
            StatedConfiguration::Fanuc(configuration) => configuration.words(nominal, q, counted),
        }
    }
}
