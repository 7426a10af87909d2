//! Columns with the times of rows.

use super::roles::{ColumnRole, plain_letters};

/// Units of times, with their sizes in seconds.
const UNITS: [(&str, f64); 6] = [("s", 1.0), ("sec", 1.0), ("seconds", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];

/// Unit, in seconds, of a column of times with this name and unit; `None` for another column.
pub(crate) fn seconds_of(name: &str, unit: Option<&str>) -> Option<f64> {
    let plain = plain_letters(name);
    let own = |unit: &str| UNITS.iter().find(|it| it.0.eq_ignore_ascii_case(unit)).map(|it| it.1);
    match (ColumnRole::Time.has(&plain), unit) {
        (true, None) => Some(1.0),
        (true, Some(unit)) => own(unit),
        (false, None) => own(["timestamp", "time"].into_iter().find_map(|it| plain.strip_prefix(it))?),
        (false, Some(_)) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::seconds_of;

    #[test]
    fn columns_of_times_are_known_by_their_names() {
        for (name, unit, expected) in [
            ("time", None, Some(1.0)),
            ("Time (Seconds)", None, Some(1.0)),
            ("timestamp", Some("ms"), Some(1e-3)),
            ("time_ns", None, Some(1e-9)),
            ("t", Some("s"), Some(1.0)),
            ("t", Some("mm"), None),
            ("torque", None, None),
            ("theta", None, None),
        ] {
            assert_eq!(seconds_of(name, unit), expected, "{name} {unit:?}");
        }
    }
}
