//! Losses that bound the effect of a single row (theory.md §6 (34b)).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Loss of robust estimation, a function of the length of a row's whitened residual. Its constant leads to 95 % efficiency under normal noise of that
/// many components.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::Loss;
/// # }
/// use poecal::Loss;
/// assert_eq!(Loss::Huber.weight(0.5, 3), 1.0);
/// assert_eq!(Loss::Tukey.weight(50.0, 3), 0.0);
/// assert!(Loss::Cauchy.weight(50.0, 3) < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Loss {
    /// Linear beyond a bound: one minimum, and every row has some influence.
    Huber,
    /// The influence of a row decreases with its residual, but never vanishes.
    Cauchy,
    /// The bisquare: beyond its bound a row has no influence at all.
    Tukey,
}

/// Constants for residuals of 1 to 6 components: efficiency 95 %.
const HUBER: [f64; 6] = [1.345, 1.51, 1.63, 1.73, 1.81, 1.87];
const CAUCHY: [f64; 6] = [2.385, 2.549, 2.666, 2.752, 2.815, 2.862];
const TUKEY: [f64; 6] = [4.685, 5.123, 5.490, 5.810, 6.096, 6.356];

impl Loss {
    /// Weight of a row whose whitened residual of `components` numbers (1 to 6) has this length: theory.md §6 (34b).
    #[must_use]
    pub fn weight(self, length: f64, components: usize) -> f64 {
        let constants = match self {
            Loss::Huber => &HUBER,
            Loss::Cauchy => &CAUCHY,
            Loss::Tukey => &TUKEY,
        };
        let ratio = length / constants[components.clamp(1, 6) - 1];
        match self {
            Loss::Huber => (1.0 / ratio).min(1.0),
            Loss::Cauchy => 1.0 / (1.0 + ratio * ratio),
            Loss::Tukey => (1.0 - ratio * ratio).max(0.0).powi(2),
        }
    }

    /// The stable word used in files and on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Loss::Huber => "huber",
            Loss::Cauchy => "cauchy",
            Loss::Tukey => "tukey",
        }
    }
}

/// Loss of a calibration.
///
/// ```
/// assert_eq!(poecal_calibrate::RobustLoss::default(), poecal_calibrate::RobustLoss::Auto);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RobustLoss {
    /// Least squares, unless outliers are evident: then Tukey's loss, and a warning reports it.
    #[default]
    Auto,
    /// Least squares.
    Off,
    /// Always this loss.
    Loss(Loss),
}
