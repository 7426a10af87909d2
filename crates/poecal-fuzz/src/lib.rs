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
pub struct FuzzTarget {
    /// Name, that of its program in `fuzz/fuzz_targets` and of its folder in `fuzz/seeds`.
    pub name: &'static str,
    /// Processes an input; returns true if it was understood, and not refused with an error.
    pub run: fn(&[u8]) -> bool,
    /// Number of inputs that the weekly test tries, about as many as take two seconds; `./test` tries a quarter.
    pub trials: usize,
}

/// All targets.
pub const TARGETS: [FuzzTarget; 23] = [
    FuzzTarget { name: "urdf", run: targets::urdf, trials: 1500 },
    FuzzTarget { name: "robot_toml", run: targets::robot_toml, trials: 1500 },
    FuzzTarget { name: "foreign", run: targets::foreign, trials: 3000 },
    FuzzTarget { name: "measurements", run: targets::measurements, trials: 6000 },
    FuzzTarget { name: "recorded", run: targets::read_recorded, trials: 400 },
    FuzzTarget { name: "mapping", run: targets::mapping, trials: 10000 },
    FuzzTarget { name: "joints", run: targets::joints, trials: 10000 },
    FuzzTarget { name: "cameras", run: targets::cameras, trials: 20000 },
    FuzzTarget { name: "boards", run: targets::boards, trials: 60000 },
    FuzzTarget { name: "messages", run: targets::messages, trials: 300 },
    FuzzTarget { name: "residuals", run: targets::residuals, trials: 5000 },
    FuzzTarget { name: "settings", run: targets::settings, trials: 20000 },
    FuzzTarget { name: "calibration", run: targets::calibration, trials: 1000 },
    FuzzTarget { name: "report", run: targets::report, trials: 600 },
    FuzzTarget { name: "programs", run: targets::programs, trials: 300 },
    FuzzTarget { name: "workbooks", run: targets::workbooks, trials: 3000 },
    FuzzTarget { name: "bags", run: targets::bags, trials: 3000 },
    FuzzTarget { name: "pictures", run: targets::pictures, trials: 3000 },
    FuzzTarget { name: "hand_eye", run: targets::hand_eye, trials: 3000 },
    FuzzTarget { name: "tcp", run: targets::tcp, trials: 6000 },
    FuzzTarget { name: "ledgers", run: targets::ledgers, trials: 10000 },
    FuzzTarget { name: "histories", run: targets::histories, trials: 20000 },
    FuzzTarget { name: "pipeline", run: targets::pipeline, trials: 150 },
];
