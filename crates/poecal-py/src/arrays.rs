//! NumPy arrays in and out.

use nalgebra::Matrix3;
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods as _, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods as _,
};
use poecal_arm::lie::Pose;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::errors::argument;

/// Largest deviation from a rotation matrix: rounding of matrices printed with three decimals.
const ROTATION_TOLERANCE: f64 = 1e-2;

/// Numbers of an array-like in C order, with their shape.
pub(crate) struct NumberArray {
    pub(crate) values: Vec<f64>,
    pub(crate) shape: Vec<usize>,
    /// True if some of them were masked: these are NaN.
    masked: bool,
}

impl NumberArray {
    /// The numbers of `value`, the argument `name`: float32, integers, lists and arrays of any layout become float64, and masked
    /// numbers NaN.
    pub(crate) fn from_argument(value: &Bound<'_, PyAny>, name: &str, expected: &str) -> PyResult<Self> {
        let unmasked = unmask(value, name, expected)?;
        let (value, masked) = (unmasked.as_ref().unwrap_or(value), unmasked.is_some());
        let array = match value.extract::<PyReadonlyArrayDyn<'_, f64>>() {
            Ok(array) if array.is_c_contiguous() => array,
            _ => convert_array(value, name, expected)?,
        };
        Ok(NumberArray { shape: array.shape().to_vec(), values: array.as_slice()?.to_vec(), masked })
    }

    /// A number for each of some rows.
    pub(crate) fn repeat_number(number: f64, rows: usize) -> Self {
        NumberArray { values: vec![number; rows], shape: vec![rows], masked: false }
    }

    /// The numbers of `value`, refused if a number is not finite.
    pub(crate) fn require_finite(value: &Bound<'_, PyAny>, name: &str, expected: &str) -> PyResult<Self> {
        let numbers = NumberArray::from_argument(value, name, expected)?;
        let row_length: usize = numbers.shape.iter().skip(1).product::<usize>().max(1);
        match numbers.values.iter().enumerate().find(|(_, number)| !number.is_finite()) {
            Some((at, number)) => {
                let place = match numbers.shape.len() {
                    0 | 1 => format!("at index {at}"),
                    _ => format!("in row {}", at / row_length),
                };
                let message = match numbers.masked {
                    true => format!(
                        "found a masked number, or {number}, {place}, expected finite numbers: leave such rows out"
                    ),
                    false => format!("found {number} {place}, expected finite numbers"),
                };
                Err(argument(name, message))
            }
            None => Ok(numbers),
        }
    }

    /// Finite numbers of the shape `wanted`, as [`NumberArray::require_shape`].
    pub(crate) fn finite_of(
        value: &Bound<'_, PyAny>,
        name: &str,
        wanted: &[Option<usize>],
        expected: &str,
    ) -> PyResult<Self> {
        NumberArray::require_finite(value, name, expected)?.require_shape(wanted, name, expected)
    }

    /// Refuses another shape than `wanted`, in which `None` is any length.
    pub(crate) fn require_shape(self, wanted: &[Option<usize>], name: &str, expected: &str) -> PyResult<Self> {
        let fits = |(&found, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|wanted| found == wanted);
        if self.shape.len() == wanted.len() && self.shape.iter().zip(wanted).all(fits) {
            return Ok(self);
        }
        Err(argument(name, format!("found an array of shape {}, expected {expected}", self.shape_words())))
    }

    /// The shape as Python prints it.
    pub(crate) fn shape_words(&self) -> String {
        match self.shape.as_slice() {
            [length] => format!("({length},)"),
            shape => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
        }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.shape.first().copied().unwrap_or(1)
    }
}

/// A masked array, or a list of some, as an array with NaN for masked values; `None` if nothing is masked.
fn unmask<'py>(value: &Bound<'py, PyAny>, name: &str, expected: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
    // An object of exactly this type has no mask, and most arguments are.
    if value.is_exact_instance_of::<PyUntypedArray>() {
        return Ok(None);
    }
    let masked = value.py().import("numpy.ma")?;
    let class = masked.getattr("MaskedArray")?;
    let is_masked = |it: &Bound<'py, PyAny>| it.is_instance(&class);
    let entries =
        if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() { Some(value) } else { None };
    let mut has_masked = is_masked(value)?;
    for entry in entries.into_iter().flat_map(|it| it.try_iter()).flatten() {
        has_masked |= is_masked(&entry?)?;
    }
    if !has_masked {
        return Ok(None);
    }
    let wrong = |cause: PyErr| argument(name, format!("found no array of numbers ({cause}), expected {expected}"));
    let array = masked.call_method1("asarray", (value,)).map_err(wrong)?;
    if !masked.call_method1("is_masked", (&array,))?.is_truthy()? {
        return array.getattr("data").map(Some);
    }
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !["f", "i", "u"].contains(&kind.as_str()) {
        return Err(argument(name, format!("found values of type {}, expected {expected}", array.getattr("dtype")?)));
    }
    array.call_method1("astype", ("float64",))?.call_method1("filled", (f64::NAN,)).map(Some)
}

