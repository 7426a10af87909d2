//! Residual variances of position and rotation, between and within configurations, with their degrees of freedom.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::factor;
use super::view::FitView;
use crate::problem::Layout;
use crate::state::{Rounding, RowError, sample_rows};
use poecal_model::measurement::{ByQuantity, MANY_ROWS, Noise, Quantity};
use poecal_numerics::distributions::{f_quantile, is_within_band};
use poecal_numerics::linalg;
use poecal_numerics::solve::{LeastSquares, NormalEquations};
use poecal_numerics::unit::Unit;

/// Fewest degrees of freedom of repeated measurements for the test of lack of fit.
const REPEATED: f64 = 20.0;
/// False-alarm probability of the test of lack of fit.
const CHANCE: f64 = 0.01;
/// Number of rows up to which the effective number of unknowns of rotations is computed exactly.
const FEW: usize = 300;
/// Noise of positions that count as not measured.
const UNMEASURED_M: f64 = 1e9;
/// Largest share of the residual variance that counts as the rounding of the readings.
const ROUNDED: f64 = 0.5;
/// Weight of the assumption that the errors of configurations are alike, as a number of configurations.
const BELIEVED: f64 = 2.0;
/// Residuals below this (metres, radians) are rounding.
const ROUNDING: f64 = 1e-9;

/// Residual variance of one kind, position (m²) or rotation (rad²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KindVariance {
    /// Mean square of a component over its degrees of freedom; between configurations, if rows are repeated.
    pub mean_square: f64,
    /// Degrees of freedom.
    pub freedom: f64,
    /// Degrees of freedom by configurations: the errors of all numbers of one configuration vary together if they are the robot's.
    pub of_configurations: f64,
    /// Mean square of a component within configurations, and its degrees of freedom; both zero without repeated rows.
    pub within: (f64, f64),
    /// Mean number of rows of a configuration.
    pub repeats: f64,
    /// Mean stated variance of a component, and the mean square over it, if the noise of all rows is stated.
    pub stated: Option<(f64, f64)>,
    /// Variance of a component by the rounding of the readings.
    pub rounded: f64,
}

/// Source of the residuals: robot or instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Attribution {
    /// The robot: no evidence that they are measurement noise.
    Robot,
    /// The instrument: stated noise explains them, and no structure is found in them.
    StatedNoise,
    /// The instrument: measurements that were repeated in one configuration scatter as much as the others.
    Repeats,
}

/// Variance components of the residuals of one kind: metres or radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceComponents {
    /// Standard deviation of each component of the model error.
    pub robot: f64,
    /// Standard deviation of each component of the instrument's noise.
    pub instrument: f64,
    /// Source of the residuals.
    pub attribution: Attribution,
    /// Degrees of freedom of the variance; infinite if it is stated.
    pub freedom: f64,
}

impl KindVariance {
    /// Position of the mean square relative to the stated noise's 99 % band (wilson1931): below, inside, above.
    #[must_use]
    pub fn against_stated(&self) -> Option<std::cmp::Ordering> {
        let (_, ratio) = self.stated?;
        Some(is_within_band(ratio, self.freedom))
    }

    /// F test of lack of fit: true if the mean square between configurations exceeds that within them. `None` if too few rows are
    /// repeated.
    fn lacks_fit(&self) -> Option<bool> {
        let (within, freedom) = self.within;
        (freedom >= REPEATED).then(|| self.mean_square > within * f_quantile(CHANCE, self.freedom.max(1.0), freedom))
    }

    /// Variance components of residuals, of which a part with this standard deviation is the robot's, and the rest the instrument's.
    #[must_use]
    pub fn with_robot_part(&self, robot: f64) -> VarianceComponents {
        let ratio = self.stated.map_or(1.0, |(_, ratio)| ratio.max(1.0));
        let robot_square = (robot * robot * ratio).min(self.mean_square);
        VarianceComponents {
            robot: robot_square.sqrt(),
            instrument: (self.mean_square - robot_square).sqrt(),
            attribution: Attribution::Robot,
            freedom: self.freedom,
        }
    }

