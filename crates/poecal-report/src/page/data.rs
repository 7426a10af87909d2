//! What the script of the page works on, as JSON.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::BTreeMap;

use serde::Serialize;

use super::frames::{FrameData, Frames, draws_instruments};
use super::lead::{Lead, component_words, sign};
use super::shapes::{MeshData, ShapeData};
use super::{reading_index, readings_of, short};
use poecal_model::measurement::Quantity;
use poecal_model::robot::{JointKind, Situation, Term};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::text::visible;
use poecal_results::calibration_file::{CalibrationFile, ScrewEntry};
use poecal_results::residuals::{ResidualRow, Residuals};
use poecal_results::shapes::Shapes;

/// Rows that charts draw at most; how many of them are chosen for being suspected, and for being far off.
pub(crate) const MOST_ROWS: usize = 4000;
const SUSPECTED: usize = 400;
const WORST: usize = 100;
/// Digits of numbers that are drawn.
const DIGITS: i32 = 6;
/// The largest power of ten that is exact.
const EXACT: i32 = 22;

#[derive(Serialize)]
struct Data<'a> {
    joints: Vec<JointData<'a>>,
    tip: FrameData<'a>,
    targets: Vec<FrameData<'a>>,
    instruments: Vec<FrameData<'a>>,
    draws_instruments: bool,
    readings: Vec<ReadingData<'a>>,
    /// The error that is told of each row, in its unit.
    lead: LeadData,
    rows: RowData,
    /// How many rows there are.
    count: usize,
    /// What the links look like; where it is not said, the picture makes its own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shapes: Vec<ShapeData<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    meshes: Vec<MeshData<'a>>,
}

#[derive(Serialize)]
struct JointData<'a> {
    name: Cow<'a, str>,
    kind: JointKind,
    /// The joint on whose link it stands; none for the base.
    on: Option<usize>,
    screw: &'a ScrewEntry,
    nominal_screw: &'a ScrewEntry,
    origin_m: [f64; 3],
    limits: Option<[f64; 2]>,
    sampled: Option<[f64; 2]>,
    reading: usize,
    multiplier: f64,
    offset: f64,
    /// Factor and shift of the joint's value by its terms, of the calibrated and the nominal model; missing without terms.
    #[serde(skip_serializing_if = "Option::is_none")]
    terms: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nominal_terms: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct LeadData {
    name: String,
    unit: &'static str,
}

#[derive(Serialize)]
struct ReadingData<'a> {
    name: Cow<'a, str>,
    unit: &'static str,
}

/// The drawn rows, by column.
#[derive(Default, Serialize)]
struct RowData {
    /// Number in the order read, from 1.
    number: Vec<usize>,
    place: Vec<String>,
    held_out: Vec<u8>,
    /// Whether the row is one of the evenly chosen, which stand for all.
    even: Vec<u8>,
    suspected: Vec<u8>,
    target: Vec<usize>,
    /// None if there is only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    instrument: Option<Vec<usize>>,
    /// The error that is told of each row, in the unit of `lead`: millimetres, unless no length was measured.
    error_mm: Vec<Option<f64>>,
    /// Residuals of the quantities that any row measured, in the axes of the row's instrument.
    residuals: Vec<ResidualData>,
    leverage: Vec<Option<f64>>,
    studentized: Vec<Option<f64>>,
    values: Vec<Vec<f64>>,
}

/// Residuals of a quantity, by component; of vectors in the axes of the row's instrument.
#[derive(Serialize)]
struct ResidualData {
    #[serde(skip)]
    quantity: Quantity,
    name: &'static str,
    unit: &'static str,
    components: Vec<ComponentData>,
}

#[derive(Serialize)]
struct ComponentData {
    name: String,
    values: Vec<Option<f64>>,
}

/// The data, safe within a script element.
pub(crate) fn json(file: &CalibrationFile, residuals: &Residuals, shapes: &Shapes) -> Result<String> {
    let robot = file.robot()?;
    let joints = file.joints.iter().enumerate().map(|(k, joint)| {
        let sampled = file.coverage.iter().find(|found| found.joint == joint.name);
        JointData {
            name: visible(&joint.name),
            kind: joint.kind,
            on: robot.body_before(k).joint(),
            screw: &joint.screw,
            nominal_screw: &joint.nominal_screw,
            origin_m: joint.base_from_joint.position_m,
            limits: joint.limits,
            sampled: sampled.map(|found| [found.sampled_min, found.sampled_max]),
            reading: reading_index(residuals, &joint.reading.name).unwrap_or_default(),
            multiplier: joint.reading.multiplier,
            offset: joint.reading.offset,
            terms: straight(&joint.terms),
            nominal_terms: straight(&joint.nominal_terms),
        }
    });
    let frames = Frames::of(file, &robot, residuals)?;
    let lead = Lead::of(residuals);
    let reading = |(_, name, unit)| ReadingData { name: visible(name), unit };
    let data = Data {
        joints: joints.collect(),
        tip: frames.tip,
        targets: frames.targets,
        instruments: frames.instruments,
        draws_instruments: draws_instruments(file),
        readings: readings_of(residuals).map(reading).collect(),
        lead: LeadData { name: lead.name(), unit: lead.unit() },
        rows: RowData::of(residuals, &lead),
        count: residuals.rows().len(),
        shapes: shapes.shapes.iter().map(ShapeData::of).collect(),
        meshes: shapes.meshes.iter().map(MeshData::of).collect(),
    };
    let text = serde_json::to_string(&data)
        .map_err(|error| ErrorKind::Export.error(format!("the report's data cannot be written: {error}")))?;
    // Within a script element, `</script` and `<!--` would be markup wherever they stand.
    Ok(text.replace('<', "\\u003c"))
}

