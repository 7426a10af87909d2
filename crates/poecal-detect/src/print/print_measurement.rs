//! Correction of a printed board by ruler measurements.

use std::str::FromStr;

use super::board_description::ends;
use super::decimal;
use crate::error::{Error, Result};
use crate::spec::{BoardSpec, length};

/// Lengths measured by a ruler on a print along x and along y, between the points that [`BoardSpec::ruled_m`] names: `180.0mm,251.3mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrintMeasurement {
    /// Along x and y, metres.
    pub sides_m: [f64; 2],
}

/// A board as it was printed.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintedBoard {
    /// The board with the squares and markers of the print: the sizes that fit both sides best, to a micrometre.
    pub spec: BoardSpec,
    /// Ratio of its printed to its stated length, along x and y.
    pub factors: [f64; 2],
}

/// Largest relative difference of the sides for which one size of square describes the print.
const AGREE: f64 = 0.003;
/// Largest ratio of a print to its stated size, or its inverse: beyond it, it is another board, or was measured otherwise.
const MOST: f64 = 2.0;

impl PrintedBoard {
    /// True if one size of square describes the print: its scales along x and y agree within 0.3 %.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.stretch().abs() <= AGREE
    }

    /// Relative excess of the print's scale along x over that along y.
    #[must_use]
    pub fn stretch(&self) -> f64 {
        self.factors[0] / self.factors[1] - 1.0
    }
}

impl PrintMeasurement {
    /// The measured board, by its intended specification.
    ///
    /// # Errors
    /// If a side differs too much from its intended length.
    pub fn correct(&self, spec: &BoardSpec) -> Result<PrintedBoard> {
        let stated = spec.ruled_m();
        let mut factors = [1.0; 2];
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let factor = self.sides_m[axis] / stated[axis];
            if !(1.0 / MOST..=MOST).contains(&factor) {
                let [found, expected] = [self.sides_m, stated].map(|it| decimal(it[axis] * 1e3, 2));
                return Err(Error::new(format!(
                    "found {found} mm along {name}, expected about {expected} mm, {}",
                    ends(spec)
                )));
            }
            factors[axis] = factor;
        }
        // Least squares: the error of a ruler is the same on a long side and on a short one.
        let [numerator, denominator] = [self.sides_m, stated].map(|it| it[0] * stated[0] + it[1] * stated[1]);
        Ok(PrintedBoard { spec: spec.scale(numerator / denominator), factors })
    }
}

impl FromStr for PrintMeasurement {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::new(format!(
                "found {text:?}, expected the lengths of the print along x and along y with their units, such as 180.0mm,251.3mm"
            ))
        };
        let (x, y) = text.split_once(',').ok_or_else(wrong)?;
        let side = |part: &str| length(part.trim()).ok_or_else(wrong);
        Ok(PrintMeasurement { sides_m: [side(x)?, side(y)?] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn correct_measured(spec: &str, measured: &str) -> Result<PrintedBoard> {
        measured.parse::<PrintMeasurement>()?.correct(&spec.parse()?)
    }

    #[test]
    fn a_print_that_shrank_has_smaller_squares_and_markers() {
        let found = correct_measured("charuco:5x7:36mm:18mm:DICT_6X6_250:legacy", "179.4mm, 25.116cm").unwrap();
        assert_eq!(found.spec.to_string(), "charuco:5x7:35.88mm:17.94mm:DICT_6X6_250:legacy");
        assert!(found.agrees());
        let found = correct_measured("chessboard:10x7:27mm", "270mm,189mm").unwrap();
        assert_eq!((found.spec.to_string().as_str(), found.agrees()), ("chessboard:10x7:27mm", true));
    }

    #[test]
    fn sides_of_other_scales_do_not_agree() {
        let found = correct_measured("chessboard:10x7:27mm", "270mm,188mm").unwrap();
        assert!(!found.agrees() && (found.stretch() - 1.0 / 188.0).abs() < 1e-12);
        assert_eq!(found.spec.to_string(), "chessboard:10x7:26.953mm");
        assert!(correct_measured("chessboard:10x7:27mm", "270mm,188.5mm").unwrap().agrees());
    }

    #[test]
    fn what_is_no_such_length_is_refused() {
        for (measured, part) in [
            ("270mm", "along x and along y with their units"),
            ("270,189", "with their units"),
            ("270mm,0mm", "with their units"),
            ("189mm,27mm", "found 27 mm along y, expected about 189 mm"),
        ] {
            let message = correct_measured("chessboard:10x7:27mm", measured).unwrap_err().to_string();
            assert!(message.starts_with("found") && message.contains(part), "{message}");
        }
    }
}
