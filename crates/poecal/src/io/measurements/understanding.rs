//! What was understood of a file, for the user to check.

use std::path::PathBuf;

use serde::Serialize;

use super::cells::Separator;
use super::header::Header;
use super::inputs::{Input, Range, Source};
use super::layout::{Layout, SetRule};
use super::lost::LostBeams;
use super::mapping::PoseDirection;
use super::number::DecimalSign;
use super::units::UnitSource;

/// What one of our columns was read from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnUnderstanding {
    /// Our name: `joint1`, `x`, `smr1 x`, …
    pub name: String,
    /// The file's column, as in its header, or the sum of columns that the mapping asks for; none for a constant of the mapping.
    pub column: Option<String>,
    /// Symbol of the unit; none for text and pure numbers.
    pub unit: Option<&'static str>,
    /// Where the unit came from; none without unit.
    pub unit_from: Option<UnitSource>,
    /// Smallest value, metres or radians; none for text and for a column of empty cells.
    pub min: Option<f64>,
    /// Largest value, metres or radians.
    pub max: Option<f64>,
}

/// How a file was understood. Serialised, it is what `poecal check --json` prints.
///
/// ```
/// use poecal::io::measurements::FileUnderstanding;
/// fn ignored(file: &FileUnderstanding) -> String {
///     format!("{}: {} rows, left alone: {}", file.path.display(), file.rows, file.ignored.join(", "))
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileUnderstanding {
    /// The file, as the user named it.
    pub path: PathBuf,
    /// Rows of the file, those of lost beams too.
    pub rows: usize,
    /// Position-only measurements.
    pub points: usize,
    /// Measurements with orientation.
    pub poses: usize,
    /// Lost beams: measurements without a position, which were left out.
    pub lost: LostBeams,
    /// What stands between two cells.
    pub separator: Separator,
    /// The line that states the separator, as `sep=;`; none if no line does.
    pub separator_line: Option<usize>,
    /// The line of units below the header; none if there is none.
    pub units_line: Option<usize>,
    /// What stands before the decimals.
    pub decimal_sign: DecimalSign,
    /// Our columns and what they were read from.
    pub columns: Vec<ColumnUnderstanding>,
    /// How orientation columns give a rotation; none without orientation.
    pub orientation: Option<String>,
    /// Which way the file's poses point: `device_from_target`, or `target_from_device` if they were inverted.
    pub pose: &'static str,
    /// Columns that were left alone.
    pub ignored: Vec<String>,
}

/// Our columns and what they were read from.
pub(super) fn columns(header: &Header<'_>, layout: &Layout, ranges: &[Range]) -> Vec<ColumnUnderstanding> {
    let text_of = |index: usize| header.cells.get(index).map(|cell| cell.text.clone());
    let number = |(input, range): (&Input, &Range)| {
        let has_unit = input.unit.symbol() != "1";
        ColumnUnderstanding {
            name: input.name.clone(),
            column: match input.source {
                Source::Column(_) if !input.sum.is_empty() => Some(input.label.clone()),
                Source::Column(index) => text_of(index),
                Source::Constant(_) => None,
            },
            unit: has_unit.then_some(input.unit.symbol()),
            unit_from: has_unit.then_some(input.unit_from),
            min: range.0.map(|(min, _)| min),
            max: range.0.map(|(_, max)| max),
        }
    };
    let text = |name: &str, index: Option<usize>| {
        let column = Some(text_of(index?)?);
        let name = name.to_owned();
        Some(ColumnUnderstanding { name, column, unit: None, unit_from: None, min: None, max: None })
    };
    let set = match layout.set {
        SetRule::Unstated => None,
        SetRule::Words(index) | SetRule::Where(index, _) => Some(index),
    };
    let texts = [
        text("target", layout.target_column),
        text("instrument", layout.instrument),
        text("id", layout.id),
        text("set", set),
    ];
    layout.inputs.iter().zip(ranges).map(number).chain(texts.into_iter().flatten()).collect()
}

/// The orientation forms of the targets, each once.
pub(super) fn orientation(layout: &Layout) -> Option<String> {
    let mut forms: Vec<String> = Vec::new();
    for (form, _) in layout.targets.iter().filter_map(|target| target.orientation.as_ref()) {
        let form = form.to_string();
        if !forms.contains(&form) {
            forms.push(form);
        }
    }
    (!forms.is_empty()).then(|| forms.join("; "))
}

/// The word for a pose's direction.
pub(super) fn pose_word(pose: PoseDirection) -> &'static str {
    match pose {
        PoseDirection::DeviceFromTarget => "device_from_target",
        PoseDirection::TargetFromDevice => "target_from_device",
    }
}
