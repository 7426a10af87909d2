//! `poecal detect --print`: a board on paper, to scale, and its correction by ruler measurements.

use std::path::Path;

use poecal_detect::BoardSpec;
use poecal_detect::print::{PrintMeasurement, PrintSheet, describe_board};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_results::output::{ExistingFiles, ReservedFile};

use crate::DONE;
use crate::args::Detect;
use crate::console::Console;
use crate::style::{label_paragraph, printable_path};

/// File form of a drawing.
enum DrawingFormat {
    Svg,
    Pdf,
}

pub(super) fn board(arguments: &Detect, spec: &BoardSpec, console: &Console) -> Result<u8> {
    if arguments.place.out.is_none() && arguments.measured.is_none() {
        return ErrorKind::Option.refuse(
            "found neither --out nor --measured, expected the file to draw, --out board.pdf or --out board.svg",
        );
    }
    let mut code = DONE;
    if let Some(out) = &arguments.place.out {
        code = write_board(arguments, (spec, out), console)?;
    }
    if let Some(measured) = &arguments.measured {
        print_measured_board(spec, measured, console)?;
    }
    Ok(code)
}

/// Writes the page, and states its contents.
fn write_board(arguments: &Detect, (spec, out): (&BoardSpec, &Path), console: &Console) -> Result<u8> {
    let form = form(out)?;
    if let Some(measured) = &arguments.measured {
        // Measurements that cannot be corrected are refused before anything is written.
        measured.correct(spec).map_err(|error| option_error("--measured", &error))?;
    }
    let sheet = PrintSheet::new(spec, &arguments.paper).map_err(|error| option_error("--print", &error))?;
    let place =
        ReservedFile::reserve(out, ExistingFiles::from_switch(arguments.place.force), &[], &mut console.warner())?;
    let text = match form {
        DrawingFormat::Svg => sheet.svg(),
        DrawingFormat::Pdf => sheet.pdf(),
    };
    place.write(vec![text.into()])?;
    if let Some((turned, instead)) = looks_alike(spec) {
        console.warning(format!(
            "{} looks the same turned by {turned}, so that its first point may be taken for another one: {instead}",
            describe_board(spec)
        ));
    }
    let [width, height] = sheet.size_mm;
    let words = label_paragraph("written", &printable_path(out))
        + &label_paragraph("board", &describe_board(spec))
        + &label_paragraph("page", &format!("{width} x {height} mm: print it at 100 %, and check both rulers"))
        + &label_paragraph("calibrate", &format!("--markers {spec}"));
    Ok(console.say_of(&words, out))
}

/// Rotation under which a board is identical to itself, and an unambiguous alternative.
fn looks_alike(spec: &BoardSpec) -> Option<(&'static str, &'static str)> {
    const ODD: &str = "an even number of squares one way and an odd one the other distinguish both";
    const DOTS: &str =
        "an asymmetric grid with an odd number of rows, a ChArUco board and an AprilGrid have no such ambiguity";
    let half = "180 degrees";
    if let BoardSpec::Chessboard(board) = spec {
        return (board.columns + board.rows).is_multiple_of(2).then_some((half, ODD));
    }
    let BoardSpec::Circles(board) = spec else { return None };
    if !board.asymmetric && board.columns == board.rows {
        return Some(("90 degrees", DOTS));
    }
    (!board.asymmetric || board.rows.is_multiple_of(2)).then_some((half, DOTS))
}

fn form(out: &Path) -> Result<DrawingFormat> {
    let extension = out.extension().and_then(|it| it.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "svg" => Ok(DrawingFormat::Svg),
        "pdf" => Ok(DrawingFormat::Pdf),
        _ => ErrorKind::Option
            .refuse(format!("--out: found no form in the name `{}`, expected .svg or .pdf", printable_path(out))),
    }
}

/// Prints the measured board as data, for pasting.
fn print_measured_board(spec: &BoardSpec, measured: &PrintMeasurement, console: &Console) -> Result<()> {
    let found = measured.correct(spec).map_err(|error| option_error("--measured", &error))?;
    let [x, y] = found.factors.map(|it| (it - 1.0) * 100.0);
    console.remark(format!("the print is {} along x, {} along y", describe_size(x), describe_size(y)));
    if !found.agrees() {
        console.warning(format!(
            "along x and y the scales differ by {:.2} %, so that no single size describes the print: run `poecal calibrate` with --free board, which finds \
             both, or print it again at 100 %",
            found.stretch().abs() * 100.0
        ));
    }
    console.data(&format!("--markers {}\n", found.spec))
}

fn describe_size(percent: f64) -> String {
    match format!("{:.2}", percent.abs()).as_str() {
        "0.00" => "as large as stated".to_owned(),
        part => format!("{part} % {}", if percent < 0.0 { "smaller" } else { "larger" }),
    }
}

fn option_error(option: &str, error: &poecal_detect::Error) -> poecal_numerics::error::Error {
    ErrorKind::Option.error(format!("{option}: {error}"))
}
