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

/// What an orientation says of a target's orientation on the last link, a row.
struct Seen {
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
            chain.evaluate(&linkage, &packed, row, observation.target);
            let link_from_device = chain.target.rotation.transpose();
            seen.push(Seen { target: observation.target, link_from_device, turned });
        }
    }
    let mut judged: Vec<(f64, Reinterpretation)> =
        Reinterpretation::all().into_iter().map(|one| (misfit(&seen, &one), one)).collect();
    judged.sort_by(|a, b| a.0.total_cmp(&b.0));
    judged.truncate(CANDIDATES);
    judged.into_iter().map(|(_, one)| hypothesis(one)).collect()
}

/// Mean squared chordal distance of the orientations from ones that follow the arm.
fn misfit(seen: &[Seen], meaning: &Reinterpretation) -> f64 {
    let targets = seen.iter().map(|one| one.target + 1).max().unwrap_or(0);
    let mut total = 0.0;
    for target in 0..targets {
        let relative: Vec<Matrix3<f64>> = seen
            .iter()
            .filter(|one| one.target == target)
            .map(|one| one.link_from_device * meaning.rotation(&one.turned))
            .collect();
        let mean = mean_rotation(relative.iter().copied());
        total += relative.iter().map(|one| (one - mean).norm_squared()).sum::<f64>();
    }
    total / seen.len().max(1) as f64
}

fn hypothesis(meaning: Reinterpretation) -> Hypothesis {
    let Reinterpretation { read, meant, .. } = meaning;
    let action = if read == meant {
        format!("taking the orientation ({}) in radians instead of degrees", meant.words())
    } else {
        format!("taking the orientation as {} instead of {}", meant.words(), read.words())
    };
    Hypothesis::new(
        DiagnosisKind::EulerConvention,
        Change::Angles(meaning),
        action,
        "check the convention of the angles (an equivalent pair of conventions may be meant)".to_owned(),
    )
}
