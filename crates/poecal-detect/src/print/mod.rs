//! A board on paper, to scale: a page as rectangles, discs and words, written as SVG or PDF, and its correction by ruler measurements.
//!
//! A [`PrintSheet`] is drawn from the [`BoardLayout`](crate::BoardLayout) that the detector finds, so that both agree on the dark squares and on the position of
//! each marker or dot.

mod black;
mod board_description;
mod draw;
mod furniture;
mod helvetica;
mod page;
mod pdf;
mod print_measurement;
mod sheet;
mod svg;

pub use board_description::describe_board;
pub use page::PaperSize;
pub use print_measurement::{PrintMeasurement, PrintedBoard};
pub use sheet::{Disc, PrintSheet, Rectangle, SheetText};

/// A number with at most this many decimals, without trailing zeros.
fn decimal(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let text = if digits > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
