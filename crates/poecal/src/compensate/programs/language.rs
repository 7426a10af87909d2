//! The languages of robot programs.

use std::path::Path;

use serde::Serialize;

/// A language of robot programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Language {
    /// URScript of Universal Robots (`.script`).
    UrScript,
    /// RAPID of ABB (`.mod`, `.prg`, `.sys`).
    Rapid,
    /// KRL of KUKA (`.src`, `.dat`).
    Krl,
    /// Programs of FANUC as text (`.ls`).
    Fanuc,
}

impl Language {
    /// The language of a file by the end of its name, in letters of either case.
    #[must_use]
    pub fn of(path: impl AsRef<Path>) -> Option<Self> {
        let end = path.as_ref().extension()?.to_str()?.to_ascii_lowercase();
        match end.as_str() {
            "script" => Some(Language::UrScript),
            "mod" | "prg" | "sys" => Some(Language::Rapid),
            "src" | "dat" => Some(Language::Krl),
            "ls" => Some(Language::Fanuc),
            _ => None,
        }
    }

    /// The name as people write it.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Language::UrScript => "URScript",
            Language::Rapid => "RAPID",
            Language::Krl => "KRL",
            Language::Fanuc => "FANUC",
        }
    }

    /// The units of its poses.
    #[must_use]
    pub fn units(self) -> &'static str {
        match self {
            Language::UrScript => "metres, and a rotation vector in radians",
            Language::Rapid => "millimetres, and a quaternion with its real part first",
            Language::Krl | Language::Fanuc => "millimetres and degrees",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Language;

    #[test]
    fn the_end_of_a_name_tells_the_language() {
        assert_eq!(Language::of("cell/weld.SRC"), Some(Language::Krl));
        assert_eq!(Language::of("rows.csv"), None);
    }
}
