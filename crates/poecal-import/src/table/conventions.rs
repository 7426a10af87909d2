//! Orientations by the names of their columns: controllers', robots', cameras' and ROS's, with the units that their makers have.

use std::sync::LazyLock;

use super::orientation::OrientationForm;
use poecal_arm::lie::angles::{Angles, MAKERS, MakersAngles};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// A convention of orientations in columns.
#[derive(Debug)]
pub(crate) struct Convention {
    /// The names of its columns; large letters or small do not count.
    pub(crate) columns: &'static [&'static str],
    /// What they mean.
    pub(crate) form: OrientationForm,
    /// Units of places and of these columns where nothing states them, as this maker has them.
    pub(crate) usual: Option<(&'static str, &'static str)>,
    /// What it is called.
    pub(crate) words: String,
    /// Whether it is the angles of a maker of controllers, in letters of its own.
    pub(crate) is_makers: bool,
}

impl Convention {
    /// The unit of a maker's places, or of its columns.
    pub(crate) fn usual_unit(&self, quantity: Unit) -> Option<NamedUnit> {
        let (length, angle) = self.usual?;
        NamedUnit::parse(if quantity == Unit::Metre { length } else { angle }, quantity).ok()
    }

    /// Whether no other maker means something else by columns of these names.
    pub(crate) fn is_unique(&self) -> bool {
        self.is_makers || self.form == OrientationForm::QuaternionWxyz
    }

    /// Whether a name is that of one of its columns.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|it| it.eq_ignore_ascii_case(name))
    }

    fn of_maker(it: &'static MakersAngles) -> Self {
        Convention {
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
/// Names of angles by which several makers mean several things.
pub(crate) const AMBIGUOUS: [&str; 3] = ["Rx", "Ry", "Rz"];

/// All conventions: of several that a header has, the first is meant.
pub(crate) static CONVENTIONS: LazyLock<Vec<Convention>> = LazyLock::new(|| {
    let named = |columns, form, words: &str, usual| {
        let words = words.to_owned();
        Convention { columns, form, usual, words, is_makers: false }
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
    let makers = MAKERS.iter().filter(|it| it.names != AMBIGUOUS).map(Convention::of_maker);
    let last = [
        // As makers turn about what they call rx, ry, rz, as others call rotation vectors.
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
