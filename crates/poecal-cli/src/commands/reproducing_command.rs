//! The command that reproduces a result.

use std::ffi::OsString;

/// Options that do not change the result: places, output, speed; settings are among the words already.
const WITH_VALUE: [&str; 7] = ["--history", "--out", "--threads", "--wait", "--require", "--report", "--settings"];
const WITHOUT_VALUE: [&str; 5] = ["--force", "--force-own", "--json", "--verbose", "--quiet"];

/// Arguments of a run, the program first, without those that do not change the result.
pub(super) fn command(arguments: &[OsString]) -> String {
    let mut words = vec!["poecal".to_owned()];
    let mut rest = arguments.iter().skip(1).map(|word| word.to_string_lossy());
    let mut only_files = false;
    while let Some(word) = rest.next() {
        if !only_files {
            if WITHOUT_VALUE.contains(&&*word) {
                continue;
            }
            if WITH_VALUE.contains(&&*word) {
                rest.next();
                continue;
            }
            if WITH_VALUE.iter().any(|option| word.strip_prefix(option).is_some_and(|it| it.starts_with('='))) {
                continue;
            }
        }
        only_files |= word == "--";
        words.push(shell_word(&word));
    }
    words.join(" ")
}

/// A word, quoted for a shell.
pub(super) fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_change_the_result_is_left_out() {
        let of = |text: &str| command(&text.split(' ').map(OsString::from).collect::<Vec<_>>());
        assert_eq!(
            of("/usr/bin/poecal --threads 4 calibrate a.urdf b.csv --out=x --seed 2 --report none --force --json"),
            "poecal calibrate a.urdf b.csv --seed 2"
        );
        assert_eq!(of("poecal calibrate -- --out --json"), "poecal calibrate -- --out --json");
    }

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(shell_word("my robot's.urdf"), "'my robot'\\''s.urdf'");
        assert_eq!((shell_word("a/b_1.csv").as_str(), shell_word("").as_str()), ("a/b_1.csv", "''"));
    }
}
