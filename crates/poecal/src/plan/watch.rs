//! Rows judged as they arrive, before they are fitted; the error to expect now, and what to measure next (docs/theory.md, *While measuring*).

use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::expected::ExpectedErrors;
use super::experiment::{Blocks, Experiment, inverse};
use super::options::PlannedFit;
use super::order::Travel;
use super::search::Search;
use super::state::{Aim, Caches, Squares, State, Weights};
use crate::distributions::f_quantile;
use crate::error::{ErrorKind, Result};
use crate::estimate::{Packed, Session, delivered};
use crate::linalg;
use crate::measurement::{Dataset, Quantity};
use crate::problem::Prior;
use crate::robot::{Robot, Tolerance};
use crate::simulate::{Configurations, Kind};
use crate::start::{Registration, register};

/// Probability with which a row that is as expected is named all the same, of normal errors; of those of real robots it is higher.
const BY_CHANCE: f64 = 2e-4;
/// A mistake explains a row if what is left would be exceeded with this probability.
const EXPLAINED: f64 = 0.05;
/// Degrees of freedom that what was believed of the noise counts.
const BELIEVED: f64 = 8.0;
/// Rows that are tested together against a target that was moved.
const TOGETHER: usize = 3;
/// Numbers from which rows can be judged, beside those of the unknown targets.
const FEWEST_NUMBERS: usize = 6;
/// Configurations to choose the next from, and of the workspace.
const CANDIDATES: usize = 200;
const WORKSPACE: usize = 300;
/// Candidates among which the rows ahead are exchanged: those that gain most by themselves.
const GAINING: usize = 50;
/// Rows that are looked ahead.
pub(super) const AHEAD: usize = 10;
/// A candidate that is as near to a measured configuration, in all joints, is measured, radians.
const MEASURED_RAD: f64 = 2e-3;
/// Change of a reading for a difference, radians or metres.
const DIFFERENCE: f64 = 1e-5;

/// What is watched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WatchOptions {
    /// The fit that will be made, and what is believed of the noise; the number of configurations does not matter.
    pub fit: PlannedFit,
    /// Configurations to choose the next from, readings one after the other; random ones within the limits if there are none.
    pub candidates: Option<Vec<f64>>,
    /// Configurations in which the robot will work; random ones within the limits if there are none.
    pub workspace: Option<Vec<f64>>,
    /// Seed of what is random.
    pub seed: u64,
}

impl WatchOptions {
    /// The same for the kind of these rows: poses if one has an orientation, else points.
    #[must_use]
    pub fn for_rows(mut self, data: &Dataset) -> Self {
        let poses = data.observations.iter().any(|row| row.measurement.sees_orientation());
        self.fit.session.kind = if poses { Kind::POSE } else { Kind::POINT };
        self
    }
}

/// What a row that is not as expected looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum Mistake {
    /// The measurement of the configuration before.
    Stale,
    /// A joint's reading with the wrong sign.
    Sign(String),
    /// A joint's reading that is off by so much, radians or metres.
    Joint(String, f64),
    /// A measurement that is off by so many metres, of unknown cause.
    Off(f64),
    /// The row repeats the one before, number by number.
    Repeats,
    /// A target that was moved by so many metres before so many rows ago.
    Moved(f64, usize),
}

/// A row that was judged.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedRow {
    /// Index of the row.
    pub row: usize,
    /// What it looks like, if it is not as expected; it is not fitted then.
    pub mistake: Option<Mistake>,
    /// How far it is from what was expected, as a share of what is named; `None` while too few rows are known.
    pub ratio: Option<f64>,
    /// Least error of a measurement that would have been named in this row for certain, metres.
    pub noticed_m: Option<f64>,
    /// Expected errors of a fit of the rows so far.
    pub now: Option<ExpectedErrors>,
    /// The same after ten more that are chosen best.
    pub after: Option<ExpectedErrors>,
    /// The configuration that gains most.
    pub next: Option<Vec<f64>>,
}

/// A session that is watched, row after row.
pub struct Watch {
    robot: Robot,
    options: WatchOptions,
    /// Rows that are as expected, and fitted.
    good: Vec<u32>,
    known: Option<Known>,
    /// Scales and degrees of freedom after each fitted row.
    history: Vec<(f64, f64)>,
    last: Option<u32>,
}

