//! Arguments of Python functions: each is refused by one sentence that names it, with what was found and what was expected.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;

use poecal_calibrate::{AcceptanceLimits, Corrections, RepairLimits};
use poecal_cli::words;
use poecal_formats::urdf::ChainSelection;
use poecal_model::robot::GravityDirection;
use poecal_numerics::error::Error;
use poecal_plan::plan::RobotError;
use poecal_results::record::Record;
use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};

use crate::errors::argument;
use crate::units;
use crate::words::{from_mm, one_of, shorten_text};

/// Type of an argument.
pub(crate) trait Argument<'a, 'py>: Sized {
    /// The argument `name`.
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self>;
}

/// A function for each name of an argument, for `#[pyo3(from_py_with = …)]`, which does not pass names.
macro_rules! named {
    ($($name:ident)*) => { $(
        pub(crate) fn $name<'a, 'py, T: Argument<'a, 'py>>(value: &'a Bound<'py, PyAny>) -> PyResult<T> {
            T::from_argument(value, stringify!($name))
        }
    )* };
}

named! {
    accept accept_model actual angle_unit angular_first base_link body camera cameras certificate check columns contact controller_base
    controller_flange convention corrections count criterion device device_aim_mm device_frame device_frames device_half_angle_deg device_mm
    distance_mm earlier error_position_mm error_rotation_deg experiment fix flange floor_height_mm folder force format formulation
    frame_names free gravity harmonics hash held_out held_out_count history id ids ignore_sets instrument_noise instruments join kind kinds
    lag language length_unit level limit_mm limits logo margin_deg_mm markers max_slide_m max_slide_mm max_turn_deg max_turn_rad
    measurements method model motors move_tip name names nearest noise_position_mm noise_rotation_deg nominal offset out output_frame part
    parts path paths points progress purpose quantity readings record refit repair repair_limit repeatability_mm
    replace_rows report residual residuals robot robot_error_mm robust seed self_collision separation_deg sets sheet sigma_position_mm
    sigma_rotation_deg socket_distance start starts stop_s strict summary target target_half_angle_deg target_normal target_offset_mm
    targets terms text third_axis tip_link tips tolerance_deg_mm tool tool_data topics train_where trials units with_uncertainty
    work_objects
}

/// Refuses keywords that a class does not have, as `poecal._keywords` does for functions.
pub(crate) fn refuse_unknown<T: PyTypeInfo>(py: Python<'_>, unknown: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
    let Some((name, _)) = unknown.and_then(|it| it.iter().next()) else { return Ok(()) };
    let refused = py.import("poecal._keywords")?.call_method1("unknown", (py.get_type::<T>(), name))?;
    Err(PyErr::from_value(refused))
}

/// The error for an argument that differs from the expectation.
pub(crate) fn unexpected_error(name: &str, value: &Bound<'_, PyAny>, expected: impl Display) -> PyErr {
    argument(name, format!("found {}, expected {expected}", describe_value(value)))
}

/// Description of a value, in words.
pub(crate) fn describe_value(value: &Bound<'_, PyAny>) -> String {
    let type_name = || value.get_type().name().map_or_else(|_| "something".to_owned(), |name| name.to_string());
    if value.is_none() {
        return "None".to_owned();
    }
    if let Ok(text) = value.cast::<PyString>() {
        return format!("the text `{}`", shorten_text(&text.to_string_lossy()));
    }
    let is_scalar = || value.getattr("ndim").and_then(|it| it.extract::<usize>()).is_ok_and(|ndim| ndim == 0);
    if value.is_instance_of::<PyInt>() || value.is_instance_of::<PyFloat>() || is_scalar() {
        return value.str().map_or_else(|_| type_name(), |text| shorten_text(&text.to_string_lossy()));
    }
    type_name()
}

/// True if a text is that of a file, and not the path of one.
pub(crate) fn is_content(text: &str) -> bool {
    let text = text.trim_start_matches('\u{feff}').trim();
    text.contains('\n') || (text.starts_with('<') && text.contains('>')) || text.starts_with("{\"")
}

