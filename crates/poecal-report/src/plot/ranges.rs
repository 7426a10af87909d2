//! Ranges by category: a row for each, with a thin line, a thick bar on it, and a dot.

use super::axis::PlotAxis;
use super::frame::PlotFrame;

/// Height of a row, px.
const ROW: f64 = 22.0;
const RADIUS: f64 = 4.0;
/// Height of a bar, px.
const BAR: f64 = 7.0;

/// A row of a [`RangePlot`].
#[derive(Default)]
pub struct RangeRow {
    pub label: String,
    pub line: Option<[f64; 2]>,
    pub bar: Option<[f64; 2]>,
    pub dot: Option<f64>,
}

/// Ranges by category.
pub struct RangePlot {
    pub title: String,
    pub description: String,
    pub x: PlotAxis,
    pub rows: Vec<RangeRow>,
}

impl RangePlot {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        let values = || self.rows.iter().flat_map(RangeRow::values);
        let x = self.x.ruler(values());
        let labels: Vec<&str> = self.rows.iter().map(|row| row.label.as_str()).collect();
        let mut frame = PlotFrame::of_rows(&self.title, &[], (&labels, ROW), (x, &self.x.title), None);
        frame.left_line();
        for (k, row) in self.rows.iter().enumerate() {
            let y = frame.area.top + ROW * (k as f64 + 0.5);
            frame.row_label(y, &row.label);
            row.draw(&mut frame, y);
        }
        frame.finish(values().next().is_some(), &self.title, &self.description)
    }
}

impl RangeRow {
    fn values(&self) -> impl Iterator<Item = f64> {
        self.line.into_iter().chain(self.bar).flatten().chain(self.dot)
    }

    fn draw(&self, frame: &mut PlotFrame, y: f64) {
        let ends = |range: Option<[f64; 2]>| {
            range.and_then(|[from, to]| Some([frame.position_across(from)?, frame.position_across(to)?]))
        };
        let (line, bar) = (ends(self.line), ends(self.bar));
        let PlotFrame { canvas, area, x, unshown } = frame;
        if let Some([from, to]) = line {
            canvas.axis_line([from, y], [to, y]);
            for end in [from, to] {
                canvas.axis_line([end, y - 4.0], [end, y + 4.0]);
            }
        }
        canvas.begin_series(0);
        if let Some([from, to]) = bar {
            canvas.bar([from, y - BAR / 2.0], [to, y + BAR / 2.0]);
        }
        if let Some(value) = self.dot {
            match x.place(value) {
                Some(place) => canvas.marker(0, [area.x(place.share), y], RADIUS, place.inside),
                None => unshown.not_numbers += 1,
            }
        }
        canvas.end_series();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::AxisScale;

    #[test]
    fn any_data_give_well_formed_pictures() {
        let odd = [0.0, -1.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        for value in odd {
            let row = |line, bar, dot| RangeRow { label: "a < b".to_owned(), line, bar, dot };
            let rows = vec![
                row(Some([value, 1.0]), Some([0.0, value]), Some(value)),
                row(None, None, None),
                RangeRow::default(),
            ];
            let x = PlotAxis::new("angle, deg", AxisScale::Linear);
            let svg = RangePlot { title: "Ranges".to_owned(), description: String::new(), x, rows }.svg();
            roxmltree::Document::parse(&svg).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("\"inf"), "{svg}");
        }
    }
}
