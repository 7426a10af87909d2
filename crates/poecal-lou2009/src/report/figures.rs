//! The figures of the report.

use std::ops::Range;

use super::document::PlotFigure;
use super::numbers::format_stated;
use super::tables::distinct_values;
use crate::{ElbowRun, Iteration, MatrixSpectrum, MeasurementKind, PaperFormulation, Reproduction, ScrewRow};
use poecal_report::plot::{AxisMark, AxisScale, DotPlot, Dots, LinePlot, NamedPlot, PlotAxis, PlotLine};

const SEEN: [MeasurementKind; 2] = [MeasurementKind::Poses, MeasurementKind::Points];
/// Names of the parts of `v` and `ω`.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Ratio from which an axis of ratios is logarithmic.
const WIDE_RATIO: f64 = 10.0;
/// Lower end of an axis of shares, unless the least share is lower; the upper end is 1.
const LEAST_SHARE: f64 = 0.9;

/// The style of a formulation, the same in every figure.
fn style(formulation: PaperFormulation) -> usize {
    PaperFormulation::ALL.iter().position(|other| *other == formulation).unwrap_or_default()
}

/// A value of an iteration over iterations, for all noise-free runs of a measurement.
fn trace_plot(
    found: &Reproduction,
    (seen, offsets_in_truth): (MeasurementKind, bool),
    (what, unit): (&str, &str),
    value: fn(&Iteration) -> f64,
) -> LinePlot {
    let chosen = |run: &&ElbowRun| run.measurement == seen && run.offsets_in_truth == offsets_in_truth && !run.noise;
    let line = |run: &ElbowRun| PlotLine {
        name: run.formulation.word().to_owned(),
        style: style(run.formulation),
        points: run.trace.iter().enumerate().map(|(k, state)| [k as f64, value(state)]).collect(),
    };
    let title = format!("{what}, {}, {} joint offsets", seen.word(), if offsets_in_truth { "with" } else { "no" });
    LinePlot {
        description: format!("{title}, by iteration, a line for each formulation."),
        title,
        x: PlotAxis::new("iteration", AxisScale::Count),
        y: PlotAxis::new(unit, AxisScale::Log),
        lines: found.runs.iter().filter(chosen).map(line).collect(),
        mark: None,
    }
}

fn name_plot(name: String, title: String, svg: String) -> NamedPlot {
    NamedPlot { name: format!("figure-{name}"), title, svg }
}

fn named_lines(name: String, plot: LinePlot) -> NamedPlot {
    let svg = plot.svg();
    name_plot(name, plot.title, svg)
}

fn named_dots(name: String, plot: DotPlot) -> NamedPlot {
    let svg = plot.svg();
    name_plot(name, plot.title, svg)
}

/// Figure 1: residuals by iteration.
pub(super) fn residuals(found: &Reproduction) -> PlotFigure {
    let plot = |seen: MeasurementKind| {
        let words = ("Residual", "RMS residual of position, mm");
        let plot = trace_plot(found, (seen, false), words, |state| 1e3 * state.residual_rms_m);
        named_lines(format!("1-residual-{}", seen.word()), plot)
    };
    PlotFigure {
        caption: "Figure 1. Residuals by iteration, without noise and without joint offsets in the truth. Iteration 0 is the nominal robot.".to_owned(),
        plots: SEEN.map(plot).into(),
    }
}

/// Figure 2: screw errors by iteration.
pub(super) fn screw_errors(found: &Reproduction) -> PlotFigure {
    let plot = |(seen, offsets): (MeasurementKind, bool)| {
        let words = ("Screw error", "largest screw error, m (v), no unit (ω)");
        let plot = trace_plot(found, (seen, offsets), words, |state| state.screw_error_max);
        let case = if offsets { "with-offsets" } else { "no-offsets" };
        named_lines(format!("2-screws-{}-{case}", seen.word()), plot)
    };
    let cases = [false, true].into_iter().flat_map(|offsets| SEEN.map(|seen| (seen, offsets)));
    PlotFigure {
        caption: "Figure 2. Largest difference of any screw coordinate from the prescribed one by iteration, without noise. The residual can vanish while the screws stay off: then several robots predict the same.".to_owned(),
        plots: cases.map(plot).collect(),
    }
}

