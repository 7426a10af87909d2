//! Residuals over the value of each joint, with smoothed curves. If there are several residuals, a script shows the selected one.

use maud::{Markup, html};

use super::motion::RobotMotions;
use super::{CELL, Charts, Component, keys, readout, with_unit};
use crate::page::data::{DrawnRow, round_for_picture};
use crate::page::readings_of;
use crate::plot::{AxisScale, Graph, PlotAxis, PlotShape, SmoothCurve, VerticalAxis, quantile};
use poecal_numerics::error::Result;
use poecal_results::calibration_file::CalibrationFile;

/// Name of the residual that is shown first, if there is one.
const OWN: &str = "along the joint's own motion";

/// Residual that is drawn over joint values.
struct DrawnResidual {
    name: String,
    unit: &'static str,
    /// Its index among the columns of the page's data, which has no motions.
    column: Option<String>,
    /// Values by drawn row: for all readings, or for each.
    values: Vec<Vec<Option<f64>>>,
}

impl DrawnResidual {
    /// The value of a row over a reading.
    fn value(&self, reading: usize, row: &DrawnRow) -> Option<f64> {
        let own = if self.values.len() == 1 { 0 } else { reading };
        self.values.get(own)?.get(row.at).copied().flatten()
    }

    /// One range for all joints, so that they compare: a few rows with large deviations are left out of sight.
    fn range(&self, rows: &[&DrawnRow]) -> [f64; 2] {
        let values = || (0..self.values.len()).flat_map(|k| rows.iter().filter_map(move |row| self.value(k, row)));
        let mut sizes: Vec<f64> = values().map(f64::abs).collect();
        sizes.sort_by(f64::total_cmp);
        let most = round_for_picture(1.3 * quantile(&sizes, 0.995));
        let most = if most > 0.0 { most } else { 1.0 };
        if values().any(|it| it < 0.0) { [-most, most] } else { [0.0, most] }
    }

    /// The axis with the smoothed curve through its values over a reading, of rows sorted by that reading.
    fn side(&self, (reading, name): (usize, &str), rows: &[(&DrawnRow, f64)], range: [f64; 2]) -> VerticalAxis {
        let points: Vec<[f64; 2]> =
            rows.iter().filter_map(|(row, at)| Some([*at, self.value(reading, row)?])).collect();
        let curve = SmoothCurve::from_points(&points);
        let (mut lines, mut bands) = (Vec::new(), Vec::new());
        for piece in curve.iter().flat_map(SmoothCurve::pieces) {
            lines.push(piece.iter().map(|[x, value, _]| [*x, *value]).collect());
            let upper = piece.iter().map(|[x, value, off]| [*x, value + off]);
            let lower = piece.iter().rev().map(|[x, value, off]| [*x, value - off]);
            bands.push(upper.chain(lower).collect());
        }
        let told = curve.as_ref().map_or_else(
            || "too few rows for a smoothed curve".to_owned(),
            |curve| {
                let [swing, deviation] = [curve.swing(), curve.deviation()].map(|it| with_unit(it, self.unit));
                format!("the smoothed curve swings by {swing}, with a standard deviation of {deviation}")
            },
        );
        VerticalAxis {
            y: PlotAxis::new(&format!("residual, {}", self.unit), AxisScale::Close).with_values(&range),
            spoken: format!("Residual {} over {name}; {told}.", self.name),
            shapes: vec![PlotShape { class: "band", pieces: bands }, PlotShape { class: "ink line", pieces: lines }],
        }
    }
}

/// Residuals that can be drawn over joint values; the first is shown.
fn residuals(charts: &Charts<'_>, file: &CalibrationFile) -> Result<Vec<DrawnResidual>> {
    let motions = RobotMotions::new(file, charts.residuals)?;
    let by_row: Vec<Vec<Option<f64>>> =
        charts.rows.iter().map(|row| motions.residual_along_motions(row.index)).collect();
    let column = |k: usize| by_row.iter().map(|row| row.get(k).copied().flatten()).collect();
    let own: Vec<Vec<Option<f64>>> = readings_of(charts.residuals).map(|(k, ..)| column(k)).collect();
    let moves = own.iter().flatten().any(Option::is_some);
    let own = moves.then(|| DrawnResidual { name: OWN.to_owned(), unit: "mm", column: None, values: own });
    let error = DrawnResidual {
        name: format!("{} error", charts.lead.name()),
        unit: charts.lead.unit(),
        column: Some("error".to_owned()),
        values: vec![charts.rows.iter().map(|row| charts.error(row)).collect()],
    };
    let component = |it: Component| DrawnResidual {
        name: it.name,
        unit: it.unit,
        column: Some(it.column),
        values: vec![it.values],
    };
    Ok(own.into_iter().chain([error]).chain(charts.components().into_iter().map(component)).collect())
}

/// Residuals over the value of each joint.
pub(crate) fn by_joint(charts: &Charts<'_>, file: &CalibrationFile) -> Result<Markup> {
    let residuals = residuals(charts, file)?;
    let believed: Vec<&DrawnRow> = charts.rows.iter().filter(|row| !row.suspected).collect();
    let few: Vec<&DrawnRow> = charts.rows.iter().filter(|row| row.few).collect();
    let ranges: Vec<[f64; 2]> = residuals.iter().map(|it| it.range(&believed)).collect();
    let mut all_keys = Vec::new();
    let mut cells = Vec::new();
    for (k, (column, name, unit)) in readings_of(charts.residuals).enumerate() {
        let at = |row: &DrawnRow| {
            round_for_picture(charts.residuals.values(row.index).get(column).copied().unwrap_or(f64::NAN))
        };
        let mut even: Vec<(&DrawnRow, f64)> =
            believed.iter().filter(|row| row.even).map(|row| (*row, at(row))).collect();
        even.sort_by(|a, b| a.1.total_cmp(&b.1));
        let sides = residuals.iter().zip(&ranges).map(|(it, range)| it.side((k, name), &even, *range));
        let own = residuals.first();
        let dot = |row: &DrawnRow| Some([at(row), own?.value(k, row).filter(|_| !row.suspected)?]);
        let (dots, found) = charts.by_set(&few, dot);
        let is_still = found.is_empty();
        if found.len() > all_keys.len() {
            all_keys = found;
        }
        let ends = [even.first(), even.last()].map(|it| it.map_or(0.0, |it| it.1));
        let x = PlotAxis::new(&format!("{name}, {unit}"), AxisScale::Close).with_values(&ends);
        let graph = Graph { x, size: CELL, dots, sides: sides.collect() };
        cells.push(html! {
            div.cell data-few data-reading=(k) {
                p.name { (name) }
                @if is_still { p.note data-side="0" { "What was measured does not move with this joint, or lies on its axis." } }
                (graph.svg())
            }
        });
    }
    all_keys.push(("ink line", "smoothed, with one standard deviation to each side"));
    Ok(html! {
        label.choice hidden {
            "Residual" select { @for it in &residuals { option data-column=[it.column.as_ref()] { (it.name) } } }
        }
        (keys(&all_keys))
        div.cells { @for cell in &cells { (cell) } }
        (readout())
    })
}
