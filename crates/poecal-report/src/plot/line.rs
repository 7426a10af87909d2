//! Lines with markers over two numeric axes.

use super::AxisMark;
use super::axis::{PlotAxis, Ruler};
use super::frame::{self, Area, PlotFrame, WIDTH};
use super::svg::Canvas;

/// Height of the area of the data, px.
const HEIGHT: f64 = 210.0;
/// Points of a line from which on its markers are small.
const MANY: usize = 25;

/// A line of a [`LinePlot`].
pub struct PlotLine {
    pub name: String,
    /// Which colour, dash and marker: the same thing has the same in every plot.
    pub style: usize,
    pub points: Vec<[f64; 2]>,
}

/// An area between two values at each place, behind the lines.
pub struct Band {
    /// Colour of the line that it belongs to.
    pub style: usize,
    /// Place, and the lower and upper value there.
    pub points: Vec<[f64; 3]>,
}

/// Lines over two axes.
pub struct LinePlot {
    pub title: String,
    pub description: String,
    pub x: PlotAxis,
    pub y: PlotAxis,
    pub lines: Vec<PlotLine>,
    pub mark: Option<AxisMark>,
}

impl LinePlot {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        self.draw(true, None)
    }

    /// The same with the points of the first line alone, not joined.
    pub fn draw_scattered(&self) -> String {
        self.draw(false, None)
    }

    /// The same with a band behind the lines.
    pub fn banded(&self, band: &Band) -> String {
        self.draw(true, Some(band))
    }

    fn draw(&self, joins_first: bool, band: Option<&Band>) -> String {
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let marked = self.mark.iter().map(|mark| mark.at);
        let x = self.x.ruler(points().map(|point| point[0]).chain(marked));
        let ends = band.iter().flat_map(|band| &band.points).flat_map(|point| [point[1], point[2]]);
        let y = self.y.ruler(points().map(|point| point[1]).chain(ends));
        let mut canvas = Canvas::new();
        // Lines of one name are one in pieces. A single one needs no legend: the title says what it is.
        let mut legend: Vec<(usize, &str)> = self.lines.iter().map(|line| (line.style, line.name.as_str())).collect();
        legend.dedup();
        if legend.len() == 1 {
            legend.clear();
        }
        let below = frame::head(&mut canvas, &self.title, &legend, true);
        let top = frame::vertical_title(&mut canvas, below, &self.y.title) + frame::mark_room(self.mark.as_ref());
        let area = Area { left: 56.0, top, right: WIDTH - 20.0, bottom: top + HEIGHT };
        frame::vertical_axis(&mut canvas, &area, &y);
        let mut frame = PlotFrame::new(canvas, area, (x, &self.x.title), self.mark.as_ref());
        band.into_iter().for_each(|band| shade(&mut frame, &y, band));
        for (k, line) in self.lines.iter().enumerate() {
            // Lines that coincide stay visible: the later ones have smaller markers.
            let radius = if line.points.len() > MANY { 2.4 } else { (5.2 - 0.8 * k as f64).max(2.4) };
            draw(&mut frame, &y, line, (radius, k > 0 || joins_first));
        }
        frame.finish(points().next().is_some(), &self.title, &self.description)
    }
}

/// Draws a band; values that are no numbers are left out.
fn shade(frame: &mut PlotFrame, y: &Ruler, band: &Band) {
    let PlotFrame { canvas, area, x, .. } = frame;
    let edge = |k: usize, point: &[f64; 3]| Some([area.x(x.place(point[0])?.share), area.y(y.place(point[k])?.share)]);
    let lower = band.points.iter().filter_map(|point| edge(1, point));
    let upper = band.points.iter().rev().filter_map(|point| edge(2, point));
    let around: Vec<[f64; 2]> = lower.chain(upper).collect();
    canvas.begin_series(band.style);
    canvas.band(&around);
    canvas.end_series();
}