/// Figure 3: nominal and identified screws against the prescribed ones.
pub(super) fn deviations(found: &Reproduction) -> PlotFigure {
    let identified: [fn(&ScrewRow) -> &[f64; 6]; 3] =
        [|row| &row.nominal, |row| &row.from_poses, |row| &row.from_points];
    let screws = |part: Range<usize>, factor| {
        identified.map(|of| {
            let parts = found.screws.iter().map(|row| (&of(row)[part.clone()], &row.prescribed[part.clone()]));
            parts.flat_map(|(values, prescribed)| differences(values, prescribed, factor)).collect()
        })
    };
    let point = |of: &[f64; 3]| differences(of, &found.point.prescribed, 1e3);
    let names = |part: &str| -> Vec<String> {
        found.screws.iter().flat_map(|row| AXES.map(|axis| format!("{} {part}{axis}", row.joint))).collect()
    };
    let [nominal, from_poses, from_points]: [Vec<Option<f64>>; 3] = screws(0..3, 1e3);
    let of_v = deviation_plot(
        ("v and of the point", "v and point", "mm"),
        [names("v"), AXES.map(|axis| format!("point P_c0 {axis}")).to_vec()].concat(),
        [
            [nominal, point(&found.point.nominal)].concat(),
            [from_poses, vec![None; 3]].concat(),
            [from_points, point(&found.point.from_points)].concat(),
        ],
    );
    let of_omega = deviation_plot(("ω", "ω", "no unit"), names("ω"), screws(3..6, 1.0));
    PlotFigure {
        caption: "Figure 3. Distance of each coordinate from its prescribed value: before (nominal) and after identification, without noise.".to_owned(),
        plots: vec![
            named_dots("3-deviations-v".to_owned(), of_v),
            named_dots("3-deviations-omega".to_owned(), of_omega),
        ],
    }
}

/// Distances from prescribed: of the nominal coordinates, and of those identified from poses and from points.
fn deviation_plot(
    (title, what, unit): (&str, &str, &str),
    rows: Vec<String>,
    values: [Vec<Option<f64>>; 3],
) -> DotPlot {
    let names = ["nominal", "from poses", "from points"].into_iter().zip(values).enumerate();
    let dots = |(style, (name, values)): (usize, (&str, _))| Dots { name: name.to_owned(), style, values };
    DotPlot {
        title: format!("Deviation of {title}"),
        description: format!("Differences of nominal and identified {what} from the prescribed ones."),
        x: PlotAxis::new(&format!("distance from prescribed, {unit}"), AxisScale::Log),
        rows,
        series: names.map(dots).collect(),
        joined: true,
        mark: None,
    }
}

fn differences(values: &[f64], prescribed: &[f64], factor: f64) -> Vec<Option<f64>> {
    let pairs = values.iter().zip(prescribed);
    pairs.map(|(value, prescribed)| Some(factor * (value - prescribed).abs())).collect()
}

/// Figure 4: offsets.
pub(super) fn offsets(found: &Reproduction) -> PlotFigure {
    let series = |name: &str, style, value: fn(&crate::OffsetRow) -> f64| Dots {
        name: name.to_owned(),
        style,
        values: found.offsets.iter().map(|row| Some(value(row))).collect(),
    };
    let plot = DotPlot {
        title: "Joint offsets".to_owned(),
        description: "Joint offsets: prescribed, and as two formulations identify them.".to_owned(),
        x: PlotAxis::new("joint offset, deg", AxisScale::Linear).with_values(&[0.0]),
        rows: found.offsets.iter().map(|row| row.joint.clone()).collect(),
        series: vec![
            series("prescribed", 0, |row| row.prescribed_deg),
            series(PaperFormulation::ScrewOffsets.word(), style(PaperFormulation::ScrewOffsets), |row| {
                row.screw_offsets_deg
            }),
            series(PaperFormulation::AdjointOffsets.word(), style(PaperFormulation::AdjointOffsets), |row| {
                row.adjoint_offsets_deg
            }),
        ],
        joined: false,
        mark: None,
    };
    PlotFigure {
        caption: "Figure 4. Joint offsets: prescribed, and identified from poses without noise.".to_owned(),
        plots: vec![named_dots("4-offsets".to_owned(), plot)],
    }
}

