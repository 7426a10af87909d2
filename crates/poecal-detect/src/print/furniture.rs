//! Surroundings of a board on its page: rulers and words, outside one square of white if the page is large enough.

use super::board_description::{describe_board, other_programs_names, spans};
use super::decimal;
use super::helvetica::{CAPITALS, width};
use super::sheet::{Rectangle, SheetText, place_on_page};
use crate::layout::{BoardLayout, BoardPattern};
use crate::spec::BoardSpec;

/// Margin that printers leave white at the edge of the page, millimetres.
const EDGE_MM: f64 = 5.0;
/// The longest ruler, and the distance of its ticks, millimetres.
const RULER_MM: f64 = 100.0;
const STEP_MM: f64 = 10.0;
/// Thickness of lines, millimetres.
const LINE_MM: f64 = 0.2;
/// Length of a tick, the gap behind it, and the size of its number, in units of 1 to 1.5 mm.
const TICK: f64 = 2.0;
const GAP: f64 = 0.5;
const NUMBER: f64 = 2.2;
/// Sizes of words, millimetres, and the distance of lines in sizes.
const SIZES_MM: [f64; 7] = [3.2, 2.9, 2.6, 2.3, 2.1, 1.9, 1.7];
const LINE: f64 = 1.25;
/// Smallest type in which sentences have lines of their own, before they share them.
const ALONE_MM: f64 = 2.3;
/// Size of the names of tags, millimetres.
const LABEL_MM: f64 = 2.6;
/// Separator of words on one line.
const BETWEEN: &str = "   |   ";

fn line_of(text: String, at_mm: [f64; 2], size_mm: f64, downwards: bool) -> SheetText {
    let length_mm = width(&text) * size_mm;
    SheetText { text, at_mm, size_mm, length_mm, downwards }
}

/// Distance from the board to an item of this depth: a square, or as far as the page allows.
fn gap(margin_mm: f64, deep_mm: f64, square_mm: f64) -> f64 {
    square_mm.min(margin_mm - EDGE_MM - deep_mm).max(0.0)
}

/// Length of a ruler from a position on a side of the page: the unit follows its end, in type of this size.
fn length(side_mm: f64, from_mm: f64, type_mm: f64) -> f64 {
    let behind = width("100 mm") * type_mm - width("100") * type_mm / 2.0;
    (((side_mm - EDGE_MM - behind - from_mm) / STEP_MM).floor() * STEP_MM).clamp(0.0, RULER_MM)
}

/// A ruler below the board, and one on its left: both begin where its squares do.
pub(super) fn rulers(size_mm: [f64; 2], board: &Rectangle, square_mm: f64) -> (Vec<Rectangle>, Vec<SheetText>) {
    let (mut lines, mut words) = (Vec::new(), Vec::new());
    let [left, upper] = board.from_mm;
    for axis in [0, 1] {
        // Its margin is across its direction.
        let margin = board.from_mm[1 - axis];
        let unit = ((margin - EDGE_MM) / EDGE_MM).clamp(1.0, 1.5);
        let gap = gap(margin, (TICK + GAP + NUMBER * CAPITALS) * unit, square_mm);
        let begin = board.from_mm[axis];
        let size = NUMBER * unit;
        let long = length(size_mm[axis], begin, size);
        // From coordinates along the ruler and away from the board to those of the page.
        let place = |along: f64, away: f64| match axis {
            0 => [left + along, board.to_mm[1] + gap + away],
            _ => [left - gap - away, upper + along],
        };
        let mut line = |from: [f64; 2], to: [f64; 2]| {
            let corner = |choose: fn(f64, f64) -> f64| [choose(from[0], to[0]), choose(from[1], to[1])];
            lines.push(Rectangle { from_mm: corner(f64::min), to_mm: corner(f64::max) });
        };
        let half = LINE_MM / 2.0;
        line(place(-half, 0.0), place(long + half, LINE_MM));
        for tick in 0..=(long / STEP_MM).round() as usize {
            let at = tick as f64 * STEP_MM;
            line(place(at - half, LINE_MM), place(at + half, TICK * unit));
            let last = at + STEP_MM / 2.0 > long;
            let text = if last { format!("{} mm", decimal(at, 0)) } else { decimal(at, 0) };
            let middle = width(&decimal(at, 0)) * size / 2.0;
            let place = place(at - middle, (TICK + GAP + NUMBER * CAPITALS) * unit);
            words.push(line_of(text, place, size, axis == 1));
        }
    }
    (lines, words)
}

