//! Closed forms of devices that measure no positions: anchors, sockets, planes, the direction of gravity.

use nalgebra::{Matrix3, Vector3};

use super::averaging::{cube_rotations, rotation_maximising};
use crate::state::Estimate;
use poecal_arm::lie::{Pose, rotation};
use poecal_model::measurement::{InitialGuess, Measurement};
use poecal_numerics::linalg;

/// Share of the information of distances about an anchor below which it is rounding.
const ROUNDING: f64 = 1e-12;
/// Largest number of steps of the search for the multiplier of a plane's normal: each halves the interval.
const HALVINGS: usize = 200;
/// Alternations of a direction with the turn of the target that measures it.
const ROUNDS: usize = 20;

/// A row: the arm's motion from zero in the base frame, the measurement, and the target.
pub(crate) struct StartRow {
    pub(crate) motion: Pose,
    pub(crate) measurement: Measurement,
    pub(crate) target: usize,
}

/// Estimates with the device at the poses that the rows of one station determine, with the targets of the start. Free targets are also
/// turned if the rows determine a direction alone.
pub(crate) fn starts(rows: &[StartRow], start: &Estimate, targets_free: bool) -> Vec<Estimate> {
    let at = |device: Pose| {
        let mut estimate = start.clone();
        estimate.device_from_base = device;
        estimate
    };
    let seen = StartRows { rows, start };
    let ranged = seen.by_ranges().map(|(device, zero_m)| {
        let mut estimate = at(device);
        if zero_m != 0.0 {
            estimate.range_mut(0).zero_m = zero_m;
        }
        estimate
    });
    let devices = [seen.by_sockets(), seen.by_heights(), seen.by_components()];
    let mut found: Vec<Estimate> = ranged.into_iter().chain(devices.into_iter().flatten().map(at)).collect();
    if found.is_empty() {
        found.extend(seen.by_directions(targets_free));
    }
    if found.is_empty() {
        found.push(start.clone());
    }
    found
}

/// Rows as measured with the targets of a start.
struct StartRows<'a> {
    rows: &'a [StartRow],
    start: &'a Estimate,
}

