//! The report of a calibration: one HTML page that holds its style, its script and its data, and loads nothing.
//!
//! Each file is a part of the page. No HTML as strings: maud writes and escapes it, and `text::visible_markup` is applied to the whole. Each figure
//! has its key of `calibration.json`, except sums over the rows of `residuals.csv`. Style and script are built from `web/src` into `assets/`. The
//! script draws the page's data, with kinematics for that, and needs no network.

mod advice;
mod answer;
mod certificate;
mod charts;
mod compensation;
mod corners;
mod corrected_model;
mod data;
mod devices;
mod errors;
mod figures;
mod fleet;
mod frames;
mod html;
mod joins;
mod joints;
mod leading_error;
mod method;
mod paper;
mod pictures;
mod plan;
mod ranges;
mod repairs;
mod rows;
mod shapes;
mod sides;
mod tested;
mod trust;
mod validation;

pub use fleet::fleet_page;
pub use paper::{CertificateExtras, certificate_page, test_certificate_page, visit_page};
pub use plan::plan_page;
pub use tested::test_page;
pub use validation::validation_page;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use poecal_calibrate::Statistic;
use poecal_model::robot::ReadingKind;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::text::visible_markup;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::output::PagePieces;
use poecal_results::record::Record;
use poecal_results::residuals::Residuals;
use poecal_results::shapes::Shapes;

/// Style and script, built from `web/` by `npm run build`.
const STYLE: &str = include_str!("assets/report.css");
const SCRIPT: &str = include_str!("assets/report.js");
/// Relative difference that sums of the same rows may have: rounding.
const SAME: f64 = 1e-9;
/// Permissions of a browser for the page: nothing is loaded from anywhere.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

/// The report of a calibration as a self-contained HTML page, made without opening any file: from the shapes in a URDF it has boxes, cylinders and
/// spheres. All of it can be read without its script, which adds the robot in three dimensions and names the element under the cursor in charts. The
/// page comes in pieces, since most of it is the same for every calibration.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::{CalibrationOptions, calibrate};
/// #     pub use poecal_results::calibration_file::{CalibrationFile, Inputs};
/// #     pub use poecal_results::residuals::Residuals;
/// #     pub use poecal_model::simulate;
/// #     pub use poecal_model::simulate::Simulation;
/// # }
/// use poecal::{CalibrationOptions, calibrate, CalibrationFile, Inputs, Residuals, Simulation};
/// use poecal::simulate::{SessionKind, elbow};
/// let made = Simulation::default().run(&elbow(), SessionKind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
/// let page = poecal_report::calibration_page(&file, &Residuals::from_calibration(&made.data, &calibration))?.concat();
/// assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<h1>"));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
///
/// # Errors
/// [`ErrorKind::Problem`] if the residuals are not those of this calibration, [`ErrorKind::Model`] if the file has been changed into no
/// calibration.
pub fn calibration_page(file: &CalibrationFile, residuals: &Residuals) -> Result<PagePieces> {
    calibration_page_with(file, residuals, &Shapes::from_calibration(file))
}

/// [`calibration_page`] with the shapes of the robot: [`Shapes::read`] reads the meshes that its URDF names.
///
/// # Errors
/// As [`calibration_page`].
pub fn calibration_page_with(file: &CalibrationFile, residuals: &Residuals, shapes: &Shapes) -> Result<PagePieces> {
    check(file, residuals)?;
    let drawn = data::drawn_rows(residuals);
    let data = data::json(file, residuals, shapes, &drawn)?;
    let charts = charts::Charts::new(residuals, &drawn);
    let title = format!("Calibration of {}", file.robot.name);
    let head = head(&title, &file.record, &file.poecal_version);
    let body = html! {
        a.skip href="#main" { "Skip to the verdict" }
        main #main {
            (paper::first_page(file))
            (answer::screen(file, shapes))
            (errors::section(file, residuals))
            (repairs::sections(file))
            (joints::corrections(file))
            (corrected_model::sections(file))
            (compensation::sections(file))
            (pictures::sections(file, residuals))
            (rows::sections(file, &charts)?)
            (trust::sections(file))
            (method::sections(file))
            (for_the_metrologist(file, &charts))
        }
    };
    Ok(vec![
        visible_markup(head).into(),
        visible_markup(body).into(),
        "\n<script type=\"application/json\" id=\"report-data\">".into(),
        data.into(),
        "</script>\n<script>\n".into(),
        SCRIPT.into(),
        "</script>\n</body>\n</html>\n".into(),
    ])
}

