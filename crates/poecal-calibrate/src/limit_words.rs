//! Text form of limits of errors: `0.2mm`, `max:0.5mm,0.05deg`.

use std::str::FromStr;

use crate::{AcceptanceLimit, AcceptanceLimits, AcceptedModel, AcceptedStatistic};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;

impl FromStr for AcceptanceLimit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (word, number) = match text.split_once(':') {
            Some((word, number)) => (Some(word.trim()), number.trim()),
            None => (None, text.trim()),
        };
        let statistic = match word {
            None => AcceptedStatistic::default(),
            Some(word) => AcceptedStatistic::ALL
                .into_iter()
                .find(|it| it.word() == word)
                .ok_or_else(|| bad(text, "rms, p95 or max before the colon"))?,
        };
        let at = number.find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E') || c == '°');
        let (number, symbol) = number.split_at(at.unwrap_or(number.len()));
        let value = number.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0);
        let Some(value) = value else { return Err(bad(text, "a number above 0 with its unit")) };
        if symbol.is_empty() {
            return Err(bad(text, "a unit behind the number"));
        }
        let typed = NamedUnit::parse_any(symbol.trim())?;
        Ok(AcceptanceLimit { statistic, unit: typed.si_unit(), most: typed.to_si(value) })
    }
}

impl FromStr for AcceptanceLimits {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let limits = text.split(',').map(str::parse).collect::<Result<Vec<AcceptanceLimit>>>()?;
        AcceptanceLimits::new(limits, AcceptedModel::default())
    }
}

fn bad(text: &str, expected: &str) -> Error {
    ErrorKind::Option
        .error(format!("found `{text}` as a limit, expected {expected}, like 0.2mm, p95:0.3mm, max:0.5mm or 0.05deg"))
}
