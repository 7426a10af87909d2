//! The kinematic chain of one row in the device's axes.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::packing::Bases;
use super::{ClockChange, Estimate, KinematicTree, PackedValues, PassedJoint, RangeModel, Sight};
use poecal_arm::lie::Pose;
use poecal_model::robot::{JointKind, JointTerm, Term};
use poecal_numerics::kernels::FixedMotion;

/// An estimate as frames relative to the frame before. A row's prediction `X T_n M Z` of theory.md §4 (13) is then a product of one fixed
/// pose and one elementary motion for each joint.
#[derive(Clone, Debug)]
pub struct Linkage {
    tree: Arc<KinematicTree>,
    /// For each route: `device_from_axis` of its first joint from the first station, then each axis in the one before.
    steps: Vec<Vec<Pose>>,
    /// Device frame of the first station in that of each further one.
    further_from_first: Vec<Pose>,
    /// For each sight, its first step, or the device frame if no joint moves between the two; and the target after the last step.
    ends: Vec<(Pose, Pose)>,
    first_device: Pose,
    /// Zero and scale of the distances of each station; empty if all are plain.
    ranges: Vec<RangeModel>,
    /// Error of the clock of each station; empty if all are right.
    clocks: Vec<ClockChange>,
    /// Terms of the value of each joint, with their places among all; empty if there are none.
    terms: Vec<Vec<(usize, JointTerm)>>,
}

impl Linkage {
    /// Relative frames of an estimate: the factors of theory.md §4 (13) between two joints' motions, at zero joint values.
    #[must_use]
    pub fn new(estimate: &Estimate) -> Self {
        let Estimate {
            tree,
            base_from_axis,
            terms,
            base_from_target,
            device_from_base: _,
            further_devices: _,
            ranges,
            clocks,
        } = estimate;
        let devices: Vec<Pose> =
            (0..tree.instruments().len()).map(|station| estimate.device_at_zero(station)).collect();
        let first = devices.first().copied().unwrap_or_else(Pose::identity);
        let mut lasts = Vec::with_capacity(tree.routes().len());
        let steps = tree.routes().iter().map(|route| {
            let mut axis_from_base = first;
            let mut steps = Vec::with_capacity(route.len());
            for base_from_axis in route.iter().map(|passed| &base_from_axis[passed.joint]) {
                steps.push(axis_from_base * *base_from_axis);
                axis_from_base = base_from_axis.inverse();
            }
            lasts.push(axis_from_base);
            steps
        });
        let steps: Vec<Vec<Pose>> = steps.collect();
        let targets = base_from_target.len().max(1);
        let ends = (0..tree.sights()).map(|sight| {
            let (station, target) = (sight / targets % devices.len().max(1), sight % targets);
            let route = tree.route_of(sight);
            match (tree.routes()[route].first(), steps[route].first()) {
                (Some(_), Some(&step)) if station == 0 => (step, lasts[route] * base_from_target[target]),
                (Some(passed), _) => {
                    (devices[station] * base_from_axis[passed.joint], lasts[route] * base_from_target[target])
                }
                (None, _) => (devices[station], base_from_target[target]),
            }
        });
        let ends = ends.collect();
        let further_from_first = relative_to_first(&devices);
        let of = |joint: usize| terms.iter().copied().enumerate().filter(move |(_, it)| it.joint == joint);
        let joints = if estimate.has_terms() { tree.kinds().len() } else { 0 };
        let terms = (0..joints).map(|joint| of(joint).collect()).collect();
        let ranges = if ranges.iter().all(RangeModel::is_plain) { Vec::new() } else { ranges.clone() };
        let clocks = if clocks.iter().all(ClockChange::is_none) { Vec::new() } else { clocks.clone() };
        Linkage { tree: Arc::clone(tree), steps, further_from_first, ends, first_device: first, terms, ranges, clocks }
    }

    /// `device_from_axis` of the first joint on the kinematic chain from an instrument to a target, then each axis in the one before, at
    /// zero joint values; and the target in the last axis. Without a joint it is the target in the base, which [`Linkage::fixed_device_frame`] has in
    /// the device frame.
    pub(crate) fn frames(&self, sight: Sight) -> (impl Iterator<Item = &Pose>, &Pose) {
        let (first, end) = &self.ends[self.tree.sight_index(sight)];
        let steps = &self.steps[self.tree.route_index(sight)];
        (steps.iter().take(1).map(move |_| first).chain(steps.iter().skip(1)), end)
    }

    /// Device frame of a sight without moving joints.
    pub(crate) fn fixed_device_frame(&self, sight: Sight) -> Option<&Pose> {
        self.steps[self.tree.route_index(sight)].is_empty().then(|| &self.ends[self.tree.sight_index(sight)].0)
    }

    /// Zero and scale of a station's distances, unless these are plain.
    pub(crate) fn range(&self, station: usize) -> Option<&RangeModel> {
        self.ranges.get(station).filter(|it| !it.is_plain())
    }

