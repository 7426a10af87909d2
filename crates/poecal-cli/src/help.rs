//! The program's commands in groups, as its help lists them.

use std::fmt::Write as _;

use clap::{Command, CommandFactory as _};
use poecal_report::table::break_text;

use crate::args::{Arguments, with_exclusions};
use crate::console::help_width;

/// Columns before the description of a command.
const NAMES: usize = 15;

/// Headings, and the commands below each in the order of their use.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Measure", &["init", "plan", "simulate", "watch", "detect"]),
    ("Calibrate", &["check", "import", "calibrate", "hand-eye", "tcp", "report"]),
    ("Use", &["iso9283", "export", "offsets", "compensate", "predict"]),
    ("Keep", &["validate", "track", "compare", "fleet"]),
];

/// The command line in the program's form.
pub(crate) fn command_line() -> Command {
    let command = Arguments::command().mut_subcommand("plan", with_exclusions);
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}Options:\n{{options}}{{after-help}}",
        list_commands(&command)
    );
    command.help_template(template)
}

/// The list of commands: the purpose of each, in groups.
fn list_commands(command: &Command) -> String {
    let width = help_width();
    let mut list = String::new();
    for (heading, names) in GROUPS {
        let _ = writeln!(list, "{heading}:");
        for &name in names {
            let about = match command.find_subcommand(name).and_then(Command::get_about) {
                Some(about) => about.to_string(),
                None => continue,
            };
            let _ = writeln!(list, "  {name:<12} {}", break_text(&about, NAMES, NAMES, width));
        }
        list.push('\n');
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commands about the program itself, and the experiment of a paper.
    const NOT_LISTED: [&str; 4] = ["reproduce", "schema", "completions", "man"];

    #[test]
    fn every_command_is_in_one_group() {
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|it| it.1.iter().copied()).chain(NOT_LISTED).collect();
        let command = command_line();
        let mut all: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
    }
}
