//! Files of instruments, controllers, recorders and spreadsheets, as tables in our form. They are recognised by their content, never by their
//! names.
//!
//! Each form in [`FORMS`] has a module. It makes a `MadeTable` (`made_table.rs`): columns, and rows of typed cells with the line of each row. This becomes a
//! text in our form, and is read as any other. So one reader handles units, beam breaks, scales and errors. A file that holds joint readings and
//! measurements at once (`recording.rs`) is two entries of the plan of files. `marker_words.rs` reports the markers that their distances
//! distinguish.

mod auto_id;
mod axes;
#[cfg(feature = "bags")]
mod bags;
mod bodies;
mod controller_lists;
mod figaroh;
pub(crate) mod headerless;
mod leica;
mod made_table;
mod marker_words;
mod motive;
mod ndi;
mod programs;
mod qualisys;
mod recording;
mod refusal;
mod robodk;
mod spatial_analyzer;
mod two_sets;
mod unsupported_forms;
mod vicon;
mod words;
#[cfg(feature = "workbooks")]
mod workbook;
#[cfg(feature = "workbooks")]
mod workbook_cells;

#[cfg(feature = "workbooks")]
use std::io::Read as _;
use std::path::Path;

use self::made_table::Refusal;
pub(crate) use self::made_table::{CellValue, CoordinateName, MadeTable, TableColumn};
pub(crate) use self::recording::Recording;
use super::ReadOptions;
use crate::table::configurations;
use crate::table::text::LineBlocks;
use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::error::{ErrorKind, Result};
#[cfg(feature = "workbooks")]
use poecal_storage::hashes::HashingReader;
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source;
#[cfg(feature = "workbooks")]
use poecal_storage::source::Input;

/// Title of a file of measurements in messages.
pub(crate) const MEASURED: &str = "a measurement file (CSV)";
/// Title of a workbook, and of a bag.
pub(crate) const WORKBOOK: &str = "a workbook";
pub(crate) const BAG: &str = "a ROS 2 bag";
/// Recordings in which several bodies or markers may be.
pub(crate) const RECORDINGS: [&str; 4] = [motive::FORM.title, qualisys::FORM.title, ndi::FORM.title, vicon::FORM.title];

/// Settings with which files are opened.
#[derive(Clone, Copy)]
pub(crate) struct OpeningContext<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) options: &'a ReadOptions,
}

/// A file that is open.
pub(crate) enum OpenedFile<'p> {
    /// A file in our form.
    Own(Box<LineBlocks<'p>>),
    /// The table of a file in another form.
    Made(Box<MadeTable>),
}

impl<'p> OpenedFile<'p> {
    /// Its blocks.
    pub(crate) fn blocks(self, path: &'p Path, expected: &'p str) -> LineBlocks<'p> {
        match self {
            OpenedFile::Own(blocks) => *blocks,
            OpenedFile::Made(table) => table.blocks(path, expected),
        }
    }
}

