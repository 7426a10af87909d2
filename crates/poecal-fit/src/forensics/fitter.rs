//! Registrations and short calibrations by which hypotheses are compared, on a subsample of the rows.

use super::change::{empty_like, push};
use nalgebra::Vector3;

use crate::gauge;
use crate::parameters::{Parameter, ScrewAxis, ValueTerm};
use crate::problem::{Prior, Problem};
use crate::start::{
    Registration, clock_parameters, device_parameter, range_parameters, register, register_roughly, target_parameters,
};
use crate::state::{
    Estimate, InstrumentMount, Linkage, PackedValues, RowChain, RowError, Session, nominal_estimate, sample_rows,
};
use poecal_arm::lie::{Freedom, Pose, Screw};
use poecal_model::measurement::{Dataset, Noise, Observation, Quantity, StatedDeviations};
use poecal_model::robot::{Body, Joint, JointKind, Robot, Term, Tolerance};
use poecal_numerics::solve::{Options, minimize};

/// Rows of the subsample.
pub(crate) const SAMPLE: usize = 90;
/// Position noise that weights the rows, metres: only its ratio to the rotation noise counts.
const NOISE_M: f64 = 1e-3;
/// Calibrated error, as a share of the reach, that needs no diagnosis: the errors of real robots are below it.
const QUIET_SHARE: f64 = 5e-4;
/// Largest ratio of a single row's error to the root mean square.
const OUTSTANDING: f64 = 8.0;
/// Largest tilt of an axis by a calibration at which its joint's zero and sign are not in doubt: 4 degrees.
const QUIET_TILT_RAD: f64 = 0.07;
/// The same for the shift of an axis, as a share of the reach.
const QUIET_SHIFT_SHARE: f64 = 0.01;
/// Weight of the prior at the end. It constrains the unknowns that the measurements do not determine, and is too small to affect the
/// errors.
const WEAK: f64 = 1e-3;
/// Weight of a prior with which gross errors do not move the axes.
const STRONG: f64 = 100.0;
/// Iterations of a calibration to the optimum.
pub(crate) const LONG: usize = 60;
/// Iterations of a calibration for comparison.
pub(crate) const SHORT: usize = 12;

/// Error of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Misfit {
    /// Root mean square distance, metres.
    pub(crate) position_m: f64,
    /// Root mean square angle, radians; 0 if no angle was measured.
    pub(crate) rotation_rad: f64,
    /// Both together, an angle counted as its arc at `length_m`.
    pub(crate) total_m: f64,
}

impl Misfit {
    /// Both together with the distances scaled.
    pub(crate) fn resized_m(&self, factor: f64) -> f64 {
        let turned = (self.total_m.powi(2) - self.position_m.powi(2)).max(0.0);
        (turned + (factor * self.position_m).powi(2)).sqrt()
    }
}

/// Errors with nominal screws, and with screws fitted in a few iterations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    pub(crate) registered: Misfit,
    pub(crate) calibrated: Misfit,
}

/// Robot and options of the fits.
#[derive(Clone, Debug)]
pub(crate) struct Fitter<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) device_free: bool,
    /// Metres that a radian counts.
    pub(crate) length_m: f64,
    pub(crate) start: Estimate,
    pub(crate) noise: Noise,
    /// For measurements that may have no length of their own: the prior of the axes, and the spread of the targets by the nominal robot,
    /// metres.
    pub(crate) constrained: Option<(Prior, f64)>,
    /// Weight of the prior.
    pub(crate) weight: f64,
}

