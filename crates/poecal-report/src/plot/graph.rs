//! Charts of many rows: dots, lines and areas as wide as their place, with text of one size at any width.
//!
//! Drawings lie in a view of whole numbers, two to the px, which is stretched to its place; strokes and text are not. A series of dots is
//! one path of lines without length, whose round ends are seen (of square ones half a px, since paper shows none without length): `m12 -7h0` is a dot, from the one before, and `m0 0` a row without one, so that
//! a script finds the row of each dot by counting; a series of none has an empty path.

use std::fmt::Write as _;

use maud::{Markup, html};

use super::axis::{PlotAxis, Ruler};

/// Units of the view to the px of its height.
const FINE: f64 = 2.0;

/// A series of dots.
pub struct DotSeries {
    /// Its classes, the first of which is its colour.
    pub class: &'static str,
    /// Width of a dot, px.
    pub size: u8,
    /// A place for each row, if it has one.
    pub points: Vec<Option<[f64; 2]>>,
}

impl DotSeries {
    /// True if its dots are squares: beside its colour a series has a shape.
    fn is_square(&self) -> bool {
        self.class == "s1"
    }
}

/// Lines or areas of one class.
pub struct PlotShape {
    pub class: &'static str,
    pub pieces: Vec<Vec<[f64; 2]>>,
}

/// A vertical axis with what belongs to it. Of several the first is shown, until a script shows another.
pub struct VerticalAxis {
    pub y: PlotAxis,
    /// Words instead of the picture.
    pub spoken: String,
    pub shapes: Vec<PlotShape>,
}

/// Dots over two axes.
pub struct Graph {
    pub x: PlotAxis,
    /// Height of the area of the data, px, and a usual width of it.
    pub size: [f64; 2],
    /// Places are along the first of the vertical axes.
    pub dots: Vec<DotSeries>,
    pub sides: Vec<VerticalAxis>,
}

/// A rectangle of whole numbers for the data.
struct PlotArea {
    width: f64,
    height: f64,
    x: Ruler,
}

impl PlotArea {
    /// Place of a point; none if it is beyond the axes.
    fn place(&self, y: &Ruler, point: [f64; 2]) -> Option<[i32; 2]> {
        let [across, up] = [self.x.place(point[0])?, y.place(point[1])?];
        (across.inside && up.inside).then(|| self.round_point(across.share, up.share))
    }

    /// The same, with what is beyond the vertical axis at its end.
    fn clip_point(&self, y: &Ruler, point: [f64; 2]) -> Option<[i32; 2]> {
        Some(self.round_point(self.x.place(point[0])?.share, y.place(point[1])?.share))
    }

    fn round_point(&self, across: f64, up: f64) -> [i32; 2] {
        [(across * self.width).round() as i32, ((1.0 - up) * self.height).round() as i32]
    }

    fn dots(&self, y: &Ruler, dots: &DotSeries) -> String {
        let mut path = String::with_capacity(9 * dots.points.len());
        if dots.points.iter().all(Option::is_none) {
            return path;
        }
        let mut last = [0, 0];
        let length = i32::from(dots.is_square());
        for point in &dots.points {
            match point.and_then(|point| self.place(y, point)) {
                Some(at) => {
                    step(&mut path, 'm', last, at);
                    path.push_str(if length == 0 { "h0" } else { "h1" });
                    last = [at[0] + length, at[1]];
                }
                None => path.push_str("m0 0"),
            }
        }
        path
    }

    fn lines(&self, y: &Ruler, pieces: &[Vec<[f64; 2]>]) -> String {
        let mut path = String::new();
        let mut last = [0, 0];
        for piece in pieces {
            let places: Vec<[i32; 2]> = piece.iter().filter_map(|point| self.clip_point(y, *point)).collect();
            for (k, at) in straighten_line(&places).into_iter().enumerate() {
                step(&mut path, if k == 0 { 'm' } else { 'l' }, last, at);
                last = at;
            }
        }
        path
    }

    /// Lines of the grid at the ticks of the vertical axis.
    fn level(&self, y: &Ruler) -> String {
        let at = |share: f64| self.round_point(0.0, share)[1];
        y.ticks.iter().map(|(share, _)| format!("M0 {}H{}", at(*share), self.width)).collect()
    }

    /// The same of the horizontal one.
    fn vertical_grid(&self) -> String {
        let at = |share: f64| self.round_point(share, 0.0)[0];
        self.x.ticks.iter().map(|(share, _)| format!("M{} 0V{}", at(*share), self.height)).collect()
    }
}

/// Writes a step of a path. Writing to a String cannot fail.
fn step(path: &mut String, command: char, from: [i32; 2], to: [i32; 2]) {
    let [across, down] = [to[0] - from[0], to[1] - from[1]];
    let space = if down < 0 { "" } else { " " };
    let _ = write!(path, "{command}{across}{space}{down}");
}

/// A line without the places that lie on the way between others, to a unit.
fn straighten_line(places: &[[i32; 2]]) -> Vec<[i32; 2]> {
    let mut kept: Vec<[i32; 2]> = Vec::new();
    let mut from = 0;
    for (k, place) in places.iter().enumerate() {
        let Some(first) = places.get(from) else { break };
        let Some(next) = places.get(k + 1).filter(|_| k > 0) else {
            kept.push(*place);
            from = k;
            continue;
        };
        let [dx, dy] = [next[0] - first[0], next[1] - first[1]];
        let off = |it: &[i32; 2]| 2 * (dx * (it[1] - first[1]) - dy * (it[0] - first[0])).abs();
        let is_between = |it: &[i32; 2]| off(it) <= 2 * dx.abs().max(dy.abs());
        if !places.get(from..=k).unwrap_or_default().iter().all(is_between) {
            kept.push(*place);
            from = k;
        }
    }
    kept
}

