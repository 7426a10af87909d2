//! Files that hold joint readings and measurements, each as a table of its own.

use std::path::Path;

use super::maker::{Called, Made};
use crate::table::text::Blocks;
use poecal_numerics::error::{Error, ErrorKind};

/// One of the tables of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnTable {
    pub(crate) made: Made,
    pub(crate) sha256: Option<String>,
    /// What the file is.
    pub(crate) title: &'static str,
}

impl OwnTable {
    /// Its blocks.
    pub(crate) fn blocks<'p>(&self, path: &'p Path, expected: &'p str) -> Blocks<'p> {
        self.clone().into_blocks(path, expected)
    }

    /// The same, once.
    pub(crate) fn into_blocks<'p>(self, path: &'p Path, expected: &'p str) -> Blocks<'p> {
        self.made.blocks(path, expected, self.sha256, self.title)
    }

    /// What the file is.
    pub(crate) fn title(&self) -> &'static str {
        self.title
    }

    /// The frame that the file says its measurements are in.
    pub(crate) fn frame(&self) -> Option<&str> {
        self.made.frame.as_deref()
    }

    /// The same with its frame as that of an instrument of this name.
    pub(crate) fn by_frame(self) -> Self {
        match self.made.frame.clone() {
            Some(frame) => OwnTable { made: self.made.with_column("instrument", &frame), ..self },
            None => self,
        }
    }

    /// The tables of two sets of coordinates, of a file that has them.
    pub(crate) fn sets(&self) -> Option<[OwnTable; 2]> {
        let other = self.made.other.as_deref()?;
        let of = |made: Made| OwnTable { made, ..self.clone() };
        Some([of(self.made.alone()), of(other.clone())])
    }

    /// What its set is called, of a file with two.
    pub(crate) fn called(&self) -> Option<Called> {
        self.made.called
    }

    /// Adds what was understood, a few words.
    pub(crate) fn say(&mut self, words: String) {
        self.made.said.insert(0, words);
    }

    /// What was understood.
    #[cfg(test)]
    pub(crate) fn said(&self) -> String {
        self.made.said.join("; ")
    }

    /// Adds a sentence that should be looked at.
    pub(crate) fn warn(&mut self, sentence: String) {
        self.made.warned.push(sentence);
    }
}

/// Why a file has no table of a kind.
#[derive(Clone, Debug)]
pub(crate) struct Missing {
    pub(crate) why: String,
    /// Whether there is nothing of the kind in it, and not too much.
    pub(crate) is_nothing: bool,
}

/// A file that may hold both.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    pub(crate) joints: Result<OwnTable, Missing>,
    pub(crate) measured: Result<OwnTable, Missing>,
    /// What is in it, in words.
    pub(crate) contents: String,
    /// Of the topics that were asked for those that it has, each with whether it is read.
    pub(crate) has_topic: Vec<Option<bool>>,
    /// Whether it names the bodies that were measured.
    pub(crate) names_bodies: bool,
}

impl Recording {
    /// The error of files that lack joint readings or measurements, of which this is one.
    pub(crate) fn error(&self, path: &Path, lacks_joints: bool) -> Error {
        let (one, other) = (self.joints.as_ref().err(), self.measured.as_ref().err());
        let needed = if lacks_joints { one } else { other };
        let message = match (one, other) {
            (Some(one), Some(other)) if one.is_nothing && other.is_nothing => {
                format!(
                    "found neither joint readings nor measurements, expected both: it has {}",
                    self.contents
                )
            }
            (Some(one), Some(other)) if one.is_nothing == lacks_joints => other.why.clone(),
            _ => needed.map_or_else(|| format!("it has {}", self.contents), |it| it.why.clone()),
        };
        ErrorKind::Measurement.error(message).in_file(path)
    }

    /// Its tables, each with whether it has joint readings; one that is left out is named with the other.
    pub(crate) fn tables(&self) -> Vec<(bool, OwnTable)> {
        let mut found = Vec::new();
        for (is_joints, own, other) in
            [(true, &self.joints, &self.measured), (false, &self.measured, &self.joints)]
        {
            let Ok(table) = own else { continue };
            let mut table = table.clone();
            if let Some(missing) = other.as_ref().err().filter(|it| !it.is_nothing) {
                table.warn(format!("left out what it has beside that: {}", missing.why));
            }
            found.push((is_joints, table));
        }
        found
    }

    /// Whether a topic that was asked for is read, by its place among these; `None` of one that it does not have.
    pub(crate) fn has_topic(&self, at: usize) -> Option<bool> {
        self.has_topic.get(at).copied().flatten()
    }

    /// Whether it names the bodies that were measured.
    pub(crate) fn names_bodies(&self) -> bool {
        self.names_bodies
    }

    /// What is in it, in words.
    pub(crate) fn contents(&self) -> &str {
        &self.contents
    }
}
