//! Ranges by category: a row for each, with a thin line, a thick bar on it, and a dot.

use super::axis::{Axis, Ruler};
use super::frame::{self, Area, Unshown, WIDTH};
use super::svg::{Anchor, Canvas, text_width};

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
    pub x: Axis,
    pub rows: Vec<RangeRow>,
}

impl RangePlot {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        let values = || self.rows.iter().flat_map(RangeRow::values);
        let x = self.x.ruler(values());
        let mut canvas = Canvas::new();
        let top = frame::head(&mut canvas, &self.title, &[], false);
        let widest = self.rows.iter().map(|row| text_width(&row.label)).fold(0.0, f64::max);
        let bottom = top + ROW * self.rows.len().max(1) as f64;
        // Long labels take from the data, but not more than half.
        let left = (widest + 18.0).clamp(40.0, WIDTH / 2.0);
        let area = Area { left, top, right: WIDTH - 24.0, bottom };
        frame::horizontal_axis(&mut canvas, &area, &x, &self.x.title, None);
        canvas.axis_line([area.left, area.top], [area.left, area.bottom]);
        let mut unshown = Unshown::default();
        for (k, row) in self.rows.iter().enumerate() {
            let y = area.top + ROW * (k as f64 + 0.5);
            canvas.text([area.left - 8.0, y + 4.0], Anchor::End, &row.label);
            row.draw(&mut canvas, (&area, &x), y, &mut unshown);
        }
        let height = frame::foot(&mut canvas, &area, values().next().is_some(), &unshown);
        canvas.finish(WIDTH, height, &self.title, &self.description)
    }
}

impl RangeRow {
    fn values(&self) -> impl Iterator<Item = f64> {
        self.line.into_iter().chain(self.bar).flatten().chain(self.dot)
    }

    fn draw(&self, canvas: &mut Canvas, (area, x): (&Area, &Ruler), y: f64, unshown: &mut Unshown) {
        let at = |value: f64| x.place(value).map(|place| area.x(place.share));
        let ends = |range: Option<[f64; 2]>| range.and_then(|[from, to]| Some([at(from)?, at(to)?]));
        if let Some([from, to]) = ends(self.line) {
            canvas.axis_line([from, y], [to, y]);
            for end in [from, to] {
                canvas.axis_line([end, y - 4.0], [end, y + 4.0]);
            }
        }
        canvas.begin_series(0);
        if let Some([from, to]) = ends(self.bar) {
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
    use crate::report::plot::Scale;

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
            let x = Axis::new("angle, deg", Scale::Linear);
            let svg = RangePlot { title: "Ranges".to_owned(), description: String::new(), x, rows }.svg();
            roxmltree::Document::parse(&svg).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("\"inf"), "{svg}");
        }
    }
}
