//! A calibration file judged by other measurements.

use std::collections::BTreeMap;

use super::CalibrationFile;
use poecal_arm::lie::rotation;
use poecal_calibrate::{
    Acceptance, AcceptanceLimits, AcceptedModel, CoverageCheck, Improvement, JudgedCalibration, JudgedModel, Judgement,
    MovedDevice, PredictedUncertainty, QuantityCoverage, RefittedPart, accepted_by, improvement, judge,
};
use poecal_fit::start::faces_on_known_planes;
use poecal_fit::state::RangeModel;
use poecal_fit::uncertainty::Uncertainty;
use poecal_model::measurement::{Dataset, Quantity};
use poecal_model::robot::Body;
use poecal_numerics::distributions::f_quantile;
use poecal_numerics::error::{ErrorKind, Result};

/// Ratio to the calibration's own error above which a device frame that is not refitted must have moved.
const MOVED_DEVICE: f64 = 20.0;
/// Largest share of the error that remains if a refitted frame explains it; and the largest probability that the frame's unknowns do so by chance.
const MUCH: f64 = 0.7;
const CHANCE: f64 = 1e-4;
/// Share of errors inside their 95 % bound below which the bounds do not hold.
const BROKEN: f64 = 0.75;
/// Fewest rows inside the sampled range that show a change of the robot since its calibration.
const FEW: usize = 5;
/// Errors of exact data below this are rounding: a nanometre, in millimetres; of angles in degrees.
const ROUNDING: f64 = 1e-6;

impl CalibrationFile {
    /// Judges the calibration by all rows of some measurements, with device frame and targets refitted as asked.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`](poecal_numerics::error::ErrorKind::Problem) if the measurements are of other targets or instruments, or
    /// too few for the refit;
    /// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) if the file holds no valid calibration.
    pub fn judge(&self, data: &Dataset, refit_frame: bool, refit_tool: bool) -> Result<Judgement> {
        let judgement = self.judge_with_refits(data, refit_frame, refit_tool)?;
        let Some(file) = self.corrected_file() else { return Ok(judgement) };
        let Judgement { calibrated: errors, promised, in_sampled_range, rows, .. } =
            file.judge_with_refits(data, refit_frame, refit_tool)?;
        let corrected = Some(JudgedModel { errors, promised, in_sampled_range });
        Ok(Judgement { corrected, rows, ..judgement })
    }

    /// [`CalibrationFile::judge`] with the device's frame refitted if the rows show a moved device. They do if the error with the frame refitted is
    /// much smaller, and the bounds hold then. The decrease must exceed the effect of six unknowns (F test, 1 in 10,000). With `refits` the judgement
    /// is the refitted one; otherwise a note states the move.
    ///
    /// # Errors
    /// As [`CalibrationFile::judge`].
    pub fn judge_wherever(&self, data: &Dataset, refit_tool: bool, refits: bool) -> Result<Judgement> {
        let found = self.judge(data, false, refit_tool)?;
        // Too few rows for a frame do not show a move.
        let Ok(again) = self.judge(data, true, refit_tool) else { return Ok(found) };
        let [before, after] = [&found, &again].map(|it| it.delivered_model().errors.leading_value());
        let (Some((_, before)), Some((_, after))) = (before, after) else { return Ok(found) };
        let numbers: usize = data.observations.iter().map(|row| row.measurement.dim()).sum();
        let frames = 6.0 * data.station_count() as f64;
        let freedom = numbers as f64 - frames;
        let (square, less) = (before.rms.powi(2), after.rms.powi(2));
        let is_plain = freedom > 0.0 && before.rms > ROUNDING;
        let ratio = freedom / frames * (square - less) / less.max(f64::MIN_POSITIVE);
        let holds = again.delivered_model().promised.is_none_or(|it| it.least_inside() >= BROKEN);
        let is_certain = is_plain && holds && ratio >= f_quantile(CHANCE, frames, freedom);
        if !is_certain || after.rms > MUCH * before.rms {
            return Ok(found);
        }
        let apart = found.base_from_device.inverse() * again.base_from_device;
        let moved_device = Some(MovedDevice {
            shift_mm: 1e3 * (again.base_from_device.translation - found.base_from_device.translation).norm(),
            turn_deg: rotation::log(&apart.rotation).norm().to_degrees(),
            before_rms: before.rms,
            after_rms: after.rms,
            refitted: refits,
        });
        Ok(Judgement { moved_device, ..if refits { again } else { found } })
    }

