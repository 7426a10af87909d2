//! Containers of old workbooks (.xls), MS-CFB.

/// A container of sectors of 512 bytes: the table of sectors, the directory, and the stream of the workbook, of at most 60,000 bytes.
#[must_use]
pub fn container(stream: &[u8]) -> Vec<u8> {
    const END: u32 = u32::MAX - 1;
    let size = u32::try_from(stream.len().max(4096)).unwrap();
    let count = size.div_ceil(512);
    let mut head = vec![0; 512];
    head[..8].copy_from_slice(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1");
    head[30] = 9;
    for (at, value) in [(48, 1), (60, END), (68, END), (76, 0)] {
        head[at..at + 4].copy_from_slice(&u32::to_le_bytes(value));
    }
    head[80..].fill(0xFF);
    // Entries of the table itself, of the directory, and of the stream.
    let mut table: Vec<u32> = vec![u32::MAX - 2, END];
    table.extend((1..count).map(|at| at + 2).chain([END]));
    assert!(table.len() <= 128);
    table.resize(128, u32::MAX);
    let entry = |name: &str, start: u32, size: u32| {
        let mut entry: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
        entry.resize(128, 0);
        entry[116..120].copy_from_slice(&start.to_le_bytes());
        entry[120..124].copy_from_slice(&size.to_le_bytes());
        entry
    };
    let mut directory = [entry("Root Entry", END, 0), entry("Workbook", 2, size)].concat();
    directory.resize(512, 0);
    let mut whole = [head, table.into_iter().flat_map(u32::to_le_bytes).collect(), directory].concat();
    whole.extend(stream);
    whole.resize(512 * (3 + count as usize), 0);
    whole
}
