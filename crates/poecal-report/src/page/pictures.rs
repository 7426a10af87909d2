//! Errors of corners over the image, and by picture.

use maud::{Markup, PreEscaped, html};

use super::html::{figure, plots, quote_text, section};
use super::short_name;
use crate::plot::{AxisScale, DotPlot, Dots, HeatCell, HeatMap, PlotAxis};
use crate::summary::has_terms;
use crate::table::number;
use poecal_calibrate::{ImageCell, ImageMap};
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::residuals::Residuals;

/// Most pictures that are drawn, the worst.
const DRAWN: usize = 60;

pub(crate) fn sections(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let Some(pictures) = &file.pictures else { return Markup::default() };
    let by_picture = html! {
        @if let Some(plot) = by_picture(file, residuals) {
            (plots(
                &[plot],
                "Each picture before and after: distance of its corners from where the model sees them (RMS). A picture that stays far off was \
                 taken with other readings, or after the board had moved.",
            ))
        }
    };
    let content = html! {
        @for (k, map) in pictures.images.iter().enumerate() {
            h3 { "The image of " (quote_text(&map.camera, format_args!("pictures.images.{k}.camera"))) }
            div.pair {
                (plots(&[map_before(map)], "Corners of all pictures that are not suspected, by the nominal axes, with tool and device fitted."))
                (plots(
                    &[after(map)],
                    "The same by the model that is delivered, with the mean of measured minus predicted as arrows. Arrows that turn about the middle, or \
                     point to or from it, are a lens that is not the stated one.",
                ))
            }
            div.pair {
                (plots(
                    &[map_predicted(map)],
                    html! {
                        "How far off a point " (figure(map.distance_mm, format_args!("pictures.images.{k}.distance_mm")))
                        " mm before the camera would be predicted (RMS), by the uncertainty of robot, camera and board together. Where no corners \
                         were, a lens is extrapolated."
                    },
                ))
                @if k + 1 == pictures.images.len() { (by_picture) }
            }
        }
        @if pictures.images.is_empty() { (by_picture) }
    };
    section("pictures", "Pictures", &content)
}

/// A map over an image.
fn map(
    map: &ImageMap,
    (title, description, values): (String, String, &str),
    value: impl Fn(&ImageCell) -> Option<f64>,
    arrow: impl Fn(&ImageCell) -> Option<[f64; 2]>,
) -> Markup {
    let cell = |cell: &ImageCell| {
        Some(HeatCell {
            at: cell.at.map(|it| i64::try_from(it).unwrap_or(i64::MAX)),
            value: value(cell)?,
            arrow: arrow(cell),
            told: describe_cell(map, cell),
        })
    };
    let plot = HeatMap {
        title,
        description,
        axes: ["u, px".to_owned(), "v, px".to_owned()],
        cell: map.cell_px,
        downwards: true,
        values: values.to_owned(),
        arrows: "px".to_owned(),
        cells: map.cells.iter().filter_map(cell).collect(),
    };
    PreEscaped(plot.svg())
}

fn after(image: &ImageMap) -> Markup {
    let words = (
        "Where corners are off after the calibration".to_owned(),
        "A map over the image: root mean square distance of the corners of each cell, with their mean error as an arrow.".to_owned(),
        "px (RMS)",
    );
    map(image, words, |it| it.after_px, |it| it.mean_px)
}

fn map_before(image: &ImageMap) -> Markup {
    let words = (
        "Where corners were off before".to_owned(),
        "A map over the image: root mean square distance of the corners of each cell by the nominal axes.".to_owned(),
        "px (RMS)",
    );
    map(image, words, |it| it.before_px, |_| None)
}

fn map_predicted(image: &ImageMap) -> Markup {
    let words = (
        "How well pixels are predicted".to_owned(),
        "A map over the image: root mean square distance by which a point is predicted off, by the covariance."
            .to_owned(),
        "px (RMS)",
    );
    map(image, words, |it| it.predicted_px, |_| None)
}

/// A cell in words.
fn describe_cell(map: &ImageMap, cell: &ImageCell) -> String {
    let from = |k: usize| cell.at[k] as f64 * map.cell_px;
    let px = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |it| format!("{} px", number(it)));
    format!(
        "u {:.0} to {:.0}, v {:.0} to {:.0}: {} corners, {} before and {} after (RMS); predicted to {}",
        from(0),
        from(0) + map.cell_px,
        from(1),
        from(1) + map.cell_px,
        cell.corners,
        px(cell.before_px),
        px(cell.after_px),
        px(cell.predicted_px)
    )
}

/// The corners of each picture before and after.
fn by_picture(file: &CalibrationFile, residuals: &Residuals) -> Option<Markup> {
    let corrected = has_terms(file);
    let mut rows: Vec<(String, f64, f64)> = residuals
        .rows()
        .iter()
        .filter_map(|row| {
            let corners = row.corners.as_ref()?;
            let [_, before, calibrated] = corners.models_px;
            let after = corners.corrected_px.filter(|_| corrected).unwrap_or(calibrated);
            let name = match row.id.as_str() {
                "" => format!("{}:{}", short_name(&residuals.files, residuals.file(row)), row.line),
                id => id.to_owned(),
            };
            let several = residuals.targets.len() > 1;
            let target = residuals.targets.get(row.target).filter(|_| several);
            let name = target.map_or(name.clone(), |target| format!("{name}, {target}"));
            Some((name, before, after))
        })
        .collect();
    let all = rows.len();
    // The worst, in the order read.
    let mut limits: Vec<f64> = rows.iter().map(|(.., after)| *after).collect();
    limits.sort_by(|a, b| b.total_cmp(a));
    if let Some(&limit) = limits.get(DRAWN) {
        rows.retain(|(.., after)| *after > limit);
    }
    let which = if all > rows.len() { format!(", the {} worst of {all}", rows.len()) } else { String::new() };
    let values =
        |of: fn(&(String, f64, f64)) -> f64| rows.iter().map(|it| Some(of(it)).filter(|it| it.is_finite())).collect();
    let plot = DotPlot {
        title: format!("Corners by picture{which}"),
        description: "For each picture the root mean square distance of its corners from where the model sees them, before and after.".to_owned(),
        x: PlotAxis::new("px (RMS, logarithmic)", AxisScale::Log),
        rows: rows.iter().map(|(name, ..)| name.clone()).collect(),
        series: vec![
            Dots { name: "registered".to_owned(), style: 3, values: values(|it| it.1) },
            Dots { name: if corrected { "corrected" } else { "calibrated" }.to_owned(), style: 0, values: values(|it| it.2) },
        ],
        joined: true,
        mark: None,
    };
    (!rows.is_empty()).then(|| PreEscaped(plot.svg()))
}