    /// Attributes the residuals to robot or instrument, by their structure (theory.md §9, between (40) and (41)).
    #[must_use]
    pub fn attribute(&self, structured: bool) -> VarianceComponents {
        // Rounding is no error of the robot; but for half of the variance, exact readings may only look rounded.
        let robot = |variance: f64, instrument: f64| {
            let rounded = self.rounded.min(ROUNDED * variance.max(0.0));
            VarianceComponents {
                robot: (variance - rounded).max(0.0).sqrt(),
                instrument: (instrument + rounded).sqrt(),
                attribution: Attribution::Robot,
                freedom: self.of_configurations,
            }
        };
        if self.mean_square.sqrt() < ROUNDING {
            return VarianceComponents {
                robot: 0.0,
                instrument: 0.0,
                attribution: Attribution::Robot,
                freedom: f64::INFINITY,
            };
        }
        if let (Some((variance, _)), Some(against)) = (self.stated, self.against_stated()) {
            return match against {
                // Residuals below the stated noise disprove it.
                std::cmp::Ordering::Less => robot(self.mean_square, 0.0),
                std::cmp::Ordering::Equal if !structured => VarianceComponents {
                    robot: 0.0,
                    instrument: variance.sqrt(),
                    attribution: Attribution::StatedNoise,
                    freedom: f64::INFINITY,
                },
                std::cmp::Ordering::Equal => robot(self.mean_square, 0.0),
                std::cmp::Ordering::Greater => robot(self.mean_square - variance, variance),
            };
        }
        let (within, _) = self.within;
        match self.lacks_fit() {
            Some(false) if !structured => VarianceComponents {
                robot: 0.0,
                instrument: self.mean_square.max(within).sqrt(),
                attribution: Attribution::Repeats,
                freedom: self.freedom,
            },
            Some(_) => robot((self.mean_square - within) / self.repeats, within),
            None => robot(self.mean_square, 0.0),
        }
    }
}

/// Variances of the residuals of a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResidualVariance {
    /// Variances of each quantity.
    pub parts: ByQuantity<KindVariance>,
    /// Variance of the whitened residuals, of configurations if rows are repeated; 1 if stated noise explains it.
    pub variance: f64,
    /// Effective number of unknowns that the measurements determine (theory.md §6 (34)).
    pub effective_unknowns: f64,
    /// Number of measured values; those that were measured again in one configuration count once.
    pub numbers: usize,
}

/// Error of a row, the same error with noise that is the same in all directions, and its noise.
struct RowDeviation {
    error: RowError,
    alike: RowError,
    noise: Noise,
}

/// Sums over residuals of one quantity.
#[derive(Clone, Copy, Default)]
struct ResidualSums {
    /// Sums of squares, of whitened squares, of both within configurations, and of the variances that whiten.
    squares: f64,
    whitened: f64,
    whitened_within: f64,
    within: f64,
    variances: f64,
    components: usize,
    groups: usize,
    configurations: usize,
}

impl ResidualSums {
    /// Adds the rows of one subject ([`Dataset::subject`](poecal_model::measurement::Dataset::subject)) in one configuration.
    fn add(&mut self, quantity: Quantity, rows: &[RowDeviation]) {
        let mut rows: Vec<&RowDeviation> = rows.iter().filter(|row| !row.error.part(quantity).is_empty()).collect();
        // Rows repeat each other if they have the same components.
        while let Some(first) = rows.first() {
            let kind = first.error.measured_components(quantity);
            let (own, rest) = rows.into_iter().partition(|row| row.error.measured_components(quantity) == kind);
            let own: Vec<&RowDeviation> = own;
            let vectors: Vec<([Vector3<f64>; 2], f64)> = own
                .iter()
                .map(|row| ([row.error.vector(quantity), row.alike.vector(quantity)], row.noise[quantity]))
                .collect();
            self.add_vectors(&vectors, kind.into_iter().filter(|it| *it).count());
            rows = rest;
        }
    }

    /// Adds errors in pairs (as measured, and with noise that is the same in all directions), each with its standard deviation.
    fn add_vectors(&mut self, rows: &[([Vector3<f64>; 2], f64)], components: usize) {
        if rows.is_empty() {
            return;
        }
        let mean = |of: usize| rows.iter().map(|(row, _)| row[of]).sum::<Vector3<f64>>() / rows.len() as f64;
        let means = [mean(0), mean(1)];
        for ([error, alike], sigma) in rows {
            self.squares += error.norm_squared();
            self.whitened += alike.norm_squared() / (sigma * sigma);
            self.within += (error - means[0]).norm_squared();
            self.whitened_within += (alike - means[1]).norm_squared() / (sigma * sigma);
            self.variances += components as f64 * sigma * sigma;
            self.components += components;
        }
        self.groups += components;
    }

