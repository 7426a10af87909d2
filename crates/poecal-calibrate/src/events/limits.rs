//! Largest sizes that a repair accepts as an event: beyond them a mistake in the input is likelier.

use std::str::FromStr;

use super::event_reports::EventKind;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// Subject of each limit, and its unit.
const THINGS: [(&str, Unit); 3] = [("device", Unit::Metre), ("tool", Unit::Metre), ("zero", Unit::Radian)];

/// Largest sizes of repairs. Turns of devices and targets count as arcs at a third of the robot's reach; offsets of sliding joints count as such arcs
/// of a zero.
///
/// ```
/// use poecal_calibrate::RepairLimits;
/// let limits: RepairLimits = "device=100mm,zero=10deg".parse()?;
/// assert_eq!((limits.device_m, limits.tool_m), (0.1, 0.02));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepairLimits {
    /// Largest motion of a device that was moved or drifts, metres.
    pub device_m: f64,
    /// Largest motion of a target, a nest or the tool with all targets, metres.
    pub tool_m: f64,
    /// Largest error of the zero of a joint, radians.
    pub zero_rad: f64,
}

impl Default for RepairLimits {
    fn default() -> Self {
        RepairLimits { device_m: 0.05, tool_m: 0.02, zero_rad: 5_f64.to_radians() }
    }
}

/// One limit in text form: `device=100mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepairLimit {
    thing: &'static str,
    /// Metres or radians.
    most: f64,
}

impl FromStr for RepairLimit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let bad = || {
            ErrorKind::Option.error(format!(
                "found `{text}` as the largest repair, expected device, tool or zero with a size above 0 and its unit, like device=100mm or zero=10deg"
            ))
        };
        let (word, size) = text.split_once('=').ok_or_else(bad)?;
        let (thing, unit) = THINGS.into_iter().find(|(thing, _)| *thing == word.trim()).ok_or_else(bad)?;
        let size = size.trim();
        let at = size.find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E') || c == '°');
        let (number, symbol) = size.split_at(at.ok_or_else(bad)?);
        let value = number.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0);
        let typed = NamedUnit::parse_any(symbol.trim())?;
        let value = value.filter(|_| typed.si_unit() == unit).ok_or_else(bad)?;
        Ok(RepairLimit { thing, most: typed.to_si(value) })
    }
}

impl FromStr for RepairLimits {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Ok(Self::with_overrides(&text.split(',').map(str::parse).collect::<Result<Vec<RepairLimit>>>()?))
    }
}

impl RepairLimits {
    /// The default limits, with these in their place.
    #[must_use]
    pub fn with_overrides(others: &[RepairLimit]) -> Self {
        let mut limits = Self::default();
        for RepairLimit { thing, most } in others {
            match *thing {
                "device" => limits.device_m = *most,
                "tool" => limits.tool_m = *most,
                _ => limits.zero_rad = *most,
            }
        }
        limits
    }

    /// The limit of this kind in words, if the size (metres and radians) exceeds it; `radian_m` metres count for a radian.
    pub(crate) fn exceeded_limit(
        &self,
        kind: EventKind,
        (size_m, size_rad): (f64, f64),
        radian_m: f64,
    ) -> Option<String> {
        let arc_m = size_m.hypot(radian_m * size_rad);
        let of_length = |thing: &str, most: f64| {
            (arc_m > most).then(|| {
                let mm = 1e3 * most;
                format!("more than the {mm} mm that --repair-limit {thing}={mm}mm lets a repair be")
            })
        };
        match kind {
            EventKind::Device | EventKind::Drift => of_length("device", self.device_m),
            EventKind::Target | EventKind::Nest => of_length("tool", self.tool_m),
            EventKind::Zero => (arc_m > radian_m * self.zero_rad).then(|| {
                let deg = (1e6 * self.zero_rad.to_degrees()).round() / 1e6;
                format!("more than the {deg} deg that --repair-limit zero={deg}deg lets a repair be")
            }),
            EventKind::Rows => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_stands_in_the_place_of_the_usual_one() {
        let limits: RepairLimits = "device=100mm, zero=10deg".parse().unwrap();
        assert_eq!(limits, RepairLimits { device_m: 0.1, zero_rad: 10_f64.to_radians(), ..RepairLimits::default() });
        for wrong in ["device", "device=", "device=100", "device=5deg", "zero=3mm", "nest=1mm", "tool=-1mm"] {
            let error = wrong.parse::<RepairLimits>().unwrap_err().to_string();
            println!("{error}");
            assert!(error.contains(wrong.split('=').next().unwrap()) || error.contains("unit"), "{error}");
        }
    }

    #[test]
    fn turns_count_as_arcs() {
        let limits = RepairLimits::default();
        let is_beyond = |kind, m, rad| limits.exceeded_limit(kind, (m, rad), 0.3).is_some();
        assert!(is_beyond(EventKind::Device, 0.06, 0.0) && !is_beyond(EventKind::Device, 0.04, 0.05));
        assert!(is_beyond(EventKind::Drift, 0.0, 0.2) && !is_beyond(EventKind::Rows, 1.0, 1.0));
        assert!(is_beyond(EventKind::Nest, 0.021, 0.0) && is_beyond(EventKind::Target, 0.0, 0.1));
        assert!(is_beyond(EventKind::Zero, 0.0, 0.09) && !is_beyond(EventKind::Zero, 0.0, 0.08));
        assert!(is_beyond(EventKind::Zero, 0.03, 0.0) && !is_beyond(EventKind::Zero, 0.02, 0.0));
    }
}
