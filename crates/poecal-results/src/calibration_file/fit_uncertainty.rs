//! Uncertainty of a fitted model, as stored in `calibration.json`.

use nalgebra::Matrix3;

use super::trust::{BootstrapEntry, ExpectedEntry, RangeEntry, held_out};
use super::{CorrelationsEntry, PoseEntry, UncertaintyEntry, link};
use super::{in_file_units, trust::by_quantity};
use poecal_calibrate::{CalibratedTarget, Calibration, Correction, CoverageCheck, Expectations, ModelAccuracy, names};
use poecal_fit::parameters::{Parameter, TargetPlace};
use poecal_fit::uncertainty::{Bootstrap, Discrepancy, Uncertainty};
use poecal_model::measurement::{Dataset, Quantity};
use poecal_model::robot::Robot;

/// A model with the prediction of its own errors.
#[derive(Clone, Copy)]
struct PredictiveModel<'a> {
    uncertainty: &'a Uncertainty,
    expected: &'a Expectations,
    held_out: Option<&'a CoverageCheck>,
    bootstrap: Option<&'a Bootstrap>,
    robot: &'a Robot,
    /// The robot with its tip and its mounted targets, as fitted.
    placed: &'a Robot,
    targets: &'a [CalibratedTarget],
    /// Errors of the fitted rows.
    measured: &'a ModelAccuracy,
    tells_correlations: bool,
}

impl PredictiveModel<'_> {
    /// Turns into the axes of the file, each with its unknowns. The fit has positions of points along axes of its own, which the file does not store.
    fn turns(&self) -> Vec<(Vec<usize>, Matrix3<f64>)> {
        let found = self.uncertainty;
        let turns = found.layout.parameters().filter_map(|(parameter, places)| {
            let Parameter::TargetPlace(TargetPlace { target }) = parameter else { return None };
            let own = self.targets.get(*target)?;
            let mount = self.placed.mounted.iter().find(|mount| Some(&mount.name) == own.name.as_ref());
            let rotation = mount.map_or(self.placed.home.rotation, |mount| self.placed.base_from(mount).rotation);
            let turn = rotation.transpose() * found.estimate.base_from_target.get(*target)?.rotation;
            Some((places.iter().map(|(place, _)| *place).collect(), turn))
        });
        turns.collect()
    }
}

/// The unknowns of a fit that the file stores.
struct StoredUnknowns {
    /// Their indices in the layout.
    places: Vec<usize>,
    names: Vec<String>,
    /// Point of the device frame about which its unknowns turn.
    about: Option<[f64; 3]>,
}

impl StoredUnknowns {
    /// Selection of the unknowns. Predictions are in the frame of the first station, so that other stations do not matter.
    fn from_uncertainty(found: &Uncertainty, robot: &Robot, data: &Dataset) -> Self {
        let names = names(robot, data);
        let (mut kept, mut about) = (Vec::new(), None);
        for (parameter, places) in found.layout.parameters() {
            match parameter {
                Parameter::DeviceFrame(frame) if frame.station == 0 => about = Some(frame.about.into()),
                Parameter::DeviceFrame(_) | Parameter::RangeUnknown(_) | Parameter::ClockUnknown(_) => {
                    continue;
                }
                Parameter::ScrewAxis(_)
                | Parameter::OtherScrew(_)
                | Parameter::ValueTerm(_)
                | Parameter::TargetPlace(_)
                | Parameter::TargetFrame(_) => {}
            }
            kept.extend(places.iter().map(|(place, _)| *place).zip(names.of_unknowns(parameter)));
        }
        kept.sort_unstable();
        let (places, names) = kept.into_iter().unzip();
        StoredUnknowns { places, names, about }
    }
}

