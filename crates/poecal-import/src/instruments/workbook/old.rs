//! Old workbooks (.xls): the numbers and texts of their sheets, MS-XLS (BIFF8). Formulas are the results that were saved with the workbook.

use calamine::Data;

use super::cells::{ReadSheet, RemainingAllowance, SheetCells};
use super::numbers::{WorkbookContext, read_long, read_short, read_wide};
use poecal_storage::containers::fields::ByteFields;
use poecal_storage::containers::office::workbook;

/// Kinds of records.
mod kind {
    pub(super) const FORMULA: u16 = 0x0006;
    pub(super) const END: u16 = 0x000A;
    pub(super) const DATES: u16 = 0x0022;
    pub(super) const LOCKED: u16 = 0x002F;
    pub(super) const MORE: u16 = 0x003C;
    pub(super) const SHEET: u16 = 0x0085;
    pub(super) const SEVERAL: u16 = 0x00BD;
    pub(super) const RICH: u16 = 0x00D6;
    pub(super) const STYLE: u16 = 0x00E0;
    pub(super) const TEXTS: u16 = 0x00FC;
    pub(super) const OF_TEXTS: u16 = 0x00FD;
    pub(super) const NUMBER: u16 = 0x0203;
    pub(super) const LABEL: u16 = 0x0204;
    pub(super) const FLAG: u16 = 0x0205;
    pub(super) const OF_FORMULA: u16 = 0x0207;
    pub(super) const SHORT: u16 = 0x027E;
    pub(super) const FORMAT: u16 = 0x041E;
    pub(super) const BEGIN: u16 = 0x0809;
}

/// The version of the form that is read.
const VERSION: u16 = 0x0600;

/// A record: its kind, and its bytes with those of the records that continue it.
struct Record<'b> {
    kind: u16,
    parts: Vec<&'b [u8]>,
}

/// The records of a stream, up to the end of a part of it.
struct StreamRecords<'b>(ByteFields<'b>);

impl<'b> StreamRecords<'b> {
    fn next_record(&mut self) -> Option<(u16, &'b [u8])> {
        let (kind, size) = (self.0.u16()?, self.0.u16()?);
        Some((kind, self.0.bytes(usize::from(size))?))
    }
}

impl<'b> Iterator for StreamRecords<'b> {
    type Item = Record<'b>;

    fn next(&mut self) -> Option<Record<'b>> {
        let (kind, own) = self.next_record().filter(|it| it.0 != kind::END)?;
        let mut parts = vec![own];
        while ByteFields(self.0.0).u16() == Some(kind::MORE) {
            parts.push(self.next_record()?.1);
        }
        Some(Record { kind, parts })
    }
}

/// The sheets of a workbook.
///
/// # Errors
/// The defect, in a sentence.
pub(crate) fn sheets(bytes: &[u8]) -> Result<Vec<ReadSheet>, String> {
    let stream = workbook(bytes).ok_or(
        "found a container of an old office program without a workbook, or a workbook that is damaged, expected a measurement file (CSV), or a workbook: \
         save the table as `CSV UTF-8`",
    )?;
    let (shared, named) = read_shared(&stream)?;
    let mut left = RemainingAllowance::new();
    let mut found = Vec::new();
    for (start, name) in named {
        let mut cells = SheetCells::default();
        shared.read(stream.get(start..).unwrap_or_default(), &mut cells, &mut left)?;
        found.push((name, cells.range(&mut left)));
    }
    Ok(found)
}

/// The data that the sheets share, and the beginning and the name of each sheet.
fn read_shared(stream: &[u8]) -> Result<(WorkbookContext, Vec<(usize, String)>), String> {
    let (mut shared, mut named, mut styles) = (WorkbookContext::default(), Vec::new(), Vec::new());
    for Record { kind, parts } in StreamRecords(ByteFields(stream)) {
        let mut data = ByteFields(parts.first().copied().unwrap_or_default());
        match kind {
            kind::BEGIN if data.u16() != Some(VERSION) => {
                return Err(
                    "found a workbook of Excel 95 or earlier, expected one of Excel 97 or later: save it as .xlsx"
                        .to_owned(),
                );
            }
            kind::LOCKED => {
                return Err(
                    "found a workbook with a password, expected one without: save its table as `CSV UTF-8`".to_owned()
                );
            }
            kind::DATES => shared.is_1904 = data.u16() == Some(1),
            kind::FORMAT => shared.formats.extend(data.u16().zip(text(&mut data))),
            kind::STYLE => styles.push(data.u16().and_then(|_| data.u16()).unwrap_or_default()),
            kind::SHEET => named.extend(sheet(data)),
            kind::TEXTS => shared.texts = texts(&parts),
            _ => {}
        }
    }
    shared.take_styles(&styles);
    Ok((shared, named))
}