impl<'a> Fitter<'a> {
    pub(crate) fn new(robot: &'a Robot, data: &Dataset, device_free: bool) -> Self {
        // The length is not taken from strokes in the data, whose unit may be wrong.
        let length_m = robot.reach_m() / 3.0;
        let noise = Noise::new(NOISE_M, NOISE_M / length_m);
        let start = nominal_estimate(robot, data);
        // With directions alone no smaller robot fits better.
        let has_lengths = [Quantity::Position, Quantity::Distance, Quantity::Contact, Quantity::Height];
        let weight = if has_lengths.iter().any(|&quantity| data.has(quantity)) { 1.0 } else { WEAK };
        let mut fitter = Fitter { robot, device_free, length_m, start, noise, constrained: None, weight };
        let rows = data.all_rows();
        let is_constrained = |station: usize| data.device_freedom(station, &rows) != Freedom::FRAME;
        if (0..data.station_count()).any(is_constrained) {
            let prior = Prior::new(robot, Tolerance::default(), device_free);
            fitter.constrained = Some((prior, fitter.spread_m(data)));
        }
        fitter
    }

    /// True if measurements may have no length of their own.
    pub(crate) fn is_constrained(&self) -> bool {
        self.constrained.is_some()
    }

    /// Root mean square distance of the targets from their mean, by the nominal robot, metres.
    fn spread_m(&self, data: &Dataset) -> f64 {
        let mut in_base = self.start.clone();
        (0..data.station_count()).for_each(|station| {
            if matches!(in_base.tree.instruments().get(station), Some(InstrumentMount::On(Body::Base))) {
                *in_base.device_mut(station) = Pose::identity();
            }
        });
        let (linkage, packed, mut chain) = (Linkage::new(&in_base), self.pack_values(data), RowChain::default());
        let mut place = |row: usize| {
            chain.evaluate(&linkage, &packed, row, &data.observations[row]);
            chain.target.translation
        };
        let places: Vec<Vector3<f64>> = (0..data.len()).map(&mut place).collect();
        let count = places.len().max(1) as f64;
        let mean = places.iter().sum::<Vector3<f64>>() / count;
        (places.iter().map(|place| (place - mean).norm_squared()).sum::<f64>() / count).sqrt()
    }

    /// Factor on errors of data whose targets move less than those of the original data: without a length of their own, smaller motions
    /// have smaller errors.
    fn error_scale(&self, data: &Dataset) -> f64 {
        let ratio = |(_, given): &(Prior, f64)| (given / self.spread_m(data).max(f64::MIN_POSITIVE)).max(1.0);
        self.constrained.as_ref().map_or(1.0, ratio)
    }

    /// Reach of the robot, metres.
    pub(crate) fn reach_m(&self) -> f64 {
        3.0 * self.length_m
    }

    pub(crate) fn pack_values(&self, data: &Dataset) -> PackedValues {
        PackedValues::from_dataset(self.robot, data)
    }

