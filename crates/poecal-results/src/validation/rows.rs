//! `errors.csv`: the error of each judging row beside its predicted uncertainty.

use super::in_file_units;
use poecal_calibrate::JudgedRow;
use poecal_model::measurement::{Dataset, Quantity};
use poecal_model::robot::{ReadingKind, Robot};
use poecal_storage::csv_text::cell;
use poecal_storage::numbers::push_number;

/// First columns; those of each quantity follow, then the joint readings.
const FIRST: &str = "file,line,id,target,inside_sampled_range";

/// The rows of a judgement with their data.
#[derive(Clone, Copy, Debug)]
pub struct JudgedRows<'a> {
    /// The measurements.
    pub data: &'a Dataset,
    /// The robot, which determines the units of the readings.
    pub robot: &'a Robot,
    /// The errors, in the order of the measurements.
    pub rows: &'a [JudgedRow],
}

impl JudgedRows<'_> {
    /// The quantities that some row measured.
    #[must_use]
    pub fn measured_quantities(&self) -> Vec<Quantity> {
        Quantity::ALL.into_iter().filter(|quantity| self.data.has(*quantity)).collect()
    }

    /// The line of column names.
    fn head(&self, quantities: &[Quantity], kinds: &[ReadingKind]) -> String {
        let mut out = FIRST.to_owned();
        for quantity in quantities {
            let (name, unit) = (quantity.name(), quantity.unit().symbol());
            for what in ["error", "expected", "bound95"] {
                out.push_str(&format!(",{name}_{what}[{unit}]"));
            }
            for component in quantity.component_names() {
                out.push_str(&format!(",{component}[{unit}]"));
            }
        }
        if !self.data.pictures.is_empty() {
            out.push_str(",corners[px],corners[mm]");
        }
        for (name, kind) in self.data.reading_names().iter().zip(kinds) {
            out.push(',');
            out.push_str(&cell(&format!("{name}[{}]", kind.symbol())));
        }
        if self.data.station_count() > 1 {
            out.push_str(",instrument");
        }
        out.push('\n');
        out
    }

    /// The text of the file.
    #[must_use]
    pub fn text(&self) -> String {
        let quantities = self.measured_quantities();
        let names = self.data.reading_names();
        let kinds: Vec<_> = names.iter().map(|name| self.robot.reading_kind(name)).collect();
        let has_stations = self.data.station_count() > 1;
        let has_pictures = !self.data.pictures.is_empty();
        let mut out = self.head(&quantities, &kinds);
        for (k, (row, observation)) in self.rows.iter().zip(&self.data.observations).enumerate() {
            let file = self.data.files.get(observation.source.file as usize);
            let file = file.map(|path| path.display().to_string()).unwrap_or_default();
            let id = self.data.ids.get(k).map_or("", String::as_str);
            let target = self.data.targets.get(observation.target).and_then(Option::as_deref);
            let inside = if row.inside_sampled_range { "yes" } else { "no" };
            let (file, id, target) = (cell(&file), cell(id), cell(target.unwrap_or_default()));
            out.push_str(&format!("{file},{},{id},{target},{inside}", observation.source.line));
            for quantity in &quantities {
                let found = row.errors.get(*quantity);
                let numbers = found.map_or([None; 3], |found| in_file_units(*quantity, found));
                let components = (0..quantity.components()).map(|k| {
                    let value = quantity.unit().in_shown_unit(*found.as_ref()?.residual.get(k)?);
                    Some(value).filter(|value| !value.is_nan())
                });
                for number in numbers.into_iter().chain(components) {
                    out.push(',');
                    number.into_iter().for_each(|number| push_number(&mut out, number));
                }
            }
            if has_pictures {
                for number in [row.corners.map(|it| it.rms_px), row.corners.map(|it| it.rms_mm)] {
                    out.push(',');
                    number.into_iter().for_each(|number| push_number(&mut out, number));
                }
            }
            for (value, kind) in self.data.readings(k).iter().zip(&kinds) {
                out.push(',');
                push_number(&mut out, kind.in_shown_unit(*value));
            }
            if has_stations {
                let name = self.data.stations.get(observation.station).and_then(Option::as_deref);
                out.push(',');
                out.push_str(&cell(name.unwrap_or_default()));
            }
            out.push('\n');
        }
        out
    }
}
