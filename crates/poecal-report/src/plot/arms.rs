//! A robot in many configurations, seen from a side.

use super::axis::{AxisScale, PlotAxis};
use super::frame::{self, Area, PlotFrame, WIDTH};
use super::svg::{Anchor, Canvas};

/// Largest height of the area of the data, px.
const HIGHEST: f64 = 420.0;

/// Lines and points of one series of an [`ArmPlot`].
#[derive(Default)]
pub struct ArmSeries {
    pub name: String,
    pub style: usize,
    pub lines: Vec<[[f64; 2]; 2]>,
    /// True if lines are transparent.
    pub is_thin: bool,
    /// Points that are marked.
    pub points: Vec<[f64; 2]>,
    /// Names of the first points, beside them.
    pub labels: Vec<String>,
}

/// Robots over two axes of one scale.
pub struct ArmPlot {
    pub title: String,
    pub description: String,
    pub x_title: String,
    pub y_title: String,
    pub arms: Vec<ArmSeries>,
}

impl ArmPlot {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        let all = || {
            let lines = self.arms.iter().flat_map(|arm| arm.lines.iter().flatten());
            lines.chain(self.arms.iter().flat_map(|arm| &arm.points))
        };
        let range = |k: usize| {
            let values = || all().map(|point| point[k]).filter(|value| value.is_finite());
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
        };
        let mut ranges = [range(0), range(1)];
        if ranges.iter().any(|it| it.0 > it.1) {
            ranges = [(0.0, 1.0); 2];
        }
        let mut canvas = Canvas::new();
        let legend: Vec<(usize, &str)> = self.arms.iter().map(|arm| (arm.style, arm.name.as_str())).collect();
        let below = frame::head(&mut canvas, &self.title, &legend, false);
        let top = frame::vertical_title(&mut canvas, below, &self.y_title);
        let (left, right) = (56.0, WIDTH - 20.0);
        // One scale for both: the narrower of the two ranges is widened, and neither is rounded to ticks.
        let [wide, high] = ranges.map(|(low, high)| (high - low).max(1e-3));
        let height = (high * (right - left) / wide).clamp(120.0, HIGHEST);
        let per_px = (wide / (right - left)).max(high / height);
        let widened = |(low, high): (f64, f64), px: f64| {
            let (middle, half) = (0.5 * (low + high), 0.5 * per_px * px);
            [middle - half, middle + half]
        };
        let x = PlotAxis::new(&self.x_title, AxisScale::Close).with_values(&widened(ranges[0], right - left));
        let y = PlotAxis::new(&self.y_title, AxisScale::Close).with_values(&widened(ranges[1], height));
        let (x, y) = (x.ruler(std::iter::empty()), y.ruler(std::iter::empty()));
        let area = Area { left, top, right, bottom: top + height };
        frame::vertical_axis(&mut canvas, &area, &y);
        let mut frame = PlotFrame::new(canvas, area, (x, &self.x_title), None);
        let any = all().next().is_some();
        for arm in &self.arms {
            let PlotFrame { canvas, area, x, .. } = &mut frame;
            let place = |[a, b]: [f64; 2]| Some([area.x(x.place(a)?.share), area.y(y.place(b)?.share)]);
            canvas.begin_series(arm.style);
            for [from, to] in &arm.lines {
                match (place(*from), place(*to)) {
                    (Some(from), Some(to)) if !arm.is_thin => canvas.path(0, &[from, to]),
                    (Some(from), Some(to)) => canvas.thin_line(from, to),
                    _ => {}
                }
            }
            for point in arm.points.iter().filter_map(|point| place(*point)) {
                canvas.marker(arm.style, point, 3.0, true);
            }
            canvas.end_series();
            for (label, [x, y]) in arm.labels.iter().zip(arm.points.iter().filter_map(|point| place(*point))) {
                canvas.text([x + 7.0, y - 6.0], Anchor::Start, label);
            }
        }
        frame.finish(any, &self.title, &self.description)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixels of a line's ends.
    fn numbers(svg: &str) -> Vec<f64> {
        let lines = svg.lines().filter(|line| line.contains("<polyline"));
        let points = lines.filter_map(|line| line.split('"').nth(1));
        points.flat_map(|it| it.split([' ', ','])).map(|it| it.parse().unwrap()).collect()
    }

    #[test]
    fn a_length_is_as_long_in_both_directions() {
        for [wide, high] in [[0.2, 0.19], [0.13, 0.3], [7.0, 0.9], [1.0, 1.0]] {
            let lines = vec![[[0.0, 0.0], [wide, 0.0]], [[0.0, 0.0], [0.0, high]]];
            let arms = vec![ArmSeries { name: "a".to_owned(), lines, ..ArmSeries::default() }];
            let text = String::new;
            let plot = ArmPlot { title: text(), description: text(), x_title: text(), y_title: text(), arms };
            let at = numbers(&plot.svg());
            let (across, up) = (at[2] - at[0], at[5] - at[7]);
            assert!((across / wide - up / high).abs() < 0.01 * across / wide, "{wide} {high}: {at:?}");
        }
    }
}
