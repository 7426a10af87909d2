//! What the terms of a corrected model do at each joint: how much, how well it is told, and over the joint's range.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::estimate::{Chain, Estimate, Linkage, RowError, Session, sample_rows};
use crate::measurement::{Noise, Quantity};
use crate::parameters::Parameter;
use crate::robot::{CorrectionModel, JointKind, Robot, Term, TermGroup};
use crate::uncertainty::Uncertainty;

/// Most rows by which effects are measured.
const ROWS: usize = 400;
/// Parts of a joint's sampled range, and fewest rows of a part.
const PARTS: usize = 12;
const FEWEST: usize = 3;
/// Standard deviation of a joint's error above which it is not told, radians or metres.
const VAGUE: f64 = 1e-3;
/// Correlation of two effects above which the measurements do not tell them apart.
const CONFUSED: f64 = 0.8;

/// What one group of terms does at one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointEffect {
    /// Name of the joint.
    pub joint: String,
    /// The group.
    pub group: TermGroup,
    /// Largest deviation in the fitted rows, radians or metres ([`TermGroup::is_of_lengths`]); of a ratio the change each radian.
    pub amplitude: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Share of its prior variance that the measurements took away, 0 to 1.
    pub told: f64,
    /// Root mean square distance by which it moves the target in the fitted rows, but for the mean of all, metres.
    pub effect_m: f64,
}

impl JointEffect {
    /// The effect in words.
    #[must_use]
    pub fn words(&self) -> String {
        let JointEffect { joint, group, amplitude, .. } = self;
        let much = format!("{:.2} {}", 1e3 * amplitude.abs(), group.row().symbols[0]);
        let way = if *amplitude < 0.0 { "less" } else { "more" };
        let words = [("{much}", much.as_str()), ("{way}", way), ("{joint}", joint)];
        let effect = group.row().effect.to_owned();
        words.into_iter().fold(effect, |effect, (of, word)| effect.replace(of, word))
    }

    /// Whether it is more than chance and the prior make.
    #[must_use]
    pub fn is_found(&self) -> bool {
        self.amplitude.abs() > 2.0 * self.sigma && self.told > 0.5
    }
}

/// Error of a joint in a part of its range, radians or metres of its own value: the motion of the joint that explains most of the rows'
/// residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointErrorPart {
    /// From and to, values of the joint.
    pub range: [f64; 2],
    /// Number of rows.
    pub rows: usize,
    /// By the calibrated model.
    pub before: f64,
    /// By the corrected model.
    pub after: f64,
    /// Mean deviation by the joint's own terms, and its standard deviation.
    pub terms: (f64, f64),
}

/// Error of a joint over its sampled range.
#[derive(Clone, Debug, PartialEq)]
pub struct JointErrors {
    /// Name of the joint.
    pub joint: String,
    /// Whether it slides.
    pub slides: bool,
    /// The parts that have rows enough.
    pub parts: Vec<JointErrorPart>,
}

/// What the terms do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effects {
    /// Of each joint and group, the one that moves the target most first.
    pub each: Vec<JointEffect>,
    /// Of each joint over its range.
    pub errors: Vec<JointErrors>,
    /// Effects that the measurements do not tell apart, a sentence each.
    pub confused: Vec<String>,
}

/// A term at one row: its place among the unknowns of the covariance with the scale there, its coefficient and its function.
struct TermAt {
    place: Option<(usize, f64)>,
    coefficient: f64,
    basis: f64,
    deviation: f64,
}

/// Effects of the terms of a model. `calibrated` are session and estimate of geometry alone, of the same rows.
pub(super) fn effects(
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
    let residuals =
        [(of_geometry, calibrated), (session, estimate)].map(|(session, it)| session.errors(&rows, it));
    let motions = joint_motions(session, estimate, &rows);
    for &joint in &model.places {
        let slides = model.robot.joints[joint].kind == JointKind::Prismatic;
        let name = model.robot.joints[joint].name.clone();
        for group in TermGroup::ALL {
            let terms = gatherer.of(joint, group);
            if let Some(effect) = gatherer.effect((&name, group), &terms, &rows, &motions) {
                found.push(effect);
            }
        }
        let parts = gatherer.errors(joint, &rows, &residuals, &motions[joint], noise);
        errors.push(JointErrors { joint: name, slides, parts });
    }
    let confused = gatherer.confused(&found);
    let mut each: Vec<JointEffect> = found.into_iter().map(|(effect, _)| effect).collect();
    each.sort_by(|a, b| b.effect_m.total_cmp(&a.effect_m));
    Effects { each, errors, confused }
}

/// Motion of the target by a joint, in the device's axes: of its place, and of its orientation.
type Motion = (Vector3<f64>, Vector3<f64>);

/// Motion of the target by each joint and each give, row after row.
fn joint_motions(session: &Session<'_>, estimate: &Estimate, rows: &[u32]) -> Vec<Vec<Motion>> {
    let robot: &Robot = session.robot;
    let linkage = Linkage::new(estimate);
    let mut chain = Chain::default();
    let mut motions = vec![vec![(Vector3::zeros(), Vector3::zeros()); rows.len()]; robot.joints.len()];
    for (at, &row) in rows.iter().enumerate() {
        chain.evaluate(&linkage, session.packed, row as usize, session.observation(row));
        for (joint, motions) in motions.iter_mut().enumerate() {
            let slides = robot.joints[joint].kind == JointKind::Prismatic;
            for view in chain.of_joint(joint) {
                let lever = chain.target.translation - view.origin;
                let (shift, turn) =
                    if slides { (view.z, Vector3::zeros()) } else { (view.z.cross(&lever), view.z) };
                let way = if view.backward { -1.0 } else { 1.0 };
                motions[at].0 += shift * way;
                motions[at].1 += turn * way;
            }
        }
    }
    motions
}

