//! Project folders.

use std::path::PathBuf;

use poecal_model::simulate::SessionKind;
use poecal_results::model::Model;
use poecal_results::output::{Contents, ExistingFiles, Project, write_project};
use pyo3::prelude::*;

use crate::arguments::{self as arg, NamedLinks};
use crate::errors::{argument, raise};
use crate::output_places::reserved_folder;
use crate::words::choose_word;

/// Most suggested configurations, as in the program.
const MOST: usize = 100_000;

/// Writes a project folder to start from.
///
/// It has the model, a measurement file to fill in, configurations to measure, settings for `poecal calibrate`, and instructions.
///
/// Parameters
/// ----------
/// model
///     Path of a robot model of any form.
/// out
///     The folder; files in it are never overwritten.
/// kind
///     Kind of the measurements: "point", "pose", "distance", "distance-change", "sphere", "socket", "plane", "height", "flush", "direction",
///     "ball-bar", "relative" or "component".
/// count
///     Number of configurations to suggest, from 1 to 100,000.
/// seed
///     Seed of their choice.
/// base_link, tip_link
///     The chain of a URDF that has several.
/// instruments, targets
///     Names of instruments on the robot and of targets, with their links in a URDF: the robot is the tree of the joints to these.
///
/// Returns
/// -------
/// list of str
///     Names of the files.
#[pyfunction]
#[pyo3(signature = (model, out, *, kind="point", count=60, seed=1, base_link=None, tip_link=None, instruments=None, targets=None))]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
pub(crate) fn init(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::model)] model: PathBuf,
    #[pyo3(from_py_with = arg::out)] out: PathBuf,
    #[pyo3(from_py_with = arg::kind)] kind: &str,
    #[pyo3(from_py_with = arg::count)] count: usize,
    #[pyo3(from_py_with = arg::seed)] seed: u64,
    #[pyo3(from_py_with = arg::base_link)] base_link: Option<String>,
    #[pyo3(from_py_with = arg::tip_link)] tip_link: Option<String>,
    #[pyo3(from_py_with = arg::instruments)] instruments: Option<NamedLinks>,
    #[pyo3(from_py_with = arg::targets)] targets: Option<NamedLinks>,
) -> PyResult<Vec<String>> {
    let words = SessionKind::all().into_iter().filter(|kind| kind.session().plural.is_some());
    let kind = choose_word("kind", kind, &words.map(|kind| (kind.word(), kind)).collect::<Vec<_>>())?;
    if !(1..=MOST).contains(&count) {
        return Err(argument("count", format!("found {count}, expected a number from 1 to {MOST}")));
    }
    let chain = arg::selection(base_link, tip_link, instruments, targets);
    let model = py.detach(|| Model::read(&model, &chain)).map_err(raise)?;
    let place = reserved_folder(py, &out, Contents::Project, ExistingFiles::Kept, &[])?;
    let project = Project { model: &model, chain: &chain, kind, count, seed };
    let written = py.detach(|| write_project(place, &project)).map_err(raise)?;
    crate::warn(py, &written.notes)?;
    Ok(written.files)
}
