//! The table of a test of ISO 9283.

use poecal_calibrate::{FigureName, STANDARD_CYCLES};
use poecal_results::iso9283::{BoundsEntry, FigureEntry, TestFrame, TestResult};

use poecal_arm::lie::Pose;
use poecal_plan::plan::TestCube;
use serde::Serialize;

use super::table::{line, lines, number, row};

/// Widths of the label and of each cell.
const WIDTHS: [usize; 2] = [14, 11];

/// A test as text of lines up to 80 characters: the largest figures with their intervals, then all poses.
#[must_use]
pub fn iso9283(test: &TestResult) -> String {
    let mut out = String::new();
    let files = test.inputs.measurements.join(", ");
    let standard = if test.cycles < STANDARD_CYCLES { ", fewer than the 30 of the standard" } else { "" };
    let words = format!("ISO 9283:1998, {} cycles{standard}; {} rows in {files}", test.cycles, test.rows);
    line(&mut out, "test", &words);
    let conditions = conditions(test);
    if !conditions.is_empty() {
        line(&mut out, "conditions", &conditions);
    }
    line(&mut out, "frame", &frame_words(test));
    for (name, symbol, clause, words) in FigureName::ALL {
        for unit in ["mm", "deg"] {
            let is_own =
                |it: &&FigureEntry| it.unit == unit && it.figure.trim_end_matches(['a', 'b', 'c']) == symbol;
            let own: Vec<&FigureEntry> = test.figures.iter().filter(is_own).collect();
            if !own.is_empty() {
                lines(&mut out, symbol, figure_lines(name, &own, &format!("{words} ({clause})")));
            }
        }
    }
    for limit in &test.limits {
        let BoundsEntry { found, from, to } = limit.worst;
        let words = format!(
            "{}: {} {} {unit}, between {} and {} {unit} with 95 % confidence; the limit is {} {unit}",
            limit.decision.words(),
            limit.figure,
            number(found),
            number(from),
            number(to),
            super::acceptance::format_limit(limit.limit),
            unit = limit.unit
        );
        line(&mut out, "acceptance", &words);
    }
    poses(&mut out, test);
    out
}

/// The largest AP and RP of positions with their intervals, in a sentence.
#[must_use]
pub fn iso9283_answer(test: &TestResult) -> String {
    let largest = |symbol: &str| {
        let own = test.figures.iter().filter(|it| it.figure == symbol && it.unit == "mm");
        let it = own.max_by(|a, b| a.measured.found.total_cmp(&b.measured.found))?;
        Some(format!("{symbol} {} at {}", bounds_words(&it.measured, it.unit), it.pose))
    };
    let words: Vec<String> = ["AP", "RP"].into_iter().filter_map(largest).collect();
    format!("{}; {} cycles", words.join(", "), test.cycles)
}

/// What is stated of the test.
fn conditions(test: &TestResult) -> String {
    let entries = test.record.entries();
    let mut words: Vec<String> =
        entries.iter().map(|(_, label, text)| format!("{}: {text}", label.to_lowercase())).collect();
    if !test.speed.is_empty() {
        words.insert(0, format!("speed: {}", test.speed));
    }
    words.join("; ")
}

/// The frame in which accuracy is stated.
fn frame_words(test: &TestResult) -> String {
    let (all, absorbed) = (test.frame.coordinates, test.frame.absorbed);
    match test.frame.known {
        TestFrame::Base => "the base, in which the device measures".to_owned(),
        TestFrame::Calibration => "the base, with the device where the calibration has it".to_owned(),
        TestFrame::Unknown => {
            let ratio = (all as f64 / (all.saturating_sub(absorbed).max(1)) as f64).sqrt();
            format!(
                "fitted to the barycentres, which absorbs {absorbed} of their {all} coordinates and the mean orientation: in a stated frame AP is about {ratio:.2} times as large"
            )
        }
    }
}

/// A planned test, for JSON and terminal.
#[derive(Clone, Debug, Serialize)]
pub struct TestPlan {
    middle_mm: [f64; 3],
    side_mm: f64,
    cycles: usize,
    poses: Vec<TestPlanPose>,
}

/// A pose of a planned test.
#[derive(Clone, Debug, Serialize)]
struct TestPlanPose {
    pose: String,
    position_mm: [f64; 3],
    readings: Vec<f64>,
}

