//! Binary workbooks (.xlsb): the numbers and texts of their sheets, MS-XLSB. Formulas are what they gave when the workbook was saved.
//!
//! Read here, since other readers take the lengths that records state without a check.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use calamine::{CellErrorType, Data, Range};
use quick_xml::Reader;
use quick_xml::events::Event;
use zip::ZipArchive;

use poecal_storage::limits::Limit;

use super::super::fields::Fields;
use super::archive::Parts;
use super::cells::{Found, Left, ReadSheet, broken};
use super::numbers::{Shared, long, short, wide};

/// Kinds of records.
mod kind {
    pub(super) const ROW: u16 = 0x0000;
    pub(super) const SHORT: u16 = 0x0002;
    pub(super) const ERROR: u16 = 0x0003;
    pub(super) const FLAG: u16 = 0x0004;
    pub(super) const NUMBER: u16 = 0x0005;
    pub(super) const TEXT: u16 = 0x0006;
    pub(super) const OF_TEXTS: u16 = 0x0007;
    pub(super) const FORMULA_TEXT: u16 = 0x0008;
    pub(super) const FORMULA: u16 = 0x0009;
    pub(super) const FORMULA_FLAG: u16 = 0x000A;
    pub(super) const FORMULA_ERROR: u16 = 0x000B;
    pub(super) const SHARED_TEXT: u16 = 0x0013;
    pub(super) const FORMAT: u16 = 0x002C;
    pub(super) const STYLE: u16 = 0x002F;
    pub(super) const END_OF_CELLS: u16 = 0x0092;
    pub(super) const DATES: u16 = 0x0099;
    pub(super) const SHEET: u16 = 0x009C;
    pub(super) const STYLES: u16 = 0x0269;
    pub(super) const END_OF_STYLES: u16 = 0x026A;
}

/// The part that names the sheets; a workbook with it is a binary one.
const WORKBOOK: &str = "xl/workbook.bin";
/// Bytes before the link of a sheet.
const BEFORE_LINK: usize = 8;
/// Most rows of a sheet.
const MOST_ROWS: u32 = 1 << 20;
/// What is said of a record whose parts lie beyond its end.
const SHORT_RECORD: &str = "a record is shorter than what it holds";

/// The parts of a workbook by their names.
struct Archive<'b>(ZipArchive<Cursor<&'b [u8]>>);

impl Archive<'_> {
    /// A part, if there is one; its size is bounded with those of all.
    fn part(&mut self, name: &str) -> Result<Option<Vec<u8>>, String> {
        let own = self.0.file_names().find(|it| it.eq_ignore_ascii_case(name)).map(str::to_owned);
        let Some(own) = own else { return Ok(None) };
        let mut bytes = Vec::new();
        let part = self.0.by_name(&own).map_err(|error| error.to_string())?;
        part.take(Limit::Unpacked.most()).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
        Ok(Some(bytes))
    }
}

/// A record of a part: its kind and its bytes.
type Record<'b> = (u16, Fields<'b>);

/// The records of a part; the last one is an error if it is cut.
struct Records<'b>(Fields<'b>);

impl<'b> Records<'b> {
    fn of(part: &'b [u8]) -> Self {
        Records(Fields(part))
    }

    fn one(&mut self) -> Option<Record<'b>> {
        let rest = &mut self.0;
        let first = rest.u8()?;
        let kind = match first & 0x80 {
            0 => u16::from(first),
            _ => u16::from(first & 0x7F) | u16::from(rest.u8()? & 0x7F) << 7,
        };
        let mut size = 0;
        for shift in [0, 7, 14, 21] {
            let next = rest.u8()?;
            size |= usize::from(next & 0x7F) << shift;
            if next & 0x80 == 0 {
                break;
            }
        }
        Some((kind, Fields(rest.bytes(size)?)))
    }
}

impl<'b> Iterator for Records<'b> {
    type Item = Result<Record<'b>, String>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.0.0.is_empty() {
            return None;
        }
        let found = self.one();
        if found.is_none() {
            self.0 = Fields(&[]);
        }
        Some(found.ok_or_else(|| "a record goes beyond the end".to_owned()))
    }
}

