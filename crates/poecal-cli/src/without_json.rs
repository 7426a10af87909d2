//! Commands without `--json`: the form of their output, and the command that prints JSON of it.

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Each command without `--json`, its output, and the source of the same as JSON.
const COMMANDS: [(&str, &str, &str); 11] = [
    ("simulate", "it writes the files of a session", "use `poecal check … --json` on them"),
    ("import", "it writes a table and a mapping", "use `poecal check … --json` on the table"),
    ("detect", "it writes a table of corners", "use `poecal check … --json` on the table"),
    ("report", "it writes a page", "use the calibration.json that it shows"),
    ("export", "it writes a model in the form of --format", "use `--format poe` for JSON"),
    ("predict", "it prints a table of poses", "use the table, or `predict` in Python"),
    ("fleet", "it writes a folder for each robot", "use the ledger fleet.jsonl, a line of JSON for each robot"),
    ("reproduce", "it prints the tables of a paper", "use `reproduce` in Python, whose result has `to_json`"),
    ("schema", "it prints JSON in any case", "leave --json away"),
    ("completions", "it prints a script of the shell", "leave --json away"),
    ("man", "it writes manual pages", "leave --json away"),
];

/// The sentence for `--json` of a command without that option.
pub(crate) fn sentence(typed: &[OsString], error: &clap::Error) -> Option<String> {
    let is_json =
        matches!(error.get(ContextKind::InvalidArg), Some(ContextValue::String(argument)) if argument == "--json");
    if error.kind() != ErrorKind::UnknownArgument || !is_json {
        return None;
    }
    // The first word that is a command is the command.
    let mut words = typed.iter().skip(1).filter_map(|word| word.to_str());
    let found = words.find_map(|word| COMMANDS.iter().find(|(command, ..)| word == *command));
    found
        .map(|(command, output, instead)| format!("found --json, but `poecal {command}` has none: {output}; {instead}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::help::command_line;

    #[test]
    fn every_command_without_json_has_its_sentence() {
        for command in command_line().get_subcommands() {
            let name = command.get_name();
            let has_json = command.get_arguments().any(|it| it.get_long() == Some("json"));
            let is_listed = COMMANDS.iter().any(|(listed, ..)| *listed == name);
            assert_eq!(is_listed, !has_json && name != "help", "{name}");
        }
    }

    #[test]
    fn json_of_a_command_without_it_is_answered_in_one_sentence() {
        let typed: Vec<OsString> = ["poecal", "--quiet", "predict", "--json", "a", "b"].map(OsString::from).into();
        let error = command_line().try_get_matches_from(&typed).unwrap_err();
        let expected = "found --json, but `poecal predict` has none: it prints a table of poses; use the table, or `predict` in Python";
        assert_eq!(sentence(&typed, &error).as_deref(), Some(expected));
    }
}
