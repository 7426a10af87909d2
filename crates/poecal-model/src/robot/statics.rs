//! Moments of weights about joints.

use nalgebra::Vector3;
use poecal_arm::{GravityTorque, PulledWeight};

use super::{Body, Gravity, JointKind, Mass, Robot, Term, TermArgument, Weight};
use poecal_arm::lie::Pose;

/// Lever below which a weight has no moment, as a share of the arm: a tool on the last axis.
const LEAST_LEVER: f64 = 1e-2;

/// Moments of the weights of a robot in any configuration, by its nominal screws.
#[derive(Clone, Debug)]
pub struct Statics<'a> {
    robot: &'a Robot,
    gravity: &'a Gravity,
    /// For each joint and weight, 1 over the joint's longest lever; 0 for a weight that it does not carry.
    shares: Vec<f64>,
    levers: Vec<f64>,
    mass_levers: Vec<f64>,
    /// For each joint and mass, the mass over the sum of all that the joint carries times their longest levers; 0 for one that it does not
    /// carry.
    of_masses: Vec<f64>,
}

/// Moments in one configuration: of each weight about each joint, over the joint's longest lever.
#[derive(Clone, Debug, Default)]
pub struct Moments {
    weights: usize,
    values: Vec<f64>,
    of_masses: Vec<f64>,
    links: Vec<Pose>,
}

impl Moments {
    /// Moment of a weight about a joint.
    #[must_use]
    pub fn moment(&self, joint: usize, weight: usize) -> f64 {
        if weight >= self.weights {
            return 0.0;
        }
        self.values.get(joint * self.weights + weight).copied().unwrap_or_default()
    }

    /// Moment of all masses about a joint.
    pub(crate) fn of_masses(&self, joint: usize) -> f64 {
        self.of_masses.get(joint).copied().unwrap_or_default()
    }

    /// Moment of the last weight, where payloads are, about a joint.
    pub(crate) fn of_last(&self, joint: usize) -> f64 {
        self.weights.checked_sub(1).map_or(0.0, |last| self.moment(joint, last))
    }
}

impl<'a> Statics<'a> {
    /// Statics of a robot, if it has gravity.
    #[must_use]
    pub fn new(robot: &'a Robot) -> Option<Self> {
        let gravity = robot.gravity.as_ref()?;
        let mut shares = Vec::with_capacity(robot.joints.len() * gravity.weights.len());
        let mut levers = Vec::with_capacity(robot.joints.len());
        let (mut mass_levers, mut of_masses) = (Vec::new(), Vec::new());
        let least = LEAST_LEVER * robot.arm_m();
        for joint in 0..robot.joints.len() {
            let lever = |weight: &Weight| longest_lever(robot, gravity, joint, (weight.body, &weight.place));
            let longest = gravity.weights.iter().filter_map(lever).fold(0.0, f64::max);
            levers.push(longest);
            for weight in &gravity.weights {
                shares.push(match robot.joints[joint].kind {
                    JointKind::Revolute => lever(weight).filter(|it| *it > least).map_or(0.0, |_| 1.0 / longest),
                    JointKind::Prismatic => lever(weight).map_or(0.0, |_| 1.0),
                });
            }
            let lever = |mass: &Mass| longest_lever(robot, gravity, joint, (mass.body, &mass.place));
            let arms: Vec<Option<f64>> = robot.masses.iter().map(lever).collect();
            let carried = || robot.masses.iter().zip(&arms).filter_map(|(mass, arm)| Some((mass.kg, (*arm)?)));
            let kg: f64 = carried().map(|(kg, _)| kg).sum();
            let all = match robot.joints[joint].kind {
                JointKind::Revolute => {
                    let all: f64 = carried().map(|(kg, arm)| kg * arm).sum();
                    if all > least * kg { all } else { 0.0 }
                }
                JointKind::Prismatic => kg,
            };
            mass_levers.push(all);
            let share = |(mass, arm): (&Mass, &Option<f64>)| {
                if all > 0.0 && arm.is_some() { mass.kg / all } else { 0.0 }
            };
            of_masses.extend(robot.masses.iter().zip(&arms).map(share));
        }
        Some(Statics { robot, gravity, shares, levers, mass_levers, of_masses })
    }

    /// Longest lever of each joint, metres; 0 for one that carries no weight.
    #[must_use]
    pub fn levers_m(&self) -> &[f64] {
        &self.levers
    }

    /// For each joint, the sum of the masses that it carries times their longest levers, kg m; for a prismatic joint, of the masses alone.
    #[must_use]
    pub fn mass_levers_kg_m(&self) -> &[f64] {
        &self.mass_levers
    }

    /// True if a weight has a moment about a joint in any configuration.
    #[must_use]
    pub fn is_carried(&self, joint: usize, weight: usize) -> bool {
        self.shares.get(joint * self.gravity.weights.len() + weight).is_some_and(|share| *share > 0.0)
    }

    /// True if masses of the model have a moment about a joint in any configuration.
    #[must_use]
    pub fn carries_masses(&self, joint: usize) -> bool {
        self.mass_levers.get(joint).is_some_and(|all| *all > 0.0)
    }

