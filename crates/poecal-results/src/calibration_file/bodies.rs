//! The robot of a calibration file: its joints, and the bodies that carry joints, targets and instruments.

use std::borrow::Cow;
use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use super::{CalibrationFile, JointEntry, PoseEntry, ScrewEntry, TargetEntry, refuse};
use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_calibrate::CalibratedTarget;
use poecal_model::robot::{Body, JointTerm, Mass, Mount, Robot, Term};
use poecal_numerics::error::Result;

/// A body of the robot: `"base"`, or `{"link_of": "joint2"}`, the link that this joint moves.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BodyEntry {
    /// The base.
    Base,
    /// The link that this joint moves.
    LinkOf(String),
}

/// Serialisation of a term's name as a key.
pub(crate) struct TermName;

impl JsonSchema for TermName {
    fn schema_name() -> Cow<'static, str> {
        "Term".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "type": "string",
            "pattern": Term::pattern(),
            "description": "A term of a joint's value.",
        })
    }
}

/// An instrument on the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InstrumentEntry {
    /// Body that carries it. Its pose is in the frame of the joint that moves the body, or in the base.
    pub on: BodyEntry,
    /// Position, metres.
    pub position_m: [f64; 3],
    /// Unit quaternion x, y, z, w.
    pub quaternion_xyzw: [f64; 4],
}

/// Measured quantities of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeasuredEntry {
    /// Position and orientation.
    Pose,
    /// Position alone.
    Position,
    /// Nothing: no row names it.
    Nothing,
}

impl TargetEntry {
    /// The quantities that were measured of it.
    #[must_use]
    pub fn measured_entry(&self) -> MeasuredEntry {
        let by_quaternion = if self.quaternion_xyzw.is_some() { MeasuredEntry::Pose } else { MeasuredEntry::Position };
        self.measured.unwrap_or(by_quaternion)
    }
}

impl CalibrationFile {
    /// The calibrated robot, with its named targets.
    ///
    /// # Errors
    /// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) if the file holds no valid robot.
    pub fn robot(&self) -> Result<Robot> {
        self.robot_of(|joint| (&joint.screw, &joint.terms), &self.robot.base_from_tip_at_zero)
    }

    /// The nominal robot, with the calibrated targets.
    ///
    /// # Errors
    /// As [`CalibrationFile::robot`].
    pub fn nominal_robot(&self) -> Result<Robot> {
        let robot = self.robot_of(
            |joint| (&joint.nominal_screw, &joint.nominal_terms),
            &self.robot.nominal_base_from_tip_at_zero,
        )?;
        if robot.mounted.is_empty() && robot.instruments.is_empty() {
            return Ok(robot);
        }
        // Targets and instruments are in the frames of nominal joints here; those of the file are in the frames of the calibrated ones.
        let calibrated = self.robot()?;
        let screws: Vec<_> = robot.joints.iter().map(|joint| joint.screw).collect();
        let joints = calibrated.with_screws(&screws).joints;
        Ok(Robot { joints, ..robot })
    }

