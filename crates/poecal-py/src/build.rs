//! Robots from arrays, through a TOML model, whose reader makes all checks.

use std::fmt::Write as _;

use poecal_arm::lie::Pose;
use poecal_formats::robot_toml;
use poecal_numerics::error::Error;
use poecal_results::model::{Model, ModelSource};
use pyo3::prelude::*;

use crate::arrays::{NumberArray, pose};
use crate::errors::{argument, raise};
use crate::words::choose_word;

/// Arguments that do not concern geometry.
pub(crate) struct NamingArguments<'a, 'py> {
    pub(crate) name: &'a str,
    pub(crate) names: Option<Vec<String>>,
    pub(crate) limits: Option<&'a Bound<'py, PyAny>>,
    pub(crate) base_link: &'a str,
    pub(crate) tip_link: &'a str,
}

impl NamingArguments<'_, '_> {
    /// Names of the joints.
    fn joints(&self, count: usize) -> PyResult<Vec<String>> {
        let Some(names) = &self.names else {
            return Ok((1..=count).map(|index| format!("joint{index}")).collect());
        };
        check_count("names", names.len(), count)?;
        Ok(names.clone())
    }

    /// Limits as keys of the joints' tables.
    fn limits(&self, count: usize) -> PyResult<Vec<String>> {
        let Some(limits) = self.limits else { return Ok(vec![String::new(); count]) };
        let expected = format!("shape ({count}, 2): lower and upper limit of each joint, radians or metres");
        let limits = NumberArray::from_argument(limits, "limits", &expected)?.require_shape(
            &[Some(count), Some(2)],
            "limits",
            &expected,
        )?;
        let key = |row: &[f64]| match row {
            [lower, upper] if lower.is_finite() && upper.is_finite() => {
                format!(", limits = [{lower:?}, {upper:?}]")
            }
            _ => String::new(),
        };
        Ok(limits.values.chunks_exact(2).map(key).collect())
    }

    /// The model of the TOML text that begins with this and continues with `rest`.
    fn model(&self, rest: &str) -> PyResult<Model> {
        let text = format!(
            "poecal_robot = 1\nname = {}\nlength_unit = \"m\"\nangle_unit = \"rad\"\nbase_link = {}\ntip_link = {}\n{rest}",
            quote_toml(self.name),
            quote_toml(self.base_link),
            quote_toml(self.tip_link)
        );
        // A position in a text that the user did not write would mislead.
        let without_place = |error: Error| raise(Error::new(error.kind(), error.message()));
        let robot = robot_toml::parse(&text, self.name).map_err(without_place)?;
        Ok(Model { robot, source: ModelSource::Toml, path: self.name.into() })
    }
}

/// Refuses another number of an argument's entries than one for each joint.
fn check_count(name: &str, found: usize, joints: usize) -> PyResult<()> {
    if found == joints {
        return Ok(());
    }
    Err(argument(name, format!("found {found} {name}, expected one for each of {joints} joints")))
}

/// A TOML string.
fn quote_toml(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            // Writing to a String cannot fail.
            c if c.is_control() => drop(write!(out, "\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out + "\""
}

/// A pose as a TOML table.
fn pose_table(name: &str, pose: &Pose) -> String {
    let [x, y, z]: [f64; 3] = pose.translation.into();
    let row = |row: usize| {
        let at = |column: usize| pose.rotation[(row, column)];
        format!("[{:?}, {:?}, {:?}]", at(0), at(1), at(2))
    };
    format!("[{name}]\nposition = [{x:?}, {y:?}, {z:?}]\nrotation = [{}, {}, {}]\n", row(0), row(1), row(2))
}

pub(crate) fn from_screws(
    screws: &Bound<'_, PyAny>,
    home: &Bound<'_, PyAny>,
    angular_first: bool,
    naming: &NamingArguments<'_, '_>,
) -> PyResult<Model> {
    let expected = "shape (n, 6): a unit twist a joint";
    let screws = NumberArray::finite_of(screws, "screws", &[None, Some(6)], expected)?;
    let count = screws.rows();
    let (names, limits) = (naming.joints(count)?, naming.limits(count)?);
    let mut text = "joint = [\n".to_owned();
    for ((row, name), limits) in screws.values.chunks_exact(6).zip(&names).zip(&limits) {
        let (first, last) = row.split_at(3);
        let (v, w) = if angular_first { (last, first) } else { (first, last) };
        let kind = if w.iter().all(|part| *part == 0.0) { "prismatic" } else { "revolute" };
        let name = quote_toml(name);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{{ name = {name}, type = \"{kind}\", screw = {{ v = {v:?}, w = {w:?} }}{limits} }},");
    }
    text.push_str("]\n");
    naming.model(&(text + &pose_table("home", &pose(home, "home")?)))
}

/// Denavit-Hartenberg parameters as arguments.
pub(crate) struct DhArguments<'a, 'py> {
    pub(crate) a_m: &'a Bound<'py, PyAny>,
    pub(crate) alpha_rad: &'a Bound<'py, PyAny>,
    pub(crate) d_m: &'a Bound<'py, PyAny>,
    pub(crate) theta_rad: &'a Bound<'py, PyAny>,
    pub(crate) convention: &'a str,
    pub(crate) kinds: Option<Vec<String>>,
    pub(crate) base: Option<&'a Bound<'py, PyAny>>,
    pub(crate) tool: Option<&'a Bound<'py, PyAny>>,
}

pub(crate) fn from_dh(table: &DhArguments<'_, '_>, naming: &NamingArguments<'_, '_>) -> PyResult<Model> {
    let words = [("standard", "standard_dh"), ("modified", "modified_dh")];
    let convention = choose_word("convention", table.convention, &words)?;
    let a = NumberArray::finite_of(table.a_m, "a_m", &[None], "shape (n,), metres")?;
    let count = a.rows();
    let expected = format!("shape ({count},) as a_m");
    let column = |value, name| NumberArray::finite_of(value, name, &[Some(count)], &expected);
    let columns = [
        a.values,
        column(table.alpha_rad, "alpha_rad")?.values,
        column(table.d_m, "d_m")?.values,
        column(table.theta_rad, "theta_rad")?.values,
    ];
    let kinds = match &table.kinds {
        Some(kinds) => {
            check_count("kinds", kinds.len(), count)?;
            let words = [("revolute", "revolute"), ("prismatic", "prismatic")];
            kinds.iter().map(|kind| choose_word("kinds", kind, &words)).collect::<PyResult<_>>()?
        }
        None => vec!["revolute"; count],
    };
    let (names, limits) = (naming.joints(count)?, naming.limits(count)?);
    let mut text = format!("convention = \"{convention}\"\njoint = [\n");
    for (row, ((name, kind), limits)) in names.iter().zip(kinds).zip(&limits).enumerate() {
        let name = quote_toml(name);
        let _ = write!(text, "{{ name = {name}, type = \"{kind}\"");
        for (key, values) in ["a", "alpha", "d", "theta"].iter().zip(&columns) {
            let _ = write!(text, ", {key} = {:?}", values.get(row).copied().unwrap_or_default());
        }
        let _ = writeln!(text, "{limits} }},");
    }
    text.push_str("]\n");
    for (name, place) in [("base", table.base), ("tool", table.tool)] {
        if let Some(place) = place {
            text.push_str(&pose_table(name, &pose(place, name)?));
        }
    }
    naming.model(&text)
}