    /// Ratio of the nominal model's error to the delivered one's on all rows of some measurements that were judged with these refits, device frame
    /// and targets fitted for both; `None` if the rows are too few for that.
    ///
    /// # Errors
    /// As [`CalibrationFile::judge`].
    pub fn improvement(&self, data: &Dataset, refit_frame: bool, refit_tool: bool) -> Result<Option<Improvement>> {
        let corrected = self.corrected_file();
        let file = corrected.as_ref().unwrap_or(self);
        file.with_subject(data, refit_frame, refit_tool, |subject, data| Ok(improvement(subject, data)))
    }

    /// Judges limits by all rows of some measurements, with device frame and targets refitted as asked: theory.md §9, *Acceptance*. `sha256`
    /// are the checksums of their files, none of which may be of the calibration itself.
    ///
    /// # Errors
    /// As [`CalibrationFile::judge`], and [`ErrorKind::Option`](poecal_numerics::error::ErrorKind::Option) if no row measured what a limit is for,
    /// [`ErrorKind::Problem`](poecal_numerics::error::ErrorKind::Problem) if the calibration was made of one of the files.
    pub fn accept(
        &self,
        data: &Dataset,
        refit_frame: bool,
        refit_tool: bool,
        limits: &AcceptanceLimits,
        sha256: &BTreeMap<String, String>,
    ) -> Result<Acceptance> {
        let names = self.inputs.measurements.iter().filter_map(|name| self.inputs.sha256.get(name));
        let seen: Vec<&String> = names.collect();
        if let Some((name, _)) = sha256.iter().find(|(_, sha256)| seen.contains(sha256)) {
            return ErrorKind::Problem.refuse(format!(
                "found `{name}`, which the calibration was made of, expected measurements that it has not seen: it was accepted or not by its own \
                 rows held out when it was made"
            ));
        }
        let corrected = if limits.model == AcceptedModel::Corrected { self.corrected_file() } else { None };
        let model = if corrected.is_some() { AcceptedModel::Corrected } else { AcceptedModel::Calibrated };
        let file = corrected.as_ref().unwrap_or(self);
        file.with_subject(data, refit_frame, refit_tool, |subject, data| accepted_by(subject, data, limits, model))
    }

    fn judge_with_refits(&self, data: &Dataset, refit_frame: bool, refit_tool: bool) -> Result<Judgement> {
        self.with_subject(data, refit_frame, refit_tool, judge)
    }

