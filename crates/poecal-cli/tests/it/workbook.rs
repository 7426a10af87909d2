//! A small workbook (.xlsx): a ZIP archive without compression.

use std::fmt::Write as _;

/// CRC-32 of ZIP archives.
fn crc32(bytes: &[u8]) -> u32 {
    let of = |mut crc: u32, byte: &u8| {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
        crc
    };
    !bytes.iter().fold(!0, of)
}

/// An archive of files.
fn archive(files: &[(String, String)]) -> Vec<u8> {
    let (mut bytes, mut list) = (Vec::new(), Vec::new());
    for (name, text) in files {
        let start = u32::try_from(bytes.len()).unwrap();
        let size = u32::try_from(text.len()).unwrap().to_le_bytes();
        let mut head = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        head.extend(crc32(text.as_bytes()).to_le_bytes());
        head.extend([size, size].concat());
        head.extend(u16::try_from(name.len()).unwrap().to_le_bytes());
        head.extend([0, 0]);
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&head);
        bytes.extend([name.as_bytes(), text.as_bytes()].concat());
        list.extend(b"PK\x01\x02\x14\0");
        list.extend(&head);
        list.extend([0; 10]);
        list.extend(start.to_le_bytes());
        list.extend(name.as_bytes());
    }
    let (start, size) = (u32::try_from(bytes.len()).unwrap(), u32::try_from(list.len()).unwrap());
    let count = u16::try_from(files.len()).unwrap().to_le_bytes();
    bytes.extend(list);
    bytes.extend(b"PK\x05\x06\0\0\0\0");
    bytes.extend([count, count].concat());
    bytes.extend([size.to_le_bytes(), start.to_le_bytes()].concat());
    bytes.extend([0, 0]);
    bytes
}

/// A workbook of sheets with the texts of their cells. A cell that is a number is stored as one. A cell that begins with `t` is stored as the text
/// behind it, one with `=` as a formula, whose result is behind `|`. One with `d` is stored as a number that is shown as a date.
pub(crate) fn workbook(sheets: &[(&str, &Vec<Vec<String>>)]) -> Vec<u8> {
    const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>";
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
    let mut files = Vec::new();
    let (mut list, mut links, mut types) = (String::new(), String::new(), String::new());
    for (at, (name, rows)) in (1..).zip(sheets) {
        let mut data = String::new();
        for (row, cells) in (1..).zip(rows.iter()) {
            write!(data, "<row r=\"{row}\">").unwrap();
            for (column, text) in ('A'..).zip(cells) {
                let own = text.strip_prefix('t').unwrap_or(text);
                if text.is_empty() {
                } else if let Some((formula, result)) = text.strip_prefix('=').and_then(|it| it.split_once('|')) {
                    write!(data, "<c r=\"{column}{row}\"><f>{formula}</f><v>{result}</v></c>").unwrap();
                } else if let Some(number) = text.strip_prefix('d').filter(|it| it.parse::<f64>().is_ok()) {
                    write!(data, "<c r=\"{column}{row}\" s=\"1\"><v>{number}</v></c>").unwrap();
                } else if text.parse::<f64>().is_ok() {
                    write!(data, "<c r=\"{column}{row}\"><v>{text}</v></c>").unwrap();
                } else {
                    write!(data, "<c r=\"{column}{row}\" t=\"inlineStr\"><is><t>{own}</t></is></c>").unwrap();
                }
            }
            data += "</row>";
        }
        files.push((
            format!("xl/worksheets/sheet{at}.xml"),
            format!("{HEAD}<worksheet xmlns=\"{MAIN}\"><sheetData>{data}</sheetData></worksheet>"),
        ));
        write!(list, "<sheet name=\"{name}\" sheetId=\"{at}\" r:id=\"rId{at}\"/>").unwrap();
        write!(links, "<Relationship Id=\"rId{at}\" Type=\"{OFFICE}/worksheet\" Target=\"worksheets/sheet{at}.xml\"/>")
            .unwrap();
        write!(
            types,
            "<Override PartName=\"/xl/worksheets/sheet{at}.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml\"/>"
        )
        .unwrap();
    }
    write!(links, "<Relationship Id=\"styles\" Type=\"{OFFICE}/styles\" Target=\"styles.xml\"/>").unwrap();
    write!(
        types,
        "<Override PartName=\"/xl/styles.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.styles+xml\"/>"
    )
    .unwrap();
    files.push((
        "xl/styles.xml".to_owned(),
        format!("{HEAD}<styleSheet xmlns=\"{MAIN}\"><cellXfs count=\"2\"><xf numFmtId=\"0\"/><xf numFmtId=\"22\"/></cellXfs></styleSheet>"),
    ));
    files.push((
        "xl/workbook.xml".to_owned(),
        format!("{HEAD}<workbook xmlns=\"{MAIN}\" xmlns:r=\"{OFFICE}\"><sheets>{list}</sheets></workbook>"),
    ));
    files.push((
        "xl/_rels/workbook.xml.rels".to_owned(),
        format!("{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\">{links}</Relationships>"),
    ));
    files.push((
        "_rels/.rels".to_owned(),
        format!("{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\"><Relationship Id=\"rId1\" Type=\"{OFFICE}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"),
    ));
    files.push((
        "[Content_Types].xml".to_owned(),
        format!("{HEAD}<Types xmlns=\"{PACKAGE}/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Override PartName=\"/xl/workbook.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml\"/>{types}</Types>"),
    ));
    archive(&files)
}
