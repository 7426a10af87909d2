//! Rows that repeat configurations of an earlier visit.

use nalgebra::{DMatrix, DVector};

use super::visit::Visit;
use poecal_model::measurement::{Dataset, Observation, Quantity};
use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::linalg;

/// Largest difference of readings of one configuration: 0.1°, 0.1 mm.
const SAME_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;
const SAME_M: f64 = 1e-4;

/// Numbers of a position.
const PLACE: usize = 3;

/// Changes of measured numbers between visits, about the model.
#[derive(Clone, Debug)]
pub(crate) struct VisitChanges {
    /// Measured less predicted in this visit, less the same in the earlier one, in standard deviations.
    pub(crate) residual: DVector<f64>,
    /// Derivatives in those units, by the unknowns of the visit.
    pub(crate) jacobian: DMatrix<f64>,
    /// Standard deviation of each number, metres or radians.
    pub(crate) sigma: DVector<f64>,
    /// Squares of the scatter within repeats of each visit, in variances, and their degrees of freedom.
    pub(crate) scatter: (f64, f64),
    /// Rows of this visit that are among them.
    pub(crate) rows: Vec<u32>,
}

/// Rows of a visit by configuration, target and instrument, in the order of the data.
pub(crate) fn groups(data: &Dataset) -> Vec<Vec<u32>> {
    let class = |row: u32| {
        let seen = &data.observations[row as usize];
        (seen.target, seen.station)
    };
    let mut found = data.group_similar(&data.all_rows(), SAME_RAD, 1, class);
    found.sort_unstable();
    found
}

/// Largest difference of each reading within one configuration; infinite for a factor.
fn tolerances<'a>(data: &'a Dataset, robot: &'a Robot) -> impl Iterator<Item = f64> + 'a {
    data.reading_names().iter().map(|name| match robot.reading_kind(name) {
        ReadingKind::Angle => SAME_RAD,
        ReadingKind::Length => SAME_M,
        ReadingKind::Factor => f64::INFINITY,
    })
}

/// Number of leading numbers that rows of two visits share: all if they are of one kind of measurement, those of the position if one visit has
/// orientations too; otherwise 0.
fn shared_numbers((a, rows): (&Dataset, &[u32]), (b, others): (&Dataset, &[u32])) -> usize {
    let seen = |data: &Dataset, row: &u32| data.observations[*row as usize];
    let all = || rows.iter().map(|row| seen(a, row)).chain(others.iter().map(|row| seen(b, row)));
    let Some(first) = all().next() else { return 0 };
    if all().all(|it| it.measurement.function() == first.measurement.function()) {
        return first.measurement.dim();
    }
    // Numbers of a position are along the axes of the base, unless its noise has a shape.
    let is_place = |it: &Observation| {
        it.measurement.channels().range(Quantity::Position) == (0..PLACE) && it.noise_shape.is_none()
    };
    if all().all(|it| is_place(&it)) { PLACE } else { 0 }
}

/// True if rows of two visits are of one configuration, target and instrument.
fn is_same(a: &Dataset, row: u32, b: &Dataset, other: u32, robot: &Robot) -> bool {
    let (one, two) = (&a.observations[row as usize], &b.observations[other as usize]);
    let named = |data: &Dataset, at: usize| data.targets.get(at).cloned().flatten();
    let from = |data: &Dataset, at: usize| data.stations.get(at).cloned().flatten();
    named(a, one.target) == named(b, two.target)
        && from(a, one.station) == from(b, two.station)
        && one.from.is_none()
        && two.from.is_none()
        && a.readings(row as usize)
            .iter()
            .zip(b.readings(other as usize))
            .zip(tolerances(a, robot))
            .all(|((x, y), same)| (x - y).abs() <= same)
}

impl VisitChanges {
    /// The largest standard deviation of a number of a position.
    pub(crate) fn largest_sigma(&self) -> f64 {
        self.sigma.iter().copied().fold(0.0, f64::max)
    }

