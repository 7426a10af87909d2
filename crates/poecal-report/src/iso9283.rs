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
    let beside = if test.reference.is_empty() { "" } else { ", beside " };
    let files = format!("{}{beside}{}", test.inputs.measurements.join(", "), test.reference.join(", "));
    let standard = if test.cycles < STANDARD_CYCLES { ", fewer than the 30 of the standard" } else { "" };
    let words = format!("ISO 9283:1998, {} cycles{standard}; {} rows in {files}", test.cycles, test.rows);
    line(&mut out, "test", &words);
    let conditions = conditions(test);
    if !conditions.is_empty() {
        line(&mut out, "conditions", &conditions);
    }
    line(&mut out, "frame", &frame_words(test));
    for group in groups(test) {
        lines(&mut out, group.name.symbol(), group.lines());
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

/// Statements about the test.
fn conditions(test: &TestResult) -> String {
    let entries = test.record.entries();
    let words = entries.iter().map(|(_, label, text)| format!("{}: {text}", label.to_lowercase()));
    words.collect::<Vec<_>>().join("; ")
}

/// The frame in which accuracy is stated.
pub(crate) fn frame_words(test: &TestResult) -> String {
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
    sides_mm: [f64; 3],
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
            sides_mm: cube.sides_m.map(|it| 1e3 * it),
            cycles,
            poses: cube.poses.iter().enumerate().map(pose).collect(),
        }
    }

    /// Cube or plane, and its sides that are not zero, millimetres.
    fn shape(&self) -> (&'static str, String) {
        let sides: Vec<String> = self.sides_mm.iter().filter(|it| **it > 1e-3).map(|it| format!("{it:.0}")).collect();
        match sides.as_slice() {
            [across, up] => ("plane", format!("{across} × {up}")),
            _ => ("cube", sides.first().cloned().unwrap_or_default()),
        }
    }

    /// The shape and the number of cycles, in a few words.
    #[must_use]
    pub fn answer(&self) -> String {
        let (name, size) = self.shape();
        format!("{name} of {size} mm, {} cycles of P5 to P1", self.cycles)
    }

    /// The same as text of lines up to 80 characters.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = String::new();
        let [x, y, z] = self.middle_mm;
        let (name, size) = self.shape();
        let words = format!(
            "{size} mm along the base, middle at ({x:.0}, {y:.0}, {z:.0}) mm; all five poses within reach and limits (ISO 9283:1998, 6.8)"
        );
        line(&mut out, name, &words);
        for it in &self.poses {
            let [x, y, z] = it.position_mm;
            line(&mut out, &it.pose, &format!("({x:.1}, {y:.1}, {z:.1}) mm, the tip"));
        }
        let order = format!("{} cycles of P5, P4, P3, P2, P1, after warm-up, at one speed and load", self.cycles);
        line(&mut out, "order", &order);
        line(&mut out, "not checked", "collisions, and the paths between the poses: see both at low speed first");
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

/// Figures of one name and unit, each with its index in the JSON.
pub(crate) struct FigureGroup<'a> {
    pub(crate) name: FigureName,
    pub(crate) own: Vec<(usize, &'a FigureEntry)>,
}

/// A value of a figure, if it has one.
pub(crate) type FigureValue = fn(&FigureEntry) -> Option<BoundsEntry>;

/// Further values of a figure: words, short words and key.
pub(crate) const FURTHER: [(&str, &str, &str, FigureValue); 3] = [
    ("without the instrument's noise", "without noise", "without_noise", |it| it.without_noise),
    ("before", "before", "before", |it| it.before),
    ("predicted for corrected commands", "predicted", "corrected", |it| it.corrected),
];

/// The figures of a test by name and unit.
pub(crate) fn groups(test: &TestResult) -> Vec<FigureGroup<'_>> {
    let all = FigureName::ALL.into_iter().flat_map(|it| [(it.0, it.1, "mm"), (it.0, it.1, "deg")]);
    let group = |(name, symbol, unit): (FigureName, &str, &str)| {
        let is_own = |it: &&FigureEntry| it.unit == unit && it.figure.trim_end_matches(['a', 'b', 'c']) == symbol;
        let own = test.figures.iter().enumerate().filter(|(_, it)| is_own(it)).collect();
        FigureGroup { name, own }
    };
    all.map(group).filter(|it| !it.own.is_empty()).collect()
}

impl<'a> FigureGroup<'a> {
    /// The largest of a value: index, figure and value.
    pub(crate) fn largest(&self, value: FigureValue) -> Option<(usize, &'a FigureEntry, BoundsEntry)> {
        let all = self.own.iter().filter_map(|&(at, it)| Some((at, it, value(it)?)));
        all.max_by(|a, b| a.2.found.abs().total_cmp(&b.2.found.abs()))
    }

    /// Its place in words: `at P3`, `at P3 about c`, `from P2 to P4`.
    pub(crate) fn place(&self, of: &FigureEntry) -> String {
        if let Some((from, to)) = of.pose.split_once('-') {
            return format!("from {from} to {to}");
        }
        match of.figure.strip_prefix(self.name.symbol()) {
            None | Some("") => format!("at {}", of.pose),
            Some(axis) => format!("at {} about {axis}", of.pose),
        }
    }

    /// The largest with its interval, and further values, a line each.
    fn lines(&self) -> Vec<String> {
        let which = if self.own.len() > 1 { "largest " } else { "" };
        let first = self.largest(|it| Some(it.measured)).map(|(_, it, value)| {
            let (at, words, clause) = (self.place(it), self.name.words(), self.name.clause());
            format!("{}, {which}{at}: {words} ({clause})", bounds_words(&value, it.unit))
        });
        let further = FURTHER.iter().filter_map(|(words, _, _, value)| {
            let (_, it, found) = self.largest(*value)?;
            Some(format!("{} {words}, {}", bounds_words(&found, it.unit), self.place(it)))
        });
        first.into_iter().chain(further).collect()
    }
}

/// AP and RP of positions at each pose.
fn poses(out: &mut String, test: &TestResult) {
    let of = |symbol: &'static str| test.figures.iter().filter(move |it| it.figure == symbol && it.unit == "mm");
    out.push('\n');
    row(out, "position, mm", WIDTHS, ["AP", "from", "to", "RP", "from", "to"]);
    for (accuracy, repeatability) in of("AP").zip(of("RP")) {
        let cells = [accuracy.measured, repeatability.measured].map(|it| [it.found, it.from, it.to].map(number));
        row(out, &format!("  {}", accuracy.pose), WIDTHS, cells.concat());
    }
    for (words, value) in [("before, mm", FURTHER[1].3), ("corrected, mm", FURTHER[2].3)] {
        let all: Vec<_> = of("AP").filter_map(|it| Some((&it.pose, value(it)?))).collect();
        if !all.is_empty() {
            row(out, words, WIDTHS, ["AP", "from", "to"]);
        }
        for (pose, it) in all {
            row(out, &format!("  {pose}"), WIDTHS, [it.found, it.from, it.to].map(number));
        }
    }
}
