//! What programs say of the configuration at a pose.

use poecal_arm::Arm;

use super::fanuc::configuration::Configuration as Letters;
use super::krl::status::Status;
use super::rapid::configuration::Configuration as Quarters;

/// What a motion's text says of the configuration in which a pose is reached.
#[derive(Clone, Debug, PartialEq)]
pub enum Stated {
    /// Nothing: it is that to which a straight way leads from the motion before, or the nearest.
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

impl From<Status> for Stated {
    fn from(status: Status) -> Self {
        if status == Status::default() { Stated::Nothing } else { Stated::Krl(status) }
    }
}

impl Stated {
    /// Whether a configuration of the nominal arm (the model's readings, and the counted ones) fits the words, borders included.
    pub fn fits(&self, nominal: &Arm, (q, counted): &(Vec<f64>, Vec<f64>)) -> bool {
        match self {
            Stated::Nothing | Stated::Near(_) => true,
            Stated::Krl(status) => status.fits(nominal, q, counted),
            Stated::Rapid(configuration) => configuration.fits(counted),
            Stated::Fanuc(configuration) => configuration.fits(nominal, q, counted),
        }
    }

    /// Of several configurations that fit, whether one also fits the words that count where the others do not tell them apart.
    pub fn fits_best(&self, nominal: &Arm, q: &[f64]) -> bool {
        match self {
            Stated::Rapid(configuration) => configuration.branch_fits(nominal, q),
            Stated::Nothing | Stated::Near(_) | Stated::Krl(_) | Stated::Fanuc(_) => true,
        }
    }

    /// The words' numbers for a configuration of the nominal arm, in the order of the target's numbers behind its pose; `None` if words would
    /// have to change that are no numbers.
    pub fn words(&self, nominal: &Arm, (q, counted): &(Vec<f64>, Vec<f64>)) -> Option<Vec<f64>> {
        match self {
            Stated::Nothing | Stated::Near(_) => Some(Vec::new()),
            Stated::Krl(status) => Some(status.words(nominal, q, counted)),
            Stated::Rapid(configuration) => Some(configuration.words(counted)),
            Stated::Fanuc(configuration) => configuration.words(nominal, q, counted),
        }
    }
}
