//! Measurements by an external device. The residual of a measurement depends on the predicted pose of its target alone, not on joints or
//! parameters.

mod configurations;
mod dataset;
mod distance;
mod observe;
mod other_pose;
mod point;
mod pose;
mod quantity;

pub(crate) use configurations::MANY as MANY_ROWS;
pub use dataset::{Dataset, Observation, Set, Source};
pub use distance::DistanceMeasurement;
pub use observe::{Channel, Channels, NUMBERS, Observe, Sensitivity};
pub use other_pose::PoseResidual;
pub(crate) use other_pose::Written;
pub use point::PointMeasurement;
pub use pose::PoseMeasurement;
pub use quantity::{ByQuantity, Measured, Noise, Quantity, Stated};

use nalgebra::Vector3;

use crate::lie::{Pose, rotation};

/// One measurement of a target in the measuring device's frame.
///
/// A new type is one file with [`Observe`] and one variant here.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::measurement::{Measurement, PointMeasurement};
/// let seen = Measurement::Point(PointMeasurement { position: Vector3::new(1.0, 2.0, 3.0) });
/// assert_eq!(seen.observe().dim(), 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Measurement {
    /// Position of a point.
    Point(PointMeasurement),
    /// Position and orientation of a frame.
    Pose(PoseMeasurement),
    /// Distance of a point from the instrument.
    Distance(DistanceMeasurement),
}

/// What a measurement shows of the target itself: for all that moves or draws measured places and orientations.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::measurement::{Measurement, PointMeasurement, Seen};
/// let measured = Measurement::Point(PointMeasurement { position: Vector3::x() });
/// assert!(matches!(measured.seen(), Seen::Point(position) if position.x == 1.0));
/// ```
#[derive(Clone, Copy)]
pub enum Seen<'a> {
    /// Its place.
    Point(&'a Vector3<f64>),
    /// Its place and orientation.
    Frame(&'a Pose),
    /// Something that follows from its pose.
    Other(&'a dyn Observe),
}

impl Measurement {
    /// What was measured, by its type.
    #[must_use]
    #[inline]
    pub fn observe(&self) -> &dyn Observe {
        match self {
            Measurement::Point(point) => point,
            Measurement::Pose(pose) => pose,
            Measurement::Distance(distance) => distance,
        }
    }

    /// What it shows of the target itself.
    #[must_use]
    #[inline]
    pub fn seen(&self) -> Seen<'_> {
        match self {
            Measurement::Point(PointMeasurement { position }) => Seen::Point(position),
            Measurement::Pose(PoseMeasurement { pose }) => Seen::Frame(pose),
            Measurement::Distance(distance) => Seen::Other(distance),
        }
    }

    /// How far apart two measurements of one kind are: metres, and radians of orientations. `None` of different kinds.
    #[must_use]
    pub fn apart(&self, other: &Measurement) -> Option<(f64, f64)> {
        let place = |seen: Seen<'_>| match seen {
            Seen::Point(position) => Some((*position, None)),
            Seen::Frame(pose) => Some((pose.translation, Some(pose.rotation))),
            Seen::Other(_) => None,
        };
        match (place(self.seen()), place(other.seen())) {
            (Some((a, turned)), Some((b, other))) => {
                let turn = turned.zip(other).map(|(a, b)| rotation::log(&(a * b.transpose())).norm());
                Some(((a - b).norm(), turn.unwrap_or(0.0)))
            }
            (None, None) => {
                let (a, b) = (self.observe().range()?, other.observe().range()?);
                Some(((a - b).abs(), 0.0))
            }
            (Some(_), None) | (None, Some(_)) => None,
        }
    }

    /// Whether it depends on the target's orientation, so that the target is a frame and not only a point.
    #[must_use]
    #[inline]
    pub fn sees_orientation(&self) -> bool {
        match self.seen() {
            Seen::Point(_) => false,
            Seen::Frame(_) => true,
            Seen::Other(model) => model.sees_orientation(),
        }
    }

    /// Whether a number of this quantity was measured.
    #[must_use]
    #[inline]
    pub fn has(&self, quantity: Quantity) -> bool {
        match self.seen() {
            Seen::Point(_) => quantity == Quantity::Position,
            Seen::Frame(_) => quantity.is_of_pose(),
            Seen::Other(model) => model.channels().has(quantity),
        }
    }

    /// The measured `device_from_target`, with the identity for what was not measured.
    #[must_use]
    pub fn pose(&self) -> Pose {
        match self.seen() {
            Seen::Point(position) => Pose::from_translation(*position),
            Seen::Frame(pose) => *pose,
            Seen::Other(_) => Pose::identity(),
        }
    }
}
