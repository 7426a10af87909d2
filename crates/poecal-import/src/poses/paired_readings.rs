//! Data from paired recordings: means of static intervals, and rates of the readings.

use std::path::Path;

use crate::read::MeasurementReader;
use poecal_model::measurement::{Clock, Observation};
use poecal_numerics::error::{ErrorKind, Result};

impl MeasurementReader<'_> {
    /// Replaces each row that represents a static interval by the mean measurement of the interval.
    pub(crate) fn take_means(&mut self, first: usize) {
        let Some(by_line) = self.readings.as_ref().filter(|it| !it.means.is_empty()) else { return };
        let (mut line, mut at) = (0, 0);
        for row in self.found.data.observations.iter_mut().skip(first) {
            (line, at) = if line == row.source.line { (line, at + 1) } else { (row.source.line, 0) };
            if let Some(mean) = by_line.means.get(&(line as usize)).and_then(|it| it.get(at)) {
                row.measurement = *mean;
            }
        }
    }

    /// Adds the rates of the readings and the clock to rows that were measured in motion.
    pub(crate) fn take_motion(&mut self, path: &Path, first: usize) -> Result<()> {
        let Some(motion) = self.readings.as_ref().and_then(|it| it.moving.as_ref()) else { return Ok(()) };
        let data = &mut self.found.data;
        for row in first..data.len() {
            let Some(Observation { station, source, .. }) = data.observations.get(row).copied() else {
                continue;
            };
            let Some((rates, time_s)) = motion.rows.get(&(source.line as usize)) else { continue };
            let clock = Clock { station, ..motion.clock };
            match data.moving.clock(station) {
                None => data.moving.clocks.push(clock),
                Some(known) if *known == clock => {}
                Some(_) => {
                    let message = "found a second recording in motion by one instrument, expected one, whose clock is an unknown of the fit: --device-frames per-file makes each file an instrument with a clock and a frame of its own, also where the instrument did not move between them";
                    return Err(ErrorKind::Measurement.error(message).in_file(path));
                }
            }
            data.state_motion(row, rates, *time_s);
        }
        Ok(())
    }

    /// Refuses a pair of which one row is missing.
    pub(crate) fn refuse_single_rows(&mut self, path: &Path) -> Result<()> {
        if let Some((name, (_, line))) = self.begun.iter().find(|(_, (index, _))| index.is_some()) {
            return Err(ErrorKind::Measurement.error(format!(
                "found one row of the pair `{name}`, expected two: the instrument's configuration, then the target's with what was measured"
            )).at_line(path, *line));
        }
        self.begun.clear();
        Ok(())
    }
}
