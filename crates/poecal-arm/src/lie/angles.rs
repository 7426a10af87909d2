//! Conventions of three numbers for an orientation, and the makers that use them.

use core::f64::consts::PI;
use core::fmt;
use core::str::FromStr;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

use nalgebra::{Matrix3, Vector3};

use super::rotation;

/// A convention of three angles, radians.
///
/// ```
/// use poecal_arm::lie::angles::Angles;
/// let turned = Angles::ZYX.rotation([0.3, -0.2, 0.1]);
/// let same = Angles::ROLL_PITCH_YAW.decompose(&turned);
/// assert!((same[0] - 0.1).abs() < 1e-15 && (same[2] - 0.3).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angles {
    /// About moving axes (0 = x): `R = R_i(a) R_j(b) R_k(c)`.
    Intrinsic([usize; 3]),
    /// About fixed axes: `R = R_k(c) R_j(b) R_i(a)`.
    Extrinsic([usize; 3]),
    /// Axis times angle.
    RotationVector,
}

/// The twelve sequences of axes, the usual ones first.
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

/// The angles of a maker of controllers.
///
/// ```
/// use poecal_arm::lie::angles::{Angles, MakersAngles};
/// let fanuc = MakersAngles { maker: "FANUC", names: ["W", "P", "R"], angles: Angles::ROLL_PITCH_YAW };
/// assert_eq!(Angles::ROLL_PITCH_YAW.maker(), Some(&fanuc));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MakersAngles {
    /// The maker.
    pub maker: &'static str,
    /// Names of the angles by the maker.
    pub names: [&'static str; 3],
    /// Convention.
    pub angles: Angles,
}

const fn makers_angles(maker: &'static str, names: [&'static str; 3], angles: Angles) -> MakersAngles {
    MakersAngles { maker, names, angles }
}

/// Makers with their angles; the first of each convention is its best known.
///
/// ```
/// use poecal_arm::lie::angles::{Angles, MAKERS};
/// assert!(MAKERS.iter().any(|it| it.maker == "KUKA" && it.angles == Angles::ZYX));
/// ```
pub const MAKERS: [MakersAngles; 8] = [
    makers_angles("KUKA", ["A", "B", "C"], Angles::ZYX),
    makers_angles("FANUC", ["W", "P", "R"], Angles::ROLL_PITCH_YAW),
    makers_angles("Yaskawa", ["Rx", "Ry", "Rz"], Angles::ROLL_PITCH_YAW),
    makers_angles("Kawasaki", ["O", "A", "T"], Angles::ZYZ),
    makers_angles("Comau", ["A", "E", "R"], Angles::ZYZ),
    makers_angles("Epson", ["U", "V", "W"], Angles::ZYX),
    makers_angles("Universal Robots", ["Rx", "Ry", "Rz"], Angles::RotationVector),
    makers_angles("Stäubli", ["Rx", "Ry", "Rz"], Angles::XYZ),
];

impl Angles {
    /// About z, the new y and the newest x.
    pub const ZYX: Self = Angles::Intrinsic([2, 1, 0]);
    /// About z, the new y and the newest z.
    pub const ZYZ: Self = Angles::Intrinsic([2, 1, 2]);
    /// About x, the new y and the newest z.
    pub const XYZ: Self = Angles::Intrinsic([0, 1, 2]);
    /// URDF's roll, pitch, yaw: about the fixed x, y and z.
    pub const ROLL_PITCH_YAW: Self = Angles::Extrinsic([0, 1, 2]);

    /// All conventions, the usual ones first.
    pub fn all() -> impl Iterator<Item = Angles> {
        let turns = SEQUENCES.into_iter().flat_map(|axes| [Angles::Extrinsic(axes), Angles::Intrinsic(axes)]);
        turns.chain([Angles::RotationVector])
    }

    /// The best known maker of the convention.
    #[must_use]
    pub fn maker(self) -> Option<&'static MakersAngles> {
        MAKERS.iter().find(|it| it.angles == self)
    }

    /// The rotation of three angles, radians.
    #[must_use]
    pub fn rotation(self, [a, b, c]: [f64; 3]) -> Matrix3<f64> {
        match self {
            Angles::Intrinsic([i, j, k]) => rotation::about(i, a) * rotation::about(j, b) * rotation::about(k, c),
            Angles::Extrinsic([i, j, k]) => rotation::about(k, c) * rotation::about(j, b) * rotation::about(i, a),
            Angles::RotationVector => rotation::exp(&Vector3::new(a, b, c)),
        }
    }

    /// Three angles of a rotation, the middle one within ±90° (from 0 to 180° if the first axis is also the last).
    #[must_use]
    pub fn decompose(self, r: &Matrix3<f64>) -> [f64; 3] {
        match self {
            Angles::Intrinsic(axes) => intrinsic(axes, r),
            Angles::Extrinsic([i, j, k]) => {
                let [c, b, a] = intrinsic([k, j, i], r);
                [a, b, c]
            }
            Angles::RotationVector => rotation::log(r).into(),
        }
    }

    /// The other three angles of the same rotation.
    #[must_use]
    pub fn other_angles(self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        match self {
            Angles::Intrinsic([i, _, k]) | Angles::Extrinsic([i, _, k]) => [
                wrap_to_half_turn(a + PI),
                if i == k { -b } else { wrap_to_half_turn(PI - b) },
                wrap_to_half_turn(c + PI),
            ],
            Angles::RotationVector => {
                let angle = Vector3::new(a, b, c).norm().max(f64::MIN_POSITIVE);
                [a, b, c].map(|part| part - 2.0 * PI * part / angle)
            }
        }
    }
}

