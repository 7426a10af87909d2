//! Files: robot models, measurements, results. The only module that opens them; it computes nothing beyond units.

pub mod calibration_file;
mod csv_text;
pub mod disk;
mod hashes;
mod looks_like;
pub mod measurements;
mod mimic;
pub mod model;
pub mod named_files;
mod numbers;
pub mod output;
pub mod predictions;
mod proof;
pub mod residuals;
pub mod robot_toml;
pub mod settings;
mod source;
mod source_text;
pub mod urdf;

pub use proof::Difference;
