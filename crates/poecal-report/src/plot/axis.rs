//! Axes: which range is shown, where its ticks are, and where a value lies on it.

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisScale {
    Linear,
    /// The same from the least value to the largest, and not from tick to tick.
    Close,
    /// Powers of ten.
    Log,
    /// Whole numbers from 0.
    Count,
}

/// An axis before it sees its data.
pub struct PlotAxis {
    /// Quantity and unit.
    pub title: String,
    pub scale: AxisScale,
    /// Values that are shown whatever the data are.
    pub includes: Vec<f64>,
    /// Steps between ticks that a linear axis aims at.
    pub steps: f64,
}

impl PlotAxis {
    pub fn new(title: &str, scale: AxisScale) -> Self {
        PlotAxis { title: title.to_owned(), scale, includes: Vec::new(), steps: TICKS }
    }

    pub fn with_values(mut self, values: &[f64]) -> Self {
        self.includes.extend_from_slice(values);
        self
    }

    /// The same with so many steps between its ticks, or somewhat fewer.
    pub fn in_steps(self, steps: f64) -> Self {
        PlotAxis { steps, ..self }
    }

    /// The range and ticks for these values.
    pub(crate) fn ruler(&self, values: impl Iterator<Item = f64>) -> Ruler {
        let values: Vec<f64> = values.chain(self.includes.iter().copied()).collect();
        match self.scale {
            AxisScale::Linear => Ruler::linear(&values, self.steps, true),
            AxisScale::Close => Ruler::linear(&values, self.steps, false),
            AxisScale::Log => Ruler::log(&values),
            AxisScale::Count => Ruler::count(&values),
        }
    }
}

/// Position of a value on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisPosition {
    /// From 0 (low end) to 1 (high end).
    pub(crate) share: f64,
    /// True if the value itself lies on the axis; else it is drawn at the nearer end.
    pub(crate) inside: bool,
}

/// An axis with its range.
pub(crate) struct Ruler {
    log: bool,
    /// Ends: values, or powers of ten.
    low: f64,
    high: f64,
    /// Share along the axis and label.
    pub(crate) ticks: Vec<(f64, String)>,
}

/// Decades that a logarithmic axis shows at most: smaller values are rounding.
const MOST_DECADES: i32 = 20;
/// Largest and smallest size that a linear axis works with, so that differences and steps stay finite.
const LARGEST: f64 = 1e300;
const SMALLEST: f64 = 1e-290;
/// Room at each end of a linear axis, as a share of it.
const PADDING: f64 = 0.03;
/// Digits of powers.
const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
/// Ticks that an axis aims at.
const TICKS: f64 = 5.0;

impl Ruler {
    /// Position of a value; `None` if it is not a number.
    pub(crate) fn place(&self, value: f64) -> Option<AxisPosition> {
        if value.is_nan() {
            return None;
        }
        // The logarithm of zero is minus infinity, and that of a negative value is shown there too.
        let along = if self.log { value.max(0.0).log10() } else { value };
        let inside = along.is_finite() && along >= self.low && along <= self.high;
        Some(AxisPosition { share: self.share(along.clamp(self.low, self.high)), inside })
    }

