//! Unread keys in files of cameras, boards and robots: those that scale or shift are refused, others are listed unless they are harmless.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind, Result, first_few};
use poecal_numerics::text::escape_invisible;

use crate::yaml::YamlLeaf;

/// Parts of names of keys that describe the processing of the sensor's pictures, or a scale of numbers.
const CHANGES: [&str; 17] = [
    "scale",
    "factor",
    "ratio",
    "gear",
    "invert",
    "offset",
    "crop",
    "binning",
    "decimation",
    "skew",
    "flip",
    "mirror",
    "resiz",
    "zoom",
    "shift",
    "downsampl",
    "subsampl",
];
/// A part that also counts if the key has one value: a list of several is the orientation of the camera.
const TURNS: &str = "rotat";
/// Whole names of such keys: the second parameter of an omnidirectional lens, and regions.
const CHANGES_BY_NAME: [&str; 3] = ["xi", "roi", "region"];
/// Parts of names of keys that change no number of a lens or a board.
const HARMLESS: [&str; 16] = [
    "time", "date", "stamp", "error", "rms", "serial", "comment", "note", "version", "name", "topic", "frames", "flag",
    "views", "gray", "grey",
];
/// Values of a key without any effect.
const NEUTRAL: [&str; 6] = ["", "false", "no", "none", "off", "null"];

/// Subject of the keys of a file, for the sentence of a key that changes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyOwner {
    /// A camera's pictures.
    Pictures,
    /// A board.
    Board,
    /// A robot.
    Robot,
}

impl KeyOwner {
    /// The expected state, and the remedy.
    fn as_they_are(self) -> &'static str {
        match self {
            KeyOwner::Pictures => "numbers of the pictures as they are: state them for these pictures",
            KeyOwner::Board => "the board as it is printed: state its own numbers",
            KeyOwner::Robot => "lengths and angles as they are: work it into them",
        }
    }
}

/// The keys of a file that were not read and are not harmless, in words. `read` returns true for a lower-case key at depth `at` of the leaves' keys
/// that was read or is known to be harmless there.
///
/// # Errors
/// [`ErrorKind::Measurement`] for a key that scales or shifts the numbers, with its position.
pub fn other_keys(
    leaves: &[YamlLeaf],
    at: usize,
    read: impl Fn(&str) -> bool,
    (of, path): (KeyOwner, &Path),
) -> Result<Option<String>> {
    let mut others: Vec<String> = Vec::new();
    for leaf in leaves {
        let Some(key) = leaf.path.get(at) else { continue };
        let small = key.to_lowercase();
        if read(&small) || HARMLESS.iter().any(|part| small.contains(part)) {
            continue;
        }
        if !changes(leaf, at) {
            let word = format!("`{}`", escape_invisible(key));
            if !others.contains(&word) {
                others.push(word);
            }
        } else if !is_neutral(leaf, at) {
            let message = format!(
                "found `{}` for `{}`, which this program does not apply, expected {}, and remove the key",
                leaf.text,
                leaf.path.join("."),
                of.as_they_are()
            );
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, leaf.line));
        }
    }
    Ok((!others.is_empty()).then(|| format!("did not read {}", first_few(&others))))
}

/// True if a key scales or shifts.
fn changes(leaf: &YamlLeaf, at: usize) -> bool {
    let keys: Vec<String> = leaf.path.iter().skip(at).map(|key| key.to_lowercase()).collect();
    let is_one =
        |key: &String| CHANGES.iter().any(|part| key.contains(part)) || CHANGES_BY_NAME.contains(&key.as_str());
    let is_turn = keys.len() == 1 && keys.iter().any(|key| key.contains(TURNS));
    is_turn || keys.iter().any(is_one)
}

/// True if a key that scales or shifts has a value without any effect.
fn is_neutral(leaf: &YamlLeaf, at: usize) -> bool {
    // For these, 1 is no neutral value.
    const SHIFTS: [&str; 5] = ["offset", "shift", "flip", "mirror", "invert"];
    let is_shift = |key: &String| SHIFTS.iter().any(|part| key.to_lowercase().contains(part));
    let value = leaf.text.trim().to_lowercase();
    match value.parse::<f64>() {
        Ok(number) => number == 0.0 || number == 1.0 && !leaf.path.iter().skip(at).any(is_shift),
        Err(_) => NEUTRAL.contains(&value.as_str()),
    }
}
