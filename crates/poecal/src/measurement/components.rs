//! Some components of a point's position.

use nalgebra::Vector3;

use super::point::XYZ;
use super::{Channels, Observe, Sensitivity};
use crate::lie::{Freedom, Pose};

/// Measured components of a target's position, `e = (y - p)` and `S = [I 0]` of those alone: a camera that looks along z sees x and y, a
/// gauge on a rail one of them. The device shows its frame but for its place along the others (theory.md §4 (15)).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ComponentsMeasurement {
    /// Position in the device's frame, metres; zero where a component was not measured.
    pub position: Vector3<f64>,
    /// Which components were measured, at least one.
    pub measured: [bool; 3],
}

const NONE: Channels = Channels::new(&[]);
const ONE: [Channels; 3] = [Channels::new(&[XYZ[0]]), Channels::new(&[XYZ[1]]), Channels::new(&[XYZ[2]])];
/// Without x, without y, without z.
const TWO: [Channels; 3] =
    [Channels::new(&[XYZ[1], XYZ[2]]), Channels::new(&[XYZ[0], XYZ[2]]), Channels::new(&[XYZ[0], XYZ[1]])];
const ALL: Channels = Channels::new(&XYZ);

impl ComponentsMeasurement {
    /// Of components, metres; none of those that were not measured.
    #[must_use]
    pub fn new(components: [Option<f64>; 3]) -> Self {
        ComponentsMeasurement {
            position: components.map(Option::unwrap_or_default).into(),
            measured: components.map(|it| it.is_some()),
        }
    }

    /// The components; none where one was not measured.
    #[must_use]
    pub fn components(&self) -> [Option<f64>; 3] {
        [0, 1, 2].map(|k| self.measured[k].then_some(self.position[k]))
    }

    /// Indices of the measured components.
    fn indices(&self) -> impl Iterator<Item = usize> {
        let measured = self.measured;
        (0..3).filter(move |&k| measured[k])
    }
}

impl Observe for ComponentsMeasurement {
    fn channels(&self) -> &'static Channels {
        const TABLE: [&Channels; 8] = [&NONE, &ONE[0], &ONE[1], &TWO[2], &ONE[2], &TWO[1], &TWO[0], &ALL];
        let [x, y, z] = self.measured.map(usize::from);
        TABLE[x + 2 * y + 4 * z]
    }

    fn residual(&self, predicted: &Pose, out: &mut [f64]) {
        for (out, k) in out.iter_mut().zip(self.indices()) {
            *out = self.position[k] - predicted.translation[k];
        }
    }

    fn sensitivity(&self, _: &Pose, out: &mut [Sensitivity]) {
        for (out, k) in out.iter_mut().zip(self.indices()) {
            *out = [0.0; 6];
            out[k] = 1.0;
        }
    }

    fn is_wrench(&self) -> bool {
        true
    }

    fn position_components(&self) -> [Option<f64>; 3] {
        self.components()
    }

    fn device_freedom(&self) -> Freedom {
        match self.measured {
            [true, false, false] => Freedom::plane(0),
            [false, true, false] => Freedom::plane(1),
            [false, false, true] => Freedom::plane(2),
            [false, true, true] => Freedom::across(0),
            [true, false, true] => Freedom::across(1),
            [true, true, false] => Freedom::across(2),
            [true, true, true] | [false, false, false] => Freedom::FRAME,
        }
    }

    fn is_finite(&self) -> bool {
        self.measured.contains(&true) && self.position.iter().all(|number| number.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_measured_minus_predicted_of_those_alone() {
        let seen = ComponentsMeasurement::new([Some(0.3), None, Some(0.1)]);
        let mut e = [0.0; 2];
        seen.residual(&Pose::from_translation(Vector3::new(0.3, 7.0, 0.0)), &mut e);
        assert_eq!((e, seen.channels()[1].name), ([0.0, 0.1], "z"));
    }
}
