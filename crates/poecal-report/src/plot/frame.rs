//! Frame of all plots: title, legend, axes and notes around an area for the data.

use super::AxisMark;
use super::axis::Ruler;
use super::svg::{Anchor, Canvas, text_width, wrap_text};

/// Width of every plot, px.
pub(crate) const WIDTH: f64 = 440.0;
const MARGIN: f64 = 10.0;
const LINE: f64 = 17.0;
/// Size of a marker in the legend, px.
const LEGEND_MARKER: f64 = 4.0;
/// Room for a marker and its dash in the legend, px.
const LEGEND_KEY: f64 = 28.0;
/// Room between the entries of the legend, px.
const LEGEND_GAP: f64 = 8.0;

/// The area of the data, px.
#[derive(Clone, Copy)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Area {
    pub(crate) fn x(&self, share: f64) -> f64 {
        self.left + share * (self.right - self.left)
    }

    pub(crate) fn y(&self, share: f64) -> f64 {
        self.bottom - share * (self.bottom - self.top)
    }
}

/// Values that an axis could not show.
#[derive(Default)]
pub(crate) struct HiddenValues {
    zero: usize,
    infinite: usize,
    other: usize,
    pub(crate) not_numbers: usize,
}

impl HiddenValues {
    /// Counts a value that is drawn at an end of its axis.
    pub(crate) fn count_beyond(&mut self, value: f64) {
        let count = match value {
            0.0 => &mut self.zero,
            value if value.is_infinite() => &mut self.infinite,
            _ => &mut self.other,
        };
        *count += 1;
    }
}

/// A plot in the making: an area for the data, below the title and the legend, and the horizontal axis below it.
pub(crate) struct PlotFrame {
    pub(crate) canvas: Canvas,
    pub(crate) area: Area,
    /// The horizontal axis.
    pub(crate) x: Ruler,
    pub(crate) unshown: HiddenValues,
}

impl PlotFrame {
    /// A frame around an area, with its horizontal axis, and its mark, for which there is [`mark_room`].
    pub(crate) fn new(canvas: Canvas, area: Area, (x, title): (Ruler, &str), mark: Option<&AxisMark>) -> Self {
        let mut frame = PlotFrame { canvas, area, x, unshown: HiddenValues::default() };
        frame.horizontal_axis(title, mark);
        frame
    }

    /// A frame around rows of a height, with room for their labels.
    pub(crate) fn of_rows(
        title: &str,
        legend: &[(usize, &str)],
        (labels, height): (&[&str], f64),
        x: (Ruler, &str),
        mark: Option<&AxisMark>,
    ) -> Self {
        let mut canvas = Canvas::new();
        let top = head(&mut canvas, title, legend, false) + mark_room(mark);
        let widest = labels.iter().map(|label| text_width(label)).fold(0.0, f64::max);
        let bottom = top + height * labels.len().max(1) as f64;
        // Long labels take from the data, but not more than half.
        let left = (widest + 18.0).clamp(40.0, WIDTH / 2.0);
        PlotFrame::new(canvas, Area { left, top, right: WIDTH - 24.0, bottom }, x, mark)
    }

    /// Position of a value along the horizontal axis, px; `None` if it is not a number.
    pub(crate) fn position_across(&self, value: f64) -> Option<f64> {
        self.x.place(value).map(|place| self.area.x(place.share))
    }

    /// The label of a row, to the left of the area.
    pub(crate) fn row_label(&mut self, y: f64, label: &str) {
        self.canvas.text([self.area.left - 8.0, y + 4.0], Anchor::End, label);
    }

    /// The line to the left of the area.
    pub(crate) fn left_line(&mut self) {
        let Area { left, top, bottom, .. } = self.area;
        self.canvas.axis_line([left, top], [left, bottom]);
    }

