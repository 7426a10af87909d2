//! Numbers in the form of the report.

use poecal_report::table;

/// A number with about four digits, with an exponent if it is tiny or huge.
pub(super) fn number(value: f64) -> String {
    if value.is_nan() {
        return "not a number".to_owned();
    }
    if value.is_infinite() {
        return "infinite".to_owned();
    }
    let size = if value.abs() >= 1e6 { format!("{:.1e}", value.abs()) } else { table::number(value.abs()) };
    if value < 0.0 { format!("-{size}") } else { size }
}

/// A number, or a dash for a missing one.
pub(super) fn number_or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), number)
}

/// Metres in millimetres.
pub(super) fn mm(metres: f64) -> String {
    number(1e3 * metres)
}

/// A chosen size in its original form: without digits that rounding adds.
pub(super) fn format_stated(value: f64) -> String {
    let rounded = (value * 1e9).round() / 1e9;
    if rounded.is_finite() && value.abs() < 1e6 { format!("{rounded}") } else { number(value) }
}

/// A share, with a tenth of a percent.
pub(super) fn percent(share: f64) -> String {
    if share.is_finite() { format!("{:.1} %", 100.0 * share) } else { number(share) }
}

/// A number with four decimals, as Table II prints them.
pub(super) fn four_decimals(value: f64) -> String {
    if !value.is_finite() || value.abs() >= 1e6 {
        return number(value);
    }
    let text = format!("{value:.4}");
    // A tiny negative number would be a negative zero.
    if text == "-0.0000" { "0.0000".to_owned() } else { text }
}

pub(super) fn yes_no(value: bool) -> String {
    if value { "yes" } else { "no" }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!([0.0, 1.25, -12.5, -3e-11].map(number), ["0", "1.250", "-12.50", "-3.0e-11"]);
        assert_eq!([f64::NAN, f64::INFINITY, 1e7].map(number), ["not a number", "infinite", "1.0e7"]);
        assert_eq!([20.0, 5e-5 * 1e3, 0.01_f64.to_radians().to_degrees()].map(format_stated), ["20", "0.05", "0.01"]);
        assert_eq!([1.0, 0.9612, f64::NAN].map(percent), ["100.0 %", "96.1 %", "not a number"]);
        assert_eq!([-1e-9, 0.123_46].map(four_decimals), ["0.0000", "0.1235"]);
    }
}