macro_rules! whole_numbers {
    ($($kind:ty)*) => { $(
        impl<'a, 'py> Argument<'a, 'py> for $kind {
            fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
                let expected = format!("a whole number from 0 to {}", <$kind>::MAX);
                value.extract().map_err(|_| unexpected_error(name, value, expected))
            }
        }
    )* };
}

whole_numbers! { u32 u64 usize }

impl<'a, 'py> Argument<'a, 'py> for f64 {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        if let (Some(unit), true) = (units::of_name(name), value.is_instance_of::<PyString>()) {
            return units::in_unit(<&str>::from_argument(value, name)?, unit, name);
        }
        value.extract().map_err(|_| unexpected_error(name, value, "a number"))
    }
}

impl<'a, 'py> Argument<'a, 'py> for bool {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        value.extract().map_err(|_| unexpected_error(name, value, "True or False"))
    }
}

impl<'a, 'py> Argument<'a, 'py> for &'a str {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let text = value.cast::<PyString>().map_err(|_| unexpected_error(name, value, "a text"))?;
        text.to_str().map_err(|_| unexpected_error(name, value, "a text of Unicode characters"))
    }
}

impl<'a, 'py> Argument<'a, 'py> for String {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        <&str>::from_argument(value, name).map(str::to_owned)
    }
}

impl<'a, 'py> Argument<'a, 'py> for PathBuf {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let path: PathBuf =
            value.extract().map_err(|_| unexpected_error(name, value, "a path: a text, or an os.PathLike"))?;
        if path.as_os_str().is_empty() {
            return Err(argument(name, "found an empty text, expected a path"));
        }
        if path.to_str().is_some_and(is_content) {
            let expected = "the path of a file that holds it; a robot model's text is read by poecal.Robot.from_text";
            return Err(unexpected_error(name, value, expected));
        }
        Ok(path)
    }
}

impl<'a, 'py, T: Argument<'a, 'py>> Argument<'a, 'py> for Option<T> {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        if value.is_none() { Ok(None) } else { T::from_argument(value, name).map(Some) }
    }
}

impl<'a, 'py, T: for<'b> Argument<'b, 'py>> Argument<'a, 'py> for Vec<T> {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let entries: Vec<Bound<'py, PyAny>> = value.extract().map_err(|_| unexpected_error(name, value, "a list"))?;
        let entry = |(at, entry): (usize, &Bound<'py, PyAny>)| T::from_argument(entry, &format!("{name}[{at}]"));
        entries.iter().enumerate().map(entry).collect()
    }
}

/// Some of a few words: a list, or a text with commas as in the program.
pub(crate) struct WordSet(Vec<String>);

impl WordSet {
    /// Their meanings.
    pub(crate) fn choose<T: Copy>(&self, name: &str, words: words::WordList<T>) -> PyResult<Vec<T>> {
        self.0.iter().map(|word| one_of(name, word, words)).collect()
    }
}

impl<'a, 'py> Argument<'a, 'py> for WordSet {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        if value.is_instance_of::<PyString>() {
            return Ok(WordSet(
                <&str>::from_argument(value, name)?.split(',').map(|word| word.trim().to_owned()).collect(),
            ));
        }
        Vec::from_argument(value, name).map(WordSet)
    }
}

impl<'a, 'py> Argument<'a, 'py> for (f64, f64) {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let value = &units::split_list(value, name)?;
        if value.len().is_ok_and(|length| length != 2) || value.try_iter().is_err() {
            return Err(unexpected_error(name, value, "two numbers"));
        }
        match Vec::<f64>::from_argument(value, name)?.as_slice() {
            [first, second] => Ok((*first, *second)),
            _ => Err(unexpected_error(name, value, "two numbers")),
        }
    }
}

