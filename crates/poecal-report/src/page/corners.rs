//! Errors of the corners of pictures.

use maud::{Markup, Render, html};

use super::html::{HtmlTable, figure};
use crate::summary::{LeadingRows, ModelRow};
use poecal_calibrate::{PixelAccuracy, SetAccuracy};
use poecal_results::calibration_file::CalibrationFile;

/// A statistic of corners: its column, its name in the file, and its value.
type CornerStatistic = (&'static str, &'static str, fn(&PixelAccuracy) -> f64);

/// The statistics of a table.
const COLUMNS: [CornerStatistic; 6] = [
    ("mean, px", "mean_px", |it| it.mean_px),
    ("median, px", "median_px", |it| it.median_px),
    ("RMS, px", "rms_px", |it| it.rms_px),
    ("max, px", "max_px", |it| it.max_px),
    ("median picture, px", "median_picture_px", |it| it.median_picture_px),
    ("RMS at the board, mm", "rms_mm", |it| it.rms_mm),
];

/// True if all rows of a set are pictures.
pub(crate) fn are_all(set: &SetAccuracy) -> bool {
    set.calibrated.of_pictures(set.count).is_some()
}

/// Errors of corners by each model; `None` without pictures.
pub(crate) fn table(rows: &[ModelRow<'_>], on: &str) -> Option<HtmlTable> {
    let caption = format!("Distance of corners {on} from where the model sees them");
    let heads: Vec<&str> = std::iter::once("").chain(COLUMNS.map(|(head, ..)| head)).collect();
    let mut table = HtmlTable::new(&caption, 1, &heads);
    let mut has_any = false;
    for (name, model, key) in rows {
        let Some(pixels) = model.pixels else { continue };
        let cells = COLUMNS.map(|(_, word, value)| figure(value(&pixels), format_args!("{key}.pixels.{word}")));
        table.cells(std::iter::once(name.render()).chain(cells));
        has_any = true;
    }
    has_any.then_some(table)
}

/// Errors of the corners of pictures that were held out, or else of those fitted.
pub(crate) fn fact(file: &CalibrationFile) -> Option<Markup> {
    let leading = LeadingRows::from_calibration(file);
    let [before, after] = leading.ends()?;
    let (Some(was), Some(is)) = (before.1.pixels, after.1.pixels) else { return None };
    let [of_before, of_after] = [&before.2, &after.2];
    Some(html! {
        (figure(was.rms_px, format_args!("{of_before}.pixels.rms_px"))) " px before, "
        (figure(is.rms_px, format_args!("{of_after}.pixels.rms_px"))) " px after (RMS), "
        (figure(is.rms_mm, format_args!("{of_after}.pixels.rms_mm"))) " mm at the board, square to the ray"
    })
}
