//! `poecal completions`: scripts by which a shell completes the program's words.

use poecal_numerics::error::Result;

use crate::DONE;
use crate::args::Completions;
use crate::console::Console;
use crate::help::command_line;

pub(crate) fn completions(arguments: &Completions, console: &Console) -> Result<u8> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command_line(), "poecal", &mut script);
    console.data(&String::from_utf8_lossy(&script))?;
    Ok(DONE)
}