    /// Result of `to` for the calibration and the measurements that judge it.
    fn with_subject<T>(
        &self,
        data: &Dataset,
        refit_frame: bool,
        refit_tool: bool,
        to: impl FnOnce(&JudgedCalibration<'_>, &Dataset) -> Result<T>,
    ) -> Result<T> {
        let (calibrated, nominal) = (self.robot()?, self.nominal_robot()?);
        let shared = self.pictures.as_ref().map(|known| data.with_common(known.common_error()));
        let data = shared.as_deref().unwrap_or(data);
        if !refit_tool {
            self.check_targets(data)?;
        }
        let devices = if refit_frame { Vec::new() } else { self.devices_of(data)? };
        let usual = self.base_from_device()?;
        let (first, further) = devices.split_first().map_or((usual, &[][..]), |(first, further)| (*first, further));
        let range = |name: &Option<String>| {
            let own = self.stations.iter().find(|it| it.instrument == *name);
            let zero_m = own.and_then(|it| it.zero_mm).map_or(0.0, |zero| 1e-3 * zero);
            RangeModel { zero_m, scale: own.and_then(|it| it.scale).unwrap_or(0.0) }
        };
        let ranges: Vec<RangeModel> = data.stations.iter().map(range).collect();
        let turned = faces_on_known_planes(data, &calibrated, &devices);
        let data = &*turned;
        let noise = self.noise()?;
        // Refitted targets are not those of the calibration.
        let unnamed = self.unnamed_target();
        let known = data.targets.iter().map(|name| name.as_deref().or(unnamed)).filter(|_| !refit_tool);
        let names: Vec<Option<&str>> = known.collect();
        let found = if self.uncertainty.is_some() { Some(self.uncertainty_as_seen(&names)?) } else { None };
        let predicted = found.as_ref().map(|(uncertainty, targets)| PredictedUncertainty {
            uncertainty,
            targets,
            coverage: &self.coverage,
        });
        let subject = JudgedCalibration {
            calibrated: &calibrated,
            nominal: &nominal,
            base_from_device: first,
            further_base_from_device: further,
            ranges: &ranges,
            frame: self.frame(),
            noise,
            refit_frame,
            refit_tool,
            uncertainty: predicted,
        };
        to(&subject, data)
    }

    /// Uncertainty of predictions relative to the first instrument: they do not depend on a motion of both.
    fn uncertainty_as_seen(&self, targets: &[Option<&str>]) -> Result<(Uncertainty, Vec<usize>)> {
        let robot = self.robot()?;
        let first = self.stations.first().and_then(|station| station.instrument.as_ref());
        let mount = robot.instruments.iter().find(|mount| Some(&mount.name) == first);
        let body = mount.map_or(Body::Base, |mount| mount.body);
        self.uncertainty_from(targets, &robot, body)
    }

    /// Contradiction between a judgement and the calibration, as a sentence.
    #[must_use]
    pub fn doubt(&self, judgement: &Judgement) -> Option<String> {
        if let Some(moved) = judgement.moved_device.as_ref().filter(|it| !it.refitted) {
            return doubt_of_device(judgement, moved);
        }
        let delivered = judgement.delivered_model();
        let own = self.own_rms(delivered.model).max(ROUNDING);
        let (leading, found) = delivered.errors.leading_value()?;
        let (rms, unit) = (found.rms, leading.unit().symbol());
        let check = delivered.promised.filter(|_| rms > ROUNDING);
        // If most errors are inside their bounds, single rows are wrong, not the device.
        let mostly = check.is_some_and(|it| it.parts.lead().inside_bound95 > 0.5);
        let is_far = rms > MOVED_DEVICE * own;
        if mostly && is_far {
            return Some(format!(
                "most errors are inside their 95 % bounds, the largest is {:.2} {unit}: some measurements are gross errors",
                found.max
            ));
        }
        let refit_frame = judgement.refitted.contains(&RefittedPart::DeviceFrame);
        let broken = check.filter(|it| it.least_inside() < BROKEN);
        let Some(check) = broken else {
            return (check.is_none() && is_far && !refit_frame).then(|| moved_words(leading, rms, own));
        };
        let exceeding = describe_exceeding(check);
        let inside = delivered.in_sampled_range;
        let Some(some) = inside.filter(|some| some.count >= FEW.min(judgement.count)) else {
            let moved = if refit_frame { "" } else { ". If the device was set up again, add `--refit device`" };
            let lie = match inside.map_or(0, |some| some.count) {
                0 => "no row lies".to_owned(),
                1 => "only 1 row lies".to_owned(),
                count => format!("only {count} rows lie"),
            };
            return Some(format!(
                "{lie} inside the range that was sampled for the calibration, and {exceeding} exceed their 95 % bound: these \
                 rows lie outside the calibrated range and do not fit{moved}"
            ));
        };
        if some.promised.least_inside() >= BROKEN {
            return Some(format!(
                "the errors of the {} inside the sampled range are as expected; outside it the calibration does not hold \
                 ({exceeding} in all exceed their 95 % bound)",
                if some.count == 1 { "1 row".to_owned() } else { format!("{} rows", some.count) }
            ));
        }
        if !refit_frame && is_far {
            return Some(moved_words(leading, rms, own));
        }
        let place = if check.inside_sampled_range < 1.0 { " inside the sampled range" } else { "" };
        Some(format!(
            "{}{place} exceed their 95 % bound: the robot, its tool or the measuring device is not as it was calibrated, or orientations \
             are written in another form",
            self::describe_exceeding(&some.promised)
        ))
    }
}

/// Shares of errors beyond their bounds.
fn describe_exceeding(check: &CoverageCheck) -> String {
    let share = |part: QuantityCoverage| 100.0 * (1.0 - part.inside_bound95);
    let words =
        check.parts.iter().map(|(quantity, part)| format!("{:.0} % of the {} errors", share(part), quantity.name()));
    words.collect::<Vec<_>>().join(" and ")
}

fn moved_words(leading: Quantity, rms: f64, own: f64) -> String {
    let (name, unit, times) = (leading.name(), leading.unit().symbol(), rms / own);
    format!(
        "the {name} error is {times:.0} times that of the calibration itself ({rms:.2e} {unit}, {own:.2e} {unit}): \
         if the measuring device was moved, refit its frame with --refit device"
    )
}

/// The sentence on a device that was moved since the calibration.
fn doubt_of_device(judgement: &Judgement, moved: &MovedDevice) -> Option<String> {
    let (quantity, _) = judgement.delivered_model().errors.leading_value()?;
    let (name, unit) = (quantity.name(), quantity.unit().symbol());
    Some(format!(
        "the device stands {:.3} mm and {:.4} deg from where the calibration has it: with its frame refitted the {name} error is {:.4} {unit} \
         instead of {:.4} {unit} (RMS); judge the robot by --refit device, or let --refit auto do so",
        moved.shift_mm, moved.turn_deg, moved.after_rms, moved.before_rms
    ))
}