/// The sheets of a binary workbook; `None` of an archive that is none.
///
/// # Errors
/// What is wrong with it, in a sentence.
pub(crate) fn sheets(bytes: &[u8], parts: Parts) -> Result<Option<Vec<ReadSheet>>, String> {
    let Ok(archive) = ZipArchive::new(Cursor::new(bytes)) else { return Ok(None) };
    let mut archive = Archive(archive);
    let damaged = |error: String| {
        format!("the workbook cannot be read ({error}), expected a workbook that is whole: save it again")
    };
    let Some(workbook) = archive.part(WORKBOOK).map_err(damaged)? else { return Ok(None) };
    let (shared, named) = shared(&mut archive, &workbook).map_err(damaged)?;
    if shared.texts.len() as u64 > Limit::Cells.most() {
        return Err(Limit::Cells.exceeded("the texts of this workbook"));
    }
    parts.refuse_sheets(named.len())?;
    let mut left = Left::of_workbook();
    let mut found = Vec::new();
    for (name, path) in named {
        let sheet = archive.part(&path).and_then(|it| it.ok_or_else(|| format!("there is no part `{path}`")));
        let sheet = sheet.map_err(|error| broken(&name, &error))?;
        let range = shared.range(&sheet, &name, &mut left)?;
        found.push((name, range));
    }
    Ok(Some(found))
}

/// What the sheets share, and their names with those of their parts.
fn shared(archive: &mut Archive<'_>, workbook: &[u8]) -> Result<(Shared, Vec<(String, String)>), String> {
    let (mut shared, mut named) = (Shared::default(), Vec::new());
    let paths = paths(&archive.part("xl/_rels/workbook.bin.rels")?.unwrap_or_default());
    for record in Records::of(workbook) {
        match record? {
            (kind::DATES, mut data) => shared.is_1904 = data.u8().is_some_and(|it| it & 1 != 0),
            (kind::SHEET, data) => {
                let (link, name) = link_and_name(data).ok_or(SHORT_RECORD)?;
                let path = paths.get(&link).filter(|it| it.contains("worksheets/"));
                named.extend(path.map(|it| (name, it.clone())));
            }
            _ => {}
        }
    }
    for record in Records::of(&archive.part("xl/sharedStrings.bin")?.unwrap_or_default()) {
        if let (kind::SHARED_TEXT, mut data) = record? {
            let text = data.u8().and_then(|_| text(&mut data));
            shared.texts.push(text.ok_or(SHORT_RECORD)?);
        }
    }
    // Formats, and the list of the styles of cells, which names them.
    let (mut styles, mut is_of_cells) = (Vec::new(), false);
    for record in Records::of(&archive.part("xl/styles.bin")?.unwrap_or_default()) {
        match record? {
            (kind::FORMAT, mut data) => shared.formats.extend(data.u16().zip(text(&mut data))),
            (kind::STYLES, _) => is_of_cells = true,
            (kind::END_OF_STYLES, _) => is_of_cells = false,
            (kind::STYLE, mut data) if is_of_cells => {
                styles.push(data.u16().and_then(|_| data.u16()).unwrap_or_default());
            }
            _ => {}
        }
    }
    shared.take_styles(&styles);
    Ok((shared, named))
}

impl Shared {
    /// The cells of a sheet.
    fn range(&self, sheet: &[u8], name: &str, left: &mut Left) -> Result<Range<Data>, String> {
        let (mut found, mut row) = (Found::default(), 0);
        for record in Records::of(sheet) {
            let (kind, mut data) = record.map_err(|error| broken(name, &error))?;
            let short = || broken(name, &SHORT_RECORD);
            match kind {
                kind::END_OF_CELLS => break,
                kind::ROW => row = data.u32().filter(|it| *it < MOST_ROWS).ok_or_else(short)?,
                kind::SHORT..=kind::FORMULA_ERROR => {
                    let column = data.u32().filter(|it| *it <= u32::from(u16::MAX)).ok_or_else(short)?;
                    let value = self.value(kind, data).ok_or_else(short)?;
                    found.add((row, column), value, left)?;
                }
                _ => {}
            }
        }
        Ok(found.range(left))
    }

