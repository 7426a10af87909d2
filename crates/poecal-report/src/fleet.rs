//! A line of robots in figures, from its ledger.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_plan::fleet::{
    Capability, FEWEST, FigureSeries, FigureSpread, FigureStep, FigureValue, OutlyingRobot, outliers, steps,
    typical_value,
};
use poecal_results::fleet::LedgerRow;
use poecal_storage::csv_text::cell;

/// A figure of the line with its spread.
#[derive(Clone, Debug, PartialEq)]
pub struct LineFigure {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its scatter.
    pub spread: FigureSpread,
    /// Its capability relative to its limits, if there are some.
    pub capability: Option<Capability>,
}

/// Effect of the line's prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PriorUse {
    /// Number of robots that were calibrated by it.
    pub robots: usize,
    /// Its share in the information on their axes, 0 to 1: the median.
    pub share: f64,
    /// Median of their errors (RMS), millimetres.
    pub error: f64,
    /// Robots since the first of these that were measured in full and judged without it: their number, the share of the default tolerance, and the
    /// median of their errors.
    pub in_full: Option<(usize, f64, f64)>,
}

impl PriorUse {
    fn from_rows(rows: &[&LedgerRow]) -> Option<Self> {
        let done: Vec<&LedgerRow> = rows.iter().copied().filter(|row| row.verdict.is_some()).collect();
        let first = done.iter().position(|row| row.by_prior)?;
        let (own, others): (Vec<&LedgerRow>, Vec<&LedgerRow>) = done[first..].iter().partition(|row| row.by_prior);
        let error = |rows: &[&LedgerRow]| typical_value(rows.iter().filter_map(|row| row.error_rms));
        let share =
            |rows: &[&LedgerRow]| typical_value(rows.iter().filter_map(|row| row.prior_share())).unwrap_or_default();
        Some(PriorUse {
            robots: own.len(),
            share: share(&own),
            error: error(&own)?,
            in_full: error(&others).map(|error| (others.len(), share(&others), error)),
        })
    }

    /// The effect in words.
    #[must_use]
    pub fn words(&self) -> String {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let own = format!(
            "{} robots by the prior of the line, its share in what is known of their axes {}, error {:.4} mm (medians)",
            self.robots,
            percent(self.share),
            self.error
        );
        match self.in_full {
            None => own + "; none since was measured in full and judged without it",
            Some((count, share, error)) => format!(
                "{own}; {count} measured in full and judged without it, {} of the usual tolerance, error {error:.4} mm",
                percent(share)
            ),
        }
    }
}

/// A line of robots.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetLine {
    /// The robots, in the order of measurement.
    pub rows: Vec<LedgerRow>,
    /// Number of robots.
    pub first: usize,
    /// Number of robots that passed at their first measurement.
    pub first_passed: usize,
    /// All figures of the line, in the order of measurement.
    pub series: Vec<FigureSeries>,
    /// True if there are too few robots for spreads.
    pub is_few: bool,
    /// Spreads of all figures.
    pub figures: Vec<LineFigure>,
    /// Robots that deviate from the line.
    pub outliers: Vec<OutlyingRobot>,
    /// Steps in time, each true if it is the station's.
    pub steps: Vec<(FigureStep, bool)>,
    /// Effect of the line's prior, if there is one.
    pub prior: Option<PriorUse>,
}

/// Outliers that are printed.
const LISTED: usize = 40;
/// Share of the figures that step within so many robots from which on a step is the station's.
const MOST_FIGURES: f64 = 0.5;
const TOGETHER: usize = 10;