impl StartRows<'_> {
    fn place(&self, row: &StartRow) -> Vector3<f64> {
        row.motion.act(&self.start.base_from_target[row.target].translation)
    }

    /// The device's frame with its axes as at the start and its origin at a point of the base.
    fn frame_at(&self, point: &Vector3<f64>) -> Pose {
        let turn = self.start.device_from_base.rotation;
        Pose::new(turn, -(turn * point))
    }

    /// Device at the point a that has the measured distances d from the targets p, and the zero o of its readings. With `|a|² - o²` as an
    /// unknown of its own, `|p|² - d² = 2 p·a - 2 d o - (|a|² - o²)` is linear. Readings that are all equal, as of a sphere, determine their
    /// zero by that unknown. The axes are those of the start.
    fn by_ranges(&self) -> Option<(Pose, f64)> {
        let ranges: Vec<(Vector3<f64>, f64)> =
            self.rows.iter().filter_map(|row| Some((self.place(row), row.measurement.range()?))).collect();
        if ranges.is_empty() {
            return None;
        }
        let count = ranges.len() as f64;
        let middle = ranges.iter().map(|(place, _)| place).sum::<Vector3<f64>>() / count;
        let mean = ranges.iter().map(|(_, range)| range).sum::<f64>() / count;
        let has_zero = self.rows.iter().any(|row| row.measurement.function().zero_is_unknown);
        let varies = ranges.iter().any(|(_, range)| (range - mean).abs() > ROUNDING.sqrt() * mean.abs().max(1.0));
        let unknowns = if has_zero && varies { 5 } else { 4 };
        let (mut gram, mut right) = (vec![0.0; unknowns * unknowns], vec![0.0; unknowns]);
        for (place, range) in &ranges {
            let arm = place - middle;
            let row = [2.0 * arm.x, 2.0 * arm.y, 2.0 * arm.z, -1.0, -2.0 * (range - mean)];
            // Distances count from the mean reading, so that its square does not drown the others.
            let known = if varies { arm.norm_squared() - (range - mean).powi(2) } else { arm.norm_squared() };
            let known = if has_zero { known } else { arm.norm_squared() - range * range };
            for (i, a) in row.iter().enumerate().take(unknowns) {
                right[i] += a * known;
                (0..unknowns).for_each(|j| gram[i * unknowns + j] += a * row[j]);
            }
        }
        let trace: f64 = (0..unknowns).map(|k| gram[k * unknowns + k]).sum();
        let factor = linalg::cholesky(&gram, unknowns, ROUNDING * trace)?;
        let found = linalg::cholesky_solve(&factor, &right);
        let arm = Vector3::new(*found.first()?, *found.get(1)?, *found.get(2)?);
        let zero = match (has_zero, found.get(4)) {
            (false, _) => 0.0,
            // `d - mean = |p - a| + (o - mean)`.
            (true, Some(from_mean)) => from_mean + mean,
            (true, None) => mean - (arm.norm_squared() - found.get(3)?).max(0.0).sqrt(),
        };
        Some((self.frame_at(&(middle + arm)), zero))
    }

    /// Middle of the balls.
    fn by_sockets(&self) -> Option<Pose> {
        let places = self.rows.iter().filter(|row| row.measurement.clue() == InitialGuess::Middle);
        let (sum, count) = places.fold((Vector3::zeros(), 0), |(sum, count), row| (sum + self.place(row), count + 1));
        (count > 0).then(|| self.frame_at(&(sum / f64::from(count))))
    }

    /// Plane from which the points have the measured heights.
    fn by_heights(&self) -> Option<Pose> {
        let height = |row: &StartRow| {
            let InitialGuess::Height { point, height, .. } = row.measurement.clue() else { return None };
            Some((row.motion.act(&self.start.base_from_target[row.target].act(&point)), height))
        };
        let heights: Vec<(Vector3<f64>, f64)> = self.rows.iter().filter_map(height).collect();
        let count = heights.len() as f64;
        let (place, height) =
            heights.iter().fold((Vector3::zeros(), 0.0), |(place, height), it| (place + it.0, height + it.1));
        let (middle, mean) = (place / count.max(1.0), height / count.max(1.0));
        let normal = self.flush_normal().or_else(|| {
            let arms = heights.iter().map(|(place, height)| (place - middle, height - mean));
            let up = self.start.device_from_base.rotation.row(2).transpose();
            (!heights.is_empty()).then(|| normal_of(arms, &up))
        })?;
        let turn = rotation::shortest_arc(&normal, &Vector3::z());
        Some(Pose::new(turn, Vector3::z() * mean - turn * middle))
    }

    /// Frame in which the points have the measured components: each along a direction of its own, as heights along a normal; then the
    /// nearest right-handed axes.
    fn by_components(&self) -> Option<Pose> {
        let mut axes = Matrix3::zeros();
        let mut middles = [None; 3];
        for (k, found) in middles.iter_mut().enumerate() {
            let of = |row: &StartRow| row.measurement.position_components()[k];
            let seen: Vec<(Vector3<f64>, f64)> =
                self.rows.iter().filter_map(|row| Some((self.place(row), of(row)?))).collect();
            if seen.is_empty() {
                continue;
            }
            let count = seen.len() as f64;
            let middle = seen.iter().map(|(place, _)| place).sum::<Vector3<f64>>() / count;
            let mean = seen.iter().map(|(_, value)| value).sum::<f64>() / count;
            let arms = seen.iter().map(|(place, value)| (place - middle, value - mean));
            let own = self.start.device_from_base.rotation.row(k).transpose();
            axes.set_row(k, &normal_of(arms, &own).transpose());
            *found = Some((middle, mean));
        }
        middles.iter().any(Option::is_some).then(|| {
            // An axis that is not measured is zero; the nearest rotation has the cross product of the others for it.
            let turn = rotation_maximising(&axes.transpose());
            let along = [0, 1, 2].map(|k| middles[k].map_or(0.0, |(middle, mean)| mean - (turn.row(k) * middle).x));
            Pose::new(turn, along.into())
        })
    }

    /// Mean of a plane's normals by faces that lay on it.
    fn flush_normal(&self) -> Option<Vector3<f64>> {
        let normals = self.rows.iter().filter_map(|row| {
            let InitialGuess::Height { up: Some(normal), .. } = row.measurement.clue() else { return None };
            Some(row.motion.rotation * self.start.base_from_target[row.target].rotation * normal)
        });
        normals.reduce(|a, b| a + b)?.try_normalize(f64::MIN_POSITIVE)
    }

    /// The device's z in the base from targets that measure it, `u = Rᵀ e_z`: the mean of `R u` for the targets of the start. Free targets
    /// are also turned, from several starts and in alternation.
    fn by_directions(&self, targets_free: bool) -> Vec<Estimate> {
        let up = |row: &'_ StartRow| {
            if let InitialGuess::Up(up) = row.measurement.clue() { Some(up) } else { None }
        };
        let seen: Vec<(&StartRow, Vector3<f64>)> = self.rows.iter().filter_map(|row| Some((row, up(row)?))).collect();
        if seen.is_empty() {
            return Vec::new();
        }
        let turns: Vec<Matrix3<f64>> =
            if targets_free { cube_rotations().collect() } else { vec![Matrix3::identity()] };
        let mut found = Vec::with_capacity(turns.len());
        for turn in turns {
            let mut estimate = self.start.clone();
            estimate.base_from_target.iter_mut().for_each(|pose| pose.rotation *= turn);
            for round in 0..ROUNDS {
                let sum: Vector3<f64> = seen
                    .iter()
                    .map(|(row, u)| row.motion.rotation * estimate.base_from_target[row.target].rotation * u)
                    .sum();
                let Some(up) = sum.try_normalize(f64::MIN_POSITIVE) else { break };
                let device = rotation::shortest_arc(&up, &Vector3::z());
                estimate.device_from_base = Pose::new(device, estimate.device_from_base.translation);
                if !targets_free || round + 1 == ROUNDS {
                    break;
                }
                for (target, pose) in estimate.base_from_target.iter_mut().enumerate() {
                    let own = seen.iter().filter(|(row, _)| row.target == target);
                    let sum: Matrix3<f64> =
                        own.map(|(row, u)| u * (row.motion.rotation.transpose() * up).transpose()).sum();
                    if sum != Matrix3::zeros() {
                        pose.rotation = rotation_maximising(&sum);
                    }
                }
            }
            found.push(estimate);
        }
        found
    }
}

