//! Motions without effect, in a fit in which some blocks are held or joint offsets are unknown.

use nalgebra::{DMatrix, Vector3, Vector6};

use super::Layout;
use crate::parameters::{Parameter, ParameterSubject};
use crate::state::{Estimate, InstrumentMount, Session};
use poecal_arm::lie::{Freedom, Pose, Twist};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Body, JointKind, Term};
use poecal_numerics::linalg;

/// Share of the largest information about a motion below which held blocks do not constrain it: rounding.
const UNSEEN: f64 = 1e-12;

/// Directions of a step without effect on the measurements of some rows.
pub struct NullDirections {
    /// Orthonormal directions.
    pub directions: Vec<Vec<f64>>,
    /// Number of these that are motions of the base alone.
    pub(crate) of_base: usize,
}

/// A motion of all objects on some bodies: on all of them (the base), or on those beyond a joint, against its offset.
struct BodyMotion {
    twist: Twist,
    beyond: Option<usize>,
    /// Place of the offset in a step, and its change.
    offset: Option<(usize, f64)>,
}

impl Layout {
    /// Motions that leave all held blocks in place and change no measurement of these rows. They are those of the base under all
    /// bodies (theory.md §8 (37)), and of the bodies beyond a joint with its offset turned back (§3 (9)).
    #[must_use]
    pub fn motions_without_effect(&self, estimate: &Estimate, session: &Session<'_>, rows: &[u32]) -> NullDirections {
        let data = session.data;
        let base = base_motions(self.length_m());
        // The terms of a formulation are compared as they are.
        let offsets = if session.unknowns.terms.is_empty() { Vec::new() } else { self.offset_motions(estimate) };
        let is_held = |station: usize| {
            let of_it =
                |(parameter, _): (&Parameter, _)| parameter.model().subject() == ParameterSubject::Instrument(station);
            !self.parameters().any(of_it)
        };
        let sees_axes = |station: usize| data.device_freedom(station, rows) == Freedom::FRAME;
        let first = data.first_station(rows);
        let of_base = if is_held(first) && estimate.tree.shared_target(first).is_none() && sees_axes(first) {
            // The first device frame holds the base.
            0
        } else {
            self.unobserved_combinations(estimate, data, rows, (&base, &|_| true)).len()
        };
        if offsets.is_empty() && of_base == 0 {
            return NullDirections { directions: Vec::new(), of_base };
        }
        let all: Vec<BodyMotion> = base.into_iter().chain(offsets).collect();
        NullDirections { directions: self.unobserved_combinations(estimate, data, rows, (&all, &|_| true)), of_base }
    }

    /// Motions of the base that leave all held blocks in place, except the joints by which links bend: these move with the links.
    pub(crate) fn base_motions(&self, estimate: &Estimate, session: &Session<'_>, rows: &[u32]) -> Vec<Vec<f64>> {
        let bends = |joint: usize| session.robot.joints.get(joint).is_some_and(|it| it.give_of.is_some());
        self.unobserved_combinations(
            estimate,
            session.data,
            rows,
            (&base_motions(self.length_m()), &|joint| !bends(joint)),
        )
    }

    /// Growth about the first station of all quantities that these rows measure. It changes no measurement if none has a length. In this
    /// step a point 1 m from the station moves by 1 m.
    pub(crate) fn growth(&self, estimate: &Estimate, data: &Dataset, rows: &[u32]) -> Vec<f64> {
        let centre = estimate.device(data.first_station(rows)).inverse().translation;
        let local = |frame: &Pose| frame.rotation.tr_mul(&(frame.translation - centre));
        let mut step = vec![0.0; self.dim()];
        for (parameter, places) in self.parameters() {
            let (freedom, shift) = match parameter.model().subject() {
                ParameterSubject::Joint(joint) if parameter.value_term().is_none() => {
                    let is_revolute = estimate.kinds().get(joint) == Some(&JointKind::Revolute);
                    let freedom = Freedom::from_motions([0, 1].into_iter().filter(|_| is_revolute));
                    (freedom, estimate.base_from_axis.get(joint).map(local))
                }
                ParameterSubject::Target(target) => {
                    let freedom = self.freedom_of(target).unwrap_or(Freedom::PLACE);
                    (freedom, estimate.base_from_target.get(target).map(local))
                }
                ParameterSubject::Instrument(station) => {
                    let device = estimate.device(station);
                    let shift = device.rotation * centre + device.translation;
                    (data.device_freedom(station, rows), Some(shift))
                }
                ParameterSubject::Joint(_) | ParameterSubject::Range(_) | ParameterSubject::Clock(_) => {
                    continue;
                }
            };
            let shift = shift.unwrap_or_default();
            let shifts = freedom.motions().iter().map(|&at| if at < 3 { shift[at] } else { 0.0 });
            for (&(at, scale), shift) in places.iter().zip(shifts) {
                step[at] = shift * scale;
            }
        }
        step
    }

