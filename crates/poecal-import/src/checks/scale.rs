//! Joint values in a wrong unit or beyond their limits.

use std::f64::consts::TAU;
use std::path::Path;

use crate::table::Row;
use crate::table::inputs::{Input, InputReader, Range};
use crate::table::layout::ColumnLayout;
use crate::table::lost::{NAMED_LINES, named_lines};
use poecal_model::robot::{Joint, JointKind, Limits, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::unit::Unit;

/// Without limits, readings beyond this many radians or metres need a stated unit.
const LARGEST_UNLIMITED: f64 = 50.0;
/// Without limits, largest reading in the supposed unit (two turns in radians, and metres).
pub const LARGEST_OTHERWISE: f64 = 4.0 * std::f64::consts::PI;
/// Least share of rows with implausible values: a few corrupt rows are no wrong unit.
pub const SHARE: f64 = 0.1;
/// The largest of all readings where they are per cent of the joints' ranges, from -100 to 100 and a little beyond.
const PER_CENT: std::ops::RangeInclusive<f64> = 92.0..=102.0;
/// By how much readings differ at most that count a joint's turns from the middle of its range on or beyond, radians; and a margin.
const MOST_TURNS: f64 = 2.0 * TAU;
const MORE: f64 = 0.05;
/// Rounding allowed beyond a limit.
const ROUNDING: f64 = 1e-6;

/// Collects the joint values of a file.
pub(crate) struct JointWatch<'a> {
    joints: Vec<OneJoint<'a>>,
    rows: usize,
}

struct OneJoint<'a> {
    joint: &'a Joint,
    reading: usize,
    /// Whether a whole turn of its reading is one of the joint, and of no other.
    is_periodic: bool,
    /// The lowest and the highest reading before whole turns are taken off.
    raw: [f64; 2],
    turned: usize,
    turned_lines: Vec<usize>,
    beyond: usize,
    first_lines: Vec<usize>,
    /// The largest of these, and its place.
    extreme: f64,
    extreme_place: (usize, usize),
}

impl<'a> JointWatch<'a> {
    pub(crate) fn new(robot: &'a Robot) -> Self {
        let joints = robot.joints.iter().zip(robot.reading_indices());
        let joints = joints.map(|(joint, reading)| OneJoint {
            joint,
            reading,
            is_periodic: joint.kind == JointKind::Revolute
                && joint.reading.multiplier.abs() == 1.0
                && robot.reading_indices().iter().filter(|it| **it == reading).count() == 1,
            raw: [f64::INFINITY, f64::NEG_INFINITY],
            turned: 0,
            turned_lines: Vec::new(),
            beyond: 0,
            first_lines: Vec::new(),
            extreme: 0.0,
            extreme_place: (0, 0),
        });
        JointWatch { joints: joints.collect(), rows: 0 }
    }

    /// Takes whole turns off the readings of a row that are inside the limits without, as 0 to 360° of a joint from -180 to 180°.
    pub(crate) fn unwind(&mut self, row: &Row<'_>, inputs: &mut InputReader<'_>) {
        for one in &mut self.joints {
            let Some(reading) = inputs.value(one.reading) else { continue };
            one.raw = [one.raw[0].min(reading), one.raw[1].max(reading)];
            if reading.abs() > one.extreme {
                one.extreme = reading.abs();
                one.extreme_place = row.place(inputs.column(one.reading));
            }
            let Some(turns) = one.turns(reading) else { continue };
            inputs.unwind(one.reading, turns);
            one.turned += 1;
            if one.turned_lines.len() < NAMED_LINES {
                one.turned_lines.push(row.line);
            }
        }
    }

    /// Adds the readings of a row.
    pub(crate) fn observe(&mut self, row: &Row<'_>, inputs: &InputReader<'_>) {
        self.rows += 1;
        for one in &mut self.joints {
            let Some(reading) = inputs.value(one.reading) else { continue };
            if one.allows(reading, ROUNDING) {
                continue;
            }
            one.beyond += 1;
            if one.first_lines.len() < NAMED_LINES {
                one.first_lines.push(row.line);
            }
        }
    }

