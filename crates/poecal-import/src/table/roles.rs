//! Names of columns: ours, and those of makers, recorders, cameras and scripts around them.
//!
//! A new word goes into a row of [`ROLES`]. A maker's angles are a row of [`MAKERS`](poecal_arm::lie::angles::MAKERS), which `conventions.rs` uses
//! with quaternions, vectors and matrices.

use poecal_numerics::named_unit::NamedUnit;

/// Role of a column, or of a word in its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColumnRole {
    /// Meaning in every file of measurements, by exactly this name.
    Ours,
    /// The readings of a numbered joint, with its number.
    Joint,
    /// The time of a row.
    Time,
    /// The picture of a row.
    Picture,
    /// The picture of a row, if nothing else names the row.
    Frame,
    /// The name of a row.
    Row,
    /// A corner in a picture.
    Corner,
    /// The columns of a pixel along and down the picture; HALCON's row and column have their zero in the centre of the first pixel, as OpenCV's.
    Pixel,
    /// The standard deviation of a pixel.
    PixelSigma,
    Camera,
    Board,
    /// Name of a point in a file of boards.
    BoardPoint,
    /// Word before x, y and z: the position of a corner on its board.
    OnBoard,
    /// Word before a part of a pose: the arm's.
    OfArm,
    /// Word before a part of a pose: the target's, which the camera saw.
    OfTarget,
    /// Word in a key, or in the name of a file or a matrix: the arm's poses.
    KeyOfArm,
    /// Word in such a name: the target's poses, unless a word before it is the arm's.
    KeyOfTarget,
    /// Word before an axis, by its letter or its number: the beginning of the name of a part of a pose in a convention.
    Part(&'static str),
    /// Word before an axis by its letter alone: the position of a pose.
    Place,
    /// Word beside a joint: a reading.
    Reading,
    /// Word beside a joint or a position: a commanded value, or another quantity.
    Other,
    /// Word in the name of a joint.
    InJoint,
    /// Word in the name of a measurement.
    InMeasured,
    /// Word in the name of a column with the quality of another one.
    InStatistic,
    /// Word before x, y and z without anything between, in a file whose columns are guessed.
    Guessed,
    /// The coordinates of a position that is guessed.
    Axes,
    /// A set of coordinates that was commanded or computed.
    NominalSet,
    /// A set of coordinates that was measured.
    MeasuredSet,
}

/// Words of each role in small letters and digits, except our own; the first one that a file has applies.
const ROLES: &[(ColumnRole, &str)] = &[
    (
        ColumnRole::Ours,
        "x y z qx qy qz qw rx ry rz roll pitch yaw target instrument pair sigma_position sigma_x sigma_y sigma_z sigma_rotation id set",
    ),
    (ColumnRole::Joint, "q j a joint axis theta th jnt jointposition jointangle angle"),
    (ColumnRole::Time, "time t timestamp stamp times timeseconds seconds elapsed"),
    (ColumnRole::Picture, "image picture file filename"),
    (ColumnRole::Frame, "frame imageid"),
    (ColumnRole::Row, "name id index"),
    (ColumnRole::Corner, "target corner cornerid id index mark point marker"),
    (ColumnRole::Pixel, "u v"),
    (ColumnRole::Pixel, "column row"),
    (ColumnRole::Pixel, "col row"),
    (ColumnRole::Pixel, "xpx ypx"),
    (ColumnRole::Pixel, "px py"),
    (ColumnRole::Pixel, "pixelx pixely"),
    (ColumnRole::Pixel, "imagex imagey"),
    (ColumnRole::PixelSigma, "sigma sigmapx"),
    (ColumnRole::Camera, "camera"),
    (ColumnRole::Board, "board"),
    (ColumnRole::BoardPoint, "target marker corner name"),
    (ColumnRole::OnBoard, "obj object"),
    (ColumnRole::OfArm, "flange robot tcp base ee tool0 tool gripper arm hand endeffector"),
    (ColumnRole::OfTarget, "target board marker camera cam tag pattern object chessboard c"),
    (ColumnRole::KeyOfArm, "effector robot flange tcp gripper hand ee arm base fpe fme rpe"),
    (ColumnRole::KeyOfTarget, "object tracking target board marker camera cam pattern cpo cmo"),
    (ColumnRole::Part(""), "position pos tvec translation trans"),
    (ColumnRole::Part("rvec"), "rvec rotvec"),
    (ColumnRole::Part("intrinsic"), "intrinsic"),
    (ColumnRole::Part("q"), "orientation quaternion quat rotation"),
    (ColumnRole::Place, "t p"),
    (ColumnRole::Reading, "actual measured meas current act feedback"),
    (
        ColumnRole::Other,
        "target desired wanted command commanded cmd goal setpoint reference velocity speed acceleration torque effort moment temperature \
         voltage amps tau error load",
    ),
    (ColumnRole::InJoint, "joint axis axe achse gelenk"),
    (ColumnRole::InMeasured, "meas actual tracker laser leica prism smr refl point"),
    (ColumnRole::InStatistic, "std sigma stdev dev err rms cov noise u95"),
    (ColumnRole::Guessed, "p t pos position tcp point meas target"),
    (ColumnRole::Axes, "x y z"),
    (ColumnRole::Axes, "east north up"),
    (
        ColumnRole::NominalSet,
        "nominal nom theoretical theory ideal command commanded cmd desired reference ref design calculated target",
    ),
    (ColumnRole::MeasuredSet, "measured measurement meas actual act real laser"),
];

