//! Numbers with a unit on the command line: `0.05mm`, `0.01deg`.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use poecal_compensate::MaxCorrection;
use poecal_model::robot::{Corrections, GravityDirection, Sizes, Tolerance};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::threads::MOST_THREADS;
use poecal_numerics::unit::Unit;
use poecal_plan::plan::RobotError;
use poecal_storage::limits::{self, ResourceLimit as FileLimit};

/// A number with its unit, in SI: metres for a length, radians for an angle.
///
/// # Errors
/// One sentence with found and expected.
pub(crate) fn parse(text: &str, quantity: Unit) -> Result<f64> {
    let (value, symbol) = value_and_symbol(text, example(quantity))?;
    Ok(NamedUnit::parse(symbol, quantity)?.to_si(value))
}

/// As [`parse`], for a number of either sign.
///
/// # Errors
/// As [`parse`].
pub(crate) fn parse_signed(text: &str, quantity: Unit) -> Result<f64> {
    let (value, symbol) = signed_and_symbol(text, example(quantity))?;
    Ok(NamedUnit::parse(symbol, quantity)?.to_si(value))
}

fn example(quantity: Unit) -> &'static str {
    match quantity {
        Unit::Metre => "0.05mm",
        Unit::Radian => "0.01deg",
        Unit::One => "3",
        Unit::Second => "12ms",
    }
}

/// A non-negative number, and the symbol of its unit.
fn value_and_symbol<'a>(text: &'a str, example: &str) -> Result<(f64, &'a str)> {
    match signed_and_symbol(text, example)? {
        (value, _) if value < 0.0 => Err(bad(text, "", " not below 0,", example)),
        found => Ok(found),
    }
}

/// The number and the symbol of its unit.
fn signed_and_symbol<'a>(text: &'a str, example: &str) -> Result<(f64, &'a str)> {
    let split = text.find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E')).unwrap_or(text.len());
    let (number, symbol) = text.split_at(split);
    match number.trim().parse::<f64>() {
        Ok(value) if !value.is_finite() => Err(bad(text, "", "", example)),
        Ok(_) if symbol.is_empty() => Err(bad(text, " without a unit", "", example)),
        Ok(value) => Ok((value, symbol.trim())),
        Err(_) => Err(bad(text, "", "", example)),
    }
}

fn bad(text: &str, what: &str, expected: &str, example: &str) -> Error {
    ErrorKind::Option.error(format!("found `{text}`{what}, expected a number{expected} with a unit, like {example}"))
}

/// A length and an angle as stated by the user: `1deg,2mm` in either order; an omitted one is zero.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LengthAndAngle {
    pub(crate) text: String,
    pub(crate) length_m: f64,
    pub(crate) angle_rad: f64,
    pub(crate) has_length: bool,
    pub(crate) has_angle: bool,
}

impl FromStr for LengthAndAngle {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (mut length_m, mut angle_rad) = (None, None);
        for part in text.split(',').map(str::trim) {
            let (value, symbol) = value_and_symbol(part, "2mm or 1deg")?;
            let unit = NamedUnit::parse_any(symbol)?;
            let place = if unit.si_unit() == Unit::Radian { &mut angle_rad } else { &mut length_m };
            if place.replace(unit.to_si(value)).is_some() {
                return ErrorKind::Option
                    .refuse(format!("found `{text}`, expected one length and one angle, like 2mm,1deg"));
            }
        }
        Ok(LengthAndAngle {
            text: text.to_owned(),
            length_m: length_m.unwrap_or(0.0),
            angle_rad: angle_rad.unwrap_or(0.0),
            has_length: length_m.is_some(),
            has_angle: angle_rad.is_some(),
        })
    }
}

/// Tolerance of the prior, `none`, `auto`, or the file that determines its sizes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BelievedTolerance {
    None,
    Auto,
    Given(Tolerance),
    /// A maker's calibration.
    Of(PathBuf),
}

impl FromStr for BelievedTolerance {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "none" => return Ok(BelievedTolerance::None),
            "auto" => return Ok(BelievedTolerance::Auto),
            file if file.to_ascii_lowercase().ends_with(".cfg") => {
                return Ok(BelievedTolerance::Of(file.into()));
            }
            _ => {}
        }
        let LengthAndAngle { length_m, angle_rad, .. } = text.parse()?;
        if length_m > 0.0 && angle_rad > 0.0 {
            return Ok(BelievedTolerance::Given(Tolerance { angle_rad, length_m }));
        }
        ErrorKind::Option.refuse(format!(
            "found `{text}`, expected an angle and a length above 0, like 0.5deg,5mm, or none, or auto, or MOC.cfg of a controller of ABB"
        ))
    }
}

