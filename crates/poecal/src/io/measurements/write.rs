//! A measurement file of simulated rows.

use std::fmt::Write as _;

use super::units::{Quantity, Unit};
use crate::error::{Error, ErrorKind, Result};
use crate::io::residuals::quoted;
use crate::measurement::{Dataset, Noise};
use crate::robot::{JointKind, Robot};

/// Rows of the unnamed target as a file that begins with a comment: joints in degrees and millimetres, positions in millimetres,
/// orientations as quaternions. Readings read back as the same numbers; measured ones are rounded to less than a thousandth of
/// their noise.
pub(in crate::io) fn text(data: &Dataset, robot: &Robot, noise: &Noise, comment: &str) -> Result<String> {
    let mm = Unit::parse("mm", Quantity::Length)?;
    let number = Quantity::Number.si_unit();
    let orientations = data.observations.iter().any(|row| row.measurement.sees_orientation());
    let units = reading_units(data.reading_names(), robot)?;
    let mut out = format!("# {comment}\n{}\n", header(data.reading_names(), &units, orientations)?);
    let position_decimals = decimals(mm.from_si(noise.position_m));
    // A rotation turns the quaternion by half its angle.
    let quaternion_decimals = decimals(noise.rotation_rad / 2.0);
    for (row, observation) in data.observations.iter().enumerate() {
        for (&reading, &unit) in data.readings(row).iter().zip(&units) {
            push_decimal(&mut out, reading, unit, None);
            out.push(',');
        }
        let pose = observation.measurement.pose();
        for (axis, &length) in pose.translation.iter().enumerate() {
            out.push_str(if axis == 0 { "" } else { "," });
            push_decimal(&mut out, length, mm, position_decimals);
        }
        if observation.measurement.sees_orientation() {
            for part in pose.quaternion_xyzw() {
                out.push(',');
                push_decimal(&mut out, part, number, quaternion_decimals);
            }
        } else if orientations {
            out.push_str(",,,,");
        }
        out.push('\n');
    }
    Ok(out)
}

/// The units that readings are written in: degrees and millimetres.
pub(super) fn reading_units(names: &[String], robot: &Robot) -> Result<Vec<Unit>> {
    let (deg, mm) = (Unit::parse("deg", Quantity::Angle)?, Unit::parse("mm", Quantity::Length)?);
    let unit = |name: &String| match robot.joints.iter().find(|joint| joint.reading.name == *name) {
        Some(joint) if joint.kind == JointKind::Prismatic => mm,
        _ => deg,
    };
    Ok(names.iter().map(unit).collect())
}

/// The header of a file of readings and measured positions, with orientations or without.
pub(super) fn header(names: &[String], units: &[Unit], orientations: bool) -> Result<String> {
    let measured_names: &[&str] =
        if orientations { &["x", "y", "z", "qx", "qy", "qz", "qw"] } else { &["x", "y", "z"] };
    if let Some(name) = names.iter().find(|name| measured_names.contains(&name.as_str())) {
        let message = format!(
            "found the joint `{name}` in the model, expected none with the name of a measured column, which could not be \
             read back: rename the joint in the model"
        );
        return Err(Error::new(ErrorKind::Model, message));
    }
    let measured = if orientations { "x[mm],y[mm],z[mm],qx,qy,qz,qw" } else { "x[mm],y[mm],z[mm]" };
    Ok(format!("{},{measured}", reading_header(names, units)))
}

/// The columns of the readings.
pub(super) fn reading_header(names: &[String], units: &[Unit]) -> String {
    let cell = |(name, unit): (&String, &Unit)| quoted(&format!("{name}[{}]", unit.symbol())).to_string();
    names.iter().zip(units).map(cell).collect::<Vec<_>>().join(",")
}

/// Decimals that leave less than a thousandth of a noise; `None`, all that there are, without noise.
fn decimals(noise: f64) -> Option<usize> {
    (noise > 0.0).then(|| (3.0 - noise.log10()).ceil().clamp(0.0, 17.0) as usize)
}

