//! `reproduce`.

use std::path::PathBuf;

use poecal_lou2009::{self as experiments, report as reproduced};
use poecal_report as report;
use poecal_results::output::{self, Contents, ExistingFiles};
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::errors::raise;
use crate::findings::Findings;
use crate::output_places::reserved_folder;
use crate::words::choose_word;

/// Repeats the experiment of a paper and checks its claims, or shows the effect of gross errors.
///
/// Parameters
/// ----------
/// experiment
///     "lou2009" (the paper) or "breakdown" (gross errors).
/// out
///     Folder for the report.
/// force
///     True to overwrite files that exist.
/// trials
///     Number of sessions that compare the formulations, or the losses.
/// starts
///     Number of random starts for each size of error (lou2009).
/// seed
///     Seed of everything random.
///
/// Returns
/// -------
/// Reproduction
///     The runs, and the claims with their results.
#[pyfunction]
#[pyo3(signature = (experiment, *, out=None, force=false, trials=1000, starts=100, seed=1))]
pub(crate) fn reproduce(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::experiment)] experiment: &str,
    #[pyo3(from_py_with = arg::out)] out: Option<PathBuf>,
    #[pyo3(from_py_with = arg::force)] force: bool,
    #[pyo3(from_py_with = arg::trials)] trials: u32,
    #[pyo3(from_py_with = arg::starts)] starts: u32,
    #[pyo3(from_py_with = arg::seed)] seed: u64,
) -> PyResult<Findings> {
    #[derive(Clone, Copy)]
    enum PaperExperiment {
        Lou2009,
        Breakdown,
    }
    let words = [("lou2009", PaperExperiment::Lou2009), ("breakdown", PaperExperiment::Breakdown)];
    let experiment = choose_word("experiment", experiment, &words)?;
    let options = experiments::ReproductionOptions { trials: trials as usize, starts: starts as usize, seed };
    let reserved =
        |folder: &PathBuf| reserved_folder(py, folder, Contents::Reproduction, ExistingFiles::from_switch(force), &[]);
    let place = out.as_ref().map(reserved).transpose()?;
    let work = || {
        let (json, words, answer, files) = match experiment {
            PaperExperiment::Lou2009 => {
                let found = experiments::lou2009(&options)?;
                let (holding, all) = found.count_holding(true);
                let answer = format!("{holding} of {all} claims of the paper hold as they are made");
                let files = reproduced::reproduction_files(&found)?;
                (report::json(&found)?, reproduced::claims(&found), answer, files)
            }
            PaperExperiment::Breakdown => {
                let found = experiments::breakdown(&options)?;
                let answer =
                    format!("errors by share of gross errors, from {} sessions of {} rows", found.sessions, found.rows);
                let files = reproduced::breakdown_files(&found)?;
                (report::json(&found)?, reproduced::breakdown_table(&found), answer, files)
            }
        };
        let written = place.map(|place| output::write_reproduction(place, &files)).transpose()?;
        let notes = written.map(|written| written.notes).unwrap_or_default();
        Ok((Findings::of_json("Reproduction", words, answer, json), notes))
    };
    let (found, notes) = py.detach(work).map_err(raise)?;
    crate::warn(py, &notes)?;
    Ok(found)
}
