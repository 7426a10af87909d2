//! The arm of a robot as `poecal_arm` computes with it.

use nalgebra::Vector3;
use poecal_arm::{
    Arm, ArmModel, GravityTorque, JointValue, MOST_JOINTS, ModelJoint as ArmJoint, NominalJoint, Term, TermArgument,
    TermCurve, TermFunction, Wave,
};

use super::{JointLimits, JointTerm, Robot, Statics};
use poecal_numerics::error::{ErrorKind, Result};

impl Robot {
    /// Joints from the base to the tip, for forward and inverse kinematics, with their terms at these values of the factors and the limits
    /// of their readings. The second result has the index of each of the arm's readings among the robot's ([`Robot::reading_names`]).
    /// Joints of other branches are at zero.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if more than [`MOST_JOINTS`] readings move the tip, or one of them does not move it.
    ///
    /// ```
    /// let robot = poecal_model::simulate::elbow();
    /// let (arm, readings) = robot.arm(&[]).unwrap();
    /// assert_eq!(readings, [0, 1, 2, 3, 4, 5]);
    /// let apart = arm.forward_kinematics(&[0.3; 6]).translation - robot.forward_kinematics(&[0.3; 6]).translation;
    /// assert!(apart.norm() < 1e-14);
    /// ```
    pub fn arm(&self, factors: &[f64]) -> Result<(Arm, Vec<usize>)> {
        self.arm_holding(factors, &[])
    }

    /// The same arm with some readings, each by its index among the robot's, held at a value (rad, m): they are none of the arm's.
    ///
    /// # Errors
    /// As [`Robot::arm`].
    pub fn arm_holding(&self, factors: &[f64], held: &[(usize, f64)]) -> Result<(Arm, Vec<usize>)> {
        let (model, readings) = self.model_holding(factors, held)?;
        let names = self.reading_names();
        let arm = Arm::from_model(&model).ok_or_else(|| {
            let names: Vec<&str> = readings.iter().filter_map(|&it| names.get(it)).map(String::as_str).collect();
            ErrorKind::Model.error(format!(
                "not every one of the joints {} moves the tip of robot `{}`",
                names.join(", "),
                self.name
            ))
        })?;
        Ok((arm, readings))
    }

    /// Model of [`Robot::arm`].
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if more than [`MOST_JOINTS`] readings move the tip.
    pub fn arm_model(&self, factors: &[f64]) -> Result<(ArmModel, Vec<usize>)> {
        self.model_holding(factors, &[])
    }

    fn model_holding(&self, factors: &[f64], held: &[(usize, f64)]) -> Result<(ArmModel, Vec<usize>)> {
        let indices = self.reading_indices();
        let path = self.joints_to(self.tip_body());
        let moving: Vec<usize> = path.iter().copied().filter(|&it| self.joints[it].give_of.is_none()).collect();
        let mut readings: Vec<usize> = Vec::new();
        for &joint in &moving {
            let is_held = held.iter().any(|it| it.0 == indices[joint]);
            if !is_held && !readings.contains(&indices[joint]) {
                readings.push(indices[joint]);
            }
        }
        if readings.len() > MOST_JOINTS {
            return ErrorKind::Model
                .refuse(format!("{} joints move the tip, expected at most {MOST_JOINTS}", readings.len()));
        }
        let statics = Statics::new(self);
        let factors: Vec<f64> = (self.factors.iter().enumerate())
            .map(|(index, it)| factors.get(index).map_or(0.0, |value| value - it.reference))
            .collect();
        let values = JointValues {
            robot: self,
            statics,
            moving: &moving,
            readings: &readings,
            indices: &indices,
            held,
            factors,
        };
        let mut model = ArmModel::new(readings.len(), &self.home);
        for &joint in &path {
            let value = values.value_of_joint(joint);
            if value != JointValue::default() {
                model.joints.push(ArmJoint { screw: self.joints[joint].screw, value });
            }
        }
        if let Some(gravity) = &self.gravity {
            model.gravity = gravity.direction;
            for &joint in &moving {
                let screw = gravity.axes.get(joint).map_or(self.joints[joint].screw, |it| it.0);
                let (constant, linear) = values.by_reading(joint);
                let (reading, factor) = linear.unwrap_or((0, 0.0));
                model.drawing.push(NominalJoint { screw, reading, factor, constant });
            }
        } else {
            model.gravity = Vector3::zeros();
        }
        model.limits = readings.iter().map(|&reading| self.limits_of(&moving, &indices, reading)).collect();
        Ok((model, readings))
    }

    /// Limits of a reading: those of the joint that is named by it, without placeholders.
    fn limits_of(&self, moving: &[usize], indices: &[usize], reading: usize) -> Option<(f64, f64)> {
        let joint = moving.iter().map(|&it| (it, &self.joints[it])).find(|(it, _)| indices[*it] == reading)?.1;
        let limits = joint.limits.filter(|it| it.upper - it.lower < JointLimits::PLACEHOLDER_M)?;
        let (low, high) = (limits.lower, limits.upper);
        (joint.reading.multiplier == 1.0 && joint.reading.offset == 0.0).then_some((low, high))
    }
}

