//! Which supposition explains the measurements: scores, what is accepted, and the sentence.

use rayon::prelude::*;

use super::change::Change;
use super::conventions::conventions;
use super::few::Few;
use super::hypotheses::{
    Columns, Hypothesis, joint_couplings, joint_exchanges, joint_signs, joint_units, mirrors, pose_forms,
    position_units, row_shifts,
};
use super::session::{SHORT, Score, Session, sampled};
use super::zero::joint_zeros;
use super::{Diagnosis, DiagnosisKind};
use crate::measurement::Dataset;

/// Joints above which only neighbours are supposed to count the other way together.
const MANY_JOINTS: usize = 12;
/// Suppositions that are calibrated at all, and of those that are calibrated for long.
const CALIBRATED: usize = 24;
const FINALISTS: usize = 6;
/// By how much a supposition must lower the error with nominal screws, or that after a calibration.
const REGISTERED_GAIN: f64 = 2.0;
const CALIBRATED_GAIN: f64 = 3.0;
/// The same of a joint's zero, which only the nominal screws can show.
const ZERO_GAIN: f64 = 1.7;
/// How much worse than before the other of the two may get.
const SLACK: f64 = 1.2;
/// What nominal errors leave at most, and what a calibration leaves at most, as shares of the reach.
const REGISTERED_SHARE: f64 = 0.12;
pub(super) const CALIBRATED_SHARE: f64 = 5e-3;
/// Below this share of the reach a calibrated error is noise, whose differences say nothing.
const NOISE_SHARE: f64 = 3e-5;
/// By how much better a supposition with a fitted number must be: half a turn of one joint is often the sign of its neighbour.
const FITTED: f64 = 3.0;
/// Suppositions whose scores differ by less than this factor explain the data alike: the simplest is named.
const ALIKE: f64 = 1.15;

/// A supposition with what it makes of the data.
struct Judged {
    index: usize,
    kind: DiagnosisKind,
    /// By how much positions were resized: errors are resized with them, and are compared as they were before.
    resized: f64,
    data: Dataset,
    score: Score,
}

/// The one mistake that explains the measurements, if there is one.
pub(super) fn diagnose(few: &Few<'_, '_>, all: &Dataset, base: &Score) -> Option<Diagnosis> {
    let session = &*few.session;
    let columns = Columns::new(session.robot);
    let sample = sampled(&few.data);
    let hypotheses = single_mistakes(session, &columns, &sample);
    let (best, score) = best_of(few, all, &sample, base, &hypotheses)
        .map(|(index, score)| (hypotheses[index].clone(), score))
        .or_else(|| {
            let pairs = sign_pairs(&columns);
            best_of(few, all, &sample, base, &pairs).map(|(index, score)| (pairs[index].clone(), score))
        })?;
    Some(told(&best, base, &score))
}

fn single_mistakes(session: &Session<'_>, columns: &Columns, sample: &Dataset) -> Vec<Hypothesis> {
    let turned = sample.observations.iter().any(|row| row.measurement.sees_orientation());
    let mut all = joint_units(columns);
    all.extend(position_units());
    all.extend(joint_signs(columns));
    all.extend(joint_exchanges(columns));
    all.extend(joint_couplings(columns));
    if turned {
        all.extend(pose_forms());
        all.extend(conventions(session, sample));
    }
    all.extend(mirrors(session.device_free, turned));
    all.extend(row_shifts(sample.targets.len()));
    all.extend(joint_zeros(session, columns, sample));
    all
}

