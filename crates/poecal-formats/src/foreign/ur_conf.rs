//! The controller's files of an arm of Universal Robots: `urcontrol.conf` with its nominal DH table, and `calibration.conf` with the corrections of
//! the maker's calibration.

use std::path::{Path, PathBuf};

use super::driver_yaml::ur_arm;
use super::links::LinkTree;
use poecal_arm::lie::Pose;
use poecal_model::forms::AxisFrames;
use poecal_model::robot::{DhRow, DhTableConvention, JointKind, Robot};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::numbers::LARGEST_NUMBER;

/// Number of joints.
const JOINTS: usize = 6;
/// Corrections of a, d, alpha and theta by the maker's calibration.
const DELTAS: [&str; 4] = ["delta_a", "delta_d", "delta_alpha", "delta_theta"];
/// Required contents of the text.
const EXPECTED: &str =
    "a = [...], d = [...] and alpha = [...] of six numbers in [DH], as in the controller's urcontrol.conf";

/// The file beside a `calibration.conf` with the nominal table, if the text does not have it itself.
pub(crate) fn sibling(text: &str, path: &Path) -> Option<PathBuf> {
    let lines = lines(text, path);
    let has = |section: &str, key: &str| lines.iter().any(|line| line.section == section && line.key == key);
    let is_delta = DELTAS.iter().any(|key| has("mounting", key));
    (is_delta && !has("DH", "a")).then(|| path.with_file_name("urcontrol.conf"))
}

/// The arm of a text and of the one beside it.
pub(crate) fn read(text: &str, path: &Path, beside: Option<(&str, &Path)>) -> Result<LinkTree> {
    let mut lines = lines(text, path);
    lines.extend(beside.into_iter().flat_map(|(text, path)| self::lines(text, path)));
    let list = |section: &str, key: &str| -> Result<Option<[f64; JOINTS]>> {
        let mut found = lines.iter().filter(|line| line.section == section && line.key == key);
        let (first, second) = (found.next(), found.next());
        if let Some(line) = second {
            return Err(ErrorKind::Model
                .error(format!("found `{key}` a second time in [{section}], expected it once"))
                .at_line(line.path, line.number));
        }
        first.map(ConfLine::numbers).transpose()
    };
    let nominal = |key: &str| -> Result<[f64; JOINTS]> {
        list("DH", key)?.ok_or_else(|| {
            ErrorKind::Model.error(format!("found no `{key}` in [DH], expected {EXPECTED}")).in_file(path)
        })
    };
    let (a, d, alpha) = (nominal("a")?, nominal("d")?, nominal("alpha")?);
    if let Some(line) = lines.iter().find(|line| line.section == "mounting" && line.key == "calibration_status")
        && line.value == "0"
    {
        return Err(ErrorKind::Model.error("found calibration_status = 0, which says that the controller has no calibration, expected 1 or 2: leave the file out and \
                       read urcontrol.conf, the nominal arm").at_line(line.path, line.number));
    }
    let mut found = [None; 4];
    for (found, key) in found.iter_mut().zip(DELTAS) {
        *found = list("mounting", key)?;
    }
    let missing: Vec<&str> =
        DELTAS.into_iter().zip(&found).filter_map(|(key, it)| it.is_none().then_some(key)).collect();
    if !missing.is_empty() && missing.len() < DELTAS.len() {
        return Err(ErrorKind::Model
            .error(format!("found no {} in [mounting], expected all of {}", missing.join(", "), DELTAS.join(", ")))
            .in_file(path));
    }
    let deltas = found.map(Option::unwrap_or_default);
    let rows: Vec<DhRow> = (0..JOINTS)
        .map(|k| DhRow {
            name: format!("joint{}", k + 1),
            kind: JointKind::Revolute,
            a_m: a[k] + deltas[0][k],
            d_m: d[k] + deltas[1][k],
            alpha_rad: alpha[k] + deltas[2][k],
            theta_rad: deltas[3][k],
            fixed: Pose::identity(),
        })
        .collect();
    let place = |error: Error| error.in_file(path);
    let robot = Robot::from_dh("ur", DhTableConvention::Standard, &rows, Pose::identity(), Pose::identity());
    let mut frames = AxisFrames::from_robot(&robot.map_err(place)?).map_err(place)?;
    frames.end_at_tip();
    Ok(ur_arm(&frames))
}

/// `key = value` of a section.
struct ConfLine<'a> {
    path: &'a Path,
    section: &'a str,
    key: &'a str,
    value: &'a str,
    number: usize,
}

impl ConfLine<'_> {
    fn numbers(&self) -> Result<[f64; JOINTS]> {
        let refuse = |found: String| {
            ErrorKind::Model
                .error(format!("found {found} for `{}`, expected six numbers in brackets", self.key))
                .at_line(self.path, self.number)
        };
        let inside = self.value.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        let Some(inside) = inside else { return Err(refuse(format!("`{}`", self.value))) };
        let mut numbers = Vec::new();
        for word in inside.split(',').map(str::trim) {
            let number: f64 = word.parse().map_err(|_| refuse(format!("`{word}`")))?;
            // The maker's lengths are hundreds of metres for nearly parallel axes.
            if !number.is_finite() || number.abs() > LARGEST_NUMBER {
                return Err(refuse(format!("`{word}`")));
            }
            numbers.push(number);
        }
        let count = numbers.len();
        numbers.try_into().map_err(|_| refuse(format!("{count} numbers")))
    }
}

/// The lines with values.
fn lines<'a>(text: &'a str, path: &'a Path) -> Vec<ConfLine<'a>> {
    let mut section = "";
    let mut found = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.split(['#', ';']).next().unwrap_or_default().trim();
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            section = name.trim();
        } else if let Some((key, value)) = line.split_once('=') {
            found.push(ConfLine { path, section, key: key.trim(), value: value.trim(), number: index + 1 });
        }
    }
    found
}
