//! `poecal export --offset`: a robot whose joints have other readings.

use poecal_model::offsets::into_screws;
use poecal_model::robot::{JointKind, Robot};
use poecal_numerics::error::{ErrorKind, Result, nearest_word};
use poecal_numerics::unit::Unit;
use poecal_results::model::Model;

use crate::console::Console;
use crate::quantity::parse_signed;

/// The model with offsets of its joints in the screws, and a warning if others follow such a joint.
pub(super) fn with_offsets(model: Model, stated: &[String], console: &Console) -> Result<Model> {
    if stated.is_empty() {
        return Ok(model);
    }
    let offsets = offsets(stated, &model.robot)?;
    for (joint, _) in model.robot.joints.iter().zip(&offsets).filter(|(_, offset)| **offset != 0.0) {
        let followers = model.robot.followers(&joint.name);
        if !followers.is_empty() {
            console.warning(format!(
                "--offset: joint `{}` alone is moved, not {}, which follows its reading; if its encoder is off, so are these, by \
                 their multiplier: state their offsets too",
                joint.name,
                quote_names(&followers)
            ));
        }
    }
    Ok(Model { robot: into_screws(&model.robot, &offsets)?, ..model })
}

/// Offsets of `--offset JOINT=VALUE`, in the order of the joints.
fn offsets(stated: &[String], robot: &Robot) -> Result<Vec<f64>> {
    let mut offsets = vec![None; robot.joints.len()];
    for text in stated {
        let bad = |message: String| ErrorKind::Option.error(format!("--offset: {message}"));
        let (name, value) = text.rsplit_once('=').ok_or_else(|| {
            bad(format!("found `{text}`, expected a joint and its offset, like joint2=0.5deg or slide=1.2mm"))
        })?;
        let mut joints = robot.joints.iter().zip(&mut offsets);
        let Some((joint, offset)) = joints.find(|(joint, _)| joint.name == name) else {
            return Err(bad(unknown_joint(name, robot)));
        };
        let quantity = match joint.kind {
            JointKind::Revolute => Unit::Radian,
            JointKind::Prismatic => Unit::Metre,
        };
        let value = parse_signed(value, quantity).map_err(|error| bad(format!("joint `{name}`: {error}")))?;
        if offset.replace(value).is_some() {
            return Err(bad(format!("found joint `{name}` twice, expected one offset a joint")));
        }
    }
    Ok(offsets.into_iter().map(|offset| offset.unwrap_or(0.0)).collect())
}

/// Names for a message.
pub(super) fn quote_names(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

fn unknown_joint(name: &str, robot: &Robot) -> String {
    let names: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    let hint =
        nearest_word(name, names.iter().copied()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    format!("found no moving joint `{name}`, expected one of {}{hint}", names.join(", "))
}