/// The unit vector n that minimises `Σ (n·a - h)²` over arms a and heights h: `(A + λ 1) n = b` for the λ that makes its length one, found by
/// bisection. Without heights it is the direction of least spread, on the side of the direction `up`.
fn normal_of(arms: impl Iterator<Item = (Vector3<f64>, f64)>, up: &Vector3<f64>) -> Vector3<f64> {
    let (mut gram, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (arm, height) in arms {
        gram += arm * arm.transpose();
        right += arm * height;
    }
    let (values, vectors) = linalg::symmetric_eigen(gram.as_slice(), 3);
    let axes = [0, 1, 2].map(|k| Vector3::new(vectors[(0, k)], vectors[(1, k)], vectors[(2, k)]));
    let least = values.first().copied().unwrap_or(0.0);
    let sign = if axes[0].dot(up) < 0.0 { -1.0 } else { 1.0 };
    let at = |above: f64| -> Vector3<f64> {
        let along = axes.iter().zip(&values).skip(1);
        let others: Vector3<f64> =
            along.map(|(axis, value)| axis * (axis.dot(&right) / (value - least + above).max(f64::MIN_POSITIVE))).sum();
        others + axes[0] * (axes[0].dot(&right) / above.max(f64::MIN_POSITIVE))
    };
    let scale = gram.trace().max(f64::MIN_POSITIVE);
    if right.norm() <= 1e-9 * scale {
        return axes[0] * sign;
    }
    let (mut low, mut high) = (0.0, right.norm() + scale);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if at(middle).norm() > 1.0 { low = middle } else { high = middle }
    }
    let found = at(high);
    // With heights that do not depend on it, the axis of least spread completes the length.
    let rest = (1.0 - found.norm_squared()).max(0.0).sqrt();
    (found + axes[0] * (sign * rest)).normalize()
}
