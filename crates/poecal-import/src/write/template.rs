//! An empty measurement file for a robot, and a table of configurations to be measured.

use std::fmt::Write as _;

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;

use crate::write::own_columns::{decimal, header, reading_header, reading_units, refuse_names};
use poecal_model::measurement::Quantity;
use poecal_model::robot::Robot;
use poecal_model::simulate::{Configurations, SessionKind};
use poecal_numerics::error::Result;
use poecal_numerics::text::escape_invisible;
use poecal_plan::plan::{CYCLE, Plan, RETURN_EVERY, RowPurpose, TestCube};

/// A measurement file without rows: the columns for this robot, with instructions as comments.
pub fn template(robot: &Robot, kind: SessionKind) -> Result<String> {
    let names = robot.reading_names();
    let units = reading_units(&names, robot)?;
    let mut columns = if kind.has_device() {
        header(&names, &units, kind.sees_orientation())?
    } else {
        let own = kind.session().columns;
        refuse_names(&names, &own.iter().map(|it| it.split('[').next().unwrap_or(it)).collect::<Vec<_>>())?;
        format!("{},{}", reading_header(&names, &units), own.join(","))
    };
    for (column, mounts) in [(",instrument", &robot.instruments), (",target", &robot.mounted)] {
        columns.push_str(if mounts.is_empty() { "" } else { column });
    }
    let mut text = "# Measurements: a row for each configuration, below the line of column names. Lines that begin with # are ignored.\n\
         # Units stand in brackets. If your numbers have others, change them there: [rad], [deg], [m], [mm], [um].\n\
         #\n\
         # Joints      what the controller shows while the robot stands still, not what it was told to do.\n"
        .to_owned();
    if kind.has_device() {
        text.push_str(
            "# x, y, z     where the device sees the target, in the device's own frame, wherever the device stands.\n",
        );
    }
    text.push_str(kind.session().about);
    for (column, does, mounts) in
        [("instrument", "sees", &robot.instruments), ("target    ", "is seen", &robot.mounted)]
    {
        if !mounts.is_empty() {
            let names: Vec<&str> = mounts.iter().map(|mount| mount.name.as_str()).collect();
            let _ = writeln!(text, "# {column}  which {does} in this row: {}", escape_invisible(&names.join(", ")));
        }
    }
    text.push_str(
        "#\n\
         # Columns to add if you have them, in any place:\n\
         #   id                   name of the row, kept in the results\n\
         #   target               name of the measured tool point; several in one configuration are several rows\n\
         #   set                  fit, or held_out for rows to judge by [default: a random 30 % of the configurations, none of few]\n",
    );
    if kind.has_device() {
        text.push_str(
            "#   sigma_position[mm]   standard deviation of each of x, y, z, if the device states it [default: estimated]\n",
        );
    }
    for name in kind.quantities().iter().filter(|it| !it.is_of_pose()).map(|it| (it.name(), it.unit().symbol())) {
        let column = format!("sigma_{}[{}]", name.0, name.1);
        let _ =
            writeln!(text, "#   {column:<20} standard deviation of its numbers, if it is known [default: estimated]");
    }
    if kind.quantities().contains(&Quantity::Rotation) {
        text.push_str(
            "#   sigma_rotation[deg]  standard deviation of the rotation about each axis [default: estimated]\n",
        );
    }
    Ok(format!("{text}{columns}\n"))
}

/// A table of `count` random configurations within the limits with some margin, within a turn (±180° and ±0.5 m if there are none). Every twentieth
/// repeats the first, which shows repeatability and drift.
pub fn plan(robot: &Robot, count: usize, seed: u64) -> Result<String> {
    let names = robot.reading_names();
    let units = reading_units(&names, robot)?;
    let mut text = format!(
        "# {count} configurations to measure, random within the limits of the joints, 2 deg and 5 mm from them (180 deg, 500 mm to either side where a joint has none).\n\
         # COLLISIONS ARE NOT CHECKED, in them or on the way, nor whether the device sees the target there: go through\n\
         # them slowly or in simulation first, and replace or leave out what does not work. Every twentieth is the first again, which\n\
         # shows how well the robot repeats and whether anything drifts. What they would determine: poecal plan --rows\n\
         {}\n",
        reading_header(&names, &units)
    );
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let configurations = Configurations::new(robot).to_measure();
    let first = configurations.random(&mut generator);
    for row in 1..=count {
        let again = row == 1 || row % RETURN_EVERY == 0;
        let readings = if again { first.clone() } else { configurations.random(&mut generator) };
        let cells: Vec<String> =
            readings.iter().zip(&units).map(|(&value, &unit)| decimal(value, unit, None)).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", cells.join(","));
    }
    Ok(text)
}

