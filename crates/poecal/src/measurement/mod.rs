//! Measurements by an external device. The residual of a measurement depends on the predicted pose of its target alone, not on joints or
//! parameters.

mod components;
mod configurations;
mod dataset;
mod direction;
mod distance;
mod flush;
mod height;
mod known_length;
mod noise_shape;
mod observe;
mod other_pose;
mod point;
mod pose;
mod quantity;
mod socket;

pub use components::ComponentsMeasurement;
pub(crate) use configurations::MANY as MANY_ROWS;
pub use dataset::{Dataset, Observation, Set, Source};
pub use direction::DirectionMeasurement;
pub use distance::DistanceMeasurement;
pub use flush::FlushMeasurement;
pub use height::HeightMeasurement;
pub use known_length::KnownLength;
pub use noise_shape::NoiseShape;
pub use observe::{Channel, Channels, NUMBERS, Observe, Sensitivity};
pub use other_pose::PoseResidual;
pub(crate) use other_pose::Written;
pub use point::PointMeasurement;
pub use pose::PoseMeasurement;
pub use quantity::{ByQuantity, Measured, Noise, Quantity, Stated};
pub use socket::SocketMeasurement;

use nalgebra::Vector3;

use crate::lie::{Freedom, Pose, rotation};

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
    /// Some components of the position of a point.
    Components(ComponentsMeasurement),
    /// Position and orientation of a frame.
    Pose(PoseMeasurement),
    /// Distance of a point from the instrument.
    Distance(DistanceMeasurement),
    /// Place of a ball in its socket.
    Socket(SocketMeasurement),
    /// Height over a plane.
    Height(HeightMeasurement),
    /// Height and tilts of a face on a plane.
    Flush(FlushMeasurement),
    /// A fixed direction, as the target sees it.
    Direction(DirectionMeasurement),
}

/// What a measurement shows of the target itself: for all that moves or draws measured places and orientations.
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
            Measurement::Components(components) => components,
            Measurement::Pose(pose) => pose,
            Measurement::Distance(distance) => distance,
            Measurement::Socket(socket) => socket,
            Measurement::Height(height) => height,
            Measurement::Flush(flush) => flush,
            Measurement::Direction(direction) => direction,
        }
    }

    /// What it shows of the target itself.
    #[must_use]
    #[inline]
    pub fn seen(&self) -> Seen<'_> {
        match self {
            Measurement::Point(PointMeasurement { position }) => Seen::Point(position),
            Measurement::Pose(PoseMeasurement { pose }) => Seen::Frame(pose),
            other @ (Measurement::Components(_)
            | Measurement::Distance(_)
            | Measurement::Socket(_)
            | Measurement::Height(_)
            | Measurement::Flush(_)
            | Measurement::Direction(_)) => Seen::Other(other.observe()),
        }
    }

    /// How far apart two measurements of one kind are: metres, and radians of orientations. `None` of different kinds.
    #[must_use]
    pub fn apart(&self, other: &Measurement) -> Option<(f64, f64)> {
        let angle = |a: &Vector3<f64>, b: &Vector3<f64>| a.cross(b).norm().atan2(a.dot(b));
        match (self, other) {
            (Measurement::Distance(a), Measurement::Distance(b)) => {
                Some(((a.distance - b.distance).abs(), 0.0))
            }
            (Measurement::Components(a), Measurement::Components(b)) if a.measured == b.measured => {
                Some(((a.position - b.position).norm(), 0.0))
            }
            (Measurement::Socket(a), Measurement::Socket(b)) => Some(((a.place - b.place).norm(), 0.0)),
            (Measurement::Height(a), Measurement::Height(b)) => Some(((a.height - b.height).abs(), 0.0)),
            (Measurement::Flush(a), Measurement::Flush(b)) => {
                Some(((a.height - b.height).abs(), angle(&a.normal, &b.normal)))
            }
            (Measurement::Direction(a), Measurement::Direction(b)) => {
                Some((0.0, angle(&a.direction, &b.direction)))
            }
            (Measurement::Point(_) | Measurement::Pose(_), Measurement::Point(_) | Measurement::Pose(_)) => {
                let (a, b) = (self.pose(), other.pose());
                let both = self.sees_orientation() && other.sees_orientation();
                let turn =
                    if both { rotation::log(&(a.rotation * b.rotation.transpose())).norm() } else { 0.0 };
                Some(((a.translation - b.translation).norm(), turn))
            }
            (
                Measurement::Point(_)
                | Measurement::Components(_)
                | Measurement::Pose(_)
                | Measurement::Distance(_)
                | Measurement::Socket(_)
                | Measurement::Height(_)
                | Measurement::Flush(_)
                | Measurement::Direction(_),
                _,
            ) => None,
        }
    }

    /// Whether it depends on the target's orientation, so that the target is a frame and not only a point.
    #[must_use]
    #[inline]
    pub fn sees_orientation(&self) -> bool {
        self.target_freedom().turns()
    }

    /// What it shows of the target.
    #[must_use]
    #[inline]
    pub fn target_freedom(&self) -> Freedom {
        match self.seen() {
            Seen::Point(_) => Freedom::PLACE,
            Seen::Frame(_) => Freedom::FRAME,
            Seen::Other(model) => model.target_freedom(),
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
