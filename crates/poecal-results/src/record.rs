//! Statements of a certificate about a session beside its figures: robot, persons, date, place and equipment.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_numerics::error::{Error, ErrorKind, Result, nearest_or_all};
use poecal_numerics::text::acts;

/// Most letters of an entry.
const LONGEST: usize = 200;
/// Most letters of a note.
const LONGEST_NOTE: usize = 1000;

/// Defines the record by its entries: key, label, and description.
macro_rules! record {
    ($($(#[$doc:meta])+ $key:ident = $label:literal,)+) => {
        /// Statements about a session, for its report: after ISO/IEC 17025:2017, 7.8.2. poecal computes nothing from them.
        #[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        #[serde(default)]
        pub struct Record {
            $($(#[$doc])+ #[serde(skip_serializing_if = "Option::is_none")] pub $key: Option<String>,)+
        }

        impl Record {
            /// The keys, in the order of the report.
            pub const KEYS: &[&str] = &[$(stringify!($key)),+];

            /// The statements: key, label and text.
            #[must_use]
            pub fn entries(&self) -> Vec<(&'static str, &'static str, &str)> {
                let all = [$((stringify!($key), $label, &self.$key)),+];
                let own = all.into_iter().filter_map(|(key, label, text)| Some((key, label, text.as_deref()?)));
                own.filter(|(.., text)| !text.trim().is_empty()).collect()
            }

            fn place(&mut self, key: &str) -> Option<&mut Option<String>> {
                match key {
                    $(stringify!($key) => Some(&mut self.$key),)+
                    _ => None,
                }
            }
        }
    };
}

record! {
    /// Number of the report or certificate.
    certificate = "Certificate",
    /// Name and address of the calibrating laboratory.
    laboratory = "Laboratory",
    /// Customer of the calibration.
    customer = "Customer",
    /// The robot's name used by its owner: maker and type.
    robot = "Robot",
    /// Its serial number.
    serial = "Serial number",
    /// The measuring instrument: its serial number and its own certificate.
    instrument = "Instrument",
    /// Day of the instrument's own calibration, `YYYY-MM-DD`.
    instrument_calibrated = "Instrument calibration",
    /// The tool that was on the flange.
    tool = "Tool",
    /// The load that the robot carried, with its unit.
    payload = "Payload",
    /// The speed of a test, like `100 %` or `500 mm/s`.
    speed = "Speed",
    /// Warm-up of the robot before a test.
    warm_up = "Warm-up",
    /// Person who measured.
    operator = "Operator",
    /// Day of the measurements, `YYYY-MM-DD`.
    date = "Date",
    /// Location of the robot.
    place = "Place",
    /// Temperature there, with its unit, `21.5 °C` or `21.5 ± 0.5 °C`.
    temperature = "Temperature",
    /// Day until which the certificate is valid, `YYYY-MM-DD`.
    valid_until = "Valid until",
    /// Anything else.
    note = "Note",
}

impl Record {
    /// Record of keys and texts; an empty text states nothing.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] for a key that is not known or repeated, a text that is too long or has control characters, an invalid date, and an
    /// invalid temperature.
    pub fn from_pairs<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self> {
        let mut record = Record::default();
        for (key, text) in pairs {
            let text = Record::check_text(key, text)?;
            let Some(place) = record.place(key) else { return Err(unknown(key)) };
            if place.is_some() {
                return Err(record_error(format!("found `{key}` twice in the record, expected it once")));
            }
            *place = text;
        }
        Ok(record)
    }

    /// Key and text of `KEY=TEXT`.
    ///
    /// # Errors
    /// As [`Record::from_pairs`].
    pub fn pair(text: &str) -> Result<(String, String)> {
        let Some((key, value)) = text.split_once('=') else {
            return Err(record_error(format!("found `{text}`, expected KEY=TEXT, like serial=4711")));
        };
        let key = key.trim();
        let value = Record::check_text(key, value)?.unwrap_or_default();
        Ok((key.to_owned(), value))
    }

    /// The same record with another's statements in place of its own.
    #[must_use]
    pub fn override_with(mut self, by: &Record) -> Self {
        for (key, _, text) in by.entries() {
            if let Some(place) = self.place(key) {
                *place = Some(text.to_owned());
            }
        }
        self
    }

    /// True if it states nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries().is_empty()
    }

    /// A text as it is stored; `None` for an empty one.
    fn check_text(key: &str, text: &str) -> Result<Option<String>> {
        if !Record::KEYS.contains(&key) {
            return Err(unknown(key));
        }
        let text = text.trim();
        if let Some(c) = text.chars().find(|c| acts(*c)) {
            return Err(record_error(format!(
                "found the character U+{:04X} in `{key}`, expected one line of text without control characters",
                u32::from(c)
            )));
        }
        let most = if key == "note" { LONGEST_NOTE } else { LONGEST };
        let count = text.chars().count();
        if count > most {
            return Err(record_error(format!("found {count} letters in `{key}`, expected at most {most}")));
        }
        match key {
            _ if text.is_empty() => Ok(None),
            "date" | "instrument_calibrated" | "valid_until" if !is_date(text) => {
                Err(record_error(format!("found `{text}` as the {}, expected a day like 2026-03-02", day_name(key))))
            }
            "temperature" => temperature(text).map(Some).ok_or_else(|| {
                record_error(format!(
                    "found `{text}` as the temperature, expected degrees Celsius, like 21.5C or 21.5+-0.5C"
                ))
            }),
            _ => Ok(Some(text.to_owned())),
        }
    }
}

/// A day of the record in words.
fn day_name(key: &str) -> &'static str {
    match key {
        "instrument_calibrated" => "day of the instrument's calibration",
        "valid_until" => "day until which it is valid",
        _ => "date",
    }
}

fn record_error(message: String) -> Error {
    ErrorKind::Option.error(message)
}

fn unknown(key: &str) -> Error {
    let near = nearest_or_all(key, Record::KEYS);
    record_error(format!("found the key `{key}`, expected one of the record: {near}"))
}

/// True if it is a day of the calendar, `YYYY-MM-DD`.
fn is_date(text: &str) -> bool {
    let form: String = text.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
    let mut parts = text.split('-').map(str::parse::<u32>);
    let (Some(Ok(year)), Some(Ok(month)), Some(Ok(day))) = (parts.next(), parts.next(), parts.next()) else {
        return false;
    };
    let is_leap = year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    let days = match month {
        4 | 6 | 9 | 11 => 30,
        2 if is_leap => 29,
        2 => 28,
        1..=12 => 31,
        _ => return false,
    };
    form == "0000-00-00" && year >= 1900 && (1..=days).contains(&day)
}

/// Degrees Celsius with their unit, and their variation, as people read them.
fn temperature(text: &str) -> Option<String> {
    let number = text.strip_suffix('C')?.trim_end();
    let number = number.strip_suffix('°').unwrap_or(number).trim_end();
    let (value, varied) = match number.split_once("+-").or_else(|| number.split_once('±')) {
        Some((value, varied)) => (value.trim(), Some(varied.trim())),
        None => (number, None),
    };
    let plain = |text: &str| {
        let is_plain = text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '-'));
        text.parse::<f64>().ok().filter(|_| is_plain && text.len() < 12)
    };
    plain(value).filter(|it| *it >= -273.15)?;
    match varied {
        Some(varied) => plain(varied).filter(|it| *it >= 0.0).map(|_| format!("{value} ± {varied} °C")),
        None => Some(format!("{value} °C")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        for day in ["2026-03-02", "2024-02-29", "2000-02-29", "1999-12-31"] {
            assert!(is_date(day), "{day}");
        }
        for none in [
            "2026-02-29",
            "1900-02-29",
            "2026-13-01",
            "2026-00-10",
            "2026-04-31",
            "26-03-02",
            "2026-3-2",
            "today",
            "2026-03-02-01",
            "+026-03-02",
        ] {
            assert!(!is_date(none), "{none}");
        }
    }

    #[test]
    fn temperatures_have_their_unit() {
        for (text, kept) in
            [("21.5C", "21.5 °C"), ("-4 °C", "-4 °C"), ("20 ± 0.5 °C", "20 ± 0.5 °C"), ("20+-1C", "20 ± 1 °C")]
        {
            assert_eq!(temperature(text).as_deref(), Some(kept));
        }
        for none in ["21.5", "C", "warm", "21.5 F", "-300C", "20+--1C", "nanC", "1e2C", "20+-C"] {
            assert_eq!(temperature(none), None, "{none}");
        }
    }
}