/// What is known once there are enough rows.
struct Known {
    experiment: Experiment,
    aim: Aim,
    candidates: Vec<f64>,
    /// Whether each candidate is to be measured yet.
    open: Vec<bool>,
    /// The best candidates to measure beside the rows so far, when last sought.
    ahead: Vec<usize>,
    blocks: Blocks,
    gram: DMatrix<f64>,
    covariance: DMatrix<f64>,
    rows: DMatrix<f64>,
    residuals: DVector<f64>,
    /// Variance of the whitened residuals, its degrees of freedom, and the factor of the terms' variance.
    scale: f64,
    freedom: f64,
    terms: f64,
    /// Targets and instruments of the data.
    names: [usize; 2],
}

impl Watch {
    /// A session of a robot of which nothing is measured yet.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] for kinds of measurement other than points and poses of a device.
    pub fn new(robot: &Robot, options: WatchOptions) -> Result<Self> {
        if !options.fit.session.kind.has_device() {
            return ErrorKind::Option.refuse(format!(
                "found the kind `{}`, expected points or poses, of which rows can be judged as they arrive",
                options.fit.session.kind.word()
            ));
        }
        Ok(Watch {
            robot: robot.clone(),
            options,
            good: Vec::new(),
            known: None,
            history: Vec::new(),
            last: None,
        })
    }

    /// Judges a row of the data, in the order of their arrival, and fits it if it is as expected.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`] if the robot has more unknowns than one fit allows.
    pub fn add(&mut self, data: &Dataset, row: usize) -> Result<WatchedRow> {
        let index = u32::try_from(row).unwrap_or(u32::MAX);
        let before = self.last.replace(index);
        let mut found = WatchedRow {
            row,
            mistake: None,
            ratio: None,
            noticed_m: None,
            now: None,
            after: None,
            next: None,
        };
        if before.is_some_and(|before| is_repeated(data, before as usize, row)) {
            found.mistake = Some(Mistake::Repeats);
            return Ok(found);
        }
        let is_new = self
            .known
            .as_ref()
            .is_some_and(|known| known.names != [data.targets.len(), data.station_count()]);
        if is_new {
            self.known = None;
        }
        if let Some(known) = &self.known {
            let judged = known.judge(data, index);
            found.ratio = Some(judged.ratio);
            found.noticed_m = Some(judged.noticed_m);
            if judged.ratio > 1.0 {
                found.mistake = Some(known.mistake(data, index, before, judged.off_m));
            }
        }
        if found.mistake.is_none() {
            self.good.push(index);
            self.fit(data)?;
            found.mistake = self.moved(data);
        }
        if let Some(known) = &mut self.known {
            known.foresee(&mut found);
        }
        Ok(found)
    }

    /// Fits the good rows.
    fn fit(&mut self, data: &Dataset) -> Result<()> {
        let own = data.only(&self.good);
        if let Some(known) = &mut self.known {
            known.fit(&own);
        } else {
            let numbers: usize = own.observations.iter().map(|row| row.measurement.dim()).sum();
            if numbers < FEWEST_NUMBERS + 3 * data.targets.len().max(1) + 3 {
                return Ok(());
            }
            self.known = Some(Known::new(&self.robot, &self.options, &own)?);
        }
        if let Some(known) = &self.known {
            self.history.push((known.scale, known.freedom));
        }
        Ok(())
    }

    /// Whether the last rows have in common that their target is elsewhere.
    fn moved(&mut self, data: &Dataset) -> Option<Mistake> {
        let known = self.known.as_ref()?;
        let before = *self.history.len().checked_sub(TOGETHER + 1).and_then(|at| self.history.get(at))?;
        let target = data.observations.get(*self.good.last()? as usize)?.target;
        let of_target =
            |row: &&u32| data.observations.get(**row as usize).is_some_and(|it| it.target == target);
        let last: Vec<u32> = self.good.iter().rev().filter(of_target).take(TOGETHER).copied().collect();
        if last.len() < TOGETHER {
            return None;
        }
        let off_m = known.shift(data, &self.good, &last, target, before)?;
        let ago = self.good.iter().filter(|row| last.iter().min().is_some_and(|first| *row >= first)).count();
        self.good.retain(|row| !last.contains(row));
        let own = data.only(&self.good);
        if let Some(known) = &mut self.known {
            known.fit(&own);
        }
        Some(Mistake::Moved(off_m, ago))
    }
}