/// Description of the board, above it: as many of the sentences as fit, in the largest type that fits.
pub(super) fn texts(spec: &BoardSpec, size_mm: [f64; 2], board: &Rectangle, square_mm: f64) -> Vec<SheetText> {
    let sentences = [
        describe_board(spec),
        format!("poecal: --markers {spec}"),
        format!("Print at 100 % (actual size). {}; check the rulers.", spans(spec)),
        other_programs_names(spec),
    ];
    let margin = board.from_mm[1];
    let wide = size_mm[0] - 2.0 * EDGE_MM;
    let room = (margin - EDGE_MM).min(4.5).max(0.7 * (margin - EDGE_MM));
    let Some((lines, size)) = (1..=sentences.len()).rev().find_map(|count| set(&sentences[..count], wide, room)) else {
        return Vec::new();
    };
    let longest = lines.iter().map(|line| width(line) * size).fold(0.0, f64::max);
    let left = board.from_mm[0].min(size_mm[0] - EDGE_MM - longest).max(EDGE_MM);
    let deep = lines.len() as f64 * LINE * size;
    let top = margin - gap(margin, deep, square_mm) - deep;
    let base = |at: usize| top + (at as f64 * LINE + 1.0) * size;
    lines.into_iter().enumerate().map(|(at, line)| line_of(line, [left, base(at)], size, false)).collect()
}

/// The names of loose tags, below each.
pub(super) fn labels(layout: &BoardLayout, origin_mm: [f64; 2]) -> Vec<SheetText> {
    let tags = match &layout.pattern {
        BoardPattern::Tags(tags) if !tags.kalibr => tags,
        BoardPattern::Tags(_) | BoardPattern::Squares | BoardPattern::Dots { .. } => return Vec::new(),
    };
    let label = |id: usize| {
        let [x, y] = place_on_page(layout, origin_mm, layout.corner(4 * id + 3).into());
        let middle = y + 0.5 * (tags.gap * layout.square_m * 1e3 + LABEL_MM * CAPITALS);
        line_of(format!("tag{id}"), [x, middle], LABEL_MM, false)
    };
    (0..tags.columns * tags.rows).map(label).collect()
}

/// Sentences in lines of a width, together within a height, and the size of their type: each on its own line, else side by side, else broken.
fn set(sentences: &[String], wide: f64, room: f64) -> Option<(Vec<String>, f64)> {
    let fits = |lines: &Vec<String>, size: f64| {
        lines.len() as f64 * LINE * size <= room && lines.iter().all(|it| width(it) * size <= wide)
    };
    let all = || SIZES_MM.into_iter();
    let joined = sentences.join(" | ");
    let words: Vec<&str> = joined.split(' ').collect();
    let whole: Vec<&str> = sentences.iter().map(String::as_str).collect();
    let alone = all().filter(|size| *size >= ALONE_MM).map(|size| (sentences.to_vec(), size));
    let beside = all().map(|size| (fill_lines(&whole, BETWEEN, wide / size), size));
    let broken = all().map(|size| (fill_lines(&words, " ", wide / size), size));
    alone.chain(beside).chain(broken).find(|(lines, size)| fits(lines, *size))
}

/// Parts in lines, as many on each as fit.
fn fill_lines(parts: &[&str], between: &str, wide: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in parts {
        match lines.last_mut() {
            Some(line) if width(line) + width(between) + width(part) <= wide => {
                line.push_str(between);
                line.push_str(part);
            }
            _ => lines.push((*part).to_owned()),
        }
    }
    lines
}