    /// What a cell holds, from its style on; `None` of a record that is too short.
    fn value(&self, kind: u16, mut data: Fields<'_>) -> Option<Data> {
        // The upper byte is none of the style.
        let (style, _) = (data.u16()?, data.u16()?);
        let number = |value| self.number(value, style).unwrap_or(Data::Empty);
        Some(match kind {
            kind::SHORT => number(short(&mut data)?),
            kind::NUMBER | kind::FORMULA => number(long(&mut data)?),
            kind::TEXT | kind::FORMULA_TEXT => Data::String(text(&mut data)?),
            kind::OF_TEXTS => self.text(&mut data)?,
            kind::FLAG | kind::FORMULA_FLAG => Data::Bool(data.u8()? != 0),
            kind::ERROR | kind::FORMULA_ERROR => Data::Error(error(data.u8()?)),
            _ => Data::Empty,
        })
    }
}

fn error(code: u8) -> CellErrorType {
    match code {
        0x00 => CellErrorType::Null,
        0x07 => CellErrorType::Div0,
        0x17 => CellErrorType::Ref,
        0x1D => CellErrorType::Name,
        0x24 => CellErrorType::Num,
        0x2A => CellErrorType::NA,
        0x2B => CellErrorType::GettingData,
        _ => CellErrorType::Value,
    }
}

/// A text with its number of letters before it.
fn text(data: &mut Fields<'_>) -> Option<String> {
    let count = data.index()?;
    wide(data, count)
}

/// The link of a sheet to its part, and its name.
fn link_and_name(mut data: Fields<'_>) -> Option<(String, String)> {
    data.bytes(BEFORE_LINK)?;
    // A sheet without a part, such as one of macros.
    let has_part = Fields(data.0).u32()? != u32::MAX;
    let link = if has_part { text(&mut data) } else { data.u32().map(|_| String::new()) };
    Some((link?, text(&mut data)?))
}

