//! Orientations by the names of their columns in controllers, robots, cameras and ROS, with the makers' units.

use std::sync::LazyLock;

use super::orientation::OrientationForm;
use poecal_arm::lie::angles::{Angles, MAKERS, MakersAngles};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// A convention of orientations in columns.
#[derive(Debug)]
pub(crate) struct OrientationConvention {
    /// The names of its columns; case does not matter.
    pub(crate) columns: &'static [&'static str],
    /// The form of the orientation.
    pub(crate) form: OrientationForm,
    /// This maker's units of positions and of these columns, for columns without a stated unit.
    pub(crate) usual: Option<(&'static str, &'static str)>,
    /// Name of the convention in messages.
    pub(crate) words: String,
    /// True if it is the angles of a maker of controllers, in letters of its own.
    pub(crate) is_makers: bool,
}

impl OrientationConvention {
    /// The unit of a maker's positions, or of its columns.
    pub(crate) fn usual_unit(&self, quantity: Unit) -> Option<NamedUnit> {
        let (length, angle) = self.usual?;
        NamedUnit::parse(if quantity == Unit::Metre { length } else { angle }, quantity).ok()
    }

    /// True if no other maker has another meaning for columns of these names.
    pub(crate) fn is_unique(&self) -> bool {
        self.is_makers || self.form == OrientationForm::QuaternionWxyz
    }

    /// True if a name is that of one of its columns.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|it| it.eq_ignore_ascii_case(name))
    }

    fn of_maker(it: &'static MakersAngles) -> Self {
        OrientationConvention {
            columns: &it.names,
            form: OrientationForm::Angles(it.angles),
            usual: Some(("mm", "deg")),
            words: format!("{}'s {}", it.maker, it.names.join(", ")),
            is_makers: true,
        }
    }
}

/// OpenCV's rotation vector.
pub(crate) const OPENCV: &[&str] = &["rvecx", "rvecy", "rvecz"];
/// Names of angles with different meanings by maker.
pub(crate) const AMBIGUOUS: [&str; 3] = ["Rx", "Ry", "Rz"];

/// All conventions; if a header has several, the first one applies.
pub(crate) static CONVENTIONS: LazyLock<Vec<OrientationConvention>> = LazyLock::new(|| {
    let named = |columns, form, words: &str, usual| {
        let words = words.to_owned();
        OrientationConvention { columns, form, usual, words, is_makers: false }
    };
    let (xyzw, wxyz) = (OrientationForm::QuaternionXyzw, OrientationForm::QuaternionWxyz);
    let (vector, turns) = (OrientationForm::ROTATION_VECTOR, OrientationForm::ROLL_PITCH_YAW);
    let (matrix, metres) = (OrientationForm::MatrixByRows, Some(("m", "rad")));
    let first = [
        named(xyzw.part_names(), xyzw, "quaternion by names", None),
        named(&["q1", "q2", "q3", "q4"], wxyz, "ABB's quaternion, q1 real", Some(("mm", "1"))),
        named(&["q0", "q1", "q2", "q3"], wxyz, "quaternion, q0 real", None),
        named(OPENCV, vector, "OpenCV's rvec and tvec", metres),
    ];
    let makers = MAKERS.iter().filter(|it| it.names != AMBIGUOUS).map(OrientationConvention::of_maker);
    let last = [
        // Makers' rotations about the axes that they name rx, ry, rz, which are others' names for rotation vectors.
        named(
            &["intrinsicx", "intrinsicy", "intrinsicz"],
            OrientationForm::Angles(Angles::XYZ),
            "angles about x, y, z as turned (Stäubli's RX, RY, RZ)",
            Some(("mm", "deg")),
        ),
        named(turns.part_names(), turns, "roll, pitch, yaw about fixed axes x, y, z", None),
        named(vector.part_names(), vector, "Universal Robots' rotation vector", metres),
        named(matrix.part_names(), matrix, "matrix by rows", None),
    ];
    first.into_iter().chain(makers).chain(last).collect()
});
