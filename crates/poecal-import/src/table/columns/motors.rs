//! LeRobot's calibration of motors: what its readings are of each joint, in ticks, degrees or per cent of the range.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::super::header::Header;
use super::column_spec::ColumnSpec;
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result, first_few};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// Ticks of a turn, and as many as LeRobot divides degrees by.
const TICKS: f64 = 4096.0;
const DIVISOR: f64 = 4095.0;
/// Ending of LeRobot's names of positions.
const POSITION: &str = ".pos";

/// Motors by their names, as `~/.cache/huggingface/lerobot/calibration/robots/TYPE/ID.json` has them.
#[derive(Clone, Debug, Deserialize)]
#[serde(transparent)]
pub(crate) struct Motors(BTreeMap<String, MotorReadings>);

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MotorReadings {
    id: u8,
    drive_mode: u8,
    #[expect(dead_code, reason = "part of the file; readings have it off already")]
    homing_offset: i32,
    range_min: u32,
    range_max: u32,
}

impl Motors {
    /// The motors of a text in JSON; messages call it `path`.
    ///
    /// # Errors
    /// [`ErrorKind::Syntax`] if it is no calibration of motors.
    pub(crate) fn parse(text: &str, path: &Path) -> Result<Self> {
        let motors: Motors = serde_json::from_str(text).map_err(|error| {
            ErrorKind::Syntax
                .error(format!(
                    "found {error}, expected a mapping (TOML), or LeRobot's calibration of motors with id, drive_mode, homing_offset, range_min \
                     and range_max of each"
                ))
                .in_file(path)
        })?;
        for (name, motor) in &motors.0 {
            let (least, most) = (motor.range_min, motor.range_max);
            if least >= most || f64::from(most) >= TICKS || motor.drive_mode > 1 {
                return Err(ErrorKind::Syntax
                    .error(format!(
                        "found a range from {least} to {most} and drive_mode {} of motor `{name}`, expected a range within 0 to 4095 and 0 or 1",
                        motor.drive_mode
                    ))
                    .in_file(path));
            }
        }
        Ok(motors)
    }

    /// Range of the motor of a joint, in ticks.
    pub(crate) fn range(&self, name: &str) -> Option<[f64; 2]> {
        let (_, motor) = self.motor(name)?;
        Some([motor.range_min, motor.range_max].map(f64::from))
    }

    /// The motor of a joint: models name joints as motors, or by their numbers.
    fn motor(&self, name: &str) -> Option<(&String, &MotorReadings)> {
        let by_number = || self.0.iter().find(|(_, motor)| name.parse() == Ok(motor.id));
        self.0.get_key_value(name).or_else(by_number)
    }

    /// Columns of the joints in a header, with what makes angles of them: zero is the middle of the range.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if a joint has no motor or no column, or a column no unit.
    pub(crate) fn columns(
        &self,
        header: &Header<'_>,
        robot: &Robot,
        path: &Path,
    ) -> Result<BTreeMap<String, ColumnSpec>> {
        let names = robot.joint_reading_names();
        let one = |name: String| {
            let spec = self.column(header, &name, robot).map_err(|error| error.in_file(path))?;
            Ok((name, spec))
        };
        names.into_iter().map(one).collect()
    }

    fn column(&self, header: &Header<'_>, name: &str, robot: &Robot) -> Result<ColumnSpec> {
        let Some((motor_name, motor)) = self.motor(name) else {
            let own: Vec<String> = self.0.keys().cloned().collect();
            let joints = robot.joint_reading_names();
            return ErrorKind::Measurement.refuse(format!(
                "found no motor of joint `{name}` among {}, expected one of each of {}: state the file of this arm, or the end of its chain by \
                 --tip-link",
                first_few(&own),
                first_few(&joints)
            ));
        };
        let names = [motor_name.clone(), format!("{motor_name}{POSITION}"), name.to_owned()];
        let found = names.iter().find_map(|it| header.find(it).transpose()).transpose()?;
        let Some((index, cell)) = found.and_then(|index| Some((index, header.cells.get(index)?))) else {
            // The builder names the column that is missing.
            return Ok(ColumnSpec { column: Some(motor_name.clone()), ..ColumnSpec::default() });
        };
        let ticks = NamedUnit::parse("ticks", Unit::Radian)?;
        let degrees = NamedUnit::parse("deg", Unit::Radian)?;
        let turned = if motor.drive_mode == 1 { -1.0 } else { 1.0 };
        let [least, most] = [motor.range_min, motor.range_max].map(f64::from);
        let unit = cell.unit.as_deref().unwrap_or_default();
        let (factor, offset, unit) = match unit {
            "ticks" => (1.0, -0.5 * (least + most), ticks),
            "deg" | "degrees" | "°" => (DIVISOR / TICKS, 0.0, degrees),
            "%" | "percent" => (turned * (most - least) / 200.0, 0.0, ticks),
            other => {
                let found = if other.is_empty() { "no unit".to_owned() } else { format!("the unit `{other}`") };
                return Err(header.error(
                    ErrorKind::Measurement,
                    index,
                    format!(
                        "found {found} of `{}`, expected [ticks] (raw positions), [deg] (LeRobot's degrees) or [%] (-100 to 100) behind the name",
                        cell.name
                    ),
                ));
            }
        };
        let columns = Some(BTreeMap::from([(cell.name.clone(), factor)]));
        Ok(ColumnSpec { columns, offset: Some(offset), unit: Some(unit), ..ColumnSpec::default() })
    }
}
