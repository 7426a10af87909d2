//! Robots from the tables of the file.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use toml::Spanned;

use super::context::{Context, TABLE_ROUNDING, span};
use super::file::{JointTable, PoseTable, RobotFileConvention, RobotTomlFile, ScrewTable};
use super::mounts;
use crate::mimic;
use poecal_arm::lie::{Pose, Screw, Twist};
use poecal_model::robot::{
    DhRow, DhTableConvention, Joint, JointKind, JointLimits, JointTerm, Reading, Robot, Tolerance,
};
use poecal_numerics::error::Result;
use poecal_numerics::unit::Unit;

/// Largest `v·ω` that counts as rounding, as a share of the robot's size.
const PITCH_ROUNDING: f64 = 1e-3;

pub(crate) fn robot(context: &Context, file: &RobotTomlFile) -> Result<Robot> {
    check_version(context, file)?;
    let name = context.name(&file.name, "the robot")?;
    check_joint_names(context, file)?;
    let mut robot = match file.convention {
        RobotFileConvention::Screws => from_screws(context, file, &name)?,
        RobotFileConvention::StandardDh => from_dh(context, file, &name, DhTableConvention::Standard)?,
        RobotFileConvention::ModifiedDh => from_dh(context, file, &name, DhTableConvention::Modified)?,
    };
    let tables: BTreeMap<&str, &JointTable> = file.joint.iter().map(|table| (table.name(), table)).collect();
    for (joint, table) in robot.joints.iter_mut().zip(&file.joint) {
        joint.limits = limits(context, table)?;
        joint.reading = reading(context, &tables, table)?;
        joint.tolerance = tolerance(context, table)?;
    }
    if let Some(base) = &file.base_link {
        robot.base_name = context.name(base, "the base link")?;
    }
    if let Some(tip) = &file.tip_link {
        robot.tip_name = context.name(tip, "the tip link")?;
        if robot.tip_name == robot.base_name {
            let message = format!("base and tip are both named `{}`, expected two names", robot.tip_name);
            return Err(context.error(tip.span(), message));
        }
    }
    for (joint, table) in file.joint.iter().enumerate() {
        for (&term, value) in &table.terms {
            let found = match table.kind.unit_of(term) {
                Unit::Metre => context.length.to_metres(*value.get_ref()),
                Unit::Radian => context.angle.to_radians(*value.get_ref()),
                Unit::One | Unit::Second => *value.get_ref(),
            };
            let of = format!("{term} of joint `{}`", table.name());
            if term.needs_gravity() || !term.is_of(file.joint.len(), 0) {
                let message = format!(
                    "found the term {of}, expected one of offset, ratio, sin1, cos1, …, or coupled1 to coupled{}: weights are in a calibration.json",
                    file.joint.len()
                );
                return Err(context.error(value.span(), message));
            }
            let [coefficient] = context.check_numbers([found], value.span(), &of)?;
            robot.terms.push(JointTerm { joint, term, coefficient });
        }
    }
    mounts::place(context, file, &mut robot)?;
    Ok(robot)
}

/// Tolerance of a joint's axis, if the table states one.
fn tolerance(context: &Context, table: &JointTable) -> Result<Option<Tolerance>> {
    let Some(stated) = &table.tolerance else { return Ok(None) };
    let found = Tolerance {
        angle_rad: context.angle.to_radians(stated.get_ref().angle),
        length_m: context.length.to_metres(stated.get_ref().length),
    };
    if [found.angle_rad, found.length_m].iter().all(|value| value.is_finite() && *value > 0.0) {
        return Ok(Some(found));
    }
    let message = format!(
        "the tolerance of joint `{}` is not above 0, expected standard deviations, like {{ angle = 0.5, length = 5 }} in degrees and mm",
        table.name()
    );
    Err(context.error(stated.span(), message))
}

fn check_version(context: &Context, file: &RobotTomlFile) -> Result<()> {
    let version = *file.poecal_robot.get_ref();
    if version == 1 {
        return Ok(());
    }
    let message = format!("found version {version} of the robot format, expected poecal_robot = 1");
    Err(context.error(file.poecal_robot.span(), message))
}

fn check_joint_names(context: &Context, file: &RobotTomlFile) -> Result<()> {
    let mut names = BTreeSet::new();
    for joint in &file.joint {
        context.name(&joint.name, "the joint")?;
        if !names.insert(joint.name()) {
            let message = format!("found a second joint named `{}`, expected unique joint names", joint.name());
            return Err(context.error(joint.name.span(), message));
        }
    }
    Ok(())
}

