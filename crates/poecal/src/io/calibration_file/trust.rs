//! Verdict, coverage, cross-validation and uncertainty in `calibration.json`.

use nalgebra::Matrix3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::keyed::{AttributionKeys, DiscrepancyKeys, FreedomKeys, Keyed, NoiseKeys, RmsKeys, shown};
use super::link::{self, LinkPoints};
use super::{CalibrationFile, CorrelationsEntry, JointChangeEntry, PoseEntry};
use crate::analysis::JointCoverage;
use crate::calibration::{
    CalibratedTarget, Calibration, Correction, CoverageCheck, Expectations, Expected, JointCorrection,
    ModelAccuracy, PartCoverage, Trust, names,
};
use crate::error::{Error, ErrorKind, Result};
use crate::estimate::{Estimate, Stand, Tree};
use crate::lie::Freedom;
use crate::measurement::{ByQuantity, Dataset, Measured, Quantity};
use crate::parameters::{
    Block, DeviceFrame, Names, Parameter, TargetFrame, TargetPlace, ValueTerm, screw_axes,
};
use crate::problem::Layout;
use crate::robot::{Body, JointKind, Robot, Term};
use crate::uncertainty::{Attribution, Bootstrap, Discrepancy, LeftOut, Uncertainty};

/// Errors of the rows of a fold or block, predicted by a fit of the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeftOutEntry {
    /// Name of the block.
    pub left_out: String,
    /// Number of rows.
    pub rows: usize,
    /// Root mean square error of each measured quantity, millimetres or degrees.
    #[serde(flatten)]
    pub rms: Keyed<RmsKeys>,
}

/// Cross-validation on the fitted rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CrossValidationEntry {
    /// Random folds, all together.
    pub random: LeftOutEntry,
    /// The ends of each joint's range, files, and groups of equal `id`, each predicted by a fit without it.
    pub blocked: Vec<LeftOutEntry>,
}

/// Expected errors of predicted positions, millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedEntry {
    /// Root mean square distance.
    pub sigma_position_mm: f64,
    /// Mean of the 95 % bounds.
    pub bound95_position_mm: f64,
    /// The largest of these.
    pub worst_bound95_position_mm: f64,
}

/// Spread of predictions at measured configurations over bootstrap samples of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BootstrapEntry {
    /// Number of samples: neighbourhoods of rows, with replacement.
    pub drawings: usize,
    /// Root mean square distance over these samples, millimetres.
    pub sigma_position_mm: f64,
    /// The same by the covariance, for white noise, millimetres.
    pub formal_sigma_position_mm: f64,
}

/// Errors of held-out positions or rotations compared with their predicted uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KeptEntry {
    /// Expected root mean square error between measured and predicted, millimetres or degrees.
    pub expected_rms: f64,
    /// Share of the errors within their own 95 % bound, 0 to 1.
    pub inside_bound95: f64,
}

/// Errors of held-out rows compared with their predicted uncertainty: of each quantity that was measured, millimetres or degrees.
pub type HeldOutEntry = Measured<KeptEntry>;

fn held_out(kept: &CoverageCheck) -> HeldOutEntry {
    let entry = |part: PartCoverage| KeptEntry {
        expected_rms: part.expected_rms,
        inside_bound95: part.inside_bound95,
    };
    Measured::of(|quantity| kept.parts.get(quantity).map(entry))
}

/// A part of a joint's range with the expected error there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RangeEntry {
    /// The joint.
    pub joint: String,
    /// From, radians or metres.
    pub from: f64,
    /// To.
    pub to: f64,
    /// Root mean square distance, millimetres, with the other joints anywhere in their ranges.
    pub sigma_position_mm: f64,
}

/// A joint's correction, its uncertainty, and its effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrectionEntry {
    /// The joint.
    pub joint: String,
    /// Angle between nominal and calibrated direction, degrees.
    pub tilt_deg: f64,
    /// Distance of the calibrated axis from the nominal joint's origin, millimetres.
    pub shift_mm: f64,
    /// Standard deviation of the direction, degrees (root mean square); null where it is not determined.
    pub sigma_tilt_deg: Option<f64>,
    /// Standard deviation of the axis' place at the joint, millimetres; null where it is not determined.
    pub sigma_shift_mm: Option<f64>,
    /// The same as `sigma_tilt_deg` if the axes of all other joints were known; missing in older files, and where the axis was held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_tilt_held_deg: Option<f64>,
    /// The same of `sigma_shift_mm`; missing of a joint that slides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_shift_held_mm: Option<f64>,
    /// The measurements' share in what is known of the direction, from 0 to 1; the rest is the tolerance's. Absent without a tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt_from_data: Option<f64>,
    /// The same of the axis' place; absent of a joint that slides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shift_from_data: Option<f64>,
    /// Root mean square position error with this screw alone nominal, millimetres.
    pub left_nominal_rms_mm: f64,
    /// The correction in parts, with directions; missing in older files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<JointChangeEntry>,
    /// Why the joint is suspicious: a correction beyond those of the others, or residuals that follow its position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub suspicious: Option<String>,
}

