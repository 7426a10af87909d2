//! `poecal reproduce`: a paper's experiment and its claims, or the effect of gross errors.

use poecal_lou2009::{ReproductionOptions, breakdown, lou2009, report};
use poecal_numerics::error::Result;
use poecal_results::output::{self, Contents, ExistingFiles, ReservedFolder};

use crate::args::{Experiment, Reproduce};
use crate::console::Console;
use crate::style;

pub(crate) fn reproduce(arguments: &Reproduce, console: &Console) -> Result<u8> {
    let existing = ExistingFiles::from_switch(arguments.force);
    let place = ReservedFolder::reserve(&arguments.out, Contents::Reproduction, existing, &[], &mut console.warner())?;
    let options = ReproductionOptions {
        trials: arguments.trials as usize,
        starts: arguments.starts as usize,
        seed: arguments.seed,
    };
    let bar = console.progress(1);
    bar.set(0, "repeating the experiment");
    let found = match arguments.experiment {
        Experiment::Lou2009 => {
            lou2009(&options).and_then(|found| Ok((report::reproduction_files(&found)?, report::claims(&found))))
        }
        Experiment::Breakdown => breakdown(&options)
            .and_then(|found| Ok((report::breakdown_files(&found)?, report::breakdown_table(&found)))),
    };
    bar.finish();
    let (files, words) = found?;
    let written = output::write_reproduction(place, &files)?;
    console.warnings(&written.notes);
    let files = style::describe_written_files(&written.folder, &written.files);
    Ok(console.say_of(&(words + &files), &written.folder))
}