fn from_screws(context: &Context, file: &RobotTomlFile, name: &str) -> Result<Robot> {
    context.refuse([("base", span(&file.base)), ("tool", span(&file.tool))], |key| {
        format!("found [{key}] in a model of screws, expected [home] only: it holds the tip's pose")
    })?;
    let Some(home) = &file.home else {
        let message = "found no [home], expected it: the tip's pose in the base at zero joint values".to_owned();
        return Err(context.error(0..0, message));
    };
    let home = context.pose(home.get_ref(), "[home]")?;
    let size = size_m(context, file, &home);
    let joints = file.joint.iter().map(|joint| screw_joint(context, joint, size)).collect::<Result<_>>()?;
    Robot::new(name, joints, home).map_err(|error| error.in_file(context.path))
}

/// A length that characterises the size of the robot, metres.
fn size_m(context: &Context, file: &RobotTomlFile, home: &Pose) -> f64 {
    let metres = |numbers: [f64; 3]| context.length.to_metres(Vector3::from(numbers).norm());
    file.joint
        .iter()
        .filter(|joint| joint.kind == JointKind::Revolute)
        .filter_map(|joint| joint.screw.as_ref())
        .map(|screw| metres(screw.get_ref().v))
        .fold(home.translation.norm().max(0.01), f64::max)
}

fn screw_joint(context: &Context, table: &JointTable, size_m: f64) -> Result<Joint> {
    let name = table.name();
    let dh = [("a", &table.a), ("alpha", &table.alpha), ("d", &table.d), ("theta", &table.theta)];
    context.refuse(dh.map(|(key, value)| (key, span(value))), |key| {
        format!(
            "joint `{name}` has the DH parameter `{key}`, expected `screw`, or `point` and `direction`: for a DH table state convention = \"standard_dh\" or \"modified_dh\""
        )
    })?;
    context.refuse([("fixed", span(&table.fixed))], |key| {
        format!(
            "joint `{name}` has `{key}`, expected it in a DH table only: a screw says where its axis stands in the base, whatever \
             lies between"
        )
    })?;
    let kind = table.kind;
    let error = |message: String| Err(context.error(table.name.span(), message));
    match (&table.screw, &table.point, &table.direction) {
        (Some(screw), None, None) => {
            let screw = screw_of_table(context, name, kind, screw, size_m)?;
            Ok(joint_of_screw(name, kind, screw, None))
        }
        (None, point, Some(direction)) if kind == JointKind::Prismatic || point.is_some() => {
            joint_of_line(context, name, kind, point.as_ref(), direction)
        }
        (Some(_), ..) => {
            error(format!("joint `{name}` has a screw and a point or direction, expected one or the other"))
        }
        _ => error(format!(
            "joint `{name}` has no axis, expected screw = {{ v = [...], w = [...] }}, or point and direction (a prismatic joint: direction)"
        )),
    }
}

fn joint_of_screw(name: &str, kind: JointKind, screw: Screw, origin: Option<Vector3<f64>>) -> Joint {
    let mut joint = Joint::with_screw(name, kind, screw);
    joint.frame.translation = origin.unwrap_or(joint.frame.translation);
    joint
}

fn joint_of_line(
    context: &Context,
    name: &str,
    kind: JointKind,
    point: Option<&Spanned<[f64; 3]>>,
    direction: &Spanned<[f64; 3]>,
) -> Result<Joint> {
    let of = format!("joint `{name}`");
    let axis = Vector3::from(context.check_numbers(*direction.get_ref(), direction.span(), &of)?);
    if axis == Vector3::zeros() {
        let message = format!("the direction of {of} is zero, expected a direction, such as [0, 0, 1]");
        return Err(context.error(direction.span(), message));
    }
    // The vector is scaled first, so that tiny numbers do not vanish when squared.
    let axis = axis / axis.amax();
    let point =
        point.map(|point| context.metres(*point.get_ref(), point.span(), &of).map(Vector3::from)).transpose()?;
    let screw = kind.screw(&axis, &point.unwrap_or_default());
    Ok(joint_of_screw(name, kind, screw, point))
}

/// The screw nearest to a rounded table entry.
fn screw_of_table(
    context: &Context,
    name: &str,
    kind: JointKind,
    table: &Spanned<ScrewTable>,
    size_m: f64,
) -> Result<Screw> {
    let of = format!("the screw of joint `{name}`");
    let error = |message: String| Err(context.error(table.span(), message));
    let w = Vector3::from(context.check_numbers(table.get_ref().w, table.span(), &of)?);
    let v = match kind {
        JointKind::Revolute => context.metres(table.get_ref().v, table.span(), &of)?,
        JointKind::Prismatic => context.check_numbers(table.get_ref().v, table.span(), &of)?,
    };
    let v = Vector3::from(v);
    if kind == JointKind::Prismatic && w != Vector3::zeros() {
        return error(format!("{of} has an angular part w, expected w = [0, 0, 0] since the joint is prismatic"));
    }
    let (part, length) = match kind {
        JointKind::Revolute => ("w", w.norm()),
        JointKind::Prismatic => ("v", v.norm()),
    };
    if (length - 1.0).abs() > TABLE_ROUNDING {
        return error(format!(
            "{of} has |{part}| = {length:.4}, expected a unit vector to within {TABLE_ROUNDING} ({} joint)",
            kind.word()
        ));
    }
    let pitch_m = v.dot(&w).abs();
    if kind == JointKind::Revolute && pitch_m > PITCH_ROUNDING * size_m {
        return error(format!(
            "{of} has v·w = {:.3} mm, expected v perpendicular to w to within {:.3} mm (v = -w × a point of the axis)",
            1e3 * pitch_m,
            1e3 * PITCH_ROUNDING * size_m
        ));
    }
    Screw::project(&Twist::new(v, w)).map_or_else(|| error(format!("{of} is zero, expected an axis")), Ok)
}

