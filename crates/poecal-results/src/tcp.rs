//! `tcp.json`: position of a tool's tip with its bounds, and the texts of the files beside it.

use serde::Serialize;

use super::frame_entries::{FindingEntry, InputsEntry, VerdictEntry, name_of};
use super::frame_texts::{NamedFrame, ToolBounds, ToolForm, tool_forms};
use poecal_fit::hand_eye::{HandEyeLevel, TouchedTool};
use poecal_import::FlangePoses;
use poecal_numerics::error::Result;
use poecal_storage::json_text;

/// Version word of `tcp.json`.
pub const SCHEMA: &str = "poecal-tcp-1";

/// A tool with its input, for its files.
#[derive(Clone, Copy, Debug)]
pub struct ToolResult<'a> {
    /// The result.
    pub found: &'a TouchedTool,
    /// The touches.
    pub poses: &'a FlangePoses,
    /// The command that makes the same result; empty if there is none.
    pub command: &'a str,
}

#[derive(Serialize)]
struct TcpFile<'a> {
    schema: &'static str,
    poecal_version: &'static str,
    inputs: InputsEntry<'a>,
    verdict: VerdictEntry<'a>,
    tips: Vec<TipEntry<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    axis: Option<ToolAxisEntry>,
    tool: ToolEntry,
    touches: usize,
    fitted: usize,
    rms_mm: f64,
    sigma_mm: f64,
    outliers: Vec<&'a str>,
    findings: Vec<FindingEntry<'a>>,
}

#[derive(Serialize)]
struct TipEntry<'a> {
    name: &'a str,
    position_m: [f64; 3],
    bound95_mm: f64,
    sigma_mm: [f64; 3],
}

#[derive(Serialize)]
struct ToolAxisEntry {
    direction: [f64; 3],
    bound95_deg: f64,
}

#[derive(Serialize)]
struct ToolEntry {
    position_m: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    quaternion_xyzw: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    matrix: Option<[[f64; 4]; 4]>,
    controllers: String,
}

impl ToolResult<'_> {
    /// The tool's frame in the flange's.
    #[must_use]
    pub fn frame(&self) -> NamedFrame {
        NamedFrame { parent: "tool0".to_owned(), child: "tcp".to_owned(), pose: self.found.frame }
    }

    /// The tool in the forms of controllers; empty for one that is not to be used.
    #[must_use]
    pub fn forms(&self) -> Vec<ToolForm> {
        if self.found.level == HandEyeLevel::DoNotUse {
            return Vec::new();
        }
        let tip_m = self.found.tips.first().map_or(0.0, |it| it.placed.bound95_m);
        tool_forms(&self.found.frame, ToolBounds { tip_m, axis_rad: self.found.axis.map(|it| it.1) })
    }

    /// The forms as text, each under its remark.
    fn forms_text(&self) -> String {
        self.forms().iter().map(|it| format!("# {}\n{}\n", it.remark, it.text)).collect()
    }

    fn name(&self, row: usize) -> &str {
        name_of(&self.poses.names, row)
    }

    /// The contents of `tcp.json`.
    ///
    /// # Errors
    /// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if it cannot be written as JSON.
    pub fn to_text(&self) -> Result<String> {
        let found = self.found;
        let frame = self.frame();
        let file = TcpFile {
            schema: SCHEMA,
            poecal_version: env!("CARGO_PKG_VERSION"),
            inputs: InputsEntry {
                command: self.command,
                sha256: &self.poses.sha256,
                understood: &self.poses.understood,
            },
            verdict: VerdictEntry::new(found.level, &found.reasons),
            tips: found
                .tips
                .iter()
                .map(|it| TipEntry {
                    name: &it.name,
                    position_m: it.placed.pose.translation.into(),
                    bound95_mm: 1e3 * it.placed.bound95_m,
                    sigma_mm: (1e3 * it.placed.sigma_m).into(),
                })
                .collect(),
            axis: found.axis.map(|(direction, bound)| ToolAxisEntry {
                direction: direction.into(),
                bound95_deg: bound.to_degrees(),
            }),
            tool: ToolEntry {
                position_m: frame.pose.translation.into(),
                quaternion_xyzw: found.axis.map(|_| frame.pose.quaternion_xyzw()),
                matrix: found.axis.map(|_| frame.matrix()),
                controllers: self.forms_text(),
            },
            touches: found.rows.len(),
            fitted: found.rows.len() - found.outliers.len(),
            rms_mm: 1e3 * found.rms_m,
            sigma_mm: 1e3 * found.sigma_m,
            outliers: found.outliers.iter().map(|row| self.name(*row)).collect(),
            findings: FindingEntry::all(&found.findings, &self.poses.names),
        };
        json_text(&file, "result")
    }

    /// All files of a result beside `tcp.json`: names and texts.
    #[must_use]
    pub fn texts(&self) -> Vec<(&'static str, String)> {
        let mut rows = "row,name,fitted,miss[mm]\n".to_owned();
        for (row, error) in self.found.rows.iter().enumerate() {
            let name = poecal_storage::csv_text::cell(self.name(row));
            rows += &format!("{},{name},{},{:.6}\n", row + 1, u8::from(error.is_fitted), 1e3 * error.shift_m);
        }
        let frame = self.frame();
        let forms = if self.found.axis.is_some() { frame.short_forms() } else { frame.position_forms() };
        vec![("transforms.txt", forms + "\n" + &self.forms_text()), ("rows.csv", rows)]
    }
}
