//! Joint offsets and the screws that are equivalent to them: a robot with offsets written without, and the offsets that explain best
//! how one robot differs from another (theory.md §8, lou2009 equations 11 to 15).

mod at_tip;
mod changes;
mod fit;
mod prediction;
mod start;
mod taught;

pub use changes::JointChange;
pub(crate) use changes::{ChangeBySteps, Changes, direction};
pub use prediction::TipError;
pub(crate) use taught::{Taught, with_tool_of};

use crate::error::{Error, ErrorKind, Result};
use crate::lie::{Pose, rotation};
use crate::robot::{Body, JointKind, Robot};
use at_tip::TipFit;
use fit::{Comparison, OffsetState};
use prediction::Predictions;

/// The robot without offsets that is exactly `robot` with `offsets` added to its joint values (radians, metres; one a joint):
/// `ξ'ᵢ = Ad(Gᵢ₋₁) ξᵢ`, `M' = Gₙ M` with `Gᵢ = exp(ξ₁δ₁) … exp(ξᵢδᵢ)`, so that `f'(θ) = f(θ + δ)` for every θ (theory.md §8 (38a)).
///
/// A joint's frame is fixed to the link that the joint moves and moves by `Gᵢ`, its own rotation included. Limits stay, since they bound
/// readings. The offset of a mimic joint is that of its own value.
///
/// # Errors
/// [`ErrorKind::Option`] if there is not one finite offset for each joint.
pub fn into_screws(robot: &Robot, offsets: &[f64]) -> Result<Robot> {
    if offsets.len() != robot.joints.len() {
        let message = format!(
            "found {} offsets for robot `{}`, expected one for each of its {} joints",
            offsets.len(),
            robot.name,
            robot.joints.len()
        );
        return Err(Error::new(ErrorKind::Option, message));
    }
    let mut equivalent = robot.clone();
    // Of each joint's link, from its place without offsets.
    let mut motions: Vec<Pose> = Vec::with_capacity(offsets.len());
    let of = |motions: &[Pose], body: Body| {
        body.joint().and_then(|joint| motions.get(joint)).copied().unwrap_or_else(Pose::identity)
    };
    for (index, (joint, &offset)) in equivalent.joints.iter_mut().zip(offsets).enumerate() {
        if !offset.is_finite() {
            let message =
                format!("found the offset {offset} of joint `{}`, expected a finite one", joint.name);
            return Err(Error::new(ErrorKind::Option, message));
        }
        let screw = joint.screw;
        let before = of(&motions, robot.body_before(index));
        joint.screw = screw.transformed(&before);
        let motion = (before * screw.exp(offset)).orthonormalized();
        joint.frame = (motion * joint.frame).orthonormalized();
        motions.push(motion);
    }
    equivalent.home = (of(&motions, robot.tip_body()) * robot.home).orthonormalized();
    Ok(equivalent)
}

/// Whether one end of the robot may move to explain a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Both robots have the same frame there.
    Kept,
    /// The frame is found with the offsets.
    Free,
}

impl End {
    /// The word used in files and options: `kept` or `free`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            End::Kept => "kept",
            End::Free => "free",
        }
    }
}

/// Configurations in which the tips are compared: what remains is within 1 %.
const CONFIGURATIONS: usize = 10_000;

/// Options of [`explain`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OffsetOptions {
    /// The base frame: free where the actual robot's is a choice.
    pub base: End,
    /// The tip frame: free where the tool was changed or refitted.
    pub tip: End,
    /// Number of random configurations in which the tips are compared.
    pub configurations: usize,
    /// Seed of these.
    pub seed: u64,
}

impl Default for OffsetOptions {
    fn default() -> Self {
        OffsetOptions { base: End::Kept, tip: End::Kept, configurations: CONFIGURATIONS, seed: 1 }
    }
}

/// Difference of a joint's screw that offsets do not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointRemainder {
    /// Angle between the directions, radians.
    pub tilt_rad: f64,
    /// Distance of the axis from the actual joint's origin, metres; none for a sliding joint.
    pub shift_m: Option<f64>,
}

/// Difference of the home pose that offsets do not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomeRemainder {
    /// Distance of the tips at zero, metres.
    pub position_m: f64,
    /// Angle between the tip frames at zero, radians.
    pub rotation_rad: f64,
}

/// The offsets with which one robot comes nearest to another, and the remaining differences.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// How the robots were compared.
    pub options: OffsetOptions,
    /// Offset of each joint's value, radians in (-π, π] or metres.
    pub offsets: Vec<f64>,
    /// Joints (by index) whose offsets are not determined, alone or in combination; theirs are the smallest that explain as much.
    pub undetermined: Vec<usize>,
    /// Motion of the nominal robot in the base frame; none where the base is kept.
    pub base_motion: Pose,
    /// `tip_from_tip` from the nominal tip to the actual one; none where the tip is kept.
    pub tip_motion: Pose,
    /// Remaining difference of each joint.
    pub joints: Vec<JointRemainder>,
    /// Remaining difference of the home pose; none where the tip is free.
    pub home: Option<HomeRemainder>,
    /// Error of the nominal robot's tip against the actual one's, with the best base and tip where these are free.
    pub without_offsets: TipError,
    /// The same with the offsets put in.
    pub with_offsets: TipError,
}