    fn part(&self, determined: f64, stated: bool) -> KindVariance {
        let freedom = (self.groups as f64 - determined).max(1.0);
        let within_freedom = (self.components - self.groups) as f64;
        let repeats = self.components as f64 / self.groups.max(1) as f64;
        let whole = (self.components as f64 - determined).max(1.0);
        let is_repeated = within_freedom > 0.0;
        let mean_square =
            if is_repeated { (self.squares - self.within).max(0.0) / freedom } else { self.squares / freedom };
        let variance = self.variances / self.components.max(1) as f64;
        let share = self.configurations as f64 / self.groups.max(1) as f64;
        KindVariance {
            mean_square,
            freedom,
            of_configurations: (share * freedom + BELIEVED).min(freedom),
            within: (if is_repeated { self.within / within_freedom } else { 0.0 }, within_freedom),
            repeats,
            // The ratio is of all rows: noise alone explains those within configurations as well as the others.
            stated: (stated && self.components > 0).then(|| {
                (variance, if is_repeated { self.between_configurations(freedom) } else { self.whitened / whole })
            }),
            rounded: 0.0,
        }
    }

    /// Mean whitened square of configurations.
    fn between_configurations(&self, freedom: f64) -> f64 {
        (self.whitened - self.whitened_within).max(0.0) / freedom
    }
}

/// Variances of the residuals of a fit, from its normal information at the optimum: the s² of theory.md §9 (39), and mean squares of
/// position (m²) and rotation (rad²) less the unknowns of each (theory.md §6 (34)).
#[must_use]
pub fn remainder(view: &FitView<'_>, normal: &NormalEquations, layout: &Layout) -> ResidualVariance {
    // A sample of this size has the same variances.
    let sample = sample_rows(view.rows, MANY_ROWS);
    let share = sample.len() as f64 / view.rows.len().max(1) as f64;
    let sums = residual_sums(view, &sample);
    let numbers: usize = sums.iter().map(|(_, sums)| sums.groups).sum();
    let total = numbers as f64;
    let effective_unknowns = effective_unknowns(view, normal);
    let angles = total_of(&sums, Unit::Radian);
    let lengths = total_of(&sums, Unit::Metre);
    let left_m = (3.0 * lengths.squares / lengths.components.max(1) as f64).sqrt();
    let rounding = Rounding::from_session(&view.session, left_m);
    let by_rotations = share * determined_by_rotations(view, normal, layout, effective_unknowns, &angles, total);
    let in_sample = share * effective_unknowns;
    let variance = {
        let all = || sums.iter().map(|(_, sums)| sums);
        let between: f64 = all().map(|sums| sums.between_configurations(1.0)).sum();
        let whole: f64 = all().map(|sums| sums.whitened).sum();
        let is_repeated = lengths.components > lengths.groups;
        (if is_repeated { between } else { whole }) / (total - in_sample).max(1.0)
    };
    let parts = ByQuantity::from_fn(|quantity| {
        let own = &sums[quantity];
        let of_all = |all: &ResidualSums| own.groups as f64 / all.groups.max(1) as f64;
        let determined = match quantity.unit() {
            Unit::Metre => (in_sample - by_rotations) * of_all(&lengths),
            Unit::Radian | Unit::One | Unit::Second => by_rotations * of_all(&angles),
        };
        let part = own.part(determined, view.noise_is_stated[quantity]);
        let rounded = rounding.as_ref().map_or(0.0, |it| match quantity.unit() {
            Unit::Metre => it.place_m2 / 3.0,
            Unit::Radian => it.turn_rad2 / 3.0,
            Unit::One | Unit::Second => 0.0,
        });
        KindVariance { rounded, ..part }
    });
    let is_explained = |(quantity, part): (Quantity, &KindVariance)| {
        sums[quantity].components == 0 || part.against_stated() == Some(std::cmp::Ordering::Equal)
    };
    let variance = if parts.iter().all(is_explained) { 1.0 } else { variance };
    ResidualVariance { parts, variance, effective_unknowns, numbers }
}

