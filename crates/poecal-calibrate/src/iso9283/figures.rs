//! The figures of a test, a row each.

use nalgebra::{Matrix3, Vector3};

use super::cluster::PoseCluster;
use super::faults;
use super::figure::{FigureBounds, FigureName, TestFigure};
use super::frame::{RegisteredBarycentres, register};
use super::intervals::{self, VariancePart, mean_and_covariance};
use super::rows::{PoseCell, PoseCells, TestRow};
use super::spread::{self, DEVIATIONS};
use poecal_arm::lie::{Pose, rotation};
use poecal_fit::start::mean_rotation;
use poecal_numerics::error::{ErrorKind, Result};

/// Commands (metres) within this are of one test.
const SAME_M: f64 = 1e-3;

/// A test: its figures, and the frame in which accuracy is stated.
#[derive(Clone, Debug, PartialEq)]
pub struct Iso9283 {
    /// Measured positions of each pose.
    pub clusters: Vec<PoseCluster>,
    /// Standard deviations of the instrument's noise, each component, if every row states it: metres, radians.
    pub noise: [Option<f64>; 2],
    /// Fewest cycles of a pose.
    pub cycles: usize,
    /// Rows of the figures AP to RD.
    pub rows: usize,
    /// Pose of the device in the robot's base.
    pub base_from_device: Pose,
    /// Coordinates of the barycentres, and how many of them the fit of the frame absorbed; 0 of a stated frame.
    pub coordinates: [usize; 2],
    /// The figures.
    pub figures: Vec<TestFigure>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
}

impl Iso9283 {
    /// Refuses an earlier test of other commands.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`], with the pose.
    pub fn refuse_other_commands(&self, earlier: &Iso9283) -> Result<()> {
        for own in &self.clusters {
            let Some(other) = earlier.clusters.iter().find(|it| it.pose == own.pose) else {
                return ErrorKind::Measurement.refuse(format!(
                    "found no pose {} in the rows of --reference, expected the poses of this test: measure the same list before and after",
                    own.pose
                ));
            };
            let apart_m = (own.commanded_m - other.commanded_m).norm();
            if apart_m > SAME_M {
                return ErrorKind::Measurement.refuse(format!(
                    "found pose {} commanded {:.3} mm from its command in the rows of --reference, expected one command: fill in the same list before and \
                     after, with the commands before their correction",
                    own.pose,
                    1e3 * apart_m
                ));
            }
        }
        Ok(())
    }

    /// Figures of a name, of lengths or of angles.
    pub fn of_name(&self, name: FigureName, is_of_angles: bool) -> impl Iterator<Item = &TestFigure> {
        self.figures.iter().filter(move |it| it.name == name && it.axis.is_some() == is_of_angles)
    }
}

/// Figures of ISO 9283:1998 of some rows, each with its 95 % interval (theory.md §9). Accuracy is stated in the frame `base_from_device`, or in one
/// that is fitted to the barycentres, which absorbs six of their coordinates, and the mean orientation error.
///
/// # Errors
/// [`ErrorKind::Measurement`] for rows of which no figure can be computed, with the row: doubled, exchanged, of another pose, too few, or of mixed
/// speeds; for poses that determine no frame.
pub fn iso9283(rows: &[TestRow], base_from_device: Option<Pose>) -> Result<Iso9283> {
    if rows.is_empty() {
        return ErrorKind::Measurement
            .refuse("found no rows with a measured position, expected a row for each pose and cycle");
    }
    let cells = PoseCells::from_rows(rows);
    let mut warnings = faults::check(&cells)?;
    let base = &cells.base;
    let commanded: Vec<Pose> = base.iter().map(PoseCell::commanded_pose).collect();
    let places = |poses: &[Pose]| poses.iter().map(|it| it.translation).collect::<Vec<_>>();
    let found = register(base, &places(&commanded), base_from_device)?;
    faults::refuse_gross(base, &found.errors, base_from_device.is_none())?;
    let calibrated: Option<Vec<Pose>> = base.iter().map(PoseCell::calibrated_pose).collect();
    let corrected = calibrated.as_ref().map(|it| register(base, &places(it), base_from_device)).transpose()?;
    let mut figures = positions(base, &found, corrected.as_ref());
    if cells.have_rotations() {
        let is_fitted = base_from_device.is_none();
        figures.extend(orientations(base, &found, &commanded, is_fitted));
        if let (Some(wanted), Some(corrected)) = (&calibrated, &corrected) {
            let after = orientations(base, corrected, wanted, is_fitted);
            let mut own = figures.iter_mut().filter(|it| it.axis.is_some());
            after.iter().for_each(|after| {
                if let Some(figure) = own.next().filter(|it| it.name == FigureName::Ap) {
                    figure.corrected = Some(after.measured);
                }
            });
        }
    } else if base.iter().flat_map(|it| &it.rows).any(|row| row.rotation.is_some()) {
        warnings.push("found orientations in some rows only, expected them in all: they are not judged".to_owned());
    }
    figures.extend(distances(base, &commanded, calibrated.as_deref()));
    figures.extend(variations(&cells));
    figures.extend(drifts(&cells, &found));
    let cluster = |(k, cell)| PoseCluster::new(cell, k, &found, corrected.as_ref());
    let clusters = base.iter().enumerate().map(cluster).collect();
    let noise = |quantity: usize| {
        let variances = base.iter().map(|it| it.noise_variance(quantity));
        Some((variances.sum::<Option<f64>>()? / base.len() as f64).sqrt())
    };
    Ok(Iso9283 {
        clusters,
        noise: [0, 1].map(noise),
        cycles: base.iter().map(PoseCell::count).min().unwrap_or(0),
        rows: base.iter().map(PoseCell::count).sum(),
        base_from_device: found.base_from_device,
        coordinates: [3 * base.len(), if base_from_device.is_some() { 0 } else { 6 }],
        figures,
        warnings,
    })
}

