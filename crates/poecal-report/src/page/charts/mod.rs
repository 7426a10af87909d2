//! Charts of the rows: dots by row, component and leverage, the distribution of the errors, and their comparison with noise.

mod by_joint;
mod motion;

pub(crate) use self::by_joint::by_joint;

use maud::{Markup, html};

use crate::page::data::{DrawnRow, place, round_for_picture};
use crate::page::leading_error::{LeadingError, component_words, sign};
use crate::plot::{AxisScale, DotSeries, Graph, PlotAxis, PlotShape, VerticalAxis, normal_quantile, quantile};
use crate::table::number;
use poecal_results::residuals::{ResidualRow, Residuals};

/// Rows from which on dots are small.
const MANY: usize = 800;
/// A class of drawn elements with its meaning.
pub(crate) type LegendKey = (&'static str, &'static str);
/// Sets of rows, and the additional width (px) of the element behind suspected ones.
const SETS: [LegendKey; 3] = [("alarm", "suspected"), ("s0", "fitted"), ("s1", "held out")];
const AROUND: u8 = 6;
/// Points of a normal plot at most.
const NORMAL_POINTS: usize = 800;
/// Bars of a histogram.
const BARS: [f64; 2] = [8.0, 40.0];
/// Sizes of charts, px: over the page, half as wide, and in a grid.
const WIDE: [f64; 2] = [980.0, 210.0];
const HALF: [f64; 2] = [440.0, 190.0];
pub(crate) const CELL: [f64; 2] = [280.0, 140.0];

/// A chart with the keys of its colours, a line for the element under the cursor, and its caption below.
pub(crate) fn chart(name: &str, title: &str, caption: &str, drawing: &Markup) -> Markup {
    html! {
        figure.chart data-chart=(name) {
            h3 { (title) }
            div.drawing { (drawing) }
            figcaption { (caption) }
        }
    }
}

/// The keys of these classes.
pub(crate) fn keys(keys: &[LegendKey]) -> Markup {
    html! {
        ul.keys { @for (class, words) in keys { li { i.(class) {} (words) } } }
    }
}

/// Line in which a script names the dot under the cursor. A screen reader has the tables.
pub(crate) fn readout() -> Markup {
    html! { p.readout aria-hidden="true" {} }
}

/// A number with a unit.
pub(crate) fn with_unit(value: f64, unit: &str) -> String {
    let minus = if value < 0.0 { "−" } else { "" };
    let space = if unit == "°" || unit.is_empty() { "" } else { " " };
    if value.is_finite() { format!("{minus}{}{space}{unit}", number(value.abs())) } else { "–".to_owned() }
}

/// An axis from the least to the largest of some values, which includes zero if `from_zero`.
fn axis(title: &str, values: impl Iterator<Item = f64>, from_zero: bool) -> PlotAxis {
    let range = values.filter(|it| it.is_finite()).fold(None, |range: Option<[f64; 2]>, it| {
        let [low, high] = range.unwrap_or([it, it]);
        Some([low.min(it), high.max(it)])
    });
    let zero = from_zero.then_some(0.0);
    let includes: Vec<f64> = range.into_iter().flatten().chain(zero).collect();
    PlotAxis::new(title, AxisScale::Close).with_values(&includes)
}

/// The drawn rows of a calibration, and the reported error of each.
pub(crate) struct Charts<'a> {
    pub(crate) residuals: &'a Residuals,
    pub(crate) rows: &'a [DrawnRow],
    pub(crate) lead: LeadingError,
}

impl<'a> Charts<'a> {
    pub(crate) fn new(residuals: &'a Residuals, rows: &'a [DrawnRow]) -> Self {
        Charts { residuals, rows, lead: LeadingError::from_residuals(residuals) }
    }

    fn row(&self, drawn: &DrawnRow) -> Option<&ResidualRow> {
        self.residuals.rows().get(drawn.index)
    }

    pub(crate) fn error(&self, drawn: &DrawnRow) -> Option<f64> {
        self.row(drawn).and_then(|row| self.lead.error(row)).map(round_for_picture)
    }

