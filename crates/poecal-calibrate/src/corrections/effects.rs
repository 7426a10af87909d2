//! Effects of the terms of a corrected model at each joint: their size, their uncertainty, and their course over the joint's range.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::effect::{Effects, JointEffect, JointErrorPart, JointErrors};
use poecal_fit::parameters::Parameter;
use poecal_fit::state::{Estimate, Linkage, RowChain, RowError, Session, sample_rows};
use poecal_fit::uncertainty::Uncertainty;
use poecal_model::measurement::{Noise, Quantity};
use poecal_model::robot::{CorrectionModel, JointKind, Robot, Term, TermGroup};

/// Most rows by which effects are measured.
const ROWS: usize = 400;
/// Parts of a joint's sampled range, and fewest rows of a part.
const PARTS: usize = 12;
const FEWEST: usize = 3;
/// Standard deviation of a joint's error above which it counts as undetermined, radians or metres.
const VAGUE: f64 = 1e-3;
/// Correlation above which the measurements do not distinguish two effects.
const CONFUSED: f64 = 0.8;

/// A term at one row: its index among the unknowns of the covariance with the scale there, its coefficient and its function.
struct TermAtRow {
    place: Option<(usize, f64)>,
    coefficient: f64,
    basis: f64,
    deviation: f64,
}