/// An angle wrapped to ±180°.
fn wrap_to_half_turn(angle: f64) -> f64 {
    angle - (angle / (2.0 * PI)).round() * 2.0 * PI
}

/// Angles `a, b, c` with `R = R_i(a) R_j(b) R_k(c)`.
fn intrinsic([i, j, k]: [usize; 3], r: &Matrix3<f64>) -> [f64; 3] {
    let (repeated, third) = if i == k { (true, 3 - i - j) } else { (false, k) };
    // The sign is positive if i, j, third are a cyclic permutation of x, y, z.
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

/// Displays the `form` of a mapping: `intrinsic_zyx`, `roll_pitch_yaw`, `rotation_vector`.
impl fmt::Display for Angles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, axes) = match self {
            Angles::RotationVector => return f.write_str("rotation_vector"),
            &Angles::ROLL_PITCH_YAW => return f.write_str("roll_pitch_yaw"),
            Angles::Intrinsic(axes) => ("intrinsic", axes),
            Angles::Extrinsic(axes) => ("extrinsic", axes),
        };
        let [a, b, c] = axes.map(|axis| ['x', 'y', 'z'][axis % 3]);
        write!(f, "{word}_{a}{b}{c}")
    }
}

/// A word that is no convention.
///
/// ```
/// use poecal_arm::lie::angles::{Angles, UnknownConvention};
/// assert_eq!("intrinsic_zyx".parse(), Ok(Angles::ZYX));
/// assert_eq!("intrinsic_zz".parse::<Angles>(), Err(UnknownConvention));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownConvention;

impl FromStr for Angles {
    type Err = UnknownConvention;

    fn from_str(text: &str) -> Result<Self, UnknownConvention> {
        let axes = |axes: &str| {
            let mut letters = axes.chars().map(|it| "xyz".find(it));
            let found = [letters.next()??, letters.next()??, letters.next()??];
            let is_turned = found[0] != found[1] && found[1] != found[2] && letters.next().is_none();
            is_turned.then_some(found)
        };
        let found = match text.split_once('_') {
            Some(("intrinsic", rest)) => axes(rest).map(Angles::Intrinsic),
            Some(("extrinsic", rest)) => axes(rest).map(Angles::Extrinsic),
            Some(("rotation", "vector")) => Some(Angles::RotationVector),
            Some(("roll", "pitch_yaw")) => Some(Angles::ROLL_PITCH_YAW),
            _ => None,
        };
        found.ok_or(UnknownConvention)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString as _;

    #[test]
    fn angles_of_every_kind_give_their_rotation_back() {
        let mut worst: f64 = 0.0;
        for angles in Angles::all() {
            for k in 0..50 {
                let k = f64::from(k);
                let r = rotation::exp(&Vector3::new((k * 1.3).sin() * 2.0, (k * 0.7).cos(), (k * 2.1).sin()));
                let found = angles.decompose(&r);
                for numbers in [found, angles.other_angles(found)] {
                    let apart = (angles.rotation(numbers) - r).norm();
                    assert!(apart < 1e-13, "{angles:?}: {apart:e}");
                    worst = worst.max(apart);
                }
            }
        }
        std::println!("largest difference {worst:.1e}");
    }

    #[test]
    fn words_of_conventions_are_read_back() {
        for angles in Angles::all() {
            assert_eq!(angles.to_string().parse(), Ok(angles));
        }
        for bad in ["intrinsic_xx", "intrinsic_xxy", "extrinsic_xyzx", "intrinsic_abc", "euler", "extrinsic_"] {
            assert_eq!(bad.parse::<Angles>(), Err(UnknownConvention), "{bad}");
        }
    }

    #[test]
    fn extrinsic_angles_are_intrinsic_ones_backwards() {
        let one = Angles::ZYX.rotation([0.3, -0.5, 1.1]);
        let other = Angles::ROLL_PITCH_YAW.rotation([1.1, -0.5, 0.3]);
        assert!((one - other).norm() < 1e-15);
        assert!((other - rotation::from_rpy(1.1, -0.5, 0.3)).norm() < 1e-15);
    }
}
