//! Journal of an exchange of files: remaining steps on the disk, so that the next run can complete them.

use std::collections::BTreeSet;
use std::io::{self, Read as _, Write as _};
use std::path::Path;

use super::contents::Contents;
use super::staging::{JOURNAL, JOURNAL_BACK, NEW, OLD, UNFINISHED_JOURNAL, find_object, ignore_missing};
use poecal_storage::disk::{Disk, ObjectKind};
use poecal_storage::named_files;

/// First line, with the version of the format.
const HEAD: &str = "poecal-journal-1";
/// Last line, without which the text is incomplete.
const END: &str = "end";
/// Largest journal, bytes.
const LONGEST: u64 = 1 << 20;

/// One step of an exchange. Steps are idempotent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JournalStep {
    /// Moves a file from the new folder to its place, replacing another one.
    Put,
    /// Moves a file from the new folder to its place, which is empty.
    Add,
    /// Moves a file from the old folder back to its place.
    Back,
    /// Removes a file.
    Remove,
    /// Removes a file if it was added.
    Take,
}

impl JournalStep {
    const WORDS: [(&'static str, JournalStep); 5] = [
        ("put", JournalStep::Put),
        ("add", JournalStep::Add),
        ("back", JournalStep::Back),
        ("remove", JournalStep::Remove),
        ("take", JournalStep::Take),
    ];

    fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|&(_, step)| step)
    }

    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, step)| *step == self).map_or("", |&(word, _)| word)
    }
}

/// The steps of an exchange, each with the name of its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Journal(pub(crate) Vec<(JournalStep, String)>);

impl Journal {
    fn text(&self) -> String {
        let line = |(step, name): &(JournalStep, String)| format!("{} {name}\n", step.word());
        format!("{HEAD}\n{}{END}\n", self.0.iter().map(line).collect::<String>())
    }

    /// `None` if the text is incomplete, or names a file outside the folder.
    fn parse(text: &str) -> Option<Self> {
        let lines = text.strip_prefix(HEAD)?.strip_prefix('\n')?.strip_suffix('\n')?.strip_suffix(END)?;
        let step = |line: &str| {
            let (word, name) = line.split_once(' ')?;
            // Other names were never to be written.
            let name = Contents::is_of_any(name).then(|| name.to_owned())?;
            Some((JournalStep::of_word(word)?, name))
        };
        lines.lines().map(step).collect::<Option<_>>().map(Journal)
    }

    /// Stores the journal in a staging folder, with the one that undoes it.
    pub(crate) fn keep(&self, disk: &dyn Disk, staging: &Path, back: &Journal) -> io::Result<()> {
        for (journal, name) in [(back, JOURNAL_BACK), (self, UNFINISHED_JOURNAL)] {
            let mut file = disk.create(&staging.join(name))?;
            file.write_all(journal.text().as_bytes())?;
            file.sync()?;
        }
        disk.rename(&staging.join(UNFINISHED_JOURNAL), &staging.join(JOURNAL))?;
        disk.sync_folder(staging)
    }

    /// Replaces the journal by the one that undoes it.
    pub(crate) fn turn_back(disk: &dyn Disk, staging: &Path) -> io::Result<()> {
        disk.rename(&staging.join(JOURNAL_BACK), &staging.join(JOURNAL))?;
        disk.sync_folder(staging)
    }

    /// The journal in a staging folder, if there is one.
    ///
    /// # Errors
    /// Errors of the disk; [`io::ErrorKind::InvalidData`] if it is no journal.
    pub(crate) fn find_kept(disk: &dyn Disk, staging: &Path) -> io::Result<Option<Self>> {
        let path = staging.join(JOURNAL);
        if !is_file(disk, &path)? {
            return Ok(None);
        }
        let mut text = String::new();
        disk.open(&path)?.take(LONGEST).read_to_string(&mut text)?;
        Journal::parse(&text).ok_or_else(|| io::ErrorKind::InvalidData.into()).map(Some)
    }

