//! Bodies: parent links of joints, and poses of tip, targets and instruments.

use std::collections::BTreeSet;

use toml::Spanned;

use super::context::Context;
use super::file::{RobotFileConvention, RobotTomlFile, TargetTable};
use poecal_model::robot::{Body, Mass, Robot};
use poecal_numerics::error::{Result, nearest_or_all};

/// Word for the base; the empty name means it too, for the case of a joint with this name.
pub(crate) const BASE: &str = "base";

/// Completes a robot with its branches, targets and instruments.
pub(crate) fn place(context: &Context, file: &RobotTomlFile, robot: &mut Robot) -> Result<()> {
    refuse_in_dh(context, file)?;
    for (index, table) in file.joint.iter().enumerate() {
        let Some(parent) = &table.parent else { continue };
        let of = format!("`parent` of joint `{}`", table.name());
        let body = body(context, robot, parent, &of)?;
        if body.joint().is_some_and(|joint| joint >= index) {
            let message = format!(
                "{of} is joint `{}`, which comes after it, expected one of the joints before: put it after its parent",
                parent.get_ref()
            );
            return Err(context.error(parent.span(), message));
        }
        let before = robot.body_before(index);
        if let Some(joint) = robot.joints.get_mut(index) {
            joint.stands_on = Some(body).filter(|&body| body != before);
        }
    }
    if let Some(on) = &file.tip_on {
        let body = body(context, robot, on, "`tip_on`")?;
        robot.tip = Some(body).filter(|&body| body != robot.tip_body());
    }
    let mut names = BTreeSet::new();
    for target in &file.target {
        let name = name(context, target, "target", &mut names)?;
        let pose = context.pose(&target.pose(), &format!("target `{name}`"))?;
        match &target.on {
            None => robot.targets.push((name, pose)),
            Some(on) => {
                let body = body(context, robot, on, &format!("`on` of target `{name}`"))?;
                robot.mounted.push(robot.mount(&name, body, &pose));
            }
        }
    }
    let mut names = BTreeSet::new();
    for instrument in &file.instrument {
        let name = name(context, instrument, "instrument", &mut names)?;
        let of = format!("instrument `{name}`");
        let pose = context.pose(&instrument.pose(), &of)?;
        let Some(on) = &instrument.on else {
            let message = format!(
                "{of} has no `on`, expected the joint whose link it is on, or `{BASE}`: an instrument beside the robot is left out"
            );
            return Err(context.error(instrument.name.span(), message));
        };
        let body = body(context, robot, on, &format!("`on` of {of}"))?;
        robot.instruments.push(robot.mount(&name, body, &pose));
    }
    masses(context, file, robot)
}

/// Masses of the links.
fn masses(context: &Context, file: &RobotTomlFile, robot: &mut Robot) -> Result<()> {
    for mass in &file.mass {
        let body = body(context, robot, &mass.on, "`on` of the mass")?;
        let place = context.metres(*mass.position.get_ref(), mass.position.span(), "`position` of the mass")?;
        if body == Body::Base {
            let message = "found a mass on the base, expected one that a joint moves: leave it out".to_owned();
            return Err(context.error(mass.on.span(), message));
        }
        let kg = *mass.kg.get_ref();
        if !Mass::is_mass(kg) {
            let message = format!("found the mass {kg}, expected kilograms above 0 and at most 1e6");
            return Err(context.error(mass.kg.span(), message));
        }
        robot.masses.push(Mass { body, place: place.into(), kg });
    }
    Ok(())
}

/// A name, unique within its kind.
fn name<'a>(context: &Context, table: &'a TargetTable, what: &str, names: &mut BTreeSet<&'a String>) -> Result<String> {
    let name = context.name(&table.name, &format!("the {what}"))?;
    if !names.insert(table.name.get_ref()) {
        let message = format!("found a second {what} named `{name}`, expected unique {what} names");
        return Err(context.error(table.name.span(), message));
    }
    Ok(name)
}

/// The link of the joint of this name, or the base.
fn body(context: &Context, robot: &Robot, name: &Spanned<String>, of: &str) -> Result<Body> {
    let word = name.get_ref();
    let named = robot.joints.iter().position(|joint| joint.name == *word);
    match named {
        Some(joint) => Ok(Body::Link(joint)),
        None if word == BASE || word.is_empty() => Ok(Body::Base),
        None => {
            let names: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
            let known = nearest_or_all(word, &names);
            let message = format!("{of} is `{word}`, expected a joint of this model or `{BASE}`, {known}");
            Err(context.error(name.span(), message))
        }
    }
}

/// A DH table is a chain: each row begins at the end of the row before.
fn refuse_in_dh(context: &Context, file: &RobotTomlFile) -> Result<()> {
    if file.convention == RobotFileConvention::Screws {
        return Ok(());
    }
    let parents = file.joint.iter().filter_map(|table| Some((table.parent.as_ref()?.span(), "parent")));
    let places = file.target.iter().chain(&file.instrument);
    let places = places.filter_map(|table| Some((table.on.as_ref()?.span(), "on")));
    let tip = file.tip_on.iter().map(|on| (on.span(), "tip_on"));
    match parents.chain(tip).chain(places).next() {
        Some((span, key)) => {
            let message = format!(
                "found `{key}` in a DH model, expected a model of screws for a robot with branches: a DH table is a chain from base to tip"
            );
            Err(context.error(span, message))
        }
        None => Ok(()),
    }
}