/// Whether two rows have the same readings, target and numbers.
fn is_repeated(data: &Dataset, before: usize, row: usize) -> bool {
    let (Some(a), Some(b)) = (data.observations.get(before), data.observations.get(row)) else {
        return false;
    };
    a.target == b.target
        && a.station == b.station
        && a.measurement == b.measurement
        && data.readings(before) == data.readings(row)
}

/// How a row is beside what was expected of it.
struct Judged {
    ratio: f64,
    noticed_m: f64,
    off_m: f64,
}

impl Known {
    fn new(robot: &Robot, options: &WatchOptions, data: &Dataset) -> Result<Self> {
        let packed = Packed::of(robot, data);
        let rows = data.all_rows();
        let session = Session::new(robot, data, &packed, options.fit.session.device_free);
        let prior = Prior::of(&session, options.fit.tolerance.unwrap_or(Tolerance::WIDE));
        let noise = options.fit.session.noise;
        let registration =
            Registration { session, rows: &rows, noise, targets_free: true, prior: Some((&prior, 1.0)) };
        let registered = register(&registration, &delivered(robot, data)).0;
        let experiment = Experiment::begun(robot, &options.fit, data, &registered)?;
        let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
        let configurations = Configurations::new(robot);
        let mut draw = |count: usize| -> Vec<f64> {
            (0..count).flat_map(|_| configurations.random(&mut generator)).collect()
        };
        let candidates = options.candidates.clone().unwrap_or_else(|| draw(CANDIDATES));
        let workspace = options.workspace.clone().unwrap_or_else(|| draw(WORKSPACE));
        let blocks = experiment.blocks(&candidates)?;
        let n = blocks.columns;
        let corrected = if n > experiment.geometry() { 1.0 } else { 0.0 };
        let weights = Weights { calibrated: 1.0, corrected, determinant: 0.0 };
        let aim = Aim::new(&experiment.prior, experiment.moments(&workspace), weights, experiment.share());
        let mut known = Known {
            experiment,
            aim,
            open: vec![true; blocks.count()],
            ahead: Vec::new(),
            candidates,
            blocks,
            gram: DMatrix::zeros(n, n),
            covariance: DMatrix::identity(n, n),
            rows: DMatrix::zeros(0, n),
            residuals: DVector::zeros(0),
            scale: 1.0,
            freedom: BELIEVED,
            terms: 1.0,
            names: [data.targets.len(), data.station_count()],
        };
        known.fit(data);
        Ok(known)
    }

    /// Fits rows, and finds what they say of the noise and of the terms.
    fn fit(&mut self, data: &Dataset) {
        let (estimate, _) = self.experiment.fitted(data);
        self.experiment.estimate = estimate;
        (self.rows, self.residuals) = self.experiment.rows(data);
        self.gram = self.rows.transpose() * &self.rows;
        let travel = Travel::new(&self.experiment.robot, self.experiment.length_m());
        for (open, own) in self.open.iter_mut().zip(self.candidates.chunks_exact(self.experiment.width())) {
            *open = (0..data.len()).all(|row| travel.distance(own, data.readings(row)) > MEASURED_RAD);
        }
        let n = self.gram.nrows();
        if let Some(covariance) = inverse(&(&self.gram + &self.aim.prior)) {
            self.covariance = covariance;
        }
        // Unknowns that the rows determine beside the prior.
        let determined = n as f64 - self.covariance.dot(&self.aim.prior);
        let left = (self.residuals.len() as f64 - determined).max(0.0);
        self.freedom = BELIEVED + left;
        self.scale = (BELIEVED + self.residuals.norm_squared()) / self.freedom;
        let g = self.experiment.geometry();
        let (size, count) = self.experiment.size_of_terms(&self.covariance, g);
        self.terms = (BELIEVED + size) / (BELIEVED + count);
    }

    /// The row before it is fitted: its innovation against its covariance.
    fn judge(&self, data: &Dataset, row: u32) -> Judged {
        self.innovation(&data.only(&[row]))
    }

    fn innovation(&self, one: &Dataset) -> Judged {
        let (rows, residuals) = self.experiment.rows(one);
        let m = residuals.len();
        let mut covariance = &rows * &self.covariance * rows.transpose();
        (0..m).for_each(|k| covariance[(k, k)] += 1.0);
        let (values, _) = linalg::symmetric_eigen(covariance.as_slice(), m);
        let largest = values.last().copied().unwrap_or(1.0);
        let square = linalg::solved(covariance, &residuals).map_or(f64::INFINITY, |it| it.dot(&residuals));
        let limit = f_quantile(BY_CHANCE, m as f64, self.freedom) * m as f64 * self.scale;
        let sigma_m = self.experiment.noise()[Quantity::Position];
        Judged {
            ratio: square / limit,
            noticed_m: (limit * largest).sqrt() * sigma_m,
            off_m: residuals.rows(0, m.min(3)).norm() * sigma_m,
        }
    }

