//! Which meaning of angles makes the orientations follow the arm.

use nalgebra::Matrix3;

use super::DiagnosisKind;
use super::change::{Change, like, push};
use super::euler::Reinterpretation;
use super::hypotheses::Hypothesis;
use super::session::Session;
use crate::estimate::{Chain, Linkage};
use crate::measurement::{Dataset, Measurement, Observation, PointMeasurement};
use crate::start::mean_rotation;

/// Meanings that are judged in full.
const CANDIDATES: usize = 3;
/// Elements of rotations that differ by rounding only.
const SAME: f64 = 1e-9;
/// Rows of each target whose orientations are tried as the target's own.
const GUESSES: usize = 6;

/// What an orientation says of a target's orientation on the last link, a row.
struct Seen {
    row: usize,
    target: usize,
    link_from_device: Matrix3<f64>,
    turned: Matrix3<f64>,
}

/// The meanings of the angles that fit best, judged by rotations alone: the device's frame and the arm's pose are those that the
/// positions give.
pub(super) fn conventions(session: &Session<'_>, data: &Dataset) -> Vec<Hypothesis> {
    let mut points = like(data);
    for (row, seen) in data.observations.iter().enumerate() {
        let position = seen.measurement.pose().translation;
        let measurement = Measurement::Point(PointMeasurement { position });
        push(&mut points, data.readings(row), Observation { measurement, ..*seen });
    }
    let (estimate, _) = session.registered(&points);
    let linkage = Linkage::new(&estimate);
    let packed = session.packed(data);
    let mut chain = Chain::default();
    let mut seen = Vec::new();
    for (row, observation) in data.observations.iter().enumerate() {
        if let Some(turned) = observation.measurement.residual_model().orientation() {
            chain.evaluate(&linkage, &packed, row, observation);
            let link_from_device = chain.target.rotation.transpose();
            seen.push(Seen { row, target: observation.target, link_from_device, turned });
        }
    }
    let all = Reinterpretation::all().into_iter().enumerate();
    let mut judged: Vec<Judged> =
        all.map(|(rank, meaning)| (meant(&seen, &meaning), (rank, meaning))).collect();
    judged.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let judged = distinct(judged);
    let turns = |rotations: Vec<Matrix3<f64>>| {
        let mut turns = vec![None; data.len()];
        seen.iter().zip(rotations).for_each(|(one, turned)| turns[one.row] = Some(turned));
        turns
    };
    judged.into_iter().map(|((_, rotations), (_, one))| hypothesis(one, turns(rotations))).collect()
}

/// How far the orientations meant are from ones that follow the arm, these orientations, and what makes them: its rank and meaning.
type Judged = ((f64, Vec<Matrix3<f64>>), (usize, Reinterpretation));

/// The best meanings that give different orientations. Of those that give the same, the first in the order of all is named: the one
/// that is read from the usual columns.
fn distinct(judged: Vec<Judged>) -> Vec<Judged> {
    let mut kept: Vec<Judged> = Vec::new();
    for one in judged {
        let rotations = &one.0.1;
        let same = |other: &Judged| rotations.iter().zip(&other.0.1).all(|(a, b)| (a - b).amax() < SAME);
        match kept.iter().position(same) {
            Some(at) if one.1.0 < kept[at].1.0 => kept[at] = one,
            None if kept.len() < CANDIDATES => kept.push(one),
            Some(_) | None => {}
        }
    }
    kept
}

/// The orientations meant, and their mean squared chordal distance from ones that follow the arm. Of the two sets of angles that a
/// rotation has, that is taken which follows the arm better.
fn meant(seen: &[Seen], meaning: &Reinterpretation) -> (f64, Vec<Matrix3<f64>>) {
    let pairs: Vec<[Matrix3<f64>; 2]> = seen.iter().map(|one| meaning.rotations(&one.turned)).collect();
    let relative = |k: usize, branch: usize| seen[k].link_from_device * pairs[k][branch];
    let mut branches = vec![0; seen.len()];
    let mut total = 0.0;
    let targets = seen.iter().map(|one| one.target + 1).max().unwrap_or(0);
    for target in 0..targets {
        let members: Vec<usize> = (0..seen.len()).filter(|&k| seen[k].target == target).collect();
        let nearest = |k: usize, mean: &Matrix3<f64>| {
            let [first, second] = [0, 1].map(|branch| (relative(k, branch) - mean).norm_squared());
            if second < first { (second, 1) } else { (first, 0) }
        };
        let away = |mean: &Matrix3<f64>| members.iter().map(|&k| nearest(k, mean).0).sum::<f64>();
        // A few rows say where the target may be turned to, the best of these where it is.
        let guesses = members.iter().take(GUESSES).flat_map(|&k| [relative(k, 0), relative(k, 1)]);
        let Some(guess) = guesses.min_by(|a, b| away(a).total_cmp(&away(b))) else { continue };
        let mean = mean_rotation(members.iter().map(|&k| relative(k, nearest(k, &guess).1)));
        for &k in &members {
            let (distance, branch) = nearest(k, &mean);
            total += distance;
            branches[k] = branch;
        }
    }
    let rotations = pairs.iter().zip(branches).map(|(pair, branch)| pair[branch]).collect();
    (total / seen.len().max(1) as f64, rotations)
}

fn hypothesis(meaning: Reinterpretation, turns: Vec<Option<Matrix3<f64>>>) -> Hypothesis {
    let Reinterpretation { read, meant, factor } = meaning;
    let (action, advice) = if read == meant {
        let (is, read_as, unit) =
            if factor > 1.0 { ("radians", "degrees", "rad") } else { ("degrees", "radians", "deg") };
        let columns = read.columns().map_or_else(String::new, |columns| {
            format!(", as in {}", columns.map(|name| format!("`{name}[{unit}]`")).join(", "))
        });
        (
            format!("taking the orientation ({}) in {is} instead of {read_as}", meant.words()),
            format!(
                "state the unit of the angles in the header{columns}, or in a mapping (`unit = \"{unit}\"`)"
            ),
        )
    } else {
        let columns = read.columns().map_or_else(
            || "the same `columns`".to_owned(),
            |columns| format!("`columns = [{}]`", columns.map(|name| format!("\"{name}\"")).join(", ")),
        );
        (
            format!("taking the orientation as {} instead of {}", meant.words(), read.words()),
            format!(
                "check the convention of the angles; a mapping (--columns) with `form = \"{}\"` and {columns} under `[orientation]` has \
                 them read so (an equivalent pair of conventions may be meant)",
                meant.form()
            ),
        )
    };
    Hypothesis::new(DiagnosisKind::EulerConvention, Change::Turn(turns), action, advice)
}
