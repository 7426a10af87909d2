//! Old words on the command line: the sentence that states the new one.

use std::ffi::OsString;

use clap::error::{ContextKind, ErrorKind};
use poecal_results::renamed_words::new_word;

use crate::help::command_line;

/// The sentence for an old command, option or word of an option.
pub(crate) fn sentence(typed: &[OsString], error: &clap::Error) -> Option<String> {
    let text = |kind| error.get(kind).map(ToString::to_string);
    let program = command_line();
    let mut words = typed.iter().skip(1).filter_map(|word| word.to_str());
    let command = words.find(|word| program.find_subcommand(word).is_some()).unwrap_or_default();
    let (command, old) = if error.kind() == ErrorKind::InvalidSubcommand {
        ("", text(ContextKind::InvalidSubcommand)?)
    } else if error.kind() == ErrorKind::UnknownArgument {
        (command, text(ContextKind::InvalidArg)?)
    } else {
        let option = text(ContextKind::InvalidArg)?;
        let option = option.split(' ').next().unwrap_or_default();
        (command, format!("{option} {}", text(ContextKind::InvalidValue)?))
    };
    let kind = if command.is_empty() { "the command " } else { "" };
    new_word(command, &old).map(|new| format!("found {kind}`{old}`, which is now `{new}`"))
}

#[cfg(test)]
mod tests {
    use poecal_results::renamed_words::RENAMED;

    use super::*;

    /// Old words are refused, new ones are there, and the changelog has the same table.
    #[test]
    fn each_old_word_has_its_sentence_and_its_row() {
        let changes = include_str!("../../../CHANGELOG.md");
        let section = changes.split("\n### Names that changed\n").nth(1).unwrap().split("\n#").next().unwrap();
        let rows: Vec<&str> = section.lines().filter(|line| line.starts_with('|') && line.contains('`')).collect();
        let row = |(commands, old, new): &(&str, &str, &str)| {
            let commands: Vec<String> =
                commands.split(' ').filter(|it| !it.is_empty()).map(|it| format!("`{it}`")).collect();
            format!("| {} | `{old}` | `{new}` |", commands.join(", ")).replace("|  |", "| |")
        };
        assert_eq!(rows, RENAMED.iter().map(row).collect::<Vec<_>>());
        let program = command_line();
        for (commands, old, new) in RENAMED {
            for command in commands.split(' ') {
                let mut typed: Vec<OsString> = vec!["poecal".into()];
                typed.extend(
                    [command, old].iter().flat_map(|it| it.split(' ')).filter(|it| !it.is_empty()).map(OsString::from),
                );
                let error = program.clone().try_get_matches_from(&typed).unwrap_err();
                let said = sentence(&typed, &error).unwrap_or_else(|| panic!("{typed:?}: {error}"));
                assert!(said.ends_with(&format!("`{old}`, which is now `{new}`")), "{said}");
                let (name, option) = if command.is_empty() { new.split_once(' ').unwrap() } else { (command, new) };
                let option = option.split(' ').find(|word| word.starts_with("--")).unwrap();
                let own = program.find_subcommand(name).unwrap();
                assert!(own.get_arguments().any(|it| it.get_long() == Some(&option[2..])), "{name} {option}");
            }
        }
    }
}