/// Comments above a planned list.
fn about(found: &Plan) -> [String; 4] {
    let count = |part: RowPurpose| found.rows.iter().filter(|row| row.part == part && !row.returns).count();
    let [fit, judge] = [count(RowPurpose::Fit), count(RowPurpose::Judge)];
    let [calibrated, corrected] = [found.expected.calibrated_m(), found.expected.corrected_m()];
    [
        format!("{fit} configurations to measure and fit, then {judge} at random to judge by (held_out), each set in a short order of travel."),
        "Rows whose column `returns` names row 1 are the first configuration again: they show how well the robot repeats, and drift."
            .to_owned(),
        "ONLY CONFIGURATIONS ARE CHECKED, NEVER THE WAY BETWEEN THEM: go through them slowly or in simulation first.".to_owned(),
        format!("Expected error of the calibrated robot {:.4} mm, with corrections {:.4} mm (RMS).", 1e3 * calibrated, 1e3 * corrected),
    ]
}

/// A planned list as a table: `set` states the purpose of a row, `returns` the row that it repeats, then the readings.
///
/// # Errors
/// [`poecal_numerics::error::ErrorKind::Model`] if a joint has the name of one of these columns.
pub fn planned_table(robot: &Robot, found: &Plan) -> Result<String> {
    let names = robot.reading_names();
    refuse_names(&names, &["id", "set", "returns"])?;
    let units = reading_units(&names, robot)?;
    let mut text = String::new();
    for comment in about(found) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "# {}", escape_invisible(&comment));
    }
    let _ = writeln!(text, "id,set,returns,{}", reading_header(&names, &units));
    for (row, planned) in found.rows.iter().enumerate() {
        let set = planned.part.set();
        let returns = if planned.returns { "1" } else { "" };
        let cells = planned.readings.iter().zip(&units).map(|(&value, &unit)| decimal(value, unit, None));
        let _ = writeln!(text, "{},{set},{returns},{}", row + 1, cells.collect::<Vec<_>>().join(","));
    }
    Ok(text)
}

/// The table of a test of ISO 9283 to fill in: a row for each pose and cycle, in the order of the standard.
///
/// # Errors
/// Those of [`planned_table`].
pub fn test_table(robot: &Robot, cube: &TestCube, cycles: usize) -> Result<String> {
    let names = robot.reading_names();
    refuse_names(&names, &["pose", "cycle"])?;
    let units = reading_units(&names, robot)?;
    let mut text = format!("pose,cycle,{},x[mm],y[mm],z[mm]\n", reading_header(&names, &units));
    for cycle in 1..=cycles {
        for (at, (_, readings)) in CYCLE.iter().filter_map(|&at| Some((at, cube.poses.get(at)?))) {
            let cells = readings.iter().zip(&units).map(|(&value, &unit)| decimal(value, unit, None));
            let _ = writeln!(text, "P{},{cycle},{},,,", at + 1, cells.collect::<Vec<_>>().join(","));
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::simulate::{elbow, scara};

    #[test]
    fn the_columns_are_those_of_the_robot() {
        let last = |kind| template(&scara(), kind).unwrap().lines().last().unwrap().to_owned();
        let joints = "joint1[deg],joint2[deg],joint3[mm],joint4[deg]";
        assert_eq!(last(SessionKind::POINT), format!("{joints},x[mm],y[mm],z[mm]"));
        assert_eq!(last(SessionKind::POSE), format!("{joints},x[mm],y[mm],z[mm],qx,qy,qz,qw"));
    }

    #[test]
    fn every_twentieth_configuration_is_the_first_again() {
        let text = plan(&elbow(), 60, 1).unwrap();
        let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).skip(1).collect();
        assert_eq!(rows.len(), 60);
        let first: Vec<usize> = (1..=60).filter(|row| rows[row - 1] == rows[0]).collect();
        assert_eq!(first, [1, 20, 40, 60]);
    }
}
