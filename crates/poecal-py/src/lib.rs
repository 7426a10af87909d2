//! The compiled half of the Python package `poecal`: conversions between Python and the library, and nothing else.

/// The compiled half of the Python package `poecal`.
#[pyo3::pymodule]
mod _poecal {
    use pyo3::pyfunction;

    /// The version of poecal that this module was built from.
    #[pyfunction]
    fn version() -> &'static str {
        env!("CARGO_PKG_VERSION")
    }
}
