//! Corners of rendered pictures against the truth, boards on paper, reasons and suggestions, files, and real pictures if they are available.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::panic)]

mod dots;
mod files;
mod found;
mod print;
mod real;
mod rejected;
mod tags;
