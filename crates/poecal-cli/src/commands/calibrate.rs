//! `poecal calibrate`: from model and measurements to a calibrated robot.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use poecal_calibrate::{
    AcceptanceLimits, BlockChoice, Calibration, CalibrationOptions, CalibrationStage, Decision, Gain, Level,
    RepairLimits, RepairedSession, calibrate_repairing, settle_sets,
};
use poecal_formats::abb::AbbCalibration;
use poecal_import as measurements;
use poecal_import::ReadOptions;
use poecal_lou2009::{PaperResidual, to_formulation};
use poecal_model::measurement::{ByQuantity, Dataset, Quantity};
use poecal_model::robot::Tolerance;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_report::Detail;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::model::Model;
use poecal_results::output::{
    self, Contents, ExistingFiles, PagePieces, ReservedFile, ReservedFolder, Results, free_folder,
};
use poecal_results::record::Record;
use poecal_results::residuals::{ResidualRows, Residuals};
use poecal_results::shapes::Shapes;
use poecal_storage::named_files::{refuse_fitted, refuse_repeats};

use super::models::read_model;
use super::reproducing_command::command;
use crate::args::{Calibrate, ReportPlace};
use crate::console::Console;
use crate::quantity::BelievedTolerance;
use crate::style::{self, label_paragraph, printable_path};
use crate::timings::{self, Timings};
use crate::{DONE, WORSE};

pub(crate) fn calibrate(arguments: &Calibrate, typed: &[OsString], console: &Console) -> Result<u8> {
    if arguments.timings {
        timings::need_clocks()?;
    }
    let mut timings = Timings::start();
    let model_path = stated_model(arguments)?;
    let reading = arguments.reading.options();
    let mut model = read_model(model_path, &arguments.chain.selection(reading.as_ref().ok())?, console)?;
    model.robot = model.robot.with_factors(&arguments.factors)?;
    model.terms_left_out().iter().for_each(|note| console.note(note));
    let (data, inputs) = read_measurements(arguments, &model, reading, console)?;
    let out = folder(arguments);
    let places = CalibrateOutputs::reserve(arguments, &out, console)?;
    let inputs = Inputs { command: Some(command(typed)), ..inputs };
    let options = CalibrationOptions { devices: model.devices_of(&data), ..options(arguments, console)? };
    let record = record(arguments)?;
    let poses = data.observations.iter().any(|row| row.measurement.sees_orientation());
    if arguments.residual != PaperResidual::default() && !poses {
        console.warning(format!(
            "--residual {} has no effect: it is about measured frames, and there are none",
            arguments.residual.word()
        ));
    }
    timings.end("read");
    let bar = console.progress(CalibrationStage::ALL.len() as u64);
    let repaired = calibrate_repairing(&model.robot, &data, &options, &mut |stage| {
        let step = CalibrationStage::ALL.iter().position(|&other| other == stage).unwrap_or(0);
        bar.set(step as u64, stage.words());
        match stage {
            CalibrationStage::Registration | CalibrationStage::Fit => {}
            CalibrationStage::Corrections | CalibrationStage::Analysis => timings.end("start"),
        }
    });
    timings.end("analysis");
    bar.finish();
    let RepairedSession { calibration, data } = repaired?;
    let file = CalibrationFile { record, ..CalibrationFile::new(&calibration, &data, inputs) };
    let detail = if arguments.verbose { Detail::Full } else { Detail::Short };
    let text = if arguments.json {
        console.warnings(&doubts(&file));
        file.to_text()?
    } else {
        table(&file, detail, console)
    };
    let code = code(arguments, &calibration);
    let written = write((places, &out), arguments, (&model, &data, &calibration), file, console)?;
    timings.end("write");
    if arguments.timings {
        console.note(timings.line(|| calibration.solve_again(&data, &options)));
    }
    let told = if arguments.json { console.data_of(&text, &out) } else { console.say_of(&(text + &written), &out) };
    Ok(code.max(told))
}

/// The table, the option for more of it, and the next step.
fn table(file: &CalibrationFile, detail: Detail, console: &Console) -> String {
    if detail == Detail::Full {
        return report::summary(file, detail);
    }
    let short = report::short_summary(file, console.lines_said());
    let next = short.next.map_or_else(String::new, |next| label_paragraph("next", next));
    short.table + &label_paragraph("more", &format!("--verbose: {}", short.left)) + &next
}

