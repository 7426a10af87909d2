//! Simulated sessions of a camera and a board, calibrated and judged by their truth: a JSON object a line, which `validation/camera` sums up.
//!
//!     camera_sessions accuracy|bounds|setups|optics|kinematics|degenerate|low_cost [DRAWS] [FIRST SEED]

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "its lines are read by a command")]

mod accuracy;
mod bounds;
mod degenerate;
mod information;
mod kinematics;
mod low_cost;
mod optics;
mod scene;
mod session;
mod setups;

use rayon::prelude::*;
use serde_json::Value;

/// Results of one seed.
type SeedTask = fn(u64) -> Result<Vec<Value>, poecal_numerics::error::Error>;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, usual: u64| words.get(at).and_then(|word| word.parse().ok()).unwrap_or(usual);
    let tasks: [(&str, SeedTask); 7] = [
        ("accuracy", accuracy::run),
        ("bounds", bounds::run),
        ("setups", setups::run),
        ("optics", optics::run),
        ("kinematics", kinematics::run),
        ("degenerate", degenerate::run),
        ("low_cost", low_cost::run),
    ];
    let Some((_, task)) = tasks.iter().find(|(name, _)| words.first().is_some_and(|word| word == name)) else {
        eprintln!("expected one of accuracy, bounds, setups, optics, kinematics, degenerate, low_cost");
        std::process::exit(2);
    };
    let (draws, first) = (number(1, 4), number(2, 0));
    (first..first + draws).into_par_iter().for_each(|seed| match task(seed) {
        Ok(lines) => lines.iter().for_each(|line| println!("{line}")),
        Err(error) => println!("{}", serde_json::json!({ "seed": seed, "refused": error.to_string() })),
    });
}