    /// Dots of fitted, held-out and suspected rows at some positions, and the keys of the sets that occur.
    pub(crate) fn by_set(
        &self,
        rows: &[&DrawnRow],
        place: impl Fn(&DrawnRow) -> Option<[f64; 2]>,
    ) -> (Vec<DotSeries>, Vec<LegendKey>) {
        let size = if self.rows.len() > MANY { 3 } else { 5 };
        let mut keys = Vec::new();
        let mut all = Vec::new();
        for (class, words) in SETS {
            let is_of = |row: &DrawnRow| match class {
                "s0" => !row.held_out,
                "s1" => row.held_out,
                _ => row.suspected,
            };
            let size = if class == "alarm" { size + AROUND } else { size };
            let points: Vec<Option<[f64; 2]>> = rows.iter().filter(|row| is_of(row)).map(|row| place(row)).collect();
            if points.iter().any(Option::is_some) {
                keys.push((class, words));
            }
            all.push(DotSeries { class, size, points });
        }
        // Suspected rows are drawn behind, and their key comes last.
        if keys.first().is_some_and(|it| it.0 == "alarm") {
            keys.rotate_left(1);
        }
        (all, keys)
    }

    /// The error of each row in the order read.
    pub(crate) fn by_row(&self) -> Markup {
        let rows: Vec<&DrawnRow> = self.rows.iter().collect();
        let number = |row: &DrawnRow| (row.index + 1) as f64;
        let (dots, found) = self.by_set(&rows, |row| Some([number(row), self.error(row)?]));
        let larger = |a: &&&DrawnRow, b: &&&DrawnRow| {
            self.error(a).unwrap_or_default().total_cmp(&self.error(b).unwrap_or_default()).then(b.index.cmp(&a.index))
        };
        let largest = rows.iter().max_by(larger).map_or_else(String::new, |row| self.describe_row(row));
        let (name, unit) = (self.lead.name(), self.lead.unit());
        let spoken = format!("Error of {name} in {} rows in the order read; the largest is {largest}.", rows.len());
        let y = axis(&format!("{name} error, {unit}"), rows.iter().filter_map(|row| self.error(row)), true);
        let x = axis("row, in the order read", rows.iter().map(|row| number(row)), false).in_steps(12.0);
        let graph = Graph { x, size: WIDE, dots, sides: vec![VerticalAxis { y, spoken, shapes: Vec::new() }] };
        html! { (keys(&found)) (graph.svg()) (readout()) }
    }

    /// A row in words.
    fn describe_row(&self, row: &DrawnRow) -> String {
        let set = if row.held_out { "held out" } else { "fitted" };
        let suspected = if row.suspected { ", suspected" } else { "" };
        let error = with_unit(self.error(row).unwrap_or(f64::NAN), self.lead.unit());
        format!("{}, {set}{suspected}: {error}", place(self.residuals, row.index))
    }

    /// Each component of each quantity: its name, its unit, its index among the columns of the page's data, and the values of some rows.
    pub(crate) fn components(&self) -> Vec<Component> {
        let measured = self.residuals.measured_quantities().into_iter().enumerate();
        let all = measured.flat_map(|(at, quantity)| (0..quantity.components()).map(move |k| (at, quantity, k)));
        let component = |(at, quantity, k): (usize, _, usize)| {
            let value = |drawn: &DrawnRow| {
                let residual = self.row(drawn)?.errors.get(quantity)?.residual().get(k).copied();
                residual.filter(|it| !it.is_nan()).map(round_for_picture)
            };
            Component {
                name: component_words(quantity, k),
                unit: sign(quantity.unit()),
                column: format!("{at}.{k}"),
                values: self.rows.iter().map(value).collect(),
            }
        };
        all.map(component).collect()
    }

