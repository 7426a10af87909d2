//! Numbers with a decimal point or a decimal comma.

use serde::Serialize;

/// Decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DecimalSign {
    /// `.`
    Point,
    /// `,`
    Comma,
}

/// Reader of numbers; the first one with a decimal sign fixes the sign of the file.
pub(crate) struct NumberReader {
    sign: Option<(DecimalSign, Option<usize>)>,
    buffer: String,
}

impl NumberReader {
    /// A reader for numbers with a known decimal sign, or one to be found.
    pub(crate) fn new(stated: Option<DecimalSign>) -> Self {
        NumberReader { sign: stated.map(|sign| (sign, None)), buffer: String::new() }
    }

    /// The decimal sign; a point if no number has had one.
    pub(crate) fn sign(&self) -> DecimalSign {
        self.sign.map_or(DecimalSign::Point, |(sign, _)| sign)
    }

    /// A finite number, or the expected form.
    pub(crate) fn parse(&mut self, text: &str, line: usize) -> Result<f64, String> {
        // Fast path; everything else, including `nan` and `inf`, takes the slow one.
        if matches!(self.sign, Some((DecimalSign::Point, _)))
            && let Ok(value) = fast_float2::parse::<f64, _>(text)
            && value.is_finite()
        {
            return Ok(value);
        }
        let (mut points, mut commas) = (0, 0);
        for byte in text.bytes() {
            match byte {
                b'.' => points += 1,
                b',' => commas += 1,
                b'0'..=b'9' | b'+' | b'-' | b'e' | b'E' => {}
                _ if is_grouped(text) => return Err(NO_GROUPS.to_owned()),
                // Rust's own parser would accept `nan` and `inf`.
                _ => return Err("a finite number".to_owned()),
            }
        }
        let found = match (points, commas) {
            (0, 0) => None,
            (1, 0) => Some(DecimalSign::Point),
            (0, 1) => Some(DecimalSign::Comma),
            _ => return Err(NO_GROUPS.to_owned()),
        };
        if let Some(found) = found {
            let (sign, since) = *self.sign.get_or_insert((found, Some(line)));
            if sign != found {
                let word = match sign {
                    DecimalSign::Point => "point",
                    DecimalSign::Comma => "comma",
                };
                let origin = match since {
                    Some(line) => format!("as in line {line}"),
                    None => "as the mapping states".to_owned(),
                };
                return Err(format!("a number with a decimal {word} {origin}"));
            }
        }
        let value: Result<f64, _> = if commas == 0 {
            text.parse()
        } else {
            self.buffer.clear();
            self.buffer.extend(text.chars().map(|c| if c == ',' { '.' } else { c }));
            self.buffer.parse()
        };
        value.ok().filter(|value| value.is_finite()).ok_or_else(|| "a finite number".to_owned())
    }
}

/// A finite number of a cell, with a decimal point or, if there is none, a decimal comma.
pub(crate) fn number_of(text: &str) -> Option<f64> {
    let text = text.trim();
    let is_plain = text.bytes().all(|it| it.is_ascii_digit() || b"+-.eE,".contains(&it));
    if !is_plain || text.is_empty() {
        return None;
    }
    let is_comma = text.contains(',') && !text.contains('.');
    let found = if is_comma { fast_float2::parse(text.replacen(',', ".", 1)) } else { fast_float2::parse(text) };
    found.ok().filter(|it: &f64| it.is_finite())
}

const NO_GROUPS: &str = "a number with one decimal sign and no thousands separators";

/// True if a text is digits in groups, as `1 234,5` or `1'234.5`.
fn is_grouped(text: &str) -> bool {
    let digits = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '+');
    let separates = |c: char| matches!(c, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '\'' | '\u{2019}' | '_');
    text.starts_with(digits) && text.ends_with(digits) && text.chars().all(|c| digits(c) || separates(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_decimal_sign_decides() {
        let mut numbers = NumberReader::new(None);
        assert_eq!(numbers.parse("12", 2), Ok(12.0));
        assert_eq!(numbers.parse("-2,02011E+13", 3), Ok(-2.020_11e13));
        assert_eq!(numbers.parse("1.5", 4), Err("a number with a decimal comma as in line 3".to_owned()));
        let mut numbers = NumberReader::new(Some(DecimalSign::Point));
        assert_eq!(numbers.parse("1,5", 4), Err("a number with a decimal point as the mapping states".to_owned()));
    }

    #[test]
    fn the_fast_way_takes_what_the_standard_library_takes() {
        let mut numbers = NumberReader::new(Some(DecimalSign::Point));
        for text in [
            "1",
            "+1",
            "-0",
            ".5",
            "5.",
            "1e5",
            "1E-5",
            "1.e+3",
            "4.9e-324",
            "1.7976931348623157e308",
            "0.1000000000000000055511151231257827",
        ] {
            assert_eq!(numbers.parse(text, 1).unwrap().to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
        }
        for text in ["", ".", "-", "e5", "1e", "1e+", "1 ", "1..2", "1e5.0", "1_0", "inf", "nan", "infinity", "1e999"] {
            assert!(numbers.parse(text, 1).is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_no_finite_number_is_refused() {
        for text in ["1 234.5", "-1'234,5", "1\u{202f}234"] {
            assert_eq!(NumberReader::new(None).parse(text, 1), Err(NO_GROUPS.to_owned()), "{text}");
        }
        assert_eq!(NumberReader::new(None).parse("2024-01-02 x", 1), Err("a finite number".to_owned()));
        for text in ["nan", "NaN", "inf", "-infinity", "1e999", "abc", "", "1e", "--1", "0x10", "1_0", "1,234.5"] {
            assert!(NumberReader::new(None).parse(text, 1).is_err(), "{text}");
        }
    }
}
