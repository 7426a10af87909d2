//! Uncertainty of predictions from the statements of `calibration.json`.

use super::link::LinkPoints;
use super::{CalibrationFile, PoseEntry, UncertaintyEntry};
use poecal_arm::lie::Freedom;
use poecal_fit::analysis::Cause;
use poecal_fit::parameters::{
    Block, BlockNames, DeviceFrame, Parameter, TargetFrame, TargetPlace, ValueTerm, screw_axes,
};
use poecal_fit::problem::Layout;
use poecal_fit::state::{Estimate, InstrumentMount, KinematicTree};
use poecal_fit::uncertainty::{Attribution, Discrepancy, Uncertainty};
use poecal_model::measurement::{ByQuantity, MeasuredQuantities, Quantity};
use poecal_model::robot::{Body, JointKind, Robot, Term};
use poecal_numerics::error::{Error, ErrorKind, Result};

impl UncertaintyEntry {
    /// Model error and noise. A quantity without a statement has those of another quantity of its unit.
    fn model_error(&self) -> Discrepancy {
        let teller = |quantity: Quantity| {
            let is_told = |other: &Quantity| self.discrepancy.get(*other).is_some();
            let like = |other: &Quantity| other.unit() == quantity.unit() && is_told(other);
            Some(quantity).filter(is_told).or_else(|| Quantity::ALL.into_iter().find(like)).unwrap_or(quantity)
        };
        let noise = |keyed: &MeasuredQuantities<f64>| {
            let shown = |quantity: Quantity| keyed.get(teller(quantity)).unwrap_or_default();
            ByQuantity::from_fn(|quantity| quantity.unit().from_shown(shown(quantity)))
        };
        let attribution = |quantity| self.residuals.get(&teller(quantity)).copied().unwrap_or(Attribution::Robot);
        let freedom = |quantity| self.freedom.get(&teller(quantity)).copied().unwrap_or(f64::INFINITY);
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

    /// True if a term of a joint, as `joint2.offset`, is not determined, since another free unknown has the same effect. Its written value is then
    /// the one nearest to the model.
    #[must_use]
    pub fn is_open(&self, term: &str) -> bool {
        let found = &self.identifiability;
        let Some((joint, _)) = term.rsplit_once('.').filter(|(_, name)| *name == Term::OFFSET.to_string()) else {
            return false;
        };
        let hidden = found.unidentifiable.iter().chain(&found.structural).filter(|it| it.cause == Cause::JointOffsets);
        hidden.flat_map(|it| &it.joints).any(|name| name == joint)
    }

    /// Standard deviation of a joint's term by its name, radians, metres or by value; `None` if it is no unknown.
    pub fn sigma(&self, term: &str) -> Option<f64> {
        let entry = self.uncertainty.as_ref().filter(|_| !self.is_open(term))?;
        let at = entry.unknowns.iter().position(|name| name == term)?;
        let (joint, name) = term.rsplit_once('.')?;
        let kind = self.joints.iter().find(|entry| entry.name == joint)?.kind;
        let term: Term = name.parse().ok()?;
        let n = entry.unknowns.len();
        let variance = entry.covariance_m2.get(diagonal(at, n))?;
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

    /// Uncertainty of predictions from a body of the robot, and the index in it of each of some targets.
    pub(crate) fn uncertainty_from(
        &self,
        targets: &[Option<&str>],
        robot: &Robot,
        body: Body,
    ) -> Result<(Uncertainty, Vec<usize>)> {
        let entry = self.uncertainty.as_ref().ok_or_else(|| ErrorKind::Model.error(NONE))?;
        let axes = entry.axes.iter().map(PoseEntry::pose).collect::<Result<Vec<_>>>()?;
        if axes.len() != robot.joints.len() {
            return Err(bad("another number of axes than of joints"));
        }
        let tree = KinematicTree::new(robot, vec![InstrumentMount::On(body)], Vec::new());
        let mut estimate = Estimate::from_placed(robot, tree, Vec::new(), self.base_from_device()?.inverse());
        estimate.base_from_axis = axes;
        estimate.terms.clone_from(&robot.terms);
        let place = robot.places_of_targets();
        for (name, _) in &entry.targets {
            if !name.is_empty() && !self.targets.contains_key(name) {
                return Err(bad("the uncertainty of an unknown target"));
            }
            let (body, pose) = place(Some(name));
            estimate = estimate.with_target(body, pose);
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
        let mut layout = Layout::new(entry.parameters(robot, self.first_station()), entry.length_m);
        let n = layout.dim();
        let outside = entry.covariance_outside_m2.as_ref();
        std::iter::once(&entry.covariance_m2).chain(outside).try_for_each(|upper| check(upper, n))?;
        let mut covariance = symmetric_from_upper(&entry.covariance_m2, n);
        let mut covariance_outside = outside.map(|upper| symmetric_from_upper(upper, n));
        if let Some(found) = LinkPoints::new(&estimate, &layout, &points) {
            covariance = found.covariance(&covariance);
            covariance_outside = covariance_outside.map(|outside| found.covariance(&outside));
            layout = found.layout;
        }
        let uncertainty = Uncertainty {
            estimate,
            layout,
            covariance,
            covariance_outside,
            size_sigma: None,
            sampled: self.coverage.iter().map(|it| [it.sampled_min, it.sampled_max]).collect(),
            discrepancy: entry.model_error(),
            length_m: entry.length_m,
        };
        Ok((uncertainty, indices))
    }
}

impl UncertaintyEntry {
    /// The unknowns, in the order of a fit.
    fn parameters(&self, robot: &Robot, first_station: Option<&str>) -> Vec<Parameter> {
        let names = self.names(robot, first_station);
        let target = |(target, (_, is_frame)): (usize, &(String, bool))| {
            let usual = if *is_frame { Freedom::FRAME } else { Freedom::PLACE };
            match self.freedom(&names.name_of_block(Block::Target(target))).unwrap_or(usual) {
                Freedom::PLACE => Parameter::TargetPlace(TargetPlace { target }),
                freedom => Parameter::TargetFrame(TargetFrame { target, freedom }),
            }
        };
        let is_unknown = |parameter: &Parameter| {
            self.unknowns.is_empty() || names.of_unknowns(parameter).iter().all(|name| self.unknowns.contains(name))
        };
        let of_joints = self.joint_parameters(robot, first_station).into_iter();
        of_joints.chain(self.targets.iter().enumerate().map(target)).filter(is_unknown).collect()
    }

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
        let has =
            |motion: usize| NAMES.get(motion).is_some_and(|name| self.unknowns.contains(&format!("{block}.{name}")));
        Some(Freedom::from_motions((0..NAMES.len()).filter(|&motion| has(motion)))).filter(|it| it.count() > 0)
    }

    /// Naming of the unknowns.
    fn names(&self, robot: &Robot, first_station: Option<&str>) -> BlockNames {
        let target = |(name, _): &(String, bool)| Some(name.clone()).filter(|name| !name.is_empty());
        BlockNames {
            joints: robot.joints.iter().map(|joint| joint.name.clone()).collect(),
            targets: self.targets.iter().map(target).collect(),
            stations: vec![first_station.map(str::to_owned)],
        }
    }
}

/// Message for a file without uncertainty.
const NONE: &str = "found a calibration without uncertainty, expected more measurements than unknowns to estimate it from: calibrate with \
                    more configurations, or hold out fewer";

/// An error of a file that states no uncertainty that can be used.
fn bad(what: &str) -> Error {
    ErrorKind::Model.error(format!(
        "found {what}, expected the uncertainty that `poecal calibrate` writes: calibrate again with this version"
    ))
}

/// Index of a row's diagonal element in an upper triangle by rows.
fn diagonal(row: usize, n: usize) -> usize {
    row * n - row * row.saturating_sub(1) / 2
}

/// Refuses numbers that are no covariance of `n` unknowns, an upper triangle by rows.
fn check(upper: &[f64], n: usize) -> Result<()> {
    if upper.len() != n * (n + 1) / 2 {
        return Err(bad("a covariance of another size than the unknowns make"));
    }
    if !upper.iter().all(|it| it.is_finite()) || (0..n).any(|row| upper[diagonal(row, n)] < 0.0) {
        return Err(bad("a negative variance, or one that is no number"));
    }
    Ok(())
}

/// A symmetric matrix from its upper triangle by rows.
pub(crate) fn symmetric_from_upper(upper: &[f64], n: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; n * n];
    let places = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
    for ((i, j), &value) in places.zip(upper) {
        matrix[i * n + j] = value;
        matrix[j * n + i] = value;
    }
    matrix
}
