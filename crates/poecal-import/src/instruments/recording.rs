//! Files that hold joint readings and measurements, each as a table of its own.

use std::path::Path;

use super::made_table::MadeTable;
use poecal_numerics::error::{Error, ErrorKind};

/// Reason why a file has no table of a kind.
#[derive(Clone, Debug)]
pub(crate) struct MissingTable {
    pub(crate) why: String,
    /// True if the file has nothing of the kind; false if it has too much.
    pub(crate) is_nothing: bool,
}

/// A file that may hold joint readings and measurements.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    pub(crate) joints: Result<MadeTable, MissingTable>,
    pub(crate) measured: Result<MadeTable, MissingTable>,
    /// Its contents, in words.
    pub(crate) contents: String,
    /// Requested topics that the file has, each with whether it is read.
    pub(crate) has_topic: Vec<Option<bool>>,
    /// True if it names the bodies that were measured.
    pub(crate) names_bodies: bool,
}

impl Recording {
    /// The error of files that lack joint readings or measurements, of which this is one.
    pub(crate) fn error(&self, path: &Path, lacks_joints: bool) -> Error {
        let (one, other) = (self.joints.as_ref().err(), self.measured.as_ref().err());
        let needed = if lacks_joints { one } else { other };
        let message = match (one, other) {
            (Some(one), Some(other)) if one.is_nothing && other.is_nothing => {
                format!("found neither joint readings nor measurements, expected both: it has {}", self.contents)
            }
            (Some(one), Some(other)) if one.is_nothing == lacks_joints => other.why.clone(),
            _ => needed.map_or_else(|| format!("it has {}", self.contents), |it| it.why.clone()),
        };
        ErrorKind::Measurement.error(message).in_file(path)
    }

    /// Its tables, each with whether it has joint readings; a table that is left out is named with the other.
    pub(crate) fn tables(&self) -> Vec<(bool, MadeTable)> {
        let mut found = Vec::new();
        for (is_joints, own, other) in [(true, &self.joints, &self.measured), (false, &self.measured, &self.joints)] {
            let Ok(table) = own else { continue };
            let mut table = table.clone();
            if let Some(missing) = other.as_ref().err().filter(|it| !it.is_nothing) {
                table.warned.push(format!("left out what it has beside that: {}", missing.why));
            }
            found.push((is_joints, table));
        }
        found
    }
}
