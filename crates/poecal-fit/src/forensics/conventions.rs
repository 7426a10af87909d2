//! Convention of angles with which the orientations follow the arm.

use nalgebra::Matrix3;

use super::DiagnosisKind;
use super::change::{RowChange, empty_like, push};
use super::euler::{Reinterpretation, columns, words};
use super::fitter::Fitter;
use super::hypotheses::MistakeHypothesis;
use crate::start::mean_rotation;
use crate::state::{Linkage, RowChain};
use poecal_model::measurement::{Dataset, Measurement, Observation};

/// Conventions that are tested as hypotheses.
const CANDIDATES: usize = 3;
/// Largest difference of rotations that are equal but for rounding.
const SAME: f64 = 1e-9;
/// Rows of each target whose orientations are tried as the target's.
const GUESSES: usize = 6;

/// A row's orientation relative to the last link.
struct MeasuredOrientation {
    row: usize,
    target: usize,
    link_from_device: Matrix3<f64>,
    turned: Matrix3<f64>,
}

/// Best conventions of the angles, judged by rotations alone. Device frame and arm are those that fit the positions.
pub(crate) fn conventions(fitter: &Fitter<'_>, data: &Dataset) -> Vec<MistakeHypothesis> {
    let mut points = empty_like(data);
    for (row, seen) in data.observations.iter().enumerate() {
        let Some(position) = seen.measurement.position() else { continue };
        let measurement = Measurement::point(position);
        push(&mut points, data.readings(row), Observation { measurement, ..*seen });
    }
    let (estimate, _) = fitter.register_nominal(&points);
    let linkage = Linkage::new(&estimate);
    let packed = fitter.pack_values(data);
    let mut chain = RowChain::default();
    let mut seen = Vec::new();
    for (row, observation) in data.observations.iter().enumerate() {
        if let Some(turned) = observation.measurement.orientation() {
            chain.evaluate(&linkage, &packed, row, observation);
            let link_from_device = chain.target.rotation.transpose();
            seen.push(MeasuredOrientation { row, target: observation.target, link_from_device, turned });
        }
    }
    let all = Reinterpretation::all().into_iter().enumerate();
    let mut judged: Vec<ScoredConvention> =
        all.map(|(rank, meaning)| (score_convention(&seen, &meaning), (rank, meaning))).collect();
    judged.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let judged = distinct_conventions(judged);
    let turns = |rotations: Vec<Matrix3<f64>>| {
        let mut turns = vec![None; data.len()];
        seen.iter().zip(rotations).for_each(|(one, turned)| turns[one.row] = Some(turned));
        turns
    };
    judged.into_iter().map(|((_, rotations), (_, one))| hypothesis(one, turns(rotations))).collect()
}

/// Mean squared distance of the orientations from the arm's, the orientations, and the rank and convention that produce them.
type ScoredConvention = ((f64, Vec<Matrix3<f64>>), (usize, Reinterpretation));

/// Best conventions with different orientations. Of equivalent ones the first in the order of all is named, which is read from the
/// usual columns.
fn distinct_conventions(judged: Vec<ScoredConvention>) -> Vec<ScoredConvention> {
    let mut kept: Vec<ScoredConvention> = Vec::new();
    for one in judged {
        let rotations = &one.0.1;
        let same = |other: &ScoredConvention| rotations.iter().zip(&other.0.1).all(|(a, b)| (a - b).amax() < SAME);
        match kept.iter().position(same) {
            Some(at) if one.1.0 < kept[at].1.0 => kept[at] = one,
            None if kept.len() < CANDIDATES => kept.push(one),
            Some(_) | None => {}
        }
    }
    kept
}

/// The orientations in a convention, and their mean squared chordal distance from orientations that follow the arm. A rotation has two
/// sets of angles; the better one counts.
fn score_convention(seen: &[MeasuredOrientation], meaning: &Reinterpretation) -> (f64, Vec<Matrix3<f64>>) {
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
        // Candidates from a few rows; the best of these begins the mean.
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

fn hypothesis(meaning: Reinterpretation, turns: Vec<Option<Matrix3<f64>>>) -> MistakeHypothesis {
    let Reinterpretation { read, meant, factor } = meaning;
    let (action, advice) = if read == meant {
        let (is, read_as, unit) =
            if factor > 1.0 { ("radians", "degrees", "rad") } else { ("degrees", "radians", "deg") };
        let columns = columns(read).map_or_else(String::new, |columns| {
            format!(", as in {}", columns.map(|name| format!("`{name}[{unit}]`")).join(", "))
        });
        (
            format!("taking the orientation ({}) in {is} instead of {read_as}", words(meant)),
            format!("state the unit of the angles in the header{columns}, or in a mapping (`unit = \"{unit}\"`)"),
        )
    } else {
        let columns = columns(read).map_or_else(
            || "the same `columns`".to_owned(),
            |columns| format!("`columns = [{}]`", columns.map(|name| format!("\"{name}\"")).join(", ")),
        );
        (
            format!("taking the orientation as {} instead of {}", words(meant), words(read)),
            format!(
                "check the convention of the angles; a mapping (--columns) with `form = \"{}\"` and {columns} under `[orientation]` has \
                 them read so (an equivalent pair of conventions may be meant)",
                meant
            ),
        )
    };
    MistakeHypothesis::new(DiagnosisKind::EulerConvention, RowChange::Turn(turns), action, advice)
}
