//! A map of square cells: the stronger the colour of a cell, the larger its value, which stands in it.

use super::frame::{Area, WIDTH, head, vertical_title};
use super::svg::{Anchor, Canvas, text_width};
use crate::shade::share;

/// Largest side of a cell, and height of all of them, px.
const LARGEST: f64 = 46.0;
const HEIGHT: f64 = 480.0;
/// Room for the labels at the left and the right, px.
const LEFT: f64 = 44.0;
const RIGHT: f64 = 24.0;
/// Room for the scale below the axis, px.
const SCALE: f64 = 34.0;
const MARGIN: f64 = 10.0;
/// Longest arrow as a part of a cell, and the angle of its head, rad.
const ARROW: f64 = 0.75;
const HEAD: f64 = 0.5;
/// Boxes of the scale.
const BOXES: usize = 24;
/// Distance of labels along an axis, px.
const APART: f64 = 44.0;

/// A cell of a [`HeatMap`].
pub struct HeatCell {
    /// Steps from the origin to its corner that is nearest to it.
    pub at: [i64; 2],
    pub value: f64,
    /// Arrow that is drawn in it, along the axes.
    pub arrow: Option<[f64; 2]>,
    /// Text under a resting pointer.
    pub told: String,
}

/// A map of square cells.
pub struct HeatMap {
    pub title: String,
    pub description: String,
    /// Titles of the horizontal and the vertical axis.
    pub axes: [String; 2],
    /// Side of a cell, in the unit of the axes.
    pub cell: f64,
    /// True if the vertical axis counts downwards, as the rows of an image.
    pub downwards: bool,
    /// Name of the values, with their unit.
    pub values: String,
    /// The same of the arrows, if there are any.
    pub arrows: String,
    pub cells: Vec<HeatCell>,
}

/// A value with as many decimals as the largest of the map needs.
fn format_value(value: f64, largest: f64) -> String {
    let decimals = if largest < 10.0 { 2 } else { usize::from(largest < 100.0) };
    format!("{value:.decimals$}")
}

impl HeatMap {
    /// The map as SVG.
    pub fn svg(&self) -> String {
        let mut canvas = Canvas::new();
        let top = head(&mut canvas, &self.title, &[], false);
        let top = vertical_title(&mut canvas, top, &self.axes[1]);
        let steps = |axis: usize| {
            let all = self.cells.iter().map(|cell| cell.at[axis]);
            (all.clone().min().unwrap_or(0), all.max().unwrap_or(0) + 1)
        };
        let ends = [steps(0), steps(1)];
        let [columns, rows] = ends.map(|(from, to)| (to - from).max(1) as f64);
        let side = ((WIDTH - LEFT - RIGHT) / columns).min(HEIGHT / rows).min(LARGEST);
        let area = Area { left: LEFT, top, right: LEFT + side * columns, bottom: top + side * rows };
        let values = self.cells.iter().map(|cell| cell.value).filter(|value| value.is_finite());
        let largest = values.fold(0.0, f64::max);
        let longest = self.longest_arrow();
        for cell in &self.cells {
            let [column, row] = [cell.at[0] - ends[0].0, cell.at[1] - ends[1].0].map(|it| it as f64);
            let down = if self.downwards { row } else { rows - 1.0 - row };
            let (left, top) = (area.left + side * column, area.top + side * down);
            canvas.cell([left, top], side, share(cell.value, largest), &cell.told);
            let text = format_value(cell.value, largest);
            let middle = if longest > 0.0 { 0.82 } else { 0.5 };
            if text_width(&text) <= 1.15 * side {
                canvas.small_text([left + 0.5 * side, top + middle * side + 3.5], Anchor::Middle, &text);
            }
            let is_drawn = |arrow: &[f64; 2]| longest > 0.0 && arrow.iter().all(|it| it.is_finite());
            if let Some(arrow) = cell.arrow.filter(is_drawn) {
                let down = if self.downwards { arrow[1] } else { -arrow[1] };
                let reach = ARROW * side / longest;
                draw_arrow(&mut canvas, [left + 0.5 * side, top + 0.4 * side], [reach * arrow[0], reach * down]);
            }
        }
        self.axes(&mut canvas, &area, side, ends);
        let bottom = self.scale(&mut canvas, area.bottom + 33.0, largest);
        canvas.finish(WIDTH, bottom + MARGIN, &self.title, &self.description)
    }

    /// Length of the longest arrow.
    fn longest_arrow(&self) -> f64 {
        let lengths = self.cells.iter().filter_map(|cell| cell.arrow).map(|[x, y]| x.hypot(y));
        lengths.filter(|it| it.is_finite()).fold(0.0, f64::max)
    }

