//! Joint values in a wrong unit or beyond their limits.

use std::f64::consts::TAU;

use super::{DoubtLocation, InputDoubt, ReadColumn, SHARE, format_short, state_it};
use poecal_model::robot::{Joint, JointKind, JointLimits, Robot};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::text::NamedLines;
use poecal_numerics::unit::Unit;

/// Without limits, readings beyond this many radians or metres need a stated unit.
const LARGEST_UNLIMITED: f64 = 50.0;
/// Without limits, largest reading in the supposed unit (two turns in radians, and metres).
pub const LARGEST_OTHERWISE: f64 = 4.0 * std::f64::consts::PI;
/// Largest of all readings if they are per cent of the joints' ranges, from -100 to 100 and a little beyond.
const PER_CENT: std::ops::RangeInclusive<f64> = 92.0..=102.0;
/// Largest spread of readings that count a joint's turns from the middle of its range or beyond, radians; and a margin.
const MOST_TURNS: f64 = 2.0 * TAU;
const MORE: f64 = 0.05;
/// Counts in a turn of absolute encoders, as in motors of low-cost arms.
const ENCODERS: [f64; 4] = [1024.0, 4096.0, 16_384.0, 65_536.0];
/// Rounding allowed beyond a limit.
const ROUNDING: f64 = 1e-6;

/// Collects the joint values of a file.
#[derive(Clone, Debug)]
pub struct JointWatch<'a> {
    joints: Vec<JointUnitCheck<'a>>,
    rows: usize,
}

#[derive(Clone, Debug)]
struct JointUnitCheck<'a> {
    joint: &'a Joint,
    reading: usize,
    /// True if a whole turn of its reading is one of the joint, and of no other.
    is_periodic: bool,
    /// Lowest and highest reading before whole turns are subtracted, and whether all are whole numbers from 0 on.
    raw: [f64; 2],
    is_count: bool,
    turned: NamedLines,
    beyond: NamedLines,
    /// Largest of these, and its place in the file.
    extreme: f64,
    extreme_place: (usize, usize),
}

impl<'a> JointWatch<'a> {
    /// Watch of a robot, before any row.
    #[must_use]
    pub fn new(robot: &'a Robot) -> Self {
        let joints = robot.joints.iter().zip(robot.reading_indices());
        let joints = joints.map(|(joint, reading)| JointUnitCheck {
            joint,
            reading,
            is_periodic: joint.kind == JointKind::Revolute
                && joint.reading.multiplier.abs() == 1.0
                && robot.reading_indices().iter().filter(|it| **it == reading).count() == 1,
            raw: [f64::INFINITY, f64::NEG_INFINITY],
            is_count: true,
            turned: NamedLines::default(),
            beyond: NamedLines::default(),
            extreme: 0.0,
            extreme_place: (0, 0),
        });
        JointWatch { joints: joints.collect(), rows: 0 }
    }

    /// Subtracts whole turns from readings of a row that are inside the limits without them, and adds them to `turns`. An example is 0 to 360° of
    /// a joint from -180 to 180°. `place` is that of a reading: its line and column.
    pub fn unwind(&mut self, place: &dyn Fn(usize) -> (usize, usize), readings: &mut [Option<f64>], turns: &mut [f64]) {
        for one in &mut self.joints {
            let Some(Some(reading)) = readings.get_mut(one.reading) else { continue };
            one.raw = [one.raw[0].min(*reading), one.raw[1].max(*reading)];
            one.is_count &= *reading >= 0.0 && reading.fract() == 0.0;
            if reading.abs() > one.extreme {
                (one.extreme, one.extreme_place) = (reading.abs(), place(one.reading));
            }
            let (Some(more), Some(taken)) = (one.turns(*reading), turns.get_mut(one.reading)) else {
                continue;
            };
            *reading -= more * TAU;
            *taken += more;
            one.turned.add(place(one.reading).0);
        }
    }

    /// Adds the readings of a row.
    pub fn observe(&mut self, line: usize, readings: &[Option<f64>]) {
        self.rows += 1;
        for one in &mut self.joints {
            let Some(Some(reading)) = readings.get(one.reading) else { continue };
            if !one.allows(*reading, ROUNDING) {
                one.beyond.add(line);
            }
        }
    }

