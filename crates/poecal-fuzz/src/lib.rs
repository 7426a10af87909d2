//! Properties that hold for any input, as plain functions of bytes.
//!
//! Each of [`TARGETS`] treats bytes as the text of a file that poecal reads, and fails by panicking: if the library does, or if a property does not
//! hold, such as that written text reads back the same. The programs in `fuzz/` call them with inputs of libFuzzer, the test of this crate with the
//! seeds in `fuzz/seeds` and [`Mutator`]'s variations of them.
//!
//! For tests alone; not published.

// A violated property is reported by a panic.
#![allow(clippy::panic, clippy::expect_used, clippy::unwrap_used)]

mod mutator;
mod one_file;
mod properties;
pub mod targets;

pub use mutator::Mutator;

/// Longest examined input, bytes: random findings need no more, and time and memory stay bounded.
pub const LONGEST: usize = 1 << 16;

/// Separator line between the texts of an input that has several.
pub const BETWEEN: &str = "=====";

/// A fuzzed function.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name, that of its program in `fuzz/fuzz_targets` and of its folder in `fuzz/seeds`.
    pub name: &'static str,
    /// Processes an input; returns true if it was understood, and not refused with an error.
    pub run: fn(&[u8]) -> bool,
    /// Number of inputs that the weekly test tries, about as many as take two seconds; `./test` tries a quarter.
    pub trials: usize,
}

/// All targets.
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
