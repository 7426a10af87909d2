//! Hypotheses about events during a session, as derivatives of its rows.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::corrections::CorrectedFit;
use poecal_fit::parameters::{Parameter, ParameterSubject, ValueTerm};
use poecal_fit::start::device_parameter;
use poecal_fit::state::Session;
use poecal_model::robot::Term;

/// Moved object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MovedPart {
    /// The device at a station.
    Device(usize),
    /// A target.
    Target(usize),
    /// All targets, as one body.
    Tool,
    /// The zero of a joint.
    Zero(usize),
    /// The device at a station, steadily.
    Drift(usize),
}

/// A hypothesis with its parameters.
pub(crate) struct EventHypothesis {
    moved: MovedPart,
    /// Index of each parameter, and its dependence on the unknowns of the hypothesis.
    parts: Vec<(usize, FollowRule)>,
    unknowns: usize,
}

/// Dependence of a parameter on the unknowns.
enum FollowRule {
    /// Its unknowns are the unknowns of the hypothesis.
    Own,
    /// A target that follows a motion of the tool: its orientation with all joints at zero, its offset from the middle, and the motions that are its
    /// unknowns.
    Carried(Matrix3<f64>, Vector3<f64>, &'static [usize]),
}

/// The derivatives of all numbers by the unknowns of a hypothesis, metres and radians.
pub(crate) struct HypothesisColumns {
    pub(crate) moved: MovedPart,
    pub(crate) of: DMatrix<f64>,
    /// Marks each unknown that is an angle.
    pub(crate) turns: Vec<bool>,
    /// Marks each row that depends on the unknowns.
    pub(crate) sees: Vec<bool>,
}

/// All hypotheses; parameters that the fit does not have are appended to `free`.
pub(crate) fn hypotheses(
    session: &Session<'_>,
    found: &CorrectedFit,
    rows: &[u32],
    free: &mut Vec<Parameter>,
) -> Vec<EventHypothesis> {
    let mut all = Vec::new();
    let data = session.data;
    let place = |free: &mut Vec<Parameter>, parameter: Parameter| {
        free.push(parameter);
        free.len() - 1
    };
    for station in 0..data.station_count() {
        if data.seen_from(station, rows).is_empty() || found.estimate.tree.shared_target(station).is_some() {
            continue;
        }
        let known = free.iter().position(|it| it.model().subject() == ParameterSubject::Instrument(station));
        let at = known.unwrap_or_else(|| place(free, device_parameter(data, station, rows)));
        let unknowns = free[at].model().columns().len();
        for moved in [MovedPart::Device(station), MovedPart::Drift(station)] {
            all.push(EventHypothesis { moved, parts: vec![(at, FollowRule::Own)], unknowns });
        }
    }
    let targets: Vec<(usize, usize)> = (0..data.targets.len())
        .filter_map(|target| {
            let at = free.iter().position(|it| it.model().subject() == ParameterSubject::Target(target))?;
            Some((target, at))
        })
        .collect();
    for &(target, at) in &targets {
        let unknowns = free[at].model().columns().len();
        all.push(EventHypothesis { moved: MovedPart::Target(target), parts: vec![(at, FollowRule::Own)], unknowns });
    }
    if targets.len() > 1 {
        let poses = &found.estimate.base_from_target;
        let sum = targets.iter().filter_map(|(target, _)| poses.get(*target)).map(|it| it.translation);
        let middle = sum.sum::<Vector3<f64>>() / targets.len() as f64;
        let parts = targets.iter().filter_map(|&(target, at)| {
            let pose = poses.get(target)?;
            let (_, motions) = free[at].target_motions()?;
            let turn = pose.rotation;
            Some((at, FollowRule::Carried(turn, pose.translation - middle, motions)))
        });
        all.push(EventHypothesis { moved: MovedPart::Tool, parts: parts.collect(), unknowns: 6 });
    }
    for (joint, &at) in found.model.places.iter().enumerate() {
        let Some(&kind) = found.estimate.kinds().get(at) else { continue };
        let term = ValueTerm { joint: at, kind, term: Term::OFFSET };
        let known = free.iter().position(|it| it.value_term().is_some_and(|own| *own == term));
        let at = known.unwrap_or_else(|| place(free, Parameter::ValueTerm(term)));
        all.push(EventHypothesis { moved: MovedPart::Zero(joint), parts: vec![(at, FollowRule::Own)], unknowns: 1 });
    }
    all
}

impl EventHypothesis {
    /// Derivatives of rows by the unknowns of the hypothesis.
    pub(crate) fn columns(
        &self,
        jacobian: &DMatrix<f64>,
        places: &[Vec<(usize, f64)>],
        rows: &[u32],
        session: &Session<'_>,
    ) -> HypothesisColumns {
        let mut of = DMatrix::zeros(jacobian.nrows(), self.unknowns);
        let mut turns = vec![false; self.unknowns];
        for (at, part) in &self.parts {
            let own = places.get(*at).map(Vec::as_slice).unwrap_or_default();
            match part {
                FollowRule::Own => {
                    for (k, (place, scale)) in own.iter().enumerate() {
                        of.column_mut(k).axpy(*scale, &jacobian.column(*place), 1.0);
                        turns[k] = *scale != 1.0;
                    }
                }
                FollowRule::Carried(turn, arm, motions) => {
                    for (k, is_turn) in turns.iter_mut().enumerate() {
                        let axis = Vector3::ith(k % 3, 1.0);
                        *is_turn = k >= 3;
                        let (shift, angle) = if k < 3 { (axis, Vector3::zeros()) } else { (axis.cross(arm), axis) };
                        let (shift, angle) = (turn.transpose() * shift, turn.transpose() * angle);
                        for (&motion, (place, scale)) in motions.iter().zip(own) {
                            let step = if motion < 3 { shift[motion] } else { angle[motion - 3] };
                            of.column_mut(k).axpy(step * scale, &jacobian.column(*place), 1.0);
                        }
                    }
                }
            }
        }
        let sees = rows.iter().map(|&row| {
            let seen = session.observation(row);
            match self.moved {
                MovedPart::Device(station) | MovedPart::Drift(station) => seen.station == station,
                MovedPart::Target(target) => seen.target == target,
                MovedPart::Tool | MovedPart::Zero(_) => true,
            }
        });
        let sees = sees.collect();
        HypothesisColumns { moved: self.moved, of, turns, sees }
    }
}
