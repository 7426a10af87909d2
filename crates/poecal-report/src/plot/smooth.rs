//! Statistics of charts: quantiles, and a smooth curve through dots.

/// Points that make a value of a curve, and those that it has at least.
const NEAR: f64 = 30.0;
const LEAST: usize = 8;
/// Shares of the range that a value of a curve is made of.
const SHARES: [f64; 2] = [0.05, 0.25];
/// Values of a curve.
const PLACES: usize = 100;
/// Part of the range, and how many mean distances of points, without one of which a curve is broken.
const GAP: [f64; 2] = [0.05, 8.0];

/// The value below which a share of some sorted values lies; not a number without values.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = share * sorted.len().saturating_sub(1) as f64;
    let at = |rank: f64| sorted.get(rank as usize).copied().unwrap_or(f64::NAN);
    let (below, above) = (at(rank.floor()), at(rank.ceil()));
    below + (above - below) * rank.fract()
}

/// The quantile of the standard normal distribution, by a rational approximation to 1e-9 of its value (Acklam).
pub fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -39.696_830_286_653_76,
        220.946_098_424_520_5,
        -275.928_510_446_968_7,
        138.357_751_867_269,
        -30.664_798_066_147_16,
        2.506_628_277_459_239,
    ];
    const B: [f64; 6] = [
        -54.476_098_798_224_06,
        161.585_836_858_040_9,
        -155.698_979_859_886_6,
        66.801_311_887_719_72,
        -13.280_681_552_885_72,
        1.0,
    ];
    const C: [f64; 6] = [
        -0.007_784_894_002_430_293,
        -0.322_396_458_041_136_5,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 5] =
        [0.007_784_695_709_041_462, 0.322_467_129_070_039_8, 2.445_134_137_142_996, 3.754_408_661_907_416, 1.0];
    const TAIL: f64 = 0.024_25;
    let polynomial = |factors: &[f64], x: f64| factors.iter().fold(0.0, |sum, factor| sum * x + factor);
    if p > 1.0 - TAIL {
        return -normal_quantile(1.0 - p);
    }
    if p < TAIL {
        let q = (-2.0 * p.ln()).sqrt();
        return polynomial(&C, q) / polynomial(&D, q);
    }
    let q = p - 0.5;
    polynomial(&A, q * q) * q / polynomial(&B, q * q)
}

/// A smooth curve through points: straight lines fitted locally, the nearer points counting more (cleveland1979). About thirty points make
/// each value, at most a quarter of the range wide.
pub struct SmoothCurve {
    /// Place, value and its standard deviation by the scatter of the points about the curve.
    pub points: Vec<[f64; 3]>,
    /// Least distance of neighbours where the curve is broken.
    gap: f64,
    /// Places of the points.
    xs: Vec<f64>,
}

impl SmoothCurve {
    /// The curve through points that are sorted by place; none through few, or through points at one place.
    pub fn from_points(points: &[[f64; 2]]) -> Option<Self> {
        let (first, last) = (points.first()?[0], points.last()?[0]);
        if points.len() < LEAST || last.is_nan() || last <= first {
            return None;
        }
        let range = last - first;
        let share = (NEAR / points.len() as f64).clamp(SHARES[0], SHARES[1]);
        let place = |k: usize| first + range * k as f64 / (PLACES - 1) as f64;
        let found = (0..PLACES).map(place).map(|place| {
            // Wide enough for a share of the range, and for at least eight points.
            let width = (0.5 * share * range).max(1.01 * distance_of_nearest(points, place));
            let [value, gain] = fit_locally(points, place, width);
            [place, value, gain]
        });
        let mut curve = SmoothCurve {
            points: found.collect(),
            gap: range * GAP[0].max(GAP[1] / points.len() as f64),
            xs: points.iter().map(|it| it[0]).collect(),
        };
        let squares = points.iter().map(|[x, y]| (y - curve.value(*x)).powi(2)).sum::<f64>();
        let scatter = (squares / (points.len() as f64 - 2.0 / share).max(1.0)).sqrt();
        curve.points.iter_mut().for_each(|it| it[2] *= scatter);
        Some(curve)
    }

    /// Its value, by straight lines between its places.
    fn value(&self, x: f64) -> f64 {
        let [Some(first), Some(last)] = [self.points.first(), self.points.last()] else { return f64::NAN };
        let along = (x - first[0]) / (last[0] - first[0]) * (self.points.len() - 1) as f64;
        let below = (along.floor().max(0.0) as usize).min(self.points.len().saturating_sub(2));
        let [Some(a), Some(b)] = [self.points.get(below), self.points.get(below + 1)] else {
            return f64::NAN;
        };
        a[1] + (b[1] - a[1]) * (along - below as f64)
    }

