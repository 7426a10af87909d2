//! A robot in many configurations, seen from a side.

use super::axis::{AxisScale, PlotAxis};
use super::frame::{self, Area, PlotFrame, WIDTH};
use super::svg::Canvas;

/// Largest height of the area of the data, px.
const HIGHEST: f64 = 420.0;

/// Lines and points of one series of an [`ArmPlot`].
pub struct ArmSeries {
    pub name: String,
    pub style: usize,
    pub lines: Vec<[[f64; 2]; 2]>,
    /// Whether lines are drawn so that others show through.
    pub is_thin: bool,
    /// Points that are marked.
    pub points: Vec<[f64; 2]>,
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
        // One scale for both: the narrower of the two ranges is widened.
        let [wide, high] = ranges.map(|(low, high)| (high - low).max(1e-3));
        let height = (high * (right - left) / wide).clamp(120.0, HIGHEST);
        let per_px = (wide / (right - left)).max(high / height);
        let widened = |(low, high): (f64, f64), px: f64| {
            let (middle, half) = (0.5 * (low + high), 0.5 * per_px * px);
            [middle - half, middle + half]
        };
        let x =
            PlotAxis::new(&self.x_title, AxisScale::Linear).with_values(&widened(ranges[0], right - left));
        let y = PlotAxis::new(&self.y_title, AxisScale::Linear).with_values(&widened(ranges[1], height));
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
        }
        frame.finish(any, &self.title, &self.description)
    }
}
