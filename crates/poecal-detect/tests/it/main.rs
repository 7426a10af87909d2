//! Corners of rendered pictures against the truth, reasons and suggestions, files, and real pictures where they are.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod dots;
mod files;
mod found;
mod real;
mod rejected;
mod tags;
