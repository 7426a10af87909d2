//! Interpretation of a file, for the user to check.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Serialize;

use super::cells::Separator;
use super::cursor::Cursor;
use super::inputs::{InputSource, RowInput, ValueRange};
use super::layout::{ColumnLayout, SetRule};
use super::mapping::PoseDirection;
use super::number::DecimalSign;
use crate::table::FileTable;
use poecal_numerics::named_unit::UnitSource;
use poecal_numerics::text::NamedLines;

/// Source of a column of our form.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnUnderstanding {
    /// Name in our form: `joint1`, `x`, `smr1 x`, …
    pub name: String,
    /// The file's column, or sum of columns; `None` for a constant of the mapping.
    pub column: Option<String>,
    /// Symbol of the unit; `None` for text and pure numbers.
    pub unit: Option<&'static str>,
    /// Source of the unit; `None` without unit.
    pub unit_from: Option<UnitSource>,
    /// Smallest value, metres or radians; `None` for text and empty columns.
    pub min: Option<f64>,
    /// Largest value, metres or radians.
    pub max: Option<f64>,
}

/// Interpretation of a file, as printed by `poecal check --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileUnderstanding {
    /// File name as passed by the user.
    pub path: PathBuf,
    /// Title of a file in another form than ours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub form: Option<&'static str>,
    /// Interpretation of a file in another form, in a few words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub understood: Option<String>,
    /// Number of rows, including beam breaks.
    pub rows: usize,
    /// Number of position-only measurements.
    pub points: usize,
    /// Number of measurements with orientation.
    pub poses: usize,
    /// Number of other measurements, by their quantity.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub others: BTreeMap<&'static str, usize>,
    /// Beam breaks: measurements without a position, which were omitted.
    pub lost: NamedLines,
    /// Separator of cells.
    pub separator: Separator,
    /// Line that states the separator, as `sep=;`; `None` if there is none.
    pub separator_line: Option<usize>,
    /// Line of units below the header; `None` if there is none.
    pub units_line: Option<usize>,
    /// Decimal sign.
    pub decimal_sign: DecimalSign,
    /// Columns of our form with their sources.
    pub columns: Vec<ColumnUnderstanding>,
    /// Form of the orientation columns; `None` without orientation.
    pub orientation: Option<String>,
    /// Direction of the file's poses: `device_from_target`, or `target_from_device` if they were inverted.
    pub pose: &'static str,
    /// Ignored columns.
    pub ignored: Vec<String>,
}

impl FileUnderstanding {
    /// The interpretation of a table, with its number of rows; the numbers of measurements follow.
    pub(crate) fn new(table: &FileTable<'_>, cursor: &Cursor<'_>, rows: usize) -> Self {
        FileUnderstanding {
            path: table.header.path.to_path_buf(),
            form: table.form(),
            understood: table.understood_form(),
            rows,
            points: 0,
            poses: 0,
            others: BTreeMap::new(),
            lost: NamedLines::default(),
            separator: table.separator,
            separator_line: table.separator_line,
            units_line: table.header.units_line,
            decimal_sign: cursor.numbers.sign(),
            columns: columns(table, &cursor.layout, &cursor.ranges),
            orientation: orientation(&cursor.layout),
            pose: match cursor.layout.pose {
                PoseDirection::DeviceFromTarget => "device_from_target",
                PoseDirection::TargetFromDevice => "target_from_device",
            },
            ignored: cursor.layout.ignored.iter().map(|(name, _)| name.clone()).collect(),
        }
    }
}

/// Columns of our form with their sources.
fn columns(table: &FileTable<'_>, layout: &ColumnLayout, ranges: &[ValueRange]) -> Vec<ColumnUnderstanding> {
    let (header, sources) = (&table.header, table.sources());
    let text_of = |index: usize| {
        let own = &header.cells.get(index)?.text;
        Some(sources.and_then(|it| it.get(own)).unwrap_or(own).clone())
    };
    let number = |(input, range): (&RowInput, &ValueRange)| {
        let has_unit = input.unit.symbol() != "1";
        ColumnUnderstanding {
            name: input.name.clone(),
            column: match input.source {
                InputSource::Column(_) if !input.sum.is_empty() => Some(input.label.clone()),
                InputSource::Column(index) => text_of(index),
                InputSource::Constant(_) => None,
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
    let mut places: Vec<usize> = layout
        .targets
        .iter()
        .flat_map(|target| &target.kinds)
        .flat_map(|kind| kind.places.iter().chain(&kind.word).copied())
        .collect();
    places.sort_unstable();
    places.dedup();
    let places = places.into_iter().filter_map(|at| text(header.cells.get(at)?.name.as_str(), Some(at)));
    let texts = [
        text("target", layout.target_column),
        text("instrument", layout.instrument),
        text("pair", layout.pair),
        text("id", layout.id),
        text("set", set),
    ];
    let texts = texts.into_iter().flatten().chain(places);
    layout.inputs.iter().zip(ranges).map(number).chain(texts).collect()
}

/// Orientation forms of the targets, without repetition.
pub(crate) fn orientation(layout: &ColumnLayout) -> Option<String> {
    let mut forms: Vec<String> = Vec::new();
    for (form, _) in layout.targets.iter().filter_map(|target| target.orientation.as_ref()) {
        let form = form.to_string();
        if !forms.contains(&form) {
            forms.push(form);
        }
    }
    (!forms.is_empty()).then(|| forms.join("; "))
}
