//! The README's first command prints what the README shows.

use std::fs;

use crate::folder::Folder;
use crate::project::{output_of, root};

/// The text of the README's first block of a language.
fn first_block<'a>(readme: &'a str, language: &str) -> &'a str {
    let fence = format!("```{language}\n");
    readme.split_once(&fence).unwrap().1.split_once("```").unwrap().0
}

/// The text with the differences of files read back, rounding errors that depend on the processor, as `#`.
fn without_rounding_errors(text: &str) -> String {
    let mut lines = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let is_tiny = |word: &str| word.contains("e-1") && word.parse().is_ok_and(|value: f64| value < 1e-12);
        lines.push(words.iter().map(|word| if is_tiny(word) { "#" } else { word }).collect::<Vec<_>>().join(" "));
    }
    lines.join("\n")
}

#[test]
fn the_first_command_prints_what_the_readme_shows() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let words = first_block(&readme, "sh").trim().strip_prefix("cargo run --release -- ").unwrap();
    let folder = Folder::new();
    let out = folder.path("poecal-out");
    let shown = output_of(words, &out).replace(&out.display().to_string(), "poecal-out");
    // The line with the folder, whose name is longer here, is broken at another word.
    let lines = |text: &str| without_rounding_errors(text).replace("\n              ", " ");
    assert_eq!(lines(&shown), lines(first_block(&readme, "text").trim_end()));
}

#[test]
fn the_first_command_and_its_output_stand_on_the_first_screen() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let end = readme.split_once(first_block(&readme, "text")).unwrap().0.lines().count()
        + first_block(&readme, "text").lines().count();
    assert!(end <= 60, "{end} lines");
}
