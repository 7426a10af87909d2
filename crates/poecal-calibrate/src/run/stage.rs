//! Steps of a calibration, for progress messages.

/// A step of a calibration, for progress messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationStage {
    /// Fitting device frame and targets.
    Registration,
    /// Fitting the screws.
    Fit,
    /// Fitting joint effects beyond geometry.
    Corrections,
    /// Judging the models.
    Analysis,
}

impl CalibrationStage {
    /// All stages in order.
    pub const ALL: [CalibrationStage; 4] = [
        CalibrationStage::Registration,
        CalibrationStage::Fit,
        CalibrationStage::Corrections,
        CalibrationStage::Analysis,
    ];

    /// Message for users.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            CalibrationStage::Registration => "finding the device frame and the targets",
            CalibrationStage::Fit => "fitting the screws",
            CalibrationStage::Corrections => "fitting what the joints do beyond geometry",
            CalibrationStage::Analysis => "judging the result",
        }
    }
}