    /// Its ends; of a logarithmic axis powers of ten.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    fn share(&self, along: f64) -> f64 {
        (along - self.low) / (self.high - self.low)
    }

    fn log(values: &[f64]) -> Self {
        let positive = || values.iter().filter(|v| v.is_finite() && **v > 0.0);
        let largest = positive().fold(f64::NAN, |a, b| a.max(*b));
        let smallest = positive().fold(f64::NAN, |a, b| a.min(*b));
        let (mut low, mut high) =
            if largest.is_nan() { (0, 1) } else { (smallest.log10().floor() as i32, largest.log10().ceil() as i32) };
        low = low.max(high - MOST_DECADES);
        if low == high {
            high += 1;
        }
        // Values beyond get an end of their own, free of other data.
        let beyond = |v: &f64| *v <= 0.0 || (*v > 0.0 && v.log10() < f64::from(low));
        let inside = low..=high;
        low -= i32::from(values.iter().any(beyond));
        high += i32::from(values.contains(&f64::INFINITY));
        let mut ruler = Ruler { log: true, low: f64::from(low), high: f64::from(high), ticks: Vec::new() };
        let ticks = log_ticks(inside, high - low);
        ruler.ticks = ticks.into_iter().map(|(along, label)| (ruler.share(along), label)).collect();
        ruler
    }

    fn linear(values: &[f64], steps: f64, to_ticks: bool) -> Self {
        let (mut low, mut high) = range(values).unwrap_or((0.0, 1.0));
        // Values that differ by rounding are one value, with room around it.
        if high - low <= 1e-9 * low.abs().max(high.abs()) {
            let room = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
            (low, high) = (low - room, high + room);
        }
        let step = step(high - low, steps);
        // Values that differ from a tick by rounding lie on it.
        let [first, last] = [(low / step + 1e-9).floor() * step, (high / step - 1e-9).ceil() * step];
        if to_ticks {
            return Ruler::from_step(first, last, step).pad_ends();
        }
        let mut ruler = Ruler::from_step(first, last, step);
        let along = |share: f64| first + share * (last - first);
        let span = high - low;
        ruler.ticks.iter_mut().for_each(|it| it.0 = (along(it.0) - low) / span);
        ruler.ticks.retain(|it| (-1e-9..=1.0 + 1e-9).contains(&it.0));
        (ruler.low, ruler.high) = (low, high);
        ruler.pad_ends()
    }

    fn count(values: &[f64]) -> Self {
        let (_, high) = range(values).unwrap_or((0.0, 1.0));
        let high = high.max(1.0).ceil();
        Ruler::from_step(0.0, high, step(high, TICKS).max(1.0))
    }

    /// The same with room at both ends, so that a marker at an end lies whole on the plot.
    fn pad_ends(mut self) -> Self {
        for (share, _) in &mut self.ticks {
            *share = (*share + PADDING) / (1.0 + 2.0 * PADDING);
        }
        let room = PADDING * (self.high - self.low);
        (self.low, self.high) = (self.low - room, self.high + room);
        self
    }

    /// Ticks from `low` on, `step` apart, as far as `high`.
    fn from_step(low: f64, high: f64, step: f64) -> Self {
        let mut ruler = Ruler { log: false, low, high, ticks: Vec::new() };
        let count = ((high - low) / step + 1e-6).floor().clamp(0.0, 4.0 * TICKS) as usize;
        ruler.ticks = (0..=count)
            .map(|k| low + step * k as f64)
            .map(|value| (ruler.share(value).clamp(0.0, 1.0), value_label(value, step)))
            .collect();
        ruler
    }
}

/// Smallest and largest finite value.
fn range(values: &[f64]) -> Option<(f64, f64)> {
    let clipped = values
        .iter()
        .filter(|v| v.is_finite())
        .map(|v| if v.abs() < SMALLEST { 0.0 } else { v.clamp(-LARGEST, LARGEST) });
    clipped.fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((low, high)) => Some((f64::min(low, v), f64::max(high, v))),
    })
}

