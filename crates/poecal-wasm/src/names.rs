//! Names on a disk in memory: a tree of folders and files.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::ops::Bound;
use std::path::{Component, Path, PathBuf};

/// Item of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PathEntry {
    Folder,
    /// The file of this number.
    File(usize),
}

/// All names, by their paths from the root.
#[derive(Debug)]
pub(crate) struct PathNames(BTreeMap<PathBuf, PathEntry>);

/// A path from the root, without `.` and `..`; the current folder is the root.
pub(crate) fn whole_path(path: &Path) -> PathBuf {
    let mut out = PathBuf::from("/");
    for part in path.components() {
        match part {
            Component::ParentDir => drop(out.pop()),
            Component::Normal(name) => out.push(name),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    out
}

impl PathNames {
    /// The root alone.
    pub(crate) fn new() -> Self {
        PathNames(BTreeMap::from([(PathBuf::from("/"), PathEntry::Folder)]))
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = (&Path, PathEntry)> {
        self.0.iter().map(|(path, node)| (path.as_path(), *node))
    }

    /// The item at a whole path.
    pub(crate) fn entry_at(&self, path: &Path) -> io::Result<PathEntry> {
        if let Some(node) = self.0.get(path) {
            return Ok(*node);
        }
        // A file within the path is another mistake than a missing name.
        let is_through_file =
            path.ancestors().skip(1).any(|above| matches!(self.0.get(above), Some(PathEntry::File(_))));
        Err(if is_through_file { ErrorKind::NotADirectory } else { ErrorKind::NotFound }.into())
    }

    pub(crate) fn folder(&self, path: &Path) -> io::Result<()> {
        match self.entry_at(path)? {
            PathEntry::Folder => Ok(()),
            PathEntry::File(_) => Err(ErrorKind::NotADirectory.into()),
        }
    }

    pub(crate) fn file(&self, path: &Path) -> io::Result<usize> {
        match self.entry_at(path)? {
            PathEntry::File(number) => Ok(number),
            PathEntry::Folder => Err(ErrorKind::IsADirectory.into()),
        }
    }

    /// Everything below a folder.
    fn entries_below(&self, folder: &Path) -> impl Iterator<Item = (&PathBuf, &PathEntry)> {
        let all = self.0.range::<Path, _>((Bound::Excluded(folder), Bound::Unbounded));
        all.take_while(move |(path, _)| path.starts_with(folder))
    }

    /// Names in a folder, sorted.
    pub(crate) fn children(&self, folder: &Path) -> Vec<&Path> {
        self.entries_below(folder)
            .filter(|(path, _)| path.parent() == Some(folder))
            .map(|(path, _)| path.as_path())
            .collect()
    }

    /// Adds a new name, if it is free and its folder exists.
    pub(crate) fn add(&mut self, path: PathBuf, node: PathEntry) -> io::Result<()> {
        if self.0.contains_key(&path) {
            return Err(ErrorKind::AlreadyExists.into());
        }
        self.folder(path.parent().unwrap_or(Path::new("/")))?;
        self.0.insert(path, node);
        Ok(())
    }

    pub(crate) fn remove(&mut self, path: &Path) {
        self.0.remove(path);
    }

    /// Moves a file, or a folder with its content, to a free name, or a file onto a file.
    pub(crate) fn rename(&mut self, from: &Path, to: &Path, replaces: bool) -> io::Result<()> {
        let node = self.entry_at(from)?;
        self.folder(to.parent().unwrap_or(Path::new("/")))?;
        match (node, self.0.get(to)) {
            (_, Some(_)) if !replaces => return Err(ErrorKind::AlreadyExists.into()),
            (PathEntry::File(_), Some(PathEntry::Folder)) => return Err(ErrorKind::IsADirectory.into()),
            (PathEntry::Folder, Some(PathEntry::File(_))) => return Err(ErrorKind::NotADirectory.into()),
            (PathEntry::Folder, Some(PathEntry::Folder)) if from != to && self.entries_below(to).next().is_some() => {
                return Err(ErrorKind::DirectoryNotEmpty.into());
            }
            _ => {}
        }
        if to != from && to.starts_with(from) {
            return Err(ErrorKind::InvalidInput.into());
        }
        for (path, node) in self.take_below(from) {
            self.0.insert(move_path(&path, from, to), node);
        }
        Ok(())
    }

    /// Exchanges two folders that are not within each other.
    pub(crate) fn exchange(&mut self, one: &Path, other: &Path) -> io::Result<()> {
        self.folder(one)?;
        self.folder(other)?;
        if one != other && (one.starts_with(other) || other.starts_with(one)) {
            return Err(ErrorKind::InvalidInput.into());
        }
        let (first, second) = (self.take_below(one), self.take_below(other));
        for (path, node) in first {
            self.0.insert(move_path(&path, one, other), node);
        }
        for (path, node) in second {
            self.0.insert(move_path(&path, other, one), node);
        }
        Ok(())
    }

    /// Removes a name, and all below it, from the tree.
    fn take_below(&mut self, path: &Path) -> Vec<(PathBuf, PathEntry)> {
        let mut paths: Vec<PathBuf> = self.entries_below(path).map(|(path, _)| path.clone()).collect();
        paths.push(path.to_owned());
        paths.into_iter().filter_map(|path| self.0.remove_entry(&path)).collect()
    }
}

/// A path below `from` moved below `to`.
fn move_path(path: &Path, from: &Path, to: &Path) -> PathBuf {
    match path.strip_prefix(from) {
        // Joined with an empty path, a path would end in a separator.
        Ok(rest) if rest.as_os_str().is_empty() => to.to_owned(),
        Ok(rest) => to.join(rest),
        Err(_) => path.to_owned(),
    }
}