/// Details for few readers, folded.
fn for_the_metrologist(file: &CalibrationFile, charts: &charts::Charts<'_>) -> Markup {
    html! {
        section aria-labelledby="metrologist-title" {
            details #metrologist {
                summary { h2 #metrologist-title { "For the metrologist" } }
                (corrected_model::tried_sizes_table(file))
                (trust::for_the_metrologist(file))
                h3 { "Distribution and weight of the rows" }
                (rows::for_the_metrologist(charts))
                (method::for_the_metrologist(file))
            }
        }
    }
}

/// A page up to its body: title, policy, style, and the margins of its print.
fn head(title: &str, record: &Record, version: &str) -> Markup {
    html! {
        (DOCTYPE) "\n" (PreEscaped("<html lang=\"en\">")) "\n"
        head {
            meta charset="utf-8";
            meta http-equiv="Content-Security-Policy" content=(POLICY);
            meta name="viewport" content="width=device-width, initial-scale=1";
            meta name="color-scheme" content="light dark";
            meta name="generator" content={ "poecal " (version) };
            title { (title) }
            style { (PreEscaped(STYLE)) }
            (certificate::pages(title, record, version))
        }
        "\n" (PreEscaped("<body>")) "\n"
    }
}

/// Refuses residuals of another calibration.
fn check(file: &CalibrationFile, residuals: &Residuals) -> Result<()> {
    let refused = |words: String| {
        ErrorKind::Problem.refuse(format!("found residuals {words}: name the residuals.csv that was written with it"))
    };
    let held_out = residuals.rows().iter().filter(|row| row.held_out).count();
    let found = (residuals.rows().len() - held_out, held_out);
    let accuracy = &file.accuracy;
    let expected = (accuracy.training.count, accuracy.held_out.as_ref().map_or(0, |set| set.count));
    if found != expected {
        return refused(format!(
            "of {} rows fitted and {} held out, expected {} and {} as in the calibration",
            found.0, found.1, expected.0, expected.1
        ));
    }
    for joint in &file.joints {
        if reading_index(residuals, &joint.reading.name).is_none() {
            return refused(format!(
                "without the reading of `{}`, expected a column for each joint of the calibration",
                joint.reading.name
            ));
        }
    }
    for (quantity, expected) in accuracy.training.calibrated.iter() {
        let fitted = residuals.rows().iter().filter(|row| !row.held_out);
        let errors = fitted.filter_map(|row| Some(row.errors.get(quantity)?.calibrated_error())).collect();
        let found = Statistic::from_errors(errors).map_or(0.0, |it| it.rms);
        let (expected, unit) = (expected.rms, quantity.unit().symbol());
        if (found - expected).abs() > SAME * expected {
            return refused(format!(
                "of {found:.6} {unit} (RMS) on the fitted rows, expected {expected:.6} {unit} as in the calibration"
            ));
        }
    }
    Ok(())
}

/// Index of a reading among the columns of the residuals.
fn reading_index(residuals: &Residuals, name: &str) -> Option<usize> {
    residuals.readings.iter().position(|(known, _)| known == name)
}

/// The joint readings: index among the columns of the residuals, name and unit.
fn readings_of(residuals: &Residuals) -> impl Iterator<Item = (usize, &str, &'static str)> {
    let all = residuals.readings.iter().enumerate();
    all.filter_map(|(index, (name, kind))| Some((index, name.as_str(), unit(*kind)?)))
}

/// The unit of a joint's reading; `None` for a factor.
fn unit(kind: ReadingKind) -> Option<&'static str> {
    match kind {
        ReadingKind::Angle => Some("°"),
        ReadingKind::Length => Some("mm"),
        ReadingKind::Factor => None,
    }
}

/// A file's name without its folders, if no other file has that name.
fn short_name<'a>(files: &[String], file: &'a str) -> &'a str {
    let name = |path: &str| path.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    let own = name(file);
    let same = files.iter().filter(|other| name(other) == own).count();
    if same == 1 { &file[file.len() - own.len()..] } else { file }
}
