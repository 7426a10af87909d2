//! Tables that NDI's recorders write: the time of day in four columns, and up to 26 tools side by side (`Xa`, `Ya`, `Za`, `qoa`, `qxa`, …), in
//! millimetres, zeros where a tool was not seen.

use super::bodies::{Body, Frames};
use super::maker::{Made, Refused};
use super::words::{cells, lines, number};
use super::{Form, Opening};
use crate::Separator;

pub(crate) const FORM: Form = Form { title: "a recording of an NDI tracker", is_it, table };

const FIRST: usize = 10;
/// Columns of the time of day, with the seconds of one.
const TIME: [(&str, f64); 4] = [("Hour", 3600.0), ("Minutes", 60.0), ("Seconds", 1.0), ("ms", 1e-3)];

fn header(text: &str) -> Option<(usize, Vec<&str>)> {
    let is_header = |names: &[&str]| ["Xa", "Ya", "Za", "qoa"].iter().all(|it| names.contains(it));
    lines(text)
        .take(FIRST)
        .map(|(line, it)| (line, cells(it, Separator::Comma)))
        .find(|(_, it)| is_header(it))
}

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    header(text).is_some()
}

fn table(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let Some((line, names)) = header(text) else { return Refused::whole("found no header") };
    let at = |name: &str| names.iter().position(|it| *it == name);
    let mut bodies = Vec::new();
    for letter in 'a'..='z' {
        let of = |stem: &str| at(&format!("{stem}{letter}"));
        let ([Some(x), Some(y), Some(z)], turned) =
            (["X", "Y", "Z"].map(of), ["qx", "qy", "qz", "qo"].map(of))
        else {
            continue;
        };
        let quaternion = match turned {
            [Some(x), Some(y), Some(z), Some(w)] => Some([x, y, z, w]),
            _ => None,
        };
        bodies.push(Body { name: letter.to_string(), position: [x, y, z], quaternion });
    }
    let mut frames = Frames::of(("mm", 1e-3), line);
    let mut days = 0.0;
    for (line, content) in lines(text).filter(|it| it.0 > line) {
        let found: Vec<&str> = content.split(',').map(str::trim).collect();
        if found.len() < names.len() {
            return Refused::at(
                line,
                format!("found {} cells, expected {} as in the header", found.len(), names.len()),
            );
        }
        let part = |(name, factor): (&str, f64)| Some(factor * number(found.get(at(name)?)?)?);
        let time: Option<f64> = TIME.into_iter().map(part).sum();
        // The time of day begins anew at midnight.
        let before = frames.times.last().copied().flatten();
        if let (Some(time), Some(before)) = (time, before)
            && time + days + 43_200.0 < before
        {
            days += 86_400.0;
        }
        frames.times.push(time.map(|it| it + days));
        frames.rows.push((line, found));
    }
    frames.table(&bodies, "tool", opening)
}
