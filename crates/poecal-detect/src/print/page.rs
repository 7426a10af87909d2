//! Sizes of paper.

use std::fmt;
use std::str::FromStr;

use super::decimal;
use crate::error::{Error, Result};
use crate::spec::length;

/// A page: `a4`, `a3` and `letter`, whose orientation follows the board, or `WIDTHxHEIGHT` with a unit, such as `400x300mm`, in the stated
/// orientation.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperSize {
    size_mm: [f64; 2],
    /// True if it may be turned.
    turns: bool,
}

/// Pages with names, upright, millimetres.
const NAMED: [(&str, [f64; 2]); 3] = [("a4", [210.0, 297.0]), ("a3", [297.0, 420.0]), ("letter", [215.9, 279.4])];
/// Sides of a page, millimetres: the largest in a PDF is 5,080.
const SIDES_MM: std::ops::RangeInclusive<f64> = 50.0..=5000.0;

impl PaperSize {
    /// Its permitted orientations, width and height in millimetres: one, or two.
    pub(super) fn ways(&self) -> Vec<[f64; 2]> {
        let [width, height] = self.size_mm;
        if self.turns { vec![[width, height], [height, width]] } else { vec![self.size_mm] }
    }
}

impl FromStr for PaperSize {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        if let Some((_, size_mm)) = NAMED.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)) {
            return Ok(PaperSize { size_mm: *size_mm, turns: true });
        }
        let wrong = || {
            Error::new(format!(
                "found the page {text:?}, expected a4, a3, letter, or width x height such as 400x300mm, each 50 mm to 5000 mm"
            ))
        };
        let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
        let unit = height.trim_start_matches(|it: char| !it.is_alphabetic());
        let side = |number: &str| {
            let side_mm = length(&format!("{}{unit}", number.trim()))? * 1e3;
            Some(side_mm).filter(|it| SIDES_MM.contains(it))
        };
        let height = height.strip_suffix(unit).unwrap_or(height);
        let size_mm = [side(width).ok_or_else(wrong)?, side(height).ok_or_else(wrong)?];
        Ok(PaperSize { size_mm, turns: false })
    }
}

impl fmt::Display for PaperSize {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size_mm.map(|it| decimal(it, 2));
        write!(formatter, "{width} x {height} mm")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_read_by_name_or_size() {
        let ways = |text: &str| text.parse::<PaperSize>().map(|page| page.ways());
        assert_eq!(ways("A4").unwrap(), [[210.0, 297.0], [297.0, 210.0]]);
        assert_eq!(ways("400x300.5mm").unwrap(), [[400.0, 300.5]]);
        assert_eq!(ways("40 x 30 cm").unwrap(), [[400.0, 300.0]]);
        for text in ["a5", "400x300", "400mm", "x300mm", "400x-300mm", "0x0mm", "10x20m", "nanx300mm", ""] {
            let message = ways(text).unwrap_err().to_string();
            assert!(message.starts_with("found the page"), "{text}: {message}");
        }
    }
}
