//! The problems of Moré, Garbow and Hillstrom with a fixed number of unknowns, numbered as in the paper: residuals and Jacobians.

use crate::plain::Evaluation;
use std::f64::consts::PI;

/// Residuals with the gradient of each.
fn rows<const N: usize>(rows: impl IntoIterator<Item = (f64, [f64; N])>) -> Evaluation {
    let (mut f, mut jacobian) = (Vec::new(), Vec::new());
    for (value, gradient) in rows {
        f.push(value);
        jacobian.extend(gradient);
    }
    (f, jacobian)
}

/// 1
pub(crate) fn rosenbrock(x: &[f64]) -> Evaluation {
    rows([(10.0 * (x[1] - x[0] * x[0]), [-20.0 * x[0], 10.0]), (1.0 - x[0], [-1.0, 0.0])])
}

/// 2
pub(crate) fn freudenstein_roth(x: &[f64]) -> Evaluation {
    let (a, b) = (x[0], x[1]);
    rows([
        (-13.0 + a + ((5.0 - b) * b - 2.0) * b, [1.0, (10.0 - 3.0 * b) * b - 2.0]),
        (-29.0 + a + ((b + 1.0) * b - 14.0) * b, [1.0, (3.0 * b + 2.0) * b - 14.0]),
    ])
}

/// 3
pub(crate) fn powell_badly_scaled(x: &[f64]) -> Evaluation {
    let (e, f) = ((-x[0]).exp(), (-x[1]).exp());
    rows([(1e4 * x[0] * x[1] - 1.0, [1e4 * x[1], 1e4 * x[0]]), (e + f - 1.0001, [-e, -f])])
}

/// 4
pub(crate) fn brown_badly_scaled(x: &[f64]) -> Evaluation {
    rows([(x[0] - 1e6, [1.0, 0.0]), (x[1] - 2e-6, [0.0, 1.0]), (x[0] * x[1] - 2.0, [x[1], x[0]])])
}

/// 5
pub(crate) fn beale(x: &[f64]) -> Evaluation {
    rows([1.5, 2.25, 2.625].into_iter().zip(1..).map(|(y, i)| {
        let power = x[1].powi(i);
        (y - x[0] * (1.0 - power), [power - 1.0, f64::from(i) * x[0] * x[1].powi(i - 1)])
    }))
}

/// 6, of ten residuals
pub(crate) fn jennrich_sampson(x: &[f64]) -> Evaluation {
    rows((1..=10).map(f64::from).map(|i| {
        let (e, f) = ((i * x[0]).exp(), (i * x[1]).exp());
        (2.0 + 2.0 * i - (e + f), [-i * e, -i * f])
    }))
}

/// 7
pub(crate) fn helical_valley(x: &[f64]) -> Evaluation {
    let (a, b) = (x[0], x[1]);
    let (square, radius) = (a * a + b * b, a.hypot(b));
    let turns = (b / a).atan() / (2.0 * PI) + if a < 0.0 { 0.5 } else { 0.0 };
    let slope = 100.0 / (2.0 * PI * square);
    rows([
        (10.0 * (x[2] - 10.0 * turns), [slope * b, -slope * a, 10.0]),
        (10.0 * (radius - 1.0), [10.0 * a / radius, 10.0 * b / radius, 0.0]),
        (x[2], [0.0, 0.0, 1.0]),
    ])
}

/// 8
pub(crate) fn bard(x: &[f64]) -> Evaluation {
    const Y: [f64; 15] = [0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39];
    rows(Y.into_iter().zip(1..).map(|(y, i)| {
        let (u, v) = (f64::from(i), f64::from(16 - i));
        let w = u.min(v);
        let below = v * x[1] + w * x[2];
        let slope = u / (below * below);
        (y - (x[0] + u / below), [-1.0, slope * v, slope * w])
    }))
}

/// 9
pub(crate) fn gaussian(x: &[f64]) -> Evaluation {
    const Y: [f64; 8] = [0.0009, 0.0044, 0.0175, 0.0540, 0.1295, 0.2420, 0.3521, 0.3989];
    rows((1..=15).map(|i: i32| {
        let away = f64::from(8 - i) / 2.0 - x[2];
        let e = (-x[1] * away * away / 2.0).exp();
        let y = Y[(i.min(16 - i) - 1) as usize];
        (x[0] * e - y, [e, -x[0] * e * away * away / 2.0, x[0] * e * x[1] * away])
    }))
}

/// 10
pub(crate) fn meyer(x: &[f64]) -> Evaluation {
    const Y: [f64; 16] = [
        34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0, 5147.0, 4427.0,
        3820.0, 3307.0, 2872.0,
    ];
    rows(Y.into_iter().zip(1..).map(|(y, i)| {
        let below = 45.0 + 5.0 * f64::from(i) + x[2];
        let e = (x[1] / below).exp();
        (x[0] * e - y, [e, x[0] * e / below, -x[0] * e * x[1] / (below * below)])
    }))
}

/// 11, of 99 residuals, with `|y - x₂|` where the paper misprints `|y m i x₂|`
pub(crate) fn gulf(x: &[f64]) -> Evaluation {
    rows((1..=99).map(|i| {
        let t = f64::from(i) / 100.0;
        let y = 25.0 + (-50.0 * t.ln()).powf(2.0 / 3.0);
        let away = y - x[1];
        let power = away.abs().powf(x[2]);
        let e = (-power / x[0]).exp();
        let slope = -e * power / x[0];
        (e - t, [-slope / x[0], -slope * x[2] / away, slope * away.abs().ln()])
    }))
}