impl TestPlan {
    /// A cube that is visited so often.
    #[must_use]
    pub fn new(cube: &TestCube, cycles: usize) -> Self {
        let pose = |(at, (pose, readings)): (usize, &(Pose, Vec<f64>))| TestPlanPose {
            pose: format!("P{}", at + 1),
            position_mm: (1e3 * pose.translation).into(),
            readings: readings.clone(),
        };
        TestPlan {
            middle_mm: cube.middle_m.map(|it| 1e3 * it),
            side_mm: 1e3 * cube.side_m,
            cycles,
            poses: cube.poses.iter().enumerate().map(pose).collect(),
        }
    }

    /// The same as text of lines up to 80 characters.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        let [x, y, z] = self.middle_mm;
        let cube = format!(
            "{:.0} mm along the base, middle at ({x:.0}, {y:.0}, {z:.0}) mm; all five poses within reach and limits (ISO 9283:1998, 6.8)",
            self.side_mm
        );
        line(&mut out, "cube", &cube);
        for it in &self.poses {
            let [x, y, z] = it.position_mm;
            line(&mut out, &it.pose, &format!("({x:.1}, {y:.1}, {z:.1}) mm, the tip"));
        }
        let order =
            format!("{} cycles of P5, P4, P3, P2, P1, after warm-up, at one speed and load", self.cycles);
        line(&mut out, "order", &order);
        line(
            &mut out,
            "not checked",
            "collisions, and the paths between the poses: see both at low speed first",
        );
        out
    }
}

/// A number with its sign.
fn format_signed(value: f64) -> String {
    if value < 0.0 { format!("-{}", number(-value)) } else { number(value) }
}

fn bounds_words(bounds: &BoundsEntry, unit: &str) -> String {
    let BoundsEntry { found, from, to } = *bounds;
    format!("{} {unit} ({} to {})", format_signed(found), format_signed(from), format_signed(to))
}

/// The largest of a figure, without noise and corrected.
fn figure_lines(name: FigureName, own: &[&FigureEntry], words: &str) -> Vec<String> {
    let largest = |of: fn(&FigureEntry) -> Option<BoundsEntry>| {
        let size = |it: &FigureEntry| of(it).map_or(-1.0, |it| it.found.abs());
        let it = own.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let axis = it.figure.strip_prefix(name.symbol()).unwrap_or_default();
        let about = if axis.is_empty() { String::new() } else { format!(" about {axis}") };
        let at = if it.pose.contains('-') {
            format!("from {}", it.pose.replace('-', " to "))
        } else {
            format!("at {}", it.pose)
        };
        Some((bounds_words(&of(it)?, it.unit), format!("{at}{about}")))
    };
    let which = if own.len() > 1 { "largest " } else { "" };
    let mut all: Vec<String> = largest(|it| Some(it.measured))
        .into_iter()
        .map(|(it, at)| format!("{it}, {which}{at}: {words}"))
        .collect();
    all.extend(
        largest(|it| it.without_noise).map(|(it, at)| format!("{it} without the instrument's noise, {at}")),
    );
    all.extend(
        largest(|it| it.corrected).map(|(it, at)| format!("{it} predicted for corrected commands, {at}")),
    );
    all
}

/// AP and RP of positions at each pose.
fn poses(out: &mut String, test: &TestResult) {
    let of =
        |symbol: &'static str| test.figures.iter().filter(move |it| it.figure == symbol && it.unit == "mm");
    out.push('\n');
    row(out, "position, mm", WIDTHS, ["AP", "from", "to", "RP", "from", "to"]);
    for (accuracy, repeatability) in of("AP").zip(of("RP")) {
        let cells =
            [accuracy.measured, repeatability.measured].map(|it| [it.found, it.from, it.to].map(number));
        row(out, &format!("  {}", accuracy.pose), WIDTHS, cells.concat());
    }
    let corrected: Vec<_> = of("AP").filter_map(|it| Some((&it.pose, it.corrected?))).collect();
    if !corrected.is_empty() {
        row(out, "corrected, mm", WIDTHS, ["AP", "from", "to"]);
        for (pose, it) in corrected {
            row(out, &format!("  {pose}"), WIDTHS, [it.found, it.from, it.to].map(number));
        }
    }
}