    pub(crate) fn session<'b>(&'b self, data: &'b Dataset, packed: &'b PackedValues) -> Session<'b> {
        let Fitter { robot, device_free, length_m, .. } = *self;
        Session::new(robot, data, packed, device_free).with_length(length_m)
    }

    /// Registers the nominal robot.
    pub(crate) fn register_nominal(&self, data: &Dataset) -> (Estimate, Misfit) {
        self.register(data, |registration| register(registration, &self.start).0)
    }

    /// Registers the nominal robot quickly, not always to the optimum.
    pub(crate) fn roughly_registered(&self, data: &Dataset) -> (Estimate, Misfit) {
        self.register(data, |registration| register_roughly(registration, &self.start))
    }

    fn register(&self, data: &Dataset, by: impl Fn(&Registration<'_>) -> Estimate) -> (Estimate, Misfit) {
        let packed = self.pack_values(data);
        let rows = data.all_rows();
        let registration = Registration {
            session: self.session(data, &packed),
            rows: &rows,
            noise: self.noise,
            targets_free: true,
            prior: None,
        };
        let estimate = by(&registration);
        let misfit = self.misfit(&registration.session, &estimate);
        (estimate, misfit)
    }

    /// Fits the screws from a registration in a few iterations.
    pub(crate) fn calibrate(&self, data: &Dataset, registered: &Estimate, iterations: usize) -> (Estimate, Misfit) {
        // The first device frame stays: beside the screws it is redundant.
        let first = data.first_station(&data.all_rows());
        let free = self.devices(data, Some(first)).into_iter().chain(axes(registered)).collect();
        self.fit(data, registered, free, iterations)
    }

    /// The same fitter, with a prior that leaves the errors to the measurements.
    pub(crate) fn with_weak_prior(&self) -> Self {
        Fitter { weight: WEAK, ..self.clone() }
    }

    /// The same fitter, with a prior that keeps the axes near nominal whatever the errors.
    pub(crate) fn with_strong_prior(&self) -> Self {
        Fitter { weight: STRONG, ..self.clone() }
    }

    /// Fits a term of some joints from a registration, with an unknown device frame refitted.
    pub(crate) fn with_term(
        &self,
        data: &Dataset,
        registered: &Estimate,
        (joints, term): (&[usize], Term),
        iterations: usize,
    ) -> (Estimate, Misfit) {
        let free = terms(registered, joints, term).chain(self.devices(data, None)).collect();
        self.fit(data, registered, free, iterations)
    }

    /// Fits a term of some joints together with all axes, which a prior keeps near nominal.
    pub(crate) fn with_term_and_axes(
        &self,
        data: &Dataset,
        registered: &Estimate,
        (joints, term): (&[usize], Term),
        tolerance: Tolerance,
    ) -> (Estimate, Misfit) {
        let prior = Prior::new(self.robot, tolerance, self.device_free);
        let free = axes(registered).chain(terms(registered, joints, term)).chain(self.devices(data, None)).collect();
        Fitter { constrained: Some((prior, self.spread_m(data))), weight: 1.0, ..self.clone() }
            .fit(data, registered, free, LONG)
    }

    /// The unknown device frames, but for one that stays.
    fn devices(&self, data: &Dataset, held: Option<usize>) -> Vec<Parameter> {
        let rows = data.all_rows();
        let is_seen = |station: &usize| !data.seen_from(*station, &rows).is_empty();
        let is_free = |station: &usize| self.device_free && Some(*station) != held && is_seen(station);
        let stations = (0..data.station_count()).filter(is_free);
        stations.map(|station| device_parameter(data, station, &rows)).collect()
    }

    fn fit(
        &self,
        data: &Dataset,
        registered: &Estimate,
        mut free: Vec<Parameter>,
        iterations: usize,
    ) -> (Estimate, Misfit) {
        let packed = self.pack_values(data);
        let rows = data.all_rows();
        let session = self.session(data, &packed);
        free.extend(range_parameters(&session, &rows).map(Parameter::RangeUnknown));
        free.extend(clock_parameters(&session, &rows).map(Parameter::ClockUnknown));
        free.extend(target_parameters(&session, &rows));
        let mut start = registered.clone();
        start.recentre(&session, &rows);
        let prior = self.constrained.as_ref().map(|(prior, _)| (prior, self.weight));
        let problem = Problem::new(session, rows, free, self.noise).with_prior(prior);
        // Geodesic steps are off: hypotheses that explain nothing would take most of the time.
        let options = Options { iterations, acceleration: false, ..Options::default() };
        let (estimate, _, _) = minimize(&problem, start, &options);
        let misfit = self.misfit(&session, &estimate);
        (estimate, misfit)
    }

    /// Estimate and errors of the supplied data.
    pub(crate) fn judge(&self, data: &Dataset) -> (Estimate, Score) {
        let (start, registered) = self.register_nominal(data);
        let (mut estimate, mut calibrated) = self.calibrate(data, &start, LONG);
        if self.is_constrained() {
            // Each row measures less, so that a fit ends in a local minimum more often; a start near nominal does not.
            let near = self.with_strong_prior().calibrate(data, &start, LONG).0;
            let (other, misfit) = self.calibrate(data, &near, LONG);
            if misfit.total_m < calibrated.total_m {
                (estimate, calibrated) = (other, misfit);
            }
        }
        (estimate, Score { registered, calibrated })
    }

    /// True if the data need no diagnosis: a calibration explains them with each axis near nominal.
    pub(crate) fn is_sound(&self, data: &Dataset, calibrated: &Estimate) -> bool {
        let errors = self.session(data, &self.pack_values(data)).errors(&data.all_rows(), calibrated);
        let totals = errors.iter().map(|error| self.squared_m2(error));
        let mean = totals.clone().sum::<f64>() / errors.len().max(1) as f64;
        let most = totals.fold(0.0, f64::max);
        let quiet = QUIET_SHARE * self.reach_m();
        if mean.sqrt() > quiet || most.sqrt() > quiet.max(OUTSTANDING * mean.sqrt()) {
            return false;
        }
        let motion = if self.device_free {
            gauge::base_motion(calibrated, self.robot, &self.start.base_from_target, self.length_m)
        } else {
            Pose::identity()
        };
        let moved = calibrated.rebase(&motion).screws();
        let is_near = |(screw, joint): (&Screw, &Joint)| {
            let tilt = screw.direction().angle(&joint.screw.direction());
            let place = joint.frame.translation;
            // A prismatic joint has no position.
            let shift = match joint.kind {
                JointKind::Revolute => (screw.nearest_point(&place) - place).norm(),
                JointKind::Prismatic => 0.0,
            };
            tilt < QUIET_TILT_RAD && shift < QUIET_SHIFT_SHARE * self.reach_m()
        };
        moved.iter().zip(&self.robot.joints).all(is_near)
    }

    /// Squared error of a row, an angle counted as its arc at `length_m`.
    pub(crate) fn squared_m2(&self, error: &RowError) -> f64 {
        error.square_m2() + error.square_rad2() * self.length_m.powi(2)
    }

    pub(crate) fn misfit(&self, session: &Session<'_>, estimate: &Estimate) -> Misfit {
        let (mut position, mut rotation, mut turned) = (0.0, 0.0, 0usize);
        let errors = session.errors(&session.data.all_rows(), estimate);
        for error in &errors {
            position += error.square_m2();
            rotation += error.square_rad2();
            turned += usize::from(error.has_angle());
        }
        let (count, factor) = (errors.len().max(1) as f64, self.error_scale(session.data));
        Misfit {
            position_m: factor * (position / count).sqrt(),
            rotation_rad: factor * (rotation / turned.max(1) as f64).sqrt(),
            total_m: factor * ((position + rotation * self.length_m.powi(2)) / count).sqrt(),
        }
    }
}