    /// A warning for each joint beyond its limits.
    ///
    /// # Errors
    /// Doubt if only another unit explains the readings.
    pub fn finish(&self, columns: &[ReadColumn<'_>]) -> Result<Vec<String>, InputDoubt> {
        let turned = self.joints.iter().filter(|one| one.turned.count > 0);
        let mut warnings: Vec<String> = turned.map(JointUnitCheck::turn_warning).collect();
        for one in self.joints.iter().filter(|one| one.beyond.count > 0 || one.turned.count > 0) {
            let Some(column) = columns.get(one.reading) else { continue };
            let Some((lowest, highest)) = column.range else { continue };
            let likely = one
                .other_unit(column, [lowest, highest], self.rows)
                .or_else(|| one.other_unit_of_turns(column, self.rows));
            if let Some(likely) = likely {
                let of_joints = columns.iter().take(self.joints.len());
                let extremes = of_joints.filter_map(|column| {
                    column.range.map(|(low, high)| column.unit.from_si(low.abs().max(high.abs())))
                });
                let is_per_cent = PER_CENT.contains(&extremes.fold(0.0, f64::max));
                let (line, character) = one.extreme_place;
                let message = match self.counts_a_turn(column) {
                    Some(counts) => one.counts_message(column, counts),
                    None => one.unit_message(column, likely, is_per_cent),
                };
                return Err(InputDoubt::new(DoubtLocation::Cell(line, character), message));
            }
            if let Some(limits) = one.joint.limits.filter(|_| one.beyond.count > 0) {
                warnings.push(one.limit_warning(limits, NamedUnit::from(column.unit.si_unit())));
            }
        }
        Ok(warnings)
    }

    /// Counts of an encoder in a turn, if all readings are whole numbers around its middle.
    fn counts_a_turn(&self, column: &ReadColumn<'_>) -> Option<f64> {
        let all = || self.joints.iter().map(|one| one.raw);
        let [lowest, highest] =
            [all().map(|it| it[0]).fold(f64::INFINITY, f64::min), all().map(|it| it[1]).fold(0.0, f64::max)];
        let counts = ENCODERS.into_iter().find(|counts| highest < *counts)?;
        let is_of_all = self.joints.iter().all(|one| one.is_count) && column.unit_from == UnitSource::Si;
        (is_of_all && lowest < 0.5 * counts && highest > 0.5 * counts).then_some(counts)
    }

    /// Total motion of prismatic joints without limits (metres), by the ranges of the columns.
    #[must_use]
    pub fn unlimited_slides_m(&self, columns: &[ReadColumn<'_>]) -> f64 {
        let slides =
            self.joints.iter().filter(|one| one.joint.kind == JointKind::Prismatic && one.joint.limits.is_none());
        slides
            .filter_map(|one| {
                let (lowest, highest) = columns.get(one.reading)?.range?;
                Some((one.joint.reading.multiplier * (highest - lowest)).abs())
            })
            .filter(|span| span.is_finite())
            .sum()
    }
}

impl JointUnitCheck<'_> {
    /// True if a reading is inside the limits widened by `slack`; without limits, if it is not too large.
    fn allows(&self, reading: f64, slack: f64) -> bool {
        let value = self.joint.reading.value(reading);
        match self.joint.limits {
            Some(limits) => value >= limits.lower - slack && value <= limits.upper + slack,
            None => reading.abs() <= LARGEST_UNLIMITED,
        }
    }

    /// Number of whole turns without which a reading is inside the limits, if it is beyond them with these.
    fn turns(&self, reading: f64) -> Option<f64> {
        let limits = self.joint.limits.filter(|_| self.is_periodic && !self.allows(reading, ROUNDING))?;
        // A larger reading would rather be in another unit.
        if reading.abs() > LARGEST_OTHERWISE {
            return None;
        }
        let middle = 0.5 * (limits.lower + limits.upper);
        let turns = ((self.joint.reading.value(reading) - middle) / TAU).round() * self.joint.reading.multiplier;
        (turns != 0.0 && self.allows(reading - turns * TAU, ROUNDING)).then_some(turns)
    }

    fn turn_warning(&self) -> String {
        format!(
            "whole turns are taken off the readings of joint `{}` in {} {} ({}), which brings them inside its limits",
            self.joint.name,
            self.turned.count,
            if self.turned.count == 1 { "row" } else { "rows" },
            self.turned.words()
        )
    }

    /// Unit that explains readings far outside.
    fn other_unit(&self, input: &ReadColumn<'_>, extremes: [f64; 2], rows: usize) -> Option<NamedUnit> {
        let is_rare = (self.beyond.count as f64) < SHARE * rows as f64;
        let is_far = self.is_far_outside(input.unit.si_unit(), extremes, input.unit_from);
        if is_rare || !is_far { None } else { self.smaller_unit(input, extremes) }
    }

    /// The unit for readings from which whole turns were subtracted, if they differ by more turns than any count of them.
    fn other_unit_of_turns(&self, input: &ReadColumn<'_>, rows: usize) -> Option<NamedUnit> {
        let is_rare = ((self.turned.count + self.beyond.count) as f64) < SHARE * rows as f64;
        let span = self.joint.limits.map_or(0.0, |limits| limits.upper - limits.lower);
        let [lowest, highest] = self.raw;
        let is_of_turns = highest - lowest <= MOST_TURNS.max(span) * (1.0 + MORE);
        if self.turned.count == 0 || is_rare || is_of_turns { None } else { self.smaller_unit(input, self.raw) }
    }

    /// Smaller unit in which readings are inside the limits.
    fn smaller_unit(&self, input: &ReadColumn<'_>, extremes: [f64; 2]) -> Option<NamedUnit> {
        let quantity = input.unit.si_unit();
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

    /// True if a reading is so far outside that the joint cannot have been there.
    fn is_far_outside(&self, quantity: Unit, extremes: [f64; 2], unit_from: UnitSource) -> bool {
        match self.joint.limits {
            Some(limits) => {
                let span = limits.upper - limits.lower;
                // Limits may be narrow or wrong: only large readings count.
                let (large, spans) = match quantity {
                    Unit::Metre => (5.0, 5.0),
                    Unit::Radian | Unit::One | Unit::Second => (std::f64::consts::TAU, 0.5),
                };
                extremes.into_iter().any(|reading| reading.abs() > large && !self.allows(reading, spans * span))
            }
            None => unit_from == UnitSource::Si,
        }
    }

    fn counts_message(&self, input: &ReadColumn<'_>, counts: f64) -> String {
        let (name, degrees, zero) = (input.name, 360.0 / counts, 0.5 * counts);
        format!(
            "found whole numbers from {} to {}, expected angles: most likely they are counts of an encoder, {counts} a turn with the zero at {zero}, \
             which a mapping (--columns) reads by lines under `[joints]` such as `{} = {{ columns = {{ {name} = {degrees} }}, unit = \"deg\", offset = -180 }}`",
            format_short(self.raw[0]),
            format_short(self.raw[1]),
            self.joint.name
        )
    }

    fn unit_message(&self, input: &ReadColumn<'_>, likely: NamedUnit, is_per_cent: bool) -> String {
        let stated = input.unit.symbol();
        let symbol = likely.symbol();
        let outside = match self.joint.limits {
            Some(limits) => {
                let si = NamedUnit::from(input.unit.si_unit()).symbol();
                format!(
                    "far outside the limits {} to {} {si} of joint `{}`",
                    format_short(limits.lower),
                    format_short(limits.upper),
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
            format_short(extreme),
            input.name,
            state_it(input.unit_from, symbol)
        )
    }

    fn limit_warning(&self, limits: JointLimits, unit: NamedUnit) -> String {
        format!(
            "joint `{}` lies beyond its limits {} to {} {} in {} {} ({})",
            self.joint.name,
            format_short(limits.lower),
            format_short(limits.upper),
            unit.symbol(),
            self.beyond.count,
            if self.beyond.count == 1 { "row" } else { "rows" },
            self.beyond.words()
        )
    }
}