/// Draws a line, with markers of this radius, and joined or not; where a point is not a number, it is broken.
fn draw(frame: &mut PlotFrame, y: &Ruler, line: &PlotLine, (radius, is_joined): (f64, bool)) {
    let PlotFrame { canvas, area, x, unshown } = frame;
    let mut pieces: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    let mut markers = Vec::new();
    for &[across_value, up_value] in &line.points {
        let (Some(across), Some(up)) = (x.place(across_value), y.place(up_value)) else {
            unshown.not_numbers += 1;
            pieces.push(Vec::new());
            continue;
        };
        let at = [area.x(across.share), area.y(up.share)];
        let inside = across.inside && up.inside;
        if !inside {
            unshown.count_beyond(if up.inside { across_value } else { up_value });
        }
        markers.push((at, inside));
        if let Some(piece) = pieces.last_mut() {
            piece.push(at);
        }
    }
    canvas.begin_series(line.style);
    for piece in pieces.iter().filter(|piece| is_joined && piece.len() > 1) {
        canvas.path(line.style, piece);
    }
    for (at, inside) in markers {
        canvas.marker(line.style, at, radius, inside);
    }
    canvas.end_series();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::AxisScale;

    fn plot(scale: AxisScale, lines: Vec<Vec<[f64; 2]>>) -> String {
        let line = |(style, points)| PlotLine { name: format!("line <{style}>"), style, points };
        let plot = LinePlot {
            title: "A & B".to_owned(),
            description: "lines".to_owned(),
            x: PlotAxis::new("iteration", AxisScale::Count),
            y: PlotAxis::new("error, mm", scale),
            lines: lines.into_iter().enumerate().map(line).collect(),
            mark: Some(AxisMark { at: 2.5, label: "rank 2".to_owned() }),
        };
        plot.svg()
    }

    #[test]
    fn any_data_give_well_formed_pictures() {
        let odd = [0.0, -1.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        let sets = odd.iter().map(|v| vec![vec![[0.0, *v]]]).chain([
            vec![],
            vec![vec![]],
            vec![odd.iter().map(|v| [*v, *v]).collect(), vec![[1.0, 1.0]]],
        ]);
        for lines in sets {
            for scale in [AxisScale::Linear, AxisScale::Log, AxisScale::Count] {
                let svg = plot(scale, lines.clone());
                let document = roxmltree::Document::parse(&svg).unwrap();
                assert_eq!(document.root_element().attribute("role"), Some("img"));
                assert!(!svg.contains("NaN") && !svg.contains("\"inf"), "{svg}");
            }
        }
    }

    #[test]
    fn a_band_lies_behind_the_lines_and_within_the_axis() {
        let line = PlotLine { name: "line".to_owned(), style: 1, points: vec![[0.0, 0.0], [1.0, 0.1]] };
        let plot = LinePlot {
            title: "A".to_owned(),
            description: "a line in a band".to_owned(),
            x: PlotAxis::new("x", AxisScale::Linear),
            y: PlotAxis::new("y", AxisScale::Linear),
            lines: vec![line],
            mark: None,
        };
        let svg = plot.banded(&Band { style: 1, points: vec![[0.0, -9.0, 9.0], [1.0, f64::NAN, 9.0]] });
        let (band, line) = (svg.find("fill-opacity").unwrap(), svg.find("<polyline").unwrap());
        assert!(band < line && !svg.contains("NaN"), "{svg}");
        // The axis reaches the ends of the band.
        assert!(svg.contains(">10<") && svg.contains(">−10<"), "{svg}");
    }

    #[test]
    fn zero_on_a_log_axis_is_hollow_and_noted() {
        let svg = plot(AxisScale::Log, vec![vec![[0.0, 1.0], [1.0, 0.0], [2.0, f64::NAN]]]);
        assert_eq!(svg.matches("class=\"hollow\"").count(), 1);
        assert!(svg.contains("Hollow: exactly zero (1).") && svg.contains("Not drawn: 1"));
    }

    #[test]
    fn the_same_data_give_the_same_bytes() {
        let lines = vec![vec![[0.0, 1.0], [1.0, 0.3]], vec![[0.0, 2.0]]];
        assert_eq!(plot(AxisScale::Log, lines.clone()), plot(AxisScale::Log, lines));
    }
}