impl WorkbookContext {
    /// Reads the cells of a sheet.
    fn read(&self, stream: &[u8], cells: &mut SheetCells, left: &mut RemainingAllowance) -> Result<(), String> {
        // The cell of a formula whose text follows in a record of its own.
        let mut waiting = None;
        for Record { kind, parts } in StreamRecords(ByteFields(stream)) {
            let mut data = ByteFields(parts.first().copied().unwrap_or_default());
            if kind == kind::OF_FORMULA {
                if let Some((place, value)) = waiting.take().zip(text(&mut data)) {
                    cells.add(place, Data::String(value), left)?;
                }
                continue;
            }
            let Some((row, column)) = data.u16().zip(data.u16()) else { continue };
            let place = (u32::from(row), u32::from(column));
            let several = data.0.chunks_exact(6);
            let style = data.u16().unwrap_or_default();
            let value = match (kind, data.0) {
                (kind::FORMULA, [first, _, _, _, _, _, 0xFF, 0xFF, ..]) => {
                    waiting = (*first == 0).then_some(place);
                    None
                }
                (kind::NUMBER | kind::FORMULA, _) => read_long(&mut data).and_then(|it| self.number(it, style)),
                (kind::SHORT, _) => read_short(&mut data).and_then(|it| self.number(it, style)),
                (kind::LABEL | kind::RICH, _) => text(&mut data).map(Data::String),
                (kind::OF_TEXTS, _) => self.text(&mut data),
                (kind::FLAG, [flag, 0, ..]) => Some(Data::Bool(*flag != 0)),
                (kind::SEVERAL, _) => {
                    for (next, own) in (0_u32..).zip(several) {
                        let mut own = ByteFields(own);
                        let value = own.u16().zip(read_short(&mut own));
                        let value = value.and_then(|(style, it)| self.number(it, style));
                        value.map_or(Ok(()), |it| cells.add((place.0, place.1 + next), it, left))?;
                    }
                    None
                }
                _ => None,
            };
            value.map_or(Ok(()), |value| cells.add(place, value, left))?;
        }
        Ok(())
    }
}

/// A sheet of numbers: its beginning and its name.
fn sheet(mut data: ByteFields<'_>) -> Option<(usize, String)> {
    let (start, _, kind) = (data.index()?, data.u8()?, data.u8()?);
    let (count, is_wide) = (data.u8()?, data.u8()? & 1 != 0);
    let name = letters(&mut data, usize::from(count), is_wide)?;
    (kind == 0).then_some((start, name.replace('\0', "")))
}

/// A text that states its number of letters and whether they have two bytes.
fn text(data: &mut ByteFields<'_>) -> Option<String> {
    let (count, is_wide) = (data.u16()?, data.u8()? & 1 != 0);
    letters(data, usize::from(count), is_wide)
}

/// A text of `count` letters of one or two bytes.
fn letters(data: &mut ByteFields<'_>, count: usize, is_wide: bool) -> Option<String> {
    if is_wide {
        return read_wide(data, count);
    }
    Some(data.bytes(count)?.iter().map(|it| char::from(*it)).collect())
}

/// The texts that cells share: a list over several records. A text may be cut, and its width is stated again behind the cut.
fn texts(parts: &[&[u8]]) -> Vec<String> {
    let Some((first, others)) = parts.split_first() else { return Vec::new() };
    let mut parts = RecordBytes { rest: ByteFields(first), others };
    match parts.current_fields().and_then(|it| it.bytes(8)) {
        Some(_) => std::iter::from_fn(|| parts.text()).collect(),
        None => Vec::new(),
    }
}

/// The bytes of a record and of those that continue it.
struct RecordBytes<'p> {
    rest: ByteFields<'p>,
    others: &'p [&'p [u8]],
}

