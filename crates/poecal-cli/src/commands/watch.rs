//! `poecal watch`: rows judged as they arrive.

use std::thread::sleep;
use std::time::Duration;

use poecal_calibrate::Corrections;
use poecal_import::{GrowingFile, NewRows};
use poecal_model::measurement::SessionKind;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_plan::plan::{Watch as Watched, WatchOptions, workspace_in};
use poecal_report as report;

use super::models::read_model;
use super::plan::{fit, readings};
use crate::args::WatchArgs;
use crate::console::Console;
use crate::quantity::WorkspaceChoice;
use crate::{DONE, WORSE};

/// Pause between two looks at the file.
const PAUSE: Duration = Duration::from_millis(100);
/// Number of consecutive looks with the same fault from which on a file is faulty, and not being written at the moment.
const LOOKS: u32 = 20;

pub(crate) fn watch(arguments: &WatchArgs, console: &Console) -> Result<u8> {
    if cfg!(target_family = "wasm") && !arguments.batch {
        return ErrorKind::Option.refuse(
            "found watch without --batch, expected it where a program cannot wait for a file, as in a browser",
        );
    }
    let options = arguments.columns.options();
    let model = read_model(&arguments.model, &arguments.chain.selection(options.as_ref().ok())?, console)?;
    let reading = model.reads(options?);
    let read = |path| readings(path, &model, &reading, console);
    let candidates = arguments.candidates.as_ref().map(read).transpose()?;
    let workspace = match &arguments.workspace {
        WorkspaceChoice::Limits => None,
        WorkspaceChoice::Tasks(path) => Some(readings(path, &model, &reading, console)?),
        WorkspaceChoice::Box(corners) => Some(workspace_in(&model.robot, corners, arguments.seed)?),
    };
    let fit = fit(&arguments.fit, &model, SessionKind::POINT, 30)?;
    let options = WatchOptions { fit, candidates, workspace, seed: arguments.seed };
    let mut file = open_growing_file(arguments, console);
    let mut trouble = (String::new(), 0);
    let (mut watched, mut done, mut is_named, mut is_reached) = (None, 0, false, false);
    let is_corrected = arguments.fit.corrections != Corrections::Off;
    loop {
        let news = match file.news(&model.robot, &reading) {
            Err(error) if !arguments.batch && is_for_a_moment(&error.to_string(), &mut trouble) => None,
            news => news?,
        };
        if let Some(NewRows { file, is_again }) = news {
            if is_again && done > 0 {
                console.warning("the file was shortened or changed: all rows are read again from the first");
                (watched, done) = (None, 0);
            }
            let data = &file.data;
            let session = match &mut watched {
                Some(session) => session,
                None => watched.insert(Watched::new(&model.robot, options.clone().for_rows(data))?),
            };
            while done < data.len() {
                let row = session.add(data, done)?;
                done += 1;
                let line = report::RowReport::new(&model.robot, data, &row);
                is_named |= row.mistake.is_some();
                console.json_or_table(arguments.json, || line.json(), || line.text())?;
                let error = row.now.map(|now| if is_corrected { now.corrected_m() } else { now.calibrated_m() });
                is_reached |= arguments.target_error.zip(error).is_some_and(|(until, error)| error <= until);
                if is_reached && !arguments.batch {
                    return Ok(DONE);
                }
            }
        }
        if arguments.batch {
            let is_short = arguments.target_error.is_some() && !is_reached;
            return Ok(if is_named || is_short { WORSE } else { DONE });
        }
        sleep(PAUSE);
    }
}

/// The file; unless it is read once, its creation is awaited.
fn open_growing_file(arguments: &WatchArgs, console: &Console) -> GrowingFile {
    let file = GrowingFile::new(&arguments.measurements);
    if arguments.batch {
        return file;
    }
    if file.is_absent() {
        console.remark(format!("{}: waits for its first lines", arguments.measurements.display()));
    }
    file.waited_for()
}

/// True if a file may be wrong because it is being written: `trouble` is the fault of the last look, and its number in sequence.
fn is_for_a_moment(sentence: &str, trouble: &mut (String, u32)) -> bool {
    if trouble.0 == sentence {
        trouble.1 += 1;
    } else {
        *trouble = (sentence.to_owned(), 1);
    }
    trouble.1 < LOOKS
}
