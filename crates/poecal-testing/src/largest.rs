//! The largest of several differences.

/// The larger number, or NaN if either is NaN: an undefined difference must not pass.
pub fn larger_or_nan(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
