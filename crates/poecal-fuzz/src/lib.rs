//! What must hold of any input, as plain functions of bytes.
//!
//! Each of [`TARGETS`] takes bytes for the text of a file that poecal reads, and fails by panicking: if the library does, or if something
//! does not hold that should, such as that what is written reads back the same. The programs in `fuzz/` call them with what libFuzzer
//! makes up, the test of this crate with the seeds in `fuzz/seeds` and [`Mutator`]'s variations of them.
//!
//! For tests alone; not published.

// Whatever does not hold is told by a panic.
#![allow(clippy::panic, clippy::expect_used, clippy::unwrap_used)]

mod mutator;
mod one_file;
mod properties;
pub mod targets;

pub use mutator::Mutator;

/// Longest input that is looked at, bytes: nothing that is found by chance needs more, and time and memory stay bounded.
pub const LONGEST: usize = 1 << 16;

/// What stands on a line of its own between the texts of an input that has several.
pub const BETWEEN: &str = "=====";

/// One of the things that are fuzzed.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name, that of its program in `fuzz/fuzz_targets` and of its folder in `fuzz/seeds`.
    pub name: &'static str,
    /// Takes an input; tells whether it was understood, and not refused with an error.
    pub run: fn(&[u8]) -> bool,
    /// How many inputs are tried of it weekly, about as many as take two seconds; `./test` tries a quarter.
    pub trials: usize,
}

/// All of them.
pub const TARGETS: [Target; 23] = [
    Target { name: "urdf", run: targets::urdf, trials: 1500 },
    Target { name: "robot_toml", run: targets::robot_toml, trials: 1500 },
    Target { name: "foreign", run: targets::foreign, trials: 3000 },
    Target { name: "measurements", run: targets::measurements, trials: 6000 },
    Target { name: "recorded", run: targets::recorded, trials: 400 },
    Target { name: "mapping", run: targets::mapping, trials: 10000 },
    Target { name: "joints", run: targets::joints, trials: 10000 },
    Target { name: "cameras", run: targets::cameras, trials: 20000 },
    Target { name: "boards", run: targets::boards, trials: 60000 },
    Target { name: "messages", run: targets::messages, trials: 300 },
    Target { name: "residuals", run: targets::residuals, trials: 5000 },
    Target { name: "settings", run: targets::settings, trials: 20000 },
    Target { name: "calibration", run: targets::calibration, trials: 1000 },
    Target { name: "report", run: targets::report, trials: 600 },
    Target { name: "programs", run: targets::programs, trials: 300 },
    Target { name: "workbooks", run: targets::workbooks, trials: 3000 },
    Target { name: "bags", run: targets::bags, trials: 3000 },
    Target { name: "pictures", run: targets::pictures, trials: 3000 },
    Target { name: "hand_eye", run: targets::hand_eye, trials: 3000 },
    Target { name: "tcp", run: targets::tcp, trials: 6000 },
    Target { name: "ledgers", run: targets::ledgers, trials: 10000 },
    Target { name: "histories", run: targets::histories, trials: 20000 },
    Target { name: "pipeline", run: targets::pipeline, trials: 150 },
];
