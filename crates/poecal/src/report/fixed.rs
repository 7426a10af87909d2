//! Numbers with a fixed number of decimals, of which pages and plots are full.

use std::fmt::{Display, Formatter};

/// A number with some decimals, as `{:.decimals$}` writes it.
pub(super) struct Fixed(pub(super) f64, pub(super) usize);

impl Display for Fixed {
    /// By whole numbers, which is quick, unless the last digit is hard to tell.
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        /// Digits of the whole number, at most.
        const MOST: usize = 9;
        const HALF_WAY: f64 = 1e-3;
        let &Fixed(value, decimals) = self;
        let scaled = value.abs() * 10_f64.powi(decimals.min(MOST) as i32);
        let is_plain = scaled < 1e9 - 1.0 && (scaled.fract() - 0.5).abs() > HALF_WAY;
        if !is_plain || !(1..MOST).contains(&decimals) {
            return write!(f, "{value:.decimals$}");
        }
        let mut rest = (scaled + 0.5) as u32;
        let mut text = [0; 2 * MOST];
        let mut start = text.len();
        let mut push = |byte| {
            start -= 1;
            text[start] = byte;
        };
        for place in 0..=MOST {
            if place == decimals {
                push(b'.');
            }
            if place > decimals && rest == 0 {
                break;
            }
            push(b'0' + (rest % 10) as u8);
            rest /= 10;
        }
        if value.is_sign_negative() {
            push(b'-');
        }
        f.write_str(str::from_utf8(&text[start..]).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_numbers_are_those_of_the_library() {
        let ends =
            [0.0, -0.0, 0.125, 0.375, 9.995, 1.005, 1e-9, -1e-9, 1e6, 1e9, 1e300, f64::NAN, f64::INFINITY];
        let many = (0..20_000).map(|k| (f64::from(k) * 0.37).sin() * 10_f64.powi(k % 9 - 3));
        for value in ends.into_iter().chain(many) {
            for decimals in 0..=12 {
                assert_eq!(Fixed(value, decimals).to_string(), format!("{value:.decimals$}"));
            }
        }
    }
}
