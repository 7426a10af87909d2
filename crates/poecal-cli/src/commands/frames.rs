//! Common parts of `poecal hand-eye` and `poecal tcp`.

use std::path::{Path, PathBuf};

use poecal_fit::hand_eye::HandEyeLevel;
use poecal_numerics::error::Result;
use poecal_results::model::Model;
use poecal_results::output::{Contents, ExistingFiles, ReservedFolder, write_texts};

use super::models::read_model;
use crate::args::{ChainArgs, FramesOutputArgs};
use crate::console::Console;
use crate::{DONE, WORSE, style};

/// The model of the joint readings, if one is stated.
pub(super) fn model(path: Option<&PathBuf>, chain: &ChainArgs, console: &Console) -> Result<Option<Model>> {
    chain.refuse_without(path.map(PathBuf::as_path))?;
    path.map(|path| read_model(path, &chain.selection(), console)).transpose()
}

/// Name of a row in messages.
pub(super) fn row_name(names: &[String]) -> impl Fn(usize) -> String {
    move |row| names.get(row).cloned().unwrap_or_else(|| format!("row {}", row + 1))
}

/// Output to be printed and written.
pub(super) struct FramesOutput {
    /// Name and text of the result as JSON.
    pub(super) json: (&'static str, String),
    /// The table.
    pub(super) table: String,
    /// The other files.
    pub(super) texts: Vec<(&'static str, String)>,
    pub(super) level: HandEyeLevel,
}

impl FramesOutputArgs {
    /// The folder, if one is stated.
    pub(super) fn reserve(
        &self,
        contents: Contents,
        inputs: &[&Path],
        console: &Console,
    ) -> Result<Option<ReservedFolder>> {
        let existing = ExistingFiles::from_switch(self.force);
        let reserve = |out: &PathBuf| ReservedFolder::reserve(out, contents, existing, inputs, &mut console.warner());
        self.out.as_ref().map(reserve).transpose()
    }

    /// Writes and prints a result.
    pub(super) fn put(&self, place: Option<ReservedFolder>, found: FramesOutput, console: &Console) -> Result<u8> {
        let FramesOutput { json: (name, json), table, texts, level } = found;
        let written = place.map(|place| write_texts(place, (name, json.clone()), texts)).transpose()?;
        let words =
            written.as_ref().map_or_else(String::new, |it| style::describe_written_files(&it.folder, &it.files));
        let text = if self.json { json } else { table + &words };
        let told = match (&written, self.json) {
            (Some(it), true) => console.data_of(&text, &it.folder),
            (Some(it), false) => console.say_of(&text, &it.folder),
            (None, true) => console.data(&text).map(|()| DONE)?,
            (None, false) => console.say(&text).map(|()| DONE)?,
        };
        Ok(if level == HandEyeLevel::DoNotUse { WORSE } else { told })
    }
}
