//! Changes between two calibrations of one robot.

use std::fmt::Write as _;

use serde::Serialize;

use super::summary::{Detail, LeadingRows, expected_summary};
use super::table::{line, number, number_or_dash};
use poecal_model::robot::Robot;
use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::{CalibrationFile, JointChangeEntry};
use poecal_results::compare::{CalibrationComparison, ChiSquare, ComparedJoint};

/// Two calibrations compared, for a person to look over or a machine to read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonReport {
    first: SideEntry,
    second: SideEntry,
    /// True if the tip moved by more than the limit; null without a limit.
    moved: Option<bool>,
    /// True if more changed than noise explains; null without the uncertainty of both.
    changed: Option<bool>,
    /// Names of the joints that changed by more than noise.
    changed_joints: Vec<String>,
    test: Option<TestEntry>,
    joints: Vec<ComparedJointEntry>,
    base: &'static str,
    tip: ComparedTipEntry,
}

/// A calibration: its accuracy.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct SideEntry {
    calibration: String,
    model: String,
    measurements: Vec<String>,
    /// The rows that judge: held out, or fitted if none was held out.
    rows: &'static str,
    count: usize,
    quantity: &'static str,
    unit: &'static str,
    /// Root mean square error of each model.
    rms: Vec<ModelEntry>,
    /// Expected error as its verdict states it, millimetres (RMS); null if no use is advised.
    expected_mm: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct ModelEntry {
    model: String,
    rms: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct TestEntry {
    chi_square: f64,
    freedom: usize,
    limit: f64,
    changed: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct ComparedJointEntry {
    name: String,
    /// Change from nominal to the first.
    first: Option<JointChangeEntry>,
    /// Change from nominal to the second.
    second: Option<JointChangeEntry>,
    /// Change from the first to the second.
    change: JointChangeEntry,
    test: Option<TestEntry>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct ComparedTipEntry {
    configurations: usize,
    /// The model by which tips are compared.
    model: &'static str,
    rms_mm: f64,
    max_mm: f64,
    rms_deg: f64,
    max_at: Vec<ReadingEntry>,
    max_place_mm: [f64; 3],
    /// Distance (RMS) up to which the robot is unchanged.
    limit_mm: Option<f64>,
    /// True if the limit was stated; otherwise it is the expected errors of both together.
    limit_is_stated: bool,
}

/// A reading of the configuration of the largest difference: degrees or millimetres.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ReadingEntry {
    reading: String,
    value: f64,
    unit: &'static str,
}

impl From<ChiSquare> for TestEntry {
    fn from(test: ChiSquare) -> Self {
        TestEntry { chi_square: test.value, freedom: test.freedom, limit: test.limit, changed: test.is_change() }
    }
}

impl SideEntry {
    fn new((name, file): (&str, &CalibrationFile)) -> Self {
        let leading = LeadingRows::from_calibration(file);
        let set = leading.set;
        let quantity = set.calibrated.leading_value().map(|(quantity, _)| quantity);
        let rms = leading
            .rows()
            .into_iter()
            .filter_map(|(model, errors, _)| Some(ModelEntry { model, rms: errors.get(quantity?)?.rms }));
        SideEntry {
            calibration: name.to_owned(),
            model: file.inputs.model.clone(),
            measurements: file.inputs.measurements.clone(),
            rows: if file.accuracy.held_out.is_some() { "held out" } else { "fitted" },
            count: set.count,
            quantity: quantity.map_or("", |it| it.name()),
            unit: quantity.map_or("", |it| it.unit().symbol()),
            rms: rms.collect(),
            expected_mm: expected_summary(file).map(|it| it.error_mm),
        }
    }
}

impl SideEntry {
    fn words(&self) -> String {
        let expected = self.expected_mm.map_or_else(String::new, |it| format!(": expected error {} mm", number(it)));
        format!("{}{expected}", self.calibration)
    }
}

impl ComparisonReport {
    /// Comparison of two calibrations by their names.
    ///
    /// # Errors
    /// [`ErrorKind::Model`](poecal_numerics::error::ErrorKind::Model) if a file holds no valid robot.
    pub fn new(
        first: (&str, &CalibrationFile),
        second: (&str, &CalibrationFile),
        found: &CalibrationComparison,
    ) -> poecal_numerics::error::Result<Self> {
        let robot = first.1.robot()?;
        let correction = |file: &CalibrationFile, name: &str| {
            file.corrections.iter().find(|it| it.joint == name).and_then(|it| it.change.clone())
        };
        let joint = |it: &ComparedJoint| ComparedJointEntry {
            name: it.name.clone(),
            first: correction(first.1, &it.name),
            second: correction(second.1, &it.name),
            change: JointChangeEntry::from(&it.change),
            test: it.test.map(TestEntry::from),
        };
        Ok(ComparisonReport {
            moved: found.is_moved(),
            changed: found.is_change(),
            changed_joints: found.changed_joints().map(|it| it.name.clone()).collect(),
            test: found.test.map(TestEntry::from),
            joints: found.joints.iter().map(joint).collect(),
            base: if found.base_is_free { "free" } else { "kept" },
            tip: ComparedTipEntry {
                configurations: found.tip.configurations,
                model: if found.tip.is_corrected { "corrected" } else { "calibrated" },
                rms_mm: 1e3 * found.tip.rms_m,
                max_mm: 1e3 * found.tip.max_m,
                rms_deg: found.tip.rms_rad.to_degrees(),
                max_at: found.tip.max_at.iter().map(|(name, value)| ReadingEntry::new(&robot, name, *value)).collect(),
                max_place_mm: (1e3 * found.tip.max_place).into(),
                limit_mm: found.tip.limit_m.map(|it| 1e3 * it),
                limit_is_stated: found.tip.limit_is_stated,
            },
            first: SideEntry::new(first),
            second: SideEntry::new(second),
        })
    }

    /// As text of lines up to 80 characters (except for longer names): the answer, and in full each joint with its test.
    #[must_use]
    pub fn text(&self, detail: Detail) -> String {
        let mut out = String::new();
        line(&mut out, "verdict", &self.answer());
        line(&mut out, "largest", &self.tip.words());
        line(&mut out, "first", &self.first.words());
        line(&mut out, "second", &self.second.words());
        if detail == Detail::Short {
            line(&mut out, "more", "--verbose: each joint, its test against noise, the errors of both");
            return out;
        }
        out.push('\n');
        line(&mut out, "noise", &self.noise());
        out.push('\n');
        self.accuracy(&mut out);
        out.push('\n');
        for joint in &self.joints {
            line(&mut out, "joint", &format!("{}{}", escape_invisible(&joint.name), joint.test_words()));
            let both = [("first", &joint.first), ("second", &joint.second)];
            for (name, change) in both {
                if let Some(change) = change {
                    line(&mut out, &format!("  {name}"), &change.words);
                }
            }
            line(&mut out, "  change", &joint.change.words);
        }
        out.push('\n');
        let words = if self.base == "free" {
            "base and tool of the second are fitted to the first, since calibrations choose them"
        } else {
            "the base is kept, the tool of the second is fitted to the first"
        };
        line(&mut out, "compared", words);
        out
    }

    /// Motion of the tip, and its comparison with the limit, in a sentence.
    #[must_use]
    pub fn answer(&self) -> String {
        let rms = number(self.tip.rms_mm);
        let moved = format!("the tip moved by {rms} mm (RMS) in the range that both sampled");
        match (self.moved, self.tip.limit_mm) {
            (Some(moves), Some(limit)) => {
                let answer = if moves { "no longer good" } else { "still good" };
                let which = if self.tip.limit_is_stated { "" } else { ", the expected errors of both together" };
                format!("{answer}: {moved} (limit {} mm{which})", number(limit))
            }
            _ => format!("unknown: {moved}, and a calibration has no expected error: state a --limit"),
        }
    }

    /// Decision whether the changes are more than noise.
    fn noise(&self) -> String {
        let Some(test) = self.test else {
            return "unknown: a calibration has no uncertainty, so that noise and change are not distinguishable"
                .to_owned();
        };
        let numbers =
            format!("χ² {:.1} of {} degrees of freedom, noise up to {:.1}", test.chi_square, test.freedom, test.limit);
        match self.changed {
            Some(true) if self.changed_joints.is_empty() => {
                format!("changed significantly, in no single joint ({numbers})")
            }
            Some(true) => format!("changed significantly: {} ({numbers})", self.changed_joints.join(", ")),
            _ => format!("no change beyond noise ({numbers})"),
        }
    }

    /// The errors of both, side by side.
    fn accuracy(&self, out: &mut String) {
        let (one, other) = (&self.first, &self.second);
        let title = format!("{} error, {} (RMS)", one.quantity, one.unit);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{title:<42}{:>13}{:>13}", "first", "second");
        let mut names: Vec<&str> = one.rms.iter().map(|it| it.model.as_str()).collect();
        names.extend(
            other.rms.iter().map(|it| it.model.as_str()).filter(|it| !one.rms.iter().any(|own| own.model == *it)),
        );
        let of = |side: &SideEntry, name: &str| {
            let is_same = (side.quantity, side.unit) == (one.quantity, one.unit);
            let found = side.rms.iter().find(|it| it.model == name).map(|it| it.rms);
            number_or_dash(found.filter(|_| is_same))
        };
        for name in names {
            let _ = writeln!(out, "  {name:<40}{:>13}{:>13}", of(one, name), of(other, name));
        }
        let [a, b] = [one, other].map(|it| number_or_dash(it.expected_mm));
        let _ = writeln!(out, "  {:<40}{a:>13}{b:>13}", "expected, mm");
        let [a, b] = [one, other].map(|it| format!("{} {}", it.count, it.rows));
        let _ = writeln!(out, "  {:<40}{a:>13}{b:>13}", "rows");
    }
}

impl ReadingEntry {
    fn new(robot: &Robot, name: &str, value: f64) -> Self {
        let kind = robot.reading_kind(name);
        ReadingEntry { reading: name.to_owned(), value: kind.in_shown_unit(value), unit: kind.suffix() }
    }
}

impl ComparedJointEntry {
    fn test_words(&self) -> String {
        let Some(test) = self.test else { return String::new() };
        let words = if test.changed { "changed by more than noise" } else { "no change beyond noise" };
        format!(": {words} (χ² {:.1}, noise up to {:.1})", test.chi_square, test.limit)
    }
}

impl ComparedTipEntry {
    fn words(&self) -> String {
        let at = self.max_at.iter().map(|it| format!("{} {:.1} {}", it.reading, it.value, it.unit));
        let at: Vec<String> = at.map(|it| it.trim_end().to_owned()).collect();
        format!(
            "{} mm at {}, by the {} models in {} random configurations; {} deg (RMS)",
            number(self.max_mm),
            at.join(", "),
            self.model,
            self.configurations,
            number(self.rms_deg)
        )
    }
}