/// 12, of ten residuals
pub(crate) fn box_three(x: &[f64]) -> Evaluation {
    rows((1..=10).map(|i| {
        let t = 0.1 * f64::from(i);
        let (e, f, g) = ((-t * x[0]).exp(), (-t * x[1]).exp(), (-t).exp() - (-10.0 * t).exp());
        (e - f - x[2] * g, [-t * e, t * f, -g])
    }))
}

/// 13
pub(crate) fn powell_singular(x: &[f64]) -> Evaluation {
    let (five, ten) = (5.0_f64.sqrt(), 10.0_f64.sqrt());
    let (a, b) = (x[1] - 2.0 * x[2], x[0] - x[3]);
    rows([
        (x[0] + 10.0 * x[1], [1.0, 10.0, 0.0, 0.0]),
        (five * (x[2] - x[3]), [0.0, 0.0, five, -five]),
        (a * a, [0.0, 2.0 * a, -4.0 * a, 0.0]),
        (ten * b * b, [2.0 * ten * b, 0.0, 0.0, -2.0 * ten * b]),
    ])
}

/// 14
pub(crate) fn wood(x: &[f64]) -> Evaluation {
    let (ninety, ten) = (90.0_f64.sqrt(), 10.0_f64.sqrt());
    rows([
        (10.0 * (x[1] - x[0] * x[0]), [-20.0 * x[0], 10.0, 0.0, 0.0]),
        (1.0 - x[0], [-1.0, 0.0, 0.0, 0.0]),
        (ninety * (x[3] - x[2] * x[2]), [0.0, 0.0, -2.0 * ninety * x[2], ninety]),
        (1.0 - x[2], [0.0, 0.0, -1.0, 0.0]),
        (ten * (x[1] + x[3] - 2.0), [0.0, ten, 0.0, ten]),
        ((x[1] - x[3]) / ten, [0.0, 1.0 / ten, 0.0, -1.0 / ten]),
    ])
}

/// 15
pub(crate) fn kowalik_osborne(x: &[f64]) -> Evaluation {
    const Y: [f64; 11] = [0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246];
    const U: [f64; 11] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625];
    rows(Y.into_iter().zip(U).map(|(y, u)| {
        let (above, below) = (u * u + u * x[1], u * u + u * x[2] + x[3]);
        let value = x[0] * above / below;
        (y - value, [-above / below, -x[0] * u / below, value * u / below, value / below])
    }))
}

/// 16, of twenty residuals
pub(crate) fn brown_dennis(x: &[f64]) -> Evaluation {
    rows((1..=20).map(|i| {
        let t = f64::from(i) / 5.0;
        let (a, b) = (x[0] + t * x[1] - t.exp(), x[2] + x[3] * t.sin() - t.cos());
        (a * a + b * b, [2.0 * a, 2.0 * a * t, 2.0 * b, 2.0 * b * t.sin()])
    }))
}

/// 17
pub(crate) fn osborne_1(x: &[f64]) -> Evaluation {
    const Y: [f64; 33] = [
        0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603,
        0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411,
        0.406,
    ];
    rows(Y.into_iter().zip(0..).map(|(y, i)| {
        let t = 10.0 * f64::from(i);
        let (e, f) = ((-t * x[3]).exp(), (-t * x[4]).exp());
        (y - (x[0] + x[1] * e + x[2] * f), [-1.0, -e, -f, t * x[1] * e, t * x[2] * f])
    }))
}

/// 18, of thirteen residuals
pub(crate) fn biggs_exp6(x: &[f64]) -> Evaluation {
    rows((1..=13).map(|i| {
        let t = 0.1 * f64::from(i);
        let y = (-t).exp() - 5.0 * (-10.0 * t).exp() + 3.0 * (-4.0 * t).exp();
        let (e, f, g) = ((-t * x[0]).exp(), (-t * x[1]).exp(), (-t * x[4]).exp());
        let value = x[2] * e - x[3] * f + x[5] * g - y;
        (value, [-t * x[2] * e, t * x[3] * f, e, -f, -t * x[5] * g, g])
    }))
}

/// 19
pub(crate) fn osborne_2(x: &[f64]) -> Evaluation {
    const Y: [f64; 65] = [
        1.366, 1.191, 1.112, 1.013, 0.991, 0.885, 0.831, 0.847, 0.786, 0.725, 0.746, 0.679, 0.608, 0.655, 0.616, 0.606,
        0.602, 0.626, 0.651, 0.724, 0.649, 0.649, 0.694, 0.644, 0.624, 0.661, 0.612, 0.558, 0.533, 0.495, 0.500, 0.423,
        0.395, 0.375, 0.372, 0.391, 0.396, 0.405, 0.428, 0.429, 0.523, 0.562, 0.607, 0.653, 0.672, 0.708, 0.633, 0.668,
        0.645, 0.632, 0.591, 0.559, 0.597, 0.625, 0.739, 0.710, 0.729, 0.720, 0.636, 0.581, 0.428, 0.292, 0.162, 0.098,
        0.054,
    ];
    rows(Y.into_iter().zip(0..).map(|(y, i)| {
        let t = f64::from(i) / 10.0;
        let e = (-t * x[4]).exp();
        let mut value = y - x[0] * e;
        let mut gradient = [0.0; 11];
        (gradient[0], gradient[4]) = (-e, t * x[0] * e);
        for k in 0..3 {
            let (height, width, away) = (x[1 + k], x[5 + k], t - x[8 + k]);
            let e = (-away * away * width).exp();
            value -= height * e;
            gradient[1 + k] = -e;
            gradient[5 + k] = height * away * away * e;
            gradient[8 + k] = -2.0 * height * width * away * e;
        }
        (value, gradient)
    }))
}