    /// The components of the residuals in the order read.
    pub(crate) fn by_component(&self) -> Markup {
        let few: Vec<&DrawnRow> = self.rows.iter().filter(|row| row.few).collect();
        let mut all_keys = Vec::new();
        let mut cells = Vec::new();
        for Component { name, unit, values, .. } in self.components() {
            let value = |row: &DrawnRow| values.get(row.at).copied().flatten();
            let (dots, found) = self.by_set(&few, |row| Some([(row.index + 1) as f64, value(row)?]));
            if found.len() > all_keys.len() {
                all_keys = found;
            }
            let y = axis(&format!("residual, {unit}"), few.iter().filter_map(|row| value(row)), false);
            let x = axis("row", few.iter().map(|row| (row.index + 1) as f64), false);
            let spoken = format!(
                "Residuals of {name} of each row in the order read; the table below has their means and spreads."
            );
            let sides = vec![VerticalAxis { y, spoken, shapes: Vec::new() }];
            let graph = Graph { x, size: CELL, dots, sides };
            cells.push(html! { div.cell data-few { p.name { (name) } (graph.svg()) } });
        }
        html! { (keys(&all_keys)) div.cells { @for cell in &cells { (cell) } } (readout()) }
    }

    /// Histogram of the errors of fitted and of held-out rows.
    pub(crate) fn histogram(&self) -> Markup {
        let errors = |held_out: bool| -> Vec<f64> {
            let rows = self.rows.iter().filter(|row| row.even && row.held_out == held_out);
            rows.filter_map(|row| self.error(row)).filter(|it| it.is_finite()).collect()
        };
        let sets = [errors(false), errors(true)];
        let mut sorted: Vec<f64> = sets.iter().flatten().copied().collect();
        sorted.sort_by(f64::total_cmp);
        // A few rows with large errors would leave all others in one bar.
        let most = sorted.last().map_or(1.0, |last| last.min(1.6 * quantile(&sorted, 0.97)));
        let most = if most > 0.0 { most } else { 1.0 };
        let count = (sorted.len() as f64).sqrt().round().clamp(BARS[0], BARS[1]) as usize;
        let width = most / count as f64;
        let beyond = sorted.iter().filter(|it| **it > most).count();
        let mut shapes = Vec::new();
        let mut found = Vec::new();
        for (errors, (class, key)) in
            sets.iter().zip([("s0 bars", ("s0 box", "fitted")), ("s1 line", ("s1 line", "held out"))])
        {
            if !errors.is_empty() {
                shapes.push(PlotShape { class, pieces: vec![outline(errors, width, count)] });
                found.push(key);
            }
        }
        let shares = shapes.iter().flat_map(|it| it.pieces.iter().flatten()).map(|it| it[1]);
        let (name, unit) = (self.lead.name(), self.lead.unit());
        let y = axis("share of the rows, %", shares, true);
        let left = if beyond > 0 { format!(" ({beyond} rows beyond are not drawn)") } else { String::new() };
        let x = PlotAxis::new(&format!("{name} error, {unit}{left}"), AxisScale::Close).with_values(&[0.0, most]);
        let spoken = format!(
            "Histogram of errors of {name} in steps of {}; the tables of errors have mean, RMS, 95 % and largest.",
            with_unit(width, unit)
        );
        let graph = Graph { x, size: HALF, dots: Vec::new(), sides: vec![VerticalAxis { y, spoken, shapes }] };
        html! { (keys(&found)) (graph.svg()) }
    }