/// Figure 5: singular values.
pub(super) fn spectra(found: &Reproduction) -> PlotFigure {
    let plot = |(k, spectrum): (usize, &MatrixSpectrum)| {
        let values = spectrum.singular_values.iter().enumerate();
        let gap = (spectrum.rank < spectrum.columns)
            .then(|| AxisMark { at: spectrum.rank as f64 + 0.5, label: format!("rank {}", spectrum.rank) });
        let title = format!("{}, {}: rank {} of {}", spectrum.matrix, spectrum.at, spectrum.rank, spectrum.columns);
        let plot = LinePlot {
            description: format!("Singular values, the largest first. {title}."),
            title,
            x: PlotAxis::new("number of the singular value", AxisScale::Count),
            y: PlotAxis::new("singular value, share of the largest", AxisScale::Log),
            lines: vec![PlotLine {
                name: spectrum.matrix.clone(),
                style: 0,
                points: values.map(|(k, value)| [k as f64 + 1.0, *value]).collect(),
            }],
            mark: gap,
        };
        named_lines(format!("5-singular-values-{:02}", k + 1), plot)
    };
    PlotFigure {
        caption: format!(
            "Figure 5. Singular values at the identified robot as shares of the largest. A dashed line marks the gap: singular values beyond it are rounding. A radian counts as {} m.",
            format_stated(found.length_m)
        ),
        plots: found.spectra.iter().filter(|it| it.at == "identified").enumerate().map(plot).collect(),
    }
}

/// Figure 6: accuracy with noise against the bound.
pub(super) fn efficiency(found: &Reproduction) -> PlotFigure {
    let rows = distinct_values(found.efficiency.iter().map(|row| (row.formulation, row.measurement)));
    let ways = distinct_values(found.efficiency.iter().map(|row| (row.residual.as_str(), row.method.as_str())));
    let ratio = |(formulation, seen): (PaperFormulation, MeasurementKind), way: (&str, &str)| {
        let fits = |row: &&crate::Efficiency| {
            (row.formulation, row.measurement) == (formulation, seen)
                && (row.residual.as_str(), row.method.as_str()) == way
        };
        found.efficiency.iter().find(fits).map(|row| row.ratio)
    };
    let series = |(style, way): (usize, &(&str, &str))| Dots {
        name: format!("{} residual, {}", way.0, way.1),
        style,
        values: rows.iter().map(|row| ratio(*row, *way)).collect(),
    };
    let wide = found.efficiency.iter().any(|row| row.ratio.is_finite() && row.ratio > WIDE_RATIO);
    let scale = if wide { AxisScale::Log } else { AxisScale::Linear };
    let plot = DotPlot {
        title: "Held-out error over the Cramér-Rao bound".to_owned(),
        description: "Ratio of the RMS held-out error of many noisy fits to the Cramér-Rao bound.".to_owned(),
        // A scatter of a percent must not fill the plot.
        x: PlotAxis::new("held-out RMS error over bound, ratio", scale).with_values(&[0.9, 1.1]),
        rows: rows.iter().map(|(formulation, seen)| format!("{}, {}", formulation.word(), seen.word())).collect(),
        series: ways.iter().enumerate().map(series).collect(),
        joined: false,
        mark: Some(AxisMark { at: 1.0, label: "bound".to_owned() }),
    };
    PlotFigure {
        caption: "Figure 6. Accuracy with noise: 1 is the best that any unbiased estimator can do.".to_owned(),
        plots: vec![named_dots("6-efficiency".to_owned(), plot)],
    }
}

/// Figure 7: share of starts that converge.
pub(super) fn basin(found: &Reproduction) -> PlotFigure {
    let panels = distinct_values(found.basin.iter().map(|row| (row.measurement, row.method.as_str())));
    let plot = |(k, (seen, method)): (usize, &(MeasurementKind, &str))| {
        let here = || found.basin.iter().filter(|row| (row.measurement, row.method.as_str()) == (*seen, *method));
        let line = |formulation: PaperFormulation| PlotLine {
            name: formulation.word().to_owned(),
            style: style(formulation),
            points: here().filter(|row| row.formulation == formulation).map(|row| [row.error_deg, row.share]).collect(),
        };
        let title = format!("Starts that converge, {}, {method}", seen.word());
        let plot = LinePlot {
            description: format!("{title}: share by the error of the start, a line for each formulation."),
            title,
            x: PlotAxis::new("error of each axis, deg", AxisScale::Linear).with_values(&[0.0]),
            y: PlotAxis::new("share of starts", AxisScale::Linear).with_values(&[LEAST_SHARE, 1.0]),
            lines: distinct_values(here().map(|row| row.formulation)).into_iter().map(line).collect(),
            mark: None,
        };
        named_lines(format!("7-basin-{}-{}", seen.word(), k + 1), plot)
    };
    PlotFigure {
        caption: "Figure 7. Share of starts from which the truth is reached, without noise. The axis of shares does not begin at 0."
            .to_owned(),
        plots: panels.iter().enumerate().map(plot).collect(),
    }
}
