//! `poecal reproduce`: the experiment of a paper, and what became of its claims.

use std::process::ExitCode;

use poecal::io::output;
use poecal::reproduce::{Options, lou2009};
use poecal::{Result, report};

use crate::args::{Paper, Reproduce};
use crate::console::Console;

pub(crate) fn reproduce(arguments: &Reproduce, console: &Console) -> Result<ExitCode> {
    output::check_folder(&arguments.out, arguments.force)?;
    let options = Options {
        trials: arguments.trials as usize,
        starts: arguments.starts as usize,
        seed: arguments.seed,
    };
    let bar = console.progress(1);
    bar.set_message("repeating the experiment");
    let found = match arguments.paper {
        Paper::Lou2009 => lou2009(&options),
    };
    bar.finish_and_clear();
    let found = found?;
    let files = report::reproduction_files(&found)?;
    let written = output::write_reproduction(&arguments.out, arguments.force, &files)?;
    console.say(&report::claims(&found))?;
    console.say(&format!("written       {}: {}\n", written.folder.display(), written.files.join(", ")))?;
    Ok(ExitCode::SUCCESS)
}
