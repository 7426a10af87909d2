//! Bodies of joints, instruments and targets, and the joints between them.

use super::Sight;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Body, JointKind, Robot};

/// Parent of an instrument's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstrumentMount {
    /// A body, with a frame of its own on it.
    On(Body),
    /// The frame of the target of this index: the same frame measured in two configurations.
    Target(usize),
}

/// A joint on the kinematic chain from an instrument to a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassedJoint {
    /// Index of the joint.
    pub joint: usize,
    /// True if it is passed from its link towards the base, by `exp(-ξθ)`. In a row of two configurations such joints have the values of
    /// the instrument's configuration.
    pub backward: bool,
}

/// Kinds and parents of the joints, and the bodies of instruments and targets. They do not change during a fit.
///
/// The kinematic chain from an instrument on body a to a target on body b is `(T_a)⁻¹ T_b`. T is the product of exponentials from the
/// base to the body. Joints that are on both branches cancel, unless instrument and target were in different configurations.
#[derive(Clone, Debug, PartialEq)]
pub struct KinematicTree {
    kinds: Vec<JointKind>,
    stands_on: Vec<Body>,
    instruments: Vec<InstrumentMount>,
    targets: Vec<Body>,
    /// Different routes, and that of each pair of instrument and target: in one configuration, then in two.
    routes: Vec<Vec<PassedJoint>>,
    of_sight: Vec<usize>,
}

impl KinematicTree {
    /// The tree of a robot, with bodies of instruments (stations) and targets in the order of the data.
    #[must_use]
    pub fn new(robot: &Robot, instruments: Vec<InstrumentMount>, targets: Vec<Body>) -> Self {
        let joints = 0..robot.joints.len();
        let none = KinematicTree {
            kinds: robot.joints.iter().map(|joint| joint.kind).collect(),
            stands_on: joints.map(|joint| robot.body_before(joint)).collect(),
            instruments: Vec::new(),
            targets: Vec::new(),
            routes: Vec::new(),
            of_sight: Vec::new(),
        };
        none.with_bodies(instruments, targets)
    }

    /// Tree of a robot with the instruments and targets of a data set, by their names. An instrument without a pose in the model is on the base.
    /// One whose rows have two configurations measures from the frame of the target with its name, or else of the target that they measure.
    #[must_use]
    pub fn from_robot(robot: &Robot, data: &Dataset) -> Self {
        let stand = |station: usize| {
            let name = data.stations.get(station).and_then(Option::as_deref);
            let mount = robot.instruments.iter().find(|mount| Some(mount.name.as_str()) == name);
            let body = mount.map_or(Body::Base, |mount| mount.body);
            let named = data.targets.iter().position(|target| name.is_some() && target.as_deref() == name);
            let in_two = || data.observations.iter().find(|row| row.station == station && row.from.is_some());
            // Without further configurations there are no rows in two.
            let may_be_shared = mount.is_none() && !data.further_readings().is_empty();
            let shared = if may_be_shared { in_two() } else { None };
            shared.map_or(InstrumentMount::On(body), |row| InstrumentMount::Target(named.unwrap_or(row.target)))
        };
        let instruments = (0..data.station_count()).map(stand).collect();
        let place = robot.places_of_targets();
        let targets = data.targets.iter().map(|name| place(name.as_deref()).0).collect();
        KinematicTree::new(robot, instruments, targets)
    }

    /// The same tree with one of the instruments only.
    pub(crate) fn seen_from(&self, station: usize) -> Self {
        let stand = self.instruments.get(station).copied().unwrap_or(InstrumentMount::On(Body::Base));
        self.with_bodies(vec![stand], self.targets.clone())
    }

    /// The same tree with further instruments on the base.
    pub(crate) fn with_further_on_base(&self, further: usize) -> Self {
        let first = self.instruments.first().copied();
        let on_base = std::iter::repeat_n(InstrumentMount::On(Body::Base), further);
        self.with_bodies(first.into_iter().chain(on_base).collect(), self.targets.clone())
    }

    /// The same tree with one more target.
    pub(crate) fn with_target(&self, body: Body) -> Self {
        let targets = self.targets.iter().copied().chain([body]).collect();
        self.with_bodies(self.instruments.clone(), targets)
    }

