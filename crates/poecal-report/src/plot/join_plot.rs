//! Two lists that were joined, one above the other, with what belongs to what; of recordings also both speeds, over the same axis.

use super::axis::{PlotAxis, Ruler};
use super::frame::{self, Area, PlotFrame, WIDTH};
use super::line::PlotLine;
use super::svg::Canvas;

/// Height of the area of the speeds, of a list, and of what is between the lists, px.
const SPEEDS: f64 = 130.0;
const LIST: f64 = 14.0;
const BETWEEN: f64 = 40.0;
/// Room between speeds and lists, px.
const GAP: f64 = 16.0;
/// Narrowest entry, px.
const NARROWEST: f64 = 2.0;
const MARKER: f64 = 4.0;

/// An entry of a list: a row, or the time of a stand.
pub struct JoinedEntry {
    pub from: f64,
    pub to: f64,
    /// Oddity of the entry, by its place in [`JoinPlot::oddities`].
    pub odd: Option<usize>,
}

/// A list.
pub struct JoinedList {
    pub name: String,
    /// Ranges with rows: the whole of a list without times, and the times between lost frames of a recording.
    pub present: Vec<[f64; 2]>,
    pub entries: Vec<JoinedEntry>,
}

/// Two lists that were joined.
pub struct JoinPlot {
    pub title: String,
    pub description: String,
    pub x: PlotAxis,
    pub y: PlotAxis,
    /// Speeds; none without times.
    pub lines: Vec<PlotLine>,
    pub lists: [JoinedList; 2],
    /// Positions of a pair of entries in the first list and in the second.
    pub links: Vec<[f64; 2]>,
    /// Names and styles of what is odd.
    pub oddities: Vec<(usize, &'static str)>,
}

impl JoinPlot {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let entries = || self.lists.iter().flat_map(|list| &list.entries);
        let present = || self.lists.iter().flat_map(|list| list.present.iter().flatten());
        let along = entries().flat_map(|it| [it.from, it.to]).chain(present().copied());
        let x = self.x.ruler(along.chain(points().map(|it| it[0])));
        let y = self.y.ruler(points().map(|it| it[1]).filter(|it| !it.is_nan()));
        let mut canvas = Canvas::new();
        let mut legend: Vec<(usize, &str)> =
            self.lists.iter().enumerate().map(|(style, list)| (style, list.name.as_str())).collect();
        legend.extend(self.oddities.iter().enumerate().filter(|it| self.has(it.0)).map(|it| *it.1));
        let below = frame::head(&mut canvas, &self.title, &legend, !self.lines.is_empty());
        let has_speeds = !self.lines.is_empty();
        let top = if has_speeds { frame::vertical_title(&mut canvas, below, &self.y.title) } else { below };
        let lists = top + if has_speeds { SPEEDS + GAP } else { 0.0 };
        let bottom = lists + 2.0 * LIST + BETWEEN;
        let area = Area { left: 56.0, top, right: WIDTH - 20.0, bottom };
        if has_speeds {
            frame::vertical_axis(&mut canvas, &Area { bottom: top + SPEEDS, ..area }, &y);
        }
        let mut frame = PlotFrame::new(canvas, area, (x, &self.x.title), None);
        let speeds = Area { bottom: top + SPEEDS, ..area };
        self.lines.iter().for_each(|line| draw_line(&mut frame, speeds, &y, line));
        let ends = [lists + LIST, lists + LIST + BETWEEN];
        for [one, other] in &self.links {
            if let (Some(one), Some(other)) = (frame.position_across(*one), frame.position_across(*other)) {
                frame.canvas.axis_line([one, ends[0]], [other, ends[1]]);
            }
        }
        for (style, (list, top)) in self.lists.iter().zip([lists, ends[1]]).enumerate() {
            self.draw_list(&mut frame, style, list, top);
        }
        frame.finish(entries().next().is_some(), &self.title, &self.description)
    }

    /// True if any entry has this oddity.
    fn has(&self, oddity: usize) -> bool {
        self.lists.iter().flat_map(|list| &list.entries).any(|it| it.odd == Some(oddity))
    }

    fn draw_list(&self, frame: &mut PlotFrame, style: usize, list: &JoinedList, top: f64) {
        let middle = top + LIST / 2.0;
        for [from, to] in &list.present {
            if let (Some(from), Some(to)) = (frame.position_across(*from), frame.position_across(*to)) {
                frame.canvas.axis_line([from, middle], [to, middle]);
            }
        }
        let styles = std::iter::once((style, None))
            .chain(self.oddities.iter().enumerate().map(|(at, (style, _))| (*style, Some(at))));
        for (style, odd) in styles {
            frame.canvas.begin_series(style);
            for entry in list.entries.iter().filter(|it| it.odd == odd) {
                let (Some(from), Some(to)) = (frame.position_across(entry.from), frame.position_across(entry.to))
                else {
                    continue;
                };
                let half = (0.5 * (to - from)).max(0.5 * NARROWEST);
                let at = 0.5 * (from + to);
                frame.canvas.bar([at - half, top], [at + half, top + LIST]);
                if odd.is_some() {
                    frame.canvas.marker(style, [at, middle], MARKER, true);
                }
            }
            frame.canvas.end_series();
        }
    }
}

/// A line in an area, without markers; where a point is not a number, it is broken.
fn draw_line(frame: &mut PlotFrame, area: Area, y: &Ruler, line: &PlotLine) {
    let place = |&[across, up]: &[f64; 2]| {
        let up = y.place(up).filter(|it| it.inside)?;
        Some([frame.position_across(across)?, area.y(up.share)])
    };
    let places: Vec<Option<[f64; 2]>> = line.points.iter().map(place).collect();
    frame.canvas.begin_series(line.style);
    for piece in places.split(Option::is_none).filter(|it| it.len() > 1) {
        let piece: Vec<[f64; 2]> = piece.iter().copied().flatten().collect();
        frame.canvas.path(line.style, &piece);
    }
    frame.canvas.end_series();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::AxisScale;

    #[test]
    fn any_data_give_well_formed_pictures() {
        for value in [0.0, -1.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            for has_speeds in [false, true] {
                let list = |name: &str| JoinedList {
                    name: name.to_owned(),
                    present: vec![[0.0, value]],
                    entries: vec![
                        JoinedEntry { from: value, to: 1.0, odd: None },
                        JoinedEntry { from: 0.0, to: value, odd: Some(0) },
                    ],
                };
                let line = PlotLine {
                    name: "robot".to_owned(),
                    style: 0,
                    points: vec![[0.0, value], [1.0, 1.0], [value, 2.0]],
                };
                let plot = JoinPlot {
                    title: "a < b".to_owned(),
                    description: String::new(),
                    x: PlotAxis::new("time, s", AxisScale::Linear),
                    y: PlotAxis::new("speed, mm/s", AxisScale::Linear),
                    lines: if has_speeds { vec![line] } else { Vec::new() },
                    lists: [list("robot"), list("measured & all")],
                    links: vec![[value, 1.0], [0.0, 0.0]],
                    oddities: vec![(3, "without partner"), (2, "measured again")],
                };
                let svg = plot.svg();
                let document = roxmltree::Document::parse(&svg).unwrap();
                assert_eq!(document.root_element().attribute("role"), Some("img"));
                assert!(!svg.contains("NaN") && !svg.contains("\"inf"), "{svg}");
                assert!(svg.contains("without partner") && !svg.contains("measured again"), "{svg}");
            }
        }
    }
}
