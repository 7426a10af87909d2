//! The state of an estimation (axis frames, targets and device frames), and its prediction of each row.
//!
//! The state is the full set of screws, each carried by a frame on its axis: `A_i = base_from_axis` at zero configuration, z along
//! the screw. A local step `A_i ← A_i exp(ε)` is the adjoint update `ξ_i ← Ad_exp(η) ξ_i` with `η = Ad_A_i ε` (theory.md §5 (18)).
//!
//! A robot with its measurements is one value, [`Session`]: functions of both take it, and structs such as `Problem` and `Registration` hold it.
//! [`Estimate`] is not one type with `Robot`: a fit makes a state in every step, and names, limits and readings never change in one. `tree.rs` has
//! the joints on the kinematic chain from each instrument to each target, passed forward or backward; `unknowns.rs` has the unknowns of a fit.

mod chain;
mod clock;
mod packing;
mod predictions;
mod range;
mod rounding;
mod row_error;
mod session;
mod side_by_side;
mod sight;
mod tree;
mod unknowns;

pub use chain::{JointView, Linkage, RowChain};
pub use clock::{ClockChange, ClockTerm};
pub use packing::{PackedValues, sample_rows};
pub use predictions::turn_to_first;
pub use range::{RangeModel, RangeTerm};
pub use rounding::Rounding;
pub use row_error::{RowError, rms_m};
pub use session::Session;
pub use sight::Sight;
pub use tree::{InstrumentMount, KinematicTree, PassedJoint};
pub use unknowns::Unknowns;

use std::sync::Arc;

use nalgebra::Vector3;

use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Body, JointKind, JointTerm, Robot, Term};

/// The current estimate of everything that may be unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Bodies of joints, instruments and targets.
    pub tree: Arc<KinematicTree>,
    /// `base_from_axis` of each joint at zero configuration: z along the screw, origin on the axis.
    pub base_from_axis: Vec<Pose>,
    /// Terms of the joints' values, among them the offsets (lou2009: Δθ).
    pub terms: Vec<JointTerm>,
    /// `base_from_target` of each target with all joint values zero (lou2009: M, or the point P_c0).
    pub base_from_target: Vec<Pose>,
    /// The base in the device frame; in that of the first of several stations.
    pub device_from_base: Pose,
    /// The base in the device frame of each further station ([`Dataset::stations`]).
    pub further_devices: Vec<Pose>,
    /// Zero and scale of the distances of each station; those beyond the last are plain.
    pub ranges: Vec<RangeModel>,
    /// Error of the clock of each station; those beyond the last are right.
    pub clocks: Vec<ClockChange>,
}

impl Estimate {
    /// Estimate of a robot's screws, targets at zero configuration and a device frame. Axis frames have z along the screw, as in
    /// theory.md §5 (18). All targets are on the tip's link, and the device is on the base.
    #[must_use]
    pub fn new(robot: &Robot, base_from_target: Vec<Pose>, device_from_base: Pose) -> Self {
        let targets = vec![robot.tip_body(); base_from_target.len()];
        let tree = KinematicTree::new(robot, vec![InstrumentMount::On(Body::Base)], targets);
        Estimate::from_placed(robot, tree, base_from_target, device_from_base)
    }

    /// The same estimate with instruments and targets on the bodies of a tree; further device frames are that of the first.
    #[must_use]
    pub fn from_placed(
        robot: &Robot,
        tree: KinematicTree,
        base_from_target: Vec<Pose>,
        device_from_base: Pose,
    ) -> Self {
        let further = tree.instruments().len().saturating_sub(1);
        Estimate {
            tree: Arc::new(tree),
            base_from_axis: robot
                .joints
                .iter()
                .map(|joint| axis_frame(&joint.screw, &joint.frame.translation))
                .collect(),
            terms: robot.terms.clone(),
            base_from_target,
            device_from_base,
            further_devices: vec![device_from_base; further],
            ranges: Vec::new(),
            clocks: Vec::new(),
        }
    }

    /// Kind of each joint.
    #[must_use]
    pub fn kinds(&self) -> &[JointKind] {
        self.tree.kinds()
    }

    /// `device_from_base` of a station; for an instrument on the robot at zero joint values. That of a shared target follows from the
    /// target.
    pub fn device_at_zero(&self, station: usize) -> Pose {
        match self.tree.shared_target(station) {
            Some(target) => self.base_from_target[target].inverse(),
            None => *self.device(station),
        }
    }

    /// `device_from_base` of a station. A single frame is that of all stations.
    #[must_use]
    pub fn device(&self, station: usize) -> &Pose {
        station.checked_sub(1).and_then(|at| self.further_devices.get(at)).unwrap_or(&self.device_from_base)
    }

    /// [`Estimate::device`], mutable.
    pub fn device_mut(&mut self, station: usize) -> &mut Pose {
        match station.checked_sub(1).and_then(|at| self.further_devices.get_mut(at)) {
            Some(device) => device,
            None => &mut self.device_from_base,
        }
    }

