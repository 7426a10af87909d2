//! Old workbooks (.xls): the numbers and texts of their sheets, MS-XLS (BIFF8). Formulas are what they gave when the workbook was saved.

use calamine::Data;

use super::cells::{Found, Left, ReadSheet};
use super::container::{u16_at, u32_at, workbook};
use super::numbers::{Styles, f64_at, short};

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
struct Records<'b>(&'b [u8]);

impl<'b> Records<'b> {
    fn one(&mut self) -> Option<(u16, &'b [u8])> {
        let (kind, size) = (u16_at(self.0, 0)?, usize::from(u16_at(self.0, 2)?));
        let own = self.0.get(4..4 + size)?;
        self.0 = self.0.get(4 + size..)?;
        Some((kind, own))
    }
}

impl<'b> Iterator for Records<'b> {
    type Item = Record<'b>;

    fn next(&mut self) -> Option<Record<'b>> {
        let (kind, own) = self.one().filter(|it| it.0 != kind::END)?;
        let mut parts = vec![own];
        while u16_at(self.0, 0) == Some(kind::MORE) {
            parts.push(self.one()?.1);
        }
        Some(Record { kind, parts })
    }
}

/// What the sheets of a workbook share.
#[derive(Default)]
struct Shared {
    sheets: Vec<(usize, String)>,
    texts: Vec<String>,
    styles: Styles,
}

/// The sheets of a workbook.
///
/// # Errors
/// What is wrong with it, in a sentence.
pub(crate) fn sheets(bytes: &[u8]) -> Result<Vec<ReadSheet>, String> {
    let stream = workbook(bytes).ok_or(
        "found a container of an old office program without a workbook, or a workbook that is damaged, expected a measurement file (CSV), or a workbook: \
         save the table as `CSV UTF-8`",
    )?;
    let shared = Shared::of(&stream)?;
    let mut left = Left::of_workbook();
    let mut found = Vec::new();
    for (start, name) in &shared.sheets {
        let mut cells = Found::default();
        shared.read(stream.get(*start..).unwrap_or_default(), &mut cells, &mut left)?;
        found.push((name.clone(), cells.range(&mut left)));
    }
    Ok(found)
}

impl Shared {
    fn of(stream: &[u8]) -> Result<Self, String> {
        let (mut shared, mut formats, mut styles, mut is_1904) =
            (Shared::default(), Vec::new(), Vec::new(), false);
        for Record { kind, parts } in Records(stream) {
            let data = parts.first().copied().unwrap_or_default();
            match kind {
                kind::BEGIN if u16_at(data, 0) != Some(VERSION) => {
                    return Err("found a workbook of Excel 95 or earlier, expected one of Excel 97 or later: save it as .xlsx".to_owned());
                }
                kind::LOCKED => {
                    return Err("found a workbook with a password, expected one without: save its table as `CSV UTF-8`".to_owned());
                }
                kind::DATES => is_1904 = u16_at(data, 0) == Some(1),
                kind::FORMAT => formats.extend(u16_at(data, 0).zip(text(data.get(2..).unwrap_or_default()))),
                kind::STYLE => styles.push(u16_at(data, 2).unwrap_or_default()),
                kind::SHEET => shared.sheets.extend(sheet(data)),
                kind::TEXTS => shared.texts = texts(&parts),
                _ => {}
            }
        }
        shared.styles = Styles::of(&formats, &styles, is_1904);
        Ok(shared)
    }

