//! A disk in memory with chosen failures, which forgets unsynced data at a power failure.
//!
//! Names are kept as a journaling file system keeps them: in the order in which they changed. A folder that is synced has all its changes so far
//! kept, with all that came before them. Of later ones a random number is lost, the last ones first. The bytes of a file that was not synced are
//! anything afterwards: all there, none, some, or zeros.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};

/// The folder that relative paths begin in.
const HERE: &str = "/cell";
/// Error of every operation after the machine has stopped.
const STOPPED: &str = "the machine has stopped";

/// Small pseudorandom numbers (splitmix64).
#[derive(Clone, Debug)]
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn draw_below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % bound.max(1) as u64) as usize
    }

    pub(crate) fn one_in(&mut self, count: usize) -> bool {
        self.draw_below(count) == 0
    }
}

/// Faults of the disk.
#[derive(Clone, Debug, Default)]
pub(crate) struct Faults {
    /// The machine stops before this operation.
    pub(crate) stop_before: Option<usize>,
    /// These operations fail.
    pub(crate) fail: BTreeSet<usize>,
    /// Bytes that can be written in all.
    pub(crate) room: Option<usize>,
    /// No call writes all of its bytes.
    pub(crate) short_writes: bool,
    /// Folders cannot be exchanged.
    pub(crate) no_exchange: bool,
    /// Files have one name only.
    pub(crate) no_links: bool,
    /// The folder `/cell/out` is a disk of its own.
    pub(crate) mounted: bool,
    /// Random numbers for all other choices.
    pub(crate) chance: Option<Chance>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Node {
    Folder,
    File(usize),
}

pub(crate) type Tree = BTreeMap<PathBuf, Node>;

#[derive(Clone, Debug, Default)]
pub(crate) struct Content {
    pub(crate) bytes: Vec<u8>,
    /// Content that is on the disk for certain.
    pub(crate) synced: Option<Vec<u8>>,
}

pub(crate) struct State {
    pub(crate) files: Vec<Content>,
    pub(crate) tree: Tree,
    /// The names as they were before each change since the last that is on the disk for certain, with the folders it touched.
    pub(crate) unsynced: Vec<(Tree, Vec<PathBuf>)>,
    pub(crate) locks: BTreeSet<PathBuf>,
    pub(crate) faults: Faults,
    pub(crate) operations: usize,
    pub(crate) stopped: bool,
    pub(crate) written: usize,
    pub(crate) failures: usize,
    /// Number of times that each file was opened for reading.
    pub(crate) opened: BTreeMap<PathBuf, usize>,
}

/// The disk. Its clones are the same disk.
#[derive(Clone)]
pub(crate) struct SimulatedDisk(Arc<Mutex<State>>);

pub(crate) fn error(kind: ErrorKind) -> io::Error {
    kind.into()
}

pub(crate) fn whole_path(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in Path::new(HERE).join(path).components() {
        match part {
            Component::ParentDir => drop(out.pop()),
            Component::CurDir => {}
            other @ (Component::Prefix(_) | Component::RootDir | Component::Normal(_)) => out.push(other),
        }
    }
    out
}

impl State {
    /// Counts an operation, which may fail.
    pub(crate) fn begin(&mut self) -> io::Result<()> {
        if self.stopped || self.faults.stop_before == Some(self.operations) {
            self.stopped = true;
            return Err(io::Error::other(STOPPED));
        }
        self.operations += 1;
        if self.faults.fail.contains(&(self.operations - 1)) {
            self.failures += 1;
            let kinds = [ErrorKind::Other, ErrorKind::StorageFull, ErrorKind::PermissionDenied];
            let chance = self.faults.chance.get_or_insert(Chance(1));
            return Err(io::Error::new(kinds[chance.draw_below(3)], "a simulated failure"));
        }
        Ok(())
    }

    pub(crate) fn folder(&self, path: &Path) -> io::Result<()> {
        match self.tree.get(path) {
            Some(Node::Folder) => Ok(()),
            Some(_) => Err(error(ErrorKind::NotADirectory)),
            None => Err(error(ErrorKind::NotFound)),
        }
    }

    pub(crate) fn children(&self, path: &Path) -> Vec<PathBuf> {
        self.tree.keys().filter(|other| other.parent() == Some(path)).cloned().collect()
    }

    /// Changes names.
    pub(crate) fn change(&mut self, touched: &[&Path], change: impl FnOnce(&mut Tree)) {
        let parents = touched.iter().filter_map(|path| path.parent()).map(Path::to_owned).collect();
        self.unsynced.push((self.tree.clone(), parents));
        change(&mut self.tree);
    }

