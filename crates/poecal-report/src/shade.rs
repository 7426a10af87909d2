//! The colour of a value in a map or a table: its share of the largest one, from zero. So nearly equal values have nearly equal colours.

/// Share from 0, the colour of the page, to 1, the full colour; the style sheet mixes the two evenly for the eye.
pub(crate) fn share(value: f64, largest: f64) -> f64 {
    let share = value / largest;
    if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
}

/// The share as the style of an element of class `heat`.
pub(crate) fn style(value: f64, largest: f64) -> String {
    format!("--share:{:.3}", share(value, largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_nearly_alike_look_alike() {
        // The expected errors of a robot that is equally certain everywhere, mm.
        let (least, most) = (share(0.0983, 0.1004), share(0.1004, 0.1004));
        println!("0.0983 of 0.1004: {least:.3} and {most:.3} of the colour");
        assert!(most - least < 0.03 && most == 1.0);
        assert_eq!([0.0, 1.0, 2.0, 3.0].map(|value| share(value, 2.0)), [0.0, 0.5, 1.0, 1.0]);
        assert_eq!([f64::NAN, f64::INFINITY, -1.0].map(|value| share(value, 1.0)), [0.0; 3]);
        assert_eq!(style(0.0, 0.0), "--share:0.000");
    }
}