/// The powers of ten that a decimal's places stand for.
const POWERS: [f64; 18] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17];
/// Whole numbers below are exact.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Appends a number in a unit: with the decimals asked for (17 at most), else with as many as it takes to read back as the same number.
pub(super) fn push_decimal(out: &mut String, si: f64, unit: Unit, decimals: Option<usize>) {
    let value = unit.from_si(si);
    // The number in so many decimals is a whole number of the last one's steps.
    let steps = |power: f64| Some((value.abs() * power).round_ties_even()).filter(|steps| *steps < EXACT);
    let reads_back = |&(count, &power): &(usize, &f64)| {
        let again = match steps(power) {
            Some(steps) => Some((steps / power).copysign(value)),
            None => format!("{value:.count$}").parse().ok(),
        };
        again.is_some_and(|again| unit.to_si(again) == si)
    };
    let chosen = match decimals {
        Some(count) => POWERS.get(count).map(|power| (count, power)),
        None => POWERS.iter().enumerate().find(reads_back),
    };
    // Writing to a String cannot fail.
    let _ = match chosen.map(|(count, &power)| (count, power, steps(power))) {
        Some((count, power, Some(steps))) => {
            let (sign, steps, power) =
                (if value.is_sign_negative() { "-" } else { "" }, steps as u64, power as u64);
            match count {
                0 => write!(out, "{sign}{steps}"),
                _ => write!(out, "{sign}{}.{:0count$}", steps / power, steps % power),
            }
        }
        Some((count, _, None)) => write!(out, "{value:.count$}"),
        None => write!(out, "{value:?}"),
    };
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_core::{Rng, SeedableRng};

    use super::*;

    fn decimal(si: f64, unit: Unit, decimals: Option<usize>) -> String {
        let mut text = String::new();
        push_decimal(&mut text, si, unit, decimals);
        text
    }

    #[test]
    fn decimals_are_those_of_the_standard_library() {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let metre = Unit::parse("m", Quantity::Length).unwrap();
        for count in 0..=9 {
            for scale in [1e-12, 1e-3, 1.0, 1e12] {
                let value = scale * (generator.next_u64() as f64 / 2f64.powi(63) - 1.0);
                assert_eq!(decimal(value, metre, Some(count)), format!("{value:.count$}"));
            }
            assert_eq!(decimal(-0.0, metre, Some(count)), format!("{:.count$}", -0.0));
        }
    }

    #[test]
    fn readings_read_back_the_same() {
        let deg = Unit::parse("deg", Quantity::Angle).unwrap();
        let mm = Unit::parse("mm", Quantity::Length).unwrap();
        assert_eq!(decimal(deg.to_si(-12.3456), deg, None), "-12.3456");
        assert_eq!(decimal(mm.to_si(250.001), mm, None), "250.001");
        for si in [0.1 + 0.2, -1e-3, 3.0, 0.123_456_789_012_345_6] {
            assert_eq!(mm.to_si(decimal(si, mm, None).parse().unwrap()), si);
        }
    }

    #[test]
    fn a_joint_with_the_name_of_a_measured_column_is_refused() {
        let joint =
            crate::robot::Joint::prismatic("y", crate::lie::Screw::prismatic(&nalgebra::Vector3::y()));
        let robot = Robot::new("slide", vec![joint], crate::lie::Pose::identity()).unwrap();
        let noise = Noise { position_m: 0.0, rotation_rad: 0.0 };
        let error = text(&Dataset::new(robot.reading_names()), &robot, &noise, "").unwrap_err();
        assert_eq!(
            error.to_string(),
            "found the joint `y` in the model, expected none with the name of a measured column, which could not be \
             read back: rename the joint in the model"
        );
    }

    #[test]
    fn measured_numbers_are_as_long_as_their_noise_deserves() {
        let mm = Unit::parse("mm", Quantity::Length).unwrap();
        assert_eq!(decimal(0.812_310_012_345, mm, decimals(0.05)), "812.31001");
        assert_eq!(decimals(0.0), None);
    }
}