/// Covariance of the unknowns, and expected errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertaintyEntry {
    /// Factor of the covariance over that of independent residuals.
    pub inflation: f64,
    /// The same outside the sampled range; absent if no larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extrapolation: Option<f64>,
    /// Model error: standard deviation of each component, millimetres or degrees; of positions, rotations and what else was measured.
    #[serde(flatten)]
    pub discrepancy: Keyed<DiscrepancyKeys>,
    /// Measurement noise in the residuals: standard deviation of each component, millimetres or degrees.
    #[serde(flatten)]
    pub noise: Keyed<NoiseKeys>,
    /// Whether the residuals count as the robot's or the instrument's.
    #[serde(flatten)]
    pub residuals: Keyed<AttributionKeys, Attribution>,
    /// Degrees of freedom of the residuals' variance; none where their noise is stated.
    #[serde(flatten)]
    pub freedom: Keyed<FreedomKeys>,
    /// Correlation of residuals of consecutive rows; null if not significant.
    #[serde(default)]
    pub lag_one_correlation: Option<f64>,
    /// In the measured configurations.
    pub measured: ExpectedEntry,
    /// Anywhere within the limits.
    pub range: ExpectedEntry,
    /// Errors of held-out rows compared with their predicted uncertainty; null without such rows.
    #[serde(default)]
    pub held_out: Option<HeldOutEntry>,
    /// Bootstrap at measured configurations; null with too few rows.
    #[serde(default)]
    pub bootstrap: Option<BootstrapEntry>,
    /// By parts of each joint's range.
    pub parts: Vec<RangeEntry>,
    /// Metres that a radian counts in the covariance.
    pub length_m: f64,
    /// Frames `base_from_axis` at zero, z along the joint, of each joint's unknowns: shifts along x and y and turns about x and y of a
    /// revolute joint, turns about x and y of a prismatic one.
    pub axes: Vec<PoseEntry>,
    /// Targets with unknowns, `true` for frames: shifts along their axes, and for frames turns about them. One that is the tip has an empty name.
    pub targets: Vec<(String, bool)>,
    /// Names of the unknowns, in the order of the covariance; missing in older files.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unknowns: Vec<String>,
    /// Point of the device frame about which its unknowns turn, metres, where the frame is among them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_about_m: Option<[f64; 3]>,
    /// Correlations of the unknowns, by blocks; missing in older files and of the corrected model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlations: Option<CorrelationsEntry>,
    /// Covariance of the unknowns, square metres, turns multiplied by `length_m`: the upper triangle by rows, in the order of the fit with
    /// pure translations first.
    pub covariance_m2: Vec<f64>,
    /// The same outside the sampled range; absent if no larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance_outside_m2: Option<Vec<f64>>,
}

/// A model with what it predicts of its own errors.
#[derive(Clone, Copy)]
struct Predicting<'a> {
    uncertainty: &'a Uncertainty,
    expected: &'a Expectations,
    held_out: Option<&'a CoverageCheck>,
    bootstrap: Option<&'a Bootstrap>,
    robot: &'a Robot,
    /// The robot with its tip and its mounted targets, as it was found.
    placed: &'a Robot,
    targets: &'a [CalibratedTarget],
    /// Errors of the fitted rows.
    measured: &'a ModelAccuracy,
    tells_correlations: bool,
}

impl LeftOutEntry {
    fn of(found: &LeftOut) -> Self {
        LeftOutEntry {
            left_out: found.name.clone(),
            rows: found.rows,
            rms: shown(|quantity| found.rms.get(quantity)),
        }
    }
}

impl CrossValidationEntry {
    pub(super) fn of(trust: &Trust) -> Option<Self> {
        let found = trust.cross_validation.as_ref()?;
        Some(CrossValidationEntry {
            random: LeftOutEntry::of(&found.random),
            blocked: found.blocked.iter().map(LeftOutEntry::of).collect(),
        })
    }
}

