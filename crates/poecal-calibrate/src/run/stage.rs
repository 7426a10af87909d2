//! Steps of a calibration, for progress messages.

/// A step of a calibration, for progress messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Fitting device frame and targets.
    Registration,
    /// Fitting the screws.
    Fit,
    /// Fitting joint effects beyond geometry.
    Corrections,
    /// Judging the models.
    Analysis,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 4] = [Stage::Registration, Stage::Fit, Stage::Corrections, Stage::Analysis];

    /// Message for users.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Stage::Registration => "finding the device frame and the targets",
            Stage::Fit => "fitting the screws",
            Stage::Corrections => "fitting what the joints do beyond geometry",
            Stage::Analysis => "judging the result",
        }
    }
}