    /// True if the argument of a term has a moment about a joint in any configuration.
    pub fn is_pulled(&self, joint: usize, term: Term) -> bool {
        match term.argument() {
            TermArgument::Masses => self.carries_masses(joint),
            TermArgument::Weight => self.is_carried(joint, term.index()),
            TermArgument::Payload => self.is_carried(joint, self.gravity.weights.len().saturating_sub(1)),
            TermArgument::Nothing | TermArgument::OwnValue | TermArgument::OtherJoint | TermArgument::Factor => false,
        }
    }

    /// Torque model of a joint with these coefficients of the weights and of all masses, where these joints are the moving ones of an arm.
    pub(crate) fn pull(&self, joint: usize, moving: &[usize], sags: &[f64], of_masses: f64) -> Option<GravityTorque> {
        let after = |body: Body| {
            let carrying = self.robot.joints_to(body);
            moving.iter().take_while(|it| carrying.contains(it)).count()
        };
        let weights = &self.gravity.weights;
        let shares = self.shares.get(joint * weights.len()..)?;
        let sagging = weights.iter().zip(shares).zip(sags);
        let sagging = sagging.map(|((weight, share), sag)| (share * sag, weight.body, weight.place));
        let masses = &self.robot.masses;
        let shares = self.of_masses.get(joint * masses.len()..)?;
        let massive = masses.iter().zip(shares).map(|(mass, share)| (share * of_masses, mass.body, mass.place));
        let pulled = sagging.chain(massive).filter(|(size, ..)| *size != 0.0);
        let weights: Vec<PulledWeight> =
            pulled.map(|(size, body, place)| PulledWeight { after: after(body), size, place }).collect();
        let (screw, place) = self.gravity.axes.get(joint)?;
        let before = self.robot.body_before(joint);
        (!weights.is_empty()).then(|| GravityTorque {
            after: after(before),
            slides: self.robot.joints[joint].kind == JointKind::Prismatic,
            direction: screw.direction(),
            place: *place,
            weights,
        })
    }

    /// Moments at these values of all joints, without terms.
    pub fn evaluate(&self, values: &[f64], out: &mut Moments) {
        let weights = &self.gravity.weights;
        out.weights = weights.len();
        out.links.clear();
        let joints = || self.robot.joints.iter().zip(&self.gravity.axes);
        for (index, ((joint, (screw, _)), &value)) in joints().zip(values).enumerate() {
            let before = self.robot.body_before(index);
            let link = match before.joint().and_then(|before| out.links.get(before)) {
                _ if joint.give_of.is_some() && value == 0.0 => body_of(&out.links, before),
                Some(before) => *before * screw.exp(value),
                None => screw.exp(value),
            };
            out.links.push(link);
        }
        out.values.clear();
        out.of_masses.clear();
        let places: Vec<Vector3<f64>> = weights.iter().map(|it| body_of(&out.links, it.body).act(&it.place)).collect();
        let masses: Vec<Vector3<f64>> =
            self.robot.masses.iter().map(|it| body_of(&out.links, it.body).act(&it.place)).collect();
        for (index, (joint, (screw, place))) in joints().enumerate() {
            let moving = body_of(&out.links, self.robot.body_before(index));
            let axis = moving.rotation * screw.direction();
            let origin = moving.act(place);
            let shares = &self.shares[index * weights.len()..];
            let moment = |place: &Vector3<f64>| match joint.kind {
                JointKind::Revolute => axis.dot(&(place - origin).cross(&self.gravity.direction)),
                JointKind::Prismatic => axis.dot(&self.gravity.direction),
            };
            let of_weight = |(place, share): (&Vector3<f64>, &f64)| {
                if *share == 0.0 { 0.0 } else { share * moment(place) }
            };
            out.values.extend(places.iter().zip(shares).map(of_weight));
            let shares = &self.of_masses[index * masses.len()..];
            out.of_masses.push(masses.iter().zip(shares).map(of_weight).sum());
        }
    }
}

fn body_of(links: &[Pose], body: Body) -> Pose {
    body.joint().and_then(|joint| links.get(joint)).copied().unwrap_or_else(Pose::identity)
}

/// Longest lever of a weight about a joint that carries it: the path from joint to joint, metres.
fn longest_lever(robot: &Robot, gravity: &Gravity, joint: usize, (body, place): (Body, &Vector3<f64>)) -> Option<f64> {
    let path = robot.joints_to(body);
    let first = path.iter().position(|&other| other == joint)?;
    let turning = path[first..].iter().filter(|&&other| robot.joints[other].kind == JointKind::Revolute);
    let mut at = gravity.axes.get(joint)?.1;
    let mut lever = 0.0;
    for &other in turning {
        let next = gravity.axes.get(other)?.0.nearest_point(&at);
        lever += (next - at).norm();
        at = next;
    }
    Some(lever + (place - at).norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;

    #[test]
    fn the_tip_hangs_from_the_shoulder_and_not_from_a_vertical_axis() {
        let mut robot = elbow();
        robot.gravity = Some(Gravity::of_unit_weights(&robot, -Vector3::z()));
        let (statics, mut moments) = (Statics::new(&robot).unwrap(), Moments::default());
        statics.evaluate(&[0.0; 6], &mut moments);
        assert!(moments.moment(0, 5).abs() < 1e-15);
        // The tip is at x = 0.834, the axis along y at x = 0.15.
        assert!((moments.moment(1, 5) * statics.levers_m()[1] - 0.684).abs() < 1e-14);
    }
}