impl FleetLine {
    /// Figures of the rows of a ledger. `reference` is the serial number of the reference arm, which does not count in the line; limits are by the
    /// names of figures.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if a limit names no figure.
    pub fn from_rows(
        rows: Vec<LedgerRow>,
        reference: Option<&str>,
        limits: &BTreeMap<String, [Option<f64>; 2]>,
    ) -> Result<Self> {
        let (of_reference, of_line): (Vec<&LedgerRow>, Vec<&LedgerRow>) =
            rows.iter().partition(|row| Some(row.serial.as_str()) == reference);
        let mut seen = BTreeSet::new();
        let first: Vec<&&LedgerRow> = of_line.iter().filter(|row| seen.insert(&row.serial)).collect();
        let all = series(&of_line);
        let limits = limits_of(&all, limits)?;
        let figure = |it: &FigureSeries| {
            let limits = limits.get(&it.name).copied().unwrap_or_default();
            Some(LineFigure {
                name: it.name.clone(),
                unit: it.unit,
                spread: FigureSeries { is_size: false, ..it.clone() }.spread().filter(|_| it.is_enough())?,
                capability: Capability::from_series(it, limits[0], limits[1]),
            })
        };
        let of_reference = steps(&series(&of_reference));
        let found = steps(&all);
        let is_station = |step: &FigureStep| {
            let near = found.iter().filter(|it| it.from.abs_diff(step.from) <= TOGETHER).count();
            near as f64 > MOST_FIGURES * all.len() as f64 || of_reference.iter().any(|it| it.series == step.series)
        };
        let figures: Vec<LineFigure> = all.iter().filter_map(figure).collect();
        Ok(FleetLine {
            first: first.len(),
            first_passed: first.iter().filter(|row| row.is_passed()).count(),
            prior: PriorUse::from_rows(&of_line),
            is_few: of_line.len() < FEWEST,
            outliers: outliers(&all),
            steps: found.iter().map(|step| (step.clone(), is_station(step))).collect(),
            figures,
            series: all,
            rows,
        })
    }

    /// The table: one row for each robot and date, one column for each figure.
    #[must_use]
    pub fn csv(&self) -> String {
        let rows: Vec<&LedgerRow> = self.rows.iter().collect();
        let all = series(&rows);
        let mut out = String::from("serial,date,type,exit,verdict,accepted,rows,error_rms,noise,prior_share");
        for it in &all {
            let name = format!("{}[{}]", it.name, it.unit);
            let _ = write!(out, ",{},{}", cell(&name), cell(&format!("sigma_{name}")));
        }
        out.push_str(",reason\n");
        let by_robot: Vec<BTreeMap<&str, &FigureValue>> =
            all.iter().map(|it| it.values.iter().map(|value| (value.serial.as_str(), value)).collect()).collect();
        for row in &self.rows {
            let text = |it: &Option<String>| cell(it.as_deref().unwrap_or_default()).into_owned();
            let number = |it: Option<f64>| it.map_or_else(String::new, |it| it.to_string());
            let _ = write!(
                out,
                "{},{},{},{},{},{},{},{},{},{}",
                cell(&row.serial),
                cell(&row.date),
                cell(&row.of_type),
                row.exit,
                text(&row.verdict),
                text(&row.accepted),
                row.rows.map_or_else(String::new, |it| it.to_string()),
                number(row.error_rms),
                number(row.noise),
                number(row.prior_share().filter(|_| row.by_prior))
            );
            for values in &by_robot {
                match values.get(key(row).as_str()) {
                    Some(value) => {
                        let _ = write!(out, ",{},{}", value.value, value.sigma);
                    }
                    None => out.push_str(",,"),
                }
            }
            let _ = writeln!(out, ",{}", text(&row.reason));
        }
        out
    }

    /// Findings on the line, in words.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        let rate = 100.0 * self.first_passed as f64 / self.first.max(1) as f64;
        let robots = self.rows.iter().map(|row| &row.serial).collect::<BTreeSet<_>>().len();
        let visits =
            if self.rows.len() > robots { format!("; {} measurements in all", self.rows.len()) } else { String::new() };
        let _ = writeln!(
            out,
            "robots      {robots}, {} of {} passed at their first measurement ({rate:.1} %){visits}",
            self.first_passed, self.first
        );
        for row in &self.rows {
            if let Some(sentence) = &row.of_another {
                let _ = writeln!(out, "another     {} {}: {sentence}", row.serial, row.date);
            }
        }
        if self.is_few {
            let _ = writeln!(out, "spreads     none: fewer than {FEWEST} robots");
        }
        if let Some(prior) = &self.prior {
            let _ = writeln!(out, "prior       {}", prior.words());
        }
        for it in self.outliers.iter().take(LISTED) {
            let _ = writeln!(out, "outlier     {}: {}, {:.1} spreads of the line", it.serial, it.series, it.spreads);
        }
        for (step, is_station) in &self.steps {
            let of = if *is_station { " (the station's)" } else { "" };
            let _ = writeln!(out, "step        {}{of}", step_words(step));
        }
        out
    }
}

