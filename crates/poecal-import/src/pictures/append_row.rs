//! Addition of the measurements of a row to the session.

use std::borrow::Cow;

use crate::FrameGrouping;
use crate::read::MeasurementReader;
use crate::table::cursor::Cursor;
use crate::table::kinds::KindColumns;
use crate::table::layout::{ColumnLayout, SetRule};
use crate::table::row::{component_noise, measurement};
use crate::table::targets::TargetLayout;
use crate::table::{FileRow, beam_breaks};
use poecal_model::measurement::{Measurement, NoiseShape, Observation, Quantity, RowLocation, Set, StatedDeviations};
use poecal_model::robot::check_name;
use poecal_numerics::error::Result;

impl MeasurementReader<'_> {
    /// Takes the measurements of a row.
    pub(crate) fn row(&mut self, row: &FileRow<'_>, inputs: &Cursor<'_>) -> Result<()> {
        let layout = &inputs.layout;
        let set = self.set(row, layout)?;
        for target in &layout.targets {
            let may_be_missing = layout.targets.len() > 1;
            let how = (may_be_missing, self.options.strict);
            if let Some(measurement) = measurement(row, target, layout.pose, inputs, how)? {
                let mut stated = StatedDeviations::default();
                stated.set(Quantity::Position, inputs.sigma(row, target.sigma_position)?);
                stated.set(Quantity::Rotation, inputs.sigma(row, target.sigma_rotation)?);
                let shape = component_noise(row, target, inputs, &measurement)?.and_then(NoiseShape::by_component);
                if let (Some(_), Some(input)) = (&shape, target.sigma_position) {
                    let message =
                        "found `sigma_position` beside standard deviations of the components, expected one of the two";
                    return Err(row.error(inputs.column(input), message));
                }
                self.observation(row, (target, set, None), (measurement, stated), inputs)?;
                if let Some(shape) = shape {
                    self.found.data.state_noise(self.found.data.len() - 1, shape);
                }
            }
            let has_position = beam_breaks::has_position(target, inputs);
            for kind in &target.kinds {
                if let Some((measurement, stated)) =
                    kind.measurement(row, inputs, (has_position, self.options.contact))?
                {
                    self.observation(row, (target, set, Some(kind)), (measurement, stated), inputs)?;
                }
            }
        }
        Ok(())
    }

    /// True if a row is the first one of a pair, the configuration from which the second is seen.
    pub(crate) fn begins_pair(&mut self, row: &FileRow<'_>, inputs: &Cursor<'_>) -> Result<bool> {
        let pair = inputs.layout.pair;
        let Some((column, name)) = pair.zip(row.cell(pair).filter(|it| !it.is_empty())) else {
            return Ok(false);
        };
        if self.begun.get(name.as_ref()).is_some_and(|(index, _)| index.is_some()) {
            return Ok(false);
        }
        if let Some((_, line)) = self.begun.get(name.as_ref()) {
            let message = format!("found a third row of the pair `{name}` (line {line} is the first), expected two");
            return Err(row.error(column, message));
        }
        let further = self.found.data.push_further(inputs.readings());
        let further = further.map_err(|error| row.error(column, error.message()))?;
        self.begun.insert(name.into_owned(), (Some(further), row.line));
        Ok(true)
    }

    /// Adds a measurement of a row.
    fn observation(
        &mut self,
        row: &FileRow<'_>,
        (target, set, kind): (&TargetLayout, Option<Set>, Option<&KindColumns>),
        (measurement, stated): (Measurement, StatedDeviations),
        inputs: &Cursor<'_>,
    ) -> Result<()> {
        let layout = &inputs.layout;
        let target = self.target(row, layout, target)?;
        let pair = row.cell(layout.pair);
        let from = pair.and_then(|pair| self.begun.get_mut(pair.as_ref())?.0.take());
        let observation = Observation {
            station: self.station(row, layout, kind, from.map(|_| target))?,
            from,
            stated,
            set,
            source: RowLocation {
                // A file with joint readings only has no rows.
                file: u32::try_from(self.found.data.files.len().saturating_sub(1)).unwrap_or(u32::MAX),
                line: u32::try_from(row.line).unwrap_or(u32::MAX),
            },
            ..Observation::new(target, measurement)
        };
        let pushed = self.found.data.push_observation(inputs.readings(), observation);
        pushed.map_err(|error| row.error(0, error.message()))?;
        self.found.data.ids.extend(row.cell(layout.id).map(Cow::into_owned));
        Ok(())
    }

    /// The stated set of a row.
    pub(crate) fn set(&mut self, row: &FileRow<'_>, layout: &ColumnLayout) -> Result<Option<Set>> {
        match &layout.set {
            SetRule::Unstated => Ok(None),
            SetRule::Words(index) => set_of(row, *index),
            SetRule::Where(index, rule) => {
                self.fit_values_seen.resize(rule.values.len(), false);
                let text = row.cell(Some(*index)).unwrap_or_default();
                let Some(value) = rule.matching_index(&text) else { return Ok(Some(Set::HeldOut)) };
                if let Some(seen) = self.fit_values_seen.get_mut(value) {
                    *seen = true;
                }
                Ok(Some(Set::Fit))
            }
        }
    }

    /// Index of the row's target. Either all rows name their target or none does.
    fn target(&mut self, row: &FileRow<'_>, layout: &ColumnLayout, target: &TargetLayout) -> Result<usize> {
        let cell = row.cell(layout.target_column);
        let name = cell.as_deref().or(target.name.as_deref()).filter(|name| !name.is_empty());
        let column = layout.target_column;
        let index = self.targets.index(row, column, "target", name)?;
        if index == self.found.data.targets.len() {
            check_name(name.unwrap_or_default(), "target")
                .map_err(|error| row.error(column.unwrap_or(0), error.message()))?;
            self.found.data.targets.push(name.map(str::to_owned));
        }
        Ok(index)
    }

    /// Index of the row's station: of its instrument, or of the position from which it was measured. Either all rows of one kind of measurement
    /// name theirs, or none does.
    fn station(
        &mut self,
        row: &FileRow<'_>,
        layout: &ColumnLayout,
        kind: Option<&KindColumns>,
        shared: Option<usize>,
    ) -> Result<usize> {
        let own = kind.and_then(|kind| kind.place_name(row));
        let instrument = row.cell(layout.instrument).filter(|it| !it.is_empty());
        if let (Some(kind), Some(own), Some(other)) = (kind, &own, &instrument)
            && own != other
        {
            let (what, columns) = kind.place();
            let message = format!(
                "found the {what} `{own}` beside the instrument `{other}`, expected one of the two: leave one cell empty"
            );
            return Err(row.error(columns.last().copied().unwrap_or(0), message));
        }
        let place = kind.map(KindColumns::place).filter(|(_, columns)| !columns.is_empty());
        let (what, column) = match place.filter(|_| own.is_some() || instrument.is_none()) {
            Some((what, columns)) => (what, columns.last().copied()),
            None => ("instrument", layout.instrument),
        };
        let pair = shared.filter(|_| own.is_none() && instrument.is_none()).map(|target| {
            let target = self.found.data.targets.get(target).cloned().flatten();
            Cow::Owned(target.map_or_else(|| "pair".to_owned(), |target| format!("pair/{target}")))
        });
        let (what, column) = if pair.is_some() { ("pair", layout.pair) } else { (what, column) };
        let name = match (own.or(pair), self.options.frames) {
            (Some(own), _) => Some(own),
            (None, FrameGrouping::PerFile) => Some(Cow::Owned(row.path.display().to_string())),
            (None, FrameGrouping::Common) => instrument,
        };
        let name = name.as_deref();
        if let Some(name) = name {
            self.refuse_other_place(row, column, what, name)?;
        }
        let index = self.stations.index(row, column, what, name)?;
        let known = &mut self.found.data.stations;
        if index >= known.len() && (name.is_some() || index > 0) {
            if let Some(name) = name.filter(|_| self.options.frames == FrameGrouping::Common) {
                check_name(&name.replace('/', "_"), what)
                    .map_err(|error| row.error(column.unwrap_or(0), error.message()))?;
            }
            // An unnamed instrument precedes the first name.
            known.resize(index, None);
            known.push(name.map(str::to_owned));
            if what == "socket" {
                let (place, socket) =
                    name.and_then(|name| name.rsplit_once('/')).unwrap_or(("", name.unwrap_or_default()));
                self.sockets.entry(place.to_owned()).or_default().push((socket.to_owned(), index));
            }
        }
        Ok(index)
    }

    /// Refuses a name that positions of two kinds share. An anchor may be an instrument that measures positions too.
    fn refuse_other_place(
        &mut self,
        row: &FileRow<'_>,
        column: Option<usize>,
        what: &'static str,
        name: &str,
    ) -> Result<()> {
        let place = |what: &'static str| if what == "anchor" { "instrument" } else { what };
        let (known, path, line) =
            self.places.entry(name.to_owned()).or_insert_with(|| (what, row.path.to_path_buf(), row.line));
        if place(known) == place(what) {
            return Ok(());
        }
        let message = format!(
            "found the {what} `{name}`, which is the name of the {known} in {}:{line}, expected another name",
            path.display()
        );
        Err(row.error(column.unwrap_or(0), message))
    }
}

/// The set that a cell states.
pub(crate) fn set_of(row: &FileRow<'_>, index: usize) -> Result<Option<Set>> {
    match row.cell(Some(index)).unwrap_or_default().as_ref() {
        "" => Ok(None),
        "fit" => Ok(Some(Set::Fit)),
        "held_out" => Ok(Some(Set::HeldOut)),
        other => Err(row.error(index, format!("found `{other}` in column `set`, expected `fit` or `held_out`"))),
    }
}