/// The offsets, and the motions of base and tip where these are free, with which the tip of `nominal` comes nearest to that of `actual`: least
/// squares of its places and of its turns, at a tenth of a metre, in random configurations within the limits of `nominal` (theory.md §8 (38d)), from
/// those with which the screws and the home pose come nearest (38b), which also decide where no tip does. Offsets may be of any size. It is what a controller gains that takes
/// offsets, a base and a tool, and nothing else.
///
/// # Errors
/// [`ErrorKind::Option`] if the robots do not have the same joints (number, names in order, kinds and readings), or have branches.
pub fn explain(nominal: &Robot, actual: &Robot, options: &OffsetOptions) -> Result<Explanation> {
    explained(nominal, actual, options, true)
}

/// The same by the screws alone, (38b): where [`explain`] starts.
///
/// # Errors
/// As [`explain`].
pub fn explain_screws(nominal: &Robot, actual: &Robot, options: &OffsetOptions) -> Result<Explanation> {
    explained(nominal, actual, options, false)
}

fn explained(nominal: &Robot, actual: &Robot, options: &OffsetOptions, at_tip: bool) -> Result<Explanation> {
    check_same_joints(nominal, actual)?;
    let (nominal, actual) = (&nominal.without_offsets(), &actual.without_offsets());
    let comparison = Comparison::new(nominal, actual, options);
    let found = comparison.best();
    let unmoved = comparison.best_without_offsets();
    let undetermined = comparison.undetermined(&found);
    let predictions = Predictions::new(nominal, actual, options);
    let nearest = |moves_offsets: bool, state: OffsetState| {
        let length_m = comparison.length_m;
        let fit = TipFit { nominal, predictions: &predictions, options, moves_offsets, length_m };
        if at_tip {
            return fit.nearest(state);
        }
        fit.compared(&state).map(|(tip_motion, left)| (state, tip_motion, left))
    };
    let (found, tip_motion, with_offsets) = nearest(true, found)?;
    let (_, _, without_offsets) = nearest(false, unmoved)?;
    let (joints, home) = remainder(&comparison, &found);
    Ok(Explanation {
        options: *options,
        undetermined,
        offsets: found.offsets,
        base_motion: found.base,
        tip_motion,
        joints,
        home,
        without_offsets,
        with_offsets,
    })
}

fn remainder(
    comparison: &Comparison<'_>,
    found: &OffsetState,
) -> (Vec<JointRemainder>, Option<HomeRemainder>) {
    let (screws, home) = comparison.moved(found);
    let actual = comparison.actual;
    let joints = screws.iter().zip(&actual.joints).map(|(screw, joint)| {
        let (direction, goal) = (screw.direction(), joint.screw.direction());
        let tilt_rad = direction.cross(&goal).norm().atan2(direction.dot(&goal));
        let origin = joint.screw.nearest_point(&joint.frame.translation);
        let shift_m =
            (joint.kind == JointKind::Revolute).then(|| (screw.nearest_point(&origin) - origin).norm());
        JointRemainder { tilt_rad, shift_m }
    });
    let home = (comparison.options.tip == End::Kept).then(|| HomeRemainder {
        position_m: (home.translation - actual.home.translation).norm(),
        rotation_rad: rotation::log(&(home.rotation * actual.home.rotation.transpose())).norm(),
    });
    (joints.collect(), home)
}

fn check_same_joints(nominal: &Robot, actual: &Robot) -> Result<()> {
    let differ = |message: String| Err(Error::new(ErrorKind::Option, message));
    for (robot, which) in [(nominal, "nominal"), (actual, "actual")] {
        if !robot.is_serial() {
            return differ(format!(
                "found branches or joints beyond the tip in the {which} robot, expected a serial chain: offsets are explained from base to \
                 tip, choose one chain with --base-link and --tip-link"
            ));
        }
    }
    if nominal.joints.len() != actual.joints.len() {
        return differ(format!(
            "found an actual robot of {} joints, expected the {} of the nominal one: compare two models of one robot",
            actual.joints.len(),
            nominal.joints.len()
        ));
    }
    for (index, (expected, found)) in nominal.joints.iter().zip(&actual.joints).enumerate() {
        if expected.name != found.name {
            return differ(format!(
                "found joint `{}` at place {} of the actual robot, expected `{}` as in the nominal one: compare two models of one robot",
                found.name,
                index + 1,
                expected.name
            ));
        }
        if expected.kind != found.kind {
            return differ(format!(
                "found the {} joint `{}` in the actual robot, expected a {} one as in the nominal robot",
                found.kind.word(),
                found.name,
                expected.kind.word()
            ));
        }
        if expected.reading != found.reading {
            return differ(format!(
                "found joint `{}` with another relation to its reading in the actual robot, expected the same mimic relation as in the nominal one",
                found.name
            ));
        }
    }
    Ok(())
}