impl ExpectedEntry {
    fn of(expected: &Expected) -> Self {
        ExpectedEntry {
            sigma_position_mm: expected.sigma_m * 1e3,
            bound95_position_mm: expected.bound_m * 1e3,
            worst_bound95_position_mm: expected.worst_bound_m * 1e3,
        }
    }
}

impl BootstrapEntry {
    fn of(found: &Bootstrap) -> Self {
        BootstrapEntry {
            drawings: found.drawings,
            sigma_position_mm: found.sigma_m * 1e3,
            formal_sigma_position_mm: found.formal_sigma_m * 1e3,
        }
    }
}

impl CorrectionEntry {
    pub(super) fn of((coverage, found): (&JointCoverage, &JointCorrection)) -> Self {
        CorrectionEntry {
            joint: coverage.joint.clone(),
            tilt_deg: found.tilt_rad.to_degrees(),
            shift_mm: found.shift_m * 1e3,
            sigma_tilt_deg: found.sigma_tilt_rad.map(f64::to_degrees),
            sigma_shift_mm: found.sigma_shift_m.map(|sigma| sigma * 1e3),
            sigma_tilt_held_deg: found.held.map(|(tilt, _)| tilt.to_degrees()),
            sigma_shift_held_mm: found.held.filter(|(_, shift)| *shift > 0.0).map(|(_, shift)| 1e3 * shift),
            tilt_from_data: found.tilt_from_data,
            shift_from_data: found.shift_from_data,
            left_nominal_rms_mm: found.left_nominal_rms_m * 1e3,
            change: Some(JointChangeEntry::from(&found.change)),
            suspicious: found.suspicious.clone(),
        }
    }
}