/// Two or three joints that count the other way.
fn sign_pairs(columns: &Columns) -> Vec<Hypothesis> {
    let count = columns.names.len();
    // Of many joints only neighbours: the number of threes grows with the cube.
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

fn signs(columns: &Columns, members: Vec<usize>) -> Hypothesis {
    let names: Vec<&str> = members.iter().map(|&column| columns.names[column].as_str()).collect();
    let names = names.join(", ");
    Hypothesis::new(
        DiagnosisKind::JointSign,
        Change::Scale(members, -1.0),
        format!("counting {names} the other way"),
        format!("check the signs of {names} in the readings and the directions of their axes in the model"),
    )
}

/// The supposition that explains the data, and how well.
fn best_of(
    few: &Few<'_, '_>,
    all: &Dataset,
    sample: &Dataset,
    base: &Score,
    hypotheses: &[Hypothesis],
) -> Option<(usize, Score)> {
    let session = &*few.session;
    let rough = |(index, hypothesis): (usize, &Hypothesis)| {
        // Rows are shifted before targets and a sample are taken of them.
        let shifts = hypothesis.kind == DiagnosisKind::RowShift;
        let data = if shifts { sampled(&few.among(hypothesis.apply(all))) } else { hypothesis.apply(sample) };
        let (estimate, registered) = session.roughly_registered(&data);
        (index, data, estimate, registered)
    };
    let mut found: Vec<_> = hypotheses.par_iter().enumerate().map(rough).collect();
    found.sort_by(|a, b| a.3.total_m.total_cmp(&b.3.total_m));
    found.truncate(CALIBRATED);
    let mut judged: Vec<Judged> = found
        .into_par_iter()
        .map(|(index, data, estimate, registered)| {
            let calibrated = session.calibrated(&data, &estimate, SHORT).1;
            let Hypothesis { kind, .. } = hypotheses[index];
            let resized = hypotheses[index].resized();
            Judged { index, kind, resized, data, score: Score { registered, calibrated } }
        })
        .collect();
    judged.sort_by(|a, b| session.merit(a).total_cmp(&session.merit(b)));
    judged.truncate(FINALISTS);
    judged.par_iter_mut().for_each(|one| one.score = session.judged(&one.data).1);
    judged.retain(|one| session.explains(base, one));
    let least = judged.iter().map(|one| session.merit(one)).fold(f64::INFINITY, f64::min);
    judged.retain(|one| session.merit(one) < ALIKE * least);
    let simplest = judged.iter().min_by_key(|one| (one.kind, one.index))?;
    Some((simplest.index, simplest.score))
}

impl Judged {
    /// Registered and calibrated error, metres of the data as they are. A robot can be calibrated to any size, but only data that
    /// have shrunk bring the errors of the nominal one down with them.
    fn errors_m(&self) -> (f64, f64) {
        let registered = self.score.registered.resized_m((1.0 / self.resized).max(1.0));
        (registered, self.score.calibrated.resized_m(1.0 / self.resized))
    }
}

impl Session<'_> {
    /// One number to compare suppositions by: a mistake shows with nominal screws, or after a calibration, or both.
    fn merit(&self, one: &Judged) -> f64 {
        let (registered, calibrated) = one.errors_m();
        let fitted = if one.kind == DiagnosisKind::JointZero { FITTED } else { 1.0 };
        fitted * registered * calibrated.max(NOISE_SHARE * self.reach_m())
    }

    /// Whether a supposition explains far more than the data as they are, and leaves no more than nominal errors do.
    fn explains(&self, base: &Score, one: &Judged) -> bool {
        let (reach, after) = (self.reach_m(), one.errors_m());
        let noise = NOISE_SHARE * reach;
        let registered = base.registered.total_m / after.0;
        let calibrated = base.calibrated.total_m.max(noise) / after.1.max(noise);
        let least = if one.kind == DiagnosisKind::JointZero { ZERO_GAIN } else { REGISTERED_GAIN };
        (registered > least || calibrated > CALIBRATED_GAIN)
            && registered.min(calibrated) * SLACK > 1.0
            && one.score.registered.total_m < REGISTERED_SHARE * reach
            && one.score.calibrated.total_m < CALIBRATED_SHARE * reach
    }
}

/// The sentence with its evidence.
fn told(best: &Hypothesis, base: &Score, score: &Score) -> Diagnosis {
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
        format!("{which} orientation error from {} to {} deg", short(before), short(after))
    } else {
        let (before, after) = (before.position_m * 1e3, after.position_m * 1e3);
        format!("{which} error from {} to {} mm", short(before), short(after))
    };
    Diagnosis {
        kind: best.kind,
        statement: format!("{} lowers the {evidence} (RMS): {}", best.action, best.advice),
        rows: Vec::new(),
        before_mm: before.total_m * 1e3,
        after_mm: after.total_m * 1e3,
    }
}

/// Three digits that matter.
pub(super) fn short(value: f64) -> String {
    if !value.is_finite() || value == 0.0 {
        return value.to_string();
    }
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.digits$}")
}
