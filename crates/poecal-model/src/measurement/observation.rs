//! One row of a session.

use serde::{Deserialize, Serialize};

use super::{ByQuantity, Measurement, Noise, StatedDeviations};

/// Set of a row: training or held out.
///
/// ```
/// # use poecal_model::measurement::{SessionKind, Set};
/// # use poecal_model::simulate::{Simulation, elbow};
/// let mut data = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?.data;
/// for (row, observation) in data.observations.iter_mut().enumerate() {
///     observation.set = Some(if row < 30 { Set::Fit } else { Set::HeldOut });
/// }
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Set {
    /// Used to fit.
    Fit,
    /// Held out to judge the fit.
    HeldOut,
}

/// Source of a row: index into [`Dataset::files`](crate::measurement::Dataset::files) and line (from 1; 0 if it has none).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct RowLocation {
    /// Index into [`Dataset::files`](crate::measurement::Dataset::files).
    pub file: u32,
    /// Line in that file, from 1.
    pub line: u32,
}

/// One row: a measurement of a target, with its noise, set and source.
///
/// ```
/// # use poecal_model::measurement::{Dataset, Measurement};
/// # use nalgebra::Vector3;
/// let mut data = Dataset::new(vec!["joint1".into()]);
/// let seen = Measurement::point(Vector3::new(0.1, 0.2, 0.3));
/// data.push(&[0.1], Some("ball"), seen)?;
/// assert_eq!((data.observations[0].target, &data.targets[0]), (0, &Some("ball".to_owned())));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// Index into [`Dataset::targets`](crate::measurement::Dataset::targets).
    pub target: usize,
    /// Index into [`Dataset::stations`](crate::measurement::Dataset::stations); 0 if there is one device frame only.
    #[serde(default)]
    pub station: usize,
    /// Instrument's own configuration, if it differs from the target's. It is an index into
    /// [`Dataset::further_readings`](crate::measurement::Dataset::further_readings).
    #[serde(default)]
    pub from: Option<u32>,
    /// The measurement.
    pub measurement: Measurement,
    /// Standard deviations of each component, metres or radians, if the row states them.
    pub stated: StatedDeviations,
    /// Shape of the noise of its position, if it is not the same in all directions. It is an index into
    /// [`Dataset::noise_shapes`](crate::measurement::Dataset::noise_shapes).
    #[serde(default)]
    pub noise_shape: Option<u32>,
    /// Index of the row among those that were measured in motion: into the times of
    /// [`Dataset::moving_rows`](crate::measurement::Dataset::moving).
    #[serde(default)]
    pub moving: Option<u32>,
    /// Set of the row, if it states it.
    pub set: Option<Set>,
    /// File and line.
    pub source: RowLocation,
}

impl Observation {
    /// A measurement of a target from the first station, in one configuration, without stated noise.
    #[must_use]
    pub fn new(target: usize, measurement: Measurement) -> Self {
        Observation {
            target,
            station: 0,
            from: None,
            measurement,
            stated: StatedDeviations::default(),
            noise_shape: None,
            moving: None,
            set: None,
            source: RowLocation::default(),
        }
    }

    /// Stated noise of the row; `usual` for a standard deviation that it does not state.
    #[must_use]
    pub fn noise_or(&self, usual: Noise) -> Noise {
        ByQuantity::from_fn(|quantity| self.stated.get(quantity).unwrap_or(usual[quantity]))
    }
}
