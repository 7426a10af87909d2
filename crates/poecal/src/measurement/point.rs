//! Position of a point: lou2009 (19) to (26).

use nalgebra::Vector3;

use super::{Channel, Channels, Observe, Quantity, Sensitivity};
use crate::lie::Pose;

/// Measured position of a target point, `e = y - p`, `S = [I 0]` in target-centred form (theory.md §4 (15)).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::lie::Pose;
/// use poecal::measurement::{Observe, PointMeasurement};
/// let seen = PointMeasurement { position: Vector3::new(0.0, 0.0, 0.002) };
/// let mut e = [0.0; 3];
/// seen.residual(&Pose::identity(), &mut e);
/// assert_eq!(e, [0.0, 0.0, 0.002]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PointMeasurement {
    /// Position in the device's frame, metres.
    pub position: Vector3<f64>,
}

/// The channels of a position.
pub(super) const XYZ: [Channel; 3] = [
    Channel { name: "x", quantity: Quantity::Position },
    Channel { name: "y", quantity: Quantity::Position },
    Channel { name: "z", quantity: Quantity::Position },
];

const POSITION: Channels = Channels::new(&XYZ);

impl Observe for PointMeasurement {
    fn channels(&self) -> &'static Channels {
        &POSITION
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        out[..3].copy_from_slice((self.position - predicted.translation).as_slice());
    }

    fn sensitivity(&self, _: &Pose, out: &mut [Sensitivity]) {
        for (k, row) in out[..3].iter_mut().enumerate() {
            *row = [0.0; 6];
            row[k] = 1.0;
        }
    }

    fn is_wrench(&self) -> bool {
        true
    }

    fn position(&self) -> Option<Vector3<f64>> {
        Some(self.position)
    }

    fn is_finite(&self) -> bool {
        self.position.iter().all(|number| number.is_finite())
    }
}