    /// What explains a row that is not as expected.
    fn mistake(&self, data: &Dataset, row: u32, before: Option<u32>, off_m: f64) -> Mistake {
        let at = row as usize;
        let observation = &data.observations[at];
        let with = |readings: &[f64]| -> Option<Dataset> {
            let mut one = data.only(&[]);
            one.push_observation(readings, *observation).ok()?;
            Some(one)
        };
        let own = data.readings(at);
        let chance = f_quantile(BY_CHANCE, observation.measurement.dim() as f64, self.freedom);
        let enough = f_quantile(EXPLAINED, observation.measurement.dim() as f64, self.freedom) / chance;
        let ratio =
            |readings: &[f64]| with(readings).map_or(f64::INFINITY, |one| self.innovation(&one).ratio);
        let mut best: (f64, Option<Mistake>) = (enough, None);
        let mut propose = |ratio: f64, mistake: Mistake| {
            if ratio < best.0 {
                best = (ratio, Some(mistake));
            }
        };
        if let Some(before) = before {
            propose(ratio(data.readings(before as usize)), Mistake::Stale);
        }
        let names = data.reading_names();
        for (joint, name) in names.iter().enumerate() {
            let mut turned = own.to_vec();
            turned[joint] = -turned[joint];
            propose(ratio(&turned), Mistake::Sign(name.clone()));
            if let Some((by, left)) = self.joint_off(&with, own, joint) {
                // One more number fits better by itself.
                propose(2.0 * left, Mistake::Joint(name.clone(), by));
            }
        }
        best.1.unwrap_or(Mistake::Off(off_m))
    }

    /// The change of one reading that explains a row best, and the ratio that is left.
    fn joint_off(
        &self,
        with: &impl Fn(&[f64]) -> Option<Dataset>,
        own: &[f64],
        joint: usize,
    ) -> Option<(f64, f64)> {
        let mut readings = own.to_vec();
        let mut by = 0.0;
        // Some steps: an offset may be large.
        for _ in 0..6 {
            let (rows, residuals) = self.experiment.rows(&with(&readings)?);
            let mut near = readings.clone();
            near[joint] += DIFFERENCE;
            let (_, moved) = self.experiment.rows(&with(&near)?);
            let slope = (moved - &residuals) / DIFFERENCE;
            let m = residuals.len();
            let mut covariance = &rows * &self.covariance * rows.transpose();
            (0..m).for_each(|k| covariance[(k, k)] += 1.0);
            let weighed = linalg::solved(covariance, &slope)?;
            let step = -weighed.dot(&residuals) / weighed.dot(&slope).max(f64::MIN_POSITIVE);
            by += step;
            readings[joint] += step;
            if !by.is_finite() || by.abs() > 1.0 {
                return None;
            }
        }
        Some((by, self.innovation(&with(&readings)?).ratio))
    }

    /// By how much the target of some of the fitted rows is elsewhere, if it evidently is; `before` is what was known before them.
    fn shift(
        &self,
        data: &Dataset,
        good: &[u32],
        last: &[u32],
        target: usize,
        before: (f64, f64),
    ) -> Option<f64> {
        let columns = self.experiment.shifts_of(target);
        let numbers = |row: &u32| data.observations.get(*row as usize).map_or(0, |it| it.measurement.dim());
        let mut moved = DMatrix::zeros(self.rows.nrows(), columns.len());
        let mut at = 0;
        for row in good {
            let count = numbers(row);
            if last.contains(row) {
                for (k, &column) in columns.iter().enumerate() {
                    moved.view_mut((at, k), (count, 1)).copy_from(&self.rows.view((at, column), (count, 1)));
                }
            }
            at += count;
        }
        if at != self.rows.nrows() || columns.is_empty() {
            return None;
        }
        let pull = moved.transpose() * &self.residuals;
        let shared = self.rows.transpose() * &moved;
        let information = moved.transpose() * &moved - shared.transpose() * &self.covariance * &shared;
        let step = linalg::solved(information, &pull)?;
        let (scale, freedom) = before;
        let k = columns.len() as f64;
        let limit = f_quantile(BY_CHANCE, k, freedom) * k * scale;
        (step.dot(&pull) > limit).then(|| step.norm())
    }

