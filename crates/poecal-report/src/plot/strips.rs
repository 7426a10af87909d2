//! Counts of values in each part of a range: a strip of cells for each row.

use super::frame::{self, WIDTH};
use super::svg::{Anchor, Canvas, text_width};
use crate::shade::share;

/// Cells of a strip, and the height of a row, px.
pub const CELLS: usize = 20;
const ROW: f64 = 26.0;

/// A row: its name, the ends of its range, and how many values are in each part.
pub struct StripRow {
    pub name: String,
    pub ends: [String; 2],
    pub counts: [usize; CELLS],
}

/// Strips, one below the other.
pub struct StripPlot {
    pub title: String,
    pub description: String,
    pub strips: Vec<StripRow>,
}

impl StripPlot {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        let mut canvas = Canvas::new();
        let top = frame::head(&mut canvas, &self.title, &[], false) + 4.0;
        let widest = |of: &dyn Fn(&StripRow) -> f64| self.strips.iter().map(of).fold(0.0, f64::max);
        let name = widest(&|it| text_width(&it.name)).min(WIDTH / 3.0);
        let [low, high] = [0, 1].map(|end| widest(&|it| text_width(&it.ends[end])));
        let left = 10.0 + name + 12.0 + low + 6.0;
        let side = ((WIDTH - 10.0 - high - 6.0 - left) / CELLS as f64).max(4.0);
        let most = self.strips.iter().flat_map(|it| it.counts).max().unwrap_or(0);
        for (at, strip) in self.strips.iter().enumerate() {
            let y = top + ROW * at as f64;
            canvas.text([10.0, y + 11.0], Anchor::Start, &strip.name);
            canvas.text([left - 6.0, y + 11.0], Anchor::End, &strip.ends[0]);
            for (cell, &count) in strip.counts.iter().enumerate() {
                let x = left + side * cell as f64;
                canvas.cell([x, y], side, share(count as f64, most as f64), &count.to_string());
            }
            canvas.text([left + side * CELLS as f64 + 6.0, y + 11.0], Anchor::Start, &strip.ends[1]);
        }
        canvas.finish(WIDTH, top + ROW * self.strips.len() as f64 + 6.0, &self.title, &self.description)
    }
}
