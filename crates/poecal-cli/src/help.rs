//! The program's commands in groups, as its help lists them.

use std::fmt::Write as _;

use clap::{Command, CommandFactory as _};
use poecal_report::table::broken;

use crate::args::Arguments;
use crate::console::help_width;

/// Columns before what a command does.
const NAMES: usize = 15;

/// Headings, and the commands below each in the order of their use.
const GROUPS: [(&str, &[&str]); 5] = [
    ("Before and while measuring", &["init", "plan", "identify", "simulate", "board", "watch"]),
    ("Calibrate", &["calibrate", "check", "import", "hand-eye", "tcp", "detect", "report", "certificate"]),
    ("Use a calibration", &["export", "apply", "offsets", "compensate", "predict", "convert"]),
    ("Judge, again and again", &["validate", "track", "compare", "fleet"]),
    ("The program itself", &["reproduce", "schema", "completions", "man", "help"]),
];

/// The command line as the program understands it.
pub(crate) fn command_line() -> Command {
    let command = Arguments::command();
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}Options:\n{{options}}{{after-help}}",
        listed(&command)
    );
    command.help_template(template)
}

/// The list of commands: what each does, in groups.
fn listed(command: &Command) -> String {
    let width = help_width();
    let mut list = String::new();
    for (heading, names) in GROUPS {
        let _ = writeln!(list, "{heading}:");
        for &name in names {
            let about = match command.find_subcommand(name).and_then(Command::get_about) {
                Some(about) => about.to_string(),
                None if name == "help" => "Print this message or the help of a command".to_owned(),
                None => continue,
            };
            let _ = writeln!(list, "  {name:<12} {}", broken(&about, NAMES, NAMES, width));
        }
        list.push('\n');
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let mut grouped: Vec<&str> =
            GROUPS.iter().flat_map(|it| it.1.iter().copied()).filter(|it| *it != "help").collect();
        let command = command_line();
        let mut all: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
    }
}
