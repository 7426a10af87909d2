//! Rank judged against the noise, and undetermined directions described with joint names (theory.md §7 (36)).

use std::borrow::Cow;

use super::causes::{Degree, explain};
use super::direction::{Cause, Direction};
use super::excitation::Excitation;
use super::observability::Observability;
use super::open_offsets::open_offsets;
use super::setup::AnalysisSetup;
use super::spectrum::{PLAUSIBLE, ROUNDING, Spectrum, WEAK, rounding};
use crate::parameters::Parameter;
use poecal_model::robot::{Joint, JointKind, Term};
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// Unknowns, their determined directions, and the directions that are not determined.
///
/// ```
/// # use poecal_fit::analysis::{PlannedSession, identify};
/// # use poecal_model::{measurement::SessionKind, simulate::{Simulation, elbow}};
/// let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?;
/// let found = identify(&made.nominal, made.data.all_readings(), &PlannedSession::default())?.identifiability;
/// assert_eq!((found.rank, found.parameters), (30, 30));
/// assert!(found.unidentifiable.is_empty() && found.spectrum.determined_unknowns().iter().all(|&known| known));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiability {
    /// Unknowns in the minimal basis: 4 a revolute joint, 2 a prismatic one, 6 a target frame, 3 a target point.
    pub parameters: usize,
    /// Number of directions that the measurements determine against the noise.
    pub rank: usize,
    /// Effective number of unknowns that the measurements determine beside the prior, `Σ_k λ_k / (λ_k + 1)` with λ_k the information of the
    /// measurements over that of the prior: theory.md §6 (34).
    pub effective_unknowns: f64,
    /// Largest singular value of the scaled Jacobian over the smallest that counts to the rank.
    pub condition: f64,
    /// Directions that these configurations do not determine.
    pub unidentifiable: Vec<Direction>,
    /// Directions that they determine weakly, little better than the nominal model.
    pub weak: Vec<Direction>,
    /// Directions that no measurement of this kind can determine: not among the parameters, and without effect on predictions.
    pub structural: Vec<Direction>,
    /// Observability indices of the configurations.
    pub observability: Observability,
    /// Eigenvalues of the information.
    pub spectrum: Spectrum,
}

impl Identifiability {
    /// Number of unknowns that are determined weakly.
    #[must_use]
    pub fn weakly_determined(&self) -> usize {
        self.weak.iter().map(|direction| direction.directions).sum()
    }
}

/// Variance `s²` of the whitened residuals, `2F / (m − n)` as in theory.md §7 (36): 1 if the noise is as stated.
#[must_use]
pub fn residual_variance(normal: &NormalEquations) -> f64 {
    let residuals = normal.residuals as f64;
    normal.mean_square() * residuals / (residuals - normal.dim() as f64).max(1.0)
}

/// Effective number of unknowns determined by a part of the residuals, `tr(N⁻¹ N_part)`: theory.md §6 (34).
#[must_use]
pub fn effective_unknowns(normal: &NormalEquations, part: &NormalEquations) -> f64 {
    let n = normal.dim();
    let largest = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
    let Some(factor) = linalg::cholesky(&normal.gram, n, (ROUNDING * ROUNDING * largest).max(f64::MIN_POSITIVE)) else {
        return 0.0;
    };
    linalg::trace_of_quotient(&factor, &part.gram, n)
}

/// Identifiability from the information `N` (upper triangle, row-major) and the variance of the residuals: theory.md §7 (36).
#[must_use]
pub fn identifiability(setup: &AnalysisSetup<'_>, gram: &[f64], variance: f64) -> Identifiability {
    let n = setup.layout.dim();
    // Motions of the base without any effect are no unknowns: they count as known.
    let motions = setup.layout.motions_without_effect(setup.estimate, &setup.session, setup.rows);
    let base = motions.directions;
    let least = variance / (PLAUSIBLE * setup.session.length_m).powi(2);
    let gram = &with_known(gram, n, &base, least);
    let spectrum = Spectrum::new(gram, n, variance, setup.session.length_m);
    let values = &spectrum.values;
    let largest = values.last().copied().unwrap_or(0.0);
    let condition = values.get(spectrum.undetermined).map_or(f64::INFINITY, |&value| (largest / value).sqrt());
    let singular: Vec<f64> = {
        let least = rounding(values);
        values.iter().rev().map(|&value| if value > least { value.sqrt() } else { 0.0 }).collect()
    };
    let excitation = Excitation::new(setup);
    let weak = (spectrum.undetermined..n).take_while(|&k| spectrum.sigma_m(k) > WEAK * setup.session.length_m).count();
    // The offset of a joint with a held axis is an unknown, also where a free target or device hides it.
    let mut unidentifiable = open_offsets(setup, &base);
    let open: usize = unidentifiable.iter().map(|direction| direction.directions).sum();
    unidentifiable.extend(explain(setup, &excitation, &spectrum, Degree::Undetermined));
    let mut hardly = explain(setup, &excitation, &spectrum, Degree::Weak(weak));
    hardly.extend(excitation.seen_once(setup));
    let rank = (n - spectrum.undetermined).saturating_sub(base.len());
    Identifiability {
        parameters: n + open - base.len(),
        rank,
        effective_unknowns: rank as f64,
        condition,
        unidentifiable,
        weak: hardly,
        structural: structural_kernel(setup, motions.of_base, (base.len() - motions.of_base).saturating_sub(open)),
        observability: Observability::new(&singular, setup.rows.len()),
        spectrum,
    }
}

