//! A page as PDF.

use std::fmt::Write as _;

use super::decimal;
use super::sheet::{Disc, PrintSheet};

/// Points per millimetre.
const POINTS: f64 = 72.0 / 25.4;

/// A document of one page, in ASCII. It requests unscaled printing.
pub(super) fn write_pdf(sheet: &PrintSheet) -> String {
    let [width, height] = sheet.size_mm.map(|it| decimal(it * POINTS, 5));
    let content = content(sheet);
    let objects = [
        "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>".to_owned(),
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
        format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width} {height}] /Resources << /Font << /F1 5 0 R >> >> /Contents 4 0 R >>"
        ),
        format!("<< /Length {} >>\nstream\n{content}\nendstream", content.len()),
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>".to_owned(),
        format!("<< /Title ({}) /Producer (poecal) >>", escape_pdf(&sheet.title)),
    ];
    let mut out = "%PDF-1.6\n".to_owned();
    let mut places = Vec::new();
    for (object, number) in objects.iter().zip(1..) {
        places.push(out.len());
        // Writing to a string does not fail.
        let _ = write!(out, "{number} 0 obj\n{object}\nendobj\n");
    }
    let (table, count) = (out.len(), objects.len() + 1);
    // Each line of the table has 20 bytes.
    let _ = write!(out, "xref\n0 {count}\n0000000000 65535 f \n");
    for place in places {
        let _ = writeln!(out, "{place:010} 00000 n ");
    }
    let _ = write!(out, "trailer\n<< /Size {count} /Root 1 0 R /Info 6 0 R >>\nstartxref\n{table}\n%%EOF\n");
    out
}

/// Content of the page, in millimetres from its upper left corner: y is turned downwards for all of it, and back for words.
fn content(sheet: &PrintSheet) -> String {
    let mm = |value: f64| decimal(value, 5);
    let (scale, height) = (decimal(POINTS, 10), decimal(sheet.size_mm[1] * POINTS, 5));
    let mut out = format!("{scale} 0 0 -{scale} 0 {height} cm\n0 g\n");
    for it in &sheet.rectangles {
        let [x, y] = it.from_mm.map(mm);
        let [width, height] = [0, 1].map(|axis| mm(it.to_mm[axis] - it.from_mm[axis]));
        let _ = writeln!(out, "{x} {y} {width} {height} re");
    }
    for it in &sheet.discs {
        outline(&mut out, it);
    }
    // Filled at once, so that no light line appears between touching parts.
    out += "f\nBT\n/F1 1 Tf\n";
    for words in &sheet.words {
        let ([x, y], size) = (words.at_mm.map(mm), mm(words.size_mm));
        let turn = if words.downwards { format!("0 {size} {size} 0") } else { format!("{size} 0 0 -{size}") };
        let _ = writeln!(out, "{turn} {x} {y} Tm ({}) Tj", escape_pdf(&words.text));
    }
    out + "ET"
}

/// A circle as four curves, which deviate from it by at most 0.03 % of its radius.
fn outline(out: &mut String, disc: &Disc) {
    // Distance of the control points of a quarter: 4/3 (√2 - 1).
    const PULL: f64 = 0.552_284_749_830_793_4;
    let at = |x: f64, y: f64| {
        let [x, y] = [(x, 0), (y, 1)].map(|(it, axis)| disc.middle_mm[axis] + it * disc.radius_mm);
        format!("{} {}", decimal(x, 5), decimal(y, 5))
    };
    let _ = writeln!(out, "{} m", at(1.0, 0.0));
    for [x, y] in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
        // A quarter further is at (-y, x).
        let (from, to) = (at(x - PULL * y, y + PULL * x), at(-y + PULL * x, x + PULL * y));
        let _ = writeln!(out, "{from} {to} {} c", at(-y, x));
    }
    out.push_str("h\n");
}

fn escape_pdf(text: &str) -> String {
    text.replace('\\', "\\\\").replace('(', "\\(").replace(')', "\\)")
}
