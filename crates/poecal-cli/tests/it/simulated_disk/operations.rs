//! The operations of a disk in memory.

use std::ffi::OsString;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use poecal_storage::disk::{Disk, DiskObject, Lock, ObjectKind, Output};

use super::disk::{Chance, Content, Node, SimulatedDisk, error, whole_path};

/// A file that is read or written.
struct Handle {
    disk: SimulatedDisk,
    number: usize,
    at: usize,
}

impl Read for Handle {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut state = self.disk.state();
        state.begin()?;
        let bytes = &state.files[self.number].bytes;
        let count = into.len().min(bytes.len() - self.at);
        into[..count].copy_from_slice(&bytes[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

impl Write for Handle {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut state = self.disk.state();
        state.begin()?;
        let mut count = bytes.len();
        if state.faults.short_writes && count > 1 {
            let chance = state.faults.chance.get_or_insert(Chance(1));
            // Not so short that a page would take long.
            count = (1 + chance.draw_below(count)).max(count / 4);
        }
        if let Some(room) = state.faults.room {
            count = count.min(room.saturating_sub(state.written));
            if count == 0 && !bytes.is_empty() {
                state.failures += 1;
                return Err(error(ErrorKind::StorageFull));
            }
        }
        state.written += count;
        state.files[self.number].bytes.extend(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Output for Handle {
    fn sync(&mut self) -> io::Result<()> {
        let mut state = self.disk.state();
        state.begin()?;
        let file = &mut state.files[self.number];
        file.synced = Some(file.bytes.clone());
        Ok(())
    }
}

/// A lock, until it is dropped.
struct Held(SimulatedDisk, PathBuf);

impl Drop for Held {
    fn drop(&mut self) {
        let mut state = self.0.state();
        if !state.stopped {
            state.locks.remove(&self.1);
        }
    }
}

impl Disk for SimulatedDisk {
    fn look(&self, path: &Path) -> io::Result<DiskObject> {
        let mut state = self.state();
        state.begin()?;
        match state.tree.get(&whole_path(path)) {
            Some(Node::Folder) => Ok(DiskObject { kind: ObjectKind::Folder, identity: None, is_mine: true }),
            Some(Node::File(number)) => {
                Ok(DiskObject { kind: ObjectKind::File, identity: Some((1, *number as u64)), is_mine: true })
            }
            None => Err(error(ErrorKind::NotFound)),
        }
    }

    fn follow(&self, path: &Path) -> io::Result<DiskObject> {
        self.look(path)
    }

    fn canonical_path(&self, path: &Path) -> io::Result<PathBuf> {
        self.look(path).map(|_| whole_path(path))
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        let mut state = self.state();
        state.begin()?;
        state.folder(&whole_path(folder))?;
        let children = state.children(&whole_path(folder));
        Ok(children.iter().map(|path| path.file_name().unwrap().to_owned()).collect())
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Read + Send>> {
        let mut state = self.state();
        state.begin()?;
        *state.opened.entry(whole_path(path)).or_default() += 1;
        match state.tree.get(&whole_path(path)) {
            Some(Node::File(number)) => Ok(Box::new(Handle { disk: self.clone(), number: *number, at: 0 })),
            Some(Node::Folder) => Err(error(ErrorKind::IsADirectory)),
            None => Err(error(ErrorKind::NotFound)),
        }
    }

    fn standard_input(&self) -> io::Result<Box<dyn Read + Send>> {
        Ok(Box::new(io::empty()))
    }

    fn create(&self, path: &Path) -> io::Result<Box<dyn Output>> {
        let mut state = self.state();
        state.begin()?;
        let path = whole_path(path);
        state.folder(path.parent().unwrap())?;
        if state.tree.contains_key(&path) {
            return Err(error(ErrorKind::AlreadyExists));
        }
        state.files.push(Content::default());
        let number = state.files.len() - 1;
        state.change(&[&path.clone()], |tree| {
            tree.insert(path, Node::File(number));
        });
        Ok(Box::new(Handle { disk: self.clone(), number, at: 0 }))
    }

    fn append(&self, path: &Path) -> io::Result<Box<dyn Output>> {
        let there = {
            let mut state = self.state();
            state.begin()?;
            state.tree.get(&whole_path(path)).copied()
        };
        match there {
            Some(Node::File(number)) => Ok(Box::new(Handle { disk: self.clone(), number, at: 0 })),
            Some(Node::Folder) => Err(error(ErrorKind::IsADirectory)),
            None => self.create(path),
        }
    }

    fn stream(&self, _: &Path) -> io::Result<Box<dyn Output>> {
        Err(error(ErrorKind::Unsupported))
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        let path = whole_path(path);
        state.folder(path.parent().unwrap())?;
        if state.tree.contains_key(&path) {
            return Err(error(ErrorKind::AlreadyExists));
        }
        state.change(&[&path.clone()], |tree| {
            tree.insert(path, Node::Folder);
        });
        Ok(())
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        let path = whole_path(path);
        match state.tree.get(&path) {
            Some(Node::File(_)) => {
                state.change(&[&path.clone()], |tree| {
                    tree.remove(&path);
                });
                Ok(())
            }
            Some(Node::Folder) => Err(error(ErrorKind::IsADirectory)),
            None => Err(error(ErrorKind::NotFound)),
        }
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        let path = whole_path(path);
        state.folder(&path)?;
        if !state.children(&path).is_empty() {
            return Err(error(ErrorKind::DirectoryNotEmpty));
        }
        state.change(&[&path.clone()], |tree| {
            tree.remove(&path);
        });
        Ok(())
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        let (from, to) = (whole_path(from), whole_path(to));
        state.same_disk(&from, &to)?;
        state.folder(to.parent().unwrap())?;
        match (state.tree.get(&from), state.tree.get(&to)) {
            (None, _) => Err(error(ErrorKind::NotFound)),
            (Some(Node::File(one)), Some(Node::File(other))) if one == other => Ok(()),
            (Some(Node::File(_)), Some(Node::File(_)) | None) => {
                state.move_below(&from, &to);
                Ok(())
            }
            _ => Err(error(ErrorKind::IsADirectory)),
        }
    }

    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        let (from, to) = (whole_path(from), whole_path(to));
        state.same_disk(&from, &to)?;
        state.folder(to.parent().unwrap())?;
        if !state.tree.contains_key(&from) {
            return Err(error(ErrorKind::NotFound));
        }
        if state.tree.contains_key(&to) {
            return Err(error(ErrorKind::AlreadyExists));
        }
        state.move_below(&from, &to);
        Ok(())
    }

    fn exchange(&self, one: &Path, other: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        let (one, other) = (whole_path(one), whole_path(other));
        if state.faults.no_exchange {
            return Err(error(ErrorKind::Unsupported));
        }
        state.same_disk(&one, &other)?;
        state.folder(&one)?;
        state.folder(&other)?;
        let swapped = |path: &PathBuf| {
            if let Ok(rest) = path.strip_prefix(&one) {
                other.join(rest)
            } else if let Ok(rest) = path.strip_prefix(&other) {
                one.join(rest)
            } else {
                path.clone()
            }
        };
        // A path that is joined with nothing keeps a mark at its end.
        let tidy = |path: PathBuf| path.components().collect::<PathBuf>();
        let tree = state.tree.iter().map(|(path, node)| (tidy(swapped(path)), *node)).collect();
        state.change(&[&one, &other], |old| *old = tree);
        Ok(())
    }

    fn link(&self, from: &Path, to: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        if state.faults.no_links {
            return Err(error(ErrorKind::Unsupported));
        }
        let (from, to) = (whole_path(from), whole_path(to));
        state.same_disk(&from, &to)?;
        let Some(&node) = state.tree.get(&from) else { return Err(error(ErrorKind::NotFound)) };
        if state.tree.contains_key(&to) {
            return Err(error(ErrorKind::AlreadyExists));
        }
        state.change(&[&to.clone()], |tree| {
            tree.insert(to, node);
        });
        Ok(())
    }

    fn copy_access(&self, _: &Path, _: &Path) -> io::Result<()> {
        self.state().begin()
    }

    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        let mut state = self.state();
        state.begin()?;
        let path = whole_path(path);
        state.folder(&path)?;
        let last = state.unsynced.iter().rposition(|(_, touched)| touched.contains(&path));
        if let Some(last) = last {
            state.unsynced.drain(..=last);
        }
        Ok(())
    }

    fn lock(&self, path: &Path) -> io::Result<Option<Lock>> {
        if self.look(path).is_err_and(|error| error.kind() == ErrorKind::NotFound) {
            self.create(path)?;
        }
        let path = whole_path(path);
        if !self.state().locks.insert(path.clone()) {
            return Ok(None);
        }
        Ok(Some(Box::new(Held(self.clone(), path))))
    }

    fn lock_folder(&self, _: &Path) -> io::Result<Lock> {
        self.state().begin()?;
        Ok(Box::new(()))
    }
}
