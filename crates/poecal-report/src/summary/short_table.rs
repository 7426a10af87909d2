//! The table in few lines: the verdict, the figures, their domain, points of attention. All else is named and left out.

use super::review_points::{PointSource, look_at};
use crate::table::{INDENT, WIDTH, lines};
use poecal_calibrate::{Decision, Level};
use poecal_results::calibration_file::CalibrationFile;

/// Lines of the table, beside those that state the omissions, the next step and the path of the results.
const LINES: usize = 11;
/// Lines of the table at least, however much was printed before it.
const FEWEST: usize = 7;
/// Lines under a label of verdict, errors and range.
const PARAGRAPH: usize = 5;
/// Parts that are left out and named; at least as many more are counted.
const NAMED: usize = 3;
/// Labels that keep all their lines: a verdict with its remedy, repairs, figures, and requested limits.
const WHOLE: [&str; 4] = ["verdict", "repaired", "expected", "acceptance"];
/// Importance of points and of labels; others, on verdict, errors and range, are always there.
const FIRST_POINTS: usize = 1;
const POINTS: usize = 3;
const RANKS: [(usize, &[&str]); 3] = [
    (2, &["held out", "fitted", "found"]),
    (4, &["determined", "undetermined"]),
    (5, &["corrected", "target", "tip", "held", "corners", "gravity", "terms", "clock"]),
];

/// Lines under one label.
struct LabelledLines {
    label: String,
    text: Vec<String>,
    rank: usize,
    is_shown: bool,
}

/// The short table of a calibration.
pub struct ShortTable {
    /// The lines.
    pub table: String,
    /// The parts that it leaves out, on one line.
    pub left: String,
    /// The next step, by the verdict.
    pub next: Option<&'static str>,
}

/// The short table, after `said` printed lines.
pub(super) fn short_table(file: &CalibrationFile, said: usize) -> ShortTable {
    let mut blocks = blocks(file);
    choose(&mut blocks, LINES.saturating_sub(said).max(FEWEST));
    let (mut out, mut label) = (String::new(), "");
    for block in blocks.iter().filter(|it| it.is_shown) {
        for (k, text) in block.text.iter().enumerate() {
            let head = if k == 0 && label != block.label { block.label.as_str() } else { "" };
            out.push_str(format!("{head:<INDENT$}{text}").trim_end());
            out.push('\n');
        }
        label = &block.label;
    }
    let points = blocks.iter().filter(|it| !it.is_shown && it.label == "look at").count();
    let mut left = Vec::new();
    if points > 0 {
        left.push(format!("{points} more to look at"));
    }
    let others = blocks.iter().filter(|it| !it.is_shown && it.label != "look at");
    left.extend(others.map(|it| it.label.clone()).chain(["noise", "solver", "joints"].map(str::to_owned)));
    let named = left.len().min(NAMED);
    let more = left.len() - named;
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    ShortTable { table: out, left: left[..named].join(", ") + &more, next: next(file) }
}

/// The next step.
fn next(file: &CalibrationFile) -> Option<&'static str> {
    match file.acceptance.as_ref().map(|it| it.decision) {
        Some(Decision::Fail) => return Some("the limits of --accept are not met: see acceptance"),
        Some(Decision::NotShown) => {
            return Some("measure more rows: they do not show whether the limits are met");
        }
        Some(Decision::Pass) | None => {}
    }
    Some(match file.verdict.as_ref()?.level {
        Level::Good => "export or compensate puts it on the robot, track watches it",
        Level::InsideSampledRange => "use it inside the sampled range; plan --keep-rows extends that",
        Level::MeasuredConfigurations => "use it in such configurations only; plan --keep-rows adds others",
        Level::Located => "use the located frames; axes need more rows: plan",
        Level::DoNotUse => "read the report, mend what is named, and calibrate again",
    })
}

/// All blocks of the table, in its order; each point to look at is one.
fn blocks(file: &CalibrationFile) -> Vec<LabelledLines> {
    let [mut top, mut rest] = [String::new(), String::new()];
    super::top(&mut top, file);
    super::rest(&mut rest, file);
    let mut all = parsed(&top);
    for (k, point) in look_at(file).into_iter().enumerate() {
        let is_doubt =
            matches!(point.place, PointSource::Suspicion(_) | PointSource::Diagnosis(_) | PointSource::Warning(_));
        let mut text = String::new();
        lines(&mut text, "look at", [&point.text]);
        let rank = if k == 0 || is_doubt { FIRST_POINTS } else { POINTS };
        all.extend(parsed(&text).into_iter().map(|block| LabelledLines { rank, ..block }));
    }
    all.extend(parsed(&rest));
    all
}