/// Keeps so many items that come first, in any order.
pub(crate) fn keep_first<T>(items: &mut Vec<T>, most: usize, compare: impl FnMut(&T, &T) -> Ordering) {
    if items.len() > most {
        items.select_nth_unstable_by(most, compare);
        items.truncate(most);
    }
}

/// The rows that are drawn, in order, and whether each is one of the evenly chosen.
pub(crate) fn drawn(residuals: &Residuals) -> Vec<(usize, bool)> {
    let count = residuals.rows().len();
    if count <= MOST_ROWS {
        return (0..count).map(|row| (row, true)).collect();
    }
    let suspected = |row: usize| residuals.rows().get(row)?.judged.map(|judged| judged.suspected);
    let lead = Lead::of(residuals);
    let error = |row: usize| residuals.rows().get(row).and_then(|row| lead.error(row)).unwrap_or_default();
    let (mut worst, mut others): (Vec<usize>, Vec<usize>) =
        (0..count).partition(|&row| suspected(row) == Some(true));
    for (rows, most) in [(&mut worst, SUSPECTED), (&mut others, WORST)] {
        keep_first(rows, most, |&a, &b| error(b).total_cmp(&error(a)).then(a.cmp(&b)));
    }
    worst.extend(others);
    let evenly = MOST_ROWS - SUSPECTED - WORST;
    let mut rows: Vec<(usize, bool)> = (0..evenly).map(|k| (k * count / evenly, true)).collect();
    rows.extend(worst.into_iter().map(|row| (row, false)));
    // A row that is both counts as evenly chosen.
    rows.sort_unstable_by_key(|&(row, even)| (row, !even));
    rows.dedup_by_key(|found| found.0);
    rows
}

impl RowData {
    fn of(residuals: &Residuals, lead: &Lead) -> Self {
        let mut rows = RowData {
            residuals: residuals.measured().into_iter().map(ResidualData::new).collect(),
            instrument: (!residuals.stations.is_empty()).then(Vec::new),
            ..RowData::default()
        };
        rows.values = vec![Vec::new(); residuals.readings.len()];
        for (index, even) in drawn(residuals) {
            if let Some(row) = residuals.rows().get(index) {
                rows.push(residuals, (index, row, even), lead.error(row));
            }
        }
        rows
    }

    fn push(
        &mut self,
        residuals: &Residuals,
        (index, row, even): (usize, &ResidualRow, bool),
        error: Option<f64>,
    ) {
        self.number.push(index + 1);
        self.place.push(visible(&place(residuals, index)).into_owned());
        self.held_out.push(u8::from(row.held_out));
        self.even.push(u8::from(even));
        self.suspected.push(u8::from(row.judged.is_some_and(|judged| judged.suspected)));
        self.target.push(row.target);
        if let Some(instrument) = &mut self.instrument {
            instrument.push(row.station);
        }
        self.error_mm.push(error.map(rounded));
        self.residuals.iter_mut().for_each(|residual| residual.push(row));
        self.leverage.push(row.judged.map(|judged| rounded(judged.leverage)).filter(|it| it.is_finite()));
        self.studentized
            .push(row.judged.map(|judged| rounded(judged.studentized)).filter(|it| it.is_finite()));
        for (column, &value) in self.values.iter_mut().zip(residuals.values(index)) {
            column.push(rounded(value));
        }
    }
}

impl ResidualData {
    fn new(quantity: Quantity) -> Self {
        let components = (0..quantity.components())
            .map(|k| ComponentData { name: component_words(quantity, k), values: Vec::new() });
        let (name, unit) = (quantity.name(), sign(quantity.unit()));
        ResidualData { quantity, name, unit, components: components.collect() }
    }

    fn push(&mut self, row: &ResidualRow) {
        let errors = row.errors.get(self.quantity);
        for (k, component) in self.components.iter_mut().enumerate() {
            let value = errors.as_ref().and_then(|errors| errors.residual().get(k)).copied();
            component.values.push(value.filter(|value| !value.is_nan()).map(rounded));
        }
    }
}

/// Factor and shift of a joint's value by its terms, as a straight line through the values at 0 and 1.
fn straight(terms: &BTreeMap<Term, f64>) -> Option<[f64; 2]> {
    let at = |value: f64| -> f64 {
        value + terms.iter().map(|(term, c)| c * Situation::of(&[value]).basis(0, *term)).sum::<f64>()
    };
    (!terms.is_empty()).then(|| [at(1.0) - at(0.0), at(0.0)])
}

/// As many digits as a picture can show. A whole number of that many digits over a power of ten that is exact rounds as text does, in
/// 25 ns instead of 450: 1,500 rows of 15 columns take 0.6 ms instead of 10, where all else of the page takes 1.
fn rounded(value: f64) -> f64 {
    let places = (DIGITS - 1).saturating_sub(value.abs().log10().floor() as i32);
    if !(0..=EXACT).contains(&places) {
        return format!("{value:.*e}", DIGITS as usize - 1).parse().unwrap_or(value);
    }
    let scale = 10_f64.powi(places);
    (value * scale).round_ties_even() / scale
}

/// The place of a row: its file and line, or its number.
pub(crate) fn place(residuals: &Residuals, index: usize) -> String {
    let Some(row) = residuals.rows().get(index) else { return String::new() };
    match residuals.file(row) {
        "" => format!("row {}", index + 1),
        file => format!("{}:{}", short(&residuals.files, file), row.line),
    }
}