    /// Lines and labels of both axes, at the edges of cells.
    fn axes(&self, canvas: &mut Canvas, area: &Area, side: f64, ends: [(i64, i64); 2]) {
        let every = (APART / side).ceil().max(1.0) as i64;
        let decimals = (-self.cell.log10().floor()).max(0.0) as usize;
        let label = |step: i64| format!("{:.decimals$}", step as f64 * self.cell).replace('-', "−");
        let labelled = |(from, to): (i64, i64)| (from..=to).filter(move |step| step.rem_euclid(every) == 0);
        for step in labelled(ends[0]) {
            let x = area.left + side * (step - ends[0].0) as f64;
            canvas.axis_line([x, area.bottom], [x, area.bottom + 4.0]);
            canvas.text([x, area.bottom + 16.0], Anchor::Middle, &label(step));
        }
        for step in labelled(ends[1]) {
            let along = side * (step - ends[1].0) as f64;
            let y = if self.downwards { area.top + along } else { area.bottom - along };
            canvas.axis_line([area.left - 4.0, y], [area.left, y]);
            canvas.text([area.left - 7.0, y + 4.0], Anchor::End, &label(step));
        }
        canvas.axis_line([area.left, area.bottom], [area.right, area.bottom]);
        canvas.axis_line([area.left, area.top], [area.left, area.bottom]);
        canvas.axis_title([area.left, area.bottom + 32.0], Anchor::Start, &self.axes[0]);
    }

    /// Draws the legend of the colours, and returns the y below.
    fn scale(&self, canvas: &mut Canvas, top: f64, largest: f64) -> f64 {
        const BOX: f64 = 12.0;
        const WIDE: f64 = 5.5;
        let y = top + SCALE - BOX;
        canvas.text([LEFT, y + 10.0], Anchor::Start, "0");
        let mut x = LEFT + text_width("0") + 6.0;
        for level in 0..=BOXES {
            canvas.swatch([x, y], [WIDE, BOX], level as f64 / BOXES as f64);
            x += WIDE;
        }
        let longest = self.longest_arrow();
        let arrows = if longest > 0.0 {
            format!("; arrows to {} {}", format_value(longest, longest), self.arrows)
        } else {
            String::new()
        };
        let words = format!("{} {}{arrows}", format_value(largest, largest), self.values);
        canvas.text([x + 6.0, y + 10.0], Anchor::Start, &words);
        y + BOX
    }
}

/// A line from its middle to both sides, with a head.
fn draw_arrow(canvas: &mut Canvas, [x, y]: [f64; 2], [along, down]: [f64; 2]) {
    let (from, to) = ([x - 0.5 * along, y - 0.5 * down], [x + 0.5 * along, y + 0.5 * down]);
    canvas.axis_line(from, to);
    for side in [HEAD, -HEAD] {
        let (sin, cos) = side.sin_cos();
        let back = [cos * along - sin * down, sin * along + cos * down].map(|it| 0.3 * it);
        canvas.axis_line(to, [to[0] - back[0], to[1] - back[1]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(values: &[f64]) -> HeatMap {
        let cell = |(k, &value): (usize, &f64)| HeatCell {
            at: [k as i64 % 3, k as i64 / 3 - 1],
            value,
            arrow: Some([value, -1.0]).filter(|_| k % 2 == 0),
            told: "a < b".to_owned(),
        };
        HeatMap {
            title: "Map".to_owned(),
            description: String::new(),
            axes: ["r, m".to_owned(), "z, m".to_owned()],
            cell: 0.2,
            downwards: values.len() == 2,
            values: "mm".to_owned(),
            arrows: "mm".to_owned(),
            cells: values.iter().enumerate().map(cell).collect(),
        }
    }

    #[test]
    fn any_values_give_well_formed_pictures() {
        let odd = [0.0, 1.0, 1e-300, 1e300, f64::INFINITY, f64::NAN];
        for values in [&odd[..], &odd[..1], &[], &[2.0, 2.0]] {
            let svg = map(values).svg();
            let picture = roxmltree::Document::parse(&svg).unwrap();
            let cells = picture.descendants().filter(|it| it.has_tag_name("title")).count() - 1;
            assert_eq!(cells, values.len());
            assert!(!svg.contains("=\"NaN") && !svg.contains("=\"inf"), "{svg}");
        }
    }

    #[test]
    fn colours_begin_at_zero() {
        let svg = map(&[0.0983, 0.1004]).svg();
        for share in ["--share:0.979", "--share:1.000", "--share:0.000"] {
            assert!(svg.contains(share), "{share}");
        }
    }
}