/// All axes of an estimate as unknowns.
fn axes(estimate: &Estimate) -> impl Iterator<Item = Parameter> {
    let kinds = estimate.kinds().iter().enumerate();
    kinds.map(|(joint, &kind)| Parameter::ScrewAxis(ScrewAxis { joint, kind }))
}

/// A term of some joints as unknowns.
fn terms(estimate: &Estimate, joints: &[usize], term: Term) -> impl Iterator<Item = Parameter> {
    let kinds = estimate.kinds();
    joints
        .iter()
        .filter_map(move |&joint| kinds.get(joint).map(|&kind| Parameter::ValueTerm(ValueTerm { joint, kind, term })))
}

/// Some rows of a data set, without stated noise.
pub(crate) fn take_rows(data: &Dataset, rows: &[u32]) -> Dataset {
    let mut taken = empty_like(data);
    for &row in rows {
        let observation = data.observations[row as usize];
        let plain = Observation { stated: StatedDeviations::default(), noise_shape: None, ..observation };
        push(&mut taken, data.readings(row as usize), plain);
    }
    taken
}

/// The subsample of a data set.
pub(crate) fn subsample(data: &Dataset) -> Dataset {
    sample_of(data, &data.all_rows())
}

/// The subsample of some rows.
pub(crate) fn sample_of(data: &Dataset, rows: &[u32]) -> Dataset {
    take_rows(data, &sample_rows(rows, SAMPLE))
}
