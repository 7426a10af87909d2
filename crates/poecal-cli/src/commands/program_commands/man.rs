//! `poecal man`: manual pages.

use poecal_numerics::error::{ErrorKind, Result, nearest_word};
use poecal_numerics::text::escape_invisible;

use crate::DONE;
use crate::args::Man;
use crate::console::Console;
use crate::help::command_line;

/// Collection to which the pages belong.
const SOURCE: &str = concat!("poecal ", env!("CARGO_PKG_VERSION"));

pub(crate) fn man(arguments: &Man, console: &Console) -> Result<u8> {
    let mut program = command_line().disable_help_subcommand(true);
    program.build();
    let command = match &arguments.command {
        None => program,
        Some(name) => {
            let found = program.find_subcommand(name).cloned();
            found.ok_or_else(|| ErrorKind::Option.error(unknown(name, &program)))?
        }
    };
    let mut page = Vec::new();
    let written = clap_mangen::Man::new(command).source(SOURCE).render(&mut page);
    written.map_err(|error| ErrorKind::File.error(format!("the manual page cannot be written ({error})")))?;
    console.data(&String::from_utf8_lossy(&page))?;
    Ok(DONE)
}

fn unknown(name: &str, program: &clap::Command) -> String {
    let names: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
    let hint =
        nearest_word(name, names.iter().copied()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    format!("man: found no command `{}`, expected one of {}{hint}", escape_invisible(name), names.join(", "))
}