/// Terms of factors as of their difference from the mean of all rows: what is the same everywhere is geometry.
fn about_their_mean(of_rows: &mut [Vec<Vec<TermAt>>]) {
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
            | Parameter::RangeUnknown(_) => None,
        });
        Gatherer { model, session, estimate, uncertainty, deviations, places: terms.collect() }
    }

    /// The terms of a group at a joint, those of each of its gives apart.
    fn of(&self, joint: usize, group: TermGroup) -> Vec<Vec<(usize, Term, f64)>> {
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

    fn at(&self, terms: &[(usize, Term, f64)], row: u32) -> Vec<TermAt> {
        let term = |&(joint, term, deviation): &(usize, Term, f64)| TermAt {
            place: self.places.get(&(joint, term)).copied(),
            coefficient: self.estimate.coefficient(joint, term),
            basis: self.session.packed.basis(row as usize, None, joint, term),
            deviation,
        };
        terms.iter().map(term).collect()
    }

    /// The effect of a group, and the quantity that stands for it as a combination of unknowns.
    fn effect(
        &self,
        (joint, group): (&str, TermGroup),
        terms: &[Vec<(usize, Term, f64)>],
        rows: &[u32],
        motions: &[Vec<Motion>],
    ) -> Option<(JointEffect, Vec<(usize, f64)>)> {
        let value = |terms: &[TermAt]| terms.iter().map(|it| it.coefficient * it.basis).sum::<f64>();
        // Of gives the vector of both turns; a row where it is largest stands for the effect.
        let mut of_rows: Vec<Vec<Vec<TermAt>>> =
            rows.iter().map(|&row| terms.iter().map(|terms| self.at(terms, row)).collect()).collect();
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
        // Along the vector at that row.
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
        motions: &[Motion],
        noise: Noise,
    ) -> Vec<JointErrorPart> {
        let value = |row: u32| self.session.packed.joint_values(row as usize)[joint];
        // The terms of its gives are at other joints.
        let own: Vec<(usize, Term, f64)> = TermGroup::ALL
            .into_iter()
            .flat_map(|group| self.of(joint, group).concat())
            .filter(|(at, ..)| *at == joint)
            .collect();
        let (least, most) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &row| {
            (least.min(value(row)), most.max(value(row)))
        });
        let width = (most - least) / PARTS as f64;
        if width.is_nan() || width <= 0.0 {
            return Vec::new();
        }
        let weigh = [Quantity::Position, Quantity::Rotation].map(|it| noise[it].powi(-2));
        // The motion of the joint that explains most of the residuals, and its standard deviation.
        let explained = |some: &[usize], errors: &[RowError]| {
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
        };
        let part = |part: usize| {
            let range = [least + width * part as f64, least + width * (part + 1) as f64];
            let is_here = |row: u32| {
                let at = ((value(row) - least) / width) as usize;
                at.min(PARTS - 1) == part
            };
            let some: Vec<usize> = (0..rows.len()).filter(|&at| is_here(rows[at])).collect();
            if some.len() < FEWEST {
                return None;
            }
            let count = some.len() as f64;
            let mut mean = 0.0;
            let mut along: BTreeMap<usize, f64> = BTreeMap::new();
            for &at in &some {
                for it in self.at(&own, rows[at]) {
                    mean += it.coefficient * it.basis / count;
                    if let Some((place, scale)) = it.place {
                        *along.entry(place).or_default() += it.basis / scale / count;
                    }
                }
            }
            let along: Vec<(usize, f64)> = along.into_iter().collect();
            let [(before, sigma), (after, _)] = [0, 1].map(|k| explained(&some, &residuals[k]));
            // What the target does not show of a joint is no error of it.
            if sigma.is_nan() || sigma > VAGUE {
                return None;
            }
            Some(JointErrorPart {
                range,
                rows: some.len(),
                before,
                after,
                terms: (mean, self.covariance(&along, &along).max(0.0).sqrt()),
            })
        };
        (0..PARTS).filter_map(part).collect()
    }

    /// Pairs of effects that the measurements do not tell apart.
    fn confused(&self, found: &[(JointEffect, Vec<(usize, f64)>)]) -> Vec<String> {
        let mut confused = Vec::new();
        for (k, (one, a)) in found.iter().enumerate() {
            for (other, b) in &found[k + 1..] {
                let correlation = self.covariance(a, b) / (one.sigma * other.sigma);
                // Of what the measurements say nothing there is nothing to tell apart.
                let is_told = one.told.max(other.told) > 0.2;
                if is_told && correlation.abs() > CONFUSED {
                    confused.push(format!(
                        "{} of {} and {} of {} are hardly told apart (correlation {correlation:.2})",
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_is_said_in_milliradians() {
        let sag = JointEffect {
            joint: "joint2".into(),
            group: TermGroup::Sag,
            amplitude: 4e-4,
            sigma: 5e-5,
            told: 0.9,
            effect_m: 2e-4,
        };
        assert_eq!(sag.words(), "joint2 sags by up to 0.40 mrad under weight");
    }
}
