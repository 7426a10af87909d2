//! LeRobot's calibration of motors: what its readings are of each joint, in ticks, degrees or per cent of the range.

use std::collections::BTreeMap;
use std::path::Path;

use super::super::header::Header;
use super::column_spec::ColumnSpec;
use poecal_formats::motors::{DIVISOR, Motor, Motors, POSITION, TICKS};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result, first_few};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;

/// Motors whose positions are readings of joints.
#[derive(Clone, Debug)]
pub(crate) struct MotorReadings(Motors);

impl MotorReadings {
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
            let [least, most] = motor.range();
            let is_range = 0.0 <= least && least < most && most < TICKS;
            if !is_range || motor.drive_mode > 1 || i32::try_from(motor.homing_offset).is_err() {
                return Err(ErrorKind::Syntax
                    .error(format!(
                        "found a range from {least} to {most}, drive_mode {} and homing_offset {} of motor `{name}`, expected a range within 0 to \
                         4095, 0 or 1, and an offset of 32 bits",
                        motor.drive_mode, motor.homing_offset
                    ))
                    .in_file(path));
            }
        }
        Ok(MotorReadings(motors))
    }

    /// Range of the motor of a joint, in ticks.
    pub(crate) fn range(&self, name: &str) -> Option<[f64; 2]> {
        Some(self.motor(name)?.1.range())
    }

    /// The motor of a joint, with its name.
    fn motor(&self, joint: &str) -> Option<(&String, &Motor)> {
        self.0.0.get_key_value(self.0.name_of(joint, None)?)
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
            let own: Vec<String> = self.0.0.keys().cloned().collect();
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
        let unit = cell.unit.as_deref().unwrap_or_default();
        let (factor, offset, unit) = match unit {
            "ticks" => (1.0, -motor.middle(), ticks),
            "deg" | "degrees" | "°" => (DIVISOR / TICKS, 0.0, degrees),
            "%" | "percent" => (motor.ticks_of_per_cent(), 0.0, ticks),
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
