//! Comparison of hypotheses: scores, acceptance, statement.

use rayon::prelude::*;

use super::boards::board_size;
use super::change::RowChange;
use super::conventions::conventions;
use super::diagnosis::format_short;
use super::few_targets::FewTargets;
use super::fitter::{Fitter, SHORT, Score, subsample};
use super::hypotheses::{
    MistakeHypothesis, ReadingColumns, axis_units, file_units, joint_couplings, joint_exchanges, joint_signs,
    joint_units, length_units, mirrors, pose_forms, row_shifts, tilt_units, zeros,
};
use super::scales::joint_scales;
use super::zero::joint_zeros;
use super::{Diagnosis, DiagnosisKind};
use poecal_model::measurement::{Dataset, Observation, Quantity};
use poecal_numerics::unit::Unit;

/// Number of joints above which only neighbours are tested for wrong signs together.
const MANY_JOINTS: usize = 12;
/// Hypotheses with a short calibration, and those of them with a long one.
const CALIBRATED: usize = 24;
const FINALISTS: usize = 6;
/// Least reduction of the registered error, or of the calibrated one.
const REGISTERED_GAIN: f64 = 2.0;
const CALIBRATED_GAIN: f64 = 3.0;
/// Least reduction of the calibrated error by one more unknown.
const FREED_GAIN: f64 = 1.25;
/// Least reduction of the registered error by the zero of a joint, which the calibrated error does not show.
const ZERO_GAIN: f64 = 1.7;
/// Largest growth of the other error.
const SLACK: f64 = 1.2;
/// Largest registered and calibrated error with the mistake undone, as shares of the reach.
const REGISTERED_SHARE: f64 = 0.12;
pub(crate) const CALIBRATED_SHARE: f64 = 5e-3;
/// Registered error, as a share of the reach, above which there may be more than a single mistake: the errors of real robots are below it.
pub(crate) const POOR: f64 = 1e-2;
/// Ratio of the products of both errors from which on several mistakes explain more than one.
const SEVERAL: f64 = 5.0;
/// Calibrated errors below this share of the reach are noise.
const NOISE_SHARE: f64 = 3e-5;
/// The same limit for one more unknown: no other hypothesis is compared with it.
const FREED_SHARE: f64 = 3e-6;
/// Factor on the score of a hypothesis with a fitted number: half a turn of one joint is often the sign of its neighbour.
const FITTED: f64 = 3.0;
/// Hypotheses whose scores differ by less than this factor are equivalent: the simplest is named.
const ALIKE: f64 = 1.15;

/// A hypothesis with its score.
struct Candidate {
    index: usize,
    kind: DiagnosisKind,
    /// Factor on positions, by which errors are divided before they are compared.
    resized: f64,
    data: Dataset,
    score: Score,
}

/// Mistake that explains the measurements, if there is one.
pub(crate) fn diagnose(few: &FewTargets<'_, '_>, all: &Dataset, base: &Score) -> Option<Diagnosis> {
    let fitter = &*few.fitter;
    let columns = ReadingColumns::new(fitter.robot);
    let sample = subsample(&few.data);
    let hypotheses = single_mistakes(fitter, &columns, &sample);
    let of = |hypotheses: &[MistakeHypothesis]| {
        let (index, score) = best_of(few, all, &sample, base, hypotheses)?;
        Some((hypotheses[index].clone(), score))
    };
    let single = of(&hypotheses);
    // One of two mistakes often explains part of the error.
    let is_poor = single.as_ref().is_none_or(|(_, score)| fitter.is_poor(score));
    let several = is_poor.then(|| of(&sign_pairs(&columns))).flatten();
    let (best, score) = several
        .filter(|(_, several)| single.as_ref().is_none_or(|(_, single)| several.is_far_better(single)))
        .or(single)
        .or_else(|| {
            let scales = joint_scales(fitter, &columns, &sample)?;
            let (_, score) = best_of(few, all, &sample, base, std::slice::from_ref(&scales))?;
            Some((scales, score))
        })?;
    Some(diagnosis(&best, base, &score))
}