impl<'a, 'py> Argument<'a, 'py> for [f64; 3] {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let value = &units::split_list(value, name)?;
        if value.try_iter().is_err() {
            return Err(unexpected_error(name, value, "three numbers"));
        }
        match Vec::<f64>::from_argument(value, name)?.as_slice() {
            [x, y, z] => Ok([*x, *y, *z]),
            found => Err(argument(name, format!("found {} numbers, expected three", found.len()))),
        }
    }
}

impl<'a, 'py> Argument<'a, 'py> for RobotError {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let value = &units::split_list(value, name)?;
        let (calibrated_mm, corrected_mm) = match value.try_iter() {
            Ok(_) if !value.is_instance_of::<PyString>() => {
                <(f64, f64)>::from_argument(value, name).map(|it| (it.0, Some(it.1)))?
            }
            _ => (f64::from_argument(value, name)?, None),
        };
        let calibrated_m = crate::words::size(name, calibrated_mm, from_mm)?;
        let corrected_m = corrected_mm.map(|it| crate::words::size(name, it, from_mm)).transpose()?;
        if corrected_m.is_some_and(|it| it > calibrated_m) {
            let message = format!(
                "found ({calibrated_mm}, {}), expected the error of the calibrated model and the smaller one of the corrected model",
                corrected_mm.unwrap_or_default()
            );
            return Err(argument(name, message));
        }
        Ok(RobotError { calibrated_m, corrected_m })
    }
}

/// Tolerance of the prior: none, chosen by cross-validation, degrees and millimetres, or a maker's file.
#[derive(Clone, PartialEq)]
pub(crate) enum PriorTolerance {
    None,
    Auto,
    Given((f64, f64)),
    Of(PathBuf),
}

impl<'a, 'py> Argument<'a, 'py> for PriorTolerance {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        match value.cast::<PyString>().ok().map(|text| text.to_string_lossy().into_owned()) {
            Some(text) if text == "auto" => Ok(PriorTolerance::Auto),
            Some(text) if text.to_ascii_lowercase().ends_with(".cfg") => Ok(PriorTolerance::Of(text.into())),
            Some(text) if text.contains(',') => <(f64, f64)>::from_argument(value, name).map(PriorTolerance::Given),
            Some(_) => Err(unexpected_error(
                name,
                value,
                "two numbers, a text like \"0.5deg,5mm\", \"auto\", the path of a MOC.cfg, or None",
            )),
            None if value.is_none() => Ok(PriorTolerance::None),
            None => <(f64, f64)>::from_argument(value, name).map(PriorTolerance::Given),
        }
    }
}

impl<'a, 'py> Argument<'a, 'py> for GravityDirection {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        if value.is_instance_of::<PyString>() {
            return String::from_argument(value, name)?.parse().map_err(|message: String| argument(name, message));
        }
        crate::words::direction(<[f64; 3]>::from_argument(value, name)?).map(GravityDirection::Known)
    }
}

impl<'a, 'py> Argument<'a, 'py> for Corrections {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let words = if value.is_instance_of::<PyString>() {
            String::from_argument(value, name)?
        } else if value.is_instance_of::<PyDict>() {
            let sizes = BTreeMap::<String, f64>::from_argument(value, name)?;
            sizes.iter().map(|(group, size)| format!("{group}={size:e}")).collect::<Vec<_>>().join(",")
        } else {
            return Err(unexpected_error(name, value, "a text, or a dict of groups of terms and their sizes"));
        };
        words.parse().map_err(|message: String| argument(name, message))
    }
}

impl<'a, 'py> Argument<'a, 'py> for BTreeMap<String, f64> {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let expected = "a dict of names and numbers";
        let entries = value.cast::<PyDict>().map_err(|_| unexpected_error(name, value, expected))?;
        let entry = |(key, number): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
            let key = String::from_argument(&key, &format!("{name}, a key"))?;
            let name = format!("{name}[\"{key}\"]");
            let number = match number.cast::<PyString>() {
                Ok(text) => units::in_si(&text.to_string_lossy(), &name)?,
                Err(_) => f64::from_argument(&number, &name)?,
            };
            Ok((key, number))
        };
        entries.iter().map(entry).collect()
    }
}