/// All warnings and diagnoses: people do not read those in the JSON.
fn doubts(file: &CalibrationFile) -> Vec<String> {
    let found = file.diagnosis.iter().map(|diagnosis| &diagnosis.statement);
    file.warnings.iter().chain(found).cloned().collect()
}

/// Exit code after a written calibration.
fn code(arguments: &Calibrate, calibration: &Calibration) -> u8 {
    let level = calibration.verdict.level;
    let worse = arguments.require.is_some_and(|required| level < required);
    let has_no_gain = arguments.require_gain && calibration.verdict.gain != Some(Gain::Clear);
    let converged = calibration.solver.termination.is_success();
    let refused = calibration.acceptance.as_ref().is_some_and(|it| it.decision != Decision::Pass);
    if worse || has_no_gain || refused || level == Level::DoNotUse || !converged { WORSE } else { DONE }
}

/// Statements about the session.
fn record(arguments: &Calibrate) -> Result<Record> {
    Record::from_pairs(arguments.record.iter().map(|(key, text)| (key.as_str(), text.as_str())))
}

/// The model, if it and measurements are named, by arguments or settings.
fn stated_model(arguments: &Calibrate) -> Result<&Path> {
    let missing = |what: &str| {
        ErrorKind::Option
            .refuse(format!("found no {what}, expected `poecal calibrate MODEL FILES…`, or settings that name both"))
    };
    match &arguments.model {
        None => missing("model"),
        Some(_) if arguments.measurements.is_empty() => missing("measurement file"),
        Some(model) => Ok(model),
    }
}

/// Reads and joins the files; with `--validate`, those rows are held out and all others fitted. Reports the input.
fn read_measurements(
    arguments: &Calibrate,
    model: &Model,
    reading: Result<ReadOptions>,
    console: &Console,
) -> Result<(Dataset, Inputs)> {
    refuse_repeats(&arguments.measurements)?;
    refuse_repeats(&arguments.validate)?;
    refuse_fitted(&arguments.validate, &arguments.measurements)?;
    // With --validate the files' roles determine the sets.
    let ignore_sets = !arguments.validate.is_empty();
    let options = model.reads(ReadOptions { ignore_sets, ..reading? });
    let meaning = arguments.reading.meaning.files();
    let mut inputs = Inputs {
        sha256: Inputs::checksums(std::iter::once(model.path.as_path()).chain(meaning))?,
        ..Inputs::of_model(model)
    };
    let mut read = |paths: &[PathBuf]| -> Result<Dataset> {
        let file = measurements::read(paths, &model.robot, &options)?;
        inputs.measurements.extend(paths.iter().map(|path| path.display().to_string()));
        console.said_of(&file);
        inputs.take(&file);
        Ok(file.data)
    };
    let mut data = read(&arguments.measurements)?;
    if !arguments.validate.is_empty() {
        data.judged_by(&read(&arguments.validate)?)?;
    }
    let stated_by = if !arguments.validate.is_empty() {
        "--validate"
    } else if arguments.reading.train_where.is_some() {
        "--train-where"
    } else {
        "a column of the files"
    };
    if settle_sets(&mut data, arguments.held_out, stated_by)? && arguments.seed.is_some() {
        console.warning("--seed has no effect on which rows are held out: that is stated");
    }
    Ok((data, inputs))
}

fn options(arguments: &Calibrate, console: &Console) -> Result<CalibrationOptions> {
    let usual = CalibrationOptions::default();
    let method = arguments.method.unwrap_or(arguments.formulation.usual_method());
    Ok(CalibrationOptions {
        frame: arguments.device_frame,
        blocks: BlockChoice { free: arguments.free.clone(), fix: arguments.fix.clone() },
        sigma: ByQuantity::default()
            .with_value(Quantity::Position, arguments.sigma_position)
            .with_value(Quantity::Rotation, arguments.sigma_rotation),
        tolerance: match &arguments.tolerance {
            BelievedTolerance::Given(tolerance) => Some(*tolerance),
            BelievedTolerance::Of(path) => Some(makers_tolerance(path, console)?),
            BelievedTolerance::None => None,
            BelievedTolerance::Auto => usual.tolerance,
        },
        chooses_tolerance: arguments.tolerance == BelievedTolerance::Auto,
        corrections: arguments.corrections,
        harmonics: arguments.harmonics,
        gravity: arguments.gravity,
        held_out: arguments.held_out,
        seed: arguments.seed.unwrap_or(usual.seed),
        robust: arguments.robust,
        move_tip: arguments.move_tip,
        repair: arguments.repair,
        repair_limits: RepairLimits::with_overrides(&arguments.repair_limit),
        accept: AcceptanceLimits::from_choice(arguments.accept.clone(), arguments.accept_model)?,
        formulation: to_formulation(arguments.formulation, arguments.residual, method),
        ..usual
    })
}