impl<'p> RecordBytes<'p> {
    /// The rest of the record, or of the next one at its end.
    fn current_fields(&mut self) -> Option<&mut ByteFields<'p>> {
        while self.rest.0.is_empty() {
            let (first, others) = self.others.split_first()?;
            (self.rest, self.others) = (ByteFields(first), others);
        }
        Some(&mut self.rest)
    }

    fn skip(&mut self, mut count: usize) -> Option<()> {
        while count > 0 {
            let here = self.current_fields()?;
            let own = count.min(here.0.len());
            here.bytes(own)?;
            count -= own;
        }
        Some(())
    }

    fn text(&mut self) -> Option<String> {
        let mut head = ByteFields(self.current_fields()?.bytes(3)?);
        let (mut left, flags) = (usize::from(head.u16()?), head.u8()?);
        let mut is_wide = flags & 1 != 0;
        let runs = if flags & 8 != 0 { self.current_fields()?.u16()? } else { 0 };
        let beside = if flags & 4 != 0 { self.current_fields()?.index()? } else { 0 };
        let mut found = String::new();
        while left > 0 {
            if self.rest.0.is_empty() {
                is_wide = self.current_fields()?.u8()? & 1 != 0;
            }
            let here = left.min(self.rest.0.len() / if is_wide { 2 } else { 1 });
            if here == 0 {
                return None;
            }
            found.push_str(&letters(&mut self.rest, here, is_wide)?);
            left -= here;
        }
        self.skip(usize::from(runs) * 4)?;
        self.skip(beside)?;
        Some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_storage::limits::{self, ResourceLimit};
    use poecal_testing::damage::read_damaged;
    use poecal_testing::old_workbook::container;

    fn record(kind: u16, data: &[u8]) -> Vec<u8> {
        [&kind.to_le_bytes(), &u16::try_from(data.len()).unwrap().to_le_bytes(), data].concat()
    }

    /// A cell: row, column, style, and content.
    fn cell(kind: u16, [row, column, style]: [u16; 3], data: &[u8]) -> Vec<u8> {
        record(kind, &[&row.to_le_bytes()[..], &column.to_le_bytes(), &style.to_le_bytes(), data].concat())
    }

    fn counted_text(text: &str) -> Vec<u8> {
        [&u16::try_from(text.len()).unwrap().to_le_bytes()[..], &[0], text.as_bytes()].concat()
    }

    /// A workbook of one sheet: its texts in two records, the second of which begins within the text `second`.
    fn stream(cells: &[Vec<u8>]) -> Vec<u8> {
        let begin = record(kind::BEGIN, &[0, 6, 5, 0]);
        let shared = [&[2, 0, 0, 0, 2, 0, 0, 0][..], &counted_text("first"), &[6, 0, 0], b"sec"].concat();
        let more = [&[1][..], &"ond".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()].concat();
        let globals = |start: u32| {
            let name = [&start.to_le_bytes()[..], &[0, 0, 5, 0], b"Rows1"].concat();
            [
                begin.clone(),
                record(kind::FORMAT, &[&[164, 0][..], &counted_text("yyyy\\-mm \"d\"")].concat()),
                record(kind::STYLE, &[0, 0, 0, 0]),
                record(kind::STYLE, &[0, 0, 164, 0]),
                record(kind::SHEET, &name),
                record(kind::TEXTS, &shared),
                record(kind::MORE, &more),
                record(kind::END, &[]),
            ]
            .concat()
        };
        let start = u32::try_from(globals(0).len()).unwrap();
        [globals(start), begin, cells.concat(), record(kind::END, &[])].concat()
    }

    fn example() -> Vec<Vec<u8>> {
        let number = |value: f64| value.to_le_bytes();
        vec![
            cell(kind::OF_TEXTS, [0, 0, 0], &[0, 0, 0, 0]),
            cell(kind::OF_TEXTS, [0, 1, 0], &[1, 0, 0, 0]),
            cell(kind::LABEL, [0, 2, 0], &counted_text("third")),
            cell(kind::NUMBER, [1, 0, 0], &number(1.5)),
            // 250 hundredths, and the upper half of 0.25.
            cell(kind::SHORT, [1, 1, 0], &(250_u32 << 2 | 3).to_le_bytes()),
            cell(kind::SEVERAL, [1, 2, 0], &[&(0.25_f64.to_bits() >> 32).to_le_bytes()[..4], &[2, 0]].concat()),
            cell(kind::NUMBER, [2, 0, 1], &number(2.0)),
            cell(kind::FORMULA, [2, 1, 0], &[&number(7.0)[..], &[0; 8]].concat()),
            cell(kind::FORMULA, [2, 2, 0], &[0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0, 0]),
            record(kind::OF_FORMULA, &counted_text("made")),
            cell(kind::FLAG, [3, 0, 0], &[1, 0]),
        ]
    }

    #[test]
    fn cells_of_every_kind_are_read() {
        let found = sheets(&container(&stream(&example()))).unwrap();
        let [(name, range)] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((name.as_str(), range.get_size()), ("Rows1", (4, 3)));
        let text = |at| range.get_value(at).map(ToString::to_string);
        for (at, expected) in [
            ((0, 0), "first"),
            ((0, 1), "second"),
            ((0, 2), "third"),
            ((1, 0), "1.5"),
            ((1, 1), "2.5"),
            ((1, 2), "0.25"),
            ((2, 1), "7"),
            ((2, 2), "made"),
            ((3, 0), "true"),
        ] {
            assert_eq!(text(at).as_deref(), Some(expected), "{at:?}");
        }
        assert!(matches!(range.get_value((2, 0)), Some(Data::DateTime(time)) if time.as_f64() == 2.0));
    }

    #[test]
    fn a_cell_far_off_is_refused_before_its_range_is_held() {
        let mut cells = example();
        cells.push(cell(kind::NUMBER, [65_535, 16_000, 0], &1.0_f64.to_le_bytes()));
        let error = sheets(&container(&stream(&cells))).unwrap_err();
        assert!(error.starts_with("found a sheet of 65536 rows and 16001 columns, expected at most"), "{error}");
        let few = limits::current_limits().with_limit(ResourceLimit::Cells, 11);
        assert!(limits::run_with_limits(few, || sheets(&container(&stream(&example())))).is_err());
    }

    #[test]
    fn no_bytes_end_in_a_panic() {
        read_damaged(&container(&stream(&example())), |bytes| drop(sheets(bytes)));
    }
}
