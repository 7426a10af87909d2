//! `poecal detect --print`: a board on paper, to scale, and its correction by ruler measurements.

use std::path::Path;

use poecal_detect::Spec;
use poecal_detect::print::{Measured, Sheet, described};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_results::output::{Existing, FilePlace};

use crate::DONE;
use crate::args::Detect;
use crate::console::Console;
use crate::style::{labelled, shown};

/// File form of a drawing.
enum Form {
    Svg,
    Pdf,
}

pub(super) fn board(arguments: &Detect, spec: &Spec, console: &Console) -> Result<u8> {
    if arguments.place.out.is_none() && arguments.measured.is_none() {
        return ErrorKind::Option.refuse("found neither --out nor --measured, expected the file to draw, --out board.pdf or --out board.svg");
    }
    let mut code = DONE;
    if let Some(out) = &arguments.place.out {
        code = drawn(arguments, (spec, out), console)?;
    }
    if let Some(measured) = &arguments.measured {
        corrected(spec, measured, console)?;
    }
    Ok(code)
}

/// Writes the page, and states its contents.
fn drawn(arguments: &Detect, (spec, out): (&Spec, &Path), console: &Console) -> Result<u8> {
    let form = form(out)?;
    if let Some(measured) = &arguments.measured {
        // Measurements that cannot be corrected are refused before anything is written.
        measured.correct(spec).map_err(|error| refused("--measured", &error))?;
    }
    let sheet = Sheet::new(spec, &arguments.paper).map_err(|error| refused("--print", &error))?;
    let place = FilePlace::reserve(out, Existing::forced(arguments.place.force), &[], &mut console.warner())?;
    let text = match form {
        Form::Svg => sheet.svg(),
        Form::Pdf => sheet.pdf(),
    };
    place.write(vec![text.into()])?;
    if let Some((turned, instead)) = looks_alike(spec) {
        console.warning(format!(
            "{} looks the same turned by {turned}, so that its first point may be taken for another one: {instead}",
            described(spec)
        ));
    }
    let [width, height] = sheet.size_mm;
    let words = labelled("written", &shown(out))
        + &labelled("board", &described(spec))
        + &labelled("page", &format!("{width} x {height} mm: print it at 100 %, and check both rulers"))
        + &labelled("calibrate", &format!("--markers {spec}"));
    Ok(console.say_of(&words, out))
}

/// Rotation under which a board is identical to itself, and an unambiguous alternative.
fn looks_alike(spec: &Spec) -> Option<(&'static str, &'static str)> {
    const ODD: &str = "an even number of squares one way and an odd one the other tell both apart";
    const DOTS: &str =
        "an asymmetric grid with an odd number of rows, a ChArUco board and an AprilGrid have no such doubt";
    let half = "180 degrees";
    if let Spec::Chessboard(board) = spec {
        return (board.columns + board.rows).is_multiple_of(2).then_some((half, ODD));
    }
    let Spec::Circles(board) = spec else { return None };
    if !board.asymmetric && board.columns == board.rows {
        return Some(("90 degrees", DOTS));
    }
    (!board.asymmetric || board.rows.is_multiple_of(2)).then_some((half, DOTS))
}

fn form(out: &Path) -> Result<Form> {
    let extension = out.extension().and_then(|it| it.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "svg" => Ok(Form::Svg),
        "pdf" => Ok(Form::Pdf),
        _ => ErrorKind::Option
            .refuse(format!("--out: found no form in the name `{}`, expected .svg or .pdf", shown(out))),
    }
}

/// Prints the measured board as data, for pasting.
fn corrected(spec: &Spec, measured: &Measured, console: &Console) -> Result<()> {
    let found = measured.correct(spec).map_err(|error| refused("--measured", &error))?;
    let [x, y] = found.factors.map(|it| (it - 1.0) * 100.0);
    console.remark(format!("the print is {} along x, {} along y", larger(x), larger(y)));
    if !found.agrees() {
        console.warning(format!(
            "along x and y the scales differ by {:.2} %, so that no single size describes the print: run `poecal calibrate` with --free board, which finds \
             both, or print it again at 100 %",
            found.stretch().abs() * 100.0
        ));
    }
    console.data(&format!("--markers {}\n", found.spec))
}

fn larger(percent: f64) -> String {
    match format!("{:.2}", percent.abs()).as_str() {
        "0.00" => "as large as stated".to_owned(),
        part => format!("{part} % {}", if percent < 0.0 { "smaller" } else { "larger" }),
    }
}

fn refused(option: &str, error: &poecal_detect::Error) -> poecal_numerics::error::Error {
    ErrorKind::Option.error(format!("{option}: {error}"))
}
