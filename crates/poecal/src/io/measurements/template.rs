//! An empty measurement file for a robot, and a table of configurations to be measured.

use std::fmt::Write as _;

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;

use super::write::{decimal, header, reading_header, reading_units, refuse_names};
use crate::error::Result;
use crate::measurement::Quantity;
use crate::robot::Robot;
use crate::simulate::{Configurations, Kind};
use crate::text::visible;

/// Number of rows between visits of the first configuration.
const ROWS_BETWEEN_VISITS: usize = 20;

/// A measurement file without rows: the columns for this robot, with instructions as comments.
pub(in crate::io) fn template(robot: &Robot, kind: Kind) -> Result<String> {
    let names = robot.reading_names();
    let units = reading_units(&names, robot)?;
    let mut columns = if kind.has_device() {
        header(&names, &units, kind.sees_orientation())?
    } else {
        let own = kind.columns().0;
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
    text.push_str(if kind == Kind::Pose {
        "# qx to qw    the target's orientation in the device's frame, as a quaternion (w last). Instead, name the columns\n\
         #             rx,ry,rz[deg] for a rotation vector, or roll,pitch,yaw[deg] for turns about the fixed x, then y, then z.\n"
    } else if kind == Kind::Mixed {
        "# qx to qw    the target's orientation in the device's frame, as a quaternion (w last); leave all four empty in rows\n\
         #             where a point was seen.\n"
    } else {
        kind.columns().1
    });
    for (column, does, mounts) in
        [("instrument", "sees", &robot.instruments), ("target    ", "is seen", &robot.mounted)]
    {
        if !mounts.is_empty() {
            let names: Vec<&str> = mounts.iter().map(|mount| mount.name.as_str()).collect();
            let _ = writeln!(text, "# {column}  which {does} in this row: {}", visible(&names.join(", ")));
        }
    }
    text.push_str(
        "#\n\
         # Columns to add if you have them, in any place:\n\
         #   id                   name of the row, kept in the results\n\
         #   target               name of the measured tool point; several in one configuration are several rows\n\
         #   set                  fit, or held_out for rows to judge by [default: a random 30 % of the configurations]\n",
    );
    if kind.has_device() {
        text.push_str(
            "#   sigma_position[mm]   standard deviation of each of x, y, z, if the device states it [default: estimated]\n",
        );
    }
    for name in
        kind.quantities().iter().filter(|it| !it.is_of_pose()).map(|it| (it.name(), it.unit().symbol()))
    {
        let column = format!("sigma_{}[{}]", name.0, name.1);
        let _ = writeln!(
            text,
            "#   {column:<20} standard deviation of its numbers, if it is known [default: estimated]"
        );
    }
    if kind.quantities().contains(&Quantity::Rotation) {
        text.push_str("#   sigma_rotation[deg]  standard deviation of the rotation about each axis [default: estimated]\n");
    }
    Ok(format!("{text}{columns}\n"))
}

/// A table of `count` random configurations within the limits (±180° and ±0.5 m where there are none). Every twentieth is the first again,
/// which shows repeatability and drift.
pub(in crate::io) fn plan(robot: &Robot, count: usize, seed: u64) -> Result<String> {
    let names = robot.reading_names();
    let units = reading_units(&names, robot)?;
    let mut text = format!(
        "# {count} configurations to measure, random within the limits of the joints (180 deg, 500 mm to either side where a joint has none).\n\
         # COLLISIONS ARE NOT CHECKED, in them or on the way, nor whether the device sees the target there: go through\n\
         # them slowly or in simulation first, and replace or leave out what does not work. Every twentieth is the first again, which\n\
         # shows how well the robot repeats and whether anything drifts. What they would determine: poecal identify\n\
         {}\n",
        reading_header(&names, &units)
    );
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let configurations = Configurations::new(robot);
    let first = configurations.random(&mut generator);
    for row in 1..=count {
        let again = row == 1 || row % ROWS_BETWEEN_VISITS == 0;
        let readings = if again { first.clone() } else { configurations.random(&mut generator) };
        let cells: Vec<String> =
            readings.iter().zip(&units).map(|(&value, &unit)| decimal(value, unit, None)).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", cells.join(","));
    }
    Ok(text)
}

impl Kind {
    /// Columns of a kind without a device frame, and what they are.
    fn columns(self) -> (&'static [&'static str], &'static str) {
        match self {
            Kind::Pose | Kind::Point | Kind::Mixed => (&[], ""),
            Kind::Distance => (
                &["anchor", "distance[mm]"],
                "# anchor      from where the distance was measured; three places or more tell most. Where they are is found.\n\
                 # distance    from there to the target.\n",
            ),
            Kind::Change => (
                &["anchor", "distance_change[mm]"],
                "# anchor           the instrument, or where it stood; another name whenever it was moved or set to zero.\n\
                 # distance_change  what it shows: the distance from it, counted from any zero.\n",
            ),
            Kind::Sphere => (
                &["sphere", "radius[mm]"],
                "# sphere      the sphere that the target touches. Where it is is found.\n\
                 # radius      its radius, and that of the probe; leave it empty if it is unknown (then it is found too).\n",
            ),
            Kind::Socket => (
                &["place", "socket"],
                "# place       where the sockets stood; another name whenever they were moved.\n\
                 # socket      the socket in which the ball is, or the fixed point that is touched.\n",
            ),
            Kind::Plane | Kind::Height => (
                &["plane", "contact", "height[mm]"],
                "# plane       the plane that is touched. Where it is is found.\n\
                 # contact     point, or flush where a face lies on it.\n\
                 # height      of the target over it, as a dial gauge shows; leave it empty where it is touched.\n",
            ),
            Kind::Flush => (
                &["plane", "contact"],
                "# plane       the plane on which a face of the tool lies. Where it is is found.\n\
                 # contact     flush, or point where a point touches it.\n",
            ),
            Kind::Direction => (
                &["direction", "tilt_x[deg]", "tilt_y[deg]"],
                "# direction   the direction that is seen, such as gravity.\n\
                 # tilt_x, y   the tilts of the target about its own x and y, as an inclinometer with two axes shows them.\n",
            ),
            Kind::BallBar => (
                &["pair", "distance[mm]"],
                "# pair        two rows with the same name are one measurement, of two configurations; the second has the number.\n\
                 # distance    of the target between the two.\n",
            ),
            Kind::Component => (
                &["instrument", "x[mm]", "y[mm]", "z[mm]"],
                "# instrument  what measured; each has axes of its own, which are found.\n\
                 # x, y, z     position of the target; leave a cell empty where that component was not measured.\n",
            ),
            Kind::Relative => (
                &["pair", "x[mm]", "y[mm]", "z[mm]", "qx", "qy", "qz", "qw"],
                "# pair        two rows with the same name are one measurement, of two configurations; the second has the numbers.\n\
                 # x to qw     the target in the second, seen from where it was in the first.\n",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{elbow, scara};

    #[test]
    fn the_columns_are_those_of_the_robot() {
        let last = |kind| template(&scara(), kind).unwrap().lines().last().unwrap().to_owned();
        let joints = "joint1[deg],joint2[deg],joint3[mm],joint4[deg]";
        assert_eq!(last(Kind::Point), format!("{joints},x[mm],y[mm],z[mm]"));
        assert_eq!(last(Kind::Pose), format!("{joints},x[mm],y[mm],z[mm],qx,qy,qz,qw"));
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