    fn robot_of(
        &self,
        of: impl Fn(&JointEntry) -> (&ScrewEntry, &BTreeMap<Term, f64>),
        home: &PoseEntry,
    ) -> Result<Robot> {
        let joints = self.joints.iter().map(|entry| entry.joint(of(entry).0)).collect::<Result<Vec<_>>>()?;
        let mut robot = Robot::new(&self.robot.name, joints, home.pose()?)?;
        for (joint, entry) in self.joints.iter().enumerate() {
            for (&term, &coefficient) in of(entry).1 {
                if !coefficient.is_finite() {
                    let name = &entry.name;
                    return refuse(format!("found {coefficient} as the {term} of joint `{name}`, expected a number"));
                }
                robot.terms.push(JointTerm { joint, term, coefficient });
            }
        }
        let names: Vec<String> = self.robot.factors.iter().map(|it| it.name.clone()).collect();
        robot = robot.with_factors(&names)?;
        if let Some(factor) = self.robot.factors.iter().find(|it| !it.reference.is_finite()) {
            return refuse(format!("found a reference of factor `{}` that is no number, expected one", factor.name));
        }
        robot.factors.clone_from(&self.robot.factors);
        robot.base_name.clone_from(&self.robot.base_link);
        robot.tip_name.clone_from(&self.robot.tip_link);
        for (index, entry) in self.joints.iter().enumerate() {
            let on = entry.on.as_ref().map(|on| on.body(&robot)).transpose()?;
            let give_of = entry.compliance_of.as_deref().map(|name| self.joint_that_gives(name, index)).transpose()?;
            (robot.joints[index].stands_on, robot.joints[index].give_of) = (on, give_of);
        }
        robot.masses = self.robot.masses.iter().map(|entry| entry.mass(&robot)).collect::<Result<_>>()?;
        if let Some(gravity) = &self.robot.gravity {
            robot.gravity = Some(gravity.gravity(&robot, &self.joints)?);
        }
        self.check_terms(&robot)?;
        robot.tip = self.robot.tip_on.as_ref().map(|on| on.body(&robot)).transpose()?;
        for (name, target) in &self.targets {
            match &target.on {
                None => robot.targets.push((name.clone(), target.pose()?)),
                Some(on) => {
                    let (body, pose) = (on.body(&robot)?, target.pose()?);
                    robot.mounted.push(Mount { name: name.clone(), body, pose });
                }
            }
        }
        for (name, instrument) in &self.instruments {
            let (body, pose) = (instrument.on.body(&robot)?, instrument.pose()?);
            robot.instruments.push(Mount { name: name.clone(), body, pose });
        }
        robot.check_tree()?;
        self.controller.iter().try_for_each(|it| it.check(&robot))?;
        Ok(robot)
    }
}

/// A mass of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MassEntry {
    /// Its body.
    pub on: BodyEntry,
    /// Its centre at zero joint values, base frame, metres.
    pub place_m: [f64; 3],
    /// Mass, kg.
    pub mass_kg: f64,
}

impl MassEntry {
    /// The masses of a robot.
    pub fn all_from_robot(robot: &Robot) -> Vec<Self> {
        let entry = |mass: &Mass| MassEntry {
            on: BodyEntry::from_body(robot, mass.body),
            place_m: mass.place.into(),
            mass_kg: mass.kg,
        };
        robot.masses.iter().map(entry).collect()
    }

    fn mass(&self, robot: &Robot) -> Result<Mass> {
        if !Mass::is_mass(self.mass_kg) {
            return refuse(format!("found a mass of {} kg, expected above 0 and at most 1e6", self.mass_kg));
        }
        Ok(Mass { body: self.on.body(robot)?, place: Vector3::from(self.place_m), kg: self.mass_kg })
    }
}

impl CalibrationFile {
    /// True if a joint has this name.
    pub fn has_joint(&self, name: &str) -> bool {
        self.joints.iter().any(|joint| joint.name == name)
    }

    /// Refuses terms of weights that the robot does not carry, and compliant joints that do not stand on their joint.
    fn check_terms(&self, robot: &Robot) -> Result<()> {
        for JointTerm { joint, term, .. } in &robot.terms {
            if let Some(needed) = robot.lacks(*term) {
                let name = &robot.joints[*joint].name;
                return refuse(format!("found the term {term} of joint `{name}`, expected {needed}"));
            }
        }
        for (index, joint) in robot.joints.iter().enumerate() {
            let Some(of) = joint.give_of else { continue };
            let before = robot.body_before(index).joint();
            let is_on_it = before.is_some_and(|before| before == of || robot.joints[before].give_of == Some(of));
            if !is_on_it {
                let (give, name) = (&joint.name, &robot.joints[of].name);
                return refuse(format!("found `{give}` as a compliance of `{name}`, expected it to follow that joint"));
            }
        }
        Ok(())
    }

    /// Index of the joint whose compliance another joint is.
    fn joint_that_gives(&self, name: &str, give: usize) -> Result<usize> {
        let found = self.joints.iter().position(|entry| entry.name == name);
        let own = &self.joints[give].name;
        found.filter(|&of| of < give && self.joints[of].compliance_of.is_none()).map_or_else(
            || refuse(format!("found `{own}` as a compliance of `{name}`, expected one of a joint before it")),
            Ok,
        )
    }
}

