//! The container of old workbooks (.xls), MS-CFB: streams in chains of sectors.

use super::fields::ByteFields;

/// Beginning of a container.
pub const MAGIC: &[u8] = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1";
/// Names of the stream of a workbook.
const WORKBOOK: [&str; 4] = ["Workbook", "Book", "WORKBOOK", "BOOK"];
/// Smallest number of a sector that is a mark.
const MARKS: u32 = 0xFFFF_FFFA;
/// Size below which a stream is in small sectors, bytes.
const SMALL: u64 = 4096;
const SMALL_SECTOR: usize = 64;
/// Sectors of the table of sectors that the head lists.
const LISTED: usize = 109;
/// Bytes of an entry of the directory.
const ENTRY: usize = 128;

/// A container: its bytes, and for each sector the next one of its chain.
struct Container<'b> {
    bytes: &'b [u8],
    sector: usize,
    next: Vec<u32>,
}

/// The stream of the workbook; `None` if the container is damaged or has none.
pub fn workbook(bytes: &[u8]) -> Option<Vec<u8>> {
    let shift = ByteFields(bytes.get(30..)?).u16()?;
    if !bytes.starts_with(MAGIC) || !matches!(shift, 9 | 12) {
        return None;
    }
    let mut container = Container { bytes, sector: 1 << shift, next: Vec::new() };
    container.next = container.table()?;
    let directory = container.chain(u32_at(bytes, 48)?, u64::MAX)?;
    let entries: Vec<&[u8]> = directory.chunks_exact(ENTRY).collect();
    let entry = WORKBOOK.into_iter().find_map(|name| entries.iter().find(|it| is_named(it, name)))?;
    let (start, size) = (u32_at(entry, 116)?, u64::from(u32_at(entry, 120)?));
    if size >= SMALL {
        return container.chain(start, size);
    }
    let root = entries.first()?;
    let small = container.chain(u32_at(root, 116)?, u64::from(u32_at(root, 120)?))?;
    let table = container.chain(u32_at(bytes, 60)?, u64::MAX)?;
    let next: Vec<u32> = numbers(&table).collect();
    follow_chain(&next, start, size, |sector| {
        let at = usize::try_from(sector).ok()?.checked_mul(SMALL_SECTOR)?;
        small.get(at..at.checked_add(SMALL_SECTOR)?.min(small.len()))
    })
}

fn is_named(entry: &[u8], name: &str) -> bool {
    let mut letters = entry.chunks_exact(2).map_while(|it| ByteFields(it).u16()).take_while(|it| *it != 0);
    name.encode_utf16().all(|it| letters.next() == Some(it)) && letters.next().is_none()
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    ByteFields(bytes.get(at..)?).u32()
}

/// The numbers of sectors in a sequence of bytes.
fn numbers(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.chunks_exact(4).filter_map(|it| ByteFields(it).u32())
}

impl<'b> Container<'b> {
    /// A sector; the last one may be cut off.
    fn sector(&self, number: u32) -> Option<&'b [u8]> {
        // The head occupies one sector.
        let start = usize::try_from(number).ok()?.checked_add(1)?.checked_mul(self.sector)?;
        let end = start.checked_add(self.sector)?.min(self.bytes.len());
        self.bytes.get(start..end).filter(|it| !it.is_empty())
    }

    /// The next sectors of all sectors.
    fn table(&self) -> Option<Vec<u32>> {
        let most = self.bytes.len() / self.sector;
        let head = self.bytes.get(76..).unwrap_or_default();
        let mut listed: Vec<u32> = numbers(head).take(LISTED).collect();
        let mut more = u32_at(self.bytes, 68)?;
        for _ in 0..=most {
            if more >= MARKS {
                break;
            }
            let own: Vec<u32> = numbers(self.sector(more)?).collect();
            let (last, own) = own.split_last()?;
            listed.extend(own);
            more = *last;
        }
        let mut next = Vec::new();
        for number in listed.into_iter().filter(|it| *it < MARKS).take(most) {
            next.extend(numbers(self.sector(number)?));
        }
        Some(next)
    }

    /// The bytes of a chain, at most `size`.
    fn chain(&self, start: u32, size: u64) -> Option<Vec<u8>> {
        follow_chain(&self.next, start, size, |sector| self.sector(sector))
    }
}

/// The bytes of a chain of sectors, up to a size; `None` if a sector is missing, or the chain is longer than the number of sectors.
fn follow_chain<'s>(next: &[u32], start: u32, size: u64, sector: impl Fn(u32) -> Option<&'s [u8]>) -> Option<Vec<u8>> {
    let (mut found, mut at) = (Vec::new(), start);
    for _ in 0..=next.len() {
        if at >= MARKS || found.len() as u64 >= size {
            found.truncate(usize::try_from(size).unwrap_or(usize::MAX));
            return Some(found);
        }
        found.extend_from_slice(sector(at)?);
        at = *next.get(usize::try_from(at).ok()?)?;
    }
    None
}
