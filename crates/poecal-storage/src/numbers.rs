//! Numbers in model files.

/// Larger lengths (metres) or angles (radians) in a model are mistakes.
pub const LARGEST_NUMBER: f64 = 1e6;

/// The shortest decimal that reads back as the same number.
pub fn format_shortest(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// Appends the shortest decimal that reads back as the same number; faster, for tables.
pub fn push_number(out: &mut String, number: f64) {
    let mut buffer = zmij::Buffer::new();
    // Adding zero makes negative zero positive.
    let text = buffer.format(number + 0.0);
    out.push_str(text.strip_suffix(".0").unwrap_or(text));
}

/// Removes the rounding of products: a number within 1e-15 of a number with twelve decimals becomes that number, 0.2025 for 0.20249999999999999 and
/// 0 for 6e-17.
pub fn tidy_numbers<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    numbers.map(|number| {
        let rounded = (number * 1e12).round() / 1e12;
        // Adding zero makes negative zero positive.
        if (rounded - number).abs() < 1e-15 { rounded + 0.0 } else { number }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        assert_eq!(
            tidy_numbers([0.202_499_999_999_999_99, -6e-17, 0.123_456_789_012_345_6]).map(format_shortest),
            ["0.2025", "0", "0.1234567890123456"]
        );
        for number in [1.0, -0.1, 1e-7, 0.1 + 0.2, f64::MIN_POSITIVE] {
            assert_eq!(format_shortest(number).parse(), Ok(number));
            let mut text = String::new();
            push_number(&mut text, number);
            assert_eq!(text.parse(), Ok(number));
        }
    }
}
