//! Calibrated numbers in a URDF that the user names: the one that was calibrated, or one with the same kinematics.

use std::path::Path;

use super::{SAME, export_error, is_same, remaining_difference};
use crate::model::{Model, ModelSource, verify};
use poecal_arm::lie::rotation;
use poecal_formats::urdf::{ChainSelection, ConvertedModel, UrdfDocument, holdable};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::hashes::sha256_of;
use poecal_storage::source_text;

/// Writes the calibrated numbers of a calibration into the text of a URDF; all other bytes remain. `selection` states the calibrated part of it, if
/// the calibration does not.
///
/// # Errors
/// [`ErrorKind::Option`] if the model is no calibration; [`ErrorKind::Export`] if the URDF is another robot than the one that was calibrated;
/// as [`UrdfDocument::read`] and [`crate::model::convert`].
pub fn write_onto(calibration: &Model, urdf: &Path, selection: &ChainSelection) -> Result<ConvertedModel> {
    let ModelSource::Calibration(file) = &calibration.source else {
        return Err(ErrorKind::Option
            .error("found a model, expected the calibration.json whose numbers are written into the URDF")
            .in_file(&calibration.path));
    };
    let text = source_text::read(urdf, "a URDF robot description")?;
    let kept = file.inputs.urdf.as_ref();
    let named = *selection != ChainSelection::default();
    let of_robot = || ChainSelection {
        base_link: Some(calibration.robot.base_name.clone()),
        tip_link: Some(calibration.robot.tip_name.clone()),
        ..ChainSelection::default()
    };
    let selection = match (named, kept) {
        (true, _) => selection.clone(),
        (false, Some(kept)) => kept.selection(),
        (false, None) => of_robot(),
    };
    let document = UrdfDocument::parse(&text, urdf, &selection)?;
    let mut notes = Vec::new();
    if kept.is_none_or(|kept| kept.sha256 != sha256_of(&text)) {
        let original = file.original_urdf(&calibration.path)?;
        let nominal = match &original {
            Some(original) => original.robot().clone(),
            None => file.nominal_robot().map_err(|error| error.in_file(&calibration.path))?,
        };
        refuse_other(&nominal, document.robot(), urdf, original.is_some())?;
        if kept.is_some() {
            notes.push(format!(
                "{} is not the text that was calibrated (its SHA-256 is another), but has the same kinematics",
                urdf.display()
            ));
        }
    }
    let plain = holdable(&calibration.robot, &mut notes);
    let patched = document.patch(&plain)?;
    notes.extend(patched.notes);
    let again = UrdfDocument::parse(&patched.text, urdf, &patched.selection)
        .map_err(|error| export_error(format!("the URDF cannot be read back: {}", error.message())))?;
    verify(calibration, &plain, again.robot())?;
    Ok(ConvertedModel { text: patched.text, notes })
}

/// Refuses a URDF that differs from the nominal robot of the calibration, whose joint frames may be known.
fn refuse_other(nominal: &Robot, found: &Robot, urdf: &Path, has_frames: bool) -> Result<()> {
    let refuse = |message: String| Err(ErrorKind::Export.error(message).in_file(urdf));
    let names = |robot: &Robot| -> Vec<String> { robot.joints.iter().map(|it| it.name.clone()).collect() };
    let (expected, own) = (names(nominal), names(found));
    if let Some(name) = own.iter().find(|name| !expected.contains(name)) {
        return refuse(format!(
            "found the joint `{name}`, expected those of the robot that was calibrated: {}",
            expected.join(", ")
        ));
    }
    if expected != own {
        return refuse(format!("found the joints {}, expected {}", own.join(", "), expected.join(", ")));
    }
    let off = remaining_difference(nominal, found);
    let bound_m = SAME * nominal.reach_m().max(1.0);
    if is_same(nominal, &off) {
        return Ok(());
    }
    // The first joint whose frame on its link differs.
    let on_link = |robot: &Robot, at: usize| {
        let below = at.checked_sub(1).and_then(|below| robot.joints.get(below));
        let joint = robot.joints.get(at)?;
        Some(below.map_or(joint.frame, |below| below.frame.inverse() * joint.frame))
    };
    let moved = (0..nominal.joints.len()).filter(|_| has_frames).find_map(|at| {
        let (a, b) = (on_link(nominal, at)?, on_link(found, at)?);
        let shift = (a.translation - b.translation).norm();
        let turn = rotation::log(&(a.rotation.transpose() * b.rotation)).norm();
        (shift > bound_m || turn > SAME).then(|| (nominal.joints[at].name.clone(), shift, turn))
    });
    let where_ = moved.map_or_else(
        || "its tip".to_owned(),
        |(name, shift, turn)| {
            format!("joint `{name}`, which is {:.3} mm and {:.4} deg from there", shift * 1e3, turn.to_degrees())
        },
    );
    refuse(format!(
        "found a robot whose tip is up to {:.3} mm and {:.4} deg off the one that was calibrated, first at {where_}, expected the same numbers: \
         apply to the URDF that was calibrated, or calibrate with this one",
        off.position_m * 1e3,
        off.rotation_rad.to_degrees()
    ))
}
