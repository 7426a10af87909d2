//! Joins of files of joint readings with files of measurements: in words, as a picture, and pair by pair.

use maud::{Markup, PreEscaped, html};

use super::html::{HtmlTable, count, facts, figure, fold_table, path, plots, quote_text};
use crate::plot::{AxisScale, JoinPlot, JoinedEntry, JoinedList, PlotAxis, PlotLine};
use poecal_import::{InputEntry, Join, JoinEntry, MotionEntry, RowEntry};

/// Most pairs that the picture links: about every second pixel of its width.
const LINKS: usize = 180;
/// Most lines that are named in a fact.
const NAMED: usize = 20;
/// Most rows of the table of pairs.
const LISTED: usize = 200;
/// Names of the two lists of the picture.
const NAMES: [&str; 2] = ["robot", "measured"];
/// Irregularities of a row, with their style in the picture.
const ODDITIES: [(usize, &str); 2] = [(3, "without partner"), (2, "measured more than once")];

/// All joins; empty if each file contains both readings and measurements.
pub(crate) fn sections(joins: &[JoinEntry]) -> Markup {
    html! { @for (at, join) in joins.iter().enumerate() { (section(join, at)) } }
}

fn section(join: &JoinEntry, at: usize) -> Markup {
    let key = |name: &str| format!("inputs.joins.{at}.{name}");
    let how = match join.join {
        Join::Name => "by the names of their rows",
        Join::Rows => "row by row, in their order",
        Join::Time => "at the times of their stands",
        Join::Motion => "in motion, with lag and drift of the clocks as unknowns of the fit",
    };
    let what = if join.join == Join::Time && join.robot_motion.is_some() {
        ("stands of the robot", "of the measurements")
    } else {
        ("rows of joint readings", "measured configurations")
    };
    let files = html! {
        (path(&join.joints, key("joints"))) " and " (path(&join.measurements, key("measurements"))) ", " (how)
    };
    let pairs = html! {
        (count(join.paired, key("paired"))) ", of " (count(join.joint_rows, key("joint_rows"))) " " (what.0) " and "
        (count(join.measured_rows, key("measured_rows"))) " " (what.1)
    };
    let mut all = vec![("Joined", files), ("Pairs", pairs)];
    if let Some(missed) = join.missed_mm {
        all.push(("Nominal robot", html! { "misses them by " (figure(missed, key("missed_mm"))) " mm (median)" }));
    }
    if let Some(lag) = join.lag_s {
        all.push((
            "Lag",
            html! { (figure(lag, key("lag_s"))) " s: the clock of the measurements less that of the joint readings" },
        ));
    }
    for (name, rows) in [
        ("Nothing measured at", &join.unmeasured),
        ("Measured more than once", &join.repeated),
        ("Left out of the measurements", &join.unread),
    ] {
        if !rows.is_empty() {
            all.push((name, html! { (lines(rows)) }));
        }
    }
    let caption = if join.join == Join::Motion {
        "The speed of the nominal robot's tip beside that of what was measured, both by the clock of the joint readings. A line that is broken has lost \
         frames."
    } else if join.robot_motion.is_some() {
        "The speed of the nominal robot's tip beside that of what was measured, both by the clock of the joint readings; below, the stands of \
         both, and lines between those that are one configuration. A line that is broken has lost frames."
    } else {
        "The rows of both files in their order, and lines between those that are one configuration."
    };
    html! {
        h3 { "How the files were joined" }
        (facts(&all))
        (plots(&[PreEscaped(plot(join).svg())], caption))
        @if !join.pairs.is_empty() { (fold_table("The pairs as numbers", &table(join))) }
    }
}

/// Lines of rows, in words.
fn lines(rows: &[RowEntry]) -> String {
    let named: Vec<String> = rows.iter().take(NAMED).map(|it| it.line.to_string()).collect();
    let more = rows.len() - named.len();
    format!(
        "line{} {}{}",
        if rows.len() == 1 { "" } else { "s" },
        named.join(", "),
        if more > 0 { format!(" and {more} more") } else { String::new() }
    )
}

/// Pairs one after the other in both files, as one row of the table.
fn runs(join: &JoinEntry) -> Vec<([usize; 2], usize)> {
    let mut runs: Vec<([usize; 2], usize)> = Vec::new();
    for &[one, other] in &join.pairs {
        match runs.last_mut() {
            Some((first, count)) if first[0] + *count == one && first[1] + *count == other => *count += 1,
            _ => runs.push(([one, other], 1)),
        }
    }
    runs
}

fn table(join: &JoinEntry) -> HtmlTable {
    let what = if join.robot_motion.is_some() {
        ["stands of the robot", "stands of the measurements"]
    } else {
        ["joint readings", "measured"]
    };
    let mut table = HtmlTable::new(
        "Which belongs to which, by their numbers in the order of the files",
        3,
        &[what[0], what[1], "pairs"],
    );
    let range = |from: usize, count: usize| {
        if count == 1 { from.to_string() } else { format!("{from} to {}", from + count - 1) }
    };
    let runs = runs(join);
    for ([one, other], count) in runs.iter().take(LISTED) {
        table.row(&[&range(*one, *count), &range(*other, *count), count]);
    }
    if runs.len() > LISTED {
        table.row(&[&"…", &"…", &"the rest is in calibration.json"]);
    }
    table
}

