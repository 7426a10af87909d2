//! A test of ISO 9283 from files to its JSON: commanded and measured poses of each row, figures, limits.

mod judge;
mod read;

pub use judge::{JudgedTest, StatedTest, judge_test};
pub use read::TestOptions;

use std::path::PathBuf;

use serde::Serialize;

use super::calibration_file::PoseEntry;
use super::record::Record;
use super::validation::ValidationInputs;
use poecal_calibrate::{Decision, FigureBounds, FigureLimit, Iso9283, JudgedFigure, TestFigure};
use poecal_numerics::error::Result;
use poecal_numerics::unit::Unit;

/// Name of the schema.
const SCHEMA: &str = "poecal-iso9283-1";

/// Frame in which accuracy is stated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TestFrame {
    /// Fitted to the barycentres.
    #[default]
    Unknown,
    /// The device measures in the base frame.
    Base,
    /// The device stands where the calibration had it.
    Calibration,
}

/// A figure with its interval, millimetres or degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoundsEntry {
    /// By the formula of the standard.
    pub found: f64,
    /// Lower end of its 95 % interval.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

/// A figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureEntry {
    /// Its symbol: `AP`, of angles `APa`.
    pub figure: String,
    /// Its clause in ISO 9283:1998.
    pub clause: &'static str,
    /// The pose, or both poses of a distance.
    pub pose: String,
    /// Number of cycles.
    pub cycles: usize,
    /// Unit of the numbers: `mm` or `deg`.
    pub unit: &'static str,
    /// As measured.
    #[serde(flatten)]
    pub measured: BoundsEntry,
    /// Without the stated noise of the instrument.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_noise: Option<BoundsEntry>,
    /// As measured before, in the rows of an earlier test.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<BoundsEntry>,
    /// Predicted for commands that are corrected by the calibration; beside an earlier test by its rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corrected: Option<BoundsEntry>,
}

/// A limit with its decision.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureLimitEntry {
    /// Symbol of the figure.
    pub figure: &'static str,
    /// Unit of the numbers: `mm` or `deg`.
    pub unit: &'static str,
    /// The limit.
    pub limit: f64,
    /// The largest figure of all poses, and the largest ends of intervals.
    #[serde(flatten)]
    pub worst: BoundsEntry,
    /// Decision on the limit.
    pub decision: Decision,
}

/// The frame of the device, and what its fit absorbed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestFrameEntry {
    /// Source of the frame: fitted or stated.
    pub known: TestFrame,
    /// Pose of the device in the robot's base.
    pub base_from_device: PoseEntry,
    /// Coordinates of all barycentres.
    pub coordinates: usize,
    /// Number of them that the fit absorbed.
    pub absorbed: usize,
}

/// A test of ISO 9283, as its JSON has it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestResult {
    /// Name and version of this schema.
    pub schema: &'static str,
    /// Version that computed it.
    pub poecal_version: &'static str,
    /// The files. The calibration is empty if there is none.
    pub inputs: ValidationInputs,
    /// Files of the test before, if there was one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reference: Vec<String>,
    /// Statements about the test: payload, instrument and so on.
    #[serde(skip_serializing_if = "Record::is_empty")]
    pub record: Record,
    /// Standard deviation of the instrument's noise in each position component, millimetres, if every row states it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_mm: Option<f64>,
    /// The device frame.
    pub frame: TestFrameEntry,
    /// Number of rows.
    pub rows: usize,
    /// Fewest cycles of a pose.
    pub cycles: usize,
    /// The figures.
    pub figures: Vec<FigureEntry>,
    /// The worst decision of all limits; absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decision: Option<Decision>,
    /// The limits.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<FigureLimitEntry>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
}

fn shown_paths(paths: &[PathBuf]) -> Vec<String> {
    paths.iter().map(|path| path.display().to_string()).collect()
}

impl BoundsEntry {
    fn new(bounds: &FigureBounds, unit: Unit) -> Self {
        let [found, from, to] = [bounds.found, bounds.from, bounds.to].map(|it| unit.in_shown_unit(it));
        BoundsEntry { found, from, to }
    }
}

impl FigureEntry {
    fn new(figure: &TestFigure) -> Self {
        let unit = figure.unit();
        let shown = |bounds: &FigureBounds| BoundsEntry::new(bounds, unit);
        FigureEntry {
            figure: figure.symbol(),
            clause: figure.name.clause(),
            pose: figure.pose.clone(),
            cycles: figure.cycles,
            unit: unit.symbol(),
            measured: shown(&figure.measured),
            without_noise: figure.without_noise.as_ref().map(shown),
            before: None,
            corrected: figure.corrected.as_ref().map(shown),
        }
    }
}

impl FigureLimitEntry {
    fn new(judged: &JudgedFigure) -> Self {
        let unit = judged.limit.unit;
        FigureLimitEntry {
            figure: judged.limit.name.symbol(),
            unit: unit.symbol(),
            limit: unit.in_shown_unit(judged.limit.most),
            worst: BoundsEntry::new(&judged.worst, unit),
            decision: judged.decision,
        }
    }
}

impl TestResult {
    /// A test with limits that its figures shall keep.
    ///
    /// # Errors
    /// As [`FigureLimit::judge`].
    pub fn new(
        found: &Iso9283,
        frame: TestFrame,
        limits: &[FigureLimit],
        inputs: ValidationInputs,
        record: Record,
    ) -> Result<Self> {
        let judged = limits.iter().map(|limit| limit.judge(&found.figures)).collect::<Result<Vec<_>>>()?;
        Ok(TestResult {
            schema: SCHEMA,
            poecal_version: env!("CARGO_PKG_VERSION"),
            inputs,
            reference: Vec::new(),
            record,
            noise_mm: found.noise[0].map(|it| 1e3 * it),
            frame: TestFrameEntry {
                known: frame,
                base_from_device: (&found.base_from_device).into(),
                coordinates: found.coordinates[0],
                absorbed: found.coordinates[1],
            },
            rows: found.rows,
            cycles: found.cycles,
            figures: found.figures.iter().map(FigureEntry::new).collect(),
            decision: judged.iter().map(|it| it.decision).max(),
            limits: judged.iter().map(FigureLimitEntry::new).collect(),
            warnings: found.warnings.clone(),
        })
    }

    /// The same beside an earlier test of the same commands, whose rows also predict the figures of corrected ones.
    ///
    /// # Errors
    /// As [`Iso9283::refuse_other_commands`].
    pub fn compare(&mut self, found: &Iso9283, earlier: &Iso9283) -> Result<()> {
        found.refuse_other_commands(earlier)?;
        let before: Vec<FigureEntry> = earlier.figures.iter().map(FigureEntry::new).collect();
        for own in &mut self.figures {
            let same = before.iter().find(|it| it.figure == own.figure && it.pose == own.pose && it.unit == own.unit);
            own.before = same.map(|it| it.measured);
            own.corrected = same.and_then(|it| it.corrected);
        }
        Ok(())
    }

    /// The text of its JSON.
    ///
    /// # Errors
    /// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if a number is not finite.
    pub fn to_text(&self) -> Result<String> {
        poecal_storage::json_text(self, "test")
    }
}