impl BodyEntry {
    /// The entry of a body of a robot.
    pub fn from_body(robot: &Robot, body: Body) -> Self {
        match body.joint().and_then(|joint| robot.joints.get(joint)) {
            Some(joint) => BodyEntry::LinkOf(joint.name.clone()),
            None => BodyEntry::Base,
        }
    }

    pub(crate) fn body(&self, robot: &Robot) -> Result<Body> {
        match self {
            BodyEntry::Base => Ok(Body::Base),
            BodyEntry::LinkOf(name) => {
                let found = robot.joints.iter().position(|joint| joint.name == *name);
                let message = || format!("found the link of joint `{name}`, expected that of a joint of this file");
                found.map(Body::Link).map_or_else(|| refuse(message()), Ok)
            }
        }
    }
}

/// The named targets of a calibration: those that were measured, and those of the model with a body of their own.
pub(crate) fn targets(robot: &Robot, targets: &[CalibratedTarget]) -> BTreeMap<String, TargetEntry> {
    let on_body = |mount: &Mount, measured: MeasuredEntry| TargetEntry {
        position_m: mount.pose.translation.into(),
        quaternion_xyzw: Some(mount.pose.quaternion_xyzw()),
        on: Some(BodyEntry::from_body(robot, mount.body)),
        measured: Some(measured),
    };
    let entry = |target: &CalibratedTarget| {
        let name = target.name.clone()?;
        let entry = match robot.mounted.iter().find(|mount| mount.name == name) {
            Some(mount) if target.is_frame => on_body(mount, MeasuredEntry::Pose),
            Some(mount) => on_body(mount, MeasuredEntry::Position),
            None => TargetEntry {
                position_m: target.tip_from_target.translation.into(),
                quaternion_xyzw: target.is_frame.then(|| target.tip_from_target.quaternion_xyzw()),
                on: None,
                measured: None,
            },
        };
        Some((name, entry))
    };
    let is_measured = |mount: &&Mount| targets.iter().any(|target| target.name.as_ref() == Some(&mount.name));
    let unused = robot.mounted.iter().filter(|mount| !is_measured(mount));
    let unused = unused.map(|mount| (mount.name.clone(), on_body(mount, MeasuredEntry::Nothing)));
    targets.iter().filter_map(entry).chain(unused).collect()
}

impl InstrumentEntry {
    /// Entries of instruments, or targets, of a robot.
    pub(crate) fn all_from_mounts(robot: &Robot, mounts: &[Mount]) -> BTreeMap<String, Self> {
        let entry = |mount: &Mount| {
            let PoseEntry { position_m, quaternion_xyzw } = (&mount.pose).into();
            let on = BodyEntry::from_body(robot, mount.body);
            (mount.name.clone(), InstrumentEntry { on, position_m, quaternion_xyzw })
        };
        mounts.iter().map(entry).collect()
    }

    /// Its pose in the frame of the joint that moves its body, or in the base.
    ///
    /// # Errors
    /// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) if the quaternion is far from unit.
    pub fn pose(&self) -> Result<Pose> {
        PoseEntry { position_m: self.position_m, quaternion_xyzw: self.quaternion_xyzw }.pose()
    }
}

impl TargetEntry {
    /// Its pose in the tip frame, or in the frame of its body; a point has the orientation of that frame.
    ///
    /// # Errors
    /// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) if the quaternion is far from unit.
    pub fn pose(&self) -> Result<Pose> {
        let quaternion_xyzw = self.quaternion_xyzw.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        PoseEntry { position_m: self.position_m, quaternion_xyzw }.pose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_the_base_or_the_link_of_a_joint() {
        for (entry, text) in
            [(BodyEntry::Base, r#""base""#), (BodyEntry::LinkOf("torso2".into()), r#"{"link_of":"torso2"}"#)]
        {
            assert_eq!(serde_json::to_string(&entry).unwrap(), text);
            assert_eq!(serde_json::from_str::<BodyEntry>(text).unwrap(), entry);
        }
    }
}
