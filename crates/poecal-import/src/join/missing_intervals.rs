//! Reasons why rows that follow each other as in a recording have no static intervals.

use poecal_fit::start::StreamFailure;

/// Reason why rows have no static intervals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum MissingIntervals {
    /// They are a list, or have other measurements than positions.
    Listed,
    /// They follow each other as in a recording, but their times cannot be used. `why` is the reason, and `back` the line whose time is before that
    /// of the line above.
    Recorded { why: String, back: Option<usize> },
}

impl MissingIntervals {
    /// The reason by the defect of the rows' times, with their lines; a list if there is none.
    pub(crate) fn from_times(why: Option<StreamFailure>, times: &[f64], line: impl Fn(usize) -> Option<usize>) -> Self {
        let Some(why) = why else { return MissingIntervals::Listed };
        let line = |row: usize| line(row).unwrap_or_default();
        let back = if let StreamFailure::Back(row) = why { Some(line(row)) } else { None };
        let why = match why {
            StreamFailure::NoTime(_) if times.iter().all(|it| it.is_nan()) => "no column of times".to_owned(),
            StreamFailure::NoTime(row) => format!("no time in line {}", line(row)),
            StreamFailure::Slow(0.0) => {
                "times that are the same in most rows (write them with fractions of a second)".to_owned()
            }
            StreamFailure::Slow(step_s) => {
                let units = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
                let unit = units.into_iter().find(|it| (1e-4..0.25).contains(&(step_s * it.1)));
                let advice = unit.map_or_else(
                    || "a recording has four rows a second or more".to_owned(),
                    |(unit, _)| format!("if they are {unit}, write `time[{unit}]` in the header"),
                );
                format!("times {step_s} s apart ({advice})")
            }
            StreamFailure::Back(row) => {
                let time = |row: usize| times.get(row).copied().unwrap_or(f64::NAN);
                format!("a time that goes back, from {} s to {} s", time(row.saturating_sub(1)), time(row))
            }
        };
        MissingIntervals::Recorded { why, back }
    }
}