fn from_dh(context: &Context, file: &RobotTomlFile, name: &str, convention: DhTableConvention) -> Result<Robot> {
    context.refuse([("home", span(&file.home))], |key| {
        format!("found [{key}] in a DH model, expected [base] and [tool]: the home pose follows from the table")
    })?;
    let rows = file.joint.iter().map(|joint| dh_row(context, joint)).collect::<Result<Vec<_>>>()?;
    let pose = |table: &Option<Spanned<PoseTable>>, of| match table {
        Some(table) => context.pose(table.get_ref(), of),
        None => Ok(Pose::identity()),
    };
    let (base, tool) = (pose(&file.base, "[base]")?, pose(&file.tool, "[tool]")?);
    Robot::from_dh(name, convention, &rows, base, tool).map_err(|error| error.in_file(context.path))
}

fn dh_row(context: &Context, table: &JointTable) -> Result<DhRow> {
    let of = format!("joint `{}`", table.name());
    let screw = [("screw", span(&table.screw)), ("point", span(&table.point)), ("direction", span(&table.direction))];
    context
        .refuse(screw, |key| format!("{of} has `{key}`, expected a, alpha, d and theta: the model is a DH table"))?;
    let length = |value: &Option<Spanned<f64>>| match value {
        Some(value) => context.metres([*value.get_ref()], value.span(), &of).map(|[only]| only),
        None => Ok(0.0),
    };
    let angle = |value: &Option<Spanned<f64>>| match value {
        Some(value) => context.radians([*value.get_ref()], value.span(), &of).map(|[only]| only),
        None => Ok(0.0),
    };
    Ok(DhRow {
        name: table.name().to_owned(),
        kind: table.kind,
        a_m: length(&table.a)?,
        alpha_rad: angle(&table.alpha)?,
        d_m: length(&table.d)?,
        theta_rad: angle(&table.theta)?,
        fixed: match &table.fixed {
            Some(fixed) => context.pose(fixed.get_ref(), &format!("`fixed` of {of}"))?,
            None => Pose::identity(),
        },
    })
}

fn limits(context: &Context, table: &JointTable) -> Result<Option<JointLimits>> {
    let Some(limits) = &table.limits else { return Ok(None) };
    let of = format!("limits of joint `{}`", table.name());
    let values = limits.get_ref().map(|value| context.joint_value(table.kind, value));
    let [lower, upper] = context.check_numbers(values, limits.span(), &of)?;
    if lower >= upper {
        let [lower, upper] = limits.get_ref();
        let message = format!("found {of} from {lower} to {upper}, expected [lower, upper] with lower < upper");
        return Err(context.error(limits.span(), message));
    }
    Ok(Some(JointLimits { lower, upper }))
}

/// Reading of a joint, through mimic relations. A leader outside the chain is read too, in the follower's unit.
fn reading(context: &Context, tables: &BTreeMap<&str, &JointTable>, table: &JointTable) -> Result<Reading> {
    let find = |name: &str| tables.get(name).copied();
    let follows = |name: &str| -> Result<Option<Reading>> {
        let Some((follower, mimic)) = find(name).and_then(|joint| Some((joint, joint.mimic.as_ref()?))) else {
            return Ok(None);
        };
        let table = mimic.get_ref();
        let of = format!("mimic of joint `{name}`");
        let leader = find(&table.joint).map_or(follower.kind, |joint| joint.kind);
        let unit = |kind| context.joint_value(kind, 1.0);
        let multiplier = if leader == follower.kind {
            table.multiplier
        } else {
            table.multiplier * unit(follower.kind) / unit(leader)
        };
        let offset = context.joint_value(follower.kind, table.offset);
        let [multiplier, offset] = context.check_numbers([multiplier, offset], mimic.span(), &of)?;
        if table.joint.trim().is_empty() {
            return Err(context.error(mimic.span(), format!("{of} names no joint, expected its leader")));
        }
        Ok(Some(Reading { name: table.joint.clone(), multiplier, offset }))
    };
    mimic::reading(table.name(), follows, |message| context.error(table.name.span(), message))
}