    /// Expected errors now and after more rows, and the next configuration: of the best list of so many rows, which begins with that of
    /// the row before, the one that gains most by itself.
    fn foresee(&mut self, found: &mut WatchedRow) {
        let Some((state, squares)) = State::new(&self.aim, &self.gram) else { return };
        found.now = Some(self.errors(&squares));
        let mut aim = self.aim.clone();
        if aim.weights.corrected > 0.0 {
            aim.weights.calibrated = 1.0 / squares.calibrated().max(f64::MIN_POSITIVE);
            aim.weights.corrected = 1.0 / squares.corrected.max(f64::MIN_POSITIVE);
        }
        let caches = Caches::new(&state, &aim, &self.blocks);
        let mut ranked: Vec<(f64, usize)> = (0..self.blocks.count())
            .filter(|&at| self.open[at])
            .map(|at| (caches.gain(at, &aim.weights), at))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let begun = self.ahead.iter().copied().filter(|&at| self.open[at]);
        let mut open: Vec<usize> = ranked.iter().take(GAINING).map(|it| it.1).chain(begun).collect();
        open.sort_unstable();
        open.dedup();
        let blocks = self.blocks.only(&open);
        let search = Search { aim: &aim, kept: &self.gram, blocks: &blocks, apart: &|_, _| true };
        let begun = self.ahead.iter().filter_map(|at| open.binary_search(at).ok()).collect();
        let chosen = search.exchange(search.greedy(begun, AHEAD.min(open.len())), 0);
        found.after = search.squares(&chosen).map(|squares| self.errors(&squares));
        self.ahead = chosen.into_iter().map(|at| open[at]).collect();
        let next = ranked.iter().find(|(_, at)| self.ahead.contains(at));
        let mut each = self.candidates.chunks_exact(self.experiment.width());
        found.next = next.and_then(|&(_, at)| each.nth(at)).map(<[f64]>::to_vec);
    }

    /// Errors with noise and terms as large as the rows show them.
    fn errors(&self, squares: &Squares) -> ExpectedErrors {
        let seen = Squares {
            true_noise: squares.true_noise * self.scale,
            terms: squares.terms * self.terms,
            corrected: squares.corrected * self.scale,
            ..*squares
        };
        ExpectedErrors::seen(&self.experiment, &seen, [self.scale, self.terms])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::Measurement;
    use crate::simulate::{Simulation, elbow};

    /// Rows of a simulated session of points, one of them off by 5 mm, one with the wrong sign of joint 5, one stale.
    #[test]
    fn mistakes_are_named_as_they_arrive() {
        let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), Kind::POINT).unwrap();
        let mut data = made.data.only(&[]);
        for row in 0..made.data.len() {
            let mut readings = made.data.readings(row).to_vec();
            let mut observation = made.data.observations[row];
            match row {
                20 => {
                    let at = observation.measurement.position().unwrap();
                    observation.measurement = Measurement::point(at + nalgebra::Vector3::new(0.0, 5e-3, 0.0));
                }
                25 => readings[4] = -readings[4],
                30 => observation = made.data.observations[row - 1],
                _ => {}
            }
            data.push_observation(&readings, observation).unwrap();
        }
        let fit = PlannedFit {
            robot_error: Some(crate::plan::RobotError { calibrated_m: 5e-5, corrected_m: None }),
            ..PlannedFit::default()
        };
        let mut watch =
            Watch::new(&elbow(), WatchOptions { fit, seed: 1, ..WatchOptions::default() }).unwrap();
        let mut named = Vec::new();
        for row in 0..data.len() {
            let found = watch.add(&data, row).unwrap();
            if let Some(mistake) = found.mistake {
                println!("{row}: {mistake:?}, {:.1} mm would be noticed", 1e3 * found.noticed_m.unwrap());
                named.push((row, mistake));
            }
        }
        let rows: Vec<usize> = named.iter().map(|it| it.0).collect();
        assert_eq!(rows, [20, 25, 30], "{named:?}");
        assert!(matches!(named[0].1, Mistake::Off(_) | Mistake::Joint(..)));
        assert_eq!(named[1].1, Mistake::Sign("joint5".to_owned()));
        assert_eq!(named[2].1, Mistake::Stale);
    }
}