    /// The difference of its largest and its least value.
    pub fn swing(&self) -> f64 {
        let values = || self.points.iter().map(|it| it[1]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    }

    /// The middle one of its standard deviations.
    pub fn deviation(&self) -> f64 {
        let mut deviations: Vec<f64> = self.points.iter().map(|it| it[2]).collect();
        deviations.sort_by(f64::total_cmp);
        quantile(&deviations, 0.5)
    }

    /// Its pieces: it is broken where nothing was measured for a good part of its range.
    pub fn pieces(&self) -> Vec<&[[f64; 3]]> {
        let is_measured = |place: f64| {
            let after = self.xs.partition_point(|x| *x < place);
            let ends = self.xs.get(after.saturating_sub(1)).zip(self.xs.get(after));
            ends.is_none_or(|(before, after)| after - before <= self.gap)
        };
        let pieces = self.points.chunk_by(|a, b| is_measured(a[0]) && is_measured(b[0]));
        pieces.filter(|piece| piece.len() > 1).collect()
    }
}

/// Within which distance of a place [`LEAST`] points lie.
fn distance_of_nearest(points: &[[f64; 2]], place: f64) -> f64 {
    let middle = points.partition_point(|it| it[0] < place);
    let from = middle.saturating_sub(LEAST);
    let near = points.get(from..(middle + LEAST).min(points.len())).unwrap_or_default();
    let ends = near.windows(LEAST).filter_map(|some| some.first().zip(some.last()));
    ends.map(|(first, last)| (place - first[0]).max(last[0] - place)).fold(f64::INFINITY, f64::min)
}

/// The value of the line at a place, and its standard deviation over that of a point.
fn fit_locally(points: &[[f64; 2]], place: f64, width: f64) -> [f64; 2] {
    let from = points.partition_point(|it| it[0] <= place - width);
    let to = points.partition_point(|it| it[0] < place + width);
    let near = || {
        points.get(from..to).unwrap_or_default().iter().map(|[x, y]| {
            let d = (x - place) / width;
            [d, *y, (1.0 - d.abs().powi(3)).powi(3)]
        })
    };
    let [s, sx, sy, sxx, sxy] = near().fold([0.0; 5], |[s, sx, sy, sxx, sxy], [d, y, weight]| {
        let along = weight * d;
        [s + weight, sx + along, sy + weight * y, sxx + along * d, sxy + along * y]
    });
    let determinant = s * sxx - sx * sx;
    let is_line = determinant > 1e-9 * s * s;
    let share = |[d, _, weight]: [f64; 3]| {
        if is_line { weight * (sxx - sx * d) / determinant } else { weight / s }
    };
    let gain = near().map(|point| share(point).powi(2)).sum::<f64>().sqrt();
    [if is_line { (sxx * sy - sx * sxy) / determinant } else { sy / s }, gain]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (p, expected) in [(0.5, 0.0), (0.975, 1.959_963_985), (0.01, -2.326_347_874), (1e-6, -4.753_424_309)] {
            assert!((normal_quantile(p) - expected).abs() < 1e-8, "{p}: {}", normal_quantile(p));
        }
        assert!((quantile(&[1.0, 2.0, 4.0], 0.75) - 3.0).abs() < 1e-15);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn a_curve_follows_what_it_goes_through() {
        // A wave under a disturbance that repeats as no place does.
        let noise = |k: usize| 0.3 * (43758.5453 * (12.9898 * k as f64).sin()).fract();
        let points: Vec<[f64; 2]> =
            (0..800).map(|k| (k as f64 / 100.0, noise(k))).map(|(x, off)| [x, x.sin() + off]).collect();
        let curve = SmoothCurve::from_points(&points).unwrap();
        for [x, value, deviation] in &curve.points {
            assert!(
                (value - x.sin()).abs() < 4.0 * deviation + 0.01 && *deviation > 0.005 && *deviation < 0.2,
                "{x} {value} {deviation}"
            );
        }
        assert!((curve.swing() - 2.0).abs() < 0.1);
        assert_eq!(curve.pieces().len(), 1);
    }

    #[test]
    fn a_curve_is_broken_where_nothing_was_measured() {
        let points: Vec<[f64; 2]> =
            (0..200).map(|k| [if k < 100 { f64::from(k) } else { 150.0 + f64::from(k) }, 1.0]).collect();
        let curve = SmoothCurve::from_points(&points).unwrap();
        let pieces = curve.pieces();
        assert_eq!(pieces.len(), 2);
        assert!(pieces[0].iter().all(|it| it[0] < 100.0) && pieces[1].iter().all(|it| it[0] > 249.0));
    }

    #[test]
    fn few_points_and_points_at_one_place_have_no_curve() {
        assert!(SmoothCurve::from_points(&[[0.0, 1.0]; 20]).is_none());
        assert!(SmoothCurve::from_points(&[[0.0, 1.0], [1.0, 1.0]]).is_none());
        assert!(SmoothCurve::from_points(&[]).is_none());
    }
}
