//! The project's own robot model: a TOML file written by hand from a table of screws, or of DH parameters.
//!
//! ```toml
//! poecal_robot = 1            # version of the format
//! name = "planar"
//! length_unit = "mm"          # m, cm, mm or um
//! angle_unit = "deg"          # rad or deg
//! joint = [
//!   { name = "joint1", screw = { v = [0, 0, 0], w = [0, 0, 1] }, limits = [-170, 170] },
//!   { name = "joint2", point = [300, 0, 0], direction = [0, 0, 1] },
//!   { name = "slide", type = "prismatic", direction = [0, 0, -1], limits = [0, 150] },
//! ]
//!
//! [home]                      # the tip in the base at zero joint values
//! position = [500, 0, 100]
//! rpy = [180, 0, 0]           # or quaternion_xyzw, or rotation = [[..], [..], [..]]
//! ```

mod build;
mod context;
mod file;
mod mounts;
mod write;

use std::path::Path;

pub use write::write;

use context::Context;
use poecal_model::robot::Robot;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source_text;

/// Reads a robot from a TOML file.
///
/// # Errors
/// [`ErrorKind::File`] if the file cannot be read, and those of [`parse`].
pub fn read(path: impl AsRef<Path>) -> Result<Robot> {
    let path = path.as_ref();
    parse(&source_text::read(path, "a robot model in TOML")?, path)
}

/// Reads a robot from a TOML text; `path` is for the messages only.
///
/// # Errors
/// [`ErrorKind::Syntax`] if the text is no TOML or has unknown keys, [`ErrorKind::Model`] if the model is invalid.
pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Robot> {
    parse_at(text, path.as_ref())
}

/// Compiled once, and not for each kind of path.
fn parse_at(text: &str, path: &Path) -> Result<Robot> {
    if text.len() as u64 > ResourceLimit::Settings.value() {
        return Err(ErrorKind::File.error(ResourceLimit::Settings.exceeded_error("a model in TOML")).in_file(path));
    }
    let file: file::RobotTomlFile = toml::from_str(text).map_err(|error| syntax_error(&error, text, path))?;
    let context = Context { text, path, length: file.length_unit, angle: file.angle_unit };
    build::robot(&context, &file)
}

/// The parser's message as one sentence with its position.
fn syntax_error(error: &toml::de::Error, text: &str, path: &Path) -> Error {
    let complaint = error.message().trim().replace('\n', ", ");
    let message = match complaint.as_str() {
        "missing field `poecal_robot`" => {
            "found no `poecal_robot`, expected a robot model with poecal_robot = 1, the version of its format"
                .to_owned()
        }
        "missing field `length_unit`" => {
            "found no `length_unit`, expected one of m, cm, mm, um: units are stated, not guessed".to_owned()
        }
        "missing field `angle_unit`" => {
            "found no `angle_unit`, expected one of rad, deg: units are stated, not guessed".to_owned()
        }
        _ => match complaint.strip_prefix("missing field ") {
            Some(field) => format!("found no {field} in this table, expected it to be stated"),
            None => complaint,
        },
    };
    let offset = error.span().map_or(0, |span| span.start);
    ErrorKind::Syntax.error(message).at_offset(path, text, offset)
}
