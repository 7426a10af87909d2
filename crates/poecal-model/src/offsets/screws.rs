//! Offsets written into screws, and robots that can be compared joint by joint.

use crate::robot::{Body, Robot};
use poecal_arm::lie::Pose;
use poecal_numerics::error::{ErrorKind, Result};

/// The robot without offsets that is exactly `robot` with `offsets` added to its joint values (radians, metres; one a joint). `ξ'ᵢ
/// = Ad(Gᵢ₋₁) ξᵢ`, `M' = Gₙ M` with `Gᵢ = exp(ξ₁δ₁) … exp(ξᵢδᵢ)`, so that `f'(θ) = f(θ + δ)` for every θ (theory.md §8 (38a)).
///
/// A joint's frame is fixed to the link that the joint moves and moves by `Gᵢ`, its own rotation included. Limits stay, since they bound
/// readings. The offset of a mimic joint is that of its own value.
///
/// # Errors
/// [`ErrorKind::Option`] if there is not one finite offset for each joint.
pub fn into_screws(robot: &Robot, offsets: &[f64]) -> Result<Robot> {
    if offsets.len() != robot.joints.len() {
        return ErrorKind::Option.refuse(format!(
            "found {} offsets for robot `{}`, expected one for each of its {} joints",
            offsets.len(),
            robot.name,
            robot.joints.len()
        ));
    }
    let mut equivalent = robot.clone();
    // Motion of each joint's link from its pose without offsets.
    let mut motions: Vec<Pose> = Vec::with_capacity(offsets.len());
    let of = |motions: &[Pose], body: Body| {
        body.joint().and_then(|joint| motions.get(joint)).copied().unwrap_or_else(Pose::identity)
    };
    for (index, (joint, &offset)) in equivalent.joints.iter_mut().zip(offsets).enumerate() {
        if !offset.is_finite() {
            return ErrorKind::Option
                .refuse(format!("found the offset {offset} of joint `{}`, expected a finite one", joint.name));
        }
        let screw = joint.screw;
        let before = of(&motions, robot.body_before(index));
        joint.screw = screw.transform(&before);
        let motion = (before * screw.exp(offset)).orthonormalized();
        joint.frame = (motion * joint.frame).orthonormalized();
        motions.push(motion);
    }
    equivalent.home = (of(&motions, robot.tip_body()) * robot.home).orthonormalized();
    Ok(equivalent)
}

pub(crate) fn check_same_joints(nominal: &Robot, actual: &Robot) -> Result<()> {
    let differ = |message: String| ErrorKind::Option.refuse(message);
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