/// The parts that links lead to.
fn paths(links: &[u8]) -> BTreeMap<String, String> {
    let mut reader = Reader::from_reader(links);
    let mut found = BTreeMap::new();
    while let Ok(event) = reader.read_event() {
        let (Event::Start(tag) | Event::Empty(tag)) = event else {
            if matches!(event, Event::Eof) {
                break;
            }
            continue;
        };
        let value = |name: &[u8]| {
            let own = tag.attributes().flatten().find(|it| it.key.as_ref() == name)?;
            Some(String::from_utf8_lossy(&own.value).into_owned())
        };
        if let Some((link, target)) = value(b"Id").zip(value(b"Target")) {
            let path = target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned);
            found.insert(link, path);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_storage::limits;
    use poecal_testing::damage::damaged;
    use std::io::Write;
    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    fn read(bytes: &[u8]) -> Result<Option<Vec<ReadSheet>>, String> {
        sheets(bytes, Parts::of(bytes)?)
    }

    fn record(kind: u16, data: &[u8]) -> Vec<u8> {
        let low = u8::try_from(kind & 0x7F).unwrap();
        let kind = if kind < 0x80 { vec![low] } else { vec![low | 0x80, u8::try_from(kind >> 7).unwrap()] };
        let size = u8::try_from(data.len()).unwrap();
        let size = if size < 0x80 { vec![size] } else { vec![size, 1] };
        [kind, size, data.to_vec()].concat()
    }

    fn counted(text: &str) -> Vec<u8> {
        let units: Vec<u16> = text.encode_utf16().collect();
        let count = u32::try_from(units.len()).unwrap();
        [count.to_le_bytes().to_vec(), units.into_iter().flat_map(u16::to_le_bytes).collect()].concat()
    }

    fn cell(kind: u16, column: u32, style: u32, data: &[u8]) -> Vec<u8> {
        record(kind, &[&column.to_le_bytes()[..], &style.to_le_bytes(), data].concat())
    }

    fn row(at: u32) -> Vec<u8> {
        record(kind::ROW, &[&at.to_le_bytes()[..], &[0; 13]].concat())
    }

    fn archive(sheet: &[u8]) -> Vec<u8> {
        let links =
            "<Relationships><Relationship Id=\"rId1\" Target=\"worksheets/sheet1.bin\"/></Relationships>";
        let named = [vec![0; 8], counted("rId1"), counted("Rows1")].concat();
        let texts: Vec<u8> = ["first", "second"]
            .into_iter()
            .flat_map(|it| record(kind::SHARED_TEXT, &[vec![0], counted(it)].concat()))
            .collect();
        let styles = [
            record(kind::FORMAT, &[164_u16.to_le_bytes().to_vec(), counted("yyyy-mm")].concat()),
            record(kind::STYLES, &[2, 0, 0, 0]),
            record(kind::STYLE, &[0, 0, 0, 0]),
            record(kind::STYLE, &[0, 0, 164, 0]),
            record(kind::END_OF_STYLES, &[]),
        ];
        let mut out = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in [
            (WORKBOOK, record(kind::SHEET, &named)),
            ("xl/_rels/workbook.bin.rels", links.as_bytes().to_vec()),
            ("xl/sharedStrings.bin", texts),
            ("xl/styles.bin", styles.concat()),
            ("xl/worksheets/sheet1.bin", sheet.to_vec()),
        ] {
            let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
            out.start_file(name, stored).unwrap();
            out.write_all(&content).unwrap();
        }
        out.finish().unwrap().into_inner()
    }

    fn example() -> Vec<u8> {
        [
            row(0),
            cell(kind::OF_TEXTS, 0, 0, &[0, 0, 0, 0]),
            cell(kind::OF_TEXTS, 1, 0, &[1, 0, 0, 0]),
            cell(kind::TEXT, 2, 0, &counted("third")),
            row(1),
            cell(kind::NUMBER, 0, 0, &1.5_f64.to_le_bytes()),
            cell(kind::SHORT, 1, 0, &(250_u32 << 2 | 3).to_le_bytes()),
            cell(kind::FORMULA, 2, 0, &[&7.0_f64.to_le_bytes()[..], &[0; 10]].concat()),
            row(2),
            cell(kind::NUMBER, 0, 1, &2.0_f64.to_le_bytes()),
            cell(kind::FLAG, 1, 0, &[1]),
            cell(kind::ERROR, 2, 0, &[7]),
            record(kind::END_OF_CELLS, &[]),
        ]
        .concat()
    }

    #[test]
    fn cells_of_every_kind_are_read() {
        let found = read(&archive(&example())).unwrap().unwrap();
        let [(name, range)] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((name.as_str(), range.get_size()), ("Rows1", (3, 3)));
        let texts: Vec<String> = range
            .rows()
            .flatten()
            .filter(|it| !matches!(it, Data::DateTime(_)))
            .map(ToString::to_string)
            .collect();
        assert_eq!(texts, ["first", "second", "third", "1.5", "2.5", "7", "true", "#DIV/0!"]);
        assert!(matches!(range.get_value((2, 0)), Some(Data::DateTime(time)) if time.as_f64() == 2.0));
        assert!(read(b"PK\x03\x04").unwrap().is_none());
    }

    #[test]
    fn short_and_cut_records_are_told() {
        let message = |sheet: &[u8]| read(&archive(sheet)).unwrap_err();
        let whole = example();
        let cut = message(&whole[..whole.len() - 5]);
        assert_eq!(
            cut,
            "the sheet `Rows1` cannot be read (a record goes beyond the end), expected a workbook that is whole: save it again"
        );
        for short in [
            record(kind::ROW, &[0]),
            record(kind::ROW, &u32::MAX.to_le_bytes()),
            record(kind::NUMBER, &[0; 15]),
            record(kind::SHORT, &[0; 11]),
            record(kind::ERROR, &[]),
            cell(kind::OF_TEXTS, 0, 0, &[2, 0, 0, 0]),
            cell(kind::TEXT, 0, 0, &[0xFF; 6]),
            cell(kind::NUMBER, 1 << 16, 0, &[0; 8]),
        ] {
            assert!(message(&short).contains("a record is shorter than what it holds"), "{short:?}");
        }
    }

    #[test]
    fn a_cell_far_off_is_refused_before_its_range_is_held() {
        let far = example();
        let cells = [&far[..far.len() - 3], &row(1_048_575), &cell(kind::NUMBER, 16_000, 0, &[0; 8])];
        let error = read(&archive(&cells.concat())).unwrap_err();
        assert!(
            error.starts_with("found a sheet of 1048576 rows and 16001 columns, expected at most"),
            "{error}"
        );
        let few = limits::here().with(Limit::Cells, 1);
        assert!(limits::on(few, || read(&archive(&[]))).unwrap_err().contains("the texts of this workbook"));
    }

    #[test]
    fn no_bytes_end_in_a_panic() {
        damaged(&archive(&example()), |bytes| drop(read(bytes)));
        // Checksums do not guard a sheet whose archive is whole.
        damaged(&example(), |sheet| drop(read(&archive(sheet))));
    }
}
