//! Clocks of instruments in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_calibrate::Calibration;
use poecal_fit::parameters::Parameter;
use poecal_fit::state::ClockTerm;
use poecal_fit::uncertainty::Uncertainty;
use poecal_model::measurement::Dataset;

/// The clock of an instrument whose rows were measured in motion, relative to that of the joint readings. A measurement at its time t belongs to the
/// readings at `t - lag - drift (t - middle)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClockEntry {
    /// Name of the instrument, if the measurements name it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instrument: Option<String>,
    /// Time of the instrument less that of the joint readings in the middle of the recording, seconds.
    pub lag_s: f64,
    /// Its standard deviation, milliseconds; absent where the lag was held, and without more residuals than unknowns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_lag_ms: Option<f64>,
    /// Growth of the lag, parts per million.
    pub drift_ppm: f64,
    /// Its standard deviation; absent as for the lag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_drift_ppm: Option<f64>,
    /// The middle of the recording by the clock of the instrument, seconds.
    pub middle_s: f64,
}

impl ClockEntry {
    /// Entries of a calibration; empty if nothing was measured in motion.
    pub(crate) fn all_from_calibration(calibration: &Calibration, data: &Dataset) -> Vec<Self> {
        let found = calibration.trust.uncertainty.as_ref();
        let entry = |clock: &poecal_model::measurement::Clock| {
            let change = found.map(|it| it.estimate.clock(clock.station)).unwrap_or_default();
            let sigma = |term| sigma(found?, clock.station, term);
            ClockEntry {
                instrument: data.stations.get(clock.station).cloned().flatten(),
                lag_s: clock.lag_s + change.lag_s,
                sigma_lag_ms: sigma(ClockTerm::Lag).map(|it| 1e3 * it),
                drift_ppm: 1e6 * (clock.drift + change.drift),
                sigma_drift_ppm: sigma(ClockTerm::Drift).map(|it| 1e6 * it),
                middle_s: clock.middle_s,
            }
        };
        data.moving.clocks.iter().map(entry).collect()
    }
}

/// Standard deviation of an unknown of a clock.
fn sigma(found: &Uncertainty, station: usize, term: ClockTerm) -> Option<f64> {
    let is_it =
        |it: &Parameter| matches!(it, Parameter::ClockUnknown(own) if (own.station, own.term) == (station, term));
    let (_, places) = found.layout.parameters().find(|(parameter, _)| is_it(parameter))?;
    let (place, scale) = *places.first()?;
    let variance = found.covariance.get(place * (found.layout.dim() + 1))?;
    Some(variance.max(0.0).sqrt() / scale)
}