impl UncertaintyEntry {
    /// Of the calibrated model.
    pub(super) fn of(calibration: &Calibration, data: &Dataset) -> Option<Self> {
        let trust = &calibration.trust;
        Self::of_model(
            &Predicting {
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

    /// Of the corrected model.
    pub(super) fn of_correction(correction: &Correction, data: &Dataset) -> Option<Self> {
        Self::of_model(
            &Predicting {
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

    fn of_model(model: &Predicting<'_>, data: &Dataset) -> Option<Self> {
        let Predicting {
            uncertainty: found,
            expected,
            held_out: judged,
            bootstrap,
            robot,
            placed,
            targets,
            measured,
            tells_correlations,
        } = *model;
        let n = found.layout.dim();
        // Predictions are in the frame of the first station, so that those of others do not matter.
        let is_kept = |parameter: &Parameter| match parameter {
            Parameter::DeviceFrame(frame) => frame.station == 0,
            Parameter::RangeUnknown(_) => false,
            Parameter::ScrewAxis(_)
            | Parameter::OtherScrew(_)
            | Parameter::ValueTerm(_)
            | Parameter::TargetPlace(_)
            | Parameter::TargetFrame(_) => true,
        };
        let names = names(robot, data);
        let of_layout: Vec<_> =
            found.layout.parameters().filter(|(parameter, _)| is_kept(parameter)).collect();
        let mut kept: Vec<(usize, String)> = of_layout
            .iter()
            .flat_map(|(parameter, places)| {
                places.iter().zip(names.of_unknowns(parameter)).map(|(&(place, _), name)| (place, name))
            })
            .collect();
        kept.sort_unstable();
        let (kept, unknowns): (Vec<usize>, Vec<String>) = kept.into_iter().unzip();
        let about = of_layout.iter().find_map(|(parameter, _)| match parameter {
            Parameter::DeviceFrame(frame) => Some(frame.about.into()),
            Parameter::ScrewAxis(_)
            | Parameter::OtherScrew(_)
            | Parameter::ValueTerm(_)
            | Parameter::TargetPlace(_)
            | Parameter::TargetFrame(_)
            | Parameter::RangeUnknown(_) => None,
        });
        // Places of points are along axes that the file does not have: of the fit, and not of the tip.
        let turns = found.layout.parameters().filter_map(|(parameter, places)| {
            let Parameter::TargetPlace(TargetPlace { target }) = parameter else { return None };
            let own = targets.get(*target)?;
            let mount = placed.mounted.iter().find(|mount| Some(&mount.name) == own.name.as_ref());
            let rotation = mount.map_or(placed.home.rotation, |mount| placed.base_from(mount).rotation);
            let turn = rotation.transpose() * found.estimate.base_from_target.get(*target)?.rotation;
            Some((places.iter().map(|(place, _)| *place).collect::<Vec<_>>(), turn))
        });
        let turns: Vec<(Vec<usize>, Matrix3<f64>)> = turns.collect();
        let turned = |matrix: &[f64]| -> Vec<f64> {
            let mut matrix = matrix.to_vec();
            turns.iter().for_each(|(places, turn)| link::turn(&mut matrix, n, places, turn));
            matrix
        };
        let covariance = turned(&found.covariance);
        let upper = |matrix: &[f64]| -> Vec<f64> {
            let rows = kept.iter().enumerate();
            rows.flat_map(|(at, &i)| kept[at..].iter().map(move |&j| i * n + j))
                .map(|place| matrix[place])
                .collect()
        };
        let Discrepancy { scatter, extrapolation, standard_deviation, noise, attribution, freedom, lag_one } =
            found.discrepancy;
        let is_told = |quantity: Quantity| quantity.is_of_pose() || measured.get(quantity).is_some();
        let told = |quantity: Quantity, si: f64| is_told(quantity).then_some(si);
        let is_finite = |quantity: Quantity| is_told(quantity) && freedom[quantity].is_finite();
        Some(UncertaintyEntry {
            inflation: scatter,
            extrapolation: Some(extrapolation).filter(|it| *it > scatter),
            discrepancy: shown(|quantity| told(quantity, standard_deviation[quantity])),
            noise: shown(|quantity| told(quantity, noise[quantity])),
            residuals: Measured::of(|quantity| is_told(quantity).then_some(attribution[quantity])).into(),
            freedom: Measured::of(|quantity| is_finite(quantity).then_some(freedom[quantity])).into(),
            lag_one_correlation: lag_one,
            measured: ExpectedEntry::of(expected.measured.as_ref()?),
            range: ExpectedEntry::of(expected.range.as_ref()?),
            held_out: judged.map(held_out),
            bootstrap: bootstrap.map(BootstrapEntry::of),
            parts: expected
                .parts
                .iter()
                .map(|part| RangeEntry {
                    joint: robot.joints[part.joint].name.clone(),
                    from: part.range[0],
                    to: part.range[1],
                    sigma_position_mm: part.sigma_m * 1e3,
                })
                .collect(),
            length_m: found.length_m,
            axes: found.estimate.base_from_axis.iter().map(PoseEntry::from).collect(),
            targets: targets.iter().map(|it| (it.name.clone().unwrap_or_default(), it.is_frame)).collect(),
            correlations: tells_correlations.then(|| {
                let covariance: Vec<f64> = kept
                    .iter()
                    .flat_map(|&i| kept.iter().map(|&j| covariance[i * n + j]).collect::<Vec<_>>())
                    .collect();
                CorrelationsEntry::of(&covariance, &unknowns)
            }),
            unknowns,
            frame_about_m: about,
            covariance_m2: upper(&covariance),
            covariance_outside_m2: found.covariance_outside.as_deref().map(|it| upper(&turned(it))),
        })
    }
}

impl UncertaintyEntry {
    /// Model error and noise. A quantity of which nothing is told has those of another of its unit.
    fn model_error(&self) -> Discrepancy {
        let teller = |quantity: Quantity| {
            let is_told = |other: &Quantity| self.discrepancy.get(*other).is_some();
            let like = |other: &Quantity| other.unit() == quantity.unit() && is_told(other);
            Some(quantity)
                .filter(is_told)
                .or_else(|| Quantity::ALL.into_iter().find(like))
                .unwrap_or(quantity)
        };
        let noise = |keyed: &Measured<f64>| {
            let shown = |quantity: Quantity| keyed.get(teller(quantity)).unwrap_or_default();
            ByQuantity::from_fn(|quantity| quantity.unit().from_shown(shown(quantity)))
        };
        let attribution = |quantity| self.residuals.get(teller(quantity)).unwrap_or(Attribution::Robot);
        let freedom = |quantity| self.freedom.get(teller(quantity)).unwrap_or(f64::INFINITY);
        Discrepancy {
            scatter: self.inflation,
            extrapolation: self.extrapolation.unwrap_or(self.inflation),
            standard_deviation: noise(&self.discrepancy),
            noise: noise(&self.noise),
            attribution: ByQuantity::from_fn(attribution),
            freedom: ByQuantity::from_fn(freedom),
            lag_one: self.lag_one_correlation,
        }
    }
}

impl CalibrationFile {
    /// Uncertainty of predictions, and the index in it of each of some targets; `None` is the tip.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if the calibration holds no valid uncertainty.
    pub fn uncertainty(&self, targets: &[Option<&str>]) -> Result<(Uncertainty, Vec<usize>)> {
        self.uncertainty_from(targets, &self.robot()?, Body::Base)
    }

    /// Standard deviation of a joint's term by its name, radians, metres or by value; `None` if it is no unknown.
    pub(crate) fn sigma(&self, term: &str) -> Option<f64> {
        let entry = self.uncertainty.as_ref()?;
        let at = entry.unknowns.iter().position(|name| name == term)?;
        let (joint, name) = term.rsplit_once('.')?;
        let kind = self.joints.iter().find(|entry| entry.name == joint)?.kind;
        let term: Term = name.parse().ok()?;
        let n = entry.unknowns.len();
        // The diagonal of an upper triangle by rows.
        let variance = entry.covariance_m2.get(at * n - at * at.saturating_sub(1) / 2)?;
        Some(variance.max(0.0).sqrt() / kind.unit_of(term).metres(entry.length_m))
    }

    /// Names of the unknowns, in the order of the covariance.
    ///
    /// # Errors
    /// As [`CalibrationFile::uncertainty`].
    pub fn unknowns(&self) -> Result<Vec<String>> {
        let (found, _) = self.uncertainty(&[])?;
        let robot = self.robot()?;
        let mut unknowns = vec![String::new(); found.layout.dim()];
        let names = self.uncertainty.as_ref().map(|entry| entry.names(&robot, self.first_station()));
        for (parameter, places) in found.layout.parameters() {
            let own = names.iter().flat_map(|names| names.of_unknowns(parameter));
            for (&(place, _), name) in places.iter().zip(own) {
                if let Some(unknown) = unknowns.get_mut(place) {
                    *unknown = name;
                }
            }
        }
        Ok(unknowns)
    }

    /// The same of predictions from a body of the robot.
    pub(super) fn uncertainty_from(
        &self,
        targets: &[Option<&str>],
        robot: &Robot,
        body: Body,
    ) -> Result<(Uncertainty, Vec<usize>)> {
        let bad = |what: &str| {
            let message = format!(
                "found {what}, expected the uncertainty that `poecal calibrate` writes: calibrate again with this version"
            );
            Error::new(ErrorKind::Model, message)
        };
        let entry = self.uncertainty.as_ref().ok_or_else(|| {
            let message = "found a calibration without uncertainty, expected more measurements than unknowns to estimate it from: \
                           calibrate with more configurations, or hold out fewer";
            Error::new(ErrorKind::Model, message)
        })?;
        let axes = entry.axes.iter().map(PoseEntry::pose).collect::<Result<Vec<_>>>()?;
        if axes.len() != robot.joints.len() {
            return Err(bad("another number of axes than of joints"));
        }
        let tree = Tree::new(robot, vec![Stand::On(body)], Vec::new());
        let mut estimate = Estimate::on(robot, tree, Vec::new(), self.base_from_device()?.inverse());
        estimate.base_from_axis = axes;
        estimate.terms.clone_from(&robot.terms);
        let mut free = entry.joint_parameters(robot, self.first_station());
        let is_known = |name: &str| self.targets.contains_key(name);
        let place = robot.places_of_targets();
        let names = entry.names(robot, self.first_station());
        for (index, (name, is_frame)) in entry.targets.iter().enumerate() {
            if !name.is_empty() && !is_known(name) {
                return Err(bad("the uncertainty of an unknown target"));
            }
            let (body, pose) = place(Some(name));
            estimate = estimate.with_target(body, pose);
            let usual = if *is_frame { Freedom::FRAME } else { Freedom::PLACE };
            let freedom = entry.freedom(&names.of(Block::Target(index))).unwrap_or(usual);
            free.push(if freedom == Freedom::PLACE {
                Parameter::TargetPlace(TargetPlace { target: index })
            } else {
                Parameter::TargetFrame(TargetFrame { target: index, freedom })
            });
        }
        if !entry.unknowns.is_empty() {
            let is_unknown = |parameter: &Parameter| {
                names.of_unknowns(parameter).iter().all(|name| entry.unknowns.contains(name))
            };
            free.retain(is_unknown);
        }
        let mut points = Vec::new();
        let mut index = |wanted: &Option<&str>| {
            let wanted = wanted.unwrap_or_default();
            entry.targets.iter().position(|(name, _)| name == wanted).unwrap_or_else(|| {
                // A point on a link that was not measured itself is as certain as the link.
                let (body, pose) = place(Some(wanted));
                estimate = estimate.with_target(body, pose);
                let target = estimate.base_from_target.len() - 1;
                let joint = body.joint().map(|joint| robot.joints[joint].give_of.unwrap_or(joint));
                points.extend(joint.map(|joint| (target, joint)));
                target
            })
        };
        let indices = targets.iter().map(&mut index).collect();
        let layout = Layout::new(free, entry.length_m);
        let n = layout.dim();
        let outside = entry.covariance_outside_m2.as_ref();
        let is_whole = |upper: &Vec<f64>| upper.len() == n * (n + 1) / 2;
        if !is_whole(&entry.covariance_m2) || !outside.is_none_or(is_whole) {
            return Err(bad("a covariance of another size than the unknowns make"));
        }
        let is_covariance = |upper: &Vec<f64>| {
            let of_row = |row: usize| row * n - row * row.saturating_sub(1) / 2;
            upper.iter().all(|it| it.is_finite()) && (0..n).all(|row| upper[of_row(row)] >= 0.0)
        };
        if !is_covariance(&entry.covariance_m2) || !outside.is_none_or(is_covariance) {
            return Err(bad("a negative variance, or one that is no number"));
        }
        let mut covariances = (symmetric(&entry.covariance_m2, n), outside.map(|upper| symmetric(upper, n)));
        let mut layout = layout;
        if let Some(found) = LinkPoints::new(&estimate, &layout, &points) {
            covariances =
                (found.covariance(&covariances.0), covariances.1.map(|outside| found.covariance(&outside)));
            layout = found.layout;
        }
        let uncertainty = Uncertainty {
            estimate,
            layout,
            covariance: covariances.0,
            covariance_outside: covariances.1,
            sampled: self.coverage.iter().map(|it| [it.sampled_min, it.sampled_max]).collect(),
            discrepancy: entry.model_error(),
            length_m: entry.length_m,
        };
        Ok((uncertainty, indices))
    }
}

impl UncertaintyEntry {
    /// Parameters of the first device frame and the joints that may be among the unknowns, in the order of a fit.
    fn joint_parameters(&self, robot: &Robot, first_station: Option<&str>) -> Vec<Parameter> {
        let block = first_station.map_or_else(|| "frame".to_owned(), |name| format!("frame.{name}"));
        let freedom = self.freedom(&block).unwrap_or(Freedom::FRAME);
        let of = |about: [f64; 3]| DeviceFrame { station: 0, about: about.into(), freedom };
        let frame = self.frame_about_m.map(|about| Parameter::DeviceFrame(of(about)));
        let kinds: Vec<JointKind> = robot.joints.iter().map(|joint| joint.kind).collect();
        let terms = self.unknowns.iter().filter_map(|name| {
            let (joint, term) = name.rsplit_once('.')?;
            let joint = robot.joints.iter().position(|it| it.name == joint)?;
            Some(Parameter::ValueTerm(ValueTerm { joint, kind: kinds[joint], term: term.parse().ok()? }))
        });
        frame.into_iter().chain(screw_axes(&kinds)).chain(terms).collect()
    }

    /// The motions of a frame that are among the unknowns, by the name of its block; `None` if none is.
    fn freedom(&self, block: &str) -> Option<Freedom> {
        const NAMES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
        let has = |motion: usize| {
            NAMES.get(motion).is_some_and(|name| self.unknowns.contains(&format!("{block}.{name}")))
        };
        Some(Freedom::of((0..NAMES.len()).filter(|&motion| has(motion)))).filter(|it| it.count() > 0)
    }

    /// The names by which unknowns are called.
    fn names(&self, robot: &Robot, first_station: Option<&str>) -> Names {
        let target = |(name, _): &(String, bool)| Some(name.clone()).filter(|name| !name.is_empty());
        Names {
            joints: robot.joints.iter().map(|joint| joint.name.clone()).collect(),
            targets: self.targets.iter().map(target).collect(),
            stations: vec![first_station.map(str::to_owned)],
        }
    }
}

/// A symmetric matrix from its upper triangle by rows.
fn symmetric(upper: &[f64], n: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; n * n];
    let places = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
    for ((i, j), &value) in places.zip(upper) {
        matrix[i * n + j] = value;
        matrix[j * n + i] = value;
    }
    matrix
}