    /// Zero and scale of a station's distances.
    #[must_use]
    pub fn range(&self, station: usize) -> RangeModel {
        self.ranges.get(station).copied().unwrap_or_default()
    }

    /// [`Estimate::range`], mutable.
    pub(crate) fn range_mut(&mut self, station: usize) -> &mut RangeModel {
        if self.ranges.len() <= station {
            self.ranges.resize(station + 1, RangeModel::default());
        }
        &mut self.ranges[station]
    }

    /// Error of the clock of a station.
    #[must_use]
    pub fn clock(&self, station: usize) -> ClockChange {
        self.clocks.get(station).copied().unwrap_or_default()
    }

    /// [`Estimate::clock`], mutable.
    pub(crate) fn clock_mut(&mut self, station: usize) -> &mut ClockChange {
        if self.clocks.len() <= station {
            self.clocks.resize(station + 1, ClockChange::default());
        }
        &mut self.clocks[station]
    }

    /// The same estimate with the device frame of one station only.
    #[must_use]
    pub fn seen_from(&self, station: usize) -> Self {
        let device_from_base = *self.device(station);
        let tree = Arc::new(self.tree.seen_from(station));
        let (ranges, clocks) = (vec![self.range(station)], vec![self.clock(station)]);
        Estimate { tree, device_from_base, further_devices: Vec::new(), ranges, clocks, ..self.clone() }
    }

    /// The same estimate with device frames of further stations on the base.
    #[must_use]
    pub fn with_further_devices(&self, further_devices: Vec<Pose>) -> Self {
        let tree = Arc::new(self.tree.with_further_on_base(further_devices.len()));
        Estimate { tree, further_devices, ..self.clone() }
    }

    /// The same estimate with one more target on a body, `base_from_target` at zero joint values.
    #[must_use]
    pub fn with_target(&self, body: Body, pose: Pose) -> Self {
        let mut estimate = self.clone();
        estimate.tree = Arc::new(self.tree.with_target(body));
        estimate.base_from_target.push(pose);
        estimate
    }

    /// The joint screws in the base frame, theory.md §2 (5).
    #[must_use]
    pub fn screws(&self) -> Vec<Screw> {
        self.kinds()
            .iter()
            .zip(&self.base_from_axis)
            .map(|(kind, frame)| {
                let direction = frame.rotation.column(2).into_owned();
                match kind {
                    JointKind::Revolute => Screw::revolute(&direction, &frame.translation),
                    JointKind::Prismatic => Screw::prismatic(&direction),
                }
            })
            .collect()
    }

    /// The same estimate with other screws in the base frame, one for each joint. Frames keep their position along each axis
    /// (theory.md §5 (18)).
    #[must_use]
    pub fn with_screws(&self, screws: &[Screw]) -> Self {
        let mut estimate = self.clone();
        for (frame, screw) in estimate.base_from_axis.iter_mut().zip(screws) {
            *frame = axis_frame(screw, &frame.translation);
        }
        estimate
    }

    /// The same physical robot in a base frame moved by `G`: screws and targets move by `Ad_G`, device frames by `G⁻¹`. Predictions in
    /// the device frame do not change (theory.md §8 (37)).
    #[must_use]
    pub fn rebase(&self, motion: &Pose) -> Self {
        Estimate {
            tree: Arc::clone(&self.tree),
            base_from_axis: self.base_from_axis.iter().map(|&frame| *motion * frame).collect(),
            terms: self.terms.clone(),
            base_from_target: self.base_from_target.iter().map(|&pose| *motion * pose).collect(),
            device_from_base: self.device_from_base * motion.inverse(),
            further_devices: self.further_devices.iter().map(|&device| device * motion.inverse()).collect(),
            ranges: self.ranges.clone(),
            clocks: self.clocks.clone(),
        }
    }

    /// True if any joint has a term.
    #[must_use]
    pub fn has_terms(&self) -> bool {
        self.terms.iter().any(|it| it.coefficient != 0.0)
    }

    /// True if joint values differ from those of the readings: by a term, or by the error of a clock.
    #[must_use]
    pub fn moves_values(&self) -> bool {
        self.has_terms() || self.clocks.iter().any(|it| !it.is_none())
    }

    /// Coefficient of a joint's term, 0 if it has none.
    #[must_use]
    pub fn coefficient(&self, joint: usize, term: Term) -> f64 {
        let found = self.terms.iter().find(|it| it.joint == joint && it.term == term);
        found.map_or(0.0, |it| it.coefficient)
    }

    /// Coefficient of a joint's term, added if the joint has none.
    pub fn coefficient_mut(&mut self, joint: usize, term: Term) -> &mut f64 {
        let at = self.terms.iter().position(|it| it.joint == joint && it.term == term);
        let at = at.unwrap_or(self.terms.len());
        if at == self.terms.len() {
            self.terms.push(JointTerm { joint, term, coefficient: 0.0 });
        }
        &mut self.terms[at].coefficient
    }

