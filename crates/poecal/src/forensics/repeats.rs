//! Rows that stand in the data more than once, and rows that contradict each other.

use super::judge::short;
use super::session::Session;
use super::{Diagnosis, DiagnosisKind};
use crate::lie::rotation;
use crate::measurement::{Dataset, Measurement};

/// Rows of one configuration contradict each other when they lie further apart than this share of the reach, or are turned by more
/// than this angle (radians): a hundred times what a robot repeats to.
const CONTRADICTION_SHARE: f64 = 5e-3;
const CONTRADICTION_RAD: f64 = 0.035;
/// Pairs that a statement names.
const NAMED: usize = 3;

/// Rows that repeat another, or contradict it.
pub(super) fn diagnose(session: &Session<'_>, data: &Dataset, rows: &[u32]) -> Vec<Diagnosis> {
    let key = |row: u32| data.readings(row as usize).iter().map(|value| value.to_bits());
    let target = |row: u32| data.observations[row as usize].target;
    let mut order = rows.to_vec();
    order.sort_by(|&a, &b| target(a).cmp(&target(b)).then_with(|| key(a).cmp(key(b))).then(a.cmp(&b)));
    let same = |a: &u32, b: &u32| target(*a) == target(*b) && key(*a).eq(key(*b));
    let mut repeated: Vec<(u32, u32)> = Vec::new();
    let mut contradicting: Vec<(u32, u32)> = Vec::new();
    let mut furthest: f64 = 0.0;
    for group in order.chunk_by(same) {
        for (k, &row) in group.iter().enumerate().skip(1) {
            let seen = |row: u32| &data.observations[row as usize].measurement;
            if let Some(&first) = group[..k].iter().find(|&&first| seen(first) == seen(row)) {
                repeated.push((first, row));
                continue;
            }
            let (apart_m, contradicts) = apart(session, seen(group[0]), seen(row));
            if contradicts {
                furthest = furthest.max(apart_m);
                contradicting.push((group[0], row));
            }
        }
    }
    let mut found = Vec::new();
    if !repeated.is_empty() {
        repeated.sort_unstable_by_key(|pair| pair.1);
        let statement = format!(
            "{} to the last digit, readings and measurement ({}): leave out what was copied, since it counts twice",
            if repeated.len() == 1 {
                "1 row repeats another".to_owned()
            } else {
                format!("{} rows repeat others", repeated.len())
            },
            pairs(data, &repeated, "as")
        );
        let rows = repeated.iter().map(|pair| pair.1).collect();
        found.push(Diagnosis {
            kind: DiagnosisKind::DuplicateRows,
            statement,
            rows,
            before_mm: 0.0,
            after_mm: 0.0,
        });
    }
    if !contradicting.is_empty() {
        contradicting.sort_unstable_by_key(|pair| pair.1);
        let statement = format!(
            "{} the readings of another and contradicts it, by up to {} mm ({}): look which is right, and leave the other out",
            if contradicting.len() == 1 {
                "1 row has".to_owned()
            } else {
                format!("each of {} rows has", contradicting.len())
            },
            short(furthest * 1e3),
            pairs(data, &contradicting, "against")
        );
        let mut rows: Vec<u32> = contradicting.iter().flat_map(|pair| [pair.0, pair.1]).collect();
        rows.sort_unstable();
        rows.dedup();
        let before_mm = furthest * 1e3;
        found.push(Diagnosis {
            kind: DiagnosisKind::DuplicateRows,
            statement,
            rows,
            before_mm,
            after_mm: 0.0,
        });
    }
    found
}

/// How far two measurements of one configuration are apart, and whether that is more than a robot's repeatability.
fn apart(session: &Session<'_>, a: &Measurement, b: &Measurement) -> (f64, bool) {
    let (first, second) = (a.pose(), b.pose());
    let distance = (first.translation - second.translation).norm();
    let both = a.sees_orientation() && b.sees_orientation();
    let turn = if both { rotation::log(&(first.rotation * second.rotation.transpose())).norm() } else { 0.0 };
    (distance, distance > CONTRADICTION_SHARE * session.reach_m() || turn > CONTRADICTION_RAD)
}

/// The first few pairs of rows by name.
fn pairs(data: &Dataset, pairs: &[(u32, u32)], word: &str) -> String {
    let named = pairs.iter().take(NAMED);
    let named: Vec<String> =
        named.map(|&(first, row)| format!("{} {word} {}", place(data, row), place(data, first))).collect();
    format!("{}{}", named.join(", "), if pairs.len() > NAMED { ", …" } else { "" })
}

/// A row as people find it: file and line, or its number from 1.
pub(super) fn place(data: &Dataset, row: u32) -> String {
    let source = data.observations.get(row as usize).map(|observation| observation.source);
    match source.and_then(|source| Some((data.files.get(source.file as usize)?, source.line))) {
        Some((file, line)) if line > 0 => format!("{}:{line}", file.display()),
        _ => format!("row {}", row + 1),
    }
}
