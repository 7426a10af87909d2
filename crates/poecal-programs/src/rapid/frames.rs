//! Tools and work objects of RAPID as poses.

use super::super::forms::PoseForm;
use super::super::parsed_program::Number;
use super::tokens::RapidValue;
use poecal_arm::lie::Pose;

/// Largest deviation of a quaternion's length from 1.
const LENGTH: f64 = 5e-3;

/// True if a quaternion has about the length 1.
pub(crate) fn has_length(quaternion: &[Number]) -> bool {
    (quaternion.iter().map(|it| it.value * it.value).sum::<f64>().sqrt() - 1.0).abs() < LENGTH
}

/// The pose `[[x, y, z], [q1, q2, q3, q4]]`.
fn frame(value: &RapidValue) -> Option<Pose> {
    let [place, quaternion] = value.list(2)? else { return None };
    let (place, quaternion) = (place.numbers(3)?, quaternion.numbers(4)?);
    let all: Vec<f64> = place.iter().chain(&quaternion).map(|it| it.value).collect();
    PoseForm::Quaternion.pose(&all).filter(|_| has_length(&quaternion))
}

/// `flange_from_tool` of a `tooldata`, or the reason why it is not known.
pub(crate) fn tool(value: &RapidValue) -> Result<Pose, &'static str> {
    const SHAPE: &str = "is not written as [TRUE,[[x,y,z],[q1,q2,q3,q4]],[load]] with numbers";
    let [held, pose, _] = value.list(3).ok_or(SHAPE)? else { return Err(SHAPE) };
    if held.is("false") {
        return Err("is not held by the robot");
    }
    if held.is("true") { frame(pose).ok_or(SHAPE) } else { Err(SHAPE) }
}

/// `base_from_object` of a `wobjdata`, or the reason why it is not known.
pub(crate) fn work_object(value: &RapidValue) -> Result<Pose, &'static str> {
    const SHAPE: &str = "is not written as [FALSE,TRUE,\"\",[uframe],[oframe]] with numbers";
    let [held, is_fixed, unit, user, object] = value.list(5).ok_or(SHAPE)? else { return Err(SHAPE) };
    if held.is("true") {
        return Err("is held by the robot");
    }
    if is_fixed.is("false") || *unit == RapidValue::Text(false) {
        return Err("moves with a mechanical unit");
    }
    if !held.is("false") || !is_fixed.is("true") || *unit != RapidValue::Text(true) {
        return Err(SHAPE);
    }
    Ok(frame(user).ok_or(SHAPE)? * frame(object).ok_or(SHAPE)?)
}