    /// Executes the remaining steps in a folder. A place that someone has changed since the journal was written is an error, or, on a
    /// repeated (`again`) execution, left as it is.
    pub(crate) fn carry_out(&self, disk: &dyn Disk, staging: &Path, folder: &Path, again: bool) -> io::Result<()> {
        for (step, name) in &self.0 {
            let (new, old) = (staging.join(NEW).join(name), staging.join(OLD).join(name));
            let place = folder.join(name);
            if matches!(step, JournalStep::Put | JournalStep::Remove) && is_changed(disk, &old, &place)? {
                let is_done = *step == JournalStep::Put && !is_file(disk, &new)?;
                if !is_done && !again {
                    return Err(io::Error::other(format!("{name} was changed meanwhile")));
                }
                continue;
            }
            match step {
                JournalStep::Put if is_file(disk, &new)? => disk.rename(&new, &place)?,
                JournalStep::Add if again && is_file(disk, &place)? => {}
                JournalStep::Add if is_file(disk, &new)? => disk.rename_new(&new, &place)?,
                JournalStep::Back if is_file(disk, &old)? => disk.rename(&old, &place)?,
                JournalStep::Remove if is_file(disk, &place)? => disk.remove_file(&place)?,
                JournalStep::Take if !is_file(disk, &new)? && is_file(disk, &place)? => disk.remove_file(&place)?,
                JournalStep::Put | JournalStep::Add | JournalStep::Back | JournalStep::Remove | JournalStep::Take => {}
            }
        }
        Ok(())
    }

    /// The journal that undoes this one, however far it was executed; the earlier files named in `replaced` are kept.
    pub(crate) fn undo_journal(&self, replaced: &BTreeSet<String>) -> Self {
        let added = self.0.iter().filter(|(step, _)| *step == JournalStep::Add);
        let taken = added.map(|(_, name)| (JournalStep::Take, name.clone()));
        Journal(taken.chain(replaced.iter().map(|name| (JournalStep::Back, name.clone()))).collect())
    }

    /// Ends an exchange.
    pub(crate) fn end(disk: &dyn Disk, staging: &Path) -> io::Result<()> {
        ignore_missing(disk.remove_file(&staging.join(JOURNAL)))
    }
}

/// True if the file differs from the kept one.
fn is_changed(disk: &dyn Disk, kept: &Path, place: &Path) -> io::Result<bool> {
    if !is_file(disk, place)? {
        return Ok(false);
    }
    if !is_file(disk, kept)? {
        return Ok(true);
    }
    if named_files::are_same(disk, kept, place) {
        return Ok(false);
    }
    // Without hard links it is a copy.
    let (mut kept, mut place) = (disk.open(kept)?, disk.open(place)?);
    let (mut one, mut other) = (Vec::new(), Vec::new());
    kept.read_to_end(&mut one)?;
    place.read_to_end(&mut other)?;
    Ok(one != other)
}

/// True if there is a file.
fn is_file(disk: &dyn Disk, path: &Path) -> io::Result<bool> {
    Ok(find_object(disk, path)?.is_some_and(|found| found.kind == ObjectKind::File))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_reads_back_and_leads_nowhere_else() {
        let name = |name: &str| name.to_owned();
        let journal = Journal(vec![
            (JournalStep::Put, name("calibration.json")),
            (JournalStep::Add, name("figure-accuracy.svg")),
            (JournalStep::Remove, name("report.html")),
            (JournalStep::Back, name("residuals.csv")),
            (JournalStep::Take, name("robot.urdf")),
        ]);
        assert_eq!(Journal::parse(&journal.text()), Some(journal.clone()));
        let text = journal.text();
        for cut in 1..text.len() {
            assert_eq!(Journal::parse(&text[..cut]), None, "{cut}");
        }
        for hostile in ["../a", "/etc/passwd", "a/b", "..", ".", "", "thesis.tex", ".bashrc", "figure-../../a.svg"] {
            assert_eq!(Journal::parse(&format!("{HEAD}\nput {hostile}\n{END}\n")), None, "{hostile}");
        }
    }
}