/// The information, increased along some directions: as much as the measurements have of any unknown, and more than the least that
/// determines one.
fn with_known<'a>(gram: &'a [f64], n: usize, directions: &[Vec<f64>], least: f64) -> Cow<'a, [f64]> {
    let mut gram = Cow::Borrowed(gram);
    if directions.is_empty() {
        return gram;
    }
    let most = (0..n).map(|k| gram[k * n + k]).fold(2.0 * least, f64::max);
    for direction in directions {
        for (k, value) in gram.to_mut().iter_mut().enumerate() {
            *value += most * direction[k / n] * direction[k % n];
        }
    }
    gram
}

/// True if the offset of a joint is free.
fn has_offset(setup: &AnalysisSetup<'_>, joint: &Joint) -> bool {
    let name = |at: usize| setup.session.robot.joints.get(at).map(|it| it.name.as_str());
    let is_it = |parameter: &Parameter| {
        parameter.value_term().is_some_and(|it| it.term == Term::OFFSET && name(it.joint) == Some(&joint.name))
    };
    setup.layout.parameters().any(|(parameter, _)| is_it(parameter))
}

/// The structural kernel, known before any measurement: theory.md §7 (35). `base_motions` counts the motions of the base that have no
/// effect although some blocks are held.
fn structural_kernel(setup: &AnalysisSetup<'_>, base_motions: usize, offsets: usize) -> Vec<Direction> {
    let unknowns = setup.session.unknowns;
    let joints = setup.session.robot.joints.iter().enumerate();
    let joints: Vec<&Joint> = joints.filter(|(joint, _)| unknowns.moves_axis(*joint)).map(|(_, joint)| joint).collect();
    let names: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
    let sliding = joints.iter().filter(|joint| joint.kind == JointKind::Prismatic).count();
    let turning = joints.len() - sliding;
    let mut found = Vec::new();
    let mut add = |cause, directions, joints: &[String], description: &str| {
        if directions > 0 {
            let (description, joints) = (description.to_owned(), joints.to_vec());
            found.push(Direction { description, joints, cause, directions });
        }
    };
    let own = match (turning, sliding) {
        (_, 0) => "turning or shifting a revolute joint along its own axis has no effect: not an unknown",
        (0, _) => "shifting a prismatic joint, or turning it about its own direction, has no effect: not an unknown",
        _ => {
            "turning or shifting a revolute joint along its own axis has no effect, nor has shifting a prismatic joint: not an unknown"
        }
    };
    add(Cause::OwnAxis, 2 * turning + 4 * sliding, &names, own);
    if setup.session.base_free() {
        let base = "base frame: moving it under all axes is the same as moving the device: kept as in the model";
        add(Cause::BaseFrame, 6, &[], base);
    }
    let base = "base frame: the held axes and targets leave motions of it that are the same as moving the device: chosen nearest to the model";
    add(Cause::BaseFrame, base_motions, &[], base);
    let free = "joint offsets: motions of free axes, targets or the device have the same effect as some of them together: chosen nearest to the \
                model; hold axes (--fix joints) to find offsets";
    let beside_axes: Vec<String> =
        joints.iter().filter(|joint| has_offset(setup, joint)).map(|it| it.name.clone()).collect();
    add(Cause::JointOffsets, offsets, &beside_axes, free);
    let zeros = "joint offsets: later axes and the tool have the same effect: kept as read";
    // Beside held axes or targets an offset is not an additional unknown.
    if unknowns.are_usual() {
        add(Cause::JointOffsets, joints.len(), &names, zeros);
    }
    let points = setup.layout.parameters().filter(|(it, _)| matches!(it, Parameter::TargetPlace(_))).count();
    let no_orientation = "orientation of the tool: no orientation was measured";
    add(Cause::NoOrientation, 3 * points, &[], no_orientation);
    found
}
