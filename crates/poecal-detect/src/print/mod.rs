//! A board on paper, to scale: a page as rectangles, discs and words, written as SVG or PDF, and its correction by ruler measurements.
//!
//! A [`Sheet`] is drawn from the [`Layout`](crate::Layout) that the detector finds, so that both agree on the dark squares and on the position of
//! each marker or dot.

mod black;
mod draw;
mod furniture;
mod helvetica;
mod measured;
mod page;
mod pdf;
mod sheet;
mod svg;
mod words;

pub use measured::{Corrected, Measured};
pub use page::Page;
pub use sheet::{Disc, Rectangle, Sheet, Words};
pub use words::described;

/// A number with at most this many decimals, without trailing zeros.
fn decimal(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let text = if digits > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