    /// Reads the cells of a sheet.
    fn read(&self, stream: &[u8], cells: &mut Found, left: &mut Left) -> Result<(), String> {
        // Where a formula is whose text comes in a record of its own.
        let mut waiting = None;
        for Record { kind, parts } in Records(stream) {
            let data = parts.first().copied().unwrap_or_default();
            if kind == kind::OF_FORMULA {
                if let Some((place, value)) = waiting.take().zip(text(data)) {
                    cells.add(place, Data::String(value), left)?;
                }
                continue;
            }
            let Some((row, column)) = u16_at(data, 0).zip(u16_at(data, 2)) else { continue };
            let place = (u32::from(row), u32::from(column));
            let style = u16_at(data, 4).unwrap_or_default();
            let number = |at: usize| self.styles.number(f64_at(data, at)?, style);
            let value = match kind {
                kind::NUMBER => number(6),
                kind::SHORT => u32_at(data, 6).and_then(|it| self.styles.number(short(it), style)),
                kind::LABEL | kind::RICH => text(data.get(6..).unwrap_or_default()).map(Data::String),
                kind::OF_TEXTS => {
                    let at = u32_at(data, 6).and_then(|it| usize::try_from(it).ok());
                    at.and_then(|at| self.texts.get(at)).cloned().map(Data::String)
                }
                kind::FLAG => data.get(6..8).filter(|it| it[1] == 0).map(|it| Data::Bool(it[0] != 0)),
                kind::FORMULA if data.get(12..14) != Some(&[0xFF, 0xFF]) => number(6),
                kind::FORMULA => {
                    waiting = data.get(6).filter(|it| **it == 0).map(|_| place);
                    None
                }
                kind::SEVERAL => {
                    for (next, own) in (0_u32..).zip(data.get(4..).unwrap_or_default().chunks_exact(6)) {
                        let value = u16_at(own, 0).zip(u32_at(own, 2));
                        let value = value.and_then(|(style, it)| self.styles.number(short(it), style));
                        let place = (place.0, place.1 + next);
                        value.map_or(Ok(()), |value| cells.add(place, value, left))?;
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

/// A sheet of numbers: where it begins, and its name.
fn sheet(data: &[u8]) -> Option<(usize, String)> {
    let start = usize::try_from(u32_at(data, 0)?).ok()?;
    let (kind, count) = (*data.get(5)?, usize::from(*data.get(6)?));
    let name = letters(data.get(8..)?, count, data.get(7)? & 1 != 0)?;
    (kind == 0).then_some((start, name.replace('\0', "")))
}

/// A text that states its number of letters and whether they have two bytes.
fn text(data: &[u8]) -> Option<String> {
    letters(data.get(3..)?, usize::from(u16_at(data, 0)?), data.get(2)? & 1 != 0)
}

/// So many letters of one or two bytes.
fn letters(bytes: &[u8], count: usize, is_wide: bool) -> Option<String> {
    if is_wide {
        let units: Vec<u16> =
            bytes.get(..2 * count)?.chunks_exact(2).filter_map(|it| u16_at(it, 0)).collect();
        return Some(String::from_utf16_lossy(&units));
    }
    Some(bytes.get(..count)?.iter().map(|it| char::from(*it)).collect())
}

/// The texts that cells share: a list that goes on from record to record, in which a text may be cut, with its width stated anew behind the cut.
fn texts(parts: &[&[u8]]) -> Vec<String> {
    let mut parts =
        Cut { rest: parts.first().copied().unwrap_or_default(), others: parts.get(1..).unwrap_or_default() };
    let mut found = Vec::new();
    if parts.bytes(8).is_none() {
        return found;
    }
    while let Some(text) = parts.text() {
        found.push(text);
    }
    found
}

/// The bytes of a record and of those that continue it.
struct Cut<'p> {
    rest: &'p [u8],
    others: &'p [&'p [u8]],
}

impl<'p> Cut<'p> {
    /// Goes on in the next record at the end of one.
    fn go_on(&mut self) -> Option<()> {
        while self.rest.is_empty() {
            let (first, others) = self.others.split_first()?;
            (self.rest, self.others) = (first, others);
        }
        Some(())
    }

    /// So many bytes, which no cut separates.
    fn bytes(&mut self, count: usize) -> Option<&'p [u8]> {
        self.go_on()?;
        let (found, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(found)
    }

    fn skip(&mut self, mut count: usize) -> Option<()> {
        while count > 0 {
            self.go_on()?;
            let here = count.min(self.rest.len());
            self.rest = self.rest.get(here..)?;
            count -= here;
        }
        Some(())
    }

    fn text(&mut self) -> Option<String> {
        let head = self.bytes(3)?;
        let (mut left, flags) = (usize::from(u16_at(head, 0)?), *head.get(2)?);
        let mut is_wide = flags & 1 != 0;
        let runs = if flags & 8 != 0 { u16_at(self.bytes(2)?, 0)? } else { 0 };
        let beside = if flags & 4 != 0 { u32_at(self.bytes(4)?, 0)? } else { 0 };
        let mut found = String::new();
        while left > 0 {
            if self.rest.is_empty() {
                self.go_on()?;
                is_wide = self.bytes(1)?.first()? & 1 != 0;
            }
            let width = if is_wide { 2 } else { 1 };
            let here = left.min(self.rest.len() / width);
            if here == 0 {
                return None;
            }
            found.push_str(&letters(self.bytes(here * width)?, here, is_wide)?);
            left -= here;
        }
        self.skip(usize::from(runs) * 4)?;
        self.skip(usize::try_from(beside).ok()?)?;
        Some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_storage::limits::{self, Limit};
    use poecal_testing::damage::damaged;
    use poecal_testing::old_workbook::container;

    fn record(kind: u16, data: &[u8]) -> Vec<u8> {
        [&kind.to_le_bytes(), &u16::try_from(data.len()).unwrap().to_le_bytes(), data].concat()
    }

    /// A cell: row, column, style, and what it holds.
    fn cell(kind: u16, [row, column, style]: [u16; 3], data: &[u8]) -> Vec<u8> {
        record(kind, &[&row.to_le_bytes()[..], &column.to_le_bytes(), &style.to_le_bytes(), data].concat())
    }

    fn counted(text: &str) -> Vec<u8> {
        [&u16::try_from(text.len()).unwrap().to_le_bytes()[..], &[0], text.as_bytes()].concat()
    }

    /// A workbook of one sheet: its texts in two records, the second of which begins within the text `second`.
    fn stream(cells: &[Vec<u8>]) -> Vec<u8> {
        let begin = record(kind::BEGIN, &[0, 6, 5, 0]);
        let shared = [&[2, 0, 0, 0, 2, 0, 0, 0][..], &counted("first"), &[6, 0, 0], b"sec"].concat();
        let more = [&[1][..], &"ond".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()].concat();
        let globals = |start: u32| {
            let name = [&start.to_le_bytes()[..], &[0, 0, 5, 0], b"Rows1"].concat();
            [
                begin.clone(),
                record(kind::FORMAT, &[&[164, 0][..], &counted("yyyy\\-mm \"d\"")].concat()),
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
            cell(kind::LABEL, [0, 2, 0], &counted("third")),
            cell(kind::NUMBER, [1, 0, 0], &number(1.5)),
            // 250 hundredths, and the upper half of 0.25.
            cell(kind::SHORT, [1, 1, 0], &(250_u32 << 2 | 3).to_le_bytes()),
            cell(
                kind::SEVERAL,
                [1, 2, 0],
                &[&(0.25_f64.to_bits() >> 32).to_le_bytes()[..4], &[2, 0]].concat(),
            ),
            cell(kind::NUMBER, [2, 0, 1], &number(2.0)),
            cell(kind::FORMULA, [2, 1, 0], &[&number(7.0)[..], &[0; 8]].concat()),
            cell(kind::FORMULA, [2, 2, 0], &[0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0, 0]),
            record(kind::OF_FORMULA, &counted("made")),
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
        assert!(
            error.starts_with("found a sheet of 65536 rows and 16001 columns, expected at most"),
            "{error}"
        );
        let few = limits::here().with(Limit::Cells, 11);
        assert!(limits::on(few, || sheets(&container(&stream(&example())))).is_err());
    }

    #[test]
    fn no_bytes_end_in_a_panic() {
        damaged(&container(&stream(&example())), |bytes| drop(sheets(bytes)));
    }
}