    /// Joint offsets: joint value minus reading at zero, radians or metres (lou2009: Δθ).
    #[must_use]
    pub fn offsets(&self) -> Vec<f64> {
        (0..self.kinds().len()).map(|joint| self.coefficient(joint, Term::OFFSET)).collect()
    }

    /// The same estimate with other joint offsets.
    #[must_use]
    pub fn with_offsets(&self, offsets: &[f64]) -> Self {
        let mut estimate = self.clone();
        for (joint, &offset) in offsets.iter().enumerate() {
            *estimate.coefficient_mut(joint, Term::OFFSET) = offset;
        }
        estimate
    }

    /// The same robot without joint offsets. The offset of joint i moves all screws beyond it, `ξ_j ← Ad_exp(ξ_i δ) ξ_j` for j > i, and the
    /// targets and instruments there. The result is exact; no prediction changes (lou2009 equations 11 to 15, theory.md §3 (9a)).
    #[must_use]
    pub fn without_offsets(&self) -> Self {
        if self.offsets().iter().all(|&offset| offset == 0.0) {
            return self.clone();
        }
        let (screws, offsets) = (self.screws(), self.offsets());
        let mut moved = self.clone();
        moved.terms.retain(|it| it.term != Term::OFFSET);
        // Motion of each joint's link, and of all objects on it.
        let mut motions: Vec<Pose> = Vec::with_capacity(screws.len());
        let of = |motions: &[Pose], body: Option<usize>| {
            body.and_then(|joint| motions.get(joint)).copied().unwrap_or_else(Pose::identity)
        };
        for (joint, frame) in moved.base_from_axis.iter_mut().enumerate() {
            let before = of(&motions, self.tree.joint_before(joint));
            *frame = (before * *frame).orthonormalized();
            motions.push(before * screws[joint].exp(offsets[joint]));
        }
        for (target, body) in moved.base_from_target.iter_mut().zip(self.tree.targets()) {
            *target = (of(&motions, body.joint()) * *target).orthonormalized();
        }
        for (station, stand) in self.tree.instruments().iter().enumerate() {
            if let InstrumentMount::On(Body::Link(joint)) = *stand {
                let device = moved.device_mut(station);
                *device = (*device * of(&motions, Some(joint)).inverse()).orthonormalized();
            }
        }
        moved
    }

    /// Moves each axis frame's origin along its axis to the point nearest to the targets' mean position relative to that joint. A tilt has
    /// the least leverage there (theory.md §5, below (18)). Screws do not change.
    pub fn recentre(&mut self, session: &Session<'_>, rows: &[u32]) {
        let sample = sample_rows(rows, 200);
        let count = sample.len() as f64;
        let linkage = Linkage::new(self);
        let mut chain = RowChain::default();
        let mut along = vec![0.0; self.kinds().len()];
        for &row in &sample {
            let seen = session.observation(row);
            chain.evaluate(&linkage, session.packed, row as usize, seen);
            for view in &chain.joints {
                along[view.joint] += view.z.dot(&(chain.target.translation - view.origin)) / count;
            }
        }
        for (frame, shift) in self.base_from_axis.iter_mut().zip(along) {
            frame.translation += frame.rotation.column(2) * shift;
        }
    }
}

/// Metres that a radian counts, L: a third of the reach of the arm with the strokes in the data (theory.md §6, *Physical scaling*).
#[must_use]
pub fn radian_m(robot: &Robot, packed: &PackedValues) -> f64 {
    let strokes: f64 = (0..robot.joints.len())
        .filter(|&joint| robot.joints[joint].kind == JointKind::Prismatic)
        .map(|joint| {
            let values = (0..packed.rows()).map(|row| packed.joint(row, joint).0);
            let (least, most) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
            (most - least).max(0.0)
        })
        .sum();
    (robot.arm_m() + strokes) / 3.0
}

/// Nominal estimate: nominal screws, each target and instrument at its pose in the model, other targets at the tip, and other
/// instruments at the base.
#[must_use]
pub fn nominal_estimate(robot: &Robot, data: &Dataset) -> Estimate {
    let place = robot.places_of_targets();
    let base_from_target = data.targets.iter().map(|name| place(name.as_deref()).1).collect();
    let mut delivered =
        Estimate::from_placed(robot, KinematicTree::from_robot(robot, data), base_from_target, Pose::identity());
    for station in 0..data.station_count() {
        let name = data.stations.get(station).and_then(Option::as_deref);
        if let Some(mount) = robot.instruments.iter().find(|mount| Some(mount.name.as_str()) == name) {
            *delivered.device_mut(station) = robot.base_from(mount).inverse();
        }
    }
    delivered
}

/// A frame with z along the screw and its origin at the axis point nearest to `near`.
fn axis_frame(screw: &Screw, near: &Vector3<f64>) -> Pose {
    let z = screw.direction();
    let x = rotation::perpendicular_to(&z);
    let turn = nalgebra::Matrix3::from_columns(&[x, z.cross(&x), z]);
    Pose::new(turn, screw.nearest_point(near))
}