/// A form of files.
#[derive(Clone, Copy)]
pub(crate) struct FileForm {
    /// Title of the files of this form, as in "points of SpatialAnalyzer".
    pub(crate) title: &'static str,
    /// Reports whether a text is of this form, by its beginning.
    is_it: fn(&str, &OpeningContext<'_>) -> bool,
    /// The table of a text.
    table: fn(&str, &OpeningContext<'_>) -> std::result::Result<MadeTable, Refusal>,
}

/// All forms of texts; the last one is the fallback.
const FORMS: &[FileForm] = &[
    spatial_analyzer::FORM,
    motive::FORM,
    qualisys::FORM,
    ndi::FORM,
    vicon::FORM,
    controller_lists::FANUC,
    controller_lists::STAUBLI,
    controller_lists::KUKA,
    controller_lists::ECHO,
    leica::FORM,
    programs::FORM,
    robodk::FORM,
    figaroh::FORM,
    auto_id::FORM,
    two_sets::FORM,
    headerless::FORM,
];

/// Forms of joint readings alone.
const LISTS: &[FileForm] = &[
    programs::FORM,
    controller_lists::FANUC,
    controller_lists::STAUBLI,
    controller_lists::KUKA,
    controller_lists::ECHO,
    headerless::FORM,
];

/// Forms among them whose axes have names that a mapping may assign to joints.
const NUMBERED: &[FileForm] =
    &[controller_lists::FANUC, controller_lists::STAUBLI, controller_lists::KUKA, headerless::FORM];

/// Largest number of separators in a line per column of a table: a file that is no table, such as a program, may have more.
const WIDE: usize = 16;

/// Refuses a text with a line of far too many cells, before forms are sought in it.
fn refuse_wide(text: &str, path: &Path) -> Result<()> {
    let most = ResourceLimit::Columns.most_held();
    for (line, number) in text.lines().zip(1..) {
        let count = line.bytes().filter(|it| matches!(it, b',' | b';' | b'\t')).count() + 1;
        if count > WIDE.saturating_mul(most) {
            let message = ResourceLimit::Columns.sentence(&format!("{count} columns"));
            return Err(ErrorKind::Syntax.error(message).at_line(path, number));
        }
    }
    Ok(())
}

impl OpeningContext<'_> {
    /// Columns of the joints in the robot's order: rotary joints in this unit, and slides in metres or millimetres.
    fn joint_columns(&self, angle: &str) -> impl Iterator<Item = TableColumn> {
        let length = if angle == "rad" { "m" } else { "mm" };
        let names = self.robot.joint_reading_names().into_iter().zip(self.slides());
        names.map(move |(name, slides)| TableColumn::from(name).in_unit(if slides { length } else { angle }))
    }

    /// True for each joint reading that is a length.
    fn slides(&self) -> Vec<bool> {
        let names = self.robot.joint_reading_names();
        names.iter().map(|name| self.robot.reading_kind(name) == ReadingKind::Length).collect()
    }

    /// A file that may hold joint readings and measurements, if it is one.
    pub(crate) fn recording(&self, path: &Path) -> Result<Option<Recording>> {
        #[cfg(feature = "bags")]
        if let Some(given) = self.options.bags.iter().find(|it| it.path == path) {
            return bags::read_given(given, self).map(Some);
        }
        #[cfg(feature = "bags")]
        if bags::is_bag(path) {
            return bags::read(path, self).map(Some);
        }
        let _ = path;
        Ok(None)
    }

    /// The blocks of joint readings alone.
    pub(crate) fn joint_blocks<'p>(&self, path: &'p Path, expected: &'p str) -> Result<LineBlocks<'p>> {
        match self.recording(path)? {
            Some(found) => match &found.joints {
                Ok(table) => Ok(table.blocks(path, expected)),
                Err(_) => Err(found.error(path, true)),
            },
            None => self.blocks(path, expected),
        }
    }

    /// The blocks of a file in our form, or of the table that a file in another one makes.
    pub(crate) fn blocks<'p>(&self, path: &'p Path, expected: &'p str) -> Result<LineBlocks<'p>> {
        Ok(self.open_file(path, expected)?.blocks(path, expected))
    }

    /// The file in our form, or the table of one in another form, not yet read.
    pub(crate) fn open_file<'p>(&self, path: &'p Path, expected: &'p str) -> Result<OpenedFile<'p>> {
        if configurations::is_folder(path) {
            return LineBlocks::open_or_join(path, expected).map(|it| OpenedFile::Own(Box::new(it)));
        }
        let (input, head) = source::open_any(path, expected, ResourceLimit::Table)?;
        source::refuse_named(path, expected)?;
        #[cfg(feature = "workbooks")]
        if workbook::is_one(&head) {
            return self.workbook(path, expected, input);
        }
        source::refuse_other_forms(path, expected, &head)?;
        self.of_text(path, LineBlocks::of_input(path, expected, input))
    }

    /// The table of a workbook.
    #[cfg(feature = "workbooks")]
    fn workbook<'p>(&self, path: &'p Path, expected: &'p str, input: Input) -> Result<OpenedFile<'p>> {
        let mut bytes = Vec::new();
        let mut input = HashingReader::new(input);
        let read = input.by_ref().take(ResourceLimit::Workbook.value() + 1).read_to_end(&mut bytes);
        read.map_err(|error| source::unreadable_error(path, &error, expected))?;
        if bytes.len() as u64 > ResourceLimit::Workbook.value() {
            return Err(ErrorKind::File.error(ResourceLimit::Workbook.exceeded_error("a workbook")).in_file(path));
        }
        let made = workbook::table(&bytes, self).map_err(|it| it.error(path))?;
        Ok(OpenedFile::Made(Box::new(made.of_file(WORKBOOK, Some(input.sha256())))))
    }

    /// A text in our form as it is, or the table that it makes.
    pub(crate) fn of_text<'p>(&self, path: &'p Path, mut blocks: LineBlocks<'p>) -> Result<OpenedFile<'p>> {
        blocks.begin()?;
        refuse_wide(blocks.text(), path)?;
        if let Some(message) = unsupported_forms::find_refusal(blocks.text()) {
            return Err(ErrorKind::Measurement.error(message).in_file(path));
        }
        // A mapping that names columns reads tables as they are; if it names no joints, lists of joints are read as without it.
        let forms: &[FileForm] = match self.options.mapping.as_ref().filter(|it| it.names_columns()) {
            None => FORMS,
            Some(map) if map.names_joints() => NUMBERED,
            Some(_) => LISTS,
        };
        let mut forms = forms.iter();
        let Some(form) = forms.find(|form| (form.is_it)(blocks.text(), self)) else {
            return Ok(OpenedFile::Own(Box::new(blocks)));
        };
        let text = blocks.rest()?;
        let mut made = (form.table)(&text, self).map_err(|it| it.error(path))?;
        made.said.splice(0..0, blocks.take_remarks().notes);
        Ok(OpenedFile::Made(Box::new(made.of_file(form.title, blocks.sha256()))))
    }
}
