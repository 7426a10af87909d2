//! A page as SVG.

use std::fmt::Write as _;

use super::decimal;
use super::sheet::PrintSheet;

/// Decimals of millimetres.
const DIGITS: usize = 4;

/// The page in millimetres. Black areas are one path, so that no light line appears between touching parts.
pub(super) fn write_svg(sheet: &PrintSheet) -> String {
    let mm = |value: f64| decimal(value, DIGITS);
    let [width, height] = sheet.size_mm.map(mm);
    let title = escape_xml(&sheet.title);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{title}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n<path fill=\"#000\" d=\""
    );
    // Writing to a string does not fail.
    for it in &sheet.rectangles {
        let ([left, upper], [right, lower]) = (it.from_mm.map(mm), it.to_mm.map(mm));
        let _ = writeln!(out, "M{left} {upper}H{right}V{lower}H{left}Z");
    }
    for it in &sheet.discs {
        let [x, y] = it.middle_mm;
        let (left, y, radius, across) = (mm(x - it.radius_mm), mm(y), mm(it.radius_mm), mm(2.0 * it.radius_mm));
        let half = |way: &str| format!("a{radius} {radius} 0 0 1 {way}{across} 0");
        let _ = writeln!(out, "M{left} {y}{}{}Z", half(""), half("-"));
    }
    out += "\"/>\n<g fill=\"#000\" font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\">\n";
    for words in &sheet.words {
        let ([x, y], size, length) = (words.at_mm.map(mm), mm(words.size_mm), mm(words.length_mm));
        let turn = if words.downwards { format!(" transform=\"rotate(90 {x} {y})\"") } else { String::new() };
        let text = escape_xml(&words.text);
        let _ = writeln!(
            out,
            "<text xml:space=\"preserve\" x=\"{x}\" y=\"{y}\" font-size=\"{size}\" textLength=\"{length}\" lengthAdjust=\"spacingAndGlyphs\"{turn}>{text}</text>"
        );
    }
    out + "</g>\n</svg>\n"
}

fn escape_xml(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
