//! Joint uncertainty of the corrections of several joints: common directions, and each joint when the others are held.

use nalgebra::{DMatrix, DVector, Vector3};

use poecal_fit::state::{Session, sample_rows};
use poecal_fit::uncertainty::{FitView, Uncertainty, held_covariance, position_information};
use poecal_model::offsets::{ChangeBySteps, JointChange, direction};
use poecal_model::robot::JointKind;
use poecal_numerics::solve::NormalEquations;

/// Rows by which the effect on predictions is computed.
const ROWS: usize = 300;
/// Least ratio of a standard deviation to that with the others held, for which its common direction is reported.
const LARGER: f64 = 3.0;
/// Share of a direction (of its square) from which a joint is named.
const NAMED: f64 = 0.05;
/// Smallest share of the whole variance of a reported direction, and most directions that are reported.
const SHARE: f64 = 0.1;
const MOST: usize = 3;

/// A direction in which the corrections of several joints are most uncertain: they may change together with little effect on predictions.
#[derive(Clone, Debug, PartialEq)]
pub struct CommonDirection {
    /// Description: the largest part of each joint, one standard deviation of the direction.
    pub words: String,
    /// The joints, by index.
    pub joints: Vec<usize>,
    /// Share of the direction in the variance of all corrections.
    pub share: f64,
    /// Root mean square change of predicted positions at the measured configurations, with one standard deviation of the direction, metres.
    pub effect_m: f64,
}

/// Standard deviations of the tilt (radians) and shift (metres) of each joint's axis with the axes of all other joints held: theory.md §9
/// (39b).
pub(crate) fn held_sigmas(
    view: &FitView<'_>,
    normal: &NormalEquations,
    uncertainty: &Uncertainty,
) -> Vec<Option<(f64, f64)>> {
    let layout = &uncertainty.layout;
    let n = layout.dim();
    let joint_of = |place: usize| -> Option<usize> {
        let mut parameters = layout.parameters();
        let found = parameters.find(|(_, places)| places.iter().any(|&(own, _)| own == place));
        found.and_then(|(parameter, _)| parameter.screw_axis()).map(|axis| axis.joint)
    };
    let joints: Vec<Option<usize>> = (0..n).map(joint_of).collect();
    let of_axis = |joint: usize| {
        let (axis, places) = layout.parameters().find_map(|(parameter, places)| {
            parameter.screw_axis().filter(|axis| axis.joint == joint).map(|axis| (axis, places))
        })?;
        let kept: Vec<usize> = (0..n).filter(|&k| joints[k].is_none_or(|own| own == joint)).collect();
        let scatter = uncertainty.discrepancy.scatter;
        let covariance = held_covariance(view, &normal.gram, n, scatter, &kept)?;
        let sigma = |places: &[(usize, f64)]| {
            let variance = |&(place, scale): &(usize, f64)| {
                let at = kept.iter().position(|&own| own == place)?;
                Some(covariance.get(at * kept.len() + at)? / (scale * scale))
            };
            places.iter().map(variance).sum::<Option<f64>>().map(f64::sqrt)
        };
        match axis.kind {
            JointKind::Revolute => Some((sigma(places.get(2..)?)?, sigma(places.get(..2)?)?)),
            JointKind::Prismatic => Some((sigma(places)?, 0.0)),
        }
    };
    (0..view.session.robot.joints.len()).map(of_axis).collect()
}

/// The common directions of a fit: eigenvectors of the covariance of all corrections with the largest eigenvalues, if these cause the large standard
/// deviations (theory.md §9 (39c)).
pub(crate) fn common_directions(
    view: &FitView<'_>,
    uncertainty: &Uncertainty,
    changes: &[(JointChange, ChangeBySteps)],
    held: &[Option<(f64, f64)>],
) -> Vec<CommonDirection> {
    let Session { robot, length_m, .. } = view.session;
    let n = uncertainty.layout.dim();
    let is_larger = |(change, held): (&JointChange, &Option<(f64, f64)>)| {
        let Some((tilt, shift)) = held else { return false };
        let larger = |all: Option<f64>, held: f64| all.is_some_and(|all| all > LARGER * held);
        // For a sliding joint the tilt alone counts.
        larger(change.sigma_tilt, *tilt) && (*shift == 0.0 || larger(change.sigma_shift, *shift))
    };
    // Joints that are determined no better with the others held would take most of the variance.
    let larger: Vec<bool> = changes.iter().map(|(change, _)| change).zip(held).map(is_larger).collect();
    if n == 0 || !larger.contains(&true) {
        return Vec::new();
    }
    let rows = by_unknowns(changes, &larger, n, length_m);
    let covariance = DMatrix::from_row_slice(n, n, &uncertainty.covariance);
    let spread = &covariance * rows.transpose();
    let of_changes = &rows * &spread;
    let size = of_changes.nrows();
    let upper: Vec<f64> = (0..size * size).map(|k| of_changes[(k / size, k % size)]).collect();
    let (values, vectors) = poecal_numerics::linalg::symmetric_eigen(&upper, size);
    let total: f64 = values.iter().sum();
    let sampled = sample_rows(view.rows, ROWS);
    let information = DMatrix::from_row_slice(n, n, &position_information(view, &sampled));
    let told = |k: usize| -> Option<CommonDirection> {
        let value = values[k];
        if value <= SHARE * total || value <= 0.0 {
            return None;
        }
        let direction = vectors.column(k).into_owned();
        let step: DVector<f64> = &spread * &direction / value.sqrt();
        let effect = (step.transpose() * &information * &step)[(0, 0)].max(0.0).sqrt();
        let parts = parts_of(&(direction * value.sqrt()), changes, length_m);
        let joints: Vec<usize> = parts.iter().map(|part| part.joint).collect();
        (joints.len() > 1).then(|| CommonDirection {
            words: words(&parts, |joint| robot.joints[joint].name.as_str(), effect),
            joints,
            share: value / total,
            effect_m: effect,
        })
    };
    (0..size).rev().take(MOST).filter_map(told).collect()
}

