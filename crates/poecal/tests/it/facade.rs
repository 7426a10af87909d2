//! What the library shows of itself: few types, each with an example that runs.

use std::fs;
use std::path::{Path, PathBuf};

/// Types that a reader of the documentation meets, at most.
const MOST: usize = 70;

fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The names that a file hands on by `pub use`, but for hidden ones, with the module that each comes from.
fn handed_on(file: &Path) -> Vec<(String, String)> {
    let text = fs::read_to_string(file).unwrap();
    let mut found = Vec::new();
    for (at, _) in text.match_indices("\npub use ") {
        let before = text[..at].lines().next_back().unwrap_or_default();
        if before == "#[doc(hidden)]" {
            continue;
        }
        let tree = text[at + "\npub use ".len()..].split_once(';').unwrap().0;
        let (module, names) = tree.rsplit_once("::").filter(|_| !tree.contains('{')).unwrap_or_else(|| {
            let (module, names) = tree.split_once("::{").unwrap();
            (module, names.trim_end_matches('}'))
        });
        let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
        found.extend(names.map(|name| (module.to_owned(), name.split(" as ").next().unwrap().to_owned())));
    }
    found
}

/// The documentation above the declaration of a type, below a folder or in a file.
fn documentation(place: &Path, name: &str) -> Option<String> {
    if place.is_dir() {
        let mut paths: Vec<PathBuf> =
            fs::read_dir(place).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        return paths.iter().find_map(|path| documentation(path, name));
    }
    let text = fs::read_to_string(place).ok()?;
    let lines: Vec<&str> = text.lines().collect();
    let declares = |line: &str| {
        let rest = ["pub struct ", "pub enum ", "pub trait ", "pub type "];
        let rest = rest.iter().find_map(|word| line.strip_prefix(word));
        rest.is_some_and(|rest| rest.split(|c: char| !c.is_alphanumeric()).next() == Some(name))
    };
    let at = lines.iter().position(|line| declares(line))?;
    let last = lines[..at].iter().rposition(|line| line.starts_with("///"))?;
    let first = lines[..=last].iter().rposition(|line| !line.starts_with("///")).map_or(0, |line| line + 1);
    Some(lines[first..=last].join("\n"))
}

#[test]
fn few_types_are_shown_and_each_has_an_example() {
    let root = sources();
    let mut shown = handed_on(&root.join("lib.rs"));
    let text = fs::read_to_string(root.join("lib.rs")).unwrap();
    let mut modules = Vec::new();
    for (before, line) in text.lines().zip(text.lines().skip(1)) {
        if let Some(module) = line.strip_prefix("pub mod ")
            && before != "#[cfg_attr(doc, doc(hidden))]"
        {
            modules.push(module.trim_end_matches(';').to_owned());
        }
    }
    assert_eq!(modules, ["simulate", "solve"]);
    assert!(text.contains("\npub use poecal_arm::lie;"));
    modules.push("lie".to_owned());
    let folder = |module: &str| match module {
        "lie" => root.join("../../poecal-arm/src/lie"),
        "poecal_arm" => root.join("../../poecal-arm/src"),
        _ => root.join(module.replace("::", "/")),
    };
    for module in &modules {
        let own = handed_on(&folder(module).join("mod.rs"));
        let place = |from: &str| from.strip_prefix("crate::").unwrap_or(module).to_owned();
        shown.extend(own.into_iter().map(|(from, name)| (place(&from), name)));
    }
    shown.push(("solve".into(), "LeastSquares".into()));
    shown.retain(|(_, name)| name.starts_with(char::is_uppercase));
    shown.sort_by(|a, b| a.1.cmp(&b.1));
    shown.dedup_by(|a, b| a.1 == b.1);
    for (module, name) in &shown {
        let place = folder(module);
        let place = if place.is_dir() { place } else { place.with_extension("rs") };
        let text = documentation(&place, name);
        let text =
            text.unwrap_or_else(|| panic!("{module}::{name} has no documentation in {}", place.display()));
        assert!(text.contains("```"), "{module}::{name} has no example");
    }
    println!("{} types are shown", shown.len());
    assert!(shown.len() <= MOST, "{} types: hide what few need", shown.len());
}
