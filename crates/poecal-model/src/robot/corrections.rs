//! Terms that a calibration fits beside the screws, by words.

use std::str::FromStr;

use super::{CompliantDirections, Sizes, TermGroup};
use poecal_numerics::error::nearest_word;

/// Terms that a calibration fits beside the screws, and their sizes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Corrections {
    /// Terms that predict held-out rows best; none if geometry alone predicts them as well.
    #[default]
    Auto,
    /// The same choice with bearings and links compliant in all directions ([`CompliantDirections::All`]).
    All,
    /// No terms.
    Off,
    /// Groups of these sizes.
    Sizes(Sizes),
}

impl Corrections {
    /// Compliant directions of bearings and links.
    #[must_use]
    pub fn gives(&self) -> CompliantDirections {
        match self {
            Corrections::Auto | Corrections::Off => CompliantDirections::Tilting,
            Corrections::All => CompliantDirections::All,
            Corrections::Sizes(sizes) => sizes.gives(),
        }
    }
}

impl FromStr for Corrections {
    type Err = String;

    /// Parses `auto`, `all`, `off`, or groups with commas between, each with its size behind an equals sign or of the common one.
    fn from_str(words: &str) -> Result<Self, String> {
        match words.trim() {
            "auto" => return Ok(Corrections::Auto),
            "all" => return Ok(Corrections::All),
            "off" => return Ok(Corrections::Off),
            _ => {}
        }
        let mut sizes = Sizes::NONE;
        for word in words.split(',') {
            let (name, size) = match word.split_once('=') {
                Some((name, size)) => (name.trim(), Some(size.trim())),
                None => (word.trim(), None),
            };
            let names = || TermGroup::ALL.into_iter().map(TermGroup::name);
            let Some(group) = TermGroup::ALL.into_iter().find(|group| group.name() == name) else {
                let near = nearest_word(name, names()).map(|near| format!("; did you mean `{near}`?"));
                let known = names().collect::<Vec<_>>().join(", ");
                return Err(format!(
                    "found `{name}`, expected auto, all, off, or some of {known}, each with a size like sag=1e-3{}",
                    near.unwrap_or_default()
                ));
            };
            if sizes[group] != 0.0 {
                return Err(format!("found `{name}` twice, expected each group once"));
            }
            sizes[group] = match size {
                None => Sizes::ALL[group],
                Some(text) => text.parse().ok().filter(|size| (1e-9..=1.0).contains(size)).ok_or_else(|| {
                    format!(
                        "found `{text}` as the size of {name}, expected {} from 1e-9 to 1, like 1e-3",
                        if group.is_of_lengths() { "metres" } else { "radians" }
                    )
                })?,
            };
        }
        Ok(Corrections::Sizes(sizes))
    }
}
