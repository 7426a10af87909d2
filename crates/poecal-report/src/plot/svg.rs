//! SVG elements as text, coordinates with two decimals.

use std::fmt::Write as _;

use maud::Render;

use poecal_numerics::text::visible_markup;

/// A series' colour (Okabe and Ito's, which colour-blind people tell apart), dash and marker.
struct Style {
    colour: &'static str,
    dash: &'static str,
    marker: MarkerSymbol,
}

#[derive(Clone, Copy)]
enum MarkerSymbol {
    Circle,
    Square,
    Triangle,
    Diamond,
}

const STYLES: [Style; 4] = [
    Style { colour: "#0072b2", dash: "none", marker: MarkerSymbol::Circle },
    Style { colour: "#d55e00", dash: "7 3", marker: MarkerSymbol::Square },
    Style { colour: "#00805e", dash: "2 3", marker: MarkerSymbol::Triangle },
    Style { colour: "#a8487f", dash: "9 3 2 3", marker: MarkerSymbol::Diamond },
];

/// Alignment of text relative to its point.
#[derive(Clone, Copy)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Width of text at 12 px, estimated from above for common sans-serif fonts.
pub(crate) fn text_width(text: &str) -> f64 {
    6.7 * text.chars().count() as f64
}

/// Text broken between words into lines of at most `width` px.
pub(crate) fn wrap_text(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(line) + text_width(word) + text_width(" ") <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Points of a line.
fn join_points(points: &[[f64; 2]]) -> String {
    let points: Vec<String> = points.iter().map(|&[x, y]| format!("{x:.2},{y:.2}")).collect();
    points.join(" ")
}

/// An SVG in the making. Coordinates are in px, x to the right and y down.
pub(crate) struct Canvas {
    body: String,
}

impl Canvas {
    pub(crate) fn new() -> Self {
        Canvas { body: String::new() }
    }

    /// Writes to a String, which cannot fail.
    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    pub(crate) fn text(&mut self, at: [f64; 2], anchor: Anchor, text: &str) {
        self.styled_text(at, anchor, text, "ink", "");
    }

    /// The title of an axis, which a style sheet can tell from other text.
    pub(crate) fn axis_title(&mut self, at: [f64; 2], anchor: Anchor, text: &str) {
        self.styled_text(at, anchor, text, "ink axis-title", "");
    }

    pub(crate) fn bold_text(&mut self, at: [f64; 2], text: &str) {
        self.styled_text(at, Anchor::Start, text, "ink", " font-weight=\"600\"");
    }

    fn styled_text(&mut self, [x, y]: [f64; 2], anchor: Anchor, text: &str, class: &str, style: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = text.render().into_string();
        self.put(format_args!(
            r##"<text class="{class}" x="{x:.2}" y="{y:.2}" text-anchor="{anchor}" fill="#1f2933"{style}>{text}</text>"##
        ));
    }

    pub(crate) fn grid_line(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.neutral_line("grid", "#d9dde3", from, to, "");
    }

    pub(crate) fn axis_line(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.neutral_line("axis", "#52606d", from, to, "");
    }

    pub(crate) fn mark_line(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.neutral_line("axis", "#52606d", from, to, " stroke-dasharray=\"4 3\"");
    }

    fn neutral_line(&mut self, class: &str, colour: &str, [x, y]: [f64; 2], [to_x, to_y]: [f64; 2], dash: &str) {
        self.put(format_args!(
            r#"<line class="{class}" x1="{x:.2}" y1="{y:.2}" x2="{to_x:.2}" y2="{to_y:.2}" stroke="{colour}"{dash}/>"#
        ));
    }

    /// Begins the marks of a series.
    pub(crate) fn begin_series(&mut self, style: usize) {
        let class = style % STYLES.len();
        let colour = STYLES[class].colour;
        self.put(format_args!(r#"<g class="s{class}" color="{colour}" stroke="currentColor" fill="currentColor">"#));
    }

    /// Ends the marks of a series.
    pub(crate) fn end_series(&mut self) {
        self.put(format_args!("</g>"));
    }

    /// A line through points, in the series' dash.
    pub(crate) fn path(&mut self, style: usize, points: &[[f64; 2]]) {
        let dash = STYLES[style % STYLES.len()].dash;
        let points = join_points(points);
        self.put(format_args!(
            r#"<polyline points="{points}" fill="none" stroke-width="1.6" stroke-dasharray="{dash}"/>"#
        ));
    }

    /// A thin line of a series, which others show through.
    pub(crate) fn thin_line(&mut self, [x, y]: [f64; 2], [to_x, to_y]: [f64; 2]) {
        self.put(format_args!(
            r#"<line x1="{x:.1}" y1="{y:.1}" x2="{to_x:.1}" y2="{to_y:.1}" stroke-width="1" stroke-opacity="0.4"/>"#
        ));
    }

    /// The area between two lines, which others show through: along the lower one, and back along the upper one.
    pub(crate) fn band(&mut self, around: &[[f64; 2]]) {
        let points = join_points(around);
        self.put(format_args!(r#"<polygon points="{points}" stroke="none" fill-opacity="0.2"/>"#));
    }

    /// A filled box from one corner to the other.
    pub(crate) fn bar(&mut self, [left, top]: [f64; 2], [right, bottom]: [f64; 2]) {
        let (left, width, height) = (left.min(right), (right - left).abs().max(1.0), bottom - top);
        self.put(format_args!(
            r#"<rect x="{left:.2}" y="{top:.2}" width="{width:.2}" height="{height:.2}" stroke="none"/>"#
        ));
    }

    /// A square of a map, in its share of the full colour, and what is said of it.
    pub(crate) fn cell(&mut self, at: [f64; 2], side: f64, share: f64, told: &str) {
        self.draw_shaded(
            at,
            [side; 2],
            share,
            format_args!(r##" stroke="#ffffff"><title>{}</title></rect>"##, told.render().into_string()),
        );
    }

    /// A piece of the scale of a map.
    pub(crate) fn swatch(&mut self, at: [f64; 2], size: [f64; 2], share: f64) {
        self.draw_shaded(at, size, share, format_args!("/>"));
    }

    fn draw_shaded(
        &mut self,
        [left, top]: [f64; 2],
        [width, height]: [f64; 2],
        share: f64,
        rest: std::fmt::Arguments<'_>,
    ) {
        // The colour of the style sheet on light paper.
        let [red, green, blue] = [0.0, 114.0, 178.0].map(|it: f64| (255.0 + 0.65 * share * (it - 255.0)).round() as u8);
        self.put(format_args!(
            r##"<rect class="heat" style="--share:{share:.3}" x="{left:.2}" y="{top:.2}" width="{width:.2}" height="{height:.2}" fill="#{red:02x}{green:02x}{blue:02x}"{rest}"##
        ));
    }

    /// Text in a cell.
    pub(crate) fn small_text(&mut self, at: [f64; 2], anchor: Anchor, text: &str) {
        self.styled_text(at, anchor, text, "ink in-cell", " font-size=\"10\" pointer-events=\"none\"");
    }

    /// A series' marker, filled, or hollow for a value that lies beyond the axis.
    pub(crate) fn marker(&mut self, style: usize, [x, y]: [f64; 2], radius: f64, filled: bool) {
        let hollow = if filled { "" } else { r##" class="hollow" fill="#ffffff""## };
        match STYLES[style % STYLES.len()].marker {
            MarkerSymbol::Circle => {
                self.put(format_args!(r#"<circle cx="{x:.2}" cy="{y:.2}" r="{radius:.2}"{hollow}/>"#));
            }
            MarkerSymbol::Square => {
                let [left, top, side] = [x - 0.9 * radius, y - 0.9 * radius, 1.8 * radius];
                self.put(format_args!(
                    r#"<rect x="{left:.2}" y="{top:.2}" width="{side:.2}" height="{side:.2}"{hollow}/>"#
                ));
            }
            MarkerSymbol::Triangle => {
                let corners =
                    [[x, y - 1.2 * radius], [x + 1.1 * radius, y + 0.8 * radius], [x - 1.1 * radius, y + 0.8 * radius]];
                self.polygon(&corners, hollow);
            }
            MarkerSymbol::Diamond => {
                let far = 1.25 * radius;
                self.polygon(&[[x, y - far], [x + far, y], [x, y + far], [x - far, y]], hollow);
            }
        }
    }

    fn polygon(&mut self, corners: &[[f64; 2]], hollow: &str) {
        let corners = join_points(corners);
        self.put(format_args!(r#"<polygon points="{corners}"{hollow}/>"#));
    }

    /// The whole picture of this size.
    pub(crate) fn finish(self, width: f64, height: f64, title: &str, description: &str) -> String {
        let [title, description] = [title, description].map(|text| text.render().into_string());
        let body = self.body;
        visible_markup(format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" class="plot" role="img" viewBox="0 0 {width:.0} {height:.0}" width="{width:.0}" height="{height:.0}" font-family="system-ui, 'Segoe UI', Roboto, 'Liberation Sans', Arial, sans-serif" font-size="12">
<title>{title}</title>
<desc>{description}</desc>
<rect class="paper" width="{width:.0}" height="{height:.0}" fill="#ffffff"/>
{body}</svg>
"##
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_text_stays_text() {
        let svg = Canvas::new().finish(1.0, 1.0, "a < b & \"c\"\u{1}\u{202e}", "</svg>");
        let document = roxmltree::Document::parse(&svg).unwrap();
        let text: Vec<&str> = document.root_element().children().filter_map(|node| node.text()).collect();
        assert!(text.contains(&r#"a < b & "c"\u{1}\u{202e}"#) && text.contains(&"</svg>"), "{text:?}");
    }

    #[test]
    fn lines_break_between_words() {
        assert_eq!(wrap_text("one two three", 60.0), ["one two", "three"]);
        assert_eq!(wrap_text("  ", 60.0), Vec::<String>::new());
    }
}
