//! Width of text in Helvetica.

/// Widths of the characters from the blank to the tilde, thousandths of the size: Adobe's metrics, which every reader of PDF has.
const WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833,
    722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556,
    556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334,
    260, 334, 584,
];
/// Height of capitals and digits, as a part of the size.
pub(super) const CAPITALS: f64 = 0.718;

/// Width of a text in ASCII, as a part of its size.
pub(super) fn width(text: &str) -> f64 {
    let of = |letter: u8| WIDTHS.get(usize::from(letter.wrapping_sub(b' '))).copied().unwrap_or(556);
    text.bytes().map(|letter| f64::from(of(letter)) / 1000.0).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_as_wide_as_adobe_says() {
        for (letter, expected) in
            [(" ", 0.278), ("%", 0.889), ("0", 0.556), ("@", 1.015), ("W", 0.944), ("m", 0.833), ("~", 0.584)]
        {
            assert_eq!(width(letter), expected, "{letter}");
        }
    }
}