/// Counts and squares of the residuals of some rows, in their order.
fn residual_sums(view: &FitView<'_>, sample: &[u32]) -> ByQuantity<ResidualSums> {
    let mut sums: ByQuantity<ResidualSums> = ByQuantity::default();
    let errors = view.session.errors(sample, view.estimate);
    let configurations = view.session.data.configurations(sample);
    let place = |row: u32| sample.binary_search(&row).ok().and_then(|at| errors.get(at));
    for rows in &configurations {
        let mut rows: Vec<u32> = rows.clone();
        let subject = |row: &u32| view.session.data.subject(*row);
        rows.sort_by_key(|row| (subject(row), *row));
        let before = sums.map(|sums| sums.groups);
        for same in rows.chunk_by(|a, b| subject(a) == subject(b)) {
            let of = |row: u32| {
                let (observation, error) = (view.session.observation(row), *place(row)?);
                let noise = view.session.noise_of(observation, view.noise);
                Some(RowDeviation { error, alike: view.session.equalize_noise(observation, error), noise })
            };
            let seen: Vec<_> = same.iter().filter_map(|&row| of(row)).collect();
            sums.values_mut().for_each(|(quantity, sums)| sums.add(quantity, &seen));
        }
        for (quantity, sums) in sums.values_mut() {
            sums.configurations += usize::from(sums.groups > before[quantity]);
        }
    }
    sums
}

/// Counts and squares of all quantities of a unit.
fn total_of(sums: &ByQuantity<ResidualSums>, unit: Unit) -> ResidualSums {
    let own = sums.iter().filter(|(quantity, _)| quantity.unit() == unit);
    own.fold(ResidualSums::default(), |total, (_, sums)| ResidualSums {
        squares: total.squares + sums.squares,
        components: total.components + sums.components,
        groups: total.groups + sums.groups,
        ..total
    })
}

/// Effective number of unknowns that the measurements determine beside the prior, `n - tr((N + wΛ)⁻¹ wΛ)`: theory.md §6 (34).
fn effective_unknowns(view: &FitView<'_>, normal: &NormalEquations) -> f64 {
    let n = normal.dim();
    if !view.prior.is_fitted {
        return n as f64;
    }
    let of_residuals = 2.0 * normal.cost / (normal.residuals as f64 - n as f64).max(1.0);
    let variance = view.prior.weight.unwrap_or(of_residuals);
    let Some(factor) = factor(&normal.gram, n, view.prior, variance) else { return n as f64 };
    n as f64 - variance * linalg::trace_of_quotient(&factor, &view.prior.normal.gram, n)
}

/// Effective number of unknowns that the rotation rows determine, `tr(N⁻¹ N_R)`: theory.md §6 (34). With many rows it is in proportion.
fn determined_by_rotations(
    view: &FitView<'_>,
    normal: &NormalEquations,
    layout: &Layout,
    determined: f64,
    rotation: &ResidualSums,
    total: f64,
) -> f64 {
    let turned = view.session.data.turns_of_targets(view.rows) as f64;
    if rotation.components == 0 {
        return 0.0;
    }
    let in_proportion =
        turned + (determined - turned).max(0.0) * (rotation.groups as f64 - turned) / (total - turned).max(1.0);
    // Terms of joints are determined by both alike.
    if view.rows.len() > FEW || view.prior.weight.is_some() {
        return in_proportion;
    }
    let n = layout.dim();
    let mut unmeasured = *view;
    unmeasured.noise = unmeasured.noise.without_lengths(UNMEASURED_M);
    let states = |quantity: Quantity, row: u32| view.session.observation(row).stated.get(quantity).is_some();
    let mut lengths = Quantity::ALL.into_iter().filter(|quantity| quantity.unit() == Unit::Metre);
    let stated = lengths.any(|quantity| view.rows.iter().any(|&row| states(quantity, row)));
    let part = unmeasured.problem(view.rows.to_vec()).normal(view.estimate);
    match factor(&normal.gram, n, view.prior, if view.prior.is_fitted { 1.0 } else { 0.0 }) {
        Some(factor) if !stated => linalg::trace_of_quotient(&factor, &part.gram, n).min(determined),
        _ => in_proportion,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twenty configurations and thirty unknowns leave thirty of sixty numbers. These have the degrees of freedom of ten configurations,
    /// and two are assumed.
    #[test]
    fn what_is_the_robots_varies_with_the_configuration() {
        let sums =
            ResidualSums { squares: 60.0, components: 60, groups: 60, configurations: 20, ..ResidualSums::default() };
        let part = sums.part(30.0, false);
        assert_eq!((part.freedom, part.attribute(false).freedom), (30.0, 12.0));
    }
}