/// Effects of the terms of a model. `calibrated` holds session and estimate of geometry alone, for the same rows.
pub(crate) fn effects(
    model: &CorrectionModel,
    (session, estimate): (&Session<'_>, &Estimate),
    (of_geometry, calibrated): (&Session<'_>, &Estimate),
    rows: &[u32],
    (uncertainty, deviations): (&Uncertainty, &[f64]),
    noise: Noise,
) -> Effects {
    let rows = sample_rows(rows, ROWS);
    let gatherer = Gatherer::new(model, session, estimate, uncertainty, deviations);
    let mut found: Vec<(JointEffect, Vec<(usize, f64)>)> = Vec::new();
    let mut errors = Vec::new();
    let residuals = [(of_geometry, calibrated), (session, estimate)].map(|(session, it)| session.errors(&rows, it));
    let motions = joint_motions(session, estimate, &rows);
    for &joint in &model.places {
        let slides = model.robot.joints[joint].kind == JointKind::Prismatic;
        let name = model.robot.joints[joint].name.clone();
        for group in TermGroup::ALL {
            let terms = gatherer.terms_of_joint(joint, group);
            if let Some(effect) = gatherer.effect((&name, group), &terms, &rows, &motions) {
                found.push(effect);
            }
        }
        let parts = gatherer.errors(joint, &rows, &residuals, &motions[joint], noise);
        errors.push(JointErrors { joint: name, slides, parts });
    }
    let confused = gatherer.indistinguishable_pairs(&found);
    let mut each: Vec<JointEffect> = found.into_iter().map(|(effect, _)| effect).collect();
    each.sort_by(|a, b| b.effect_m.total_cmp(&a.effect_m));
    Effects { each, errors, confused }
}

/// Motion of the target by a joint, in the device's axes: of its position and of its orientation.
type JointMotion = (Vector3<f64>, Vector3<f64>);

/// Motion of the target by each joint and each compliant joint, row by row.
fn joint_motions(session: &Session<'_>, estimate: &Estimate, rows: &[u32]) -> Vec<Vec<JointMotion>> {
    let robot: &Robot = session.robot;
    let linkage = Linkage::new(estimate);
    let mut chain = RowChain::default();
    let mut motions = vec![vec![(Vector3::zeros(), Vector3::zeros()); rows.len()]; robot.joints.len()];
    for (at, &row) in rows.iter().enumerate() {
        chain.evaluate(&linkage, session.packed, row as usize, session.observation(row));
        for (joint, motions) in motions.iter_mut().enumerate() {
            let slides = robot.joints[joint].kind == JointKind::Prismatic;
            for view in chain.of_joint(joint) {
                let lever = chain.target.translation - view.origin;
                let (shift, turn) = if slides { (view.z, Vector3::zeros()) } else { (view.z.cross(&lever), view.z) };
                let way = if view.backward { -1.0 } else { 1.0 };
                motions[at].0 += shift * way;
                motions[at].1 += turn * way;
            }
        }
    }
    motions
}

/// Refers the functions of factors to their mean over all rows: a constant part belongs to geometry.
fn about_their_mean(of_rows: &mut [Vec<Vec<TermAtRow>>]) {
    let count = of_rows.len().max(1) as f64;
    let mut mean: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for of_row in &*of_rows {
        for (k, terms) in of_row.iter().enumerate() {
            for (l, it) in terms.iter().enumerate() {
                *mean.entry((k, l)).or_default() += it.basis / count;
            }
        }
    }
    for of_row in of_rows {
        for (k, terms) in of_row.iter_mut().enumerate() {
            for (l, it) in terms.iter_mut().enumerate() {
                it.basis -= mean.get(&(k, l)).copied().unwrap_or_default();
            }
        }
    }
}

/// Motion of a joint that explains most of the residuals of some rows, and its standard deviation.
fn explain_residuals(some: &[usize], errors: &[RowError], motions: &[JointMotion], noise: Noise) -> (f64, f64) {
    let weigh = [Quantity::Position, Quantity::Rotation].map(|it| noise[it].powi(-2));
    let (mut along, mut information) = (0.0, 0.0);
    for &at in some {
        let (shift, turn) = &motions[at];
        let seen = [(Quantity::Position, shift), (Quantity::Rotation, turn)];
        for ((quantity, motion), weight) in seen.into_iter().zip(weigh) {
            if errors[at].length(quantity).is_some() {
                along += weight * motion.dot(&errors[at].vector(quantity));
                information += weight * motion.norm_squared();
            }
        }
    }
    (along / information, information.powf(-0.5))
}

struct Gatherer<'a> {
    model: &'a CorrectionModel,
    session: &'a Session<'a>,
    estimate: &'a Estimate,
    uncertainty: &'a Uncertainty,
    /// Prior standard deviation of each term of the groups.
    deviations: &'a [f64],
    places: BTreeMap<(usize, Term), (usize, f64)>,
}

impl<'a> Gatherer<'a> {
    fn new(
        model: &'a CorrectionModel,
        session: &'a Session<'a>,
        estimate: &'a Estimate,
        uncertainty: &'a Uncertainty,
        deviations: &'a [f64],
    ) -> Self {
        let terms = uncertainty.layout.parameters().filter_map(|(parameter, places)| match parameter {
            Parameter::ValueTerm(it) => Some(((it.joint, it.term), *places.first()?)),
            Parameter::ScrewAxis(_)
            | Parameter::OtherScrew(_)
            | Parameter::TargetPlace(_)
            | Parameter::TargetFrame(_)
            | Parameter::DeviceFrame(_)
            | Parameter::RangeUnknown(_)
            | Parameter::ClockUnknown(_) => None,
        });
        Gatherer { model, session, estimate, uncertainty, deviations, places: terms.collect() }
    }

    /// Terms of a group at a joint, grouped by each of its compliant joints.
    fn terms_of_joint(&self, joint: usize, group: TermGroup) -> Vec<Vec<(usize, Term, f64)>> {
        let all = self.model.terms().zip(self.model.groups.iter().zip(self.deviations));
        let mut found: BTreeMap<usize, Vec<(usize, Term, f64)>> = BTreeMap::new();
        for ((at, term), ((own, _), deviation)) in all {
            let of = self.model.robot.joints[at].give_of.unwrap_or(at);
            if of == joint && *own == group {
                found.entry(at).or_default().push((at, term, *deviation));
            }
        }
        found.into_values().collect()
    }

    fn terms_at_row(&self, terms: &[(usize, Term, f64)], row: u32) -> Vec<TermAtRow> {
        let term = |&(joint, term, deviation): &(usize, Term, f64)| TermAtRow {
            place: self.places.get(&(joint, term)).copied(),
            coefficient: self.estimate.coefficient(joint, term),
            basis: self.session.packed.basis(row as usize, None, joint, term),
            deviation,
        };
        terms.iter().map(term).collect()
    }

    /// Effect of a group, and the quantity that represents it as a combination of unknowns.
    fn effect(
        &self,
        (joint, group): (&str, TermGroup),
        terms: &[Vec<(usize, Term, f64)>],
        rows: &[u32],
        motions: &[Vec<JointMotion>],
    ) -> Option<(JointEffect, Vec<(usize, f64)>)> {
        let value = |terms: &[TermAtRow]| terms.iter().map(|it| it.coefficient * it.basis).sum::<f64>();
        // For compliant joints the vector of both turns is evaluated; the row with the largest one represents the effect.
        let mut of_rows: Vec<Vec<Vec<TermAtRow>>> =
            rows.iter().map(|&row| terms.iter().map(|terms| self.terms_at_row(terms, row)).collect()).collect();
        if group == TermGroup::Factors {
            about_their_mean(&mut of_rows);
        }
        let vectors: Vec<Vec<f64>> =
            of_rows.iter().map(|of_row| of_row.iter().map(|terms| value(terms)).collect()).collect();
        let length = |vector: &Vec<f64>| vector.iter().map(|it| it * it).sum::<f64>().sqrt();
        let largest = (0..rows.len()).max_by(|&a, &b| length(&vectors[a]).total_cmp(&length(&vectors[b])))?;
        let most = length(&vectors[largest]);
        let is_ratio = group == TermGroup::Ratio;
        if most == 0.0 {
            return None;
        }
        // Component along the vector at that row.
        let mut along: Vec<(usize, f64)> = Vec::new();
        let mut believed = 0.0;
        for (terms, share) in of_rows[largest].iter().zip(&vectors[largest]) {
            for it in terms {
                let (place, scale) = it.place?;
                let weight = if is_ratio { 1.0 } else { share / most * it.basis };
                along.push((place, weight / scale));
                believed += (weight * it.deviation).powi(2);
            }
        }
        let variance = self.covariance(&along, &along);
        let count = vectors.len() as f64;
        let turned: Vec<usize> = terms.iter().filter_map(|of_one| Some(of_one.first()?.0)).collect();
        let moved = |(row, vector): (usize, &Vec<f64>)| -> Vector3<f64> {
            turned.iter().zip(vector).map(|(&joint, value)| motions[joint][row].0 * *value).sum()
        };
        let moved: Vec<Vector3<f64>> = vectors.iter().enumerate().map(moved).collect();
        let mean = moved.iter().sum::<Vector3<f64>>() / count;
        let effect_m = (moved.iter().map(|it| (it - mean).norm_squared()).sum::<f64>() / count).sqrt();
        let coefficient = of_rows[largest].first()?.first()?.coefficient;
        let effect = JointEffect {
            joint: joint.to_owned(),
            group,
            amplitude: if is_ratio { coefficient } else { most },
            sigma: variance.max(0.0).sqrt(),
            told: (1.0 - variance / believed.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0),
            effect_m,
        };
        Some((effect, along))
    }

    fn covariance(&self, a: &[(usize, f64)], b: &[(usize, f64)]) -> f64 {
        let n = self.uncertainty.layout.dim();
        let products = a.iter().flat_map(|(i, x)| b.iter().map(move |(j, y)| (i * n + j, x * y)));
        products.map(|(at, product)| self.uncertainty.covariance[at] * product).sum::<f64>()
    }

    /// Errors of a joint in parts of its range.
    fn errors(
        &self,
        joint: usize,
        rows: &[u32],
        residuals: &[Vec<RowError>; 2],
        motions: &[JointMotion],
        noise: Noise,
    ) -> Vec<JointErrorPart> {
        let value = |row: u32| self.session.packed.joint_values(row as usize)[joint];
        // The terms of its compliant joints belong to other joints.
        let own: Vec<(usize, Term, f64)> = TermGroup::ALL
            .into_iter()
            .flat_map(|group| self.terms_of_joint(joint, group).concat())
            .filter(|(at, ..)| *at == joint)
            .collect();
        let (least, most) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &row| {
            (least.min(value(row)), most.max(value(row)))
        });
        let width = (most - least) / PARTS as f64;
        if width.is_nan() || width <= 0.0 {
            return Vec::new();
        }
        let part = |part: usize| {
            let range = [least + width * part as f64, least + width * (part + 1) as f64];
            let is_here = |row: u32| (((value(row) - least) / width) as usize).min(PARTS - 1) == part;
            let some: Vec<usize> = (0..rows.len()).filter(|&at| is_here(rows[at])).collect();
            if some.len() < FEWEST {
                return None;
            }
            let terms = self.mean_of(&own, some.iter().map(|&at| rows[at]));
            let [(before, sigma), (after, _)] =
                residuals.each_ref().map(|it| explain_residuals(&some, it, motions, noise));
            // A joint error that the target does not show is not reported.
            let shows = !sigma.is_nan() && sigma <= VAGUE;
            shows.then_some(JointErrorPart { range, rows: some.len(), before, after, terms })
        };
        (0..PARTS).filter_map(part).collect()
    }

    /// Mean deviation by terms in some rows, and its standard deviation.
    fn mean_of(&self, terms: &[(usize, Term, f64)], rows: impl ExactSizeIterator<Item = u32>) -> (f64, f64) {
        let count = rows.len() as f64;
        let mut mean = 0.0;
        let mut along: BTreeMap<usize, f64> = BTreeMap::new();
        for it in rows.flat_map(|row| self.terms_at_row(terms, row)) {
            mean += it.coefficient * it.basis / count;
            if let Some((place, scale)) = it.place {
                *along.entry(place).or_default() += it.basis / scale / count;
            }
        }
        let along: Vec<(usize, f64)> = along.into_iter().collect();
        (mean, self.covariance(&along, &along).max(0.0).sqrt())
    }

    /// Pairs of effects that the measurements do not distinguish.
    fn indistinguishable_pairs(&self, found: &[(JointEffect, Vec<(usize, f64)>)]) -> Vec<String> {
        let mut confused = Vec::new();
        for (k, (one, a)) in found.iter().enumerate() {
            for (other, b) in &found[k + 1..] {
                let correlation = self.covariance(a, b) / (one.sigma * other.sigma);
                // Undetermined effects cannot be distinguished anyway.
                let is_told = one.told.max(other.told) > 0.2;
                if is_told && correlation.abs() > CONFUSED {
                    confused.push(format!(
                        "{} of {} and {} of {} are hardly distinguishable (correlation {correlation:.2})",
                        one.group.name(),
                        one.joint,
                        other.group.name(),
                        other.joint
                    ));
                }
            }
        }
        confused
    }
}
