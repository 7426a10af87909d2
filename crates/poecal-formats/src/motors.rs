//! LeRobot's calibration of motors, as `~/.cache/huggingface/lerobot/calibration/robots/TYPE/ID.json` has it. Positions are
//! `raw − homing_offset`, and the zero of an angle is the middle of the range.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Ticks of a turn.
pub const TICKS: f64 = 4096.0;
/// Number by which LeRobot divides degrees of a turn.
pub const DIVISOR: f64 = 4095.0;
/// Ending of LeRobot's names of positions.
pub const POSITION: &str = ".pos";

/// Motors by their names.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Motors(pub BTreeMap<String, Motor>);

/// A motor.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Number on the bus.
    pub id: u8,
    /// 1 if readings in per cent count the other way.
    pub drive_mode: u8,
    /// Ticks that are taken off raw positions.
    pub homing_offset: i64,
    /// Least position, ticks.
    pub range_min: i64,
    /// Largest position, ticks.
    pub range_max: i64,
}

impl Motors {
    /// Name of the motor of a joint: models name joints as motors, or by their numbers. A column of the readings may name it too.
    #[must_use]
    pub fn name_of(&self, joint: &str, column: Option<&str>) -> Option<&str> {
        let column = column.map(|it| it.strip_suffix(POSITION).unwrap_or(it));
        let by_name = [Some(joint), column].into_iter().flatten().find_map(|it| self.0.get_key_value(it));
        let by_number = || self.0.iter().find(|(_, motor)| joint.parse() == Ok(motor.id));
        by_name.or_else(by_number).map(|it| it.0.as_str())
    }
}

impl Motor {
    /// Range of positions, ticks.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        [self.range_min, self.range_max].map(|it| it as f64)
    }

    /// Position at the zero of an angle, ticks.
    #[must_use]
    pub fn middle(&self) -> f64 {
        let [least, most] = self.range();
        0.5 * (least + most)
    }

    /// Ticks of one per cent of the range, from -100 to 100; negative if they count the other way.
    #[must_use]
    pub fn ticks_of_per_cent(&self) -> f64 {
        let [least, most] = self.range();
        let turned = if self.drive_mode == 1 { -1.0 } else { 1.0 };
        turned * (most - least) / 200.0
    }
}
