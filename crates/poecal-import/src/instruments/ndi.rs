//! Tables that NDI's recorders write: the time of day in four columns, and up to 26 tools side by side (`Xa`, `Ya`, `Za`, `qoa`, `qxa`, …). Lengths
//! are in millimetres, and all numbers are zero if a tool was not seen.

use super::bodies::{RecordedBody, RecordedFrames};
use super::made_table::{MadeTable, Refusal};
use super::words::{HeadLine, lines, number};
use super::{FileForm, OpeningContext};
use crate::Separator;

pub(crate) const FORM: FileForm = FileForm { title: "a recording of an NDI tracker", is_it, table };

const FIRST: usize = 10;
/// Columns of the time of day, with the number of seconds in each unit.
const TIME: [(&str, f64); 4] = [("Hour", 3600.0), ("Minutes", 60.0), ("Seconds", 1.0), ("ms", 1e-3)];

fn head(text: &str) -> Option<HeadLine<'_>> {
    let mut some = lines(text).take(FIRST).map(|it| HeadLine::from_line(it, Separator::Comma));
    some.find(|it| it.has(&["Xa", "Ya", "Za", "qoa"]))
}

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    head(text).is_some()
}

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let head = head(text).ok_or("found no header")?;
    let body = |letter: char| {
        let of = |stem: &str| head.column_of(&format!("{stem}{letter}"));
        let quaternion = || Some([of("qx")?, of("qy")?, of("qz")?, of("qo")?]);
        let position = [of("X")?, of("Y")?, of("Z")?];
        Some(RecordedBody { name: letter.to_string(), position, quaternion: quaternion() })
    };
    let bodies: Vec<RecordedBody> = ('a'..='z').filter_map(body).collect();
    let time = TIME.map(|(name, seconds)| Some((head.column_of(name)?, seconds)));
    let expected = head.names.len();
    let mut days = 0.0;
    let frames = RecordedFrames::from_lines(text, (head.line, ("mm", 1e-3)), ',', |cells, _, before| {
        if cells.len() < expected {
            return Err(format!("found {} cells, expected {expected} as in the header", cells.len()));
        }
        let part = |it: Option<(usize, f64)>| it.and_then(|(at, seconds)| Some(seconds * number(cells.get(at)?)?));
        let time: Option<f64> = time.into_iter().map(part).sum();
        // The time of day restarts at midnight.
        if let (Some(time), Some(before)) = (time, before)
            && time + days + 43_200.0 < before
        {
            days += 86_400.0;
        }
        Ok(time.map(|it| it + days))
    })?;
    frames.table(&bodies, "tool", opening)
}
