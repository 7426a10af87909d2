//! Arguments with a few words as values, and numbers with a unit in their name.

use nalgebra::Vector3;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_cli::words::{self, WordList};
use poecal_model::measurement::Quantity;
use poecal_model::simulate::SessionKind;
use poecal_numerics::error::nearest_word;
use poecal_numerics::text::escape_invisible;
use pyo3::prelude::*;

use crate::errors::argument;

/// Longest text of a found value in a message.
const SHOWN: usize = 60;

/// Meaning of `word`, which must be one of these.
pub(crate) fn choose_word<T: Copy>(name: &str, word: &str, words: &[(&str, T)]) -> PyResult<T> {
    if let Some((_, meaning)) = words.iter().find(|(known, _)| *known == word) {
        return Ok(*meaning);
    }
    let known: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
    let hint =
        nearest_word(word, known.iter().copied()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    Err(argument(name, format!("found `{word}`, expected one of {}{hint}", known.join(", "))))
}

/// Meaning of one of the words of an option of the program.
pub(crate) fn one_of<T: Copy>(name: &str, word: &str, words: WordList<T>) -> PyResult<T> {
    let words: Vec<(&str, T)> = words.iter().map(|(word, _, meaning)| (*word, *meaning)).collect();
    choose_word(name, word, &words)
}

pub(crate) fn frame(word: &str) -> PyResult<DeviceFrameKnowledge> {
    one_of("device_frame", word, words::FRAME)
}

pub(crate) fn kind(word: &str) -> PyResult<SessionKind> {
    let words: Vec<(&str, SessionKind)> = SessionKind::all().into_iter().map(|kind| (kind.word(), kind)).collect();
    choose_word("kind", word, &words)
}

pub(crate) fn quantity(word: &str) -> PyResult<Quantity> {
    choose_word("quantity", word, &Quantity::ALL.map(|quantity| (quantity.name(), quantity)))
}

/// Millimetres in metres.
pub(crate) fn from_mm(value: f64) -> f64 {
    value / 1e3
}

/// A standard deviation in SI.
pub(crate) fn sigma(name: &str, value: f64, to_si: fn(f64) -> f64) -> PyResult<f64> {
    if value > 0.0 && value.is_finite() {
        return Ok(to_si(value));
    }
    Err(argument(name, format!("found {value}, expected a standard deviation above 0")))
}

/// Standard deviations of positions (millimetres) and rotations (degrees) in SI, if they are stated.
pub(crate) fn sigmas(position_mm: Option<f64>, rotation_deg: Option<f64>) -> PyResult<[Option<f64>; 2]> {
    let position = position_mm.map(|it| sigma("sigma_position_mm", it, from_mm));
    let rotation = rotation_deg.map(|it| sigma("sigma_rotation_deg", it, f64::to_radians));
    Ok([position.transpose()?, rotation.transpose()?])
}

/// A size of errors or noise in SI.
pub(crate) fn size(name: &str, value: f64, to_si: fn(f64) -> f64) -> PyResult<f64> {
    if value >= 0.0 && value.is_finite() {
        return Ok(to_si(value));
    }
    Err(argument(name, format!("found {value}, expected a finite number not below 0")))
}

/// A direction of gravity.
pub(crate) fn direction(numbers: [f64; 3]) -> PyResult<Vector3<f64>> {
    let direction = Vector3::from(numbers);
    if direction.norm() > 0.0 && direction.norm().is_finite() {
        return Ok(direction);
    }
    Err(argument("gravity", format!("found {numbers:?}, expected a direction, like (0, 0, -1)")))
}

/// A text on one line, without its end if it is long.
pub(crate) fn shorten_text(text: &str) -> String {
    let line = text.trim().lines().next().unwrap_or_default();
    let begin: String = line.chars().take(SHOWN).collect();
    let mark = if begin.len() < text.trim().len() { "…" } else { "" };
    format!("{}{mark}", escape_invisible(&begin))
}