    /// A warning for each joint beyond its limits; the inputs lie in `ranges`.
    ///
    /// # Errors
    /// [`ErrorKind::Unit`] if only another unit explains the readings.
    pub(crate) fn finish(&self, path: &Path, layout: &ColumnLayout, ranges: &[Range]) -> Result<Vec<String>> {
        let mut warnings = Vec::new();
        let turned = self.joints.iter().filter(|one| one.turned > 0);
        warnings.extend(turned.map(|one| one.turn_warning(path)));
        for one in self.joints.iter().filter(|one| one.beyond > 0 || one.turned > 0) {
            let (Some(input), Some(range)) = (layout.inputs.get(one.reading), ranges.get(one.reading)) else {
                continue;
            };
            let Some((lowest, highest)) = range.0 else { continue };
            let likely = one
                .other_unit(input, [lowest, highest], self.rows)
                .or_else(|| one.other_unit_of_turns(input, self.rows));
            if let Some(likely) = likely {
                let (line, column) = one.extreme_place;
                let of_joints = layout.inputs.iter().zip(ranges).take(self.joints.len());
                let extremes = of_joints.filter_map(|(input, range)| {
                    range.0.map(|(low, high)| input.unit.from_si(low.abs().max(high.abs())))
                });
                let is_per_cent = PER_CENT.contains(&extremes.fold(0.0, f64::max));
                return Err(ErrorKind::Unit
                    .error(one.unit_message(input, likely, is_per_cent))
                    .at(path, line, column));
            }
            if let Some(limits) = one.joint.limits.filter(|_| one.beyond > 0) {
                warnings.push(one.limit_warning(path, limits, NamedUnit::from(input.unit.of())));
            }
        }
        Ok(warnings)
    }

    /// How far the slides without limits move in all (metres), by the ranges of the inputs.
    pub(crate) fn unlimited_slides_m(&self, ranges: &[Range]) -> f64 {
        let slides = self
            .joints
            .iter()
            .filter(|one| one.joint.kind == JointKind::Prismatic && one.joint.limits.is_none());
        slides
            .filter_map(|one| {
                let (lowest, highest) = ranges.get(one.reading)?.0?;
                Some((one.joint.reading.multiplier * (highest - lowest)).abs())
            })
            .filter(|span| span.is_finite())
            .sum()
    }
}

