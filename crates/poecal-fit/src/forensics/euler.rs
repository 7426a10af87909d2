//! Orientations whose three angles were read in another convention than meant.

use nalgebra::Matrix3;
use std::f64::consts::PI;

use poecal_arm::lie::rotation;

/// A convention of three angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Angles {
    /// Turns about moving axes (0 = x): `R = R_i(a) R_j(b) R_k(c)`.
    Intrinsic([usize; 3]),
    /// Turns about the device's axes: `R = R_k(c) R_j(b) R_i(a)`.
    Extrinsic([usize; 3]),
    /// Rotation vector: axis times angle.
    RotationVector,
}

/// The twelve sequences of axes.
const SEQUENCES: [[usize; 3]; 12] = [
    [0, 1, 2],
    [2, 1, 0],
    [2, 1, 2],
    [2, 0, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 1, 0],
    [0, 2, 0],
    [1, 0, 1],
    [1, 2, 1],
];

impl Angles {
    /// All conventions, the usual ones first.
    pub(crate) fn all() -> impl Iterator<Item = Angles> {
        let turns = SEQUENCES.into_iter().flat_map(|axes| [Angles::Extrinsic(axes), Angles::Intrinsic(axes)]);
        turns.chain([Angles::RotationVector])
    }

    /// The rotation of three angles, radians.
    pub(crate) fn rotation(self, [a, b, c]: [f64; 3]) -> Matrix3<f64> {
        match self {
            Angles::Intrinsic([i, j, k]) => {
                rotation::about(i, a) * rotation::about(j, b) * rotation::about(k, c)
            }
            Angles::Extrinsic([i, j, k]) => {
                rotation::about(k, c) * rotation::about(j, b) * rotation::about(i, a)
            }
            Angles::RotationVector => rotation::exp(&nalgebra::Vector3::new(a, b, c)),
        }
    }

    /// Three angles of a rotation, the middle one within ±90° (from 0 to 180° where the first axis is also the last).
    pub(crate) fn of(self, r: &Matrix3<f64>) -> [f64; 3] {
        match self {
            Angles::Intrinsic(axes) => intrinsic(axes, r),
            Angles::Extrinsic([i, j, k]) => {
                let [c, b, a] = intrinsic([k, j, i], r);
                [a, b, c]
            }
            Angles::RotationVector => rotation::log(r).into(),
        }
    }

    /// In words: `extrinsic xyz`.
    pub(crate) fn words(self) -> String {
        let name =
            |axes: [usize; 3]| -> String { axes.iter().map(|&axis| ['x', 'y', 'z'][axis % 3]).collect() };
        match self {
            Angles::Intrinsic([2, 1, 0]) => "intrinsic zyx angles (KUKA's A, B, C)".to_owned(),
            Angles::Intrinsic(axes) => format!("intrinsic {} angles", name(axes)),
            Angles::Extrinsic([0, 1, 2]) => "roll, pitch, yaw (extrinsic xyz)".to_owned(),
            Angles::Extrinsic(axes) => format!("extrinsic {} angles", name(axes)),
            Angles::RotationVector => "a rotation vector".to_owned(),
        }
    }
}

impl Angles {
    /// As the `form` of a mapping.
    pub(crate) fn form(self) -> String {
        let name =
            |axes: [usize; 3]| -> String { axes.iter().map(|&axis| ['x', 'y', 'z'][axis % 3]).collect() };
        match self {
            Angles::Intrinsic(axes) => format!("intrinsic_{}", name(axes)),
            Angles::Extrinsic([0, 1, 2]) => "roll_pitch_yaw".to_owned(),
            Angles::Extrinsic(axes) => format!("extrinsic_{}", name(axes)),
            Angles::RotationVector => "rotation_vector".to_owned(),
        }
    }

    /// Columns that are read in this convention without a mapping.
    pub(crate) fn columns(self) -> Option<[&'static str; 3]> {
        match self {
            Angles::Extrinsic([0, 1, 2]) => Some(["roll", "pitch", "yaw"]),
            Angles::RotationVector => Some(["rx", "ry", "rz"]),
            Angles::Intrinsic(_) | Angles::Extrinsic(_) => None,
        }
    }
}

/// Angles `a, b, c` with `R = R_i(a) R_j(b) R_k(c)`.
fn intrinsic([i, j, k]: [usize; 3], r: &Matrix3<f64>) -> [f64; 3] {
    let (repeated, third) = if i == k { (true, 3 - i - j) } else { (false, k) };
    // Whether i, j, third are a cyclic permutation of x, y, z.
    let sign = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 };
    let (a, b) = if repeated {
        let a = r[(j, i)].atan2(-sign * r[(third, i)]);
        (a, r[(j, i)].hypot(r[(third, i)]).atan2(r[(i, i)]))
    } else {
        let a = (-sign * r[(j, k)]).atan2(r[(k, k)]);
        (a, (sign * r[(i, k)]).atan2(r[(j, k)].hypot(r[(k, k)])))
    };
    let rest = (rotation::about(i, a) * rotation::about(j, b)).transpose() * r;
    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
    [a, b, rest[(last, next)].atan2(rest[(next, next)])]
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
                // The angles of an extrinsic convention are those of an intrinsic one backwards, so that half of the pairs are equivalent.
                // Those read as extrinsic, as in most files, represent both.
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
        let [a, b, c] = self.read.of(r);
        let other = match self.read {
            Angles::Intrinsic([i, _, k]) | Angles::Extrinsic([i, _, k]) => {
                [wrapped(a + PI), if i == k { -b } else { wrapped(PI - b) }, wrapped(c + PI)]
            }
            Angles::RotationVector => {
                let angle = a.hypot(b).hypot(c).max(f64::MIN_POSITIVE);
                [a, b, c].map(|part| part - 2.0 * PI * part / angle)
            }
        };
        [[a, b, c], other].map(|angles| self.meant.rotation(angles.map(|angle| angle * self.factor)))
    }
}

/// An angle wrapped to ±180°.
fn wrapped(angle: f64) -> f64 {
    angle - (angle / (2.0 * PI)).round() * 2.0 * PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

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

    #[test]
    fn angles_of_every_kind_give_their_rotation_back() {
        let mut worst: f64 = 0.0;
        for angles in Angles::all() {
            for k in 0..50 {
                let k = f64::from(k);
                let r = rotation::exp(&Vector3::new((k * 1.3).sin() * 2.0, (k * 0.7).cos(), (k * 2.1).sin()));
                let same = Reinterpretation { read: angles, meant: angles, factor: 1.0 };
                for other in same.rotations(&r) {
                    let apart = (other - r).norm();
                    assert!(apart < 1e-13, "{angles:?}: {apart:e}");
                    worst = worst.max(apart);
                }
            }
        }
        println!("largest difference {worst:.1e}");
    }
}