    /// Grid, ticks and title of the horizontal axis, and its mark.
    fn horizontal_axis(&mut self, title: &str, mark: Option<&AxisMark>) {
        let PlotFrame { canvas, area, x: ruler, .. } = self;
        for (share, label) in &ruler.ticks {
            let x = area.x(*share);
            canvas.grid_line([x, area.top], [x, area.bottom]);
            canvas.text([x, area.bottom + 15.0], Anchor::Middle, label);
        }
        canvas.axis_line([area.left, area.bottom], [area.right, area.bottom]);
        canvas.axis_title([(area.left + area.right) / 2.0, area.bottom + 33.0], Anchor::Middle, title);
        let Some(mark) = mark else { return };
        let Some(place) = ruler.place(mark.at) else { return };
        let x = area.x(place.share);
        canvas.mark_line([x, area.top - 4.0], [x, area.bottom]);
        // The label ends with the plot at the latest, and begins with it at the earliest.
        let half = text_width(&mark.label) / 2.0;
        let middle = x.min(WIDTH - MARGIN - half).max(MARGIN + half);
        canvas.text([middle, area.top - 8.0], Anchor::Middle, &mark.label);
    }

    /// The whole plot with notes below its axes. `any` says whether there is a value.
    pub(crate) fn finish(mut self, any: bool, title: &str, description: &str) -> String {
        let unshown = &self.unshown;
        let mut notes = Vec::new();
        if !any {
            notes.push("There are no values.".to_owned());
        }
        for (count, words) in
            [(unshown.zero, "exactly zero"), (unshown.infinite, "infinite"), (unshown.other, "beyond the axis")]
        {
            if count > 0 {
                notes.push(format!("Hollow: {words} ({count})."));
            }
        }
        if unshown.not_numbers > 0 {
            notes.push(format!("Not drawn: {}, not a number.", unshown.not_numbers));
        }
        let mut y = self.area.bottom + 33.0;
        for note in notes {
            y += LINE;
            self.canvas.text([MARGIN, y], Anchor::Start, &note);
        }
        self.canvas.finish(WIDTH, y + MARGIN, title, description)
    }
}

/// Title and legend; gives the y below them.
pub(crate) fn head(canvas: &mut Canvas, title: &str, legend: &[(usize, &str)], dashes: bool) -> f64 {
    let mut y = MARGIN + 8.0;
    for line in wrap_text(title, WIDTH - 2.0 * MARGIN) {
        canvas.bold_text([MARGIN, y], &line);
        y += LINE;
    }
    let mut x = MARGIN;
    for (style, name) in legend {
        let width = LEGEND_KEY + text_width(name) + LEGEND_GAP;
        if x > MARGIN && x + width > WIDTH {
            x = MARGIN;
            y += LINE;
        }
        let key = y - 4.0;
        canvas.begin_series(*style);
        if dashes {
            canvas.path(*style, &[[x, key], [x + LEGEND_KEY - 6.0, key]]);
        }
        canvas.marker(*style, [x + (LEGEND_KEY - 6.0) / 2.0, key], LEGEND_MARKER, true);
        canvas.end_series();
        canvas.text([x + LEGEND_KEY, y], Anchor::Start, name);
        x += width;
    }
    if legend.is_empty() { y } else { y + LINE + 3.0 }
}

/// The title of the vertical axis, above it; gives the y below.
pub(crate) fn vertical_title(canvas: &mut Canvas, y: f64, title: &str) -> f64 {
    canvas.axis_title([MARGIN, y], Anchor::Start, title);
    y + 13.0
}

/// Grid and ticks of the vertical axis.
pub(crate) fn vertical_axis(canvas: &mut Canvas, area: &Area, ruler: &Ruler) {
    for (share, label) in &ruler.ticks {
        let y = area.y(*share);
        canvas.grid_line([area.left, y], [area.right, y]);
        canvas.text([area.left - 6.0, y + 4.0], Anchor::End, label);
    }
    canvas.axis_line([area.left, area.top], [area.left, area.bottom]);
}

/// Room for a mark's label above the data.
pub(crate) fn mark_room(mark: Option<&AxisMark>) -> f64 {
    if mark.is_some() { LINE } else { 0.0 }
}
