//! The models of NIST's nonlinear regressions: value and gradient by the parameters, as the files' headers write them.

use std::f64::consts::PI;

/// Value and gradient of a prediction from parameters `b` and predictors `x`.
pub(crate) type Model = fn(&[f64], &[f64]) -> (f64, Vec<f64>);

/// All 27, in the order of NIST's list, by rising difficulty.
pub(crate) const MODELS: [(&str, Model); 27] = [
    ("Misra1a", saturation),
    ("Chwirut2", chwirut),
    ("Chwirut1", chwirut),
    ("Lanczos3", lanczos),
    ("Gauss1", gauss),
    ("Gauss2", gauss),
    ("DanWood", power),
    ("Misra1b", misra1b),
    ("Kirby2", kirby),
    ("Hahn1", cubic_ratio),
    ("Nelson", nelson),
    ("MGH17", mgh17),
    ("Lanczos1", lanczos),
    ("Lanczos2", lanczos),
    ("Gauss3", gauss),
    ("Misra1c", misra1c),
    ("Misra1d", misra1d),
    ("Roszman1", roszman),
    ("ENSO", enso),
    ("MGH09", mgh09),
    ("Thurber", cubic_ratio),
    ("BoxBOD", saturation),
    ("Rat42", rat42),
    ("MGH10", mgh10),
    ("Eckerle4", eckerle),
    ("Rat43", rat43),
    ("Bennett5", bennett),
];

fn saturation(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (-b[1] * x[0]).exp();
    (b[0] * (1.0 - e), vec![1.0 - e, b[0] * x[0] * e])
}

fn chwirut(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let x = x[0];
    let below = b[1] + b[2] * x;
    let y = (-b[0] * x).exp() / below;
    (y, vec![-x * y, -y / below, -x * y / below])
}

fn lanczos(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let (mut y, mut gradient) = (0.0, Vec::new());
    for pair in b.chunks(2) {
        let e = (-pair[1] * x[0]).exp();
        y += pair[0] * e;
        gradient.extend([e, -x[0] * pair[0] * e]);
    }
    (y, gradient)
}

fn gauss(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let x = x[0];
    let e = (-b[1] * x).exp();
    let (mut y, mut gradient) = (b[0] * e, vec![e, -x * b[0] * e]);
    for peak in b[2..].chunks(3) {
        let (height, u) = (peak[0], (x - peak[1]) / peak[2]);
        let e = (-u * u).exp();
        y += height * e;
        gradient.extend([e, 2.0 * height * e * u / peak[2], 2.0 * height * e * u * u / peak[2]]);
    }
    (y, gradient)
}

fn power(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let p = x[0].powf(b[1]);
    (b[0] * p, vec![p, b[0] * p * x[0].ln()])
}

fn misra1b(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let base = 1.0 + 0.5 * b[1] * x[0];
    let rest = 1.0 - base.powi(-2);
    (b[0] * rest, vec![rest, b[0] * x[0] * base.powi(-3)])
}

fn misra1c(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let base = 1.0 + 2.0 * b[1] * x[0];
    let rest = 1.0 - base.powf(-0.5);
    (b[0] * rest, vec![rest, b[0] * x[0] * base.powf(-1.5)])
}

fn misra1d(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let base = 1.0 + b[1] * x[0];
    (b[0] * b[1] * x[0] / base, vec![b[1] * x[0] / base, b[0] * x[0] / (base * base)])
}

/// `Σ above_k x^k / (1 + Σ below_k x^k)`, the numerator's coefficients first.
fn ratio(b: &[f64], x: f64, above: usize) -> (f64, Vec<f64>) {
    let powers: Vec<f64> = (0..above).map(|k| x.powi(k as i32)).collect();
    let (top, bottom) = b.split_at(above);
    let numerator: f64 = top.iter().zip(&powers).map(|(b, p)| b * p).sum();
    let denominator = 1.0 + bottom.iter().zip(&powers[1..]).map(|(b, p)| b * p).sum::<f64>();
    let y = numerator / denominator;
    let mut gradient: Vec<f64> = powers.iter().map(|p| p / denominator).collect();
    gradient.extend(powers[1..].iter().map(|p| -y * p / denominator));
    (y, gradient)
}

fn kirby(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    ratio(b, x[0], 3)
}

fn cubic_ratio(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    ratio(b, x[0], 4)
}

fn nelson(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (-b[2] * x[1]).exp();
    (b[0] - b[1] * x[0] * e, vec![1.0, -x[0] * e, b[1] * x[0] * x[1] * e])
}

fn mgh17(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let x = x[0];
    let (e, f) = ((-x * b[3]).exp(), (-x * b[4]).exp());
    (b[0] + b[1] * e + b[2] * f, vec![1.0, e, f, -x * b[1] * e, -x * b[2] * f])
}

fn roszman(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let away = x[0] - b[3];
    let u = b[2] / away;
    let slope = -1.0 / (PI * (1.0 + u * u));
    (b[0] - b[1] * x[0] - u.atan() / PI, vec![1.0, -x[0], slope / away, slope * u / away])
}

fn enso(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let x = 2.0 * PI * x[0];
    let (year, first, second) = (x / 12.0, x / b[3], x / b[6]);
    let y = b[0]
        + b[1] * year.cos()
        + b[2] * year.sin()
        + b[4] * first.cos()
        + b[5] * first.sin()
        + b[7] * second.cos()
        + b[8] * second.sin();
    let by_period =
        |cosine: f64, sine: f64, angle: f64, period: f64| (cosine * angle.sin() - sine * angle.cos()) * angle / period;
    let gradient = vec![
        1.0,
        year.cos(),
        year.sin(),
        by_period(b[4], b[5], first, b[3]),
        first.cos(),
        first.sin(),
        by_period(b[7], b[8], second, b[6]),
        second.cos(),
        second.sin(),
    ];
    (y, gradient)
}

fn mgh09(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let x = x[0];
    let (above, below) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
    let y = b[0] * above / below;
    (y, vec![above / below, b[0] * x / below, -y * x / below, -y / below])
}

fn rat42(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (b[1] - b[2] * x[0]).exp();
    let y = b[0] / (1.0 + e);
    let slope = -y * e / (1.0 + e);
    (y, vec![1.0 / (1.0 + e), slope, -x[0] * slope])
}

fn rat43(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (b[1] - b[2] * x[0]).exp();
    let shape = (1.0 + e).powf(-1.0 / b[3]);
    let y = b[0] * shape;
    let slope = -y / b[3] * e / (1.0 + e);
    (y, vec![shape, slope, -x[0] * slope, y * (1.0 + e).ln() / (b[3] * b[3])])
}

fn mgh10(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let below = x[0] + b[2];
    let e = (b[1] / below).exp();
    (b[0] * e, vec![e, b[0] * e / below, -b[0] * b[1] * e / (below * below)])
}

fn eckerle(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let u = (x[0] - b[2]) / b[1];
    let e = (-0.5 * u * u).exp();
    let y = b[0] / b[1] * e;
    (y, vec![e / b[1], y * (u * u - 1.0) / b[1], y * u / b[1]])
}

fn bennett(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let base = b[1] + x[0];
    let p = base.powf(-1.0 / b[2]);
    (b[0] * p, vec![p, -b[0] * p / (b[2] * base), b[0] * p * base.ln() / (b[2] * b[2])])
}