/// Parser of a standard deviation of positions for clap.
pub(crate) fn sigma_m(text: &str) -> std::result::Result<f64, String> {
    above_zero(text, Unit::Metre)
}

/// Parser of a standard deviation of rotations for clap.
pub(crate) fn sigma_rad(text: &str) -> std::result::Result<f64, String> {
    above_zero(text, Unit::Radian)
}

fn above_zero(text: &str, quantity: Unit) -> std::result::Result<f64, String> {
    match parse(text, quantity) {
        Ok(value) if value > 0.0 => Ok(value),
        Ok(_) => Err(format!("found `{text}`, expected a standard deviation above 0")),
        Err(error) => Err(error.to_string()),
    }
}

/// Parser of a share for clap.
pub(crate) fn share(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err(format!("found `{text}`, expected a number from 0 to below 1")),
    }
}

/// Parser of the largest joint motion for clap: an omitted value is the default.
pub(crate) fn most_change(text: &str) -> std::result::Result<MaxCorrection, String> {
    let found: LengthAndAngle = text.parse().map_err(|error: Error| error.to_string())?;
    let default = MaxCorrection::default();
    let or = |value: f64, is_stated: bool, default: f64| if is_stated { value } else { default };
    let most = MaxCorrection {
        turning_rad: or(found.angle_rad, found.has_angle, default.turning_rad),
        sliding_m: or(found.length_m, found.has_length, default.sliding_m),
    };
    if most.turning_rad > 0.0 && most.sliding_m > 0.0 {
        return Ok(most);
    }
    Err(format!("found `{text}`, expected an angle and a length above 0, like 2deg,2mm"))
}

/// Parser of an error of a robot for clap: a length, 0 too.
pub(crate) fn error_m(text: &str) -> std::result::Result<f64, String> {
    parse(text, Unit::Metre).map_err(|error| error.to_string())
}

/// Parser of the remaining errors of a calibration for clap: of the calibrated model, and of the corrected one.
pub(crate) fn robot_error(text: &str) -> std::result::Result<RobotError, String> {
    let (calibrated, corrected) =
        text.split_once(',').map_or((text, None), |(first, second)| (first, Some(second.trim())));
    let error =
        RobotError { calibrated_m: error_m(calibrated.trim())?, corrected_m: corrected.map(error_m).transpose()? };
    if error.corrected_m.is_some_and(|it| it > error.calibrated_m) {
        return Err(format!(
            "found `{text}`, expected the error of the calibrated model and behind it the smaller one of the corrected model"
        ));
    }
    Ok(error)
}

/// Parser of a position for clap: three numbers, and their unit behind the last.
pub(crate) fn place_m(text: &str) -> std::result::Result<[f64; 3], String> {
    let bad = || format!("found `{text}`, expected three numbers with a unit behind the last, like 50,0,30mm");
    let (before, last) = text.rsplit_once(',').ok_or_else(bad)?;
    let (z, symbol) = signed_and_symbol(last, "30mm").map_err(|_| bad())?;
    let unit = NamedUnit::parse(symbol, Unit::Metre).map_err(|error| error.to_string())?;
    let others: Vec<Option<f64>> = before.split(',').map(|part| part.trim().parse().ok()).collect();
    match others[..] {
        [Some(x), Some(y)] if f64::is_finite(x) && f64::is_finite(y) => Ok([x, y, z].map(|it| unit.to_si(it))),
        _ => Err(bad()),
    }
}

/// Parser of a height for clap: a length of either sign.
pub(crate) fn height_m(text: &str) -> std::result::Result<f64, String> {
    parse_signed(text, Unit::Metre).map_err(|error| error.to_string())
}

/// Parser of two distances for clap.
pub(crate) fn distances_m(text: &str) -> std::result::Result<[f64; 2], String> {
    let found = text.split_once(':').and_then(|(a, b)| Some([error_m(a).ok()?, error_m(b).ok()?]));
    found
        .filter(|[a, b]| a < b)
        .ok_or_else(|| format!("found `{text}`, expected two lengths, the shorter first, like 0.5m:10m"))
}

/// Workspace of a robot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WorkspaceChoice {
    /// Anywhere within its limits.
    Limits,
    /// In the configurations of a file.
    Tasks(PathBuf),
    /// With the tip between two corners, metres in the base frame.
    Box([[f64; 3]; 2]),
}

impl FromStr for WorkspaceChoice {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        if text == "limits" {
            return Ok(WorkspaceChoice::Limits);
        }
        box_m(text).map(WorkspaceChoice::Box).or_else(|message| {
            let is_box = text.split(':').all(|corner| corner.split(',').count() == 3);
            if is_box { Err(message) } else { Ok(WorkspaceChoice::Tasks(text.into())) }
        })
    }
}