/// Labelled lines as blocks.
fn parsed(table: &str) -> Vec<LabelledLines> {
    let mut blocks: Vec<LabelledLines> = Vec::new();
    for line in table.lines() {
        let (label, text) = line.split_at(line.floor_char_boundary(INDENT));
        match (label.trim(), blocks.last_mut()) {
            ("", Some(block)) => block.text.push(text.to_owned()),
            (label, _) => {
                let rank = RANKS.iter().find(|(_, labels)| labels.contains(&label)).map_or(0, |(rank, _)| *rank);
                blocks.push(LabelledLines {
                    label: label.to_owned(),
                    text: vec![text.to_owned()],
                    rank,
                    is_shown: rank == 0,
                });
            }
        }
    }
    blocks
}

/// Decides which lines are shown, by importance, and shortens paragraphs.
fn choose(blocks: &mut [LabelledLines], lines: usize) {
    for block in blocks.iter_mut().filter(|it| it.rank == 0 && it.label != "acceptance") {
        shorten(&mut block.text, PARAGRAPH);
    }
    let mut used: usize = blocks.iter().filter(|it| it.rank == 0).map(|it| it.text.len()).sum();
    while used >= lines {
        let stated = blocks.iter_mut().filter(|it| it.rank == 0 && it.text.len() > 1);
        let stated = stated.filter(|it| !WHOLE.contains(&it.label.as_str()));
        let Some(block) = stated.max_by_key(|it| (it.label == "before", it.text.len())) else { break };
        let most = block.text.len() - 1;
        shorten(&mut block.text, most);
        used -= 1;
    }
    let mut room = lines.saturating_sub(used).max(1);
    share_room(blocks, &mut room);
    for rank in FIRST_POINTS + 1..=RANKS.len() + 2 {
        for block in blocks.iter_mut().filter(|it| it.rank == rank) {
            if block.label == "look at" {
                shorten(&mut block.text, room.max(1));
            }
            block.is_shown = block.text.len() <= room;
            room -= if block.is_shown { block.text.len() } else { 0 };
        }
    }
}

/// Assigns the first points their lines: each has one before any has a second.
fn share_room(blocks: &mut [LabelledLines], room: &mut usize) {
    let mut points: Vec<&mut LabelledLines> = blocks.iter_mut().filter(|it| it.rank == FIRST_POINTS).collect();
    let mut given = vec![0; points.len()];
    let longest = points.iter().map(|it| it.text.len()).max().unwrap_or_default();
    for line in 0..longest {
        for (point, given) in points.iter().zip(&mut given) {
            if *room > 0 && point.text.len() > line {
                *given += 1;
                *room -= 1;
            }
        }
    }
    for (point, given) in points.iter_mut().zip(given) {
        point.is_shown = given > 0;
        shorten(&mut point.text, given);
    }
}

/// The first few lines of a paragraph.
fn shorten(text: &mut Vec<String>, most: usize) {
    if text.len() <= most {
        return;
    }
    text.truncate(most);
    if let Some(last) = text.last_mut() {
        while last.chars().count() + 2 > WIDTH - INDENT {
            let end = last.rfind(' ').unwrap_or(0);
            last.truncate(end);
        }
        last.push_str(" …");
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::{Detail, summary};
    use super::*;
    use poecal_calibrate::{CalibrationOptions, calibrate};
    use poecal_model::simulate::{GrossErrors, SessionKind, Simulation, elbow};
    use poecal_results::calibration_file::Inputs;

    /// Summaries of good and of spoilt sessions have few lines, each of them from the whole table, and omitted points are counted.
    #[test]
    fn the_short_table_is_short_and_says_what_it_leaves_out() {
        for (count, kind, share) in [
            (40, SessionKind::POSE, 0.0),
            (60, SessionKind::POINT, 0.2),
            (30, SessionKind::POINT, 0.1),
            (25, SessionKind::MIXED, 0.0),
        ] {
            let mut made = Simulation { count, ..Simulation::default() }.run(&elbow(), kind).unwrap();
            GrossErrors { share, ..GrossErrors::default() }.spoil(&mut made.data);
            let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
            let mut file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
            file.warnings.extend((0..7).map(|k| format!("{k}{}", " a warning of many words".repeat(9))));
            let [short, full] = [Detail::Short, Detail::Full].map(|detail| summary(&file, detail));
            let ShortTable { table, left, next } = short_table(&file, 3);
            assert!(table.lines().count() <= LINES - 3, "{table}");
            println!("{short}{left:?} {next:?}\n");
            assert!(
                short.lines().count() <= LINES && short.lines().all(|line| line.chars().count() <= WIDTH),
                "{short}"
            );
            let is_there = |line: &str| full.contains(line.trim_end_matches(" …"));
            assert!(short.lines().all(is_there) && short.contains("look at       "), "{short}\n{full}");
            assert!(left.contains(" more to look at, ") && next.is_some());
        }
    }
}