/// A share of the place as a length.
fn percent(share: f64) -> String {
    format!("{:.1}%", 100.0 * share)
}

impl Graph {
    /// The chart as SVG, for a page whose style sheet has its classes.
    pub fn svg(&self) -> Markup {
        let [width, height] = self.size;
        let view = PlotArea { width: FINE * width, height: FINE * height, x: self.x.ruler(std::iter::empty()) };
        let rulers: Vec<Ruler> = self.sides.iter().map(|side| side.y.ruler(std::iter::empty())).collect();
        let spoken = self.sides.first().map_or("", |side| &side.spoken);
        let [low, high] = view.x.ends();
        let mark = |side: usize| (self.sides.len() > 1).then_some(side);
        html! {
            svg.graph role="img" aria-label=(spoken) height=(height) {
                svg viewBox={ "0 0 " (view.width) " " (view.height) } preserveAspectRatio="none" {
                    path.grid d=(view.vertical_grid()) {}
                    @for (k, y) in rulers.iter().enumerate() { path.grid data-side=[mark(k)] hidden[k > 0] d=(view.level(y)) {} }
                    @for dots in self.dots.iter().filter(|it| !it.points.is_empty()) {
                        path.dots.(dots.class) stroke-linecap=(if dots.is_square() { "square" } else { "round" }) stroke-width=(dots.size) d=(rulers.first().map(|y| view.dots(y, dots)).unwrap_or_default()) {}
                    }
                    @for (k, (side, y)) in self.sides.iter().zip(&rulers).enumerate() {
                        g data-side=[mark(k)] hidden[k > 0] {
                            @for shape in &side.shapes { path class=(shape.class) d=(view.lines(y, &shape.pieces)) {} }
                        }
                    }
                }
                g.x data-low=(low) data-high=(high) { @for (share, label) in &view.x.ticks { text x=(percent(*share)) y="100%" { (label) } } }
                @for (k, (side, y)) in self.sides.iter().zip(&rulers).enumerate() {
                    @let [low, high] = y.ends();
                    g.y data-side=[mark(k)] data-spoken=[mark(k).map(|_| &side.spoken)] data-low=[mark(k).map(|_| low)] data-high=[mark(k).map(|_| high)] hidden[k > 0] {
                        @for (share, label) in &y.ticks { text y=(percent(1.0 - share)) { (label) } }
                        text.title { (side.y.title) }
                    }
                }
                text.title x="50%" y="100%" { (self.x.title) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::AxisScale;

    /// Dots as the page's script reads them: places in the view, none of rows without one.
    fn dots(svg: &str) -> Vec<Option<[i32; 2]>> {
        let path = svg.split_once("class=\"dots").unwrap().1.split_once(" d=\"").unwrap().1;
        let path = path.split_once('"').unwrap().0;
        let mut at = [0, 0];
        let dot = |text: &str| {
            let drawn = text.strip_suffix("h0");
            let numbers = drawn.unwrap_or(text);
            let cut = numbers.rfind(['-', ' ']).unwrap();
            at =
                [at[0] + numbers[..cut].parse::<i32>().unwrap(), at[1] + numbers[cut..].trim().parse::<i32>().unwrap()];
            drawn.map(|_| at)
        };
        path.split('m').skip(1).map(dot).collect()
    }

    fn graph(points: Vec<Option<[f64; 2]>>, line: Vec<[f64; 2]>) -> String {
        let side = VerticalAxis {
            y: PlotAxis::new("error < 1, mm", AxisScale::Linear).with_values(&[0.0, 4.0]),
            spoken: "a \"chart\"".to_owned(),
            shapes: vec![PlotShape { class: "ink", pieces: vec![line] }],
        };
        let x = PlotAxis::new("row", AxisScale::Linear).with_values(&[0.0, 10.0]);
        let dots = vec![DotSeries { class: "s0", size: 3, points }];
        Graph { x, size: [100.0, 50.0], dots, sides: vec![side] }.svg().into_string()
    }

    #[test]
    fn each_row_has_its_dot_or_the_lack_of_one() {
        let points =
            vec![Some([0.0, 0.0]), None, Some([10.0, 4.0]), Some([5.0, f64::NAN]), Some([5.0, 9.0]), Some([5.0, 1.0])];
        let svg = graph(points, Vec::new());
        // 3 % of room at each end of 200 and 100 units.
        assert_eq!(dots(&svg), [Some([6, 97]), None, Some([194, 3]), None, None, Some([100, 74])]);
        roxmltree::Document::parse(&svg).unwrap();
    }

    #[test]
    fn places_on_the_way_of_a_line_are_left_out() {
        let line = (0..=10).map(|k| [f64::from(k), f64::from(k.min(5))]).collect();
        let svg = graph(Vec::new(), line);
        // Up to 4, where the axis ends but for its room, and along that end.
        let path = svg.split_once("class=\"ink\" d=\"").unwrap().1.split_once('"').unwrap().0;
        assert!(path.starts_with("m6 97l") && path.matches('l').count() <= 3, "{path}");
    }

    #[test]
    fn any_data_give_well_formed_pictures() {
        for value in [0.0, -1.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let svg = graph(vec![Some([value, value])], vec![[value, 1.0], [0.0, value]]);
            roxmltree::Document::parse(&svg).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
