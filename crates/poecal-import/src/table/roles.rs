//! What columns are called: our names, and those of makers, recorders, cameras and scripts around them.
//!
//! A new word is a word in a row of [`ROLES`]; a maker's angles are a row of [`MAKERS`](poecal_arm::lie::angles::MAKERS), which `conventions.rs` takes
//! beside quaternions, vectors and matrices.

use poecal_numerics::named_unit::NamedUnit;

/// What a column is for, or what a word in its name says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Has a meaning in every file of measurements, by exactly this name.
    Ours,
    /// The readings of a numbered joint, with its number.
    Joint,
    /// The time of a row.
    Time,
    /// The picture of a row.
    Picture,
    /// The same, where nothing else names the row.
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
    /// The name of a point in a file of boards.
    BoardPoint,
    /// Before x, y and z: the place of a corner on its board.
    OnBoard,
    /// Before a part of a pose: the arm's.
    OfArm,
    /// Before a part of a pose: what the camera saw.
    OfTarget,
    /// In a key, or in the name of a file or a matrix: the arm's poses.
    KeyOfArm,
    /// The same of the target's, unless a word before it is the arm's.
    KeyOfTarget,
    /// Before an axis, by its letter or its number: a part of a pose, whose name in a convention begins so.
    Part(&'static str),
    /// Before an axis by its letter alone: the place of a pose.
    Place,
    /// Beside a joint: a reading.
    Reading,
    /// Beside a joint or a position: what was wanted, and other quantities.
    Other,
    /// In the name of a joint.
    InJoint,
    /// In the name of what was measured.
    InMeasured,
    /// In the name of a column that says how good another one is.
    InStatistic,
    /// Before x, y and z without anything between, in a file whose columns are guessed.
    Guessed,
    /// The coordinates of a position that is guessed.
    Axes,
    /// A set of coordinates that was wanted or computed.
    NominalSet,
    /// A set of coordinates that was measured.
    MeasuredSet,
}

/// Words of each role in small letters and digits, but for our own; the first that a file has is meant.
const ROLES: &[(Role, &str)] = &[
    (
        Role::Ours,
        "x y z qx qy qz qw rx ry rz roll pitch yaw target instrument pair sigma_position sigma_x sigma_y sigma_z sigma_rotation id set",
    ),
    (Role::Joint, "q j a joint axis theta th jnt jointposition jointangle angle"),
    (Role::Time, "time t timestamp stamp times timeseconds seconds elapsed"),
    (Role::Picture, "image picture file filename"),
    (Role::Frame, "frame imageid"),
    (Role::Row, "name id index"),
    (Role::Corner, "target corner cornerid id index mark point marker"),
    (Role::Pixel, "u v"),
    (Role::Pixel, "column row"),
    (Role::Pixel, "col row"),
    (Role::Pixel, "xpx ypx"),
    (Role::Pixel, "px py"),
    (Role::Pixel, "pixelx pixely"),
    (Role::Pixel, "imagex imagey"),
    (Role::PixelSigma, "sigma sigmapx"),
    (Role::Camera, "camera"),
    (Role::Board, "board"),
    (Role::BoardPoint, "target marker corner name"),
    (Role::OnBoard, "obj object"),
    (Role::OfArm, "flange robot tcp base ee tool0 tool gripper arm hand endeffector"),
    (Role::OfTarget, "target board marker camera cam tag pattern object chessboard c"),
    (Role::KeyOfArm, "effector robot flange tcp gripper hand ee arm base fpe fme rpe"),
    (Role::KeyOfTarget, "object tracking target board marker camera cam pattern cpo cmo"),
    (Role::Part(""), "position pos tvec translation trans"),
    (Role::Part("rvec"), "rvec rotvec"),
    (Role::Part("intrinsic"), "intrinsic"),
    (Role::Part("q"), "orientation quaternion quat rotation"),
    (Role::Place, "t p"),
    (Role::Reading, "actual measured meas current act feedback"),
    (
        Role::Other,
        "target desired wanted command commanded cmd goal setpoint reference velocity speed acceleration torque effort moment temperature \
         voltage amps tau error load",
    ),
    (Role::InJoint, "joint axis axe achse gelenk"),
    (Role::InMeasured, "meas actual tracker laser leica prism smr refl point"),
    (Role::InStatistic, "std sigma stdev dev err rms cov noise u95"),
    (Role::Guessed, "p t pos position tcp point meas target"),
    (Role::Axes, "x y z"),
    (Role::Axes, "east north up"),
    (
        Role::NominalSet,
        "nominal nom theoretical theory ideal command commanded cmd desired reference ref design calculated target",
    ),
    (Role::MeasuredSet, "measured measurement meas actual act real laser"),
];

impl Role {
    /// The rows of the role.
    pub(crate) fn rows(self) -> impl Iterator<Item = &'static str> {
        ROLES.iter().filter(move |it| it.0 == self).map(|it| it.1)
    }

    /// Its words.
    pub(crate) fn words(self) -> impl Iterator<Item = &'static str> {
        self.rows().flat_map(|row| row.split(' '))
    }

    /// Whether a name of letters and digits is one of its words.
    pub(crate) fn has(self, name: &str) -> bool {
        self.words().any(|word| word == name)
    }

    /// Whether a name has one of its words in it.
    pub(crate) fn is_in(self, name: &str) -> bool {
        self.words().any(|word| name.contains(word))
    }

    /// What a name begins with of a part of a pose, and what is behind it.
    pub(crate) fn part(name: &str) -> Option<(&'static str, &str)> {
        ROLES.iter().find_map(|(role, words)| {
            let Role::Part(part) = role else { return None };
            Some((*part, words.split(' ').find_map(|word| name.strip_prefix(word))?))
        })
    }
}

/// Letters and digits of a name, small.
pub(crate) fn plain(name: &str) -> String {
    name.chars().filter(|it| it.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// A unit as names of columns have it, in letters of any size.
pub(crate) fn unit_of(word: &str) -> Option<NamedUnit> {
    NamedUnit::parse_any(word).or_else(|_| NamedUnit::parse_any(&word.to_lowercase())).ok()
}

/// The name of a column without the unit that it ends with, as `x_mm`, and that unit.
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
            let is_plain = |word: &&str| *role == Role::Ours || plain(word) == *word;
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
