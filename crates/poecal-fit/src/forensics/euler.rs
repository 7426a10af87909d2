//! Orientations whose three angles were read in another convention than meant.

use nalgebra::Matrix3;
use std::f64::consts::PI;

use poecal_arm::lie::angles::Angles;

/// A convention in words: `extrinsic xyz angles`.
pub(crate) fn words(angles: Angles) -> String {
    match angles {
        Angles::ROLL_PITCH_YAW => "roll, pitch, yaw (extrinsic xyz)".to_owned(),
        Angles::RotationVector => "a rotation vector".to_owned(),
        Angles::Intrinsic(_) | Angles::Extrinsic(_) => {
            let whose =
                angles.maker().map_or_else(String::new, |it| format!(" ({}'s {})", it.maker, it.names.join(", ")));
            format!("{} angles{whose}", angles.to_string().replace('_', " "))
        }
    }
}

/// Columns that are read in this convention without a mapping.
pub(crate) fn columns(angles: Angles) -> Option<[&'static str; 3]> {
    match angles {
        Angles::ROLL_PITCH_YAW => Some(["roll", "pitch", "yaw"]),
        Angles::RotationVector => Some(["rx", "ry", "rz"]),
        Angles::Intrinsic(_) | Angles::Extrinsic(_) => None,
    }
}

/// Angles read in one convention, meant in another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reinterpretation {
    pub(crate) read: Angles,
    pub(crate) meant: Angles,
    /// Factor on the angles.
    pub(crate) factor: f64,
}

impl Reinterpretation {
    /// All pairs of different conventions, and angles of one convention with the wrong unit.
    pub(crate) fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for read in Angles::all() {
            for meant in Angles::all() {
                // The angles of an extrinsic convention are those of an intrinsic one in reverse order, so that half of the pairs are
                // equivalent. Those read as extrinsic, as in most files, represent both.
                if read == meant || matches!((read, meant), (Angles::Intrinsic(_), Angles::Intrinsic(_))) {
                    continue;
                }
                all.push(Reinterpretation { read, meant, factor: 1.0 });
            }
            for factor in [180.0 / PI, PI / 180.0] {
                all.push(Reinterpretation { read, meant: read, factor });
            }
        }
        all
    }

    /// The rotation meant, by each of the two sets of angles that a rotation has.
    pub(crate) fn rotations(&self, r: &Matrix3<f64>) -> [Matrix3<f64>; 2] {
        let found = self.read.decompose(r);
        [found, self.read.other_angles(found)]
            .map(|angles| self.meant.rotation(angles.map(|angle| angle * self.factor)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_that_were_read_as_radians_are_undone_up_to_a_turn() {
        let all = Reinterpretation::all();
        let meaning = |angles| all.iter().find(|one| one.read == angles && one.factor < 1.0).unwrap();
        for degrees in [[3.0, -2.0, 1.0], [0.5, 0.2, -1.0]] {
            let read = Angles::RotationVector.rotation(degrees);
            let meant = Angles::RotationVector.rotation(degrees.map(f64::to_radians));
            let found = meaning(Angles::RotationVector).rotations(&read);
            assert!(found.iter().any(|one| (one - meant).norm() < 1e-13), "{degrees:?}");
        }
    }
}