impl ColumnRole {
    /// The rows of the role.
    pub(crate) fn rows(self) -> impl Iterator<Item = &'static str> {
        ROLES.iter().filter(move |it| it.0 == self).map(|it| it.1)
    }

    /// Its words.
    pub(crate) fn words(self) -> impl Iterator<Item = &'static str> {
        self.rows().flat_map(|row| row.split(' '))
    }

    /// True if a name of letters and digits is one of its words.
    pub(crate) fn has(self, name: &str) -> bool {
        self.words().any(|word| word == name)
    }

    /// True if a name contains one of its words.
    pub(crate) fn is_in(self, name: &str) -> bool {
        self.words().any(|word| name.contains(word))
    }

    /// The beginning of a name that belongs to a part of a pose, and the rest.
    pub(crate) fn part(name: &str) -> Option<(&'static str, &str)> {
        ROLES.iter().find_map(|(role, words)| {
            let ColumnRole::Part(part) = role else { return None };
            Some((*part, words.split(' ').find_map(|word| name.strip_prefix(word))?))
        })
    }
}

/// Letters and digits of a name, in small letters.
pub(crate) fn plain_letters(name: &str) -> String {
    name.chars().filter(|it| it.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The unit of a word in the name of a column; case does not matter.
pub(crate) fn unit_of(word: &str) -> Option<NamedUnit> {
    NamedUnit::parse_any(word).or_else(|_| NamedUnit::parse_any(&word.to_lowercase())).ok()
}

/// The name of a column without the unit at its end, as `x_mm`, and that unit.
pub(crate) fn without_unit(name: &str) -> (&str, Option<NamedUnit>) {
    let parts = name.rsplit_once(|it: char| !it.is_alphanumeric() && it != '°');
    let found = parts.and_then(|(stem, word)| Some((stem, unit_of(word)?)));
    found.map_or((name, None), |(stem, unit)| (stem, Some(unit)))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_word_stands_once_in_a_role() {
        for (role, row) in ROLES {
            let words: Vec<&str> = row.split(' ').collect();
            let all: BTreeSet<&str> = words.iter().copied().collect();
            assert_eq!(all.len(), words.len(), "{role:?}");
            let is_plain = |word: &&str| *role == ColumnRole::Ours || plain_letters(word) == *word;
            assert!(words.iter().all(is_plain), "{role:?}: {row}");
        }
    }

    #[test]
    fn a_name_has_its_unit_at_its_end() {
        let parts = |name| {
            let (stem, unit) = without_unit(name);
            (stem, unit.map(NamedUnit::symbol))
        };
        for name in ["flange_x_mm", "flange_x mm", "flange_x-MM", "flange_x.mm"] {
            assert_eq!(parts(name), ("flange_x", Some("mm")), "{name}");
        }
        for name in ["x", "mm", "flange_x", "xmm", "tvec[0]"] {
            assert_eq!(parts(name), (name, None), "{name}");
        }
    }
}