fn single_mistakes(fitter: &Fitter<'_>, columns: &ReadingColumns, sample: &Dataset) -> Vec<MistakeHypothesis> {
    let turned = sample.observations.iter().any(|row| row.measurement.orientation().is_some());
    let mut all = joint_units(columns);
    let placed = sample.observations.iter().any(|row| row.measurement.position().is_some());
    for of in Quantity::ALL.into_iter().filter(|it| it.unit() == Unit::Metre) {
        let is_of = |row: &Observation| row.measurement.has_length_of(of);
        if sample.observations.iter().any(is_of) {
            // A height is small compared with the motion of the target.
            let is_all = of != Quantity::Height && sample.observations.iter().all(is_of);
            all.extend(length_units(of, is_all));
        }
    }
    if placed {
        all.extend(axis_units());
        all.extend(file_units(sample));
    }
    all.extend(of_zeros(sample));
    if sample.observations.iter().any(|row| row.measurement.function().with_angles_times.is_some()) {
        all.extend(tilt_units());
    }
    all.extend(joint_signs(columns));
    all.extend(joint_exchanges(columns));
    all.extend(joint_couplings(columns));
    if turned {
        all.extend(pose_forms());
        all.extend(conventions(fitter, sample));
    }
    if placed {
        all.extend(mirrors(fitter.device_free, turned));
    }
    all.extend(row_shifts(sample.targets.len()));
    all.extend(board_size(fitter, sample));
    all.extend(joint_zeros(fitter, columns, sample));
    all
}

/// Hypothesis that distances have an unknown zero offset, which a calibration may absorb.
fn of_zeros(sample: &Dataset) -> Option<MistakeHypothesis> {
    let is_counted = |row: &Observation| {
        row.measurement.has_length_of(Quantity::Distance) && !row.measurement.function().zero_is_unknown
    };
    let counted = |row: &Observation| row.from.is_none() && is_counted(row);
    sample.observations.iter().any(counted).then(zeros)
}

/// A mistake of lengths in data that a calibration explains.
pub(crate) fn of_lengths(few: &FewTargets<'_, '_>, all: &Dataset) -> Option<Diagnosis> {
    let sample = subsample(&few.data);
    let zero = of_zeros(&sample)?;
    let few = few.with_weak_prior();
    let base = few.fitter.judge(&sample).1;
    let (_, score) = best_of(&few, all, &sample, &base, std::slice::from_ref(&zero))?;
    Some(diagnosis(&zero, &base, &score))
}

/// Two or three joints with wrong signs.
fn sign_pairs(columns: &ReadingColumns) -> Vec<MistakeHypothesis> {
    let count = columns.names.len();
    // With many joints, only neighbours are combined: the number of triples grows with the cube.
    let reach = if count > MANY_JOINTS { 3 } else { count };
    let mut all = Vec::new();
    for a in 0..count {
        for b in a + 1..count.min(a + reach) {
            all.push(signs(columns, vec![a, b]));
            all.extend((b + 1..count.min(a + reach)).map(|c| signs(columns, vec![a, b, c])));
        }
    }
    all
}

fn signs(columns: &ReadingColumns, members: Vec<usize>) -> MistakeHypothesis {
    let names: Vec<&str> = members.iter().map(|&column| columns.names[column].as_str()).collect();
    let names = names.join(", ");
    MistakeHypothesis::new(
        DiagnosisKind::JointSign,
        RowChange::Scale(members, -1.0),
        format!("counting {names} the other way"),
        format!("check the signs of {names} in the readings and the directions of their axes in the model"),
    )
}

/// The best hypothesis and its score, if it is accepted.
fn best_of(
    few: &FewTargets<'_, '_>,
    all: &Dataset,
    sample: &Dataset,
    base: &Score,
    hypotheses: &[MistakeHypothesis],
) -> Option<(usize, Score)> {
    let fitter = &*few.fitter;
    let rough = |(index, hypothesis): (usize, &MistakeHypothesis)| {
        // Rows are shifted before targets and rows are sampled.
        let shifts = hypothesis.kind == DiagnosisKind::RowShift;
        let data = if shifts { subsample(&few.select_rows(hypothesis.apply(all))) } else { hypothesis.apply(sample) };
        let (estimate, registered) = fitter.roughly_registered(&data);
        (index, data, estimate, registered)
    };
    let mut found: Vec<_> = hypotheses.par_iter().enumerate().map(rough).collect();
    found.sort_by(|a, b| a.3.total_m.total_cmp(&b.3.total_m));
    found.truncate(CALIBRATED);
    let mut judged: Vec<Candidate> = found
        .into_par_iter()
        .map(|(index, data, estimate, registered)| {
            let calibrated = fitter.calibrate(&data, &estimate, SHORT).1;
            let MistakeHypothesis { kind, .. } = hypotheses[index];
            let resized = hypotheses[index].size_factor();
            Candidate { index, kind, resized, data, score: Score { registered, calibrated } }
        })
        .collect();
    judged.sort_by(|a, b| fitter.merit(a).total_cmp(&fitter.merit(b)));
    judged.truncate(FINALISTS);
    judged.par_iter_mut().for_each(|one| one.score = fitter.judge(&one.data).1);
    judged.retain(|one| fitter.explains(base, one));
    let least = judged.iter().map(|one| fitter.merit(one)).fold(f64::INFINITY, f64::min);
    judged.retain(|one| fitter.merit(one) < ALIKE * least);
    let simplest = judged.iter().min_by_key(|one| (one.kind, one.index))?;
    Some((simplest.index, simplest.score))
}