    fn with_bodies(&self, instruments: Vec<InstrumentMount>, targets: Vec<Body>) -> Self {
        let (kinds, stands_on) = (self.kinds.clone(), self.stands_on.clone());
        let mut tree =
            KinematicTree { kinds, stands_on, instruments, targets, routes: Vec::new(), of_sight: Vec::new() };
        tree.find_routes();
        tree
    }

    /// Kind of each joint.
    #[must_use]
    pub fn kinds(&self) -> &[JointKind] {
        &self.kinds
    }

    /// Parent of each instrument.
    #[must_use]
    pub fn instruments(&self) -> &[InstrumentMount] {
        &self.instruments
    }

    /// Body of each target.
    #[must_use]
    pub fn targets(&self) -> &[Body] {
        &self.targets
    }

    /// Joints from an instrument to a target, in order.
    #[must_use]
    pub fn route(&self, sight: Sight) -> &[PassedJoint] {
        &self.routes[self.route_index(sight)]
    }

    /// All routes that differ.
    pub(crate) fn routes(&self) -> &[Vec<PassedJoint>] {
        &self.routes
    }

    /// Index of a sight's route.
    pub(crate) fn route_index(&self, sight: Sight) -> usize {
        self.of_sight[self.sight_index(sight)]
    }

    /// Index of the route of the sight of this index.
    pub(crate) fn route_of(&self, sight: usize) -> usize {
        self.of_sight[sight]
    }

    /// Target in whose frame an instrument measures, if its frame is a target's.
    #[must_use]
    pub fn shared_target(&self, instrument: usize) -> Option<usize> {
        match self.instruments.get(instrument)? {
            InstrumentMount::On(_) => None,
            InstrumentMount::Target(target) => Some(*target),
        }
    }

    /// Number of pairs of an instrument and a target, in one configuration and in two.
    pub(crate) fn sights(&self) -> usize {
        self.of_sight.len()
    }

    /// Index of a sight among these pairs.
    pub(crate) fn sight_index(&self, sight: Sight) -> usize {
        let of_two = usize::from(sight.from.is_some()) * self.instruments.len();
        (of_two + sight.station) * self.targets.len() + sight.target
    }

    /// Joint that carries a joint on its link.
    #[must_use]
    pub fn joint_before(&self, joint: usize) -> Option<usize> {
        self.stands_on.get(joint).and_then(|body| body.joint())
    }

    /// Joints from a body to the base.
    fn towards_base(&self, body: Body) -> Vec<usize> {
        std::iter::successors(body.joint(), |&joint| self.joint_before(joint)).collect()
    }

    fn find_routes(&mut self) {
        let bodies: Vec<Body> = self
            .instruments
            .iter()
            .map(|stand| match *stand {
                InstrumentMount::On(body) => body,
                InstrumentMount::Target(target) => self.targets[target],
            })
            .collect();
        for of_two in [false, true] {
            for &from in &bodies {
                for &to in &self.targets {
                    let (mut back, mut forth) = (self.towards_base(from), self.towards_base(to));
                    while !of_two && back.last().is_some_and(|joint| forth.last() == Some(joint)) {
                        back.pop();
                        forth.pop();
                    }
                    let back = back.into_iter().map(|joint| PassedJoint { joint, backward: true });
                    let forth = forth.into_iter().rev().map(|joint| PassedJoint { joint, backward: false });
                    let route: Vec<PassedJoint> = back.chain(forth).collect();
                    let known = self.routes.iter().position(|known| *known == route);
                    self.of_sight.push(known.unwrap_or(self.routes.len()));
                    if known.is_none() {
                        self.routes.push(route);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_in_the_hand_passes_the_joints_backward() {
        let robot = poecal_testing::sessions::unlimited_elbow();
        let in_hand = KinematicTree::new(&robot, vec![InstrumentMount::On(Body::Link(5))], vec![Body::Base]);
        let passed = in_hand.route(Sight::from(0));
        assert!(passed.len() == 6 && passed[0].joint == 5 && passed.iter().all(|it| it.backward));
    }
}