    /// The components of the leading unit against the quantiles of a normal distribution.
    pub(crate) fn normal(&self) -> Markup {
        let (name, unit) = (self.lead.name(), self.lead.unit());
        let own = self.components().into_iter().filter(|it| it.unit == unit);
        let is_even = |at: usize| self.rows.get(at).is_some_and(|row| row.even);
        let of_component = |it: Component| {
            it.values.into_iter().enumerate().filter_map(move |(at, value)| value.filter(|_| is_even(at)))
        };
        let mut values: Vec<f64> = own.flat_map(of_component).collect();
        values.sort_by(f64::total_cmp);
        let (all, count) = (values.len(), values.len().min(NORMAL_POINTS));
        // Both ends, and as many between as the chart resolves.
        let rank = |k: usize| (k * all.saturating_sub(1) + count / 2) / count.saturating_sub(1).max(1);
        let ranks = (0..count).map(|k| rank(k).min(all.saturating_sub(1)));
        let expected = |rank: usize| normal_quantile((rank as f64 + 0.5) / all as f64);
        let points: Vec<Option<[f64; 2]>> = ranks.map(|rank| Some([expected(rank), *values.get(rank)?])).collect();
        let [low, high] = [0.25, 0.75].map(|share| quantile(&values, share));
        let slope = (high - low) / (2.0 * normal_quantile(0.75));
        let ends = [points.first(), points.last()].map(|it| it.copied().flatten().map_or(0.0, |it| it[0]));
        let line = ends.map(|x| [x, 0.5 * (low + high) + slope * x]).to_vec();
        let spoken = format!(
            "Normal plot of {all} components of {name}; a normal distribution through their quartiles has a standard deviation of {}.",
            with_unit(slope, unit)
        );
        let ys = points.iter().flatten().chain(&line).map(|it| it[1]);
        let y = axis(&format!("component, {unit}"), ys, false);
        let x = axis("quantile of the normal distribution", ends.into_iter(), false);
        let sides =
            vec![VerticalAxis { y, spoken, shapes: vec![PlotShape { class: "soft line", pieces: vec![line] }] }];
        let dots = vec![DotSeries { class: "s0", size: 4, points }];
        let found = [("s0", "components of all rows"), ("soft line", "normal, through the quartiles")];
        html! { (keys(&found)) (Graph { x, size: HALF, dots, sides }.svg()) }
    }

    /// The fitted rows by their influence on the fit.
    pub(crate) fn leverage(&self) -> Markup {
        let found = |row: &DrawnRow| {
            let judged = self.row(row)?.judged.filter(|_| !row.held_out)?;
            let at = [judged.leverage, judged.studentized].map(round_for_picture);
            at.iter().all(|it| it.is_finite()).then_some(at)
        };
        let judged: Vec<(&DrawnRow, [f64; 2])> = self.rows.iter().filter_map(|row| Some((row, found(row)?))).collect();
        let larger = |a: &&(&DrawnRow, [f64; 2]), b: &&(&DrawnRow, [f64; 2])| a.1[0].total_cmp(&b.1[0]);
        let Some((largest, [most, _])) = judged.iter().max_by(larger) else {
            return html! { p.note { "The rows were not judged." } };
        };
        let rows: Vec<&DrawnRow> = self.rows.iter().collect();
        let (dots, keys_found) = self.by_set(&rows, found);
        let spoken = format!(
            "Studentised residual over leverage of {} fitted rows; the largest leverage, {}, is that of {}.",
            judged.len(),
            number(*most),
            self.describe_row(largest)
        );
        let y = axis("studentised residual", judged.iter().map(|it| it.1[1]), true);
        let x = axis("leverage", judged.iter().map(|it| it.1[0]), false);
        let graph = Graph { x, size: HALF, dots, sides: vec![VerticalAxis { y, spoken, shapes: Vec::new() }] };
        html! { (keys(&keys_found)) (graph.svg()) (readout()) }
    }
}

/// A component of the residuals.
pub(crate) struct Component {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    /// Its index among the columns of the page's data.
    pub(crate) column: String,
    /// Values by drawn row.
    pub(crate) values: Vec<Option<f64>>,
}

/// The outline of the bars of a histogram, per cent of the rows.
fn outline(errors: &[f64], width: f64, count: usize) -> Vec<[f64; 2]> {
    let mut bars = vec![0.0; count];
    for error in errors {
        let at = (error / width) as usize;
        // A value at the end of the last bar is in it.
        let at = if *error <= width * count as f64 { at.min(count - 1) } else { at };
        if let Some(bar) = bars.get_mut(at) {
            *bar += 100.0 / errors.len() as f64;
        }
    }
    let steps = bars.iter().enumerate().flat_map(|(k, bar)| [[width * k as f64, *bar], [width * (k + 1) as f64, *bar]]);
    std::iter::once([0.0, 0.0]).chain(steps).chain([[width * count as f64, 0.0]]).collect()
}
