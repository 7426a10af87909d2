//! Plots that need no script. They are markup already, in which the plots' own writer has escaped every text.

use maud::{Markup, PreEscaped};

use super::html::capital;
use super::leading_error::LeadingError;
use crate::plot::{AxisScale, LinePlot, PlotAxis, PlotLine, RangePlot, RangeRow};
use crate::summary::delivered_name;
use poecal_model::robot::JointKind;
use poecal_numerics::threads;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::residuals::{ResidualRow, Residuals};

/// Points of a distribution.
const STEPS: usize = 20;

/// Distribution of the rows' errors for the models.
pub(crate) fn distributions(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let lead = LeadingError::from_residuals(residuals);
    let held_out = file.accuracy.held_out.is_some();
    // With an unknown tool the nominal model predicts nothing, and its errors would occupy most of the axis.
    let line = |name: &str, style: usize, error: &dyn Fn(&ResidualRow) -> Option<f64>| {
        let rows = residuals.rows().iter().filter(|row| row.held_out == held_out);
        PlotLine { name: name.to_owned(), style, points: distribution(rows.filter_map(error).collect()) }
    };
    // The same colour as the residuals everywhere else.
    let lines = vec![
        line("registered", 3, &|row| lead.registered_error(row)),
        line(delivered_name(file), 0, &|row| lead.error(row)),
    ];
    let name = lead.name();
    let plot = LinePlot {
        title: format!("Distribution of the {name} error"),
        description: format!(
            "For each model the share of the rows whose {name} error is below a value; the table beside has the figures."
        ),
        x: PlotAxis::new(&format!("{name} error, {} (logarithmic)", lead.unit()), AxisScale::Log),
        y: PlotAxis::new("share of the rows below, %", AxisScale::Linear).with_values(&[0.0, 100.0]),
        lines,
        mark: None,
    };
    PreEscaped(plot.svg())
}

/// Ratio of the largest error to the 95 % quantile from which on a linear axis would compress all others into a corner.
const FAR_OFF: f64 = 4.0;

/// Errors of the delivered model on fitted rows and on those held out.
pub(crate) fn sets(file: &CalibrationFile, residuals: &Residuals) -> Markup {
    let lead = LeadingError::from_residuals(residuals);
    let errors = |held_out: bool| -> Vec<f64> {
        let rows = residuals.rows().iter().filter(|row| row.held_out == held_out);
        rows.filter_map(|row| lead.error(row)).collect()
    };
    let sets = [("fitted", 0, errors(false)), ("held out", 1, errors(true))];
    let is_far_off = sets.iter().any(|(_, _, errors)| {
        let points = distribution(errors.clone());
        let most = points.iter().find(|[_, share]| *share >= 95.0).zip(points.last());
        most.is_some_and(|([usual, _], [largest, _])| *largest > FAR_OFF * usual)
    });
    let (scale, words, from) =
        if is_far_off { (AxisScale::Log, " (logarithmic)", None) } else { (AxisScale::Linear, "", Some(0.0)) };
    let lines =
        sets.map(|(name, style, errors)| PlotLine { name: name.to_owned(), style, points: distribution(errors) });
    let name = lead.name();
    let plot = LinePlot {
        title: format!("{} model: fitted against held-out rows", capital(delivered_name(file))),
        description: format!(
            "The share of fitted and of held-out rows whose {name} error is below a value; the table below has the figures."
        ),
        x: PlotAxis::new(&format!("{name} error, {}{words}", lead.unit()), scale).with_values(from.as_slice()),
        y: PlotAxis::new("share of the rows below, %", AxisScale::Linear).with_values(&[0.0, 100.0]),
        lines: lines.into_iter().filter(|line| !line.points.is_empty()).collect(),
        mark: None,
    };
    PreEscaped(plot.svg())
}

/// Points (error, share in per cent) of the distribution of some errors.
fn distribution(mut errors: Vec<f64>) -> Vec<[f64; 2]> {
    threads::sort_by(&mut errors, f64::total_cmp);
    let last = errors.len().saturating_sub(1);
    let steps = STEPS.min(last.max(1));
    let point = |step: usize| {
        let rank = (step * last).div_ceil(steps);
        Some([*errors.get(rank)?, 100.0 * rank as f64 / last.max(1) as f64])
    };
    (0..=steps).filter_map(point).collect()
}

