//! Open files of a disk in memory.

use std::io::{self, Read, Write};
use std::sync::Arc;

use poecal::io::disk::Output;

use crate::disk::MemoryDisk;

/// A file that is read: its bytes when it was opened.
pub(crate) struct Reader {
    pub(crate) bytes: Arc<Vec<u8>>,
    pub(crate) at: usize,
}

impl Read for Reader {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let count = into.len().min(rest.len());
        into[..count].copy_from_slice(&rest[..count]);
        self.at += count;
        Ok(count)
    }
}

/// A file that is written.
pub(crate) struct Writer {
    pub(crate) disk: MemoryDisk,
    pub(crate) number: usize,
}

impl Write for Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.disk.append(self.number, bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Output for Writer {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}