    /// Changes of a visit from an earlier one; `None` if no row repeats. If another point on the tool is measured, the calibration's uncertainty
    /// moves both points differently, and is part of the changes.
    pub(crate) fn from_visits(
        (visit, data): (&Visit, &Dataset),
        (earlier, before): (&Visit, &Dataset),
        robot: &Robot,
        tool_is_anew: bool,
    ) -> Option<Self> {
        let (own, old) = (groups(data), groups(before));
        let (mut squares, mut freedom) = (0.0, 0.0);
        let mut pairs = Vec::new();
        for group in &own {
            let found = old.iter().find(|it| is_same(before, it[0], data, group[0], robot));
            let Some(found) = found else { continue };
            let numbers = shared_numbers((data, group), (before, found));
            if numbers > 0 {
                pairs.push((group, found, numbers));
            }
        }
        if pairs.is_empty() {
            return None;
        }
        let mut residual = Vec::new();
        let mut sigma = Vec::new();
        let mut rows = Vec::new();
        let mut jacobian = Vec::new();
        let known = visit.by_known.as_ref().zip(earlier.by_known.as_ref()).filter(|_| tool_is_anew);
        let mut by_known = Vec::new();
        for (group, found, numbers) in pairs {
            let start = visit.starts[group[0] as usize];
            for number in 0..numbers {
                let (value, variance) = mean(visit, group, number);
                let (old, of_old) = mean(earlier, found, number);
                let deviation = (variance + of_old).sqrt();
                residual.push((value - old) / deviation);
                sigma.push(deviation);
                jacobian.push(visit.jacobian.row(start + number) / deviation);
                if let Some((own, old)) = known {
                    let before = earlier.starts[found[0] as usize];
                    by_known.push((own.row(start + number) - old.row(before + number)) / deviation);
                }
                for (of, rows) in [(visit, group), (earlier, found)] {
                    let (own, count) = scatter(of, rows, number);
                    squares += own;
                    freedom += count;
                }
            }
            rows.extend(group.iter().copied());
        }
        rows.sort_unstable();
        let (mut residual, mut jacobian) = (DVector::from_vec(residual), DMatrix::from_rows(&jacobian));
        if !by_known.is_empty() {
            (residual, jacobian) = weigh_known(&DMatrix::from_rows(&by_known), residual, jacobian)?;
        }
        Some(VisitChanges { residual, jacobian, sigma: DVector::from_vec(sigma), scatter: (squares, freedom), rows })
    }
}

/// Residuals and their derivatives, whitened by noise and by the calibration's uncertainty.
fn weigh_known(
    by_known: &DMatrix<f64>,
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let all = DMatrix::identity(residual.len(), residual.len()) + by_known * by_known.transpose();
    let count = jacobian.ncols();
    let mut both = jacobian.insert_column(count, 0.0);
    both.set_column(count, &residual);
    let both = linalg::whiten_columns(all, &both)?;
    Some((both.column(count).into_owned(), both.columns(0, count).into_owned()))
}

/// Mean of a number over rows of one configuration, and its variance.
fn mean(visit: &Visit, rows: &[u32], number: usize) -> (f64, f64) {
    let count = rows.len() as f64;
    let at = |row: &u32| visit.starts[*row as usize] + number;
    let value = rows.iter().map(|row| visit.residual[at(row)]).sum::<f64>() / count;
    let variance = rows.iter().map(|row| visit.sigma[at(row)].powi(2)).sum::<f64>() / (count * count);
    (value, variance)
}

/// Sum of squared deviations from that mean, in variances, and its degrees of freedom.
fn scatter(visit: &Visit, rows: &[u32], number: usize) -> (f64, f64) {
    let (value, _) = mean(visit, rows, number);
    let at = |row: &u32| visit.starts[*row as usize] + number;
    let squares = rows.iter().map(|row| ((visit.residual[at(row)] - value) / visit.sigma[at(row)]).powi(2)).sum();
    (squares, rows.len() as f64 - 1.0)
}
