//! Robot programs in the languages of their controllers: targets and the motions to them.

pub(crate) mod axes;
mod build;
mod fanuc;
mod flow;
pub(crate) mod forms;
mod given;
mod krl;
mod language;
mod listed;
pub(crate) mod number;
pub(crate) mod parsed;
mod posture;
mod rapid;
pub(crate) mod scan;
mod shape;
pub(crate) mod stated;
mod urscript;

use crate::error::Result;
use axes::Axes;
use parsed::Parsed;

pub use given::Given;
pub use language::Language;
pub use listed::Listed;

/// The targets of a program and its motions.
///
/// # Errors
/// [`ErrorKind::Syntax`](crate::ErrorKind::Syntax) if it is none.
pub(crate) fn parse(language: Language, text: &[u8], given: &Given, axes: &Axes) -> Result<Parsed> {
    match language {
        Language::UrScript => urscript::parse(text, given, axes),
        Language::Krl => krl::parse(text, given, axes),
        Language::Rapid => Ok(rapid::parse(text, given, axes)),
        Language::Fanuc => Ok(fanuc::parse(text, given, axes)),
    }
}