/// Sizes of the corrections with their standard deviations: tilts, and shifts of joints that turn.
pub(crate) fn corrections(file: &CalibrationFile) -> Vec<Markup> {
    let row = |joint: &str, value: f64, sigma: Option<f64>| RangeRow {
        label: joint.to_owned(),
        line: sigma.map(|sigma| [(value - sigma).max(0.0), value + sigma]),
        bar: None,
        dot: Some(value),
    };
    let plot = |title: &str, axis: &str, rows: Vec<RangeRow>| {
        let plot = RangePlot {
            title: title.to_owned(),
            description:
                "A dot for each joint, one standard deviation to each side as a line; the table has the figures."
                    .to_owned(),
            x: PlotAxis::new(axis, AxisScale::Linear).with_values(&[0.0]),
            rows,
        };
        (!plot.rows.is_empty()).then(|| PreEscaped(plot.svg()))
    };
    let length = |it: &[f64; 3]| it.iter().map(|part| part * part).sum::<f64>().sqrt();
    let changes = || file.corrections.iter().filter_map(|it| Some((&*it.joint, it.change.as_ref()?)));
    let tilts = changes().map(|(joint, it)| row(joint, length(&it.tilt_deg), it.sigma_tilt_deg));
    let shifts = changes().filter_map(|(joint, it)| Some(row(joint, length(it.shift_mm.as_ref()?), it.sigma_shift_mm)));
    let plots =
        [plot("Tilt of each axis", "degrees", tilts.collect()), plot("Shift of each axis", "mm", shifts.collect())];
    plots.into_iter().flatten().collect()
}

/// Sampled part of each joint's range: joints that turn, and joints that slide.
pub(crate) fn coverage(file: &CalibrationFile) -> Vec<Markup> {
    let kinds = [
        (JointKind::Revolute, "Joints that turn", "degrees", 1f64.to_degrees()),
        (JointKind::Prismatic, "Joints that slide", "mm", 1e3),
    ];
    let plots = kinds.into_iter().filter_map(|(kind, title, unit, factor)| {
        let joints = file
            .coverage
            .iter()
            .filter(|found| file.joints.iter().any(|joint| joint.name == found.joint && joint.kind == kind));
        let rows: Vec<RangeRow> = joints
            .map(|found| RangeRow {
                label: found.joint.clone(),
                line: found.limit_min.zip(found.limit_max).map(|(least, most)| [least * factor, most * factor]),
                bar: Some([found.sampled_min * factor, found.sampled_max * factor]),
                dot: None,
            })
            .collect();
        let plot = RangePlot {
            title: title.to_owned(),
            description:
                "For each joint its limits as a thin line and what was sampled as a bar; the table has the figures."
                    .to_owned(),
            x: PlotAxis::new(unit, AxisScale::Linear),
            rows,
        };
        (!plot.rows.is_empty()).then(|| PreEscaped(plot.svg()))
    });
    plots.collect()
}

/// Decrease of the mean square in each fit: weights differ between fits, so that a step up is not within a fit.
pub(crate) fn convergence(file: &CalibrationFile) -> Markup {
    let trace = &file.solver.trace;
    let mut step = 0;
    let fits = trace.chunk_by(|before, after| after <= before).map(|fit| {
        let points = fit.iter().enumerate().map(|(k, &value)| [(step + k) as f64, value]).collect();
        step += fit.len();
        PlotLine { name: "fit".to_owned(), style: 0, points }
    });
    let plot = LinePlot {
        title: "How the fit converged".to_owned(),
        description: "The mean square of the whitened residual by iteration, a line for each fit; the table below has the figures."
            .to_owned(),
        x: PlotAxis::new("iteration", AxisScale::Count),
        y: PlotAxis::new("mean square of the whitened residual (logarithmic)", AxisScale::Log),
        lines: fits.collect(),
        mark: None,
    };
    PreEscaped(plot.svg())
}
