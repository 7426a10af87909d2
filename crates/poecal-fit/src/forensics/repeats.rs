//! Rows that repeat or contradict each other.

use super::diagnosis::format_short;
use super::fitter::Fitter;
use super::unnamed_targets::{self, contradiction_m};
use super::{Diagnosis, DiagnosisKind};
use poecal_model::measurement::Dataset;

/// Largest number of rows of one configuration with which a row is compared: a robot may rest for thousands.
const NEAR: usize = 100;
/// Largest number of pairs in a statement.
const NAMED: usize = 3;

/// An earlier and a later row of one target with the same readings.
type RepeatPair = (u32, u32);

/// Findings on rows of one configuration.
pub(crate) struct Repeats {
    /// Rows that repeat others to the last digit.
    pub(crate) repeated: Option<Diagnosis>,
    /// Rows that contradict others.
    pub(crate) contradicting: Option<Diagnosis>,
    /// Cause of contradicting rows, if they are of several targets.
    pub(crate) unnamed: Option<Diagnosis>,
}

/// Compares the rows of each configuration.
pub(crate) fn diagnose(fitter: &Fitter<'_>, data: &Dataset, rows: &[u32]) -> Repeats {
    let target = |row: u32| {
        let seen = &data.observations[row as usize];
        (seen.station, seen.target)
    };
    let seen = |row: u32| &data.observations[row as usize].measurement;
    let mut repeats = data.group_repeated(rows);
    repeats.iter_mut().for_each(|group| group.sort_by_key(|&row| target(row)));
    let same = |a: &u32, b: &u32| target(*a) == target(*b);
    let (mut repeated, mut contradicting): (Vec<RepeatPair>, Vec<RepeatPair>) = (Vec::new(), Vec::new());
    let mut furthest_m: f64 = 0.0;
    for group in repeats.iter().flat_map(|group| group.chunk_by(same)) {
        for (k, &row) in group.iter().enumerate().skip(1) {
            let near = &group[k.saturating_sub(NEAR)..k];
            if let Some(&first) = near.iter().find(|&&first| seen(first) == seen(row)) {
                repeated.push((first, row));
            } else if let Some(apart_m) = contradiction_m(fitter, seen(group[0]), seen(row)) {
                furthest_m = furthest_m.max(apart_m);
                contradicting.push((group[0], row));
            }
        }
    }
    repeated.sort_unstable_by_key(|pair| pair.1);
    contradicting.sort_unstable_by_key(|pair| pair.1);
    let groups = repeats.iter().flat_map(|group| group.chunk_by(same));
    Repeats {
        repeated: repetition(data, &repeated),
        unnamed: if contradicting.is_empty() { None } else { unnamed_targets::diagnose(fitter, data, groups) },
        contradicting: contradiction(data, &contradicting, furthest_m * 1e3),
    }
}

fn repetition(data: &Dataset, repeated: &[RepeatPair]) -> Option<Diagnosis> {
    let what = match repeated.len() {
        0 => return None,
        1 => "1 row repeats another".to_owned(),
        count => format!("{count} rows repeat others"),
    };
    Some(Diagnosis {
        kind: DiagnosisKind::DuplicateRows,
        statement: format!(
            "{what} to the last digit, readings and measurement ({}): remove the copies, since they count twice",
            pairs(data, repeated, "as")
        ),
        rows: repeated.iter().map(|pair| pair.1).collect(),
        before_mm: 0.0,
        after_mm: 0.0,
    })
}

fn contradiction(data: &Dataset, contradicting: &[RepeatPair], furthest_mm: f64) -> Option<Diagnosis> {
    let what = match contradicting.len() {
        0 => return None,
        1 => "1 row has".to_owned(),
        count => format!("each of {count} rows has"),
    };
    let mut rows: Vec<u32> = contradicting.iter().flat_map(|pair| [pair.0, pair.1]).collect();
    rows.sort_unstable();
    rows.dedup();
    Some(Diagnosis {
        kind: DiagnosisKind::DuplicateRows,
        statement: format!(
            "{what} the readings of another and contradicts it, by up to {} mm ({}): check which is right, and remove the other",
            format_short(furthest_mm),
            pairs(data, contradicting, "against")
        ),
        rows,
        before_mm: furthest_mm,
        after_mm: 0.0,
    })
}

/// Description of the first pairs of rows by name.
fn pairs(data: &Dataset, pairs: &[(u32, u32)], word: &str) -> String {
    let named = pairs.iter().take(NAMED);
    let named: Vec<String> =
        named.map(|&(first, row)| format!("{} {word} {}", data.place(row), data.place(first))).collect();
    format!("{}{}", named.join(", "), if pairs.len() > NAMED { ", …" } else { "" })
}
