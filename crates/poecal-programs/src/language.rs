//! The languages of robot programs.

use std::path::Path;

use serde::Serialize;

use poecal_numerics::error::{ErrorKind, Result};

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

/// Endings of the names of other languages' programs, and their makers.
const OTHERS: [(&[&str], &str); 7] = [
    (&["jbi"], "Yaskawa (JBI)"),
    (&["as", "pg"], "Kawasaki (AS)"),
    (&["urp"], "Universal Robots' pendant (.urp: save it as .script there)"),
    (&["tp"], "FANUC in binary form (.tp: print it as .ls there)"),
    (&["v3", "pgx", "pjx"], "Stäubli (VAL3)"),
    (&["pac", "pcs"], "Denso (PAC)"),
    (&["mb4", "mb5", "mb6"], "Mitsubishi (MELFA)"),
];

impl Language {
    /// The language of a file by the ending of its name; case does not matter.
    #[must_use]
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        let end = path.as_ref().extension()?.to_str()?.to_ascii_lowercase();
        match end.as_str() {
            "script" => Some(Language::UrScript),
            "mod" | "prg" | "sys" => Some(Language::Rapid),
            "src" | "dat" => Some(Language::Krl),
            "ls" => Some(Language::Fanuc),
            _ => None,
        }
    }

    /// The language of a file; `None` for a table.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] for the ending of a language that is not read.
    pub fn of_name(path: impl AsRef<Path>) -> Result<Option<Self>> {
        let path = path.as_ref();
        let end = path.extension().and_then(|it| it.to_str()).unwrap_or_default().to_ascii_lowercase();
        match OTHERS.iter().find(|(ends, _)| ends.contains(&end.as_str())) {
            Some((_, maker)) => {
                Err(ErrorKind::Option.error(format!(
                    "found a program of {maker} by the end of its name, expected joint readings (CSV), or a program in URScript (.script), RAPID \
                     (.mod, .prg, .sys), KRL (.src, .dat) or of FANUC as text (.ls)"
                )).in_file(path))
            }
            None => Ok(Self::from_path(path)),
        }
    }

    /// The name of the language for people.
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
        assert_eq!(Language::from_path("cell/weld.SRC"), Some(Language::Krl));
        assert_eq!(Language::from_path("rows.csv"), None);
        assert_eq!(Language::of_name("rows.csv").unwrap(), None);
        assert!(Language::of_name("cell/WELD.JBI").unwrap_err().to_string().contains("a program of Yaskawa (JBI)"));
    }
}