/// Limits by the names of the figures; a unit in brackets must be that of the figure.
fn limits_of(
    all: &[FigureSeries],
    limits: &BTreeMap<String, [Option<f64>; 2]>,
) -> Result<BTreeMap<String, [Option<f64>; 2]>> {
    let plain = |(key, own): (&String, &[Option<f64>; 2])| {
        let parts = key.strip_suffix(']').and_then(|it| it.split_once('['));
        let (name, unit) = parts.map_or((key.as_str(), None), |(name, unit)| (name, Some(unit)));
        let series = all.iter().find(|it| it.name == name);
        match (series, unit) {
            // If all robots were refused there are no figures.
            (None, _) if !all.is_empty() => {
                let known: Vec<&str> = all.iter().map(|it| it.name.as_str()).collect();
                ErrorKind::Option.refuse(format!(
                    "found limits of `{name}`, which is no figure of the line, expected one of {}",
                    poecal_numerics::error::first_few(&known)
                ))
            }
            (Some(series), Some(unit)) if unit != series.unit => ErrorKind::Option.refuse(format!(
                "found limits of `{name}` in {unit}, expected {}, the unit of the figure",
                series.unit
            )),
            _ => Ok((name.to_owned(), *own)),
        }
    };
    limits.iter().map(plain).collect()
}

/// A step in words.
pub(crate) fn step_words(step: &FigureStep) -> String {
    let by = match step.unit {
        Some(unit) => format!("{:+.4} {unit}", step.size),
        None => format!("a factor of {:.2}", step.size),
    };
    format!("{} since {} by {by}", step.series, step.since)
}

/// A robot and date, as one value of a series.
pub(crate) fn key(row: &LedgerRow) -> String {
    if row.date.is_empty() { row.serial.clone() } else { format!("{} {}", row.serial, row.date) }
}

/// All figures of some robots.
pub(crate) fn series(rows: &[&LedgerRow]) -> Vec<FigureSeries> {
    let mut found: BTreeMap<(usize, String), FigureSeries> = BTreeMap::new();
    let mut add = |order: usize,
                   name: String,
                   joint: Option<&str>,
                   unit: &'static str,
                   is_size: bool,
                   value: FigureValue| {
        let empty =
            || FigureSeries { name: name.clone(), joint: joint.map(str::to_owned), unit, is_size, values: Vec::new() };
        found.entry((order, name.clone())).or_insert_with(empty).values.push(value);
    };
    for row in rows.iter().filter(|row| row.verdict.is_some()) {
        let one =
            |value: f64, sigma: Option<f64>| FigureValue { serial: key(row), value, sigma: sigma.unwrap_or_default() };
        if let Some(error) = row.error_rms {
            add(0, "error".to_owned(), None, "mm", true, one(error, None));
        }
        if let Some(noise) = row.noise {
            add(1, "noise".to_owned(), None, "mm", true, one(noise, None));
        }
        for it in &row.corrections {
            let joint = Some(it.joint.as_str());
            if let Some(offset) = it.offset {
                let unit = if it.unit == "mm" { "mm" } else { "deg" };
                add(2, format!("{}.offset", it.joint), joint, unit, false, one(offset, it.sigma_offset));
            }
        }
        for it in row.terms.iter().filter(|it| it.group != "tilt") {
            let unit = unit(&it.group);
            add(
                3,
                format!("{}.{}", it.joint, it.group),
                Some(&it.joint),
                unit,
                // A ratio has a sign.
                it.group != "ratio",
                one(it.amplitude, Some(it.sigma)),
            );
        }
        // A single joint with a larger error may be chance even if all together are not.
        let groups: BTreeSet<&str> = row.terms.iter().map(|it| it.group.as_str()).collect();
        for group in groups.into_iter().filter(|group| *group != "tilt") {
            let own = || row.terms.iter().filter(|it| it.group == group);
            let length = own().map(|it| it.amplitude.powi(2)).sum::<f64>().sqrt();
            let sigma = own().map(|it| (it.amplitude * it.sigma).powi(2)).sum::<f64>().sqrt();
            let sigma = if length > 0.0 { sigma / length } else { 0.0 };
            add(4, group.to_owned(), None, unit(group), false, one(length, Some(sigma)));
        }
    }
    found.into_values().collect()
}

/// Unit of the terms of a group.
fn unit(group: &str) -> &'static str {
    if group == "shift" || group == "runout" { "mm" } else { "mrad" }
}