    /// `device_from_base` of the first station.
    pub(crate) fn first_device(&self) -> &Pose {
        &self.first_device
    }

    /// Device frame of the first station in that of a further one; `None` for the first.
    pub(crate) fn station_from_first(&self, station: usize) -> Option<&Pose> {
        self.further_from_first.get(station.checked_sub(1)?)
    }

    /// True if the joint values on a route are those of a row, in their order.
    pub(crate) fn is_plain(&self, route: usize) -> bool {
        let route = &self.tree.routes()[route];
        let in_order = |(index, passed): (usize, &PassedJoint)| passed.joint == index && !passed.backward;
        self.terms.is_empty()
            && self.clocks.is_empty()
            && route.len() == self.tree.kinds().len()
            && route.iter().enumerate().all(in_order)
    }

    /// Tree of these frames.
    pub(crate) fn tree(&self) -> &KinematicTree {
        &self.tree
    }

    /// For each joint of a route, true if it is revolute, and its relative frame, from the first station.
    pub(crate) fn turning_steps(&self, route: usize) -> impl Iterator<Item = (bool, FixedMotion)> {
        let kinds = self.tree.routes()[route].iter().map(|passed| self.tree.kinds()[passed.joint]);
        kinds.zip(&self.steps[route]).map(|(kind, pose)| (kind == JointKind::Revolute, FixedMotion::from(pose)))
    }

    /// Change of the value of a joint by the error of a station's clock, if there is one: theory.md §5 (26a).
    fn by_clock(&self, station: usize, packed: &PackedValues, row: usize, joint: usize) -> Option<f64> {
        let clock = self.clocks.get(station)?;
        let (rates, time_s) = packed.motion(row)?;
        Some(clock.shift(time_s) * rates.get(joint)?)
    }

    /// `(θ, cos θ or θ, sin θ or 0)` of a joint passed on a route, terms included: `θ ← θ + δ` of theory.md §5 (26), and `-θ` if it is
    /// passed backward.
    #[inline]
    pub(crate) fn joint_value(
        &self,
        passed: PassedJoint,
        packed: &PackedValues,
        row: usize,
        sight: Sight,
    ) -> (f64, f64, f64) {
        let joint = passed.joint;
        let from = sight.from.filter(|_| passed.backward);
        let (value, (c, s)) = packed.value_at(row, from, joint);
        let kind = self.tree.kinds()[joint];
        let by_terms = self.terms.get(joint).map(|terms| packed.bases_at(row, from).sum(terms));
        let by_clock = if self.clocks.is_empty() || sight.from.is_some() {
            None
        } else {
            self.by_clock(sight.station, packed, row, joint)
        };
        let more = match (by_terms, by_clock) {
            (Some(terms), Some(clock)) => Some(terms + clock),
            (one, other) => one.or(other),
        };
        let (value, c, s) = match more {
            None => (value, c, s),
            Some(more) => match kind {
                JointKind::Revolute => {
                    let (sine, cosine) = more.sin_cos();
                    (value + more, c * cosine - s * sine, s * cosine + c * sine)
                }
                JointKind::Prismatic => (value + more, c + more, 0.0),
            },
        };
        match (passed.backward, kind) {
            (false, _) => (value, c, s),
            (true, JointKind::Revolute) => (-value, c, -s),
            (true, JointKind::Prismatic) => (-value, -c, 0.0),
        }
    }
}

/// One joint in the device's axes, before its own motion: the axis frame's directions and origin (theory.md §5 (19)), and the joint value.
/// The motion of a joint that is passed backward is by `-θ`.
#[derive(Clone, Copy, Debug)]
pub struct JointView {
    /// Index of the joint.
    pub joint: usize,
    /// True if it is passed from its link towards the base.
    pub backward: bool,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// x of the axis frame.
    pub x: Vector3<f64>,
    /// y of the axis frame.
    pub y: Vector3<f64>,
    /// z of the axis frame: the direction of the screw.
    pub z: Vector3<f64>,
    /// Origin of the axis frame, metres.
    pub origin: Vector3<f64>,
    /// Joint value θ, offset included: radians, whole turns counted, or metres.
    pub value: f64,
    /// cos θ (revolute) or θ in metres (prismatic).
    pub cosine_or_value: f64,
    /// sin θ (revolute) or 0 (prismatic).
    pub sine: f64,
}

/// A row's joints and target in the device's axes. Reused from row to row.
#[derive(Clone, Debug)]
pub struct RowChain {
    /// Joints from the instrument to the target; for a device on the base, from base to tip. A joint that both configurations of a row move
    /// is there twice.
    pub joints: Vec<JointView>,
    /// The last link's frame after all motions (the moved frame of the last axis).
    pub last: Pose,
    /// Predicted `device_from_target`.
    pub target: Pose,
    /// Station of the device, in whose axes all vectors are.
    pub station: usize,
    /// Target whose frame is the device's frame, if there is one.
    pub shared: Option<usize>,
    /// True if the instrument was in another configuration than the target.
    in_two: bool,
    /// Rates of the joint values, and the time of the row; empty if the row was measured at rest.
    rates: Vec<f64>,
    time_s: f64,
    /// Packed terms.
    terms: Arc<[(usize, Term)]>,
    /// Functions of the terms and the joint values without terms, of the row and of the instrument's own configuration.
    bases: [(Vec<f64>, Vec<f64>); 2],
}

