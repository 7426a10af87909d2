//! Journal of an exchange of files: remaining steps on the disk, so that the next run can complete them.

use std::collections::BTreeSet;
use std::io::{self, Read as _, Write as _};
use std::path::Path;

use super::contents::Contents;
use super::staging::{JOURNAL, JOURNAL_BACK, NEW, OLD, UNFINISHED_JOURNAL, gone};
use crate::io::disk::{Disk, ObjectKind};
use crate::io::named_files;

/// First line, with the version of the format.
const HEAD: &str = "poecal-journal-1";
/// Last line, without which the text is incomplete.
const END: &str = "end";
/// Largest journal, bytes.
const LONGEST: u64 = 1 << 20;

/// One step of an exchange. Steps are idempotent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Moves a file from the new folder to its place, replacing another one.
    Put(String),
    /// Moves a file from the new folder to its place, which is empty.
    Add(String),
    /// Moves a file from the old folder back to its place.
    Back(String),
    /// Removes a file.
    Remove(String),
    /// Removes a file if it was added.
    Take(String),
}

/// The steps of an exchange.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Journal(pub(super) Vec<Step>);

impl Journal {
    fn text(&self) -> String {
        let line = |step: &Step| match step {
            Step::Put(name) => format!("put {name}\n"),
            Step::Add(name) => format!("add {name}\n"),
            Step::Back(name) => format!("back {name}\n"),
            Step::Remove(name) => format!("remove {name}\n"),
            Step::Take(name) => format!("take {name}\n"),
        };
        format!("{HEAD}\n{}{END}\n", self.0.iter().map(line).collect::<String>())
    }

    /// `None` if the text is incomplete, or names a file outside the folder.
    fn parse(text: &str) -> Option<Self> {
        let lines = text.strip_prefix(HEAD)?.strip_prefix('\n')?.strip_suffix('\n')?.strip_suffix(END)?;
        let step = |line: &str| {
            let (word, name) = line.split_once(' ')?;
            // Other names were never to be written.
            let name = Contents::is_of_any(name).then(|| name.to_owned())?;
            match word {
                "put" => Some(Step::Put(name)),
                "add" => Some(Step::Add(name)),
                "back" => Some(Step::Back(name)),
                "remove" => Some(Step::Remove(name)),
                "take" => Some(Step::Take(name)),
                _ => None,
            }
        };
        lines.lines().map(step).collect::<Option<_>>().map(Journal)
    }

    /// Stores the journal in a staging folder, with the one that undoes it.
    pub(super) fn keep(&self, disk: &dyn Disk, staging: &Path, back: &Journal) -> io::Result<()> {
        for (journal, name) in [(back, JOURNAL_BACK), (self, UNFINISHED_JOURNAL)] {
            let mut file = disk.create(&staging.join(name))?;
            file.write_all(journal.text().as_bytes())?;
            file.sync()?;
        }
        disk.rename(&staging.join(UNFINISHED_JOURNAL), &staging.join(JOURNAL))?;
        disk.sync_folder(staging)
    }

    /// Replaces the journal by the one that undoes it.
    pub(super) fn turn_back(disk: &dyn Disk, staging: &Path) -> io::Result<()> {
        disk.rename(&staging.join(JOURNAL_BACK), &staging.join(JOURNAL))?;
        disk.sync_folder(staging)
    }

    /// The journal in a staging folder, if there is one.
    ///
    /// # Errors
    /// Errors of the disk; [`io::ErrorKind::InvalidData`] if it is no journal.
    pub(super) fn kept(disk: &dyn Disk, staging: &Path) -> io::Result<Option<Self>> {
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
    pub(super) fn carry_out(
        &self,
        disk: &dyn Disk,
        staging: &Path,
        folder: &Path,
        again: bool,
    ) -> io::Result<()> {
        for step in &self.0 {
            if let Step::Put(name) | Step::Remove(name) = step
                && is_changed(disk, &staging.join(OLD).join(name), &folder.join(name))?
            {
                let is_done = matches!(step, Step::Put(_)) && !is_file(disk, &staging.join(NEW).join(name))?;
                if !is_done && !again {
                    return Err(io::Error::other(format!("{name} was changed meanwhile")));
                }
                continue;
            }
            match step {
                Step::Remove(name) if is_file(disk, &folder.join(name))? => {
                    disk.remove_file(&folder.join(name))?
                }
                Step::Remove(_) => {}
                Step::Add(name) if again && is_file(disk, &folder.join(name))? => {}
                Step::Take(name) => {
                    if !is_file(disk, &staging.join(NEW).join(name))? && is_file(disk, &folder.join(name))? {
                        disk.remove_file(&folder.join(name))?;
                    }
                }
                Step::Add(name) if is_file(disk, &staging.join(NEW).join(name))? => {
                    disk.rename_new(&staging.join(NEW).join(name), &folder.join(name))?;
                }
                Step::Put(name) if is_file(disk, &staging.join(NEW).join(name))? => {
                    disk.rename(&staging.join(NEW).join(name), &folder.join(name))?;
                }
                Step::Back(name) if is_file(disk, &staging.join(OLD).join(name))? => {
                    disk.rename(&staging.join(OLD).join(name), &folder.join(name))?;
                }
                Step::Put(_) | Step::Add(_) | Step::Back(_) => {}
            }
        }
        Ok(())
    }

    /// The journal that undoes this one, however far it was executed; the earlier files named in `replaced` are kept.
    pub(super) fn back(&self, replaced: &BTreeSet<String>) -> Self {
        let added = self.0.iter().filter_map(|step| match step {
            Step::Add(name) => Some(Step::Take(name.clone())),
            Step::Put(_) | Step::Back(_) | Step::Remove(_) | Step::Take(_) => None,
        });
        Journal(added.chain(replaced.iter().cloned().map(Step::Back)).collect())
    }

    /// Ends an exchange.
    pub(super) fn end(disk: &dyn Disk, staging: &Path) -> io::Result<()> {
        gone(disk.remove_file(&staging.join(JOURNAL)))
    }
}

/// Whether the file is another one than the kept one.
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

/// Whether there is a file.
fn is_file(disk: &dyn Disk, path: &Path) -> io::Result<bool> {
    match disk.look(path) {
        Ok(found) => Ok(found.kind == ObjectKind::File),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_reads_back_and_leads_nowhere_else() {
        let name = |name: &str| name.to_owned();
        let journal = Journal(vec![
            Step::Put(name("calibration.json")),
            Step::Add(name("figure-accuracy.svg")),
            Step::Remove(name("report.html")),
            Step::Back(name("residuals.csv")),
            Step::Take(name("robot.urdf")),
        ]);
        assert_eq!(Journal::parse(&journal.text()), Some(journal.clone()));
        let text = journal.text();
        for cut in 1..text.len() {
            assert_eq!(Journal::parse(&text[..cut]), None, "{cut}");
        }
        for hostile in
            ["../a", "/etc/passwd", "a/b", "..", ".", "", "thesis.tex", ".bashrc", "figure-../../a.svg"]
        {
            assert_eq!(Journal::parse(&format!("{HEAD}\nput {hostile}\n{END}\n")), None, "{hostile}");
        }
    }
}