/// The tolerance from a maker's calibration of the arm.
fn makers_tolerance(path: &Path, console: &Console) -> Result<Tolerance> {
    let found = AbbCalibration::read(path)?;
    let tolerance = found.tolerance(path)?;
    let count: usize = found.arms.iter().map(|arm| arm.lengths_m.len() + arm.angles_rad.len()).sum();
    let gives = match found.joints.as_slice() {
        [] => String::new(),
        joints => {
            let names: Vec<&str> = joints.iter().map(|(name, _)| name.as_str()).collect();
            format!("; it also found compliance of {}, which --corrections sag fits", names.join(", "))
        }
    };
    console.note(format!(
        "tolerance {:.4} deg, {:.4} mm: the root mean squares of the {count} errors of axes that the maker found{gives}",
        tolerance.angle_rad.to_degrees(),
        tolerance.length_m * 1e3
    ));
    Ok(tolerance)
}

/// Folder of the results if none is named.
const FOLDER: &str = "poecal-out";

/// The folder of the results: a new one, unless it is named or may be overwritten.
fn folder(arguments: &Calibrate) -> PathBuf {
    match &arguments.out {
        Some(folder) => folder.clone(),
        None if arguments.existing() == ExistingFiles::Kept => free_folder(Path::new(FOLDER)),
        None => FOLDER.into(),
    }
}

/// Places of the results.
struct CalibrateOutputs {
    folder: ReservedFolder,
    /// A report outside the results.
    report: Option<ReservedFile>,
}

impl CalibrateOutputs {
    fn reserve(arguments: &Calibrate, out: &Path, console: &Console) -> Result<Self> {
        let (existing, inputs) = (arguments.existing(), arguments.inputs());
        let folder = ReservedFolder::reserve(out, Contents::Calibration, existing, &inputs, &mut console.warner())?;
        let report = match &arguments.report {
            Some(ReportPlace::File(path)) => folder.reserve_report(path, &inputs, &mut console.warner())?,
            Some(ReportPlace::None) | None => None,
        };
        Ok(CalibrateOutputs { folder, report })
    }
}

/// The report with the shapes of the robot, whose meshes are searched from the folder of the calibration; missing ones are noted.
pub(super) fn page(
    file: &CalibrationFile,
    rows: &Residuals,
    calibration: &Path,
    console: &Console,
) -> Result<PagePieces> {
    let shapes = Shapes::read(file, calibration);
    shapes.notes.iter().for_each(|note| console.remark(note));
    report::calibration_page_with(file, rows, &shapes)
}

/// Writes the results; returns their place.
fn write(
    (places, out): (CalibrateOutputs, &Path),
    arguments: &Calibrate,
    (model, data, calibration): (&Model, &Dataset, &Calibration),
    file: CalibrationFile,
    console: &Console,
) -> Result<String> {
    // Without a report, rows are computed while they are written.
    let place = &arguments.report;
    let residuals = (!matches!(place, Some(ReportPlace::None))).then(|| Residuals::from_calibration(data, calibration));
    let own = out.join("calibration.json");
    let report = residuals.as_ref().map(|rows| page(&file, rows, &own, console)).transpose()?;
    let residuals = residuals.as_ref().map_or(ResidualRows::Of(data, calibration), ResidualRows::AtHand);
    let results = Results { file, residuals, report };
    let written = output::write(places.folder, places.report, model, &calibration.robot_with_targets(), results)?;
    console.warnings(&written.notes);
    let has_report = written.files.iter().any(|name| *name == output::REPORT);
    let mut words = if has_report && !arguments.verbose {
        let beside = written.files.len() - 1;
        label_paragraph(
            "written",
            &format!("{}: open {}; {beside} files beside it", printable_path(&written.folder), output::REPORT),
        )
    } else {
        style::describe_written_files(&written.folder, &written.files)
    };
    if arguments.verbose {
        let text = format!(
            "read back within {:.1e} m and {:.1e} rad in 1,000 configurations",
            written.largest.position_m, written.largest.rotation_rad
        );
        words.push_str(&label_paragraph("", &text));
    }
    if let Some(ReportPlace::File(path)) = place
        && !has_report
    {
        words.push_str(&label_paragraph("report", &printable_path(path)));
    }
    Ok(words)
}