impl Default for RowChain {
    fn default() -> Self {
        RowChain {
            joints: Vec::new(),
            last: Pose::identity(),
            target: Pose::identity(),
            station: 0,
            shared: None,
            in_two: false,
            rates: Vec::new(),
            time_s: 0.0,
            terms: Arc::default(),
            bases: Default::default(),
        }
    }
}

impl RowChain {
    /// Evaluates the chain of a row in the device's axes, metres and radians: `X T_{i-1} A_i` of each joint (theory.md §5 (19)) and the
    /// prediction of theory.md §4 (13). `seen` is an observation, or a target alone, as measured from the first station.
    pub fn evaluate(&mut self, linkage: &Linkage, packed: &PackedValues, row: usize, seen: impl Into<Sight>) {
        let sight = seen.into();
        let Linkage { tree, .. } = linkage;
        self.joints.clear();
        self.station = sight.station;
        self.shared = tree.shared_target(sight.station);
        if !Arc::ptr_eq(&self.terms, packed.terms()) {
            self.terms = Arc::clone(packed.terms());
        }
        self.in_two = sight.from.is_some();
        let configurations = if self.in_two { 2 } else { 1 };
        for ((own, values), from) in self.bases.iter_mut().zip([None, sight.from]).take(configurations) {
            let found = packed.bases_at(row, from);
            own.clear();
            own.extend_from_slice(found.packed_functions());
            values.clear();
            values.extend_from_slice(found.values());
        }
        self.rates.clear();
        if let Some((rates, time_s)) = packed.motion(row) {
            self.rates.extend_from_slice(rates);
            self.time_s = time_s;
        }
        let mut moved = linkage.fixed_device_frame(sight).copied().unwrap_or_else(Pose::identity);
        let (steps, end) = linkage.frames(sight);
        for (&passed, step) in tree.route(sight).iter().zip(steps) {
            let (value, cosine_or_value, sine) = linkage.joint_value(passed, packed, row, sight);
            let PassedJoint { joint, backward } = passed;
            let kind = tree.kinds()[joint];
            let frame = moved * *step;
            let x = frame.rotation.column(0).into_owned();
            let y = frame.rotation.column(1).into_owned();
            let z = frame.rotation.column(2).into_owned();
            moved = match kind {
                JointKind::Revolute => Pose::new(
                    Matrix3::from_columns(&[x * cosine_or_value + y * sine, y * cosine_or_value - x * sine, z]),
                    frame.translation,
                ),
                JointKind::Prismatic => Pose::new(frame.rotation, frame.translation + z * cosine_or_value),
            };
            let origin = frame.translation;
            self.joints.push(JointView { joint, backward, kind, x, y, z, origin, value, cosine_or_value, sine });
        }
        self.last = moved;
        self.target = moved * *end;
    }

    /// Rates of the joint values (rad/s, m/s), and the time of the row from the middle of all, seconds, if it was measured in motion.
    pub(crate) fn motion_rates(&self) -> Option<(&[f64], f64)> {
        (!self.rates.is_empty() && !self.in_two).then_some((&self.rates, self.time_s))
    }

    /// Function b of a term of a joint in the configuration in which the joint is passed.
    #[must_use]
    pub fn basis(&self, view: &JointView, term: Term) -> f64 {
        // Without a configuration of its own the instrument was in that of the target.
        let [target, instrument] = &self.bases;
        let (own, values) = if view.backward && self.in_two { instrument } else { target };
        Bases::new(&self.terms, own, values).basis_of_term(view.joint, term)
    }

    /// Views of one joint: none if the target's motion does not depend on it, two if it moved between two configurations of a row.
    pub fn of_joint(&self, joint: usize) -> impl Iterator<Item = &JointView> {
        // On a serial chain the joint has its own place; before that place no joint is a later one.
        let first = self.joints.get(joint).filter(|view| view.joint == joint && !self.in_two);
        let start = if first.is_some() { joint } else { 0 };
        let views = self.joints[start..].iter().filter(move |view| view.joint == joint);
        views.take(if self.in_two { 2 } else { 1 })
    }
}

/// Device frame of the first station in that of each further one.
fn relative_to_first(devices: &[Pose]) -> Vec<Pose> {
    match devices {
        [first, further @ ..] if !further.is_empty() => {
            let base_from_first = first.inverse();
            further.iter().map(|&device| device * base_from_first).collect()
        }
        _ => Vec::new(),
    }
}
