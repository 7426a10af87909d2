//! Text of a `residuals.csv`, made in pieces by all threads and written in the order of the rows.

use std::fmt::Write as _;
use std::io::Write;
use std::ops::Range;

use super::rows::{
    CornerErrors, DIAGNOSTICS, FIRST, INSTRUMENT, MODELS, ModelErrors, Residuals, RowDiagnostics, columns,
    corner_columns,
};
use super::source::RowSource;
use poecal_calibrate::Calibration;
use poecal_model::measurement::{Dataset, MeasuredQuantities, Quantity};
use poecal_numerics::threads;
use poecal_storage::csv_text::cell;
use poecal_storage::numbers::push_number;

/// Rows of one work item.
const PIECE: usize = 256;
/// Most pieces waiting to be written.
const TOGETHER: usize = 8;
/// Approximate bytes per row.
const ROW: usize = 480;

/// Rows to write.
#[derive(Clone, Copy, Debug)]
pub enum ResidualRows<'a> {
    /// Existing rows.
    AtHand(&'a Residuals),
    /// Rows of a finished calibration, computed while they are written, since there may be many.
    Of(&'a Dataset, &'a Calibration),
}

impl ResidualRows<'_> {
    /// Writes the text of the file in pieces.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn write_to(self, out: &mut (dyn Write + Send)) -> std::io::Result<()> {
        match self {
            ResidualRows::AtHand(residuals) => {
                out.write_all(head(residuals).as_bytes())?;
                let make = |rows| text(residuals, rows);
                in_pieces(residuals.rows.len(), make, |piece| out.write_all(piece.as_bytes()))
            }
            ResidualRows::Of(data, calibration) => {
                let source = RowSource::new(data, calibration);
                out.write_all(head(&source.rows(0..0)).as_bytes())?;
                let worked_out = |rows: Range<usize>| {
                    let some = source.rows(rows);
                    text(&some, 0..some.rows.len())
                };
                in_pieces(data.len(), worked_out, |piece| out.write_all(piece.as_bytes()))
            }
        }
    }
}

/// Passes on the results of `make` for consecutive ranges of rows: all threads compute some while earlier ones are consumed.
pub(crate) fn in_pieces<T: Send, E: Send>(
    rows: usize,
    make: impl Fn(Range<usize>) -> T + Sync + Send,
    mut take: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let some = |first: usize| {
        let pieces = (rows - first).div_ceil(PIECE).min(TOGETHER);
        threads::map_parts(pieces, |piece| {
            let begin = first + piece * PIECE;
            make(begin..rows.min(begin + PIECE))
        })
    };
    let mut firsts = (0..rows).step_by(PIECE * TOGETHER);
    let mut made = firsts.next().map(some).unwrap_or_default();
    for first in firsts {
        let (taken, next) = threads::run_both(|| made.into_iter().try_for_each(&mut take), || some(first));
        taken?;
        made = next;
    }
    made.into_iter().try_for_each(take)
}

/// The line of column names.
fn head(residuals: &Residuals) -> String {
    let quantities = residuals.quantities().flat_map(|quantity| columns(quantity, residuals.has_corrected));
    let corners = residuals.has_corners.then(|| corner_columns(residuals.has_corrected)).into_iter().flatten();
    let names = FIRST.map(str::to_owned).into_iter().chain(quantities).chain(corners);
    let names = names.chain(DIAGNOSTICS.map(str::to_owned));
    let mut text = names.collect::<Vec<_>>().join(",");
    for (name, kind) in &residuals.readings {
        text.push(',');
        text.push_str(&cell(&format!("{name}[{}]", kind.symbol())));
    }
    if !residuals.stations.is_empty() {
        text.push(',');
        text.push_str(INSTRUMENT);
    }
    text.push('\n');
    text
}

/// The lines of some rows.
fn text(residuals: &Residuals, range: Range<usize>) -> String {
    let files: Vec<_> = residuals.files.iter().map(|name| cell(name)).collect();
    let targets: Vec<_> = residuals.targets.iter().map(|name| cell(name)).collect();
    let stations: Vec<_> = residuals.stations.iter().map(|name| cell(name)).collect();
    let quantities: Vec<_> = residuals.quantities().collect();
    let mut text = String::with_capacity(range.len() * ROW);
    for (index, row) in range.clone().zip(residuals.rows.get(range).unwrap_or_default()) {
        text.push_str(files.get(row.file).map_or("", |name| name));
        let _ = write!(text, ",{},", row.line);
        text.push_str(&cell(&row.id));
        text.push_str(if row.held_out { ",held_out," } else { ",fit," });
        text.push_str(targets.get(row.target).map_or("", |name| name));
        let has_corrected = residuals.has_corrected;
        quantities.iter().for_each(|&it| push_errors(&mut text, (it, has_corrected), &row.errors));
        if residuals.has_corners {
            push_corners(&mut text, row.corners.as_ref(), has_corrected);
        }
        match &row.judged {
            Some(RowDiagnostics { weight, leverage, studentized, suspected }) => {
                [*weight, *leverage, *studentized].into_iter().for_each(|number| push_cell(&mut text, number));
                text.push_str(if *suspected { ",1" } else { ",0" });
            }
            None => text.push_str(",,,,"),
        }
        residuals.values(index).iter().for_each(|&value| push_cell(&mut text, value));
        if !stations.is_empty() {
            text.push(',');
            text.push_str(stations.get(row.station).map_or("", |name| name));
        }
        text.push('\n');
    }
    text
}

/// Empty cells, as many as a quantity has at most.
const EMPTY: &str = ",,,,,,,";
const _: () = assert!(EMPTY.len() == MODELS + 1 + Quantity::MOST_COMPONENTS);

/// The cells of a quantity, empty if it was not measured.
fn push_errors(
    out: &mut String,
    (quantity, has_corrected): (Quantity, bool),
    errors: &MeasuredQuantities<ModelErrors>,
) {
    let cells = MODELS + usize::from(has_corrected) + quantity.components();
    let mut empty = cells;
    if let Some(errors) = errors.get(quantity) {
        let models = errors.models.len() + usize::from(has_corrected);
        for (at, value) in errors.numbers().take(cells).enumerate() {
            if at >= models && value.is_nan() {
                out.push(',');
            } else {
                push_cell(out, value);
            }
            empty -= 1;
        }
    }
    out.push_str(EMPTY.get(..empty).unwrap_or_default());
}

/// The cells of the corners, empty for a row that is no picture.
fn push_corners(out: &mut String, corners: Option<&CornerErrors>, has_corrected: bool) {
    let numbers: Vec<f64> = corners.map_or_else(Vec::new, |it| it.numbers().collect());
    for at in 0..=MODELS + usize::from(has_corrected) {
        match numbers.get(at) {
            Some(&number) if !number.is_nan() => push_cell(out, number),
            _ => out.push(','),
        }
    }
}

fn push_cell(out: &mut String, number: f64) {
    out.push(',');
    push_number(out, number);
}