impl OneJoint<'_> {
    /// Whether a reading is inside the limits widened by `slack`; without limits, whether it is not too large.
    fn allows(&self, reading: f64, slack: f64) -> bool {
        let value = self.joint.reading.value(reading);
        match self.joint.limits {
            Some(limits) => value >= limits.lower - slack && value <= limits.upper + slack,
            None => reading.abs() <= LARGEST_UNLIMITED,
        }
    }

    /// Whole turns without which a reading is inside the limits, where it is beyond them with these.
    fn turns(&self, reading: f64) -> Option<f64> {
        let limits = self.joint.limits.filter(|_| self.is_periodic && !self.allows(reading, ROUNDING))?;
        // More would rather be another unit.
        if reading.abs() > LARGEST_OTHERWISE {
            return None;
        }
        let middle = 0.5 * (limits.lower + limits.upper);
        let turns =
            ((self.joint.reading.value(reading) - middle) / TAU).round() * self.joint.reading.multiplier;
        (turns != 0.0 && self.allows(reading - turns * TAU, ROUNDING)).then_some(turns)
    }

    fn turn_warning(&self, path: &Path) -> String {
        format!(
            "{}: whole turns are taken off the readings of joint `{}` in {} {} ({}), which brings them inside its limits",
            path.display(),
            self.joint.name,
            self.turned,
            if self.turned == 1 { "row" } else { "rows" },
            named_lines(self.turned, &self.turned_lines)
        )
    }

    /// The unit that explains readings far outside.
    fn other_unit(&self, input: &Input, extremes: [f64; 2], rows: usize) -> Option<NamedUnit> {
        let is_rare = (self.beyond as f64) < SHARE * rows as f64;
        let is_far = self.is_far_outside(input.unit.of(), extremes, input.unit_from);
        if is_rare || !is_far { None } else { self.smaller_unit(input, extremes) }
    }

    /// The same of readings of which whole turns were taken off, although they differ by more turns than any count of them.
    fn other_unit_of_turns(&self, input: &Input, rows: usize) -> Option<NamedUnit> {
        let is_rare = ((self.turned + self.beyond) as f64) < SHARE * rows as f64;
        let span = self.joint.limits.map_or(0.0, |limits| limits.upper - limits.lower);
        let [lowest, highest] = self.raw;
        let is_of_turns = highest - lowest <= MOST_TURNS.max(span) * (1.0 + MORE);
        if self.turned == 0 || is_rare || is_of_turns { None } else { self.smaller_unit(input, self.raw) }
    }

    /// The smaller unit in which readings are inside the limits.
    fn smaller_unit(&self, input: &Input, extremes: [f64; 2]) -> Option<NamedUnit> {
        let quantity = input.unit.of();
        let candidates: &[&str] = match quantity {
            Unit::Radian => &["deg", "mrad", "arcmin", "arcsec"],
            Unit::Metre => &["mm", "um", "nm"],
            Unit::One | Unit::Second => &[],
        };
        let span = self.joint.limits.map_or(0.0, |limits| limits.upper - limits.lower);
        candidates.iter().find_map(|symbol| {
            let unit = NamedUnit::parse(symbol, quantity).ok()?;
            if unit.to_si(1.0) >= input.unit.to_si(1.0) {
                return None;
            }
            let fits = extremes.into_iter().all(|reading| {
                let reading = unit.to_si(input.unit.from_si(reading));
                let plausible = self.joint.limits.is_some() || reading.abs() <= LARGEST_OTHERWISE;
                plausible && self.allows(reading, 0.1 * span)
            });
            fits.then_some(unit)
        })
    }

    /// Whether a reading is so far outside that the joint cannot have been there.
    fn is_far_outside(&self, quantity: Unit, extremes: [f64; 2], unit_from: UnitSource) -> bool {
        match self.joint.limits {
            Some(limits) => {
                let span = limits.upper - limits.lower;
                // Limits may be narrow or wrong: only large readings count.
                let (large, spans) = match quantity {
                    Unit::Metre => (5.0, 5.0),
                    Unit::Radian | Unit::One | Unit::Second => (std::f64::consts::TAU, 0.5),
                };
                extremes
                    .into_iter()
                    .any(|reading| reading.abs() > large && !self.allows(reading, spans * span))
            }
            None => unit_from == UnitSource::Si,
        }
    }

    fn unit_message(&self, input: &Input, likely: NamedUnit, is_per_cent: bool) -> String {
        let stated = input.unit.symbol();
        let symbol = likely.symbol();
        let outside = match self.joint.limits {
            Some(limits) => {
                let si = NamedUnit::from(input.unit.of()).symbol();
                format!(
                    "far outside the limits {} to {} {si} of joint `{}`",
                    short(limits.lower),
                    short(limits.upper),
                    self.joint.name
                )
            }
            None => format!("too far for joint `{}`", self.joint.name),
        };
        let extreme = input.unit.from_si(self.extreme);
        let (likely, per_cent) = if symbol == "deg" && is_per_cent {
            (
                ": deg, or per cent of the joints' ranges".to_owned(),
                "; of per cent `poecal check` then names the factors, as lines of a mapping",
            )
        } else {
            (format!(", most likely {symbol}"), "")
        };
        format!(
            "found readings of up to {} {stated}, {outside}, expected another unit{likely}; \
             write `{}[{symbol}]` in the header, or {}{per_cent}",
            short(extreme),
            input.name,
            state_it(input.unit_from, symbol)
        )
    }

    fn limit_warning(&self, path: &Path, limits: Limits, unit: NamedUnit) -> String {
        format!(
            "{}: joint `{}` lies beyond its limits {} to {} {} in {} {} ({})",
            path.display(),
            self.joint.name,
            short(limits.lower),
            short(limits.upper),
            unit.symbol(),
            self.beyond,
            if self.beyond == 1 { "row" } else { "rows" },
            named_lines(self.beyond, &self.first_lines)
        )
    }
}

/// How to state a unit beside the header: where a column states none, by an option.
pub(crate) fn state_it(unit_from: UnitSource, symbol: &str) -> String {
    match unit_from {
        UnitSource::Si | UnitSource::Maker => format!("say --units {symbol}"),
        UnitSource::Header | UnitSource::UnitsLine | UnitSource::Mapping => {
            "the unit in the mapping".to_owned()
        }
    }
}

/// A number to four significant digits.
pub(crate) fn short(value: f64) -> String {
    format!("{value:.3e}").parse::<f64>().unwrap_or(value).to_string()
}
