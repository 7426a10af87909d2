//! Arguments with a few words as values, and numbers with a unit in their name.

use nalgebra::Vector3;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_cli::words::{self, Words};
use poecal_model::measurement::Quantity;
use poecal_model::simulate::Kind;
use poecal_numerics::error::nearest;
use poecal_numerics::text::visible;
use pyo3::prelude::*;

use crate::errors::argument;

/// Longest text of a found value in a message.
const SHOWN: usize = 60;

/// Meaning of `word`, which must be one of these.
pub(crate) fn chosen<T: Copy>(name: &str, word: &str, words: &[(&str, T)]) -> PyResult<T> {
    if let Some((_, meaning)) = words.iter().find(|(known, _)| *known == word) {
        return Ok(*meaning);
    }
    let known: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
    let hint = nearest(word, known.iter().copied())
        .map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    Err(argument(name, format!("found `{word}`, expected one of {}{hint}", known.join(", "))))
}

/// Meaning of one of the words of an option of the program.
pub(crate) fn one_of<T: Copy>(name: &str, word: &str, words: Words<T>) -> PyResult<T> {
    let words: Vec<(&str, T)> = words.iter().map(|(word, _, meaning)| (*word, *meaning)).collect();
    chosen(name, word, &words)
}

pub(crate) fn frame(word: &str) -> PyResult<DeviceFrameKnowledge> {
    one_of("device_frame", word, words::FRAME)
}

pub(crate) fn kind(word: &str) -> PyResult<Kind> {
    let words: Vec<(&str, Kind)> = Kind::all().into_iter().map(|kind| (kind.word(), kind)).collect();
    chosen("kind", word, &words)
}

pub(crate) fn quantity(word: &str) -> PyResult<Quantity> {
    chosen("quantity", word, &Quantity::ALL.map(|quantity| (quantity.name(), quantity)))
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
pub(crate) fn shortened(text: &str) -> String {
    let line = text.trim().lines().next().unwrap_or_default();
    let begin: String = line.chars().take(SHOWN).collect();
    let mark = if begin.len() < text.trim().len() { "…" } else { "" };
    format!("{}{mark}", visible(&begin))
}