/// A value in the program's notation; `expected` describes it.
fn parsed<T: FromStr<Err = Error>>(value: &Bound<'_, PyAny>, name: &str, expected: &str) -> PyResult<T> {
    if !value.is_instance_of::<PyString>() {
        return Err(unexpected_error(name, value, expected));
    }
    String::from_argument(value, name)?.parse().map_err(|error: Error| argument(name, error.message()))
}

impl<'a, 'py> Argument<'a, 'py> for AcceptanceLimits {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        parsed(value, name, "a text, like \"0.2mm\" or \"0.2mm,max:0.5mm\"")
    }
}

impl<'a, 'py> Argument<'a, 'py> for RepairLimits {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        parsed(value, name, "a text, like \"device=100mm\" or \"tool=30mm,zero=10deg\"")
    }
}

impl<'a, 'py> Argument<'a, 'py> for Record {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let entries = value.cast::<PyDict>().map_err(|_| unexpected_error(name, value, "a dict of keys and texts"))?;
        let entry = |(key, text): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
            let key = String::from_argument(&key, &format!("{name}, a key"))?;
            let text = String::from_argument(&text, &format!("{name}[\"{key}\"]"))?;
            Ok((key, text))
        };
        let entries: Vec<(String, String)> = entries.iter().map(entry).collect::<PyResult<_>>()?;
        let pairs = entries.iter().map(|(key, text)| (key.as_str(), text.as_str()));
        Record::from_pairs(pairs).map_err(|error| argument(name, error.message()))
    }
}

/// Names with their links, in their order.
pub(crate) struct NamedLinks(pub(crate) Vec<(String, String)>);

impl<'a, 'py> Argument<'a, 'py> for NamedLinks {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let entries = value.cast::<PyDict>().map_err(|_| unexpected_error(name, value, "a dict of names and links"))?;
        let entry = |(key, link): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
            let key = String::from_argument(&key, &format!("{name}, a key"))?;
            let link = String::from_argument(&link, &format!("{name}[\"{key}\"]"))?;
            Ok((key, link))
        };
        entries.iter().map(entry).collect::<PyResult<_>>().map(NamedLinks)
    }
}

/// The links of a URDF that are read.
pub(crate) fn selection(
    base_link: Option<String>,
    tip_link: Option<String>,
    instruments: Option<NamedLinks>,
    targets: Option<NamedLinks>,
) -> ChainSelection {
    let links = |links: Option<NamedLinks>| links.map_or_else(Vec::new, |links| links.0);
    ChainSelection { base_link, tip_link, instruments: links(instruments), targets: links(targets) }
}

/// A path, or several.
pub(crate) struct Paths(pub(crate) Vec<PathBuf>);

impl<'a, 'py> Argument<'a, 'py> for Paths {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let is_list = || value.extract::<Vec<Bound<'py, PyAny>>>().is_ok();
        if !value.is_instance_of::<PyString>() && is_list() {
            return Vec::from_argument(value, name).map(Paths);
        }
        if value.extract::<PathBuf>().is_err() {
            return Err(unexpected_error(name, value, "a path, or a list of paths"));
        }
        PathBuf::from_argument(value, name).map(|path| Paths(vec![path]))
    }
}

/// A function to call.
pub(crate) struct CallableArgument(pub(crate) Py<PyAny>);

impl<'a, 'py> Argument<'a, 'py> for CallableArgument {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        if value.is_instance_of::<PyBool>() && value.is_truthy()? {
            let bar = value.py().import("poecal._progress")?.getattr("Bar")?;
            return Ok(CallableArgument(bar.call0()?.unbind()));
        }
        if value.is_callable() {
            return Ok(CallableArgument(value.clone().unbind()));
        }
        Err(unexpected_error(name, value, "a function of one text, or True for a bar"))
    }
}