/// Parser of a box for clap: two corners, and the unit of all numbers behind the last.
pub(crate) fn box_m(text: &str) -> std::result::Result<[[f64; 3]; 2], String> {
    let bad =
        || format!("found `{text}`, expected two corners with a unit behind the last, like 300,-200,0:600,200,500mm");
    let (first, last) = text.split_once(':').ok_or_else(bad)?;
    let b = place_m(last).map_err(|_| bad())?;
    let symbol = last.trim_start_matches(|c: char| !c.is_alphabetic());
    let a = place_m(&format!("{first}{symbol}")).map_err(|_| bad())?;
    Ok([[0, 1, 2].map(|k| f64::min(a[k], b[k])), [0, 1, 2].map(|k| f64::max(a[k], b[k]))])
}

/// Parser of a direction for clap: three numbers, not all of them 0.
pub(crate) fn direction(text: &str) -> std::result::Result<[f64; 3], String> {
    match text.parse()? {
        GravityDirection::Known(direction) => Ok(direction.into()),
        GravityDirection::Found => Err("found `find`, expected a direction, like 0,0,-1".to_owned()),
    }
}

/// Parser of sizes of terms for clap.
pub(crate) fn terms(text: &str) -> std::result::Result<Sizes, String> {
    match text.parse()? {
        Corrections::Off => Ok(Sizes::NONE),
        Corrections::Sizes(sizes) => Ok(sizes),
        Corrections::Auto | Corrections::All => {
            Err(format!("found `{text}`, expected off, or groups like sag=1e-3,ratio"))
        }
    }
}

/// Parser of a count for clap.
pub(crate) fn parse_count<T: FromStr>(text: &str) -> std::result::Result<T, String> {
    text.parse().map_err(|_| format!("found `{text}`, expected a whole number"))
}

/// Parser of a duration for clap.
pub(crate) fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let number = text.strip_suffix('s').unwrap_or(text).parse::<f64>();
    match number {
        Ok(number) if (0.05..=86400.0).contains(&number) => Ok(Duration::from_secs_f64(number)),
        _ => Err(format!("found `{text}`, expected seconds from 0.05 to 86400, like 2s")),
    }
}

/// Value of `--limit`: of files for all commands, and of a change for `compare`, which had the word first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LimitArgument {
    /// Limit of a file.
    File(FileLimit, u64),
    /// Largest permitted motion of the tip, metres.
    Change(f64),
}

/// Parser of a file limit for clap.
pub(crate) fn limit_of_files(text: &str) -> Result<LimitArgument> {
    limits::parse(text).map(|(limit, most)| LimitArgument::File(limit, most))
}

/// Parser of the tip's largest permitted motion for clap, or of a file limit.
pub(crate) fn limit_of_change(text: &str) -> std::result::Result<LimitArgument, String> {
    if text.contains('=') {
        return limit_of_files(text).map_err(|error| error.to_string());
    }
    sigma_m(text).map(LimitArgument::Change)
}

/// Parser of a number of threads for clap.
pub(crate) fn threads(text: &str) -> std::result::Result<usize, String> {
    match parse_count(text)? {
        count @ 1..=MOST_THREADS => Ok(count),
        _ => Err(format!("found `{text}`, expected a whole number from 1 to {MOST_THREADS}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_and_an_angle_come_in_either_order() {
        let both = |text: &str| text.parse::<LengthAndAngle>().map(|both| (both.length_m, both.angle_rad));
        assert_eq!(both("1deg,2mm"), Ok((0.002, 1f64.to_radians())));
        assert_eq!(both("2mm, 1deg"), both("1deg,2mm"));
        assert_eq!(both("0.05mm"), Ok((5e-5, 0.0)));
        let most = |text: &str| most_change(text).map(|it| (it.turning_rad, it.sliding_m));
        assert_eq!(most("3deg"), Ok((3f64.to_radians(), 0.002)));
        assert_eq!(most("1mm,1deg"), Ok((1f64.to_radians(), 0.001)));
        assert!(most("0deg").unwrap_err().starts_with("found `0deg`, expected an angle and a length above 0"));
        let message = |text: &str| both(text).unwrap_err().to_string();
        assert_eq!(message("1mm,2mm"), "found `1mm,2mm`, expected one length and one angle, like 2mm,1deg");
        assert_eq!(message("1"), "found `1` without a unit, expected a number with a unit, like 2mm or 1deg");
        assert_eq!(
            message("2mm,1grad"),
            "found the unit `grad`, expected one of m, cm, mm, um, nm, in, rad, mrad, deg, arcmin, arcsec, ticks"
        );
    }
}
