//! Orientations by the names of their columns: controllers', robots', cameras' and ROS's, with the units that their makers have.

use super::orientation::OrientationForm;
use poecal_arm::lie::angles::Angles;
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// A convention of orientations in columns.
#[derive(Debug)]
pub(crate) struct Convention {
    /// The names of its columns, in small letters.
    pub(crate) columns: &'static [&'static str],
    /// What they mean.
    pub(crate) form: OrientationForm,
    /// Units of places and of these columns where nothing states them, as this maker has them.
    pub(crate) usual: Option<(&'static str, &'static str)>,
    /// What it is called.
    pub(crate) words: &'static str,
    /// Whether no other maker means something else by columns of these names.
    pub(crate) is_unique: bool,
}

impl Convention {
    /// The unit of a maker's places, or of its columns.
    pub(crate) fn usual_unit(&self, quantity: Unit) -> Option<NamedUnit> {
        let (length, angle) = self.usual?;
        NamedUnit::parse(if quantity == Unit::Metre { length } else { angle }, quantity).ok()
    }
}

const CONTROLLER: Option<(&str, &str)> = Some(("mm", "deg"));

const fn by_name(columns: &'static [&'static str], form: OrientationForm, words: &'static str) -> Convention {
    Convention { columns, form, usual: None, words, is_unique: false }
}

const fn of_maker(columns: &'static [&'static str], angles: Angles, words: &'static str) -> Convention {
    let form = OrientationForm::Angles(angles);
    Convention { columns, form, usual: CONTROLLER, words, is_unique: true }
}

/// OpenCV's rotation vector, by the keys of its columns.
pub(crate) const OPENCV: &[&str] = &["rvx", "rvy", "rvz"];
/// Angles about x, y, z as turned, which makers call rx, ry, rz, as others call rotation vectors.
const AS_TURNED: &[&str] = &["ix", "iy", "iz"];
const MATRIX: &[&str] = &["m00", "m01", "m02", "m10", "m11", "m12", "m20", "m21", "m22"];
const METRES: Option<(&str, &str)> = Some(("m", "rad"));

/// All conventions: of several that a header has, the first is meant.
pub(crate) const CONVENTIONS: [Convention; 13] = [
    by_name(&["qx", "qy", "qz", "qw"], OrientationForm::QuaternionXyzw, "quaternion by names"),
    Convention {
        usual: Some(("mm", "1")),
        is_unique: true,
        ..by_name(&["q1", "q2", "q3", "q4"], OrientationForm::QuaternionWxyz, "ABB's quaternion, q1 real")
    },
    Convention {
        is_unique: true,
        ..by_name(&["q0", "q1", "q2", "q3"], OrientationForm::QuaternionWxyz, "quaternion, q0 real")
    },
    Convention {
        usual: METRES,
        ..by_name(OPENCV, OrientationForm::ROTATION_VECTOR, "OpenCV's rvec and tvec")
    },
    of_maker(&["a", "b", "c"], Angles::ZYX, "KUKA's A, B, C"),
    of_maker(&["w", "p", "r"], Angles::ROLL_PITCH_YAW, "FANUC's W, P, R"),
    of_maker(&["o", "a", "t"], Angles::ZYZ, "Kawasaki's O, A, T"),
    of_maker(&["a", "e", "r"], Angles::ZYZ, "Comau's A, E, R"),
    of_maker(&["u", "v", "w"], Angles::ZYX, "Epson's U, V, W"),
    Convention {
        is_unique: false,
        ..of_maker(AS_TURNED, Angles::XYZ, "angles about x, y, z as turned (Stäubli's RX, RY, RZ)")
    },
    by_name(
        &["roll", "pitch", "yaw"],
        OrientationForm::ROLL_PITCH_YAW,
        "roll, pitch, yaw about fixed axes x, y, z",
    ),
    Convention {
        usual: METRES,
        ..by_name(&["rx", "ry", "rz"], OrientationForm::ROTATION_VECTOR, "Universal Robots' rotation vector")
    },
    by_name(MATRIX, OrientationForm::MatrixByRows, "matrix by rows"),
];