impl Score {
    /// True if both errors together are so much smaller that one more mistake is justified.
    fn is_far_better(&self, other: &Score) -> bool {
        let product = |it: &Score| it.registered.total_m * it.calibrated.total_m;
        SEVERAL * product(self) < product(other)
    }
}

impl Candidate {
    /// Registered and calibrated error, metres, at the size of the supplied data. The calibrated robot can have any size; the nominal
    /// one cannot, so its error counts less only for data that have shrunk.
    fn errors_m(&self) -> (f64, f64) {
        let registered = self.score.registered.resized_m((1.0 / self.resized).max(1.0));
        (registered, self.score.calibrated.resized_m(1.0 / self.resized))
    }
}

impl Fitter<'_> {
    /// Score of a hypothesis, smaller is better: a mistake shows with nominal screws, after a calibration, or both.
    fn merit(&self, one: &Candidate) -> f64 {
        let (registered, calibrated) = one.errors_m();
        let fitted = if one.kind == DiagnosisKind::JointZero { FITTED } else { 1.0 };
        fitted * registered * calibrated.max(NOISE_SHARE * self.reach_m())
    }

    /// True if the error that remains is more than a robot's own errors.
    fn is_poor(&self, score: &Score) -> bool {
        score.registered.total_m > POOR * self.reach_m()
    }

    /// True if a hypothesis reduces the errors enough, to a plausible size.
    fn explains(&self, base: &Score, one: &Candidate) -> bool {
        let (reach, after) = (self.reach_m(), one.errors_m());
        let is_freed = one.kind == DiagnosisKind::DistanceZero;
        let noise = if is_freed { FREED_SHARE } else { NOISE_SHARE } * reach;
        let registered = base.registered.total_m / after.0;
        let calibrated = base.calibrated.total_m.max(noise) / after.1.max(noise);
        let least = if one.kind == DiagnosisKind::JointZero { ZERO_GAIN } else { REGISTERED_GAIN };
        let enough = if is_freed { FREED_GAIN } else { CALIBRATED_GAIN };
        // A board's depth is noisier than the measurements of other devices.
        let share = if one.kind == DiagnosisKind::BoardSize { 4.0 } else { 1.0 } * CALIBRATED_SHARE;
        (registered > least || calibrated > enough)
            && registered.min(calibrated) * SLACK > 1.0
            && one.score.registered.total_m < REGISTERED_SHARE * reach
            && one.score.calibrated.total_m < share * reach
    }
}

/// The diagnosis with its evidence.
fn diagnosis(best: &MistakeHypothesis, base: &Score, score: &Score) -> Diagnosis {
    let registered = base.registered.total_m / score.registered.total_m.max(f64::MIN_POSITIVE);
    let (which, before, after) = if registered > ZERO_GAIN {
        ("registered", &base.registered, &score.registered)
    } else {
        ("calibrated", &base.calibrated, &score.calibrated)
    };
    let ratio = |before: f64, after: f64| before / after.max(f64::MIN_POSITIVE);
    let turned = before.rotation_rad > 0.0
        && ratio(before.rotation_rad, after.rotation_rad) > 2.0 * ratio(before.position_m, after.position_m);
    let evidence = if turned {
        let (before, after) = (before.rotation_rad.to_degrees(), after.rotation_rad.to_degrees());
        format!("{which} orientation error from {} to {} deg", format_short(before), format_short(after))
    } else {
        let (before, after) = (before.position_m * 1e3, after.position_m * 1e3);
        format!("{which} error from {} to {} mm", format_short(before), format_short(after))
    };
    Diagnosis {
        kind: best.kind,
        statement: format!("{} lowers the {evidence} (RMS): {}", best.action, best.advice),
        rows: Vec::new(),
        before_mm: before.total_m * 1e3,
        after_mm: after.total_m * 1e3,
    }
}