/// The picture of a join.
fn plot(join: &JoinEntry) -> JoinPlot {
    let clocks = join.robot_motion.as_ref().zip(join.measured_motion.as_ref()).zip(join.lag_s);
    let (lists, lines, axis) = match clocks {
        Some(((robot, measured), lag_s)) => draw_in_time(join, robot, measured, lag_s),
        None => draw_by_number(join),
    };
    let links = link(join, &lists);
    JoinPlot {
        title: "What belongs to what".to_owned(),
        description: format!(
            "Joint readings above, measurements below, with lines between the {} pairs; the words beside and the table below state the same.",
            join.paired
        ),
        x: PlotAxis::new(axis, AxisScale::Linear),
        y: PlotAxis::new("speed, mm/s", AxisScale::Linear).with_values(&[0.0]),
        lines,
        lists,
        links,
        oddities: ODDITIES.to_vec(),
    }
}

/// Two lists, lines of speed, and the name of the axis.
type JoinDrawing = ([JoinedList; 2], Vec<PlotLine>, &'static str);

/// Irregularity of a row, as an index of the irregularities.
fn find_odd(join: &JoinEntry, measured: bool, number: usize) -> Option<usize> {
    let is_in = |rows: &[RowEntry], number: usize| rows.iter().any(|it| it.number == number);
    if measured {
        is_in(&join.unread, number).then_some(0)
    } else if is_in(&join.unmeasured, number) {
        Some(0)
    } else {
        is_in(&join.repeated, number).then_some(1)
    }
}

/// The rows of both files over time, with the speeds of both.
fn draw_in_time(join: &JoinEntry, robot: &MotionEntry, measured: &MotionEntry, lag_s: f64) -> JoinDrawing {
    let motions = [(robot, 0.0), (measured, measured.begin_s - lag_s - robot.begin_s)];
    let lines = motions.iter().enumerate().filter(|it| !it.1.0.speeds_mm_s.is_empty());
    let lines = lines.map(|(at, (motion, later))| speed(motion, *later, NAMES[at], at)).collect();
    let list = |at: usize| {
        let (motion, later) = motions[at];
        let entry = |(number, span): (usize, &[f64; 2])| JoinedEntry {
            from: span[0] + later,
            to: span[1] + later,
            odd: find_odd(join, at == 1, number),
        };
        let entries = (1..).zip(&motion.stands_s).map(entry).collect();
        JoinedList { name: NAMES[at].to_owned(), present: stream_times(motion, later), entries }
    };
    ([list(0), list(1)], lines, "time since the first joint reading, s")
}

/// The rows of both files by their numbers.
fn draw_by_number(join: &JoinEntry) -> JoinDrawing {
    let list = |at: usize, rows: usize| {
        let entry = |number: usize| JoinedEntry {
            from: number as f64,
            to: number as f64,
            odd: find_odd(join, at == 1, number),
        };
        JoinedList {
            name: NAMES[at].to_owned(),
            present: vec![[1.0, rows as f64]],
            entries: (1..=rows).map(entry).collect(),
        }
    };
    ([list(0, join.joint_rows), list(1, join.measured_rows)], Vec::new(), "number of the row in its file")
}

/// Lines between the pairs.
fn link(join: &JoinEntry, lists: &[JoinedList; 2]) -> Vec<[f64; 2]> {
    let middle = |at: usize, number: usize| {
        let entry = lists[at].entries.get(number.checked_sub(1)?)?;
        Some(0.5 * (entry.from + entry.to))
    };
    // For many pairs a selection, and those at which the order jumps.
    let step = join.pairs.len().div_ceil(LINKS).max(1);
    let jumps = |at: usize| {
        let of = |at: usize| join.pairs.get(at).map(|it| it[0] as f64 - it[1] as f64);
        at > 0 && of(at) != of(at - 1)
    };
    let drawn = (0..join.pairs.len()).filter(|at| at % step == 0 || jumps(*at)).take(2 * LINKS);
    drawn
        .filter_map(|at| {
            let [one, other] = *join.pairs.get(at)?;
            Some([middle(0, one)?, middle(1, other)?])
        })
        .collect()
}

/// Speeds in the middle of their steps.
fn speed(motion: &MotionEntry, later: f64, name: &str, style: usize) -> PlotLine {
    let points = (0..).zip(&motion.speeds_mm_s);
    let point =
        |(at, speed): (u32, &Option<f64>)| [(f64::from(at) + 0.5) * motion.step_s + later, speed.unwrap_or(f64::NAN)];
    PlotLine { name: name.to_owned(), style, points: points.map(point).collect() }
}

/// The intervals in which a stream has rows.
fn stream_times(motion: &MotionEntry, later: f64) -> Vec<[f64; 2]> {
    let mut found = Vec::with_capacity(motion.gaps_s.len() + 1);
    let mut from = 0.0;
    for [begin, end] in &motion.gaps_s {
        found.push([from + later, begin + later]);
        from = *end;
    }
    found.push([from + later, motion.end_s + later]);
    found
}

/// Used part of a file, which is the one with this number.
pub(crate) fn describe_taken(entry: &InputEntry, at: usize) -> Markup {
    let counts: Vec<String> = entry.taken.iter().map(|(name, count)| format!("{count} {name}")).collect();
    let mut words = vec![if counts.is_empty() { "nothing".to_owned() } else { counts.join(", ") }];
    words.extend((!entry.units.is_empty()).then(|| entry.units.join(", ")));
    let beams = if entry.lost == 1 { "beam" } else { "beams" };
    words.extend((entry.lost > 0).then(|| format!("{} {beams} lost", entry.lost)));
    html! {
        (words.join("; "))
        @if let Some(understood) = &entry.understood {
            "; " (quote_text(understood, format_args!("inputs.files.{at}.understood")))
        }
    }
}