    /// Motions of unknown offsets.
    fn offset_motions(&self, estimate: &Estimate) -> Vec<BodyMotion> {
        let screws = estimate.screws();
        let motion = |(parameter, places): (&Parameter, &[(usize, f64)])| {
            let term = parameter.value_term().filter(|it| it.term == Term::OFFSET)?;
            let &(place, scale) = places.first()?;
            let size = if term.kind == JointKind::Revolute { 1.0 / self.length_m() } else { 1.0 };
            let twist = Twist::from_vector(&(screws.get(term.joint)?.twist().to_vector() * size));
            Some(BodyMotion { twist, beyond: Some(term.joint), offset: Some((place, -size * scale)) })
        };
        self.parameters().filter_map(motion).collect()
    }

    /// Combinations of motions that no held block constrains.
    fn unobserved_combinations(
        &self,
        estimate: &Estimate,
        data: &Dataset,
        rows: &[u32],
        (motions, holds): (&[BodyMotion], &dyn Fn(usize) -> bool),
    ) -> Vec<Vec<f64>> {
        let count = motions.len();
        let mut moved = begin_steps(motions, self.dim());
        // Information of the held blocks on the motions.
        let mut gram = DMatrix::zeros(count, count);
        let mut add = |subject: ParameterSubject, body: Option<Body>, effect: &dyn Fn(&Twist) -> Vec<f64>| {
            let is_of =
                |parameter: &&Parameter| parameter.model().subject() == subject && parameter.value_term().is_none();
            let own = self.parameters().find(|(parameter, _)| is_of(parameter));
            let effects = effects_on(estimate, body, motions, effect);
            match own {
                Some((_, places)) => {
                    for (step, effect) in moved.iter_mut().zip(&effects) {
                        places.iter().zip(effect).for_each(|(&(at, scale), value)| step[at] = value * scale);
                    }
                }
                None => gram += DMatrix::from_fn(count, count, |i, j| linalg::dot(&effects[i], &effects[j])),
            }
        };
        // A motion in the axes of the object at `frame`: positions, then rotations.
        let local = |frame: &Pose, twist: &Twist| frame.inverse().transform(twist).to_vector();
        let axes = estimate.base_from_axis.iter().zip(estimate.kinds()).enumerate();
        for (joint, (frame, kind)) in axes.filter(|(joint, _)| holds(*joint)) {
            let body = estimate.tree.joint_before(joint).map_or(Body::Base, Body::Link);
            add(ParameterSubject::Joint(joint), Some(body), &|twist| of_axis(*kind, &local(frame, twist)));
        }
        let freedoms = data.target_freedoms(rows);
        for (target, frame) in estimate.base_from_target.iter().enumerate() {
            let body = estimate.tree.targets().get(target).copied();
            let freedom = self.freedom_of(target).or(freedoms.get(target).copied()).unwrap_or(Freedom::PLACE);
            add(ParameterSubject::Target(target), body, &|twist| seen_of(freedom, &local(frame, twist)));
        }
        for station in 0..=estimate.further_devices.len() {
            let body = body_of(estimate, station);
            // A station without rows holds nothing.
            let is_seen = data.station_count() == 1 || !data.seen_from(station, rows).is_empty();
            if estimate.tree.shared_target(station).is_none() && is_seen {
                let device = estimate.device(station);
                // An unobservable motion is not held.
                let freedom = data.device_freedom(station, rows);
                let at = Pose::from_translation(self.point_of(station).unwrap_or_default());
                // `device_from_base G⁻¹`, stepped in the device's axes about a point. The base itself moves under the objects on it.
                add(ParameterSubject::Instrument(station), Some(body), &|twist| {
                    seen_of(freedom, &-at.inverse().transform(&device.transform(twist)).to_vector())
                });
            }
        }
        combine(&gram, &moved, self.dim())
    }

    /// Degrees of freedom of a target whose frame is unknown.
    fn freedom_of(&self, target: usize) -> Option<Freedom> {
        self.parameters().find_map(|(parameter, _)| match parameter {
            Parameter::TargetFrame(own) if own.target == target => Some(own.freedom),
            Parameter::TargetFrame(_)
            | Parameter::TargetPlace(_)
            | Parameter::ScrewAxis(_)
            | Parameter::OtherScrew(_)
            | Parameter::ValueTerm(_)
            | Parameter::DeviceFrame(_)
            | Parameter::RangeUnknown(_)
            | Parameter::ClockUnknown(_) => None,
        })
    }

