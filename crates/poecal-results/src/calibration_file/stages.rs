//! Targets and devices before and after a repair: `tool` and `tool.2` are one, in the order of time.

use std::borrow::Cow;

use super::{CalibrationFile, StationEntry};
use poecal_calibrate::{EventKind, family};
use poecal_model::measurement::Dataset;
use poecal_model::robot::MEASURED;

impl CalibrationFile {
    /// Number of states of the session: one more than the moves of a device or a target that were repaired.
    #[must_use]
    pub fn stages(&self) -> usize {
        let is_move = |kind| matches!(kind, EventKind::Device | EventKind::Target | EventKind::Nest);
        if !self.repairs.iter().any(|it| is_move(it.kind)) {
            return 1;
        }
        let stations = self.stations.iter().filter_map(|it| it.instrument.as_deref());
        let names = self.targets.keys().map(String::as_str).chain(stations);
        names.map(|name| family(name).1).max().unwrap_or(1)
    }

    /// Measurements whose targets and instruments are those of a state of the session, from 1. Names that already state their state remain.
    #[must_use]
    pub fn at_stage<'d>(&self, data: &'d Dataset, stage: usize) -> Cow<'d, Dataset> {
        if self.stages() == 1 {
            return Cow::Borrowed(data);
        }
        let stations: Vec<&str> = self.stations.iter().filter_map(|it| it.instrument.as_deref()).collect();
        let targets: Vec<&str> = self.targets.keys().map(String::as_str).collect();
        let mut found = data.clone();
        let only = single_name(&stations);
        if let (true, Some(only)) = (found.stations.iter().all(Option::is_none), only) {
            found.stations = vec![Some(only.to_owned()); found.station_count()];
        }
        let of = |name: &mut Option<String>, known: &[&str], usual: Option<&str>| {
            let own = name.as_deref().or(usual);
            let later = own.and_then(|own| state(known, own, stage));
            if let Some(later) = later {
                *name = Some(later.to_owned());
            }
        };
        found.stations.iter_mut().for_each(|name| of(name, &stations, None));
        found.targets.iter_mut().for_each(|name| of(name, &targets, Some(MEASURED)));
        Cow::Owned(found)
    }

    /// The last state of the target of rows without a name. `None` if that is the tip, or if rows must name theirs.
    pub(crate) fn unnamed_target(&self) -> Option<&str> {
        let targets: Vec<&str> = self.targets.keys().map(String::as_str).collect();
        state(&targets, MEASURED, usize::MAX)
    }

    /// The last state of the only device; `None` for several devices.
    pub(crate) fn last_station(&self) -> Option<&StationEntry> {
        let names: Vec<&str> = self.stations.iter().filter_map(|it| it.instrument.as_deref()).collect();
        let last = state(&names, single_name(&names)?, usize::MAX)?;
        self.stations.iter().find(|it| it.instrument.as_deref() == Some(last))
    }
}

/// The name of a thing in a state, or in the last one before.
fn state<'n>(known: &[&'n str], name: &str, stage: usize) -> Option<&'n str> {
    let own = known.iter().map(|it| (*it, family(it)));
    let own = own.filter(|(_, (base, number))| *base == name && *number <= stage);
    own.max_by_key(|(_, (_, number))| *number).map(|(it, _)| it)
}

/// The name whose states all names are.
fn single_name<'n>(names: &[&'n str]) -> Option<&'n str> {
    let (first, _) = family(names.first()?);
    (names.len() > 1 && names.iter().all(|it| family(it).0 == first)).then_some(first)
}

/// The last state of the only target; `None` unless all names are states of one.
pub(crate) fn only_target<'n>(names: &[&'n str]) -> Option<&'n str> {
    match names {
        [only] => Some(only),
        several => state(several, single_name(several)?, usize::MAX),
    }
}