    pub(crate) fn same_disk(&self, one: &Path, other: &Path) -> io::Result<()> {
        let inside = |path: &Path| path.starts_with("/cell/out") && path != Path::new("/cell/out");
        if self.faults.mounted && inside(one) != inside(other) {
            return Err(error(ErrorKind::CrossesDevices));
        }
        if self.faults.mounted && [one, other].contains(&Path::new("/cell/out")) {
            return Err(error(ErrorKind::ResourceBusy));
        }
        Ok(())
    }

    pub(crate) fn move_below(&mut self, from: &Path, to: &Path) {
        let under: Vec<PathBuf> = self.tree.keys().filter(|path| path.starts_with(from)).cloned().collect();
        let (from, to) = (from.to_owned(), to.to_owned());
        self.change(&[&from.clone(), &to.clone()], |tree| {
            for path in under {
                let rest = path.strip_prefix(&from).unwrap();
                let new = if rest.as_os_str().is_empty() { to.clone() } else { to.join(rest) };
                let node = tree.remove(&path).unwrap();
                tree.insert(new, node);
            }
        });
    }
}

impl SimulatedDisk {
    pub(crate) fn new() -> Self {
        let tree = [("/", Node::Folder), (HERE, Node::Folder)].map(|(path, node)| (path.into(), node)).into();
        SimulatedDisk(Arc::new(Mutex::new(State {
            files: Vec::new(),
            tree,
            unsynced: Vec::new(),
            locks: BTreeSet::new(),
            faults: Faults::default(),
            operations: 0,
            stopped: false,
            written: 0,
            failures: 0,
            opened: BTreeMap::new(),
        })))
    }

    pub(crate) fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap()
    }

    /// A disk of the same content, all of it synced.
    pub(crate) fn copy(&self) -> Self {
        let disk = SimulatedDisk::new();
        let state = self.state();
        let mut new = disk.state();
        new.tree = state.tree.clone();
        new.files = state.files.clone();
        for file in &mut new.files {
            file.synced = Some(file.bytes.clone());
        }
        drop(new);
        disk
    }

    /// Puts a file there, synced.
    pub(crate) fn put(&self, path: &str, bytes: &[u8]) {
        let mut state = self.state();
        let path = whole_path(Path::new(path));
        for folder in path.ancestors().skip(1) {
            state.tree.entry(folder.to_owned()).or_insert(Node::Folder);
        }
        state.files.push(Content { bytes: bytes.to_vec(), synced: Some(bytes.to_vec()) });
        let node = Node::File(state.files.len() - 1);
        state.tree.insert(path, node);
    }

    /// Sets the faults from now on. Operations are counted from here.
    pub(crate) fn set_faults(&self, faults: Faults) {
        let mut state = self.state();
        state.faults = faults;
        state.operations = 0;
        state.written = 0;
    }

    pub(crate) fn operations(&self) -> usize {
        self.state().operations
    }

    /// Operations that have failed.
    pub(crate) fn failures(&self) -> usize {
        self.state().failures
    }

    pub(crate) fn has_stopped(&self) -> bool {
        self.state().stopped
    }

    /// Starts the machine again: locks are gone, nothing fails, and after a power failure unsynced data are gone.
    pub(crate) fn restart(&self, power_was_lost: bool, chance: &mut Chance) {
        let mut state = self.state();
        state.locks.clear();
        state.stopped = false;
        state.faults = Faults::default();
        if power_was_lost {
            let kept = chance.draw_below(state.unsynced.len() + 1);
            if let Some((tree, _)) = state.unsynced.get(kept) {
                state.tree = tree.clone();
            }
            for file in &mut state.files {
                let now = std::mem::take(&mut file.bytes);
                let synced = file.synced.clone().unwrap_or_default();
                file.bytes = match (file.synced.as_ref() == Some(&now), chance.draw_below(4)) {
                    (true, _) | (_, 0) => now,
                    (_, 1) => synced,
                    (_, 2) => now[..chance.draw_below(now.len() + 1)].to_vec(),
                    _ => vec![0; now.len()],
                };
                file.synced = Some(file.bytes.clone());
            }
        }
        state.unsynced.clear();
    }

    /// Every file below a folder with its bytes, and every folder.
    pub(crate) fn listing(&self, folder: &str) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        let state = self.state();
        let below = state.tree.iter().filter(|(path, _)| path.starts_with(whole_path(Path::new(folder))));
        let content = |node: &Node| match node {
            Node::Folder => None,
            Node::File(number) => Some(state.files[*number].bytes.clone()),
        };
        below.map(|(path, node)| (path.clone(), content(node))).collect()
    }
}