/// A figure of a cell.
fn figure(name: FigureName, cell: &PoseCell<'_>, measured: FigureBounds) -> TestFigure {
    let (pose, cycles) = (cell.pose.clone(), cell.count());
    TestFigure { name, axis: None, pose, cycles, measured, without_noise: None, corrected: None }
}

/// AP and RP of positions.
fn positions(
    base: &[PoseCell<'_>],
    found: &RegisteredBarycentres,
    corrected: Option<&RegisteredBarycentres>,
) -> Vec<TestFigure> {
    let mut figures = Vec::new();
    for (k, cell) in base.iter().enumerate() {
        let accuracy = |of: &RegisteredBarycentres| intervals::length(&of.errors[k], &of.parts[k]);
        let own = figure(FigureName::Ap, cell, accuracy(found));
        figures.push(TestFigure { corrected: corrected.map(accuracy), ..own });
    }
    figures.extend(base.iter().map(position_repeatability));
    figures
}

/// RP of a cell's positions.
fn position_repeatability(cell: &PoseCell<'_>) -> TestFigure {
    let places: Vec<Vector3<f64>> = cell.rows.iter().map(|row| row.position_m).collect();
    let (measured, without_noise) = spread::with_interval(&places, cell.noise_variance(0));
    TestFigure { without_noise, ..figure(FigureName::Rp, cell, measured) }
}

/// AP and RP of angles about the axes of the base: components of the rotation from command to measurement. Beside a fitted frame the mean of all
/// poses is that of the target on the flange.
fn orientations(
    base: &[PoseCell<'_>],
    found: &RegisteredBarycentres,
    wanted: &[Pose],
    is_fitted: bool,
) -> Vec<TestFigure> {
    let turn = found.base_from_device.rotation;
    let measured = |row: &TestRow| row.rotation.map_or(turn, |it| turn * it);
    let of_cell = |(cell, wanted): (&PoseCell<'_>, &Pose)| {
        let own = mean_rotation(cell.rows.iter().map(|row| measured(row)));
        own.transpose() * wanted.rotation
    };
    let fitted = || mean_rotation(base.iter().zip(wanted).map(of_cell));
    let target = if is_fitted { fitted() } else { Matrix3::identity() };
    let errors = |(cell, wanted): (&PoseCell<'_>, &Pose)| {
        let error = |row: &&TestRow| rotation::log(&(measured(row) * target * wanted.rotation.transpose()));
        let errors: Vec<Vector3<f64>> = cell.rows.iter().map(error).collect();
        mean_and_covariance(errors.into_iter())
    };
    let spreads: Vec<(Vector3<f64>, Matrix3<f64>)> = base.iter().zip(wanted).map(errors).collect();
    let share = if is_fitted { 1.0 / base.len() as f64 } else { 0.0 };
    let mut figures = Vec::new();
    for name in [FigureName::Ap, FigureName::Rp] {
        for (k, cell) in base.iter().enumerate() {
            for axis in 0..3 {
                let variance = |at: usize| spreads[at].1[(axis, axis)];
                let weight = |at: usize| if at == k { 1.0 - share } else { share };
                let part = |at: usize| {
                    let count = base[at].count() as f64;
                    (weight(at).powi(2) * variance(at) / count, count - 1.0)
                };
                let own = if name == FigureName::Ap {
                    let parts: Vec<(f64, f64)> = (0..base.len()).map(part).collect();
                    figure(name, cell, intervals::mean(spreads[k].0[axis], &parts))
                } else {
                    scatter(name, cell, variance(k), cell.noise_variance(1))
                };
                figures.push(TestFigure { axis: Some(axis), ..own });
            }
        }
    }
    figures
}

/// Three standard deviations of a number, with and without noise of a variance.
fn scatter(name: FigureName, cell: &PoseCell<'_>, variance: f64, noise: Option<f64>) -> TestFigure {
    let of = |deviation: f64| intervals::deviation(deviation, cell.count(), DEVIATIONS);
    let raw = of(variance.sqrt());
    let free = |value: f64, noise: f64| (value * value - DEVIATIONS.powi(2) * noise).max(0.0).sqrt();
    let without_noise = noise.map(|noise| FigureBounds {
        found: free(raw.found, noise),
        from: free(raw.from, noise),
        to: free(raw.to, noise),
    });
    TestFigure { without_noise, ..figure(name, cell, raw) }
}

/// AD and RD between P2 and P4, or the two poses whose commands are farthest apart.
fn distances(base: &[PoseCell<'_>], commanded: &[Pose], calibrated: Option<&[Pose]>) -> Vec<TestFigure> {
    let at = |name: &str| base.iter().position(|it| it.pose == name);
    let apart = |poses: &[Pose], (a, b): (usize, usize)| (poses[a].translation - poses[b].translation).norm();
    let all = (0..base.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    // The first pair of equal distances is taken, whatever the rounding.
    let mut farthest: Option<(usize, usize)> = None;
    for pair in all {
        if farthest.is_none_or(|it| apart(commanded, pair) > apart(commanded, it) + 1e-6) {
            farthest = Some(pair);
        }
    }
    let Some(pair) = at("P2").zip(at("P4")).or(farthest) else { return Vec::new() };
    let found = paired_distances(&base[pair.0], &base[pair.1]);
    if found.len() < 2 {
        return Vec::new();
    }
    let count = found.len() as f64;
    let mean = found.iter().sum::<f64>() / count;
    let variance = found.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let noise = base[pair.0].noise_variance(0).zip(base[pair.1].noise_variance(0)).map(|(a, b)| a + b);
    let rows = base[pair.0].rows.iter().take(found.len()).copied().collect();
    let both = PoseCell { pose: format!("{}-{}", base[pair.0].pose, base[pair.1].pose), rows, ..base[pair.0].clone() };
    let accuracy = |poses: &[Pose]| intervals::mean(mean - apart(poses, pair), &[(variance / count, count - 1.0)]);
    let own = figure(FigureName::Ad, &both, accuracy(commanded));
    vec![TestFigure { corrected: calibrated.map(accuracy), ..own }, scatter(FigureName::Rd, &both, variance, noise)]
}

/// Distances between two poses in each cycle that both have; by their order if cycles have no names.
fn paired_distances(first: &PoseCell<'_>, second: &PoseCell<'_>) -> Vec<f64> {
    let is_named = |it: &PoseCell<'_>| it.rows.iter().all(|row| !row.labels.cycle.is_empty());
    let by_name = is_named(first) && is_named(second);
    let partner = |(k, row): (usize, &&TestRow)| {
        let own = |it: &&&TestRow| it.labels.cycle == row.labels.cycle;
        let other = if by_name { second.rows.iter().find(own) } else { second.rows.get(k) };
        Some((row.position_m - other?.position_m).norm())
    };
    first.rows.iter().enumerate().filter_map(partner).collect()
}

/// vAP and E: the farthest two barycentres of approaches, and of arms.
fn variations(cells: &PoseCells<'_>) -> Vec<TestFigure> {
    let mut figures = Vec::new();
    for name in [FigureName::Vap, FigureName::E] {
        for base in &cells.base {
            let is_alike = |it: &&PoseCell<'_>| {
                let (own, other) = (base.labels, it.labels);
                let is_of_arm = name == FigureName::E;
                it.pose == base.pose
                    && own.series == other.series
                    && (own.arm == other.arm) != is_of_arm
                    && (own.approach == other.approach) == is_of_arm
            };
            let others: Vec<&PoseCell<'_>> =
                std::iter::once(base).chain(cells.others.iter().filter(is_alike)).collect();
            let pairs = (0..others.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
            let bounds = pairs.map(|(a, b)| {
                let [(first, own), (second, other)] = [others[a].barycentre(), others[b].barycentre()];
                let part = |cell: &PoseCell<'_>, spread: Matrix3<f64>| {
                    let count = cell.count() as f64;
                    VariancePart { covariance: spread / count, freedom: count - 1.0 }
                };
                intervals::length(&(first - second), &[part(others[a], own), part(others[b], other)])
            });
            figures.extend(largest_bounds(bounds).map(|it| figure(name, base, it)));
        }
    }
    figures
}

/// The largest of several figures, with the largest ends of their intervals.
fn largest_bounds(bounds: impl Iterator<Item = FigureBounds>) -> Option<FigureBounds> {
    bounds.reduce(|a, b| FigureBounds { found: a.found.max(b.found), from: a.from.max(b.from), to: a.to.max(b.to) })
}

/// dAP and dRP: the largest change from the first series.
fn drifts(cells: &PoseCells<'_>, found: &RegisteredBarycentres) -> Vec<TestFigure> {
    let mut figures = Vec::new();
    for name in [FigureName::Dap, FigureName::Drp] {
        for (at, base) in cells.base.iter().enumerate() {
            let own = base.labels;
            let is_later = |it: &&PoseCell<'_>| {
                let other = it.labels;
                it.pose == base.pose
                    && (own.arm == other.arm && own.approach == other.approach)
                    && own.series != other.series
            };
            let repeatability = |cell: &PoseCell<'_>| position_repeatability(cell).measured;
            let change = |cell: &PoseCell<'_>| {
                if name == FigureName::Dap {
                    change_of_accuracy(found, at, cell, &base.commanded_pose().translation)
                } else {
                    intervals::difference(&repeatability(cell), &repeatability(base))
                }
            };
            let later = cells.others.iter().filter(is_later).map(change);
            figures.extend(largest_bounds(later).map(|it| figure(name, base, it)));
        }
    }
    figures
}

/// Change of AP at a pose from the first series to a later one, in one frame: `|r'| - |r|`, where the frame moves both.
fn change_of_accuracy(
    found: &RegisteredBarycentres,
    at: usize,
    later: &PoseCell<'_>,
    wanted: &Vector3<f64>,
) -> FigureBounds {
    let (mean, spread) = later.barycentre();
    let (turn, count) = (found.base_from_device.rotation, later.count() as f64);
    let own = VariancePart { covariance: turn * spread * turn.transpose() / count, freedom: count - 1.0 };
    let (error, before) = (found.base_from_device.act(&mean) - wanted, found.errors[at]);
    let mut parts = vec![own];
    if let Some(by) = &found.by_frame {
        parts.extend(by[at].iter().zip(&found.own).map(|(by, base)| VariancePart {
            covariance: by * base.covariance * by.transpose(),
            freedom: base.freedom,
        }));
    }
    let lengths = [(&error, parts.as_slice()), (&before, found.parts[at].as_slice())];
    let bounds = lengths.map(|(error, parts)| intervals::length(error, parts));
    if bounds.iter().any(|it| it.from <= 0.0) {
        return intervals::difference(&bounds[0], &bounds[1]);
    }
    let [now, then] = [error.normalize(), before.normalize()];
    let variance = |direction: Vector3<f64>, of: &VariancePart| {
        ((direction.transpose() * of.covariance * direction)[0], of.freedom)
    };
    let by_base = found.own.iter().enumerate().map(|(k, base)| {
        let by = found.by_frame.as_ref().map_or_else(Matrix3::zeros, |by| by[at][k]);
        let own = if k == at { then } else { Vector3::zeros() };
        variance(by.transpose() * (now - then) - own, base)
    });
    let variances: Vec<(f64, f64)> = std::iter::once(variance(now, &own)).chain(by_base).collect();
    intervals::difference_of_lengths(lengths, &variances)
}
