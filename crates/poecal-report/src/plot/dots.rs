//! Dots by category: a row for each, several series in a row, joined where a pair is compared.

use super::AxisMark;
use super::axis::PlotAxis;
use super::frame::{Area, PlotFrame};

/// Height of a row, px, and what each further series adds where they stand below each other.
const ROW: f64 = 17.0;
const SERIES: f64 = 8.0;
const RADIUS: f64 = 4.0;

/// A series of a [`DotPlot`].
pub struct Dots {
    pub name: String,
    /// Which colour and marker.
    pub style: usize,
    /// A value for each row, if it has one.
    pub values: Vec<Option<f64>>,
}

/// Values by category.
pub struct DotPlot {
    pub title: String,
    pub description: String,
    pub x: PlotAxis,
    pub rows: Vec<String>,
    pub series: Vec<Dots>,
    /// True if a line joins the dots of a row.
    pub joined: bool,
    pub mark: Option<AxisMark>,
}

impl DotPlot {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        let values = || self.series.iter().flat_map(|dots| dots.values.iter().flatten());
        let marked = self.mark.iter().map(|mark| mark.at);
        let x = self.x.ruler(values().copied().chain(marked));
        let legend: Vec<(usize, &str)> = self.series.iter().map(|dots| (dots.style, dots.name.as_str())).collect();
        let labels: Vec<&str> = self.rows.iter().map(String::as_str).collect();
        let (rows, x) = ((labels.as_slice(), self.row_height()), (x, self.x.title.as_str()));
        let mut frame = PlotFrame::of_rows(&self.title, &legend, rows, x, self.mark.as_ref());
        for (k, row) in labels.iter().enumerate() {
            frame.row_label(self.row_middle(&frame.area, k), row);
            self.join(&mut frame, k);
        }
        frame.left_line();
        for (k, dots) in self.series.iter().enumerate() {
            self.draw(&mut frame, k, dots);
        }
        frame.finish(values().next().is_some(), &self.title, &self.description)
    }

    fn row_height(&self) -> f64 {
        if self.joined { ROW } else { ROW + SERIES * self.series.len().saturating_sub(1) as f64 }
    }

    fn row_middle(&self, area: &Area, row: usize) -> f64 {
        area.top + self.row_height() * (row as f64 + 0.5)
    }

    /// The line from a row's least to its largest value.
    fn join(&self, frame: &mut PlotFrame, row: usize) {
        let y = self.row_middle(&frame.area, row);
        if !self.joined {
            return frame.canvas.grid_line([frame.area.left, y], [frame.area.right, y]);
        }
        let values = self.series.iter().filter_map(|dots| *dots.values.get(row)?);
        let places = values.filter_map(|value| frame.position_across(value));
        let (from, to) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        if from < to {
            frame.canvas.axis_line([from, y], [to, y]);
        }
    }

    fn draw(&self, frame: &mut PlotFrame, series: usize, dots: &Dots) {
        let PlotFrame { canvas, area, x, unshown } = frame;
        let middle = (self.series.len() as f64 - 1.0) / 2.0;
        let shift = if self.joined { 0.0 } else { SERIES * (series as f64 - middle) };
        canvas.begin_series(dots.style);
        let rows = dots.values.iter().take(self.rows.len()).enumerate();
        for (row, value) in rows.filter_map(|(row, value)| Some((row, (*value)?))) {
            let Some(place) = x.place(value) else {
                unshown.not_numbers += 1;
                continue;
            };
            if !place.inside {
                unshown.count_beyond(value);
            }
            let at = [area.x(place.share), self.row_middle(area, row) + shift];
            canvas.marker(dots.style, at, RADIUS, place.inside);
        }
        canvas.end_series();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::AxisScale;

    fn plot(scale: AxisScale, joined: bool, values: &[Option<f64>]) -> String {
        let dots = |style| Dots { name: "a < b".to_owned(), style, values: values.to_vec() };
        let plot = DotPlot {
            title: "Dots".to_owned(),
            description: String::new(),
            x: PlotAxis::new("angle, deg", scale),
            rows: values.iter().map(|_| "row & label".to_owned()).collect(),
            series: vec![dots(0), dots(7)],
            joined,
            mark: None,
        };
        plot.svg()
    }

    #[test]
    fn any_data_give_well_formed_pictures() {
        let odd = [0.0, -1.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        let sets =
            odd.iter().map(|v| vec![Some(*v)]).chain([vec![], vec![None], odd.iter().copied().map(Some).collect()]);
        for values in sets {
            for (scale, joined) in [(AxisScale::Linear, false), (AxisScale::Log, true), (AxisScale::Log, false)] {
                let svg = plot(scale, joined, &values);
                roxmltree::Document::parse(&svg).unwrap();
                assert!(!svg.contains("NaN") && !svg.contains("\"inf"), "{svg}");
            }
        }
    }

    #[test]
    fn nothing_to_show_is_said() {
        assert!(plot(AxisScale::Log, true, &[None]).contains("There are no values."));
    }
}
