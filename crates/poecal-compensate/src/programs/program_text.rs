//! Corrected numbers in the text of a program.

use std::ops::Range;

use poecal_programs::parsed_program::{Number, PoseMeaning};

/// A number in written form; empty if it is unchanged.
pub(crate) fn number(at: usize, (number, value): (&Number, &f64), meant: PoseMeaning) -> String {
    let count = match meant {
        PoseMeaning::Joints => usize::MAX,
        PoseMeaning::Pose(form) => form.names().len(),
    };
    if at >= count {
        let is_same = (value - number.value).abs() < 0.5;
        return if is_same { String::new() } else { format!("{value:.0}") };
    }
    let least = match meant {
        PoseMeaning::Pose(form) if number.scale == 1.0 => form.decimals(at),
        PoseMeaning::Pose(_) | PoseMeaning::Joints => match number.scale.abs() {
            it if it >= 0.5 => 9,
            it if it >= 0.01 => 7,
            _ => 6,
        },
    };
    let decimals = number.decimals.max(least).min(17);
    let value = value / number.scale;
    if (value - number.value).abs() < 0.5 * 10_f64.powi(-(decimals as i32)) {
        return String::new();
    }
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|it| matches!(it, b'-' | b'0' | b'.'));
    if is_zero { text.replace('-', "") } else { text }
}

/// A number with the sign style of the old one: a plus and the spaces after the sign are kept.
pub(crate) fn with_sign_as(old: &[u8], new: String) -> String {
    let Some(sign @ (b'+' | b'-')) = old.first() else { return new };
    let gap: String = old[1..].iter().take_while(|it| it.is_ascii_whitespace()).map(|&it| char::from(it)).collect();
    match (new.strip_prefix('-'), sign) {
        (Some(digits), _) => format!("-{gap}{digits}"),
        (None, b'+') => format!("+{gap}{new}"),
        (None, _) => format!("{gap}{new}"),
    }
}

/// A text with other bytes in some ranges.
pub(crate) fn replace_ranges(text: &[u8], mut changes: Vec<(Range<usize>, String)>) -> Vec<u8> {
    changes.sort_by_key(|(range, _)| range.start);
    let mut out = Vec::with_capacity(text.len() + 4 * changes.len());
    let mut at = 0;
    for (range, new) in changes {
        out.extend_from_slice(text.get(at..range.start).unwrap_or_default());
        out.extend_from_slice(new.as_bytes());
        at = range.end;
    }
    out.extend_from_slice(text.get(at..).unwrap_or_default());
    out
}