/// Values of joints as functions of the readings of an arm.
struct JointValues<'a> {
    robot: &'a Robot,
    statics: Option<Statics<'a>>,
    /// Joints of the arm except compliant joints.
    moving: &'a [usize],
    /// For each reading of the arm, the index among the robot's.
    readings: &'a [usize],
    /// For each joint, the index of its reading.
    indices: &'a [usize],
    /// Readings that are held at a value.
    held: &'a [(usize, f64)],
    /// Factors, from their references.
    factors: Vec<f64>,
}

impl JointValues<'_> {
    fn value_of_joint(&self, joint: usize) -> JointValue {
        let (constant, linear) = self.by_reading(joint);
        let linear = linear.into_iter().collect();
        let mut value = JointValue { constant, linear, ..JointValue::default() };
        let mut moments = Vec::new();
        let terms = self.robot.terms.iter().filter(|it| it.joint == joint && it.coefficient != 0.0);
        for &JointTerm { term, coefficient, .. } in terms {
            let is_linear = matches!(term.kind().row().function, TermFunction::Identity);
            match term.argument() {
                TermArgument::Nothing => value.constant += coefficient * term.function(0.0)[0],
                TermArgument::Factor => value.constant += coefficient * term.function(self.factor(term))[0],
                TermArgument::OwnValue => self.add_of_value(&mut value, term, coefficient, joint),
                TermArgument::OtherJoint => self.add_of_value(&mut value, term, coefficient, term.index()),
                TermArgument::Masses | TermArgument::Weight | TermArgument::Payload if is_linear => {
                    moments.push((term, coefficient));
                }
                TermArgument::Masses | TermArgument::Weight | TermArgument::Payload => {
                    let (linear, pull) = (Vec::new(), self.pull(joint, &[(term, 1.0)]));
                    value.curves.push(TermCurve { term, coefficient, constant: 0.0, linear, pull });
                }
            }
        }
        value.waves = merge_waves(&value.waves);
        value.pull = self.pull(joint, &moments);
        value
    }

    /// Value of a joint by its reading: a constant, and the arm's reading with a factor.
    fn by_reading(&self, joint: usize) -> (f64, Option<(usize, f64)>) {
        let (own, reading) = (&self.robot.joints[joint].reading, self.indices[joint]);
        let of_arm = self.readings.iter().position(|it| *it == reading);
        match of_arm.filter(|_| own.multiplier != 0.0) {
            Some(at) => (own.offset, Some((at, own.multiplier))),
            None => {
                let held = self.held.iter().find(|it| it.0 == reading).map_or(0.0, |it| it.1);
                (own.offset + own.multiplier * held, None)
            }
        }
    }

    /// Adds a term that is a function of the value of a joint; for a compliant joint, of the value of the joint that it belongs to.
    fn add_of_value(&self, value: &mut JointValue, term: Term, coefficient: f64, of: usize) {
        let Some(joint) = self.robot.joints.get(of) else { return };
        let (constant, linear) = self.by_reading(joint.give_of.unwrap_or(of));
        let Some((reading, factor)) = linear else {
            value.constant += coefficient * term.function(constant)[0];
            return;
        };
        let wave = Wave { reading, factor, offset: constant, order: term.number() as f64, cosine: 0.0, sine: 0.0 };
        match term.kind().row().function {
            TermFunction::One => value.constant += coefficient,
            TermFunction::Identity => {
                value.constant += coefficient * constant;
                match value.linear.iter_mut().find(|it| it.0 == reading) {
                    Some(it) => it.1 += coefficient * factor,
                    None => value.linear.push((reading, coefficient * factor)),
                }
            }
            TermFunction::Sine => value.waves.push(Wave { sine: coefficient, ..wave }),
            TermFunction::Cosine => value.waves.push(Wave { cosine: coefficient, ..wave }),
            TermFunction::Other(_) => {
                let linear = vec![(reading, factor)];
                value.curves.push(TermCurve { term, coefficient, constant, linear, pull: None });
            }
        }
    }

    /// Factor of a term's number, from its reference.
    fn factor(&self, term: Term) -> f64 {
        self.factors.get(term.index()).copied().unwrap_or(0.0)
    }

    /// Moments about a joint that terms are functions of, by these coefficients.
    fn pull(&self, joint: usize, terms: &[(Term, f64)]) -> Option<GravityTorque> {
        let weights = self.robot.gravity.as_ref()?.weights.len();
        let (mut sags, mut of_masses) = (vec![0.0; weights], 0.0);
        for &(term, coefficient) in terms {
            match term.argument() {
                TermArgument::Masses => of_masses += coefficient,
                TermArgument::Weight => sags.get_mut(term.index()).into_iter().for_each(|it| *it += coefficient),
                TermArgument::Payload => {
                    sags.last_mut().into_iter().for_each(|it| *it += coefficient * self.factor(term));
                }
                TermArgument::Nothing | TermArgument::OwnValue | TermArgument::OtherJoint | TermArgument::Factor => {}
            }
        }
        self.statics.as_ref()?.pull(joint, self.moving, &sags, of_masses)
    }
}

/// Waves with those of one order joined.
fn merge_waves(waves: &[Wave]) -> Vec<Wave> {
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
