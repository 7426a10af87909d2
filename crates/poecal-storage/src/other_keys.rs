//! Keys of files of cameras, boards and robots that are not read: those that scale or shift are refused, others are named unless they are harmless.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind, Result, first_few};
use poecal_numerics::text::visible;

use crate::yaml::Leaf;

/// Parts of names of keys that say how pictures were made of the sensor's, or how numbers are scaled.
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
/// The same where it has one value: a list of several is where the camera is.
const TURNS: &str = "rotat";
/// The same as whole names: the second parameter of an omnidirectional lens, and regions.
const CHANGES_BY_NAME: [&str; 3] = ["xi", "roi", "region"];
/// Parts of names of keys that change no number of a lens or a board.
const HARMLESS: [&str; 16] = [
    "time", "date", "stamp", "error", "rms", "serial", "comment", "note", "version", "name", "topic",
    "frames", "flag", "views", "gray", "grey",
];
/// Values of a key that leave everything as it is.
const NEUTRAL: [&str; 6] = ["", "false", "no", "none", "off", "null"];

/// Whose keys a file has, for the sentence of a key that changes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeysOf {
    /// A camera's pictures.
    Pictures,
    /// A board.
    Board,
    /// A robot.
    Robot,
}

impl KeysOf {
    /// What is expected, and what to do.
    fn as_they_are(self) -> &'static str {
        match self {
            KeysOf::Pictures => "numbers of the pictures as they are: state them for these pictures",
            KeysOf::Board => "the board as it is printed: state its own numbers",
            KeysOf::Robot => "lengths and angles as they are: work it into them",
        }
    }
}

/// The keys of a file that were not read and are not harmless, in words; `read` says of a lower-case key at the place `at` of the leaves' keys
/// whether it was read or is known to be harmless there.
///
/// # Errors
/// [`ErrorKind::Measurement`] of a key that scales or shifts what was read, with its place.
pub fn other_keys(
    leaves: &[Leaf],
    at: usize,
    read: impl Fn(&str) -> bool,
    (of, path): (KeysOf, &Path),
) -> Result<Option<String>> {
    let mut others: Vec<String> = Vec::new();
    for leaf in leaves {
        let Some(key) = leaf.path.get(at) else { continue };
        let small = key.to_lowercase();
        if read(&small) || HARMLESS.iter().any(|part| small.contains(part)) {
            continue;
        }
        if !changes(leaf, at) {
            let word = format!("`{}`", visible(key));
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

/// Whether a key scales or shifts.
fn changes(leaf: &Leaf, at: usize) -> bool {
    let keys: Vec<String> = leaf.path.iter().skip(at).map(|key| key.to_lowercase()).collect();
    let is_one = |key: &String| {
        CHANGES.iter().any(|part| key.contains(part)) || CHANGES_BY_NAME.contains(&key.as_str())
    };
    let is_turn = keys.len() == 1 && keys.iter().any(|key| key.contains(TURNS));
    is_turn || keys.iter().any(is_one)
}

/// Whether a key that scales or shifts has a value that leaves everything as it is.
fn is_neutral(leaf: &Leaf, at: usize) -> bool {
    // Of these 1 is no neutral value.
    const SHIFTS: [&str; 5] = ["offset", "shift", "flip", "mirror", "invert"];
    let is_shift = |key: &String| SHIFTS.iter().any(|part| key.to_lowercase().contains(part));
    let value = leaf.text.trim().to_lowercase();
    match value.parse::<f64>() {
        Ok(number) => number == 0.0 || number == 1.0 && !leaf.path.iter().skip(at).any(is_shift),
        Err(_) => NEUTRAL.contains(&value.as_str()),
    }
}