impl UncertaintyEntry {
    /// Uncertainty of the calibrated model.
    pub(crate) fn from_calibration(calibration: &Calibration, data: &Dataset) -> Option<Self> {
        let trust = &calibration.trust;
        Self::of_model(
            &PredictiveModel {
                uncertainty: trust.uncertainty.as_ref()?,
                expected: &trust.expected,
                held_out: trust.held_out.as_ref(),
                bootstrap: trust.bootstrap.as_ref(),
                robot: &calibration.nominal,
                placed: &calibration.robot,
                targets: &calibration.targets,
                measured: &calibration.accuracy.training.calibrated,
                tells_correlations: true,
            },
            data,
        )
    }

    /// Uncertainty of the corrected model.
    pub(crate) fn of_correction(correction: &Correction, data: &Dataset) -> Option<Self> {
        Self::of_model(
            &PredictiveModel {
                uncertainty: correction.uncertainty.as_ref()?,
                expected: &correction.expected,
                held_out: correction.kept.as_ref(),
                bootstrap: None,
                robot: &correction.robot,
                placed: &correction.robot,
                targets: &correction.targets,
                measured: &correction.training,
                tells_correlations: false,
            },
            data,
        )
    }

    fn of_model(model: &PredictiveModel<'_>, data: &Dataset) -> Option<Self> {
        let PredictiveModel { uncertainty: found, expected, held_out: judged, bootstrap, .. } = *model;
        let PredictiveModel { robot, targets, measured, tells_correlations, .. } = *model;
        let n = found.layout.dim();
        let StoredUnknowns { places: kept, names: unknowns, about } =
            StoredUnknowns::from_uncertainty(found, robot, data);
        let turns = model.turns();
        let turned = |matrix: &[f64]| -> Vec<f64> {
            let mut matrix = matrix.to_vec();
            turns.iter().for_each(|(places, turn)| link::turn(&mut matrix, n, places, turn));
            matrix
        };
        let covariance = turned(&found.covariance);
        let upper = |matrix: &[f64]| -> Vec<f64> {
            let rows = kept.iter().enumerate();
            rows.flat_map(|(at, &i)| kept[at..].iter().map(move |&j| i * n + j)).map(|place| matrix[place]).collect()
        };
        let correlations = || {
            let whole = kept.iter().flat_map(|&i| kept.iter().map(move |&j| i * n + j));
            CorrelationsEntry::from_covariance(&whole.map(|place| covariance[place]).collect::<Vec<f64>>(), &unknowns)
        };
        let Discrepancy { scatter, extrapolation, standard_deviation, noise, attribution, freedom, lag_one } =
            found.discrepancy;
        let is_told = |quantity: Quantity| quantity.is_of_pose() || measured.get(quantity).is_some();
        let told = |quantity: Quantity, si: f64| is_told(quantity).then_some(si);
        let is_finite = |quantity: Quantity| is_told(quantity) && freedom[quantity].is_finite();
        Some(UncertaintyEntry {
            inflation: scatter,
            extrapolation: Some(extrapolation).filter(|it| *it > scatter),
            discrepancy: in_file_units(|quantity| told(quantity, standard_deviation[quantity])),
            noise: in_file_units(|quantity| told(quantity, noise[quantity])),
            residuals: by_quantity(&|quantity| is_told(quantity).then_some(attribution[quantity])),
            freedom: by_quantity(&|quantity| is_finite(quantity).then_some(freedom[quantity])),
            lag_one_correlation: lag_one,
            measured: ExpectedEntry::from_expected(expected.measured.as_ref()?),
            range: ExpectedEntry::from_expected(expected.range.as_ref()?),
            held_out: judged.map(held_out),
            bootstrap: bootstrap.map(BootstrapEntry::from_bootstrap),
            parts: expected.parts.iter().map(|part| RangeEntry::from_range(robot, part)).collect(),
            length_m: found.length_m,
            axes: found.estimate.base_from_axis.iter().map(PoseEntry::from).collect(),
            targets: targets.iter().map(|it| (it.name.clone().unwrap_or_default(), it.is_frame)).collect(),
            correlations: tells_correlations.then(correlations),
            unknowns,
            frame_about_m: about,
            covariance_m2: upper(&covariance),
            covariance_outside_m2: found.covariance_outside.as_deref().map(|it| upper(&turned(it))),
        })
    }
}
