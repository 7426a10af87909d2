//! The arm of a robot as `poecal_arm` computes with it.

use nalgebra::Vector3;
use poecal_arm::{Arm, Drawn, Joint as ArmJoint, JointValue, MOST_JOINTS, Model, Wave};

use super::{JointTerm, Limits, Robot, Statics, Term};
use crate::error::{Error, ErrorKind, Result};

impl Robot {
    /// The joints from the base to the tip, their terms at these values of the factors, and the limits of their readings, for forward and
    /// inverse kinematics; beside it, of each of the arm's readings the index among the robot's ([`Robot::reading_names`]). Joints of other
    /// branches are at zero.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if more than [`MOST_JOINTS`] readings move the tip, or one of them does not move it.
    ///
    /// ```
    /// let robot = poecal::simulate::elbow();
    /// let (arm, readings) = robot.arm(&[]).unwrap();
    /// assert_eq!(readings, [0, 1, 2, 3, 4, 5]);
    /// let apart = arm.forward_kinematics(&[0.3; 6]).translation - robot.forward_kinematics(&[0.3; 6]).translation;
    /// assert!(apart.norm() < 1e-14);
    /// ```
    pub fn arm(&self, factors: &[f64]) -> Result<(Arm, Vec<usize>)> {
        self.arm_holding(factors, &[])
    }

    /// The same where some readings, each by its index among the robot's, stay at a value (rad, m): they are none of the arm's.
    ///
    /// # Errors
    /// As [`Robot::arm`].
    pub fn arm_holding(&self, factors: &[f64], held: &[(usize, f64)]) -> Result<(Arm, Vec<usize>)> {
        let (mut model, mut readings) = self.arm_model(factors)?;
        for &(reading, value) in held {
            if let Some(at) = readings.iter().position(|it| *it == reading) {
                model = model.held(at, value);
                readings.remove(at);
            }
        }
        let names = self.reading_names();
        let arm = Arm::of(&model).ok_or_else(|| {
            let names: Vec<&str> =
                readings.iter().filter_map(|&it| names.get(it)).map(String::as_str).collect();
            Error::new(
                ErrorKind::Model,
                format!(
                    "not every one of the joints {} moves the tip of robot `{}`",
                    names.join(", "),
                    self.name
                ),
            )
        })?;
        Ok((arm, readings))
    }