/// Derivatives of the corrections of some joints by the unknowns: seven rows of each joint, in metres, of offset, tilt and shift.
fn by_unknowns(
    changes: &[(JointChange, ChangeBySteps)],
    counts: &[bool],
    unknowns: usize,
    length_m: f64,
) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(7 * changes.len(), unknowns);
    for (joint, (change, by_steps)) in changes.iter().enumerate().filter(|(joint, _)| counts[*joint]) {
        let unit = if change.kind == JointKind::Revolute { length_m } else { 1.0 };
        let offset = change.offset.map_or(0.0, |_| unit);
        let tilts = by_steps.tilt.iter().map(|row| (row, length_m));
        let shifts = by_steps.shift.iter().map(|row| (row, 1.0));
        let all = std::iter::once((&by_steps.offset, offset)).chain(tilts).chain(shifts);
        for (part, (row, scale)) in all.enumerate() {
            for (k, value) in row.iter().enumerate() {
                rows[(7 * joint + part, k)] = scale * value;
            }
        }
    }
    rows
}

/// The largest part of a joint in a direction.
struct JointDirection {
    joint: usize,
    words: String,
}

/// The largest part of each joint that has a notable one; the first one grows toward a positive direction.
fn parts_of(direction: &DVector<f64>, changes: &[(JointChange, ChangeBySteps)], length_m: f64) -> Vec<JointDirection> {
    let whole = direction.norm_squared();
    let vector = |at: usize| Vector3::new(direction[at], direction[at + 1], direction[at + 2]);
    let mut sign = None;
    let mut parts = Vec::new();
    for (joint, (change, _)) in changes.iter().enumerate() {
        let own = direction.rows(7 * joint, 7);
        if own.norm_squared() < NAMED * whole {
            continue;
        }
        let (offset, tilt, shift) = (own[0], vector(7 * joint + 1), vector(7 * joint + 4));
        let leading = |it: &Vector3<f64>| it[it.iamax()];
        let largest = if shift.norm() >= tilt.norm().max(offset.abs()) {
            leading(&shift)
        } else if tilt.norm() >= offset.abs() {
            leading(&tilt)
        } else {
            offset
        };
        let sign = *sign.get_or_insert(largest.signum());
        let turns = change.kind == JointKind::Revolute;
        let words = if shift.norm() >= tilt.norm().max(offset.abs()) {
            format!("{} mm {}", digits(1e3 * shift.norm()), describe_direction("toward", &(shift * sign)))
        } else if tilt.norm() >= offset.abs() {
            let angle = (tilt.norm() / length_m).to_degrees();
            format!("a tilt of {} deg {}", digits(angle), describe_direction("about", &(tilt * sign)))
        } else {
            let (size, unit) =
                if turns { ((offset.abs() / length_m).to_degrees(), "deg") } else { (1e3 * offset.abs(), "mm") };
            let sign = if offset * sign < 0.0 { "−" } else { "+" };
            format!("an offset of {sign}{} {unit}", digits(size))
        };
        parts.push(JointDirection { joint, words });
    }
    parts
}

/// `toward +x`, or the unit vector if no direction of the base is near.
fn describe_direction(relation: &str, vector: &Vector3<f64>) -> String {
    match direction(vector) {
        Some(name) => format!("{relation} {name}"),
        None => {
            let unit = vector.normalize();
            let part = |it: f64| format!("{}{:.1}", if it < 0.0 { "−" } else { "+" }, it.abs());
            format!("{relation} ({}, {}, {})", part(unit.x), part(unit.y), part(unit.z))
        }
    }
}

/// Two significant digits.
fn digits(value: f64) -> String {
    let decimals = (1.0 - value.max(1e-6).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

fn words<'a>(parts: &[JointDirection], name: impl Fn(usize) -> &'a str, effect_m: f64) -> String {
    let each: Vec<String> = parts.iter().map(|part| format!("{} by {}", name(part.joint), part.words)).collect();
    let effect = digits(1e3 * effect_m);
    format!(
        "{}, all together or all the other way: predictions change by {effect} mm only (RMS, at the measured configurations)",
        each.join(", ")
    )
}