/// `numpy.ascontiguousarray(value, dtype=float)`, refused if that would be lossy or ambiguous.
fn convert_array<'py>(value: &Bound<'py, PyAny>, name: &str, expected: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let numpy = value.py().import("numpy")?;
    let array = numpy
        .call_method1("asarray", (value,))
        .map_err(|cause| argument(name, format!("found no array ({cause}), expected {expected}")))?;
    let dtype = array.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    if !["f", "i", "u"].contains(&kind.as_str()) {
        let found = if value.is_none() { "None".to_owned() } else { format!("values of type {dtype}") };
        return Err(argument(name, format!("found {found}, expected {expected}")));
    }
    let array = numpy.call_method1("ascontiguousarray", (array, "float64"))?;
    // A scalar becomes an array of one element.
    let array = if value.getattr("__len__").is_err() { array.call_method1("reshape", ((),))? } else { array };
    array.extract()
}

/// The argument `name` as one pose, an array of shape (4, 4).
pub(crate) fn pose(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Pose> {
    let expected = "a pose of shape (4, 4)";
    let numbers = NumberArray::finite_of(value, name, &[Some(4), Some(4)], expected)?;
    pose_of(&numbers.values).map_err(|message| argument(name, message))
}

/// The pose of 16 numbers, row by row.
pub(crate) fn pose_of(numbers: &[f64]) -> Result<Pose, String> {
    let at = |row: usize, column: usize| numbers.get(4 * row + column).copied().unwrap_or_default();
    let last = [at(3, 0), at(3, 1), at(3, 2), at(3, 3)];
    if last != [0.0, 0.0, 0.0, 1.0] {
        return Err(format!("found the last row {last:?}, expected 0, 0, 0, 1"));
    }
    let rotation = Matrix3::from_fn(at);
    let off = (rotation.transpose() * rotation - Matrix3::identity()).norm();
    let is_rotation = off <= ROTATION_TOLERANCE && rotation.determinant() > 0.0;
    if !is_rotation {
        return Err(format!(
            "found a matrix whose upper left part is no rotation (RᵀR is {off:.1e} from the identity, determinant {:.4}), expected one",
            rotation.determinant()
        ));
    }
    Ok(Pose::new(rotation, nalgebra::Vector3::new(at(0, 3), at(1, 3), at(2, 3))).orthonormalized())
}

/// A pose as 16 numbers, row by row.
fn numbers_of(pose: &Pose) -> [f64; 16] {
    let mut matrix = pose.rotation.to_homogeneous();
    matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.translation);
    std::array::from_fn(|k| matrix[(k / 4, k % 4)])
}

/// A pose as an array of shape (4, 4).
pub(crate) fn pose_array<'py>(py: Python<'py>, pose: &Pose) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_vec(py, numbers_of(pose).to_vec()).reshape([4, 4])
}

/// Poses as an array of shape (m, 4, 4).
pub(crate) fn pose_arrays<'py>(py: Python<'py>, poses: &[Pose]) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let numbers: Vec<f64> = poses.iter().flat_map(numbers_of).collect();
    PyArray1::from_vec(py, numbers).reshape([poses.len(), 4, 4])
}

/// Rows of `columns` numbers as an array of shape (m, columns).
pub(crate) fn table<'py>(py: Python<'py>, numbers: Vec<f64>, columns: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}

/// Joint readings, of shape (m, n) or (n,) for one configuration.
pub(crate) struct JointArray {
    /// All configurations, in the order of the robot's readings.
    pub(crate) readings: Vec<f64>,
    /// True if it was a single configuration.
    pub(crate) single: bool,
}

impl JointArray {
    /// Configurations of the argument `joints`.
    pub(crate) fn from_argument(value: &Bound<'_, PyAny>, robot: &poecal_model::robot::Robot) -> PyResult<Self> {
        let names = robot.reading_names();
        let n = names.len();
        let expected = format!(
            "shape (m, {n}) or ({n},): in each configuration {} (radians; metres of sliding joints)",
            names.join(", ")
        );
        let numbers = NumberArray::require_finite(value, "joints", &expected)?;
        let single = numbers.shape.len() == 1;
        let wanted: &[Option<usize>] = if single { &[Some(n)] } else { &[None, Some(n)] };
        Ok(JointArray { readings: numbers.require_shape(wanted, "joints", &expected)?.values, single })
    }
}