    /// What [`Robot::arm`] is made of.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if more than [`MOST_JOINTS`] readings move the tip.
    pub fn arm_model(&self, factors: &[f64]) -> Result<(Model, Vec<usize>)> {
        let indices = self.reading_indices();
        let path = self.joints_to(self.tip_body());
        let moving: Vec<usize> =
            path.iter().copied().filter(|&it| self.joints[it].give_of.is_none()).collect();
        let mut readings: Vec<usize> = Vec::new();
        for &joint in &moving {
            if !readings.contains(&indices[joint]) {
                readings.push(indices[joint]);
            }
        }
        if readings.len() > MOST_JOINTS {
            return Err(Error::new(
                ErrorKind::Model,
                format!("{} joints move the tip, expected at most {MOST_JOINTS}", readings.len()),
            ));
        }
        let reading_of = |joint: usize| readings.iter().position(|&it| it == indices[joint]);
        let statics = Statics::new(self);
        let factors: Vec<f64> = (self.factors.iter().enumerate())
            .map(|(index, it)| factors.get(index).map_or(0.0, |value| value - it.reference))
            .collect();
        let mut model = Model::new(readings.len(), &self.home);
        for &joint in &path {
            let own = &self.joints[joint].reading;
            let mut value = JointValue { constant: own.offset, ..JointValue::default() };
            if let Some(reading) = reading_of(joint)
                && own.multiplier != 0.0
            {
                value.linear.push((reading, own.multiplier));
            }
            let mut sags = vec![0.0; self.gravity.as_ref().map_or(0, |gravity| gravity.weights.len())];
            let mut of_masses = 0.0;
            for JointTerm { joint: _, term, coefficient } in
                self.terms.iter().filter(|it| it.joint == joint && it.coefficient != 0.0)
            {
                let turns = self.joints[joint].give_of.unwrap_or(joint);
                match term {
                    Term::Offset => value.constant += coefficient,
                    Term::Factor(it) => {
                        value.constant += coefficient * factors.get(it.index).copied().unwrap_or(0.0)
                    }
                    Term::Ratio => self.add_linear(&mut value, reading_of(turns), turns, *coefficient),
                    Term::Coupling(it) if it.joint < self.joints.len() => {
                        let other = self.joints[it.joint].give_of.unwrap_or(it.joint);
                        self.add_linear(&mut value, reading_of(other), other, *coefficient);
                    }
                    Term::Coupling(_) => {}
                    Term::Harmonic(it) => {
                        let turned = &self.joints[turns].reading;
                        let Some(reading) = reading_of(turns) else { continue };
                        value.waves.push(Wave {
                            reading,
                            factor: turned.multiplier,
                            offset: turned.offset,
                            order: f64::from(it.order),
                            cosine: if it.cosine { *coefficient } else { 0.0 },
                            sine: if it.cosine { 0.0 } else { *coefficient },
                        });
                    }
                    Term::Sag(it) => {
                        if let Some(sag) = sags.get_mut(it.weight) {
                            *sag += coefficient;
                        }
                    }
                    Term::Payload(it) => {
                        if let Some(sag) = sags.last_mut() {
                            *sag += coefficient * factors.get(it.index).copied().unwrap_or(0.0);
                        }
                    }
                    Term::OwnWeight => of_masses += coefficient,
                }
            }
            value.waves = together(&value.waves);
            value.pull = statics.as_ref().and_then(|it| it.pull(joint, &moving, &sags, of_masses));
            if value != JointValue::default() {
                model.joints.push(ArmJoint { screw: self.joints[joint].screw, value });
            }
        }
        if let Some(gravity) = &self.gravity {
            model.gravity = gravity.direction;
            for &joint in &moving {
                let own = &self.joints[joint].reading;
                let Some(reading) = reading_of(joint) else { continue };
                model.drawing.push(Drawn {
                    screw: gravity.axes.get(joint).map_or(self.joints[joint].screw, |it| it.0),
                    reading,
                    factor: own.multiplier,
                    constant: own.offset,
                });
            }
        } else {
            model.gravity = Vector3::zeros();
        }
        model.limits = readings.iter().map(|&reading| self.limits_of(&moving, &indices, reading)).collect();
        Ok((model, readings))
    }

    /// Adds a share of the value of a joint.
    fn add_linear(&self, value: &mut JointValue, reading: Option<usize>, of: usize, share: f64) {
        let own = &self.joints[of].reading;
        value.constant += share * own.offset;
        let Some(reading) = reading else { return };
        match value.linear.iter_mut().find(|it| it.0 == reading) {
            Some(it) => it.1 += share * own.multiplier,
            None => value.linear.push((reading, share * own.multiplier)),
        }
    }

    /// Limits of a reading: those of the joint that is named by it, without placeholders.
    fn limits_of(&self, moving: &[usize], indices: &[usize], reading: usize) -> Option<(f64, f64)> {
        let joint =
            moving.iter().map(|&it| (it, &self.joints[it])).find(|(it, _)| indices[*it] == reading)?.1;
        let limits = joint.limits.filter(|it| it.upper - it.lower < Limits::PLACEHOLDER_M)?;
        let (low, high) = (limits.lower, limits.upper);
        (joint.reading.multiplier == 1.0 && joint.reading.offset == 0.0).then_some((low, high))
    }
}

/// Waves with those of one order as one.
fn together(waves: &[Wave]) -> Vec<Wave> {
    let mut out: Vec<Wave> = Vec::new();
    for wave in waves {
        match out.iter_mut().find(|it| it.order == wave.order && it.reading == wave.reading) {
            Some(it) => {
                it.cosine += wave.cosine;
                it.sine += wave.sine;
            }
            None => out.push(*wave),
        }
    }
    out
}
