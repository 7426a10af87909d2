//! Options that contradict each other, the robot or the measurements.

use crate::{CalibrationOptions, Corrections, Formulation};
use poecal_fit::state::Unknowns;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{GravityDirection, Robot, TermGroup};
use poecal_numerics::error::{ErrorKind, Result};

/// Refuses options that contradict each other or the measurements.
pub(crate) fn refuse_options(data: &Dataset, options: &CalibrationOptions) -> Result<()> {
    if let GravityDirection::Known(direction) = options.gravity
        && !GravityDirection::is_direction(&direction)
    {
        return refuse_found("a gravity without direction, expected three numbers, not all of them 0");
    }
    if let Some(name) = data.targets.iter().flatten().next().filter(|_| options.move_tip) {
        return refuse_found(&format!(
            "--move-tip beside rows of the target `{name}`, expected rows without a name: leave the column `target` out, or the option"
        ));
    }
    if options.formulation == Formulation::default() {
        return Ok(());
    }
    let found = if matches!(options.corrections, Corrections::All | Corrections::Sizes(_)) {
        "terms of the joints (corrections)"
    } else if options.gravity != GravityDirection::default() {
        "a direction of gravity"
    } else if options.chooses_tolerance {
        "a tolerance that cross-validation chooses"
    } else {
        return Ok(());
    };
    refuse_found(&format!(
        "{found} with a formulation of its own, expected the usual formulation: leave one of both out"
    ))
}

/// The corrections of a fit of these unknowns: none if terms beside held or reparameterised screws would replace the screws. Refuses corrections that
/// the robot does not allow.
pub(crate) fn allowed_corrections(
    robot: &Robot,
    unknowns: &Unknowns,
    options: &CalibrationOptions,
) -> Result<Corrections> {
    let moves_all = (0..robot.joints.len()).all(|joint| unknowns.moves_axis(joint));
    match options.corrections {
        Corrections::Sizes(sizes) => {
            let needed = [
                (TermGroup::Backlash, "approach or approach_JOINT"),
                (TermGroup::Payload, "payload"),
                (TermGroup::Factors, "temperature or another column"),
            ];
            let lacks = |group| !robot.factors.iter().any(|it| it.group() == group);
            if let Some((group, column)) = needed.into_iter().find(|(group, _)| sizes[*group] > 0.0 && lacks(*group)) {
                refuse_found(&format!(
                    "{} among the corrections and no factor for it, expected {column} among the factors (--factors)",
                    group.name()
                ))?;
            }
        }
        Corrections::All if !moves_all => refuse_found(
            "corrections `all` beside axes that are held, expected all axes fitted, or groups of terms by name",
        )?,
        Corrections::Auto if !moves_all || options.formulation != Formulation::default() => {
            return Ok(Corrections::Off);
        }
        Corrections::Auto | Corrections::All | Corrections::Off => {}
    }
    Ok(options.corrections)
}

fn refuse_found(found: &str) -> Result<()> {
    ErrorKind::Option.refuse(format!("found {found}"))
}