    /// Point about which the frame of a device turns, if that is unknown.
    fn point_of(&self, station: usize) -> Option<Vector3<f64>> {
        self.parameters().find_map(|(parameter, _)| {
            let Parameter::DeviceFrame(own) = parameter else { return None };
            (own.station == station).then_some(own.about)
        })
    }
}

/// A step for each motion, of the offsets alone.
fn begin_steps(motions: &[BodyMotion], dim: usize) -> Vec<Vec<f64>> {
    let mut moved: Vec<Vec<f64>> = vec![vec![0.0; dim]; motions.len()];
    for (step, motion) in moved.iter_mut().zip(motions) {
        motion.offset.iter().for_each(|&(place, change)| step[place] = change);
    }
    moved
}

/// Effect of each motion on a body; zero if the motion does not move it.
fn effects_on(
    estimate: &Estimate,
    body: Option<Body>,
    motions: &[BodyMotion],
    effect: &dyn Fn(&Twist) -> Vec<f64>,
) -> Vec<Vec<f64>> {
    let of_motion = |motion: &BodyMotion| {
        let is_moved = motion.beyond.is_none_or(|joint| is_beyond(estimate, body, joint));
        if is_moved { effect(&motion.twist) } else { Vec::new() }
    };
    motions.iter().map(of_motion).collect()
}

/// Orthonormal combinations of steps that no held block constrains.
fn combine(gram: &DMatrix<f64>, moved: &[Vec<f64>], dim: usize) -> Vec<Vec<f64>> {
    orthonormal(null_space(gram).into_iter().map(|shares| {
        let mut step = vec![0.0; dim];
        for (share, moved) in shares.iter().zip(moved) {
            step.iter_mut().zip(moved).for_each(|(step, moved)| *step += share * moved);
        }
        step
    }))
}

/// Body that carries an instrument.
fn body_of(estimate: &Estimate, station: usize) -> Body {
    match estimate.tree.instruments().get(station) {
        Some(InstrumentMount::On(body)) => *body,
        Some(InstrumentMount::Target(_)) | None => Body::Base,
    }
}

/// Motions of an axis, along and about its own axes, that are unknowns.
fn of_axis(kind: JointKind, motion: &Vector6<f64>) -> Vec<f64> {
    match kind {
        JointKind::Revolute => vec![motion[0], motion[1], motion[3], motion[4]],
        JointKind::Prismatic => vec![motion[3], motion[4]],
    }
}

/// Observable motions of a frame.
fn seen_of(freedom: Freedom, motion: &Vector6<f64>) -> Vec<f64> {
    freedom.motions().iter().filter_map(|&at| motion.get(at).copied()).collect()
}

/// The six motions of the base; rotations count like lengths.
fn base_motions(length_m: f64) -> Vec<BodyMotion> {
    let motion = |k: usize| {
        let mut twist = Vector6::zeros();
        twist[k] = if k < 3 { 1.0 } else { 1.0 / length_m };
        BodyMotion { twist: Twist::from_vector(&twist), beyond: None, offset: None }
    };
    (0..6).map(motion).collect()
}

/// True if a joint moves a body.
fn is_beyond(estimate: &Estimate, body: Option<Body>, joint: usize) -> bool {
    let first = body.and_then(Body::joint);
    std::iter::successors(first, |&at| estimate.tree.joint_before(at)).any(|at| at == joint)
}

/// Unit vectors of the null space.
fn null_space(gram: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let (values, vectors) = linalg::symmetric_eigen(gram.as_slice(), gram.nrows());
    let largest = values.last().copied().unwrap_or(0.0);
    let count = values.iter().take_while(|&&value| value <= UNSEEN * largest.max(1.0)).count();
    vectors.column_iter().take(count).map(|it| it.iter().copied().collect()).collect()
}

/// Orthonormal vectors of the same span.
fn orthonormal(vectors: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    for mut vector in vectors {
        for known in &found {
            let along = linalg::dot(&vector, known);
            vector.iter_mut().zip(known).for_each(|(value, known)| *value -= along * known);
        }
        let length = linalg::dot(&vector, &vector).sqrt();
        if length > UNSEEN {
            vector.iter_mut().for_each(|value| *value /= length);
            found.push(vector);
        }
    }
    found
}