/// 1, 2 or 5 times a power of ten that divides the span into about so many steps.
fn step(span: f64, steps: f64) -> f64 {
    let raw = span / steps;
    let power = 10_f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= raw * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

fn value_label(value: f64, step: f64) -> String {
    // Sums of steps miss zero by rounding.
    let value = if value.abs() < 1e-6 * step { 0.0 } else { value };
    if step < 1e-4 || value.abs() >= 1e6 {
        return format!("{value:.1e}");
    }
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    format!("{value:.decimals$}").replace('-', "−")
}

/// Ticks at powers of ten, with their labels; between few of them also at 2 and 5 times these. `decades` is the axis' length.
fn log_ticks(powers: std::ops::RangeInclusive<i32>, decades: i32) -> Vec<(f64, String)> {
    let step = ((f64::from(decades) / TICKS).ceil() as i32).max(1);
    let last = *powers.end();
    let labelled: Vec<i32> = powers.filter(|power| power.rem_euclid(step) == 0).collect();
    let plain = labelled.iter().all(|power| (-3..=4).contains(power));
    let factors: &[f64] = if plain && decades <= 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let ticks = labelled.into_iter().flat_map(|power| {
        let here = if power == last { &[1.0] } else { factors };
        here.iter().map(move |factor| (f64::from(power) + factor.log10(), power_label(*factor, power, plain)))
    });
    ticks.collect()
}

fn power_label(factor: f64, power: i32, plain: bool) -> String {
    if plain {
        let decimals = (-power).max(0) as usize;
        return format!("{:.decimals$}", factor * 10_f64.powi(power));
    }
    let digits = power.to_string();
    let raised = digits.chars().map(|c| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]));
    format!("10{}", raised.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ruler(scale: AxisScale, values: &[f64]) -> Ruler {
        PlotAxis::new("length, mm", scale).ruler(values.iter().copied())
    }

    fn labels(scale: AxisScale, values: &[f64]) -> Vec<String> {
        ruler(scale, values).ticks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels(AxisScale::Linear, &[-1.2, 3.9]), ["−2", "0", "2", "4"]);
        assert_eq!(labels(AxisScale::Linear, &[0.0, 1.0]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(AxisScale::Close, &[-1.2, 3.9]), ["0", "2"]);
        assert_eq!(labels(AxisScale::Close, &[0.0, 1.0]), labels(AxisScale::Linear, &[0.0, 1.0]));
        assert_eq!(labels(AxisScale::Count, &[0.0, 7.0]), ["0", "2", "4", "6"]);
        assert_eq!(labels(AxisScale::Log, &[0.02, 30.0]), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(labels(AxisScale::Log, &[0.03, 0.04]), ["0.01", "0.02", "0.05", "0.1"]);
        assert_eq!(labels(AxisScale::Log, &[1e-12, 1.0]), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
    }

    #[test]
    fn values_at_the_ends_of_a_linear_axis_lie_inside() {
        let ruler = ruler(AxisScale::Linear, &[-4.0, 6.0]);
        let (low, high) = (ruler.place(-4.0).unwrap(), ruler.place(6.0).unwrap());
        assert!(low.inside && low.share > 0.02 && high.inside && high.share < 0.98, "{low:?} {high:?}");
        assert_eq!(labels(AxisScale::Linear, &[-4.0, 6.0]), ["−4", "−2", "0", "2", "4", "6"]);
        assert_eq!(labels(AxisScale::Linear, &[0.9, 1.0]).last().unwrap(), "1.00");
        for (share, label) in &ruler.ticks {
            let value: f64 = label.replace('−', "-").parse().unwrap();
            assert!((ruler.place(value).unwrap().share - share).abs() < 1e-12);
        }
    }

    #[test]
    fn what_a_log_axis_cannot_show_lies_at_an_end_of_its_own() {
        let ruler = ruler(AxisScale::Log, &[0.0, 1.0, 10.0, f64::INFINITY]);
        assert_eq!(ruler.place(0.0), Some(AxisPosition { share: 0.0, inside: false }));
        assert_eq!(ruler.place(f64::INFINITY), Some(AxisPosition { share: 1.0, inside: false }));
        assert_eq!(ruler.place(f64::NAN), None);
        let one = ruler.place(1.0).unwrap();
        assert!(one.inside && one.share > 0.3 && one.share < 0.4, "{one:?}");
    }

    #[test]
    fn any_values_give_finite_shares() {
        let odd = [0.0, -0.0, 1.0, -1.0, 5e-324, -1e-300, 1e-18, 1e300, f64::MAX, f64::MIN, f64::INFINITY];
        let odd = odd.into_iter().chain([f64::NEG_INFINITY, f64::NAN, 1.0 + f64::EPSILON, 1e17]);
        let odd: Vec<f64> = odd.collect();
        for scale in [AxisScale::Linear, AxisScale::Close, AxisScale::Log, AxisScale::Count] {
            let sets = odd.iter().flat_map(|a| odd.iter().map(move |b| vec![*a, *b]));
            for values in sets.chain([vec![], odd.clone()]) {
                let ruler = ruler(scale, &values);
                assert!(ruler.ticks.len() <= 22, "{values:?}");
                assert!(ruler.ticks.iter().all(|(share, _)| (0.0..=1.0).contains(share)), "{values:?}");
                for place in values.iter().filter_map(|v| ruler.place(*v)) {
                    assert!((0.0..=1.0).contains(&place.share), "{scale:?} {values:?}");
                }
            }
        }
    }
}
