//! Inputs that are opened once: what was read of one is kept, for each later question about the same path.
//!
//! So a pipe answers like a file, and all answers are of the same bytes while a log grows. Within [`reading`] alone; elsewhere, and for what is
//! [streamed](super::source::open_streamed), nothing is kept.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use poecal_numerics::error::Result;

/// Bytes that are read of an input at a time.
const BLOCK: usize = 1 << 16;

thread_local! {
    /// The inputs of this thread that were opened, within [`reading`].
    static OPEN: RefCell<Option<BTreeMap<PathBuf, Document>>> = const { RefCell::new(None) };
}

/// Does some work in which this thread opens each input once.
pub fn reading<T>(work: impl FnOnce() -> T) -> T {
    if OPEN.with_borrow(Option::is_some) {
        return work();
    }
    let _end = End;
    OPEN.set(Some(BTreeMap::new()));
    work()
}

/// The same with an input of these bytes, which has this name and is on no disk.
pub fn reading_text<T>(name: &Path, text: &str, work: impl FnOnce() -> T) -> T {
    reading(|| {
        let before = keep(name, Some(Document::new(Box::new(Cursor::new(text.as_bytes().to_vec())))));
        let done = work();
        keep(name, before);
        done
    })
}

/// Keeps this as the input of a path, or nothing; gives what was kept.
fn keep(path: &Path, document: Option<Document>) -> Option<Document> {
    OPEN.with_borrow_mut(|all| match document {
        Some(document) => all.as_mut()?.insert(path.to_path_buf(), document),
        None => all.as_mut()?.remove(path),
    })
}

/// Whether a path is that of an input that is kept: no folder.
pub fn is_kept(path: &Path) -> bool {
    OPEN.with_borrow(|all| all.as_ref().is_some_and(|all| all.contains_key(path)))
}

/// Forgets all inputs, also after a panic.
struct End;

impl Drop for End {
    fn drop(&mut self) {
        OPEN.set(None);
    }
}

/// Forgets what was read: for whoever changes files that may be inputs.
pub fn forget() {
    OPEN.with_borrow_mut(|open| open.iter_mut().for_each(BTreeMap::clear));
}

/// A reader of an input from its beginning: of what is kept, and then of what `open` opens.
pub(crate) fn open(path: &Path, open: impl FnOnce() -> Result<Source>) -> Result<Source> {
    let kept = OPEN.with_borrow(|all| all.as_ref().map(|all| all.get(path).cloned()));
    Ok(match kept {
        None => open()?,
        Some(Some(document)) => Box::new(document),
        Some(None) => {
            let document = Document::new(open()?);
            keep(path, Some(document.clone()));
            Box::new(document)
        }
    })
}

/// A reader of an input from its beginning, if it is kept.
pub(crate) fn again(path: &Path) -> Option<Source> {
    OPEN.with_borrow(|all| Some(Box::new(all.as_ref()?.get(path)?.clone()) as Source))
}

/// The same of an input whose bytes are kept no longer: what was read before is read again.
pub(crate) fn stream(path: &Path, open: impl FnOnce() -> Result<Source>) -> Result<Source> {
    match OPEN.with_borrow_mut(|all| all.as_mut()?.remove(path)) {
        None => open(),
        Some(document) => Ok(document.into_stream()),
    }
}

/// Bytes that are still to be read.
pub(crate) type Source = Box<dyn Read + Send>;

/// What was read of an input, and the rest of it.
struct Kept {
    bytes: Vec<u8>,
    rest: Source,
}

/// An input, read from its beginning.
#[derive(Clone)]
struct Document {
    kept: Arc<Mutex<Kept>>,
    at: usize,
}

impl Document {
    fn new(rest: Source) -> Self {
        Document { kept: Arc::new(Mutex::new(Kept { bytes: Vec::new(), rest })), at: 0 }
    }

    fn into_stream(self) -> Source {
        match Arc::try_unwrap(self.kept) {
            Ok(kept) => {
                let Kept { bytes, rest } = kept.into_inner().unwrap_or_else(PoisonError::into_inner);
                Box::new(Cursor::new(bytes).chain(rest))
            }
            // Somebody reads it at the moment.
            Err(kept) => Box::new(Document { kept, at: 0 }),
        }
    }
}

impl Read for Document {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let Kept { bytes, rest } = &mut *kept;
        if self.at == bytes.len() {
            let count = rest.take(BLOCK.max(into.len()) as u64).read_to_end(bytes)?;
            if count == 0 {
                *rest = Box::new(io::empty());
            }
        }
        let count = bytes.get(self.at..).unwrap_or_default().read(into)?;
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A source that tells how often it was opened, and how much was read of it.
    fn text_of(path: &str, opened: &mut usize, text: &'static [u8]) -> String {
        let mut read = String::new();
        let mut source = open(Path::new(path), || {
            *opened += 1;
            Ok(Box::new(text))
        })
        .unwrap();
        source.read_to_string(&mut read).unwrap();
        read
    }

    #[test]
    fn an_input_is_opened_once_and_read_by_all_from_its_beginning() {
        let mut opened = 0;
        reading(|| {
            let mut begun = open(Path::new("a"), || Ok(Box::new(&b"0123456789"[..]))).unwrap();
            let mut head = [0; 3];
            begun.read_exact(&mut head).unwrap();
            assert_eq!(text_of("a", &mut opened, b"another"), "0123456789");
            let mut rest = String::new();
            begun.read_to_string(&mut rest).unwrap();
            assert_eq!((&head, rest.as_str()), (b"012", "3456789"));
            assert_eq!(text_of("b", &mut opened, b"b"), "b");
            // A part of the work is no other work.
            reading(|| assert_eq!(text_of("b", &mut opened, b"c"), "b"));
            assert_eq!(opened, 1);
            forget();
            assert_eq!(text_of("a", &mut opened, b"another"), "another");
        });
        assert_eq!(text_of("a", &mut opened, b"1"), "1");
        assert_eq!(text_of("a", &mut opened, b"2"), "2");
        assert_eq!(opened, 4);
    }

    #[test]
    fn a_stream_has_what_was_read_before_and_is_not_kept() {
        let mut opened = 0;
        reading(|| {
            assert_eq!(text_of("a", &mut opened, b"begun"), "begun");
            let mut read = String::new();
            stream(Path::new("a"), || unreachable!()).unwrap().read_to_string(&mut read).unwrap();
            assert_eq!(read, "begun");
            assert_eq!(text_of("a", &mut opened, b"again"), "again");
        });
    }
}
