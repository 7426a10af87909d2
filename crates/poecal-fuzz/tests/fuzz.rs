//! Tries every target on its seeds and on variations of them, the same in every run. Names of targets, and of files to try as they are, may follow:
//! `cargo test -p poecal-fuzz --test fuzz -- urdf broken.urdf`. `POECAL_TRIALS` sets the number of variations, as in all tests.

#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use poecal_fuzz::{FuzzTarget, Mutator, TARGETS};
use poecal_testing::trials::trials;

/// Longest time of one input: one second on an idle machine may be many on a busy one.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() {
    let named: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let (targets, files): (Vec<String>, Vec<String>) =
        named.into_iter().partition(|name| TARGETS.iter().any(|target| target.name == name));
    let chosen = |target: &&FuzzTarget| targets.is_empty() || targets.iter().any(|name| name == target.name);
    let chosen: Vec<&FuzzTarget> = TARGETS.iter().filter(chosen).collect();
    let next = AtomicUsize::new(0);
    let failed = AtomicUsize::new(0);
    let work = || {
        while let Some(target) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
            if !try_target(target, &files) {
                failed.fetch_add(1, Ordering::Relaxed);
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    assert!(failed.into_inner() == 0, "a target failed");
}

/// A folder of the repository's `fuzz`.
fn fuzz_folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz").join(name)
}

fn try_target(target: &FuzzTarget, files: &[String]) -> bool {
    let mut tried = Tried::default();
    if !files.is_empty() {
        return files.iter().all(|file| tried.input(target, &fs::read(file).unwrap()));
    }
    let seeds = seeds(target.name);
    let words = words(target.name);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    for (name, seed) in &seeds {
        let before = tried.understood;
        if !tried.input(target, seed) {
            return false;
        }
        // Variations of a refused example only lead to errors.
        assert!(name.starts_with("found") || tried.understood > before, "{}: {name} is refused", target.name);
    }
    let seeds: Vec<Vec<u8>> = seeds.into_iter().map(|(_, seed)| seed).collect();
    let mut mutator = Mutator::new(1, &seeds, &words);
    for _ in 0..trials(target.trials).count {
        if !tried.input(target, &mutator.variation()) {
            return false;
        }
    }
    println!(
        "fuzz {}: {} inputs, {} of them understood, in {:.1} s; slowest {:.0} ms",
        target.name,
        tried.inputs,
        tried.understood,
        tried.seconds,
        tried.slowest.as_secs_f64() * 1e3
    );
    true
}

/// Names and content, in the order of the names.
fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = fuzz_folder("seeds").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut seeds: Vec<(String, Vec<u8>)> = entries
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path()).unwrap()))
        .collect();
    seeds.sort();
    assert!(!seeds.is_empty(), "no seeds in {}", folder.display());
    seeds
}

/// The words of the target's dictionary: `"word"` a line.
fn words(target: &str) -> Vec<String> {
    let text = fs::read_to_string(fuzz_folder("dictionaries").join(format!("{target}.dict"))).unwrap();
    let words = text.lines().filter_map(|line| line.strip_prefix('"')?.strip_suffix('"'));
    words.map(|word| word.replace("\\\"", "\"").replace("\\x0A", "\n")).collect()
}

#[derive(Default)]
struct Tried {
    inputs: usize,
    understood: usize,
    seconds: f64,
    slowest: Duration,
}

impl Tried {
    /// False if a property does not hold; the input is then kept.
    fn input(&mut self, target: &FuzzTarget, data: &[u8]) -> bool {
        let start = Instant::now();
        let outcome = catch_unwind(|| (target.run)(data));
        let took = start.elapsed();
        self.inputs += 1;
        self.seconds += took.as_secs_f64();
        self.slowest = self.slowest.max(took);
        if let Ok(understood) = outcome
            && took < PATIENCE
        {
            self.understood += usize::from(understood);
            return true;
        }
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("found-{}-{}", target.name, self.inputs));
        fs::write(&path, data).unwrap();
        println!(
            "fuzz {}: FAILED after {:.1} s on {}; try it again: cargo test -p poecal-fuzz --test fuzz -- {} {}",
            target.name,
            took.as_secs_f64(),
            path.display(),
            target.name,
            path.display()
        );
        false
    }
}
